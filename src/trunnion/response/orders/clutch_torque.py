"""What a slip clutch carries in a linear response, in which it sticks: a rigid link's torque follows from one side.

With σ = 1 behind the clutch and −1 in front of it, rotations and torques taken to the clutch,

    T = σ (J a + M + Σ T_in − Σ T_out),

J, a and M inertia, acceleration and loads of what turns with the clutch on that side, T_in the spring that drives it
and T_out those that it drives. A side will do where no angled joint is part of it and no excitation acts on it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.coefficients import Assembly, joint_laws
from trunnion.equations.harmonics import disk_torques
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.loads import mean_loads
from trunnion.equations.slip_capacity import stations_beyond, sticking_clutches
from trunnion.response.orders.result import OrderResponse


@dataclass(frozen=True)
class ClutchTorque:
    """How the torque of one clutch follows from a response.

    name, holds: of the clutch, its capacity [N m]; sense: σ; inertia [kg m²] at the clutch; point: number of the disk
    that turns with it and by how much faster; springs: number, and what a unit of its torque counts.
    """

    assembly: Assembly
    name: str
    holds: float
    sense: int
    inertia: float
    point: tuple[int, float]
    springs: tuple[tuple[int, float], ...]
    stations: tuple[int, ...]
    link: int

    def parts(self, response: OrderResponse) -> Complex:
        """Amplitudes (speed, order) [N m] of the orders that the response lists."""
        turns = response.angular_frequency
        return self._of(response.torque, response.rotation[:, :, self.point[0]] * -(turns**2))

    def peak(self, response: OrderResponse) -> Array:
        """Largest |mean + vibratory| torque (speed,) [N m], phases counted."""
        spectrum, topo = response.spectrum, self.assembly.topology
        places, (point, _) = spectrum.channels, self.point
        rotation = spectrum.amplitude[..., places.point.start + point] + spectrum.base[..., point]
        whole = self._of(spectrum.amplitude[..., places.torque], rotation * -(spectrum.angular_frequency**2))
        loads = mean_loads(topo, self.assembly.packed.column, self.assembly.table(len(response.speed), response.speed))
        mean = sum(factor * response.mean_torque[:, e] for e, factor in self.springs)
        own = list(self.stations)
        mean = mean + loads[:, own] @ (np.abs(topo.mean_speeds[own]) / topo.mean_speeds[self.link])
        return spectrum.extremes(whole[..., None], self.sense * np.reshape(mean, (-1, 1))).largest[:, 0]

    def _of(self, torque: Complex, acceleration: Complex) -> Complex:
        found = self.inertia / self.point[1] * acceleration
        for e, factor in self.springs:
            found = found + factor * torque[..., e]
        return np.asarray(self.sense * found)


def clutch_torque(assembly: Assembly, name: str) -> ClutchTorque | None:
    """The torque of the clutch of that name; None where neither side tells it."""
    topo, place = assembly.topology, assembly.line.index(name)
    clutch = assembly.line.elements[place]
    assert isinstance(clutch, SlipClutch)
    link = next((s for s, at in sticking_clutches(assembly.packed, topo) if at == place), None)
    if link is None or topo.graph:
        return None
    group = topo.group_of(link)
    members = [s for s, station in enumerate(topo.stations) if station.group == group]
    beyond = set(stations_beyond(topo, link).tolist())
    numbers = assembly.coefficients(assembly.table(1), free_play=True, any_frequency=True)
    for sense, side in ((1, [s for s in members if s in beyond]), (-1, [s for s in members if s not in beyond])):
        found = _told_by(assembly, side, link, numbers)
        if found is not None:
            return ClutchTorque(assembly, name, clutch.torque * clutch.last_share, sense, *found, tuple(side), link)
    return None


def _told_by(
    assembly: Assembly, side: list[int], link: int, numbers: LineCoefficients
) -> tuple[float, tuple[int, float], tuple[tuple[int, float], ...]] | None:
    """Inertia, point and springs of a side; None where it does not tell."""
    topo = assembly.topology
    if not side or topo.prescribed[topo.group_of(link)]:
        return None
    # An angled joint between would vary the ratios.
    laws = zip(topo.joints, joint_laws(assembly, assembly.table(1)), strict=True)
    if any(s in side and law.nonuniform for s, law in laws):
        return None
    shaken = {torque.station for torque in disk_torques(assembly) if torque.acts}
    if any(s in shaken or numbers.viscous[0, s] or numbers.quadratic[0, s] for s in side):
        return None
    inertia = numbers.inertia[0]
    faster = {s: float(topo.speed_ratio[s] / topo.speed_ratio[link]) for s in side}
    moment = sum(float(inertia[s]) * faster[s] ** 2 for s in side)
    at = next(((k, faster[s]) for k, (s, _) in enumerate(topo.points) if s in side), None)
    if at is None:
        return None
    springs = [(e, -faster[c.near]) for e, c in enumerate(topo.compliances) if c.near in side]
    springs += [(e, faster[s]) for e, c in enumerate(topo.compliances) if (s := topo.reference[c.far_group]) in side]
    return moment, at, tuple(springs)

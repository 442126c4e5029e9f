"""How the stations of a line turn while it moves: a rigid part, what is seen of a line whose shafts do not twist, and a
deviation from it, which may be drawn larger than it is."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.elements import Element
from trunnion.driveline.shafts import Elastic
from trunnion.driveline.stages import PiecewiseShaft
from trunnion.equations.coefficients import Assembly
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import LinkKind, Topology

TO_BE_SEEN = np.deg2rad(14.0)
"""How far the largest deviation or twist is drawn [rad]."""


@dataclass(frozen=True)
class Movement:
    """One motion of a line.

    time (frame,) [s]; rigid (frame, station) [rad]; deviation (frame, station) [rad] and torque (frame, spring) [N m],
    positive with the twist. With a ``growth`` λ [1/s] they are complex, and Re[deviation e^{λt}] is what moves.
    ``repeats``: the last frame is the first again, whole turns aside. ``arbitrary``: the deviation is 1 rad where it is
    largest, which says nothing; ``factor``: by what it is multiplied, ``slow``: how many times slower than
    it is it plays, both at first.
    """

    title: str
    said: str
    time: Array
    rigid: Array
    deviation: Array | Complex
    torque: Array | Complex
    repeats: bool = True
    growth: complex | None = None
    arbitrary: bool = False
    factor: float = 1.0
    slow: float = 1.0
    notes: tuple[str, ...] = ()

    @property
    def angle(self) -> Array:
        """Angle of every station as it is (frame, station) [rad]."""
        return np.asarray(self.rigid + self.real(self.deviation))

    def real(self, part: Array | Complex) -> Array:
        """What is seen of a deviation or a torque (frame, …)."""
        if self.growth is None:
            return np.asarray(part.real)
        return np.asarray((part * np.exp(self.growth * self.time)[:, None]).real)


def rigid_angles(assembly: Assembly, table: Array, input_angle: Array) -> Array:
    """Angle of every station (time, station) [rad] where shafts do not twist, at angles of the input (time,) [rad]."""
    untwisted = assembly.coefficients(table, statically_twisted=False, any_frequency=True)
    return base_motion(assembly.topology, untwisted, input_angle).angle[0]


def constants(topo: Topology, coefficients: LineCoefficients) -> Array:
    """What forks and crosses add to the angle of every station (station,) [rad], where equations of motion count it
    from the line at rest."""
    found, laws = np.zeros(len(topo.stations)), iter(coefficients.joints)
    for s, station in enumerate(topo.stations[1:], start=1):
        if station.link is LinkKind.SUM:
            found[s] = sum(float(share) * found[one] for one, share in station.of)
            continue
        found[s] = found[station.before]
        if station.link in (LinkKind.SHAFT, LinkKind.JOINT):
            found[s] += coefficients.shift[0, s]
        if station.link is LinkKind.JOINT:
            found[s] += next(laws).turned
        found[s] /= topo.ratio_values[s]
    return found


def station_deviation(topo: Topology, relative: Array, unknowns: Array | Complex) -> Array | Complex:
    """Of every station (time, station), of the unknowns (time, n), small: relative (time, station) is how fast it turns
    over its group's first."""
    moves = topo.unknown_of >= 0
    found: Array = np.zeros((len(unknowns), len(topo.stations)), dtype=unknowns.dtype)
    found[:, moves] = unknowns[:, topo.unknown_of[moves]] * np.broadcast_to(relative, found.shape)[:, moves]
    of_sums: dict[int, int] = {}
    for s, station in enumerate(topo.stations):
        if station.link is LinkKind.SUM:
            found[:, s] = np.sum([float(share) * found[:, one] for one, share in station.of], axis=0)
            of_sums[station.group] = s
        elif station.group in of_sums:  # tied to it: joints and ratios behind a leg
            over = np.broadcast_to(relative, found.shape)
            found[:, s] = found[:, station.before] * over[:, s] / over[:, station.before]
    return found


def with_massless(assembly: Assembly, deviation: Array | Complex) -> Array | Complex:
    """The same with points between massless shafts in series, which share the twist by their flexibility."""
    topo, found = assembly.topology, deviation.copy()
    for compliance in topo.compliances:
        if len(compliance.shafts) < 2:
            continue
        line = assembly.line
        soft = np.array([1 / stiffness_of(line.elements[i]) for i in compliance.shafts])
        far = topo.reference[compliance.far_group] if compliance.far is None else compliance.far
        at = np.cumsum(soft)[:-1] / soft.sum()
        for i, share in zip(compliance.shafts[:-1], at, strict=True):
            between = topo.behind[i, 0]
            found[:, between] = found[:, compliance.near] * (1 - share) + found[:, far] * share
    return found


def parted(assembly: Assembly, table: Array, angle: Array) -> tuple[Array, Array]:
    """Rigid part and deviation (time, station) of a true motion, whose ``angle`` (time, station) equations of motion
    count from the line at rest [rad].

    The rigid part follows the input where that is prescribed, else the line in front of all that slips, Σ Jρφ/Σ Jρ².
    What slips follows its own first shaft.
    """
    topo = assembly.topology
    untwisted = assembly.coefficients(table, statically_twisted=False, any_frequency=True)
    true = angle + constants(topo, untwisted)
    mean = topo.mean_speeds
    follows = angle[:, 0]
    if topo.free:
        heavy = untwisted.inertia[0] * mean
        heavy[np.concatenate([np.zeros(0, dtype=int), *(topo.stations_behind[e] for e in topo.dragged)])] = 0.0
        follows = angle @ heavy / (heavy @ mean)
    rigid = base_motion(topo, untwisted, follows).angle[0]
    for e in topo.dragged:
        compliance = topo.compliances[e]
        first = topo.reference[compliance.far_group]
        if compliance.far is not None or not mean[first]:
            continue
        behind = topo.stations_behind[e]
        slipped = (true[:, first] - rigid[:, first])[:, None]
        rigid[:, behind] += slipped * (mean[behind] / mean[first])
    return rigid, np.asarray(with_massless(assembly, true - rigid))


def stiffness_of(element: Element) -> float:
    """Of a spring [N m/rad], the stiffest stage of one with several; 0 of what is none."""
    if isinstance(element, PiecewiseShaft):
        return float(max(float(one) for one in element.stiffnesses))
    if not isinstance(element, Elastic):
        return 0.0
    return float(element.links(lambda key: getattr(element, key))[0][0])


def drawn_factor(topo: Topology, deviation: Array | Complex) -> float:
    """By how much to exaggerate, of 1, 2, 5, 10, …, so that the largest twist between neighbours is well seen."""
    near = [c.near for c in topo.compliances]
    far = [topo.reference[c.far_group] if c.far is None else c.far for c in topo.compliances]
    twist = np.abs(deviation[:, far] - deviation[:, near]).max(initial=0.0)
    swing = np.abs(deviation - deviation.mean(axis=0)).max(initial=0.0)
    largest = max(float(twist), float(swing) / 2)
    if not np.isfinite(largest) or largest <= 0:
        return 1.0
    wanted = TO_BE_SEEN / largest
    if wanted <= 1:
        return 1.0
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step <= wanted / power * (1 + 1e-9)))


def exaggerated(movement: Movement, topo: Topology) -> Movement:
    """The same with the factor that it is drawn with at first."""
    seen = movement.deviation if movement.growth is None else np.abs(movement.deviation)
    return replace(movement, factor=drawn_factor(topo, seen))

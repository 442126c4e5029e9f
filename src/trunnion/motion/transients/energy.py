"""Where the energy of a transient comes from and goes: kinetic and elastic at both ends, and the works between.

    change of kinetic and elastic energy = work of applied torques, excitation and input − loads − friction − losses

Works are integrals of torque times speed over every step, by Gauss's rule on the dense output. Losses in linear springs
are those of their dampers; in springs with stages and in clutches they are what goes in and is not stored. What the two
sides differ by measures the integration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.applied_torques import PlacedFriction, PlacedTorque
from trunnion.equations.line_regimes import line_kernel
from trunnion.equations.stage_laws import has_stages, stage_law
from trunnion.motion.transients.place import Piece

NODES = 6
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(NODES)


@dataclass(frozen=True)
class EnergyBalance:
    """Energies and works [J] of a transient from its begin to its end.

    kinetic, elastic: gained; applied: by torques applied; excitation: by harmonic torques; input: by a prescribed one;
    loads: taken by them, what drives with a share give deducted; friction: taken on disks; losses: taken by shafts,
    meshes and clutches; turned_over: all of it without signs.
    """

    kinetic: float
    elastic: float
    applied: float
    excitation: float
    input: float
    loads: float
    friction: float
    losses: float
    turned_over: float

    @property
    def residual(self) -> float:
        """What the balance lacks [J]."""
        given = self.applied + self.excitation + self.input
        return self.kinetic + self.elastic + self.loads + self.friction + self.losses - given

    @property
    def error(self) -> float:
        """The same over all that was turned over."""
        return abs(self.residual) / self.turned_over if self.turned_over else 0.0


def energy_balance(pieces: Sequence[Piece]) -> EnergyBalance:
    """The balance of a whole motion."""
    total, turned = np.zeros(8), 0.0
    for piece in pieces:
        if piece.trajectory.steps:
            works, over = _of_piece(piece)
            total, turned = total + works, turned + over
    return EnergyBalance(*(float(one) for one in (*total, turned)))


def applied_torques(piece: Piece, times: Array, states: Array, angle: Array, speed: Array) -> Array:
    """Torque of every applied torque and friction (time, torque) [N m], in the rotation of its station; ``states``
    (time, state), of which the last are those of torques that lag."""
    core, numbers = line_kernel(), piece.numbers
    at, found = int(numbers[core.APPLIED_AT]), []
    for one in piece.acting:
        row = numbers[at : at + core.PER_APPLIED]
        station, sense = int(row[core.PLACE]), row[core.SENSE]
        if row[core.CORNER]:
            first = states.shape[1] - int(numbers[core.LAGS])
            found.append(row[core.WAY] * states[:, first + int(row[core.LAGGED])])
            at += core.PER_APPLIED
            continue
        if int(row[core.FIRST]) >= core.FORMULA:
            own_speed, own_angle = sense * speed[:, station], sense * angle[:, station]
            found.append(row[core.WAY] * _programmed(one, row, numbers, times, own_speed, own_angle))
            at += core.PER_APPLIED
            continue
        variables = [np.zeros(len(times)), times, sense * speed[:, station], sense * angle[:, station]]
        u = variables[int(row[core.FIRST])] - row[core.FROM_FIRST]
        v = variables[int(row[core.SECOND])] - row[core.FROM_SECOND]
        above = row[core.NUMERATOR : core.DENOMINATOR].reshape(core.POWERS, core.POWERS)
        below = np.polynomial.polynomial.polyval(v, row[core.DENOMINATOR : core.CORNER])
        found.append(row[core.WAY] * np.polynomial.polynomial.polyval2d(u, v, above) / below)
        at += core.PER_APPLIED
    return np.array(found).reshape(-1, len(times)).T


def _programmed(
    one: PlacedTorque | PlacedFriction, row: Array, numbers: Array, times: Array, speed: Array, angle: Array
) -> Array:
    """A formula, or a function in Python, along a motion (time,)."""
    core, out = line_kernel(), np.empty(len(times))
    if int(row[core.FIRST]) == core.FORMULA:
        core.formulas(numbers, int(row[core.FROM_FIRST]), np.ascontiguousarray(times), speed, angle, out)
        return out
    assert isinstance(one, PlacedTorque) and one.called is not None
    places = np.transpose([times, speed, angle]).tolist()
    return np.array([one.called.value(*place) for place in places])


def station_angles(piece: Piece, times: Array, rotation: Array) -> Array:
    """Angle of every station (time, station) [rad], of its deviations from the reference."""
    core, numbers = line_kernel(), piece.numbers
    since = times - numbers[core.SINCE]
    reference = numbers[core.THETA] + (numbers[core.OMEGA] + numbers[core.ALPHA] * since / 2) * since
    return np.asarray(piece.line.assembly.topology.mean_speeds * reference[:, None] + rotation)


def _of_piece(piece: Piece) -> tuple[Array, float]:
    core, line, run = line_kernel(), piece.line, piece.trajectory
    topo, numbers = line.assembly.topology, piece.numbers
    half = run.length[:, None] / 2
    times = (run.start[:, None] + half * (1 + _GAUSS)).ravel()
    weights = (half * _WEIGHTS).ravel()
    moves, prescribed = topo.unknown_of >= 0, topo.unknown_of < 0
    states = run.at(times)
    motion, speed = line.moving(times, states, numbers, piece.regime_at(times))
    angle = station_angles(piece, times, motion.rotation)
    stations = numbers[core.HEAD : core.HEAD + len(topo.stations) * core.PER_STATION].reshape(-1, core.PER_STATION)
    load = stations[:, core.LOAD] + (stations[:, core.VISCOUS] + stations[:, core.QUADRATIC] * np.abs(speed)) * speed
    own = applied_torques(piece, times, states, angle, speed)
    places = [one.station for one in piece.acting]
    power = own * speed[:, places]
    rubs = np.array([getattr(one.stated, "rubs", True) for one in piece.acting], dtype=bool)
    near = [c.near for c in topo.compliances]
    far = [topo.reference[c.far_group] for c in topo.compliances]
    given = motion.torque * (speed[:, far] - speed[:, near])
    at_input = -(motion.torque * speed[:, near])[:, prescribed[near]].sum(axis=1)
    at_input += (motion.torque * speed[:, far])[:, prescribed[far]].sum(axis=1)
    works = {
        "applied": power[:, ~rubs].sum(axis=1),
        "excitation": _excitation(piece, times, angle, speed),
        "input": at_input,
        "loads": (load * speed)[:, moves].sum(axis=1),
        "friction": -power[:, rubs].sum(axis=1),
    }
    ends = run.time_of_state[[0, -1]]
    last, moving = line.moving(ends, run.state[[0, -1]], numbers, run.regime[[0, -1]])
    inertia = np.where(moves, stations[:, core.INERTIA], 0.0)
    kinetic = float(np.diff(np.square(moving) @ inertia / 2)[0])
    elastic, losses = _springs(piece, last.twist, run.state[[0, -1]], given, speed, weights, near, far)
    values = {key: float(weights @ power) for key, power in works.items()}
    # Of what drives and what resists in one sum each part is turned over by itself.
    apart = np.abs(power).sum(axis=1) + np.abs((load * speed)[:, moves]).sum(axis=1)
    apart += np.abs(works["excitation"]) + np.abs(works["input"])
    turned = float(weights @ apart) + abs(kinetic) + abs(elastic)
    total = [kinetic, elastic, *values.values(), losses]
    return np.array(total), turned


def _excitation(piece: Piece, times: Array, angle: Array, speed: Array) -> Array:
    """Power of the harmonic torques on stations that move (time,) [W]."""
    core, numbers, topo = line_kernel(), piece.numbers, piece.line.assembly.topology
    first, found = int(core.places(numbers)[1]), np.zeros(len(times))
    for h in range(int(numbers[core.HARMONICS])):
        row = numbers[first + h * core.PER_HARMONIC : first + (h + 1) * core.PER_HARMONIC]
        station = int(row[core.AT])
        if topo.unknown_of[station] >= 0:
            argument = row[core.ANGLE] + row[core.FREQUENCY] * times + row[core.ORDER] * angle[:, station]
            found += row[core.AMPLITUDE] * np.cos(argument) * speed[:, station]
    return found


def _springs(
    piece: Piece, twist: Array, states: Array, given: Array, speed: Array, weights: Array, near: list[int],
    far: list[int],
) -> tuple[float, float]:  # fmt: skip
    """Elastic energy gained and energy lost in the springs [J]; ``given`` (time, spring) is what they take."""
    line, core, numbers = piece.line, line_kernel(), piece.numbers
    assembly, topo, n = line.assembly, line.assembly.topology, line.assembly.topology.size
    first = int(core.places(numbers)[0])
    rows = numbers[first : first + len(topo.compliances) * core.PER_COMPLIANCE].reshape(-1, core.PER_COMPLIANCE)
    elastic, losses = 0.0, 0.0
    rubbed = {slider.compliance for slider in line.sliders} | {clutch.compliance for clutch in line.clutches}
    turned = {one.compliance: one for one in line.converters}
    for e, compliance in enumerate(topo.compliances):
        place = compliance.shafts[0]
        if has_stages(assembly.line.elements[place]):
            law = stage_law(assembly.line, place, assembly.packed.column, assembly.table(1)).first
            stored = float(np.diff(law.energy(twist[:, e]))[0])
        else:
            stored = float(np.diff(rows[e, core.STIFFNESS] * twist[:, e] ** 2 / 2)[0])
        for s, slider in enumerate(line.sliders):
            if slider.compliance == e:
                stored += float(np.diff(slider.stiffness * states[:, 2 * n + s] ** 2 / 2)[0])
        elastic += stored
        if e in turned:
            one = turned[e]
            ends = [one.sense * speed[:, station] for station in (one.pump, one.turbine)]
            takes, gives = one.torques(*ends)
            losses += float(weights @ (takes * ends[0] - gives * ends[1]))
        elif rows[e, core.LAW] == 0.0 and e not in rubbed:
            losses += float(weights @ (rows[e, core.DAMPING] * (speed[:, far[e]] - speed[:, near[e]]) ** 2))
        else:
            losses += float(weights @ given[:, e]) - stored
    return elastic, losses

"""The numbers that the equations of a line hold, over a box of speeds and tolerances.

Parameter 1 is the speed, Ω = middle + p₁ half; the others are tolerances, from −1 at the low end of the box to 1 at the
high one. Which numbers go with which tolerance, and that they do so linearly, follows from what the number is
(``AFFINE``); two tolerances of one element may multiply. An inertia alone on its unknown is parametrised by its
inverse, so that the equations are linear in it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.elements import Element
from trunnion.driveline.joints import HookeJoint
from trunnion.driveline.parameters import Columns
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.stage_laws import has_stages
from trunnion.errors import InputError
from trunnion.floquet.certificate.waves import OUTWARD, Wave, affine

STATED = 1e-13
"""What numbers of a line may be wrong by, relative: how they follow from a description is not enclosed."""
AFFINE = (
    "stiffness", "damping", "mesh_stiffness", "mesh_damping", "loss_factor", "inertia", "fork_offset", "plane",
    "load_torque", "viscous_load", "quadratic_load",
)  # fmt: skip
"""Numbers that the equations' own are linear in, one at a time."""
ANGLE = "angle"
STEEPEST = np.pi / 3
"""Largest angle that may scatter [rad]."""


@dataclass(frozen=True)
class NumberRange:
    """One number of a line from ``low`` to ``high``, SI units."""

    label: str
    columns: Columns
    low: float
    high: float


@dataclass(frozen=True)
class BoxCoefficients:
    """Waves without harmonics: of every compliance, station and joint as ``LineCoefficients`` has them.

    ``over_mass`` : 1/M of unknowns whose tolerance is parametrised by it, by unknown.
    """

    speed: Wave
    stiffness: list[Wave]
    damping: list[Wave]
    torque: list[Wave]
    inertia: list[Wave]
    constant: list[Wave]
    viscous: list[Wave]
    quadratic: list[Wave]
    tangents: dict[int, Wave]
    shift: list[Wave]
    over_mass: dict[int, Wave]
    middle: LineCoefficients


def box_coefficients(
    assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange], last: int
) -> BoxCoefficients:
    """Of the box from ``speeds[0]`` to ``speeds[1]`` and over all ``ranges``, as waves of ``last`` harmonics."""
    topo, many = assembly.topology, 1 + len(ranges)
    table = assembly.table(1 + 2 * len(ranges), sum(speeds) / 2)
    for k, one in enumerate(ranges):
        values = np.full(len(table), (one.low + one.high) / 2)
        values[1 + 2 * k], values[2 + 2 * k] = one.low, one.high
        one.columns.put(table, values)
    co = assembly.coefficients(table, statically_twisted=False)
    extra = _products(assembly, table, co, ranges)

    def waves(values: Array, products: Array | None = None) -> list[Wave]:
        """Of numbers (row, k), linear in each parameter."""
        found = []
        for k, column in enumerate(values.T):
            slopes = {2 + j: (column[2 + 2 * j] - column[1 + 2 * j]) / 2 for j in range(len(ranges))}
            kept = {v: float(slope) for v, slope in slopes.items() if slope}
            rest = STATED * float(np.abs(column).max()) + (0.0 if products is None else float(products[k]))
            found.append(affine(float(column[0]), kept, many, last, rest))
        return found

    half = (speeds[1] - speeds[0]) / 2
    # Exactly what it says: the ends are moved outward by more than rounding makes of the middle.
    speed = affine(sum(speeds) / 2, {1: half * OUTWARD} if half else {}, many, last)
    stiffness, damping = waves(co.stiffness), waves(co.damping, extra)
    constant, viscous, quadratic = waves(co.load), waves(co.viscous), waves(co.quadratic)
    torque = _torques(assembly, speed, constant, viscous, quadratic)
    shift = waves(co.shift)
    for e, compliance in enumerate(topo.compliances):
        _put_twists(assembly, co, e, compliance.shafts, stiffness[e], torque[e], shift, compliance.number)
    inertia, over_mass = waves(co.inertia), _inverses(assembly, co, ranges, many, last)
    tangents = {s: _tangent(assembly, s, ranges, many, last) for s in topo.joints}
    kept_tangents = {s: wave for s, wave in tangents.items() if wave is not None}
    middle = assembly.coefficients(table[:1])
    return BoxCoefficients(
        speed=speed, stiffness=stiffness, damping=damping, torque=torque, inertia=inertia, constant=constant,
        viscous=viscous, quadratic=quadratic, tangents=kept_tangents, shift=shift, over_mass=over_mass, middle=middle,
    )  # fmt: skip


def _products(assembly: Assembly, table: Array, co: LineCoefficients, ranges: Sequence[NumberRange]) -> Array:
    """What two tolerances of one element make of every damping together (compliance,): c = ηk/ω is linear in each."""
    found = np.zeros(co.damping.shape[1])
    for a, b in combinations(range(len(ranges)), 2):
        if not set(_elements(assembly, ranges[a])) & set(_elements(assembly, ranges[b])):
            continue
        both = table[:1].copy()
        ranges[a].columns.put(both, ranges[a].high)
        ranges[b].columns.put(both, ranges[b].high)
        together = assembly.coefficients(both, statically_twisted=False).damping[0]
        found += np.abs(together - co.damping[2 + 2 * a] - co.damping[2 + 2 * b] + co.damping[0]) * OUTWARD
    return found


def _elements(assembly: Assembly, one: NumberRange) -> list[int]:
    place = list(assembly.packed.place)
    return [place[column][0] for column in one.columns.index.tolist()]


def _torques(
    assembly: Assembly, speed: Wave, constant: list[Wave], viscous: list[Wave], quadratic: list[Wave]
) -> list[Wave]:
    """Static torque of every compliance: what stations behind it resist with at their mean speeds."""
    topo, found = assembly.topology, []
    for e, behind in enumerate(topo.stations_behind):
        own = topo.mean_speeds[topo.reference[topo.compliances[e].far_group]]
        torque = speed * 0.0
        for s in behind.tolist():
            if not (constant[s].size or viscous[s].size or quadratic[s].size):
                continue
            turning = speed * abs(float(topo.mean_speeds[s]))
            load = constant[s] + (viscous[s] + quadratic[s] * turning) * turning
            torque = torque + load * (-abs(float(topo.mean_speeds[s])) / float(own))
        found.append(torque)
    return found


def _put_twists(
    assembly: Assembly,
    co: LineCoefficients,
    e: int,
    shafts: tuple[int, ...],
    stiffness: Wave,
    torque: Wave,
    shift: list[Wave],
    number: int,
) -> None:
    """Add to the shift behind each shaft of a compliance the twist that its torque makes."""
    from trunnion.equations.coefficients import shaft_stiffness

    topo = assembly.topology
    staged = _staged(assembly.line.elements[shafts[0]])
    for i in shafts:
        if (i, number) not in topo.behind or not (torque.size or staged):
            continue
        behind = topo.behind[i, number]
        if staged:
            row = assembly.table(1, float(co.speed[0]))
            twist = float(assembly.coefficients(row).twist[0, e])
            shift[behind] = shift[behind] + affine(twist, {}, shift[behind].parts.shape[0] - 1, shift[behind].last)
        elif len(shafts) == 1:
            shift[behind] = shift[behind] + torque * stiffness.inverse()
        else:
            own = float(shaft_stiffness(assembly, assembly.table(1, float(co.speed[0])), i, number)[0])
            shift[behind] = shift[behind] + torque * (1 / own)


def _inverses(
    assembly: Assembly, co: LineCoefficients, ranges: Sequence[NumberRange], many: int, last: int
) -> dict[int, Wave]:
    """1/M of every unknown that turns all its inertia evenly and has one tolerance of them."""
    topo, found = assembly.topology, dict[int, Wave]()
    for i, g in enumerate(g for g, c in enumerate(topo.coordinate) if c >= 0):
        own = [s for s, one in enumerate(topo.stations) if one.group == g and co.inertia[:, s].any()]
        if own != [topo.reference[g]]:
            continue
        mass = co.inertia[:, own[0]]
        moved = [j for j in range(len(ranges)) if mass[1 + 2 * j] != mass[2 + 2 * j]]
        if len(moved) == 1:
            ends = 1 / mass[1 + 2 * moved[0]], 1 / mass[2 + 2 * moved[0]]
            middle, half = (ends[0] + ends[1]) / 2, (ends[1] - ends[0]) / 2
            found[i] = affine(float(middle), {2 + moved[0]: float(half)}, many, last, STATED * float(max(ends)))
    return found


def _tangent(assembly: Assembly, s: int, ranges: Sequence[NumberRange], many: int, last: int) -> Wave | None:
    """t = tan²(β/2) of a Hooke's joint whose angle β scatters, to second order; None of any other."""
    place = assembly.topology.stations[s].element
    for j, one in enumerate(ranges):
        labels = [list(assembly.packed.place)[column] for column in one.columns.index.tolist()]
        if (place, ANGLE) not in labels:
            continue
        k = labels.index((place, ANGLE))
        ends = [float(one.columns.offset[k] + one.columns.slope[k] * v) for v in (one.low, one.high)]
        beta, half = sum(ends) / 2, (ends[1] - ends[0]) / 2
        h, most = beta / 2, max(abs(end) for end in ends) / 2
        over = 1 / np.cos(most) ** 2
        second = 0.5 * over * (over + 2 * np.tan(most) ** 2) * half**2 / 2
        slope = np.tan(h) / np.cos(h) ** 2 * half
        value = np.tan(h) ** 2
        return affine(
            float(value), {2 + j: float(slope)}, many, last, float(second * OUTWARD + STATED * (value + 1e-3))
        )
    return None


def require_linear(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> None:
    """Refuse tolerances in which the equations are not linear, and what changes its kind with the speed.

    Raises
    ------
    InputError : names the parameter or the element, and the value.
    """
    line, topo, place = assembly.line, assembly.topology, list(assembly.packed.place)
    for one in ranges:
        for k, column in enumerate(one.columns.index.tolist()):
            element, key = place[column]
            owner = line.elements[element] if element >= 0 else None
            hooke = key == ANGLE and isinstance(owner, HookeJoint)
            if (key not in AFFINE and not hooke) or owner is None:
                raise InputError(
                    "cannot scatter in a certificate", key=one.label,
                    remedy="stiffness, damping, inertia, fork_offset, plane, loads, and the angle of a HookeJoint can; "
                    "tolerance_study takes every number",
                )  # fmt: skip
            ends = [float(one.columns.offset[k] + one.columns.slope[k] * v) for v in (one.low, one.high)]
            if hooke and max(abs(end) for end in ends) >= STEEPEST:
                worst = max(ends, key=abs)
                raise InputError("may reach 60° at most in a certificate", key=one.label, value=worst)
            if hooke and topo.free:
                raise InputError(
                    "would bend a free–free line, which then moves in its own periodic motion", key=one.label,
                    remedy="put a ConstantSpeed in front",
                )  # fmt: skip
            _require_single(assembly, one, element, key)
            if key in ("damping", "mesh_damping") and ends[0] * ends[1] <= 0:
                raise InputError(
                    f"would go from {one.low:.6g} to {one.high:.6g}, and damping that reaches zero cannot be certified",
                    key=one.label, remedy="keep it on one side of zero",
                )  # fmt: skip
    _require_even(assembly, speeds)
    loaded = any(place[c][1] in AFFINE[-3:] for one in ranges for c in one.columns.index.tolist())
    co = assembly.coefficients(assembly.table(1, speeds[1]))
    by_speed = bool(co.viscous.any() or co.quadratic.any())
    for compliance, torque in zip(topo.compliances, co.torque[0], strict=True):
        element = line.elements[compliance.shafts[0]]
        if _staged(element) and torque and (loaded or (by_speed and speeds[0] < speeds[1])):
            raise InputError(
                "has stages, and its load varies within the box: whether it stays in one stage is not followed",
                element=line.names[compliance.shafts[0]], value=float(torque),
                remedy="write a Shaft of its stiffness under load, or give one speed and no tolerance of loads",
            )  # fmt: skip
    for name, element in line.parts:
        if isinstance(element, SlipClutch) and (loaded or by_speed) and co.torque.any():
            raise InputError(
                "may slip where the load varies within the box, which a certificate does not follow", element=name,
                key="torque", value=element.torque, remedy="write a Ratio of 1 in its place",
            )  # fmt: skip


def _staged(element: Element) -> bool:
    """Whether stiffness or damping of a spring depend on what it carries: not of a mesh without play."""
    alike = len(getattr(element, "stiffnesses", ())) <= 1 and not getattr(element, "total_backlash", 0.0)
    return has_stages(element) and not (alike and not getattr(element, "impact_damping", 0.0))


def _require_single(assembly: Assembly, one: NumberRange, element: int, key: str) -> None:
    """Refuse what scatters in springs in series or with stages, of which only the whole enters the equations."""
    for compliance in assembly.topology.compliances:
        if element not in compliance.shafts or key in ("fork_offset", "plane", "inertia"):
            continue
        if len(compliance.shafts) > 1 and key in ("stiffness", "damping", "loss_factor"):
            raise InputError(
                "belongs to one of several springs in series, and what scatters in a certificate must be a spring of "
                "its own", key=one.label, remedy="write them as one Shaft, or put a Disk between",
            )  # fmt: skip
        staged = _staged(assembly.line.elements[element]) and key != "mesh_damping"
        if staged and (key != "mesh_stiffness" or assembly.coefficients(assembly.table(1, 1.0)).torque.any()):
            raise InputError(
                "belongs to a spring with stages, and cannot scatter in a certificate under load", key=one.label,
                remedy="write a Shaft of its stiffness under load",
            )  # fmt: skip


def _require_even(assembly: Assembly, speeds: tuple[float, float]) -> None:
    """Refuse what takes another stiffness, damping or load with every speed: curves of machines, pendulums."""
    table = assembly.table(3)
    table[:, 0] = speeds[0], sum(speeds) / 2, speeds[1]
    co = assembly.coefficients(table, statically_twisted=False)
    checks: list[tuple[Array, Callable[[int], int]]] = [
        (co.stiffness, lambda e: assembly.topology.compliances[e].shafts[0]),
        (co.damping, lambda e: assembly.topology.compliances[e].shafts[0]),
        *((part, _rotor_at(assembly)) for part in (co.viscous, co.quadratic)),
    ]
    if any(law.nonuniform for law in co.joints):  # elsewhere a constant load moves nothing
        checks.append((co.load, _rotor_at(assembly)))
    for part, element in checks:
        spread = np.ptp(part, axis=0)
        worst = int(spread.argmax()) if spread.size else 0
        if spread.size and spread[worst] > 1e-12 * np.abs(part).max():
            raise InputError(
                "goes with the speed along a curve of its own, which a certificate over a range of speeds does not "
                "enclose", element=assembly.line.names[element(worst)], value=float(part[0, worst]),
                remedy="state its tangent, a viscous_load or quadratic_load",
            )  # fmt: skip


def _rotor_at(assembly: Assembly) -> Callable[[int], int]:
    at = dict(assembly.topology.disks)
    return lambda station: at.get(station, assembly.topology.stations[station].element)

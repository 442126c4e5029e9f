"""The numbers that the equations of a line hold, over a box of speeds and tolerances.

Parameter 1 is the speed, Ω = middle + p₁ half; the others are tolerances, from −1 at the low end of the box to 1 at the
high one. Which numbers go with which tolerance, and that they do so linearly, follows from what the number is and is
checked (``requirements``); two tolerances of one element may multiply. An inertia alone on its unknown is parametrised
by its inverse, so that the equations are linear in it: then so are all that its tolerance moves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.elements import Element
from trunnion.driveline.parameters import Columns
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.loads import given_shares
from trunnion.equations.stage_laws import has_stages
from trunnion.floquet.certificate.waves import OUTWARD, Terms, Wave, affine

STATED = 1e-13
"""What numbers of a line may be wrong by, relative: how they follow from a description is not enclosed."""
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

    ``untwisted_shift`` : without static twist. ``over_mass`` : 1/M of unknowns whose tolerance is parametrised by it,
    by unknown.
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
    untwisted_shift: list[Wave]
    over_mass: dict[int, Wave]
    middle: LineCoefficients

    def each(self, made: Callable[[Wave], Wave]) -> BoxCoefficients:
        """With what is made of every wave."""
        found: dict[str, Any] = {}
        for name, value in vars(self).items():
            if isinstance(value, Wave):
                found[name] = made(value)
            elif isinstance(value, list):
                found[name] = [made(one) for one in value]
            elif isinstance(value, dict):
                found[name] = {key: made(one) for key, one in value.items()}
        return replace(self, **found)


def box_coefficients(
    assembly: Assembly,
    speeds: tuple[float, float],
    ranges: Sequence[NumberRange],
    last: int,
    terms: Terms | None = None,
    near: Wave | None = None,
) -> BoxCoefficients:
    """Of the box from ``speeds[0]`` to ``speeds[1]`` and over all ``ranges``, as waves of ``last`` harmonics and
    ``terms``, where products of parameters are followed.

    ``near`` : nearly the speed, in place of it, for torques that are no more than what others are counted from.
    """
    topo, many = assembly.topology, 1 + len(ranges) if terms is None else len(terms) - 1
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
            found.append(affine(float(column[0]), kept, many, last, rest, terms))
        return found

    half = (speeds[1] - speeds[0]) / 2
    # Exactly what it says: the ends are moved outward by more than rounding makes of the middle.
    speed = affine(sum(speeds) / 2, {1: half * OUTWARD} if half else {}, many, last, terms=terms)
    stiffness, damping = waves(co.stiffness), waves(co.damping, extra)
    constant, viscous, quadratic = waves(co.load), waves(co.viscous), waves(co.quadratic)
    torque = _torques(assembly, near or speed, constant, viscous, quadratic, table[:1])
    if near:
        torque = [Wave(one.parts, 0.0, one.terms) for one in torque]
    shift, untwisted_shift = waves(co.shift), waves(co.shift)
    middle = assembly.coefficients(table[:1])
    for e in range(len(topo.compliances)):
        _put_twists(assembly, middle, e, stiffness[e], torque[e], shift)
    inertia, over_mass = waves(co.inertia), _inverses(assembly, co, ranges, many, last, terms)
    tangents = {s: _tangent(assembly, s, ranges, many, last, terms) for s in topo.joints}
    kept_tangents = {s: wave for s, wave in tangents.items() if wave is not None}
    return BoxCoefficients(
        speed=speed, stiffness=stiffness, damping=damping, torque=torque, inertia=inertia, constant=constant,
        viscous=viscous, quadratic=quadratic, tangents=kept_tangents, shift=shift,
        untwisted_shift=untwisted_shift, over_mass=over_mass, middle=middle,
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
    assembly: Assembly, speed: Wave, constant: list[Wave], viscous: list[Wave], quadratic: list[Wave], row: Array
) -> list[Wave]:
    """Static torque of every compliance: what stations behind it resist with at their mean speeds."""
    topo, found = assembly.topology, []
    loads = dict[int, Wave]()
    for s in range(len(topo.stations)):
        if constant[s].size or viscous[s].size or quadratic[s].size:
            turning = speed * abs(float(topo.mean_speeds[s]))
            load = constant[s] + (viscous[s] + quadratic[s] * turning) * turning
            loads[s] = load * abs(float(topo.mean_speeds[s]))
    # Constants hold what drives carry at the middle speed: they carry what is out of balance at others too.
    share = given_shares(topo, assembly.packed.column, row)[0] if topo.free else np.zeros(len(topo.stations))
    unbalanced = sum(loads.values(), speed * 0.0) if share.any() else speed * 0.0
    for e, behind in enumerate(topo.stations_behind):
        own = float(topo.mean_speeds[topo.reference[topo.compliances[e].far_group]])
        torque = speed * 0.0
        for s in behind.tolist():
            if s in loads:
                torque = torque + loads[s] * (-1 / own)
            if share[s]:
                torque = torque + unbalanced * (float(share[s] / share.sum()) / own)
        found.append(torque)
    return found


def _put_twists(
    assembly: Assembly, middle: LineCoefficients, e: int, stiffness: Wave, torque: Wave, shift: list[Wave]
) -> None:
    """Add to the shift behind each shaft of a compliance the twist that its torque makes."""
    from trunnion.equations.coefficients import shaft_stiffness

    topo = assembly.topology
    shafts, number = topo.compliances[e].shafts, topo.compliances[e].number
    in_stage = staged(assembly.line.elements[shafts[0]])
    for i in shafts:
        if (i, number) not in topo.behind or not (torque.size or in_stage):
            continue
        behind = topo.behind[i, number]
        if in_stage:
            shift[behind] = shift[behind] + twist_in_stage(middle, e, stiffness, torque)
        elif len(shafts) == 1:
            shift[behind] = shift[behind] + torque * stiffness.inverse()
        else:
            own = float(shaft_stiffness(assembly, assembly.table(1, float(middle.speed[0])), i, number)[0])
            twisted = torque * (1 / own)
            shift[behind] = shift[behind] + Wave(twisted.parts, twisted.rest + STATED * twisted.size, twisted.terms)


def twist_in_stage(middle: LineCoefficients, e: int, stiffness: Wave, torque: Wave) -> Wave:
    """Twist [rad] of a spring with stages under ``torque`` in the stage of the ``middle``."""
    twist, carried = float(middle.twist[0, e]), float(middle.torque[0, e])
    found = (torque - carried) * stiffness.inverse() + twist
    return Wave(found.parts, found.rest + STATED * abs(twist), found.terms)


def _inverses(
    assembly: Assembly,
    co: LineCoefficients,
    ranges: Sequence[NumberRange],
    many: int,
    last: int,
    terms: Terms | None,
) -> dict[int, Wave]:
    """1/M of the unknowns that turn all their inertia evenly, where one tolerance moves them, and nothing else but
    such inertias in the same proportion: the numbers between its ends then follow one parameter."""
    topo, found = assembly.topology, dict[int, Wave]()
    groups = [g for g, c in enumerate(topo.coordinate) if c >= 0]
    own = [[s for s, one in enumerate(topo.stations) if one.group == g and co.inertia[:, s].any()] for g in groups]
    even = {stations[0]: i for i, (g, stations) in enumerate(zip(groups, own, strict=True))
            if stations == [topo.reference[g]]}  # fmt: skip
    felt = [s for stations in own for s in stations]
    moves = co.inertia[1::2] != co.inertia[2::2]
    others = co.stiffness, co.damping, co.load, co.viscous, co.quadratic, co.shift
    for j in range(len(ranges)):
        low, high = 1 + 2 * j, 2 + 2 * j
        moved = [s for s in felt if moves[j, s]]
        if any(s not in even or moves[:, s].sum() > 1 for s in moved):
            continue
        if any((part[low] != part[high]).any() for part in others):
            continue
        share = co.inertia[low, moved] / co.inertia[high, moved]
        if moved and np.ptp(share) > 1e-15 * share.max():
            continue
        for s in moved:
            ends = 1 / co.inertia[low, s], 1 / co.inertia[high, s]
            middle, half = (ends[0] + ends[1]) / 2, (ends[1] - ends[0]) / 2
            rest = STATED * float(max(ends))
            found[even[s]] = affine(float(middle), {2 + j: float(half)}, many, last, rest, terms)
    return found


def _tangent(
    assembly: Assembly, s: int, ranges: Sequence[NumberRange], many: int, last: int, terms: Terms | None
) -> Wave | None:
    """t = tan²(β/2) of a Hooke's joint whose angle β scatters, to second order, or to third where ``terms`` has the
    square of its tolerance; None of any other."""
    place = assembly.topology.stations[s].element
    for j, one in enumerate(ranges):
        labels = [list(assembly.packed.place)[column] for column in one.columns.index.tolist()]
        if (place, ANGLE) not in labels:
            continue
        k = labels.index((place, ANGLE))
        ends = [float(one.columns.offset[k] + one.columns.slope[k] * v) for v in (one.low, one.high)]
        h, half = sum(ends) / 4, (ends[1] - ends[0]) / 4  # of β/2
        value, most = np.tan(h) ** 2, np.tan(max(abs(end) for end in ends) / 2) ** 2
        slopes = {2 + j: float(2 * np.tan(h) * (1 + value) * half)}
        square = None if terms is None else terms.power(2 + j, 2)
        if square is None:
            left = (1 + most) * (1 + 3 * most) * half**2
        else:  # p² = (1 + T₂(p))/2
            second = float((1 + value) * (1 + 3 * value) * half**2)
            value, slopes[square] = value + second / 2, second / 2
            left = 4 / 3 * np.sqrt(most) * (2 + 3 * most) * (1 + most) * abs(half) ** 3
        rest = float(left * OUTWARD + STATED * (value + 1e-3))
        return affine(float(value), slopes, many, last, rest, terms)
    return None


def staged(element: Element) -> bool:
    """Whether stiffness or damping of a spring depend on what it carries: not of a mesh without play."""
    alike = len(getattr(element, "stiffnesses", ())) <= 1 and not getattr(element, "total_backlash", 0.0)
    return has_stages(element) and not (alike and not getattr(element, "impact_damping", 0.0))

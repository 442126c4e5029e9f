"""Springs with stages in a box: the stage in which each works under its load, and whether the whole box stays there.

Within a stage a spring is linear, so that a proof is of the stages in which the loads hold the springs. The torque of
a spring is a sum over loads, each linear in its tolerances and a polynomial of second degree of the speed, which lies
between its coefficients in Bernstein's form.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.gears import GearPair
from trunnion.equations.coefficients import Assembly
from trunnion.equations.mean_clutch import states_a_motion
from trunnion.equations.stage_laws import stage_law
from trunnion.errors import InputError
from trunnion.floquet.certificate.box_coefficients import STATED, NumberRange, staged

SPEEDS = 33
"""At which the load of a whole box is looked at."""
UNEVEN = 1e-12
"""By what share a load may differ from a polynomial and a sum."""
HALVINGS = 50
"""In which the speed is found at which a stage is left."""


@dataclass(frozen=True)
class WorkingStage:
    """Of a ``spring``, by its place among the compliances: its stage ``number`` of ``count``, by rising twist from 1,
    which reaches from ``low`` to ``high`` [N m] and from ``least`` to ``most`` [rad]."""

    spring: int
    name: str
    number: int
    count: int
    low: float
    high: float
    least: float
    most: float

    def holds(self, low: float, high: float) -> bool:
        """Whether all torques from ``low`` to ``high`` [N m] lie within it."""
        # The numbers of a line are right to a share of ``STATED``, and so are the ends of a stage.
        aside = 16 * STATED * max(abs(low), abs(high))
        return self.low < low - aside and high + aside < self.high

    def __str__(self) -> str:
        return f"{self.name} works in its stage {self.number} of {self.count}, {_reach(self.low, self.high)}"


def working_stages(assembly: Assembly, rows: Array) -> tuple[WorkingStage, ...]:
    """Of every spring with stages that follow the torque alone, under the mean loads of ``rows`` (row, columns): each
    once, spring by spring."""
    found: dict[WorkingStage, None] = {}
    springs = staged_springs(assembly) if len(rows) else []
    torque = assembly.static_torque(rows) if springs else np.zeros((len(rows), 0))
    for e in springs:
        for row, own in zip(rows, torque[:, e].tolist(), strict=True):
            found[_stage_under(assembly, row[None], e, own)] = None
    return tuple(found)


def staged_springs(assembly: Assembly) -> list[int]:
    """Those whose stiffness is that of the stage in which their mean load holds them."""
    line, found = assembly.line, []
    for e, compliance in enumerate(assembly.topology.compliances):
        element = line.elements[compliance.shafts[0]]
        if staged(element) and not follows_otherwise(assembly, e):
            found.append(e)
    return found


def follows_otherwise(assembly: Assembly, e: int) -> bool:
    """Whether a spring with stages takes stiffness or damping from its torque within a stage too: teeth that damp with
    the depth of their contact, clutches that state a motion."""
    element = assembly.line.elements[assembly.topology.compliances[e].shafts[0]]
    return states_a_motion(element) or (isinstance(element, GearPair) and bool(element.impact_damping))


def _stage_under(assembly: Assembly, row: Array, e: int, torque: float) -> WorkingStage:
    place = assembly.topology.compliances[e].shafts[0]
    law = stage_law(assembly.line, place, assembly.packed.column, row).first
    # Without torque: the stage in which twist 0 is.
    at = int(law.stage_under(torque)) if torque else int(law.stage(0.0))
    twists, torques = [-np.inf, *law.knots.tolist(), np.inf], [-np.inf, *law.at_knots.tolist(), np.inf]
    name = assembly.line.names[place]
    return WorkingStage(e, name, at + 1, len(law.slopes), torques[at], torques[at + 1], twists[at], twists[at + 1])


def torque_ranges(
    assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange]
) -> tuple[Array, Array]:
    """Bounds of the torque of every compliance (compliance,) [N m] over a box, from below and above."""
    low, high = speeds
    return _ends(_bernstein(_by_rows(assembly, np.array([low, (low + high) / 2, high]), ranges)))


def stages_held(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> bool:
    """Whether all of a box works in the stages of its middle."""
    if not staged_springs(assembly):
        return True
    low, high = torque_ranges(assembly, speeds, ranges)
    middle = rows_of_ranges(assembly, np.array([sum(speeds) / 2]), ranges)[:1]
    return all(one.holds(float(low[one.spring]), float(high[one.spring])) for one in working_stages(assembly, middle))


def rows_of_ranges(assembly: Assembly, speeds: Array, ranges: Sequence[NumberRange]) -> Array:
    """The line in the middle of all ``ranges`` at ``speeds``, then with one of them after another at both its ends."""
    middle = assembly.table(len(speeds), speeds)
    for one in ranges:
        one.columns.put(middle, np.full(len(speeds), (one.low + one.high) / 2))
    rows = [middle]
    for one in ranges:
        for end in (one.low, one.high):
            rows.append(middle.copy())
            one.columns.put(rows[-1], np.full(len(speeds), end))
    return np.concatenate(rows)


def _bernstein(values: Array) -> Array:
    """Coefficients (…, 3, k) of the polynomials of second degree through values at both ends and in the middle."""
    first, middle, last = values[..., 0, :], values[..., 1, :], values[..., 2, :]
    return np.stack([first, 2 * middle - (first + last) / 2, last], axis=-2)


def _ends(values: Array) -> tuple[Array, Array]:
    """Least and largest sum (k,) of a middle and what tolerances add to it: ``values`` (1 + 2 tolerances, speed, k)."""
    added = (values[1:] - values[:1]).reshape(-1, 2, *values.shape[1:])
    less = np.minimum(added.min(axis=(1, 2)), 0.0).sum(axis=0)
    more = np.maximum(added.max(axis=(1, 2)), 0.0).sum(axis=0)
    return values[0].min(axis=0) + less, values[0].max(axis=0) + more


def require_stages_held(assembly: Assembly, looked_at: Array, ranges: Sequence[NumberRange]) -> None:
    """Refuse a box, over speeds of which those ``looked_at`` tell, in which a load takes a spring out of the stage in
    which it works in the middle.

    Raises
    ------
    InputError : names the spring, its stage, and what it carries where it leaves that; or loads that are no such sums.
    """
    if not staged_springs(assembly):
        return
    _require_sums(assembly, looked_at, ranges)
    first, last = float(looked_at[0]), float(looked_at[-1])
    middle = (first + last) / 2
    for one in working_stages(assembly, rows_of_ranges(assembly, np.array([middle]), ranges)[:1]):

        def lost_at(speed: float, one: WorkingStage = one) -> bool:
            return not one.holds(*_carried(assembly, one.spring, speed, ranges))

        lost = [speed for speed in np.linspace(first, last, SPEEDS).tolist() if lost_at(speed)]
        if lost:
            at = min(lost, key=lambda speed: abs(speed - middle))
            low, high = _carried(assembly, one.spring, at, ranges)
            raise InputError(
                f"is the torque at {at:.6g} rad/s in the box, whose middle works in stage {one.number} of {one.count}, "
                f"{_reach(one.low, one.high)}, and a certificate is of one stage",
                element=one.name, value=low if one.holds(high, high) else high,
                remedy=_remedy(middle, at, lost_at),
            )  # fmt: skip


def _carried(assembly: Assembly, spring: int, speed: float, ranges: Sequence[NumberRange]) -> tuple[float, float]:
    """Least and largest torque of a spring at one speed."""
    low, high = _ends(assembly.static_torque(rows_of_ranges(assembly, np.array([speed]), ranges))[:, None, [spring]])
    return float(low[0]), float(high[0])


def _remedy(middle: float, at: float, lost_at: Callable[[float], bool]) -> str:
    """Up to, or from, which speed the stage is kept."""
    if lost_at(middle):
        return "narrow the tolerances of loads, or prove each stage by itself"
    kept, lost = middle, at
    for _ in range(HALVINGS):
        half = (kept + lost) / 2
        kept, lost = (kept, half) if lost_at(half) else (half, lost)
    side = "below" if at > middle else "above"
    return f"prove each stage by itself: this one {side} {kept:.6g} rad/s"


def _require_sums(assembly: Assembly, looked_at: Array, ranges: Sequence[NumberRange]) -> None:
    """Refuse loads that are no polynomials of the speed, or no sums over tolerances."""
    first, last = float(looked_at[0]), float(looked_at[-1])
    share = ((looked_at - first) / (last - first or 1.0))[:, None]
    ends = _by_rows(assembly, np.array([first, (first + last) / 2, last]), ranges)
    b = _bernstein(ends)[:, :, None]
    made = b[:, 0] * (1 - share) ** 2 + 2 * b[:, 1] * share * (1 - share) + b[:, 2] * share**2
    found = _by_rows(assembly, looked_at, ranges)
    missed = np.abs(found - made).max(axis=(0, 1))
    for side in (1, 2):  # all tolerances at their low ends, and at their high ones
        row = rows_of_ranges(assembly, looked_at, ())
        for one in ranges:
            one.columns.put(row, np.full(len(row), one.low if side == 1 else one.high))
        together = found[0] + (found[side::2] - found[:1]).sum(axis=0)
        missed = np.maximum(missed, np.abs(assembly.static_torque(row) - together).max(axis=0))
    for e in staged_springs(assembly):
        if missed[e] > UNEVEN * np.abs(found[..., e]).max():
            raise InputError(
                "has stages, and its load is no polynomial of the speed, or no sum over tolerances: whether it stays "
                "in one stage is not followed",
                element=assembly.line.names[assembly.topology.compliances[e].shafts[0]],
                value=float(found[0, -1, e]), remedy="write a Shaft of its stiffness under load, or give one speed",
            )  # fmt: skip


def _by_rows(assembly: Assembly, speeds: Array, ranges: Sequence[NumberRange]) -> Array:
    """Torques (1 + 2 ranges, speed, compliance)."""
    found = assembly.static_torque(rows_of_ranges(assembly, speeds, ranges))
    return found.reshape(1 + 2 * len(ranges), len(speeds), -1)


def _reach(low: float, high: float) -> str:
    if np.isinf(low):
        return "at any load" if np.isinf(high) else f"up to {high:.6g} N m"
    return f"from {low:.6g} N m on" if np.isinf(high) else f"from {low:.6g} to {high:.6g} N m"

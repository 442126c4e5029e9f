"""Whether the motion found at a mean speed is the one that the line makes there, or one of several."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.prepared_line import ANGLE_SCALE
from trunnion.errors import ComputationError
from trunnion.results.speeds import show_speed
from trunnion.steady.free.free_balance import MOST_NUMBERS, FreeBalance, SteadyStates
from trunnion.steady.free.periodic_steady_states import SEVERAL, Break, SteadyStatesBySpeed, breaks, merged
from trunnion.steady.free.tree_newton import TreeMotions

FAR, BENT = 0.05, 0.25
"""Distance from rigid shafts [rad], and what a linear step misses of it, beyond which a motion is followed from speeds
beside its own."""
ASIDE, ASIDE_OF_LONG, LONG = 0.1, 0.02, 30
"""Share of the speed by which those differ from it; the same of lines of so many unknowns whose steps take matrices of
them all, seconds each."""


def leads_elsewhere(balance: FreeBalance, motions: SteadyStates) -> bool:
    """Whether the motion of a line, solved along its tree, is so far from that of rigid shafts, and the way to it so
    bent, that others may have the same speed."""
    rigid = balance.rigid(motions.table, motions.h, motions.coefficients)
    if not motions.found[0] or np.abs(motions.rows - rigid).max() <= FAR:
        return not motions.found[0]
    return _bent(balance, motions, rigid)


def _bent(balance: FreeBalance, motions: SteadyStates, rigid: Array) -> bool:
    """Whether the way from ``rigid`` shafts to a motion far from them is bent."""
    begin = TreeMotions(rigid, np.zeros(1), np.zeros(1))
    once = balance.newton(motions.table).corrected(begin, balance.torque_unit(motions.coefficients), ANGLE_SCALE)
    return bool(np.abs(once.rows - motions.rows).max() > BENT * np.abs(motions.rows - rigid).max())


def require_one_motion(curve: SteadyStatesBySpeed, line: Driveline, speed: float) -> None:
    """Follow the motion to ``speed`` [rad/s] from slower and from faster ones.

    Raises
    ------
    ComputationError : the motions fold back, and several have this speed.
    """
    curve.broken = _breaks_about(curve, np.array([speed]))
    _refuse_folds(curve, line, [speed])


def require_one_motion_each(
    curve: SteadyStatesBySpeed, line: Driveline, speeds: Array, *, between: bool = False
) -> None:
    """The same of every one of ``speeds`` (speed,) [rad/s] at which others may have the same speed, those that lie
    beside each other together; and of all speeds ``between`` them, where they stand for the range that they span.

    Raises
    ------
    ComputationError : the motions fold back, and several have one of these speeds.
    """
    asked = np.unique(speeds)
    motions = curve.at_all(asked)
    doubtful = asked[_doubtful(curve.balance, motions)]
    if len(doubtful):
        runs = np.split(doubtful, np.flatnonzero(doubtful[1:] > (1 + ASIDE) * doubtful[:-1]) + 1)
        curve.broken = tuple(merged(one for run in runs for one in _breaks_about(curve, run)))
        folds = _folds_within(curve, float(asked[0]), float(asked[-1])) if between else []
        _refuse_folds(curve, line, [*doubtful.tolist(), *folds])


def _doubtful(balance: FreeBalance, motions: SteadyStates) -> Flags:
    """``leads_elsewhere`` of every one of them (case,); of a line that is no tree, whether it is far from rigid shafts
    or not found."""
    count = len(motions.value)
    size = max(1, MOST_NUMBERS // (motions.times * len(balance.assembly.topology.mean_speeds)))
    parts = [motions.part(slice(i, i + size)) for i in range(0, count, size)]
    rigid = np.concatenate([balance.rigid(part.table, part.h, part.coefficients) for part in parts])
    found = ~motions.found | (np.abs(motions.rows - rigid).max(axis=(1, 2)) > FAR)
    if balance.of_tree:
        for i in np.flatnonzero(found & motions.found).tolist():
            one = slice(i, i + 1)
            found[i] = _bent(balance, motions.part(one), rigid[one])
    return np.asarray(found)


def _breaks_about(curve: SteadyStatesBySpeed, speeds: Array) -> tuple[Break, ...]:
    """Where motions break off among ``speeds`` (speed,), rising, and a little beside."""
    dear = len(curve.balance.turn) >= LONG and not curve.balance.along_tree
    aside = ASIDE_OF_LONG if dear else ASIDE
    ends = speeds[0] * (1 - aside), speeds[-1] * (1 + aside)
    return breaks(curve, np.array([ends[0], *speeds, ends[1]]), between=not dear)


def _folds_within(curve: SteadyStatesBySpeed, low: float, high: float) -> list[float]:
    """The middle [rad/s] of what every break has of a range: a fold may be narrower than the speeds are apart."""
    shared = [(max(one.low, low), min(one.high, high)) for one in curve.broken]
    return [(a + b) / 2 for a, b in shared if a < b]


def _refuse_folds(curve: SteadyStatesBySpeed, line: Driveline, speeds: Iterable[float]) -> None:
    for speed in speeds:
        for one in curve.broken:
            if one.low < speed < one.high and one.why == SEVERAL:
                low, at, high = (show_speed(each, speed_unit(line)) for each in (one.low, speed, one.high))
                raise ComputationError(
                    f"the line has several periodic motions at {at}, none of which can be told to be the one it makes: "
                    f"the one that goes on from slower speeds ends at {high}, the one that goes on from faster speeds "
                    f"at {low}; judge it outside these, or give it more damping"
                )

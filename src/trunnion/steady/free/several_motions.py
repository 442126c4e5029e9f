"""Whether the motion found at one mean speed is the one that the line makes there, or one of several."""

from __future__ import annotations

import numpy as np

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.line_system import ANGLE_SCALE
from trunnion.errors import ComputationError
from trunnion.results.speeds import show_speed
from trunnion.steady.free.free_balance import FreeBalance, SteadyStates
from trunnion.steady.free.periodic_steady_states import SEVERAL, SteadyStatesBySpeed, breaks
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
    table, co = motions.table, motions.coefficients
    rigid = balance.rigid(table, motions.h, co)
    apart = motions.rows - rigid
    if not motions.found[0] or np.abs(apart).max() <= FAR:
        return not motions.found[0]
    begin = TreeMotions(rigid, np.zeros(1), np.zeros(1))
    once = balance.newton(table).corrected(begin, balance.torque_unit(co), ANGLE_SCALE)
    return bool(np.abs(once.rows - motions.rows).max() > BENT * np.abs(apart).max())


def require_one_motion(curve: SteadyStatesBySpeed, line: Driveline, speed: float) -> None:
    """Follow the motion to ``speed`` [rad/s] from slower and from faster ones.

    Raises
    ------
    ComputationError : the motions fold back, and several have this speed.
    """
    dear = len(curve.balance.turn) >= LONG and not curve.balance.along_tree
    aside = ASIDE_OF_LONG if dear else ASIDE
    curve.broken = breaks(curve, speed * np.array([1 - aside, 1.0, 1 + aside]), between=not dear)
    for one in curve.broken:
        if one.low < speed < one.high and one.why == SEVERAL:
            low, at, high = (show_speed(each, speed_unit(line)) for each in (one.low, speed, one.high))
            raise ComputationError(
                f"the line has several periodic motions at {at}, none of which can be told to be the one it makes: the "
                f"one that goes on from slower speeds ends at {high}, the one that goes on from faster speeds at "
                f"{low}; judge it outside these, or give it more damping"
            )

"""A branch of periodic motions followed over a parameter by shooting, through folds, stable or not.

The branch is the curve P(x; λ) = x in the space of z = (x, λ), followed by pseudo-arclength
(``numerics.arclength``) with the exact ∂P/∂x. Lengths are measured in the scale of the states and in the range of
the parameter. A line that starts free keeps its mean speed by its drives, as in ``periodic_response``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trunnion.analyses.orbits.branch import STEP, PeriodicBranch, Progress, followed
from trunnion.analyses.orbits.closing import Phase
from trunnion.analyses.orbits.free_orbit import kept_speed_orbit, neutral_motions, torque_scale
from trunnion.analyses.orbits.judging import IntegratedClosing
from trunnion.analyses.orbits.orbit_result import PeriodicOrbit
from trunnion.analyses.orbits.periodic_orbit import periodic_orbit
from trunnion.analyses.orbits.systems_over import LINE_SCALE, SystemOver, system_over
from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.systems.system import System

TOLERANCE = 1e-11
MOST_POINTS = 2000


def periodic_branch(
    line: Driveline | Assembly | System,
    parameter: str | Parameter,
    low: float,
    high: float,
    *,
    begin: float | None = None,
    start: ArrayLike | None = None,
    speed: float | None = None,
    periods: int = 1,
    tolerance: float = TOLERANCE,
    longest_step: float = 0.01,
    most_points: int = MOST_POINTS,
    progress: Progress | None = None,
) -> PeriodicBranch:
    """Follow the periodic motion of a line or a forced system while a parameter moves from ``low`` to ``high``.

    Parameters
    ----------
    parameter : of a line its path ("speed", "HookeJoint 1.angle", a ``Parameter``); of a system its name.
    low, high : ends of the range, in SI units.
    begin : where the first motion is sought, by default at ``low``; from inside the range the branch is followed
        both ways.
    start : a state near that motion.
    speed : input speed [rad/s] of a line, where it is not the parameter.
    periods : forcing periods in one period of the motion.
    longest_step : largest step of the parameter, as a share of its range; two special points closer together than
        a step may be missed.
    progress : called as progress(share done).

    Returns
    -------
    A branch whose ``outcome`` says where it ended; if no motion was found at ``begin`` it has no points.

    Raises
    ------
    InputError : an unknown parameter, a reversed range, an autonomous system; a line that starts free whose torques do
        not balance, or for motions of several periods.
    """
    # The parameter's scale makes its largest step the one asked for, whatever a state's may be.
    over = system_over(line, parameter, low, high, begin, speed, longest_step / STEP, free=True)
    problem, unknown, orbit = (
        _free(over, start, periods, tolerance) if over.free else _forced(over, start, periods, tolerance)
    )
    return followed(problem, np.append(unknown, over.begin), low, high, most_points, orbit.outcome, progress=progress)


def _forced(
    over: SystemOver, start: ArrayLike | None, periods: int, tolerance: float
) -> tuple[IntegratedClosing, Array, PeriodicOrbit]:
    orbit = periodic_orbit(over.at(over.begin), start=start, periods=periods, tolerance=tolerance)
    return IntegratedClosing(over.map(periods, tolerance), over.scale, over=over), orbit.start, orbit


def _free(
    over: SystemOver, start: ArrayLike | None, periods: int, tolerance: float
) -> tuple[IntegratedClosing, Array, PeriodicOrbit]:
    if periods != 1:
        raise InputError(
            "are followed of a line with a prescribed speed only", element="driveline", key="periods", value=periods,
            remedy="leave it out, or put a ConstantSpeed in front",
        )  # fmt: skip
    assert over.line is not None
    found = kept_speed_orbit(over.line, start, tolerance=tolerance, driven=lambda torque: over.at(over.begin, torque))
    torque = LINE_SCALE * torque_scale(over.line)
    problem = IntegratedClosing(
        over.map(periods, tolerance, torque),
        np.concatenate([over.scale[:-1], [torque, over.scale[-1]]]),
        Phase.held(0, float(found.orbit.start[0]), over.scale[:-1]),
        over=over,
        neutral=neutral_motions(over.line),
    )
    return problem, np.append(found.orbit.start, found.extra_torque), found.orbit

"""A branch of periodic motions followed over a parameter by shooting, through folds, stable or not.

The branch is the curve P(x; λ) = x in the space of z = (x, λ), followed by pseudo-arclength
(``numerics.arclength``) with the exact ∂P/∂x. Lengths are measured in the scale of the states and in the range of
the parameter. A line that starts free keeps its mean speed by its drives, as in ``periodic_response``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.sliders import NOT_FOLLOWED, STAND_IN, refuse_friction
from trunnion.equations.steady_base import refuse_dragged
from trunnion.errors import InputError
from trunnion.motion.orbits.branch import STEP, PeriodicBranch, Progress, followed
from trunnion.motion.orbits.periodic_response import require_forced
from trunnion.results.parameter_names import Names
from trunnion.steady.shooting.closing import Phase
from trunnion.steady.shooting.free_orbit import kept_speed_orbit, neutral_motions, require_kept_speed, torque_scale
from trunnion.steady.shooting.judging import IntegratedClosing
from trunnion.steady.shooting.periodic_orbit import MOST_STEPS, TOLERANCE, PeriodicOrbit, periodic_orbit
from trunnion.systems.maps import IntegratedMap
from trunnion.systems.system import System

LINE_SCALE = 30
"""A branch of a line is measured in 0.3 rad, thirty times what its integration is."""
BESIDE = 1e-4
"""Step of differences by a parameter, over its scale."""
MOST_POINTS = 2000


@dataclass(frozen=True)
class SystemOver(Names):
    """Systems by the value of a parameter.

    at : value → system, and of a line that starts free (value, torque [N m] beyond the balance of its loads) → system;
    scale (n + 1,) : size of each state and of the parameter that counts as one; begin : the value to begin with; curves
    : the states of a system, the shafts of a line, of which the torques [N m] are looked at.
    """

    at: Callable[..., System] = field(kw_only=True)
    scale: Array = field(kw_only=True)
    begin: float = field(kw_only=True)
    line: LineSystem | None = field(default=None, kw_only=True)

    @property
    def free(self) -> bool:
        """Whether it is a line that starts free."""
        return self.line is not None and self.line.assembly.topology.free

    def map(self, periods: int, tolerance: float, torque: float = 0.0) -> IntegratedMap:
        """The map over ``periods`` of the forcing, its value the parameter; of a line that starts free its values are
        the torque beyond the balance, in steps of a size of ``torque``, and the parameter."""
        step, look = BESIDE * float(self.scale[-1]), self.observe
        if not self.free:
            return IntegratedMap(self.at, (self.begin,), (step,), 0.0, periods, tolerance, MOST_STEPS, look)

        def driven(drive: float, value: float) -> System:
            return self.at(value, drive)

        steps = BESIDE * torque, step
        return IntegratedMap(driven, (0.0, self.begin), steps, 0.0, periods, tolerance, MOST_STEPS, look)

    def observe(self, system: System, times: Array, states: Array) -> Array:
        """The curves (times, curves) along states (times, n)."""
        return states if self.line is None else self.line.observe(system, times, states).torque


def system_over(
    line: Driveline | Assembly | System,
    parameter: str | Parameter,
    low: float,
    high: float,
    begin: float | None,
    speed: float | str | None,
    width: float,
    *,
    free: bool = False,
) -> SystemOver:
    """The systems of ``line`` over a parameter, whose range times ``width`` is its scale.

    ``free`` : whether lines that start free are taken, at the mean speed that their drives keep.

    Raises
    ------
    InputError : an unknown parameter, a reversed range, an autonomous system, a free line not asked for.
    """
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise InputError("must be a rising range", key="low, high", value=[float(low), float(high)])
    first = float(low if begin is None else begin)
    if not low <= first <= high:
        raise InputError(
            "lies outside the range", key="begin", value=first, remedy=f"choose between {low:g} and {high:g}"
        )
    if isinstance(line, System):
        return _of_system(line, str(parameter), first, (high - low) * width)
    description = line.line if isinstance(line, Assembly) else line
    refuse_friction(description, NOT_FOLLOWED, STAND_IN)
    over_speed = parameter == "speed"
    prepared = line_system(line, first if over_speed and first > 0 else operating_speed(description, speed))
    refuse_dragged(prepared.assembly)
    if not prepared.assembly.topology.free:
        require_forced(prepared)
    elif free:
        require_kept_speed(prepared)
    else:
        raise InputError(
            "starts free, which a series of harmonics at a given speed does not take", element="driveline",
            remedy='use periodic_branch or method = "shooting", or put a ConstantSpeed in front',
        )  # fmt: skip
    columns = prepared.assembly.packed.resolve_axis(parameter)
    scale = np.append(LINE_SCALE * np.asarray(prepared.system.scale), (high - low) * width)
    return SystemOver(
        columns.label, columns.unit, prepared.shafts, "N*m", speed_unit(description),
        at=prepared.varied(parameter), scale=scale, begin=first, line=prepared,
    )  # fmt: skip


def _of_system(system: System, name: str, first: float, width: float) -> SystemOver:
    if system.sliders:
        raise InputError(
            f"has dry friction, {NOT_FOLLOWED}", element=system.sliders[0],
            remedy="find single motions with periodic_response",
        )  # fmt: skip
    if system.with_parameters({name: first}).forcing_period is None:
        raise InputError(
            "is autonomous; only motions of a forced period are followed", element=system.name, key="period",
            remedy="give the system its forcing period, or find single motions with periodic_response",
        )  # fmt: skip
    scale = np.append(np.asarray(system.scale), width)
    unit = system.parameter_units.get(name, "1")
    return SystemOver(
        name, unit, system.states, at=lambda value: system.with_parameters({name: value}), scale=scale, begin=first
    )


def periodic_branch(
    line: Driveline | Assembly | System,
    parameter: str | Parameter,
    low: float,
    high: float,
    *,
    begin: float | None = None,
    start: ArrayLike | None = None,
    speed: float | str | None = None,
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

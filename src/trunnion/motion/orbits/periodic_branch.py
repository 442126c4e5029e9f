"""A branch of periodic motions followed over a parameter by shooting, through folds, stable or not.

The branch is the curve P(x; λ) = x in the space of z = (x, λ), followed by pseudo-arclength
(``numerics.continuation.arclength``) with the exact ∂P/∂x. Lengths are measured in the scale of the states and in the
range of the parameter. A free–free line keeps its mean speed by its drives, as in ``periodic_response``.

Exact motions of a piecewise linear oscillator, or of a driveline with stages, are followed over their frequency or
speed with the exact derivative by that as well: what other methods are measured against.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.released import refuse_pendulums
from trunnion.equations.sliders import NOT_FOLLOWED, STAND_IN, refuse_friction
from trunnion.equations.slip_clutches import refuse_slip_clutches
from trunnion.equations.staged_line import StagedLine, staged_line
from trunnion.equations.steady_base import refuse_dragged
from trunnion.errors import InputError
from trunnion.motion.orbits.branch import STEP, PeriodicBranch, Progress, followed
from trunnion.motion.orbits.exact_map import LineMap, OscillatorMap
from trunnion.motion.orbits.exact_orbit import orbit_near, piecewise_orbit, refuse_found_speed
from trunnion.motion.orbits.periodic_response import require_forced
from trunnion.motion.simulation.exact_motion import start_state
from trunnion.results.outcome import Outcome
from trunnion.results.parameter_names import Names
from trunnion.steady.shooting.free_orbit import kept_speed_orbit, neutral_motions, require_kept_speed, torque_scale
from trunnion.steady.shooting.periodic_orbit import MOST_STEPS, TOLERANCE, PeriodicOrbit, periodic_orbit
from trunnion.steady.shooting.shooting_problem import IntegratedShooting, Phase, ShootingProblem, refuse_speed
from trunnion.systems.maps import IntegratedMap
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator
from trunnion.systems.system import System

LINE_SCALE = 30
"""A branch of a line is measured in 0.3 rad, thirty times what its integration is."""
BESIDE = 1e-4
"""Step of differences by a parameter, over its scale."""
MOST_POINTS = 2000


@dataclass(frozen=True)
class SystemOver(Names):
    """Systems by the value of a parameter.

    at : value → system, and of a free–free line (value, torque [N m] beyond the balance of its loads) → system;
    scale (n + 1,) : size of each state and of the parameter that counts as one; begin : the value to begin with; curves
    : the states of a system, the shafts of a line, of which the torques [N m] are looked at.
    """

    at: Callable[..., System] = field(kw_only=True)
    scale: Array = field(kw_only=True)
    begin: float = field(kw_only=True)
    line: LineSystem | None = field(default=None, kw_only=True)

    @property
    def free(self) -> bool:
        """Whether it is a free–free line."""
        return self.line is not None and self.line.assembly.topology.free

    def map(self, periods: int, tolerance: float, torque: float = 0.0) -> IntegratedMap:
        """The map over ``periods`` of the forcing, its value the parameter; of a free–free line its values are
        the torque beyond the balance, in steps of a size of ``torque``, and the parameter."""
        before, sizes = ((0.0,), (torque,)) if self.free else ((), ())
        steps = tuple(BESIDE * size for size in (*sizes, float(self.scale[-1])))
        family = self._driven if self.free else self.at
        return IntegratedMap(family, (*before, self.begin), steps, 0.0, periods, tolerance, MOST_STEPS, self.observe)

    def _driven(self, torque: float, value: float) -> System:
        return self.at(value, torque)

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

    ``free`` : whether free–free lines are taken, at the mean speed that their drives keep.

    Raises
    ------
    InputError : an unknown parameter, a reversed range, an autonomous system, a free line not asked for.
    """
    first = begun_within(low, high, begin, -np.inf)
    if isinstance(line, System):
        return _of_system(line, str(parameter), first, (high - low) * width)
    description = line.line if isinstance(line, Assembly) else line
    refuse_friction(description, NOT_FOLLOWED, STAND_IN)
    refuse_slip_clutches(description)
    refuse_pendulums(description)
    over_speed = parameter == "speed"
    prepared = line_system(line, first if over_speed and first > 0 else operating_speed(description, speed))
    refuse_dragged(prepared.assembly)
    if not prepared.assembly.topology.free:
        require_forced(prepared)
    elif free:
        require_kept_speed(prepared)
    else:
        raise InputError(
            "is free–free, which a series of harmonics at a given speed does not take", element="driveline",
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
    line : a ``Driveline`` (or its ``Assembly``), or a forced ``System``.
    parameter : of a line its path ("speed", "HookeJoint 1.angle", a ``Parameter``); of a system its name.
    low, high : ends of the range, in SI units.
    begin : where the first motion is sought, by default at ``low``; from inside the range the branch is followed both
        ways.
    start : a state (n,) near that motion.
    speed : input speed [rad/s] of a line, where it is not the parameter.
    periods : forcing periods in one period of the motion.
    tolerance : error allowed per step of the integration.
    longest_step : largest step of the parameter, as a share of its range; two special points closer together than a
        step may be missed.
    most_points : points after which the branch ends.
    progress : called as progress(share done).

    Returns
    -------
    PeriodicBranch; its ``outcome`` says where it ended. If no motion was found at ``begin`` it has no points.

    Raises
    ------
    InputError : an unknown parameter, a reversed range, an autonomous system; a free–free line whose torques do
        not balance, or for motions of several periods.

    Examples
    --------
    >>> import trunnion as tn
    >>> duffing = tn.reference_system("duffing")
    >>> branch = tn.periodic_branch(duffing, "frequency", 0.8, 1.2, longest_step=0.05)
    >>> bool(branch.stable.all()), branch.curves, branch.outcome.kind
    (True, ('x', 'v'), 'followed')
    """
    # The parameter's scale makes its largest step the one asked for, whatever a state's may be.
    over = system_over(line, parameter, low, high, begin, speed, longest_step / STEP, free=True)
    if over.free:
        problem, orbit = _free(over, start, periods, tolerance)
    else:
        orbit = periodic_orbit(over.at(over.begin), start=start, periods=periods, tolerance=tolerance)
        problem = IntegratedShooting(over.map(periods, tolerance), over.scale, over=over)
    first = np.concatenate([orbit.start, orbit.values, [over.begin]])
    return followed(problem, first, low, high, most_points, orbit.outcome, progress=progress)


def _free(
    over: SystemOver, start: ArrayLike | None, periods: int, tolerance: float
) -> tuple[IntegratedShooting, PeriodicOrbit]:
    if periods != 1:
        raise InputError(
            "are followed of a line with a prescribed speed only", element="driveline", key="periods", value=periods,
            remedy="leave it out, or put a ConstantSpeed in front",
        )  # fmt: skip
    assert over.line is not None
    found = kept_speed_orbit(over.line, start, tolerance=tolerance, driven=lambda torque: over.at(over.begin, torque))
    torque = LINE_SCALE * torque_scale(over.line)
    problem = IntegratedShooting(
        over.map(periods, tolerance, torque),
        np.concatenate([over.scale[:-1], [torque, over.scale[-1]]]),
        Phase.fixed(0, float(found.start[0]), over.scale[:-1]),
        over=over,
        neutral=neutral_motions(over.line),
    )
    return problem, found


def check_range(low: float, high: float, least: float = 0.0) -> None:
    """Refuse what is not a rising range of numbers above ``least``.

    Raises
    ------
    InputError : another range.
    """
    if not (np.isfinite(low) and np.isfinite(high) and least < low < high):
        what = " of positive frequencies" if np.isfinite(least) else ""
        raise InputError(f"must be a rising range{what}", key="low, high", value=[float(low), float(high)])


def begun_within(low: float, high: float, begin: float | None, least: float = 0.0) -> float:
    """Where a branch over a range of numbers above ``least`` begins: ``low``, or ``begin`` within it.

    Raises
    ------
    InputError : no rising range, a number outside it.
    """
    check_range(low, high, least)
    first = float(low if begin is None else begin)
    if not low <= first <= high:
        raise InputError(
            "lies outside the range", key="begin", value=first, remedy=f"choose between {low:g} and {high:g}"
        )
    return first


def piecewise_branch(
    oscillator: PiecewiseOscillator | Driveline | Assembly,
    low: float,
    high: float,
    *,
    begin: float | None = None,
    start: ArrayLike | None = None,
    speed: float | str | None = None,
    periods: int = 1,
    longest_step: float = 0.01,
    most_points: int = 4000,
    progress: Progress | None = None,
) -> PeriodicBranch:
    """Exact periodic motions over the frequency from ``low`` to ``high``, stable and unstable.

    Parameters
    ----------
    oscillator : a ``PiecewiseOscillator``; or a driveline that ``exact_motion`` takes, over its speed, or over the
        common frequency of its excitations where those are in time.
    low, high : ends of the range [rad/s].
    begin : frequency [rad/s] to begin at, ``low`` by default; the branch is followed both ways from it.
    start : x and x′ at phase zero near the first motion; so isolated branches are reached. Of a driveline as in
        ``exact_motion``.
    speed : of a driveline excited in time [rad/s], where a viscous load depends on it.
    periods : forcing periods of the motion; 2 follows a motion of twice the period.
    longest_step : of the continuation, over the frequency range and over the size of the gap or of the motion.
    most_points : points after which the branch ends.
    progress : called as progress(share done).

    Returns
    -------
    PeriodicBranch with the curve "x", of a driveline the torques [N m] of its springs; where nothing was found at
    ``begin`` it has no points and says so.

    Raises
    ------
    InputError : a range that does not rise, a frequency outside it, an undamped linear resonance; a driveline without
        exact motion, or excited both by its rotation and in time.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> branch = tn.piecewise_branch(gap, 0.85, 0.95)
    >>> [(point.kind, round(point.parameter, 5)) for point in branch.special]
    [('fold', 0.92749)]
    """
    first = begun_within(low, high, begin)
    if isinstance(oscillator, Driveline | Assembly):
        begun = _line_begun(oscillator, first, start, speed, periods)
    else:
        begun = _oscillator_begun(oscillator, first, start, speed, periods)
    problem = ShootingProblem(begun.map, np.append(begun.size, (high - low) * longest_step / STEP), over=begun.over)
    return followed(
        problem, np.append(begun.start, first), low, high, most_points, begun.outcome, tolerance=begun.tolerance,
        progress=progress,
    )  # fmt: skip


class _Begun(NamedTuple):
    """Where a branch begins: its map, the size of each state that counts as one, the first state and how it was found,
    what the branch lies over, and how well its points close."""

    map: Any
    size: Array
    start: Array
    outcome: Outcome
    over: Names
    tolerance: float


def _oscillator_begun(
    o: PiecewiseOscillator, value: float, start: ArrayLike | None, speed: float | str | None, periods: int
) -> _Begun:
    refuse_speed(o.name, speed)
    orbit = piecewise_orbit(o.but(frequency=value), start, periods=periods)
    size = max([*map(abs, o.breakpoints), 0.0]) or max(abs(orbit.highest), abs(orbit.lowest), 1e-12)
    over = Names("frequency", "rad/s", ("x",), speed_unit=o.speed_unit)
    sizes = size * np.array([1.0, o.frequency])
    return _Begun(OscillatorMap(value, periods, o), sizes, orbit.start, orbit.outcome, over, 1e-11)


def _line_begun(
    line: Driveline | Assembly, value: float, start: ArrayLike | None, speed: float | str | None, periods: int
) -> _Begun:
    refuse_friction(line.line if isinstance(line, Assembly) else line, NOT_FOLLOWED, STAND_IN)
    prepared = line_over(line, value, speed)
    orbit, place = orbit_near(prepared, start_state(prepared, start), value, periods), LineMap(value, periods, prepared)
    size = np.abs(orbit.start)
    if orbit.outcome.ok:
        # Twists count by the larger of the motion and the gap, rates by that per phase.
        size[: len(prepared.springs)] = np.maximum(np.abs(orbit.twist_low), np.abs(orbit.twist_high))
    name = "speed" if prepared.independent_variable == "speed" else "frequency"
    over = Names(name, "rad/s", prepared.springs, "N*m", speed_unit(prepared.assembly.line))
    return _Begun(place, place.scale(size), orbit.start[place.kept], orbit.outcome, over, 1e-10)


def line_over(line: Driveline | Assembly, value: float, speed: float | str | None) -> StagedLine:
    """The line, ready for other values of what turns its excitation, of which ``value`` is one.

    Raises
    ------
    InputError : excitation by speed and in time together, or none.
    """
    prepared = staged_line(line, value)
    if prepared.independent_variable == "frequency":
        prepared = staged_line(line, speed)
    if prepared.independent_variable == "both":
        raise InputError(
            "is excited by its rotation and in time, so its motions over speed have no common period",
            element="driveline", key="excitation", remedy="give orders in place of frequencies, or frequencies only",
        )  # fmt: skip
    refuse_found_speed(prepared)
    _ = prepared.base  # refuses what has none
    return prepared

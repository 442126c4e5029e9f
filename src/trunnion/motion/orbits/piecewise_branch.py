"""Exact periodic motions over a frequency, of a piecewise linear oscillator or of a driveline with stages.

The curve P(x; value) = x, followed by pseudo-arclength with the exact derivative by state and value; special points as
in ``analyses/branch``. It is what the other methods are measured against.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly
from trunnion.equations.sliders import NOT_FOLLOWED, STAND_IN, refuse_friction
from trunnion.equations.staged_line import StagedLine, staged_line
from trunnion.errors import InputError
from trunnion.motion.orbits.branch import STEP, PeriodicBranch, Progress, followed
from trunnion.motion.orbits.exact_map import LineMap, OscillatorMap
from trunnion.motion.orbits.exact_orbit import orbit_near, piecewise_orbit, refuse_found_speed
from trunnion.motion.simulation.exact_motion import start_state
from trunnion.results.parameter_names import Names
from trunnion.steady.shooting.closing import Closing, refuse_speed
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


def check_range(low: float, high: float) -> None:
    """Refuse what is no rising range of positive frequencies.

    Raises
    ------
    InputError : another range.
    """
    if not (np.isfinite(low) and np.isfinite(high) and 0 < low < high):
        raise InputError("must be a rising range of positive frequencies", key="low, high", value=[low, high])


def begun_within(low: float, high: float, begin: float | None) -> float:
    """Where a branch over a range of frequencies begins: ``low``, or ``begin`` within it.

    Raises
    ------
    InputError : no rising range, a frequency outside it.
    """
    check_range(low, high)
    first = low if begin is None else float(begin)
    if not low <= first <= high:
        raise InputError("lies outside the range", key="begin", value=first, remedy=f"choose {low:g} to {high:g}")
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
    oscillator : or a driveline that ``exact_motion`` takes, over its speed, or over the common frequency of its
        excitations where those are in time.
    begin : frequency to begin at, ``low`` by default; the branch is followed both ways from it.
    start : x and x′ at phase zero near the first motion; so isolated branches are reached. Of a driveline as in
        ``exact_motion``.
    speed : of a driveline excited in time, where a viscous load depends on it.
    periods : forcing periods of the motion; 2 follows a motion of twice the period.
    longest_step : of the continuation, over the frequency range and over the size of the gap or of the motion.
    progress : called as progress(share done).

    Returns
    -------
    PeriodicBranch with the curve "x", of a driveline the torques of its springs; where nothing was found at
    ``begin`` it has no points and says so.

    Raises
    ------
    InputError : a range that does not rise, a frequency outside it, an undamped linear resonance; a driveline
        without exact motion, or excited both by its rotation and in time.
    """
    first = begun_within(low, high, begin)
    if isinstance(oscillator, Driveline | Assembly):
        return _of_line(oscillator, low, high, first, start, speed, periods, longest_step, most_points, progress)
    refuse_speed(oscillator.name, speed)
    orbit = piecewise_orbit(oscillator.but(frequency=first), start, periods=periods)
    size = max([*map(abs, oscillator.breakpoints), 0.0]) or max(abs(orbit.highest), abs(orbit.lowest), 1e-12)
    scale = np.array([size, size * oscillator.frequency, (high - low) * longest_step / STEP])
    place = OscillatorMap(first, periods, oscillator)
    problem = Closing(place, scale, over=Names("frequency", "rad/s", ("x",), speed_unit=oscillator.speed_unit))
    return followed(
        problem, np.append(orbit.start, first), low, high, most_points, orbit.outcome, tolerance=1e-11,
        progress=progress,
    )  # fmt: skip


def _of_line(
    line: Driveline | Assembly,
    low: float,
    high: float,
    first: float,
    start: ArrayLike | None,
    speed: float | str | None,
    periods: int,
    longest_step: float,
    most_points: int,
    progress: Progress | None,
) -> PeriodicBranch:
    refuse_friction(line.line if isinstance(line, Assembly) else line, NOT_FOLLOWED, STAND_IN)
    prepared = line_over(line, first, speed)
    orbit, place = orbit_near(prepared, start_state(prepared, start), first, periods), LineMap(first, periods, prepared)
    size = np.abs(orbit.start)
    if orbit.outcome.ok:
        # Twists count by the larger of the motion and the gap, rates by that per phase.
        size[: len(prepared.springs)] = np.maximum(np.abs(orbit.twist_low), np.abs(orbit.twist_high))
    scale = np.append(place.scale(size), (high - low) * longest_step / STEP)
    name = "speed" if prepared.clock == "speed" else "frequency"
    problem = Closing(
        place, scale, over=Names(name, "rad/s", prepared.springs, "N*m", speed_unit(prepared.assembly.line))
    )
    begins = np.append(orbit.start[place.kept], first)
    return followed(problem, begins, low, high, most_points, orbit.outcome, tolerance=1e-10, progress=progress)


def line_over(line: Driveline | Assembly, value: float, speed: float | str | None) -> StagedLine:
    """The line, ready for other values of what turns its excitation, of which ``value`` is one.

    Raises
    ------
    InputError : excitation by speed and in time together, or none.
    """
    prepared = staged_line(line, value)
    if prepared.clock == "frequency":
        prepared = staged_line(line, speed)
    if prepared.clock == "both":
        raise InputError(
            "is excited by its rotation and in time, so its motions over speed have no common period",
            element="driveline", key="excitation", remedy="give orders in place of frequencies, or frequencies only",
        )  # fmt: skip
    refuse_found_speed(prepared)
    _ = prepared.base  # refuses what has none
    return prepared

"""What analyses of long motions take: a system, or a driveline at a speed; its starts; what turns or runs in it.

Also how long motions end, how long a turn takes, how large they are, and the section of a map where none is asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import null_space

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.errors import InputError
from trunnion.numerics.integration.integration import integrate
from trunnion.numerics.integration.tangents import Motion
from trunnion.numerics.memory import require_memory
from trunnion.results.outcome import Outcome
from trunnion.steady.shooting.integration_outcomes import GROWN, outcome_of
from trunnion.steady.shooting.repetition import LONGEST_REPEAT
from trunnion.systems.events import Event
from trunnion.systems.system import System

SAME = 1e-9
"""Change of a rate over its size that counts as none."""
TURN_STEPS, TURN_NEAR = 64, 0.3
"""Looks along the way of a state between two samples, and the change of the rates over its largest at which one turn of
it may be near."""
TOGETHER, LARGEST_RATIO = 0.02, 12
"""Difference of ratios of states that run on together which counts as none; largest denominator of such a ratio."""
PHASES = 7
"""Phases of the forcing at which a system is looked at; an odd number meets no two zeros of a half-period."""
NEIGHBOUR = 1e-2
"""How far from the first start the others are, in units of the system's scale plus the start itself."""
BYTES_A_VALUE = 512
"""What a value of a parameter holds: itself, its motion's request and what is found there."""


def as_system(subject: System | Driveline, speed: float | str | None = None) -> System:
    """The system itself, or that of a driveline at ``speed`` [rad/s] (default: its operating speed).

    Raises
    ------
    InputError : neither, a speed given for a system, or a free–free line: it has no period to strobe at,
        and its rotation is not bounded.
    """
    if isinstance(subject, System):
        if speed is not None:
            remedy = "set it among the system's parameters, with but()"
            raise InputError("belongs to drivelines", element=subject.name, key="speed", value=speed, remedy=remedy)
        return subject
    if isinstance(subject, Driveline):
        from trunnion.driveline.operating_speed import operating_speed
        from trunnion.equations.line_system import line_system
        from trunnion.equations.sliders import NOT_FOLLOWED, STAND_IN, refuse_friction
        from trunnion.equations.slip_clutches import refuse_slip_clutches
        from trunnion.equations.steady_base import refuse_dragged

        refuse_friction(subject, NOT_FOLLOWED, STAND_IN)
        refuse_slip_clutches(subject)
        prepared = line_system(subject, operating_speed(subject, speed))
        refuse_dragged(prepared.assembly)
        if prepared.assembly.topology.free:
            raise InputError(
                "is free–free: its speed follows from its torques and is not periodic in time", element="driveline",
                remedy="put a ConstantSpeed in front, or simulate it",
            )  # fmt: skip
        return prepared.system
    raise InputError(
        "is neither a System nor a Driveline", key="subject", value=type(subject).__name__,
        remedy="write tn.System.from_function(…), or load a driveline",
    )  # fmt: skip


def first_starts(system: System, start: ArrayLike | None, count: int) -> Array:
    """Starts (count, n): those given, or the first one and random neighbours of it (always the same ones).

    Raises
    ------
    InputError : no start known, a wrong shape, or not finite.
    """
    if start is None and system.start is None:
        raise InputError("is missing", element=system.name, key="start", remedy=f"give {', '.join(system.states)}")
    given = np.atleast_2d(np.asarray(system.start if start is None else start, dtype=float))
    given = np.array([system.checked_start(row) for row in given])
    if len(given) > 1:
        return given
    first = given[0]
    spread = NEIGHBOUR * (np.asarray(system.scale) + np.abs(first))
    others = first + spread * np.random.default_rng(0).uniform(-1, 1, (count - 1, system.size))
    return np.vstack([first, others])


def tilted_frame(system: System, count: int) -> Array:
    """Tangent vectors (count, n) to begin with, tilted so that none starts in an invariant plane and stays there by
    symmetry."""
    shape = count, system.size
    return np.asarray((np.eye(*shape) + 0.1 * np.random.default_rng(1).normal(size=shape)) * np.asarray(system.scale))


def turns(system: System, states: Array) -> Array:
    """Vectors (k, n) that change no rate when they are added to a state, so that states count modulo these.

    ``states`` (m, n) are samples of a motion, equal times apart. A state is an angle where 2π more of it changes
    nothing; so is one that the equations do not contain at all. Of states that run on the period is looked for, up to
    64 times as far as they move between two samples, and then that of all of them together, as of a rotation that
    only differences of angles feel. One that is not found is missing, never wrong: each is checked at several states.
    """
    few = states[:: max(len(states) // 8, 1)][:8]
    each = np.eye(system.size)
    found = [2 * np.pi * one for one in each if _unmoved(system, few, 2 * np.pi * one)]
    runs = _drift(system, states)
    for one in each:
        if runs @ one and not any(turn @ one for turn in found):
            found += _turn_along(system, few, one * (runs @ one))
    left = np.where(np.any(found, axis=0) if found else False, 0.0, runs)
    left[[*clocks(system, few)]] = 0.0
    if np.count_nonzero(left) > 1:
        found += _turn_together(system, few, left)
    return np.array(found).reshape(-1, system.size)


def _unmoved(system: System, states: Array, vector: Array) -> bool:
    rates = _rates(system, states)
    size = np.abs(rates).max(axis=0) + 1e-300
    return bool(np.all(np.abs(_rates(system, states + vector) - rates) <= SAME * size))


def _drift(system: System, states: Array) -> Array:
    """By how much each state (n,) runs on between two samples, over their later half; 0 of those that do not."""
    steps = np.diff(states[len(states) // 2 :], axis=0)
    if not len(steps):
        return np.zeros(system.size)
    mean = steps.mean(axis=0)
    runs = (np.abs(mean) > 0.5 * np.abs(steps).mean(axis=0)) & (len(steps) * np.abs(mean) > np.asarray(system.scale))
    return np.where(runs, mean, 0.0)


def _turn_along(system: System, states: Array, drift: Array) -> list[Array]:
    """The shortest multiple of ``drift`` (n,) that changes no rate, at most 64 times it; none where none is found."""
    two = [(phases(system)[-1], states[0]), (phases(system)[len(phases(system)) // 2], states[-1])]
    rates = [system.rate_at(t, x, system.regime_at(t, x)) for t, x in two]
    size = np.abs(rates).max(axis=0) + 1e-300

    def change(share: float) -> Array:
        moved = [system.rate_at(t, x + share * drift, system.regime_at(t, x + share * drift)) for t, x in two]
        return np.ravel((np.array(moved) - rates) / size)

    def slope(share: float) -> Array:
        moved = [(t, x + share * drift) for t, x in two]
        return np.ravel([system.jacobian_times(t, x, drift, system.regime_at(t, x)) / size for t, x in moved])

    grid = np.arange(1, TURN_STEPS * LONGEST_REPEAT + 1) / TURN_STEPS
    off = np.array([np.abs(change(share)).max() for share in grid])
    if off.max() <= SAME:
        return []
    near = [i for i in range(1, len(grid) - 1) if off[i] <= min(off[i - 1], off[i + 1], TURN_NEAR * off.max())]
    for i in near[:LONGEST_REPEAT]:
        share = grid[i]
        for _ in range(8):  # Newton on the squares, as there are more rates than shares
            by = slope(share)
            share -= float(by @ change(share)) / max(float(by @ by), 1e-300)
        if abs(share - grid[i]) < 2 / TURN_STEPS and _unmoved(system, states, share * drift):
            return [share * drift]
    return []


def _turn_together(system: System, states: Array, drift: Array) -> list[Array]:
    """The same where several states run on together (``drift`` (n,)): at rates that the equations hold together, or in
    a ratio of small whole numbers."""
    scale = np.asarray(system.scale)
    matrices = [system.jacobian(t, x, system.regime_at(t, x)) for t in phases(system) for x in states]
    unfelt = null_space(np.vstack(matrices) * scale, rcond=SAME)
    along = scale * (unfelt @ (unfelt.T @ (drift / scale)))
    if np.linalg.norm((along - drift) / scale) <= TOGETHER * np.linalg.norm(drift / scale):
        turn = 2 * np.pi * along / np.abs(along).max()
        if _unmoved(system, states, turn):
            return [turn]
    first = drift[np.argmax(np.abs(drift))]
    ratio = np.array([float(Fraction(d / first).limit_denominator(LARGEST_RATIO)) for d in drift])
    if np.all(np.abs(ratio - drift / first) <= TOGETHER):
        return _turn_along(system, states, ratio * first)
    return []


def clocks(system: System, states: Array) -> dict[int, float]:
    """States that run evenly whatever the others do, and their rates [1/s]: a phase written as a state."""
    rates = _rates(system, states)
    matrices = [system.jacobian(t, x, system.regime_at(t, x)) for t in phases(system) for x in states]
    return {
        i: float(rates[0, i])
        for i in range(system.size)
        if rates[0, i] != 0.0
        and np.all(rates[:, i] == rates[0, i])
        and all(not np.any(matrix[i]) for matrix in matrices)
    }


def phases(system: System) -> list[float]:
    """Times [s] all around the forcing: at any single one a factor of it may vanish."""
    period = system.forcing_period
    return [0.0] if period is None else [period * k / PHASES for k in range(PHASES)]


def _rates(system: System, states: Array) -> Array:
    """Rates (phases · m, n) at ``states`` (m, n)."""
    return np.array([system.rate_at(t, x, system.regime_at(t, x)) for t in phases(system) for x in states])


def whole_number(key: str, value: object, least: int, most: int | None = None) -> int:
    """``value`` as a whole number within bounds; InputError otherwise."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise InputError(f"must be a whole number from {least}", key=key, value=value)
    if most is not None and value > most:
        raise InputError(f"must be {most} or less", key=key, value=int(value))
    return int(value)


def values_of(system: System, parameter: str, values: ArrayLike | tuple[float, float, int]) -> Array:
    """Rising values (m,) of one of the system's parameters, from (first, last, how many) or as they are.

    Raises
    ------
    InputError : not one of its parameters; not rising; not finite.
    """
    if parameter not in system.parameters:
        known = ", ".join(system.parameters) or "none"
        raise InputError("is not a parameter", element=system.name, key=parameter, remedy=f"parameters are: {known}")
    if isinstance(values, tuple) and len(values) == 3 and isinstance(values[2], int):
        low, high, count = values
        whole_number(parameter, count, 1)
        require_memory(BYTES_A_VALUE * count, key=parameter, value=values, remedy="ask for fewer values")
        chosen = np.linspace(low, high, count)
    else:
        chosen = np.atleast_1d(np.asarray(values, dtype=float))
    if chosen.ndim != 1 or not np.all(np.isfinite(chosen)) or np.any(np.diff(chosen) <= 0) or not len(chosen):
        remedy = "write (first, last, how many) with last above first"
        raise InputError("must be rising finite numbers", key=parameter, value=values, remedy=remedy)
    return np.asarray(chosen, dtype=float)


def usual_section(system: System, states: Array, turning: Array) -> Event:
    """The mean of the state that moves most, rising; where all are angles, the first of them passing whole turns."""
    free = [j for j in range(system.size) if not turning[:, j].any()]
    if not free:
        # An angle that wanders away from its mean for ever passes whole turns again and again.
        turn = turn_of(0, turning)
        angle = system.states[0] if turn == 2 * np.pi else f"{system.states[0]}·2π/{turn:.6g}"
        return Event(_sine_of(0, turn), direction=1, name=f"sin({angle}) = 0")
    j = max(free, key=lambda j: float(np.ptp(states[:, j])) / float(np.asarray(system.scale)[j]))
    return Event(system.states[j], float(np.mean(states[:, j])), direction=1)


def turn_of(place: int, turning: Array) -> float:
    """By how much a state turns once around; 0 of one that does not turn."""
    return float(np.abs(turning[:, place]).max(initial=0.0))


@cache
def _sine_of(place: int, turn: float) -> Callable[..., Any]:
    factor = 2 * np.pi / turn

    def sine(t: float, x: Any, p: Any) -> Any:
        return np.sin(factor * x[place])

    return sine


def failure(system: System, motion: Motion, length: float, before: str) -> Outcome:
    """What stopped a motion: met again in the interpreter, which can say what it was."""
    again = integrate(
        system.equations, motion.time, motion.time + length, motion.state, regime=motion.regime,
        tolerance=motion.tolerance, most_steps=motion.most_steps, dense=False,
    )  # fmt: skip
    outcome = outcome_of(system, again, motion.tolerance, system.regimes.guards if system.regimes else ())
    if outcome.ok:
        return Outcome(False, "refused", f"{before}the tangents could not be followed any further")
    return Outcome(False, outcome.kind, f"{before}{outcome.sentence}")


def usual_time(system: System, state: Array, tolerance: float, steps: int = 32) -> float:
    """A time in which the motion of an autonomous system gets about once around, rounded to one figure.

    Where a system comes to rest the integrator's steps grow without bound, so the fastest rate of its linear
    part bounds the time too: at the end of a trial, or at the start if the trial runs away.
    """
    trial = integrate(
        system.equations, 0.0, 1e9, state, regime=system.regime_at(0.0, state), tolerance=tolerance,
        most_steps=2000, dense=False,
    )  # fmt: skip
    half = trial.length[trial.steps // 4 :]
    interval = steps * float(np.median(half)) if len(half) else 1.0
    last = trial.state[-1]
    away = not np.all(np.abs(last) <= GROWN * np.maximum(np.abs(state), np.asarray(system.scale)))
    last, regime = (state, system.regime_at(0.0, state)) if away else (last, trial.final_regime)
    matrix = system.jacobian(0.0, last, regime)
    if np.all(np.isfinite(matrix)):
        fastest = float(np.max(np.abs(np.linalg.eigvals(matrix))))
        interval = min(interval, 2 * np.pi / fastest) if fastest > 0 else min(interval, 1.0)
    power = 10.0 ** np.floor(np.log10(interval))
    return float(max(np.floor(interval / power), 1.0) * power)


def motion_size(system: System, state: Array, interval: float, tolerance: float) -> Array:
    """Largest minus smallest value (n,) of each state over the next few intervals."""
    run = integrate(
        system.equations,
        0.0,
        8 * interval,
        state,
        regime=system.regime_at(0.0, state),
        tolerance=tolerance,
        dense=False,
    )
    return np.ptp(run.state, axis=0) if run.steps else np.zeros(system.size)

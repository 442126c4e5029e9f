"""The frequency response of an oscillator by a method of choice, or by several to see which to trust.

exact                 continuation of the exact piecewise motion; the reference of the others
harmonic balance      Fourier series, followed by continuation; any system, any number of unknowns
describing function   averaging of the exact piecewise force with its mean: one harmonic
averaging             first order about a cubic fit
multiple scales       first order about a cubic fit
sweep up, sweep down  settled motion step by step, as a bench would find it
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from inspect import signature
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.analyses.orbits.branch import PeriodicBranch
from trunnion.analyses.orbits.free_play import require_contact, require_forced
from trunnion.analyses.orbits.frequency_response_result import FrequencyResponse, ResponseComparison, place_of
from trunnion.analyses.orbits.harmonic_balance import harmonic_balance
from trunnion.analyses.orbits.harmonic_balance_springs import SpringBalance, balance_springs
from trunnion.analyses.orbits.periodic_branch import periodic_branch
from trunnion.analyses.orbits.piecewise_branch import piecewise_branch
from trunnion.analyses.orbits.piecewise_orbit import piecewise_orbit
from trunnion.analyses.orbits.piecewise_sweep import sweep
from trunnion.analyses.perturbation.averaging import averaging
from trunnion.analyses.perturbation.describing_function import DescribingFunction
from trunnion.analyses.perturbation.multiple_scales import multiple_scales
from trunnion.analyses.perturbation.slow_flow import ApproximateResponse
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed
from trunnion.driveline.refusals import nearest
from trunnion.equations.line_system import line_system
from trunnion.equations.stage_laws import has_stages
from trunnion.errors import InputError
from trunnion.numerics import harmonics as fourier
from trunnion.results.speeds import frequency_unit
from trunnion.results.verdict import Verdict
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator
from trunnion.systems.second_order import SecondOrder
from trunnion.systems.system import System

WORKS: dict[str, Callable[..., Any]] = {
    "exact": piecewise_branch,
    "harmonic balance": harmonic_balance,
    "describing function": DescribingFunction,
    "averaging": averaging,
    "multiple scales": multiple_scales,
    "sweep up": sweep,
    "sweep down": sweep,
    "shooting": periodic_branch,
}
"""What does the work of a method, and whose arguments the method takes."""
METHODS = tuple(WORKS)[:-1]
"""Those of a piecewise oscillator."""
OF_SYSTEMS = ("harmonic balance", "shooting")
REPORTING = ("exact", "shooting")
BALANCED = 20
"""Harmonics of a piecewise oscillator where none are asked for: folds to 1e-7."""
SWEPT, SAMPLES = 101, 1024


def methods_of(system: PiecewiseOscillator | SecondOrder | System | Driveline) -> tuple[str, ...]:
    """The methods there are for a system, the usual one first."""
    if isinstance(system, PiecewiseOscillator):
        return METHODS
    if isinstance(system, SecondOrder):
        return OF_SYSTEMS[:1]
    if isinstance(system, Driveline):
        if not any(isinstance(element, ConstantSpeed) for element in system.elements):
            return OF_SYSTEMS[1:]  # the torque of its drives is unknown
        # Shooting takes chattering contact as it is; a series would need hundreds of harmonics.
        staged = any(has_stages(element) for element in system.elements)
        return (*(OF_SYSTEMS[::-1] if staged else OF_SYSTEMS), METHODS[0])
    return OF_SYSTEMS


def frequency_response(
    system: PiecewiseOscillator | SecondOrder | System | Driveline,
    low: float,
    high: float,
    *,
    method: str = "",
    parameter: str = "",
    curve: str = "",
    begin: float | None = None,
    start: ArrayLike | None = None,
    periods: int | None = None,
    longest_step: float | None = None,
    most_points: int | None = None,
    tolerance: float | None = None,
    harmonics: int | None = None,
    tail: float | None = None,
    points: int | None = None,
    least: int | None = None,
    most: int | None = None,
    epsilon: float | None = None,
    fit_range: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> FrequencyResponse:
    """The frequency response between two frequencies by one method.

    Parameters
    ----------
    system : a piecewise oscillator; a ``SecondOrder`` system, by harmonic balance; a system forced at its parameter
        ``frequency``; or a driveline over its input speed.
    low, high : [rad/s].
    method : one of ``METHODS`` ("exact" by default) for a piecewise oscillator; "harmonic balance" (default) or
        "shooting" (default of drivelines with backlash or stages, the only one of those that start free) for the
        others; "exact" also for a driveline that ``exact_motion`` takes.
    parameter : of a system, by default "frequency"; of a driveline "speed".
    curve : which to look at, a state of a system or a shaft of a line; by default the first.
    begin : frequency [rad/s] to begin at, ``low`` by default; the branch is followed both ways from it.
    start : near the first motion: a state, or of harmonic balance a series; of sweeps the first start.
    periods : forcing periods in one of the motion.
    longest_step : of the continuation, over the range and over the size of the motion.
    most_points : of the continuation.
    tolerance : of the integration (shooting).
    harmonics, tail : how many, or how small the last ones have to be (harmonic balance).
    points : frequencies of a sweep; least, most : forcing periods at each.
    epsilon, fit_range : of multiple scales and averaging.
    progress : called with the share done (exact, shooting; the others do not call it).

    What is None is left to the method, whose own function says its default: ``piecewise_branch`` (exact),
    ``periodic_branch`` (shooting), ``harmonic_balance``, ``balance_springs``, ``sweep``, ``averaging``,
    ``multiple_scales``.

    Raises
    ------
    InputError : an unknown method, an argument that the method does not take, or what it refuses itself.
    """
    known = methods_of(system)
    chosen = method or known[0]
    if chosen not in known:
        raise InputError("is no method for this", key="method", value=chosen, remedy=nearest(chosen, list(known)))
    if curve:
        place_of(_curves(system, high), curve)  # before anything is computed
    given: dict[str, Any] = {
        "begin": begin, "start": start, "periods": periods, "longest_step": longest_step, "most_points": most_points,
        "tolerance": tolerance, "harmonics": harmonics, "tail": tail, "points": points, "least": least, "most": most,
        "epsilon": epsilon, "fit_range": fit_range, "progress": progress,
    }  # fmt: skip
    options = {name: value for name, value in given.items() if value is not None}
    if chosen not in REPORTING:
        options.pop("progress", None)  # it changes no number, so nothing is refused
    springs = isinstance(system, PiecewiseOscillator | SecondOrder)
    work: Callable[..., Any] = balance_springs if springs and chosen == "harmonic balance" else WORKS[chosen]
    _check_options(chosen, work, options, list(given))
    began = perf_counter()
    if isinstance(system, PiecewiseOscillator):
        result = _of_oscillator(system, low, high, chosen, options)
    elif isinstance(system, SecondOrder) or chosen == "exact":
        result = work(system, low, high, **options)
    else:
        result = work(system, _parameter(system, parameter), low, high, **options)
    found = _gathered(chosen, result, perf_counter() - began, curve)
    if isinstance(system, PiecewiseOscillator):
        return replace(found, unit=frequency_unit(system.speed_unit))
    return found


def compare_responses(
    system: PiecewiseOscillator,
    low: float,
    high: float,
    *,
    methods: Sequence[str] = METHODS,
    options: Mapping[str, Mapping[str, Any]] | None = None,
) -> ResponseComparison:
    """The same response by several methods; ``options``: arguments of ``frequency_response`` by method."""
    more = options or {}
    return ResponseComparison(
        {name: frequency_response(system, low, high, method=name, **more.get(name, {})) for name in methods}
    )


def _check_options(method: str, work: Callable[..., Any], options: Mapping[str, Any], known: Sequence[str]) -> None:
    """Refuse arguments that belong to other methods."""
    takes = {name for name in signature(work).parameters if name in known}
    takes |= {"points"} if work is sweep else set()
    for name, value in options.items():
        if name not in takes:
            remedy = f"leave it out: it takes {', '.join(n for n in known if n in takes) or 'none'}"
            raise InputError("does not belong to this method", element=method, key=name, value=value, remedy=remedy)


def _of_oscillator(o: PiecewiseOscillator, low: float, high: float, method: str, options: Mapping[str, Any]) -> Any:
    require_forced(o)
    if method in METHODS[:2]:
        require_contact(o, low)
    if method == "harmonic balance":
        return _balanced(o, low, high, {"harmonics": BALANCED, **options})
    work = WORKS[method]
    if work is sweep:
        grid = np.linspace(low, high, options.get("points", SWEPT))
        more = {name: value for name, value in options.items() if name != "points"}
        return sweep(o, grid if method == "sweep up" else grid[::-1], **more)
    if method == "exact":
        return piecewise_branch(o, low, high, **options)
    return work(o, **options).response(low, high)


def _balanced(o: PiecewiseOscillator, low: float, high: float, options: dict[str, Any]) -> SpringBalance:
    """Harmonic balance from its own start, or where that leads nowhere (free play), from the exact motion."""
    system = SecondOrder.of_piecewise(o)
    found = balance_springs(system, low, high, **options)
    if len(found.rows) or options.get("start") is not None:
        return found
    begin, periods = options.get("begin") or low, options.get("periods", 1)
    orbit = piecewise_orbit(o.but(frequency=begin), periods=periods)
    if not orbit.outcome.ok:
        return found
    rows = fourier.rows_of(orbit.motion(SAMPLES)[1][:, 0][None, :], SAMPLES // 8)
    return balance_springs(system, low, high, **{**options, "start": rows})


def _parameter(system: System | Driveline, parameter: str) -> str:
    """The one that is the frequency, or the speed of a line."""
    if isinstance(system, Driveline):
        return parameter or "speed"
    name = parameter or "frequency"
    if name not in system.parameters:
        raise InputError(
            "is not a parameter", element=system.name, key=name,
            remedy=f"name the one that is the frequency: {', '.join(system.parameters) or 'it has none'}",
        )  # fmt: skip
    return name


def _gathered(method: str, result: Any, seconds: float, curve: str) -> FrequencyResponse:
    if isinstance(result, ApproximateResponse):
        marks: tuple[tuple[str, float, float], ...] = tuple(("fold", f, a) for f, a in result.folds)
        return FrequencyResponse(
            method, result.frequency, result.amplitude, result.stable, marks, result.outcome, seconds, result
        )
    if method.startswith("sweep"):
        size = result.peak_to_peak / 2
        by = dict(zip(result.frequency.tolist(), size.tolist(), strict=True))
        marks = tuple(("jump", a, by[a]) for a, _ in result.jumps)
        whole = np.ones(len(size), dtype=bool)
        return FrequencyResponse(method, result.frequency, size, whole, marks, result.outcome, seconds, result)
    branch: PeriodicBranch = getattr(result, "branch", result)
    i = place_of(branch.curves, curve)
    between = np.array([p.parameter for p in branch.special])
    # A point where the stability changes belongs to both sides: it is drawn with the stable one.
    stable = (branch.verdict == Verdict.STABLE) | np.isin(branch.parameter, between) & (
        branch.verdict != Verdict.UNSTABLE
    )
    marks = tuple((p.kind, p.parameter, float(p.peak_to_peak[i]) / 2) for p in branch.special)
    half = branch.peak_to_peak[:, i] / 2
    name = branch.curves[i]
    return FrequencyResponse(
        method,
        branch.parameter,
        half,
        stable,
        marks,
        branch.outcome,
        seconds,
        result,
        name,
        branch.axis.unit if branch.problem.over.speed_unit else "rad/s",
    )


def _curves(system: PiecewiseOscillator | SecondOrder | System | Driveline, speed: float) -> tuple[str, ...]:
    if isinstance(system, PiecewiseOscillator):
        return ("x",)
    if isinstance(system, SecondOrder):
        return tuple(system.names)
    return line_system(system, speed).shafts if isinstance(system, Driveline) else system.states

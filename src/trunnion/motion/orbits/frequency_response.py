"""The frequency response of an oscillator by a method of choice, or by several to see which to trust.

exact                 continuation of the exact piecewise motion; the reference of the others
harmonic balance      Fourier series, followed by continuation; any system, any number of unknowns
describing function   averaging of the exact piecewise force with its mean: one harmonic
averaging             first order about a cubic fit
multiple scales       first order about a cubic fit
sweep up, sweep down  settled motion step by step, as a bench would find it
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from inspect import signature
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed
from trunnion.driveline.refusals import nearest
from trunnion.equations.line_system import line_system
from trunnion.equations.stage_laws import has_stages
from trunnion.errors import InputError
from trunnion.motion.orbits.branch import PeriodicBranch
from trunnion.motion.orbits.exact_orbit import piecewise_orbit
from trunnion.motion.orbits.harmonic_balance import harmonic_balance
from trunnion.motion.orbits.harmonic_balance_springs import SpringBalance, balance_springs
from trunnion.motion.orbits.periodic_branch import periodic_branch, piecewise_branch
from trunnion.motion.orbits.sweep import sweep
from trunnion.motion.perturbation.averaging import averaging
from trunnion.motion.perturbation.describing_function import DescribingFunction
from trunnion.motion.perturbation.multiple_scales import multiple_scales
from trunnion.motion.perturbation.slow_flow import ApproximateResponse, ResponseCurves, largest_stable
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.curves import at_place, places_at
from trunnion.results.fields import attribute, internal, labelled, variable
from trunnion.results.of_systems import ending
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.speeds import frequency_unit, speed_factor
from trunnion.results.variables import Attribute, Variable
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


@labelled
class FrequencyResponse(ResponseCurves, Result):
    """Half peak-to-peak over frequency by one method."""

    method: str = attribute("by which it was found")
    frequency: Array = variable("point", "rad/s", "of the excitation, in order along the curve")
    half_peak_to_peak: Array = variable("point", "", "of {self.curve}")
    stable: Flags = internal("where the motion is stable", axes="point")
    marks: tuple[tuple[str, float, float], ...] = internal(
        "(kind, frequency, half peak-to-peak) of folds, flips, grazing, or of jumps of a sweep"
    )
    outcome: Outcome = internal("how it ended")
    seconds: float = internal("that it took", "s")
    detail: Any = internal("the method's own result")
    curve: str = attribute("what is looked at: x, a state or the torque of a shaft", default="x")
    unit: str = internal("of frequencies in print, of a driveline that of its description", default="rad/s")

    @property
    def peak(self) -> tuple[float, float]:
        """Frequency and half peak-to-peak of the largest stable motion."""
        return largest_stable(self.frequency, self.half_peak_to_peak, self.stable)

    def folds(self) -> tuple[float, ...]:
        """Frequencies of the folds, falling; of a sweep, where it jumps."""
        return tuple(sorted((f for kind, f, _ in self.marks if kind in ("fold", "jump")), reverse=True))

    def at(self, frequency: float) -> list[tuple[float, bool]]:
        """Half peak-to-peak and stability of every motion at a frequency, by falling size.

        Computed there where the method follows a branch; approximations and sweeps are interpolated linearly.
        """
        branch = getattr(self.detail, "branch", self.detail)
        if isinstance(branch, PeriodicBranch):
            i = place_of(branch.curves, self.curve)
            seen = branch.swings_at(frequency)
            return sorted(((float(swing[i]) / 2, verdict is Verdict.STABLE) for swing, verdict in seen), reverse=True)
        places = places_at(self.frequency, frequency)
        size = self.half_peak_to_peak
        return sorted(((float(at_place(size, p)), bool(self.stable[int(p)])) for p in places), reverse=True)

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, stability, marks and the ending."""
        yield from super().declared()
        yield Variable("stable", self.stable, "point")
        yield Variable("mark_kind", np.array([m[0] for m in self.marks], dtype=str), "mark")
        yield Variable("mark_frequency", np.array([m[1] for m in self.marks], dtype=float), "mark", "rad/s")
        yield from ending(self.outcome)

    def __str__(self) -> str:
        unit = self.unit
        if not len(self.frequency):
            return f"no frequency response by {self.method}: {self.outcome}"
        at, size = self.peak
        factor = speed_factor(unit)
        rows = [f"  {kind} at {f * factor:.7g} {unit}, {a:.6g}" for kind, f, a in self.marks]
        of = "" if self.curve == "x" else f" of {self.curve}"
        largest = f"largest stable half peak-to-peak{of} {size:.6g} at {at * factor:.6g} {unit}"
        head = (
            f"frequency response by {self.method}: {len(self.frequency)} points, {int(self.stable.sum())} stable, "
            f"{self.seconds:.2g} s\n  {largest if np.isfinite(size) else 'no motion is stable beyond doubt'}"
        )
        return "\n".join([head, *rows, f"  {self.outcome}"])


@labelled
class ResponseComparison(ResponseCurves, Result):
    """Several methods side by side."""

    responses: Mapping[str, FrequencyResponse] = internal("by method, the others measured against the first")

    def __getitem__(self, method: str) -> FrequencyResponse:
        """One of them."""
        return self.responses[method]

    @property
    def unit(self) -> str:
        """What frequencies read in: that of the first."""
        return next((r.unit for r in self.responses.values()), "rad/s")

    def table(self, frequencies: Sequence[float] = (), unit: str | None = None) -> list[tuple[str, ...]]:
        """Rows of words: method, peak with its frequency, folds, the stable motions at some frequencies, seconds.

        ``frequencies`` in rad/s; those in the table in ``unit``, by default the description's.
        """
        unit = unit or self.unit
        factor = speed_factor(unit)
        stable = (f"stable at {f * factor:g}" for f in frequencies)
        rows: list[tuple[str, ...]] = [("method", "peak", f"at [{unit}]", "folds", *stable, "seconds")]
        for name, r in self.responses.items():
            at, size = r.peak
            folds = ", ".join(f"{f * factor:#.6g}" for f in r.folds()) or "none"
            motions = [", ".join(f"{a:#.5g}" for a, ok in r.at(f) if ok) or "none" for f in frequencies]
            rows.append((name, f"{size:#.5g}", f"{at * factor:#.6g}", folds, *motions, f"{r.seconds:.2g}"))
        return rows

    def declared(self) -> Iterator[Variable | Attribute]:
        """The points of all curves one after the other, each with its method."""
        found = list(self.responses.values())
        yield Variable("method", np.array([r.method for r in found for _ in r.frequency], dtype=str), "point")
        for name, unit in (("frequency", "rad/s"), ("half_peak_to_peak", ""), ("stable", "")):
            yield Variable(name, np.concatenate([getattr(r, name) for r in found]), "point", unit)

    def in_unit(self, unit: str | None) -> ResponseComparison:
        """The same with frequencies in ``unit``: "rpm", "Hz" or "rad/s"; None: as it is."""
        return replace(self, responses={name: one.in_unit(unit) for name, one in self.responses.items()})

    def __str__(self) -> str:
        rows = self.table()
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        return "\n".join(
            "  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows
        )


def place_of(curves: Sequence[str], curve: str) -> int:
    if not curve:
        return 0
    if curve not in curves:
        raise InputError("is not a curve of this result", key="curve", value=curve, remedy=nearest(curve, curves))
    return list(curves).index(curve)


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
    """The frequency response between two frequencies by one method, with folds, jumps and stability.

    What is None is left to the method, whose own function says its default: ``piecewise_branch`` (exact),
    ``periodic_branch`` (shooting), ``harmonic_balance``, ``balance_springs``, ``sweep``, ``averaging``,
    ``multiple_scales``.

    Parameters
    ----------
    system : a ``PiecewiseOscillator``; a ``SecondOrder`` system, by harmonic balance; a ``System`` forced at its
        parameter ``frequency``; or a ``Driveline`` over its input speed.
    low, high : ends of the range [rad/s].
    method : of a piecewise oscillator one of ``METHODS``, by default "exact". Of other systems "harmonic balance", the
        default, or "shooting". Drivelines with backlash or stages take "shooting" by default, and no other where they
        are free–free; "exact" is open to a driveline that ``exact_motion`` takes.
    parameter : of a system, by default "frequency"; of a driveline "speed".
    curve : which to look at, a state of a system or a shaft of a line; by default the first.
    begin : frequency [rad/s] to begin at, ``low`` by default; the branch is followed both ways from it.
    start : near the first motion: a state (n,), or of harmonic balance a series (n, 2H + 1); of sweeps the first start.
    periods : forcing periods in one of the motion.
    longest_step : of the continuation, over the range and over the size of the motion.
    most_points : of the continuation.
    tolerance : of the integration (shooting).
    harmonics : how many (harmonic balance).
    tail : how small the last harmonics have to be, over the largest (harmonic balance).
    points : frequencies of a sweep.
    least, most : forcing periods of a sweep at each frequency.
    epsilon : of multiple scales and averaging.
    fit_range : of multiple scales and averaging, in units of x.
    progress : called with the share done (exact, shooting; the others do not call it).

    Returns
    -------
    FrequencyResponse: half peak-to-peak over ``frequency`` (points,) [rad/s], and the method's own result as
    ``detail``.

    Raises
    ------
    InputError : an unknown method, an argument that the method does not take, or what it refuses itself.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> found = tn.frequency_response(gap, 0.85, 0.95)
    >>> [round(frequency, 5) for frequency in found.folds()]
    [0.92749]
    """
    known = methods_of(system)
    chosen = method or known[0]
    if chosen not in known:
        raise InputError("is not a method for this", key="method", value=chosen, remedy=nearest(chosen, list(known)))
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
    """The same frequency response by several methods, side by side.

    Parameters
    ----------
    system : a ``PiecewiseOscillator``.
    low, high : ends of the range [rad/s].
    methods : some of ``METHODS``; by default all.
    options : further arguments of ``frequency_response``, by method.

    Returns
    -------
    ResponseComparison: peaks, folds and the seconds that each method took, and a picture of all curves.

    Raises
    ------
    InputError : what ``frequency_response`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> found = tn.compare_responses(gap, 0.85, 0.95, methods=["exact", "averaging"])
    >>> list(found.responses)
    ['exact', 'averaging']
    """
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


def require_forced(o: PiecewiseOscillator) -> None:
    """Refuse an oscillator that nothing moves.

    Raises
    ------
    InputError : neither a force nor harmonics of it.
    """
    if not _forces(o):
        raise InputError("is zero: nothing moves", element=o.name, key="force", value=0.0, remedy="give an amplitude")


def require_contact(o: PiecewiseOscillator, lowest: float) -> None:
    """Refuse a free gap that the motion cannot cross at ``lowest`` rad/s or above: it may float anywhere in it.

    Without a mean force the swing in free play is Σ F_k/(k ω √((k m ω)² + c²)) at most, less at higher frequencies.

    Raises
    ------
    InputError : no contact is possible; says which force would reach it.
    """
    place = int(np.searchsorted(o.breakpoints, 0.0))
    if o.mean_force or not 0 < place < len(o.breakpoints) or o.slopes[place] != 0:
        return
    damping = o.damping if o.damping_law == "always" else 0.0
    reach = sum(f / (k * lowest * np.hypot(k * o.inertia * lowest, damping)) for k, f in _forces(o))
    gap = o.breakpoints[place] - o.breakpoints[place - 1]
    if 2 * reach < gap:
        raise InputError(
            f"moves less than its free play of {gap:.6g}: no contact is possible, and it may float anywhere there",
            element=o.name, key="force", value=o.force,
            remedy=f"give a mean_force, or a force {gap / (2 * reach):.3g} times larger",
        )  # fmt: skip


def _forces(o: PiecewiseOscillator) -> list[tuple[int, float]]:
    """(order, amplitude) of all that shakes it."""
    found = [(1, abs(o.force)), *((k, float(np.hypot(p, q))) for k, p, q in o.harmonics)]
    return [(k, f) for k, f in found if f > 0]

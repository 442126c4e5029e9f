"""A branch of periodic motions, whoever computed it: its points, its special points, and where it ends.

Between neighbours the following change sign and are located by bracketing (Doedel, Keller, Kernévez, Int. J.
Bifurcation and Chaos 1, 1991):

    fold                    dλ/ds
    period doubling         Π (σ + 1)                       (a multiplier passes −1)
    Neimark–Sacker          Π_{i<j} (σ_i σ_j − 1)           (a complex pair passes the unit circle)
    branch point            Π (σ − 1) without a fold        (a multiplier passes +1, as when a symmetry breaks)
    grazing                 the number of regime changes    (the motion touches a switching surface)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np

from trunnion.arrays import Array, Codes, Complex, Flags
from trunnion.numerics.continuation.arclength import CurvePoint, Ending, SolutionCurve, follow, locate
from trunnion.numerics.continuation.newton import solve
from trunnion.numerics.curves import at_place, places_at
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import coordinate, internal, labelled, variable
from trunnion.results.of_systems import ending
from trunnion.results.outcome import Outcome
from trunnion.results.parameter_names import Names
from trunnion.results.quantity_axes import QuantityAxis
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable
from trunnion.results.verdict import Verdict, flag_attributes, verdicts

Progress = Callable[[float], None]
CLOSE = 1e-9
"""Size of the last correction of a point, in units of the scales."""
STEP, LEAST_STEP = 0.1, 1e-8
"""Largest and smallest step along the branch, in units of the scales."""
NOISE = 1e-8
"""A test function below this on both sides changes sign by rounding, as Π(σ_i σ_j − 1) does without damping."""
FOLLOWING = 0.15
"""Share of the time that following takes where a motion has contacts; the rest locates its special points."""
LOCATING = 50.0
"""Time to locate a grazing, over that of looking at two neighbours which have none between them."""
BOUNDLESS = 30.0
"""Growth of the motion over the branch from which, while the parameter hardly moves, it is said to have no bound."""


class BranchProblem(Protocol):
    """What is followed: equations of a curve z = (unknowns, parameter), and what its points tell."""

    @property
    def over(self) -> Names:
        """What the branch lies over."""

    @property
    def scale(self) -> Array:
        """Size of each unknown and of the parameter that counts as one."""

    @property
    def size(self) -> int:
        """Number of states n."""

    def equations(self, z: Array) -> tuple[Array, Array]:
        """Residual and Jacobian; NaN where there is none."""

    def start(self, point: CurvePoint) -> Array:
        """State at t = 0."""

    def multipliers(self, point: CurvePoint) -> Complex:
        """Floquet multipliers that count by falling modulus; NaN where the motion cannot be computed."""

    def radius_error(self, point: CurvePoint, radius: float) -> float:
        """What the spectral radius may be off by; any bound will do that decides on which side of 1 it lies."""

    def undamped(self, point: CurvePoint) -> bool:
        """Whether nothing damps the motion, so that no disturbance of it can die out without another that grows."""

    def changes(self, point: CurvePoint) -> int:
        """Changes of regime in a period."""

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        """Peak-to-peak and largest absolute value of the curves, amplitude of the fundamental of the states, period."""


@dataclass(frozen=True)
class SpecialPoint:
    """A point where the branch turns or its stability changes.

    kind: "fold", "period doubling", "Neimark–Sacker", "branch point" or "grazing"; parameter: its value; start (n,);
    multipliers (n,); amplitude (n,) of the fundamental of every state; peak_to_peak (curves,) as in the branch.
    """

    kind: str
    parameter: float
    start: Array
    multipliers: Complex
    amplitude: Array
    peak_to_peak: Array


@labelled
class PeriodicBranch(Result):
    """Periodic motions along a branch."""

    label: str = internal("of the parameter")
    unit: str = internal("of the parameter, SI")
    period: Array = variable("point", "s")
    parameter: Array = variable("point", "{self.unit}", "{self.label}")
    start: Array = internal("state at the beginning of each motion", axes="point state")
    multipliers: Complex = variable(
        "point multiplier_number", "1", "NaN in place of those that a free–free line sets aside", name="multiplier"
    )
    verdict: Codes = variable("point", more=flag_attributes())
    peak_to_peak: Array = variable(
        "point curve", "{self.curve_unit}", "of the shaft torques of a line, or of the states of a system"
    )
    largest: Array = variable("point curve", "{self.curve_unit}", "largest absolute value")
    amplitude: Array = internal("of the fundamental of every state", axes="point state")
    curves: tuple[str, ...] = coordinate("curve")
    curve_unit: str = internal("of the curves, SI")
    special: tuple[SpecialPoint, ...] = internal("folds and other special points in order")
    outcome: Outcome = internal("where the branch ended and why")
    problem: BranchProblem = internal("whose zeros are the branch", repr=False)
    unknowns: Array = internal("points of the curve", axes="point unknown", repr=False)

    @property
    def stable(self) -> Flags:
        """Where the motion is stable, (points,)."""
        return np.asarray(self.verdict == Verdict.STABLE)

    @property
    def folds(self) -> tuple[SpecialPoint, ...]:
        """The folds in order."""
        return tuple(p for p in self.special if p.kind == "fold")

    def at(self, value: float) -> list[tuple[Array, Verdict]]:
        """Starts and verdicts of all motions of the branch at a value of the parameter.

        Each is computed there, from a guess between its neighbours, as exactly as the points of the branch; where that
        does not converge, as beside a grazing, the guess itself is given with the verdict "undecided".
        """
        return [(self.problem.start(point), verdict) for point, verdict in self._points_at(value)]

    def swings_at(self, value: float) -> list[tuple[Array, Verdict]]:
        """Peak-to-peak (curves,) and verdict of all motions of the branch at a value of the parameter, as ``at``."""
        return [(self.problem.observed(point)[0], verdict) for point, verdict in self._points_at(value)]

    def _points_at(self, value: float) -> list[tuple[CurvePoint, Verdict]]:
        guesses = [at_place(self.unknowns, place) for place in places_at(self.parameter, value)]
        return [_motion_at(self.problem, guess, value) for guess in guesses]

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, special points and the ending."""
        yield from super().declared()
        yield Variable("special_kind", np.array([p.kind for p in self.special], dtype=str), "special")
        yield Variable("special_parameter", np.array([p.parameter for p in self.special]), "special", self.unit)
        yield from ending(self.outcome)

    def plot(self, axes: Axes | None = None, *, curve: str = "", unit: str = "", jumps: bool = True) -> Axes:
        """Response curve with its jumps; see ``pictures.frequency_response.branch``."""
        return drawing(self, "plot")(self, axes, curve=curve, unit=unit, jumps=jumps)

    @property
    def axis(self) -> QuantityAxis:
        """How the parameter reads: the speed of a line in the unit of its description."""
        return self.problem.over.axis

    def __str__(self) -> str:
        if not len(self.parameter):
            return f"no branch over {self.label}: {self.outcome}"
        axis = self.axis
        counts = f"{int(self.stable.sum())} stable of {len(self.parameter)} points"
        rows = [f"  {p.kind} at {axis.number(p.parameter, 9)}" for p in self.special]
        low, high = self.parameter.min() * axis.factor, axis.number(float(self.parameter.max()))
        head = f"branch of periodic motions over {self.label} from {low:.6g} to {high}: {counts}"
        return "\n".join([head, *rows, f"  {self.outcome}"])


B = TypeVar("B", bound=PeriodicBranch)


def followed(
    problem: BranchProblem,
    first: Array,
    low: float,
    high: float,
    most_points: int,
    found: Outcome,
    *,
    tolerance: float = CLOSE,
    progress: Progress | None = None,
) -> PeriodicBranch:
    """The branch through the motion ``first`` (unknowns and parameter) that was ``found``, or none where it was not."""
    if not found.ok:
        words = f"no motion at {problem.over.said(float(first[-1]))}: {found.sentence}"
        return collect(problem, [], Outcome(False, found.kind, words))
    walk, outcome = follow_both_ways(problem, first, low, high, most_points, tolerance, progress=progress)
    return collect(problem, walk, outcome)


def follow_both_ways(
    problem: BranchProblem,
    first: Array,
    low: float,
    high: float,
    most_points: int,
    tolerance: float = CLOSE,
    stop: Callable[[CurvePoint], bool] | None = None,
    progress: Progress | None = None,
) -> tuple[list[tuple[CurvePoint, str]], Outcome]:
    """Points of the branch through ``first`` from ``low`` to ``high``, each with its kind or "", and the outcome.

    ``stop`` ends the branch at the first point it is true of; that end is an outcome of kind "stopped".
    ``progress`` is called with the share done.
    """
    report_progress = progress or (lambda share: None)
    begin = float(first[-1])
    curves: list[SolutionCurve] = []
    ways = [(d, end) for d, end in ((-1.0, low), (1.0, high)) if (end - begin) * d > 0]
    for i, (direction, end) in enumerate(ways):
        report = _part(report_progress, FOLLOWING * i / len(ways), FOLLOWING * (i + 1) / len(ways))
        curves.append(
            follow(
                problem.equations, first, scale=problem.scale, bounds=(low, high), direction=direction,
                first_step=STEP, largest_step=STEP, smallest_step=LEAST_STEP, most_points=most_points,
                tolerance=tolerance, on_point=_watched(stop, report, begin, end),
            )
        )  # fmt: skip
        if curves[-1].ending is Ending.STOPPED:
            return [(point, "") for point in curves[-1].points], _ending(problem, curves[-1])
        if curves[-1].ending is Ending.CLOSED:
            break  # the other way is the same way round
    outcomes = [_ending(problem, curve) for curve in curves]
    # Both ways from a point inside the range: the first walk is turned round and the common point kept once.
    count, walks = len(curves), []
    for i, curve in enumerate(curves):
        ahead = FOLLOWING + (1 - FOLLOWING) * np.array([i, i + 1]) / count
        walks.append(_special_points(problem, curve, _part(report_progress, *ahead)))
    whole = walks[-1]
    if len(walks) == 2 and walks[1]:
        whole = [*reversed(walks[0][1:]), *walks[1]]
    failed = [outcome for outcome in outcomes if not outcome.ok]
    return whole, failed[0] if failed else Outcome(True, "followed", "; ".join(o.sentence for o in outcomes))


def _part(report_progress: Progress, first: float, last: float) -> Progress:
    """Progress of one stage of the work, which takes it from share ``first`` to ``last``."""
    return lambda share: report_progress(float(first + (last - first) * share))


def _watched(
    stop: Callable[[CurvePoint], bool] | None, report_progress: Progress, begin: float, end: float
) -> Callable[[CurvePoint], bool]:
    """``stop``, telling of every point how far the curve has come, which only rises where it turns back."""
    farthest = 0.0

    def on_point(point: CurvePoint) -> bool:
        nonlocal farthest
        farthest = max(farthest, (point.parameter - begin) / (end - begin))
        report_progress(farthest)
        return stop is not None and stop(point)

    return on_point


def _ending(problem: BranchProblem, curve: SolutionCurve) -> Outcome:
    """The end of a curve as a sentence."""
    count = len(curve.points)
    at = problem.over.said(curve.points[-1].parameter) if count else "its start"
    if curve.ending is Ending.BOUND:
        return Outcome(True, "end", f"followed to {at}")
    if curve.ending is Ending.CLOSED:
        return Outcome(True, "closed", "the branch closes on itself")
    if curve.ending is Ending.STOPPED:
        return Outcome(False, "stopped", f"stopped at {at}")
    if _boundless(problem, curve):
        words = f"the motion grows without bound towards {at}, where nothing damps it"
        return Outcome(False, "unbounded", f"{words}; give damping, or end the range before")
    if curve.ending is Ending.POINTS:
        return Outcome(False, "points", f"stopped after {count} points at {at}; raise most_points or longest_step")
    return Outcome(
        False,
        "lost",
        f"the branch was lost at {at} after {count} points: no step converges there; lower longest_step (of a series: "
        "raise harmonics), or look for a switching surface that the motion touches",
    )


def _boundless(problem: BranchProblem, curve: SolutionCurve) -> bool:
    """Whether the last half of the curve does nothing but grow at nearly one value of the parameter."""
    if len(curve.points) < 8:
        return False
    z = curve.z / problem.scale
    size = np.linalg.norm(z[:, :-1], axis=1)
    late, parameter = size[len(z) // 2 :], z[len(z) // 2 :, -1]
    # A curve whose steps shrink grows too, but less and less: it is lost.
    growing = bool(np.all(np.diff(late) > 0)) and late[-1] > max(2 * late[0], BOUNDLESS * size.min())
    return growing and float(np.ptp(parameter)) < 0.02 * float(np.ptp(z[:, -1]))


def _special_points(
    problem: BranchProblem, curve: SolutionCurve, report_progress: Progress
) -> list[tuple[CurvePoint, str]]:
    """The points of a curve with the special ones put between their neighbours, each with its kind or ""."""
    folds = dict(curve.folds)
    tests: tuple[tuple[str, Callable[[Complex], float]], ...] = (
        ("period doubling", lambda values: float(np.prod(values + 1).real)),
        ("Neimark–Sacker", _torus),
        ("branch point", lambda values: float(np.prod(values - 1).real)),
    )
    changes = [problem.changes(point) for point in curve.points]
    values = [problem.multipliers(point) for point in curve.points]
    ahead = np.cumsum(1 + LOCATING * (np.diff(changes) != 0))
    points = [(curve.points[0], "")] if curve.points else []
    for i, (here, there) in enumerate(zip(curve.points[:-1], curve.points[1:], strict=True)):
        found: list[tuple[CurvePoint, str]] = [(folds[i], "fold")] if i in folds else []
        if changes[i] != changes[i + 1]:
            before = changes[i]
            met = _located(problem, here, there, lambda p, n=before: float(problem.changes(p) == n) - 0.5)  # type: ignore[misc]
            found += [(met, "grazing")] if met is not None else []
        for kind, test in tests:
            ends, alike = (test(values[i]), test(values[i + 1])), len(values[i]) == len(values[i + 1])
            crosses = alike and ends[0] * ends[1] < 0 and max(abs(ends[0]), abs(ends[1])) > NOISE
            if not crosses or (kind == "branch point" and i in folds):
                continue
            met = _located(problem, here, there, lambda p, f=test: f(problem.multipliers(p)))  # type: ignore[misc]
            if met is not None and (kind != "Neimark–Sacker" or _on_circle(problem.multipliers(met))):
                found.append((met, kind))
        chord = (there.z - here.z) / problem.scale
        points += sorted(found, key=lambda f: float(chord @ ((f[0].z - here.z) / problem.scale)))
        points.append((there, ""))
        report_progress(float(ahead[i] / ahead[-1]))
    return points


def _located(
    problem: BranchProblem, here: CurvePoint, there: CurvePoint, test: Callable[[CurvePoint], float]
) -> CurvePoint | None:
    return locate(problem.equations, here, there, test, scale=problem.scale, tolerance=CLOSE)


def _torus(values: Complex) -> float:
    pairs = [values[i] * values[j] - 1 for i in range(len(values)) for j in range(i)]
    return float(np.prod(pairs).real)


def _on_circle(values: Complex) -> bool:
    """Whether the pair at product one is complex (a torus is born) and not two real reciprocals."""
    near = [abs(values[i].imag) for i in range(len(values)) for j in range(i) if abs(values[i] * values[j] - 1) < 1e-5]
    return any(size > 1e-6 for size in near)


def collect(
    problem: BranchProblem,
    walk: list[tuple[CurvePoint, str]],
    outcome: Outcome,
    kind: Callable[..., B] = PeriodicBranch,  # type: ignore[assignment]
    **more: Any,
) -> B:
    """The branch from its points and the kinds of the special ones among them; ``more``: what a ``kind`` of branch
    knows besides."""
    points, n = [p for p, _ in walk], problem.size
    observed = [problem.observed(p) for p in points]
    counting = [problem.multipliers(p) for p in points]
    multipliers = np.full((len(points), n), np.nan, dtype=complex)
    for row, values in zip(multipliers, counting, strict=True):
        row[: len(values)] = values
    radius = np.array([np.abs(values).max(initial=0.0) for values in counting])
    verdict = [_verdict(problem, p, float(r)) for p, r in zip(points, radius, strict=True)]
    special = tuple(
        SpecialPoint(what, point.parameter, problem.start(point), values, seen[2], seen[0])
        for (point, what), values, seen in zip(walk, multipliers, observed, strict=True)
        if what
    )
    return kind(
        label=problem.over.label,
        unit=problem.over.unit,
        period=np.array([o[3] for o in observed]),
        parameter=np.array([p.parameter for p in points]),
        start=np.array([problem.start(p) for p in points]).reshape(-1, n),
        multipliers=multipliers,
        verdict=np.array(verdict, dtype=np.int8),
        peak_to_peak=np.array([o[0] for o in observed]).reshape(-1, len(problem.over.curves)),
        largest=np.array([o[1] for o in observed]).reshape(-1, len(problem.over.curves)),
        amplitude=np.array([o[2] for o in observed]).reshape(-1, n),
        curves=problem.over.curves,
        curve_unit=problem.over.curve_unit,
        special=special,
        outcome=outcome,
        problem=problem,
        unknowns=np.array([p.z for p in points]).reshape(len(points), len(problem.scale)),
        **more,
    )


def _motion_at(problem: BranchProblem, guess: Array, value: float) -> tuple[CurvePoint, Verdict]:
    """Point and verdict of the motion near ``guess`` (unknowns and parameter) at a value of the parameter."""
    n = len(guess) - 1
    scale = problem.scale[:n]

    def residual(x: Array) -> tuple[Array, Array]:
        left, slope = problem.equations(np.append(x * scale, value))
        return left, slope[:, :n] * scale

    root = solve(residual, guess[:n] / scale, np.ones(n), tolerance=CLOSE)
    z = np.append(root.x * scale if root.converged else guess[:n], value)
    point = CurvePoint(z, np.zeros_like(z), root.iterations)
    if not root.converged:
        return point, Verdict.UNDECIDED
    radius = float(np.abs(problem.multipliers(point)).max())
    return point, _verdict(problem, point, radius)


def _verdict(problem: BranchProblem, point: CurvePoint, radius: float) -> Verdict:
    error = problem.radius_error(point, radius)
    undamped = abs(radius - 1) <= error and problem.undamped(point)
    return Verdict(int(verdicts(radius, error, undamped)))

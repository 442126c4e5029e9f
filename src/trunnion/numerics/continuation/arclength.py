"""Following a curve of solutions through its folds: pseudo-arclength continuation (Keller 1977).

A curve is the set of z = (unknowns, parameter), n + 1 numbers, on which n equations vanish. From a point with
its tangent a step is predicted along the tangent and corrected by Newton's method in the plane across it, so
that folds, where the parameter turns back, are points like any other. Lengths are measured in z/scale.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeVar

import numpy as np
from scipy.optimize import brentq

from trunnion.arrays import Array
from trunnion.waiting import keep_time

Equations = Callable[[Array], tuple[Array, Array]]
"""z (n + 1,) → residual (n,) and its Jacobian (n, n + 1); numbers that are not finite mean "not here"."""
Test = Callable[["CurvePoint"], float]
"""A function of a point whose zero is sought between two of them."""

P = TypeVar("P")
T = TypeVar("T")

MOST_CORRECTIONS = 8
ROUNDING, ILL_CONDITIONED = 100 * float(np.finfo(float).eps), 1e-8
"""A residual of this size, in units of the unknowns, is rounding; a step that it makes is no longer than this."""
SWIFT, SLOW = 3, 5
"""Corrections up to which the step grows, and from which it shrinks."""
GROWTH, SHRINKAGE, RETREAT = 1.5, 0.7, 0.35
STRAIGHT = 0.9
"""Least cosine between the tangents of neighbours: a sharper turn may have skipped to another branch."""
MOST_BISECTIONS = 60


class Ending(StrEnum):
    """Why a curve ends."""

    BOUND = "the parameter reached the end of its range"
    CLOSED = "the curve came back to where it began"
    POINTS = "the number of points asked for was reached"
    STOPPED = "the caller stopped it"
    STALLED = "no step, however small, led to another point"


@dataclass(frozen=True)
class CurvePoint:
    """z (n + 1,), parameter last; unit tangent (n + 1,) in scaled units; steps of Newton's method it took."""

    z: Array
    tangent: Array
    corrections: int

    @property
    def parameter(self) -> float:
        """The parameter at the point."""
        return float(self.z[-1])


def once(tell: Callable[[P, CurvePoint], T]) -> Callable[[P, CurvePoint], T]:
    """A method that tells something of a point of a curve, computed once for each point of each problem."""
    place = f"_{tell.__name__}"

    def cached(self: P, point: CurvePoint) -> T:
        known: dict[bytes, T] = vars(self).setdefault(place, {})
        key = point.z.tobytes()
        if key not in known:
            known[key] = tell(self, point)
        return known[key]

    return cached


@dataclass(frozen=True)
class SolutionCurve:
    """Points in order of arclength, the folds among them (by the index of the point before), and why it ends."""

    points: tuple[CurvePoint, ...]
    folds: tuple[tuple[int, CurvePoint], ...]
    ending: Ending

    @property
    def z(self) -> Array:
        """All points, shape (points, n + 1)."""
        return np.array([point.z for point in self.points])


def follow(
    equations: Equations,
    start: Array,
    *,
    scale: Array,
    bounds: tuple[float, float],
    direction: float = 1.0,
    first_step: float = 0.02,
    largest_step: float = 0.1,
    smallest_step: float = 1e-7,
    most_points: int = 1000,
    tolerance: float = 1e-10,
    on_point: Callable[[CurvePoint], bool] = lambda point: False,
) -> SolutionCurve:
    """The curve from ``start`` on.

    Parameters
    ----------
    start : (n + 1,) near the curve; it is corrected at its own parameter first.
    scale : (n + 1,) typical size of each unknown and of the parameter's range.
    bounds : the parameter's range; where the curve leaves it, the last point lies on its edge.
    direction : sign in which the parameter changes at first.
    first_step, largest_step, smallest_step : arclength per step, in scaled units.
    tolerance : of the last correction, in scaled units.
    on_point : called with every accepted point; True ends the curve.

    Returns
    -------
    Curve; where ``start`` could not be corrected it has no points and ``Ending.STALLED``.
    """
    scale = np.asarray(scale, dtype=float)
    across = np.zeros(len(scale))
    across[-1] = 1.0
    point = correct(equations, np.asarray(start, dtype=float), across, scale=scale, tolerance=tolerance)
    if point is None:
        return SolutionCurve((), (), Ending.STALLED)
    if point.tangent[-1] * direction < 0:
        point = CurvePoint(point.z, -point.tangent, point.corrections)
    points, folds = [point], []
    step, ending = first_step, Ending.POINTS
    if on_point(point):
        return SolutionCurve((point,), (), Ending.STOPPED)
    while len(points) < most_points:
        found = _step(equations, point, step, scale, tolerance)
        if found is None:
            step *= RETREAT
            if step < smallest_step:
                ending = Ending.STALLED
                break
            continue
        if not bounds[0] <= found.parameter <= bounds[1]:
            edge = _on_edge(equations, point, found, bounds, scale, tolerance)
            if edge is not None:
                points.append(edge)
                on_point(edge)
            ending = Ending.BOUND
            break
        if found.tangent[-1] * point.tangent[-1] < 0:
            fold = locate(equations, point, found, lambda p: float(p.tangent[-1]), scale=scale, tolerance=tolerance)
            if fold is not None:
                folds.append((len(points) - 1, fold))
        points.append(found)
        if on_point(found):
            ending = Ending.STOPPED
            break
        if len(points) > 4 and _back(points[0], point, found, scale):
            ending = Ending.CLOSED
            break
        if found.corrections <= SWIFT:
            step = min(step * GROWTH, largest_step)
        elif found.corrections >= SLOW:
            step *= SHRINKAGE
        point = found
    return SolutionCurve(tuple(points), tuple(folds), ending)


def correct(
    equations: Equations,
    predicted: Array,
    across: Array,
    *,
    scale: Array,
    tolerance: float = 1e-10,
    to_rounding: bool = False,
) -> CurvePoint | None:
    """The point of the curve in the plane through ``predicted`` whose normal is ``across`` (scaled units).

    None where Newton's method does not get there, or with ``to_rounding`` at least as far as rounding lets it. The
    tangent points to the side of ``across``.
    """
    y = np.asarray(predicted, dtype=float) / scale
    target, before = float(across @ y), np.inf
    for count in range(MOST_CORRECTIONS):
        keep_time()
        residual, jacobian = equations(y * scale)
        matrix = np.vstack([jacobian * scale, across])
        # Both at once: the step, and the direction along the curve, on the side of ``across``.
        right = np.zeros((len(y), 2))
        right[:-1, 0], right[-1, 0], right[-1, 1] = -residual, target - across @ y, 1.0
        if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
            return None
        try:
            change, tangent = np.linalg.solve(matrix, right).T
        except np.linalg.LinAlgError:
            return None
        size = float(np.linalg.norm(change))
        if not size < 2 * before:
            return None
        y, before = y + change, size
        # Where the equations are ill-conditioned, steps stop shrinking at what the rounding of the residual makes.
        rounded = size < ILL_CONDITIONED and np.linalg.norm(residual) < ROUNDING * (1 + np.linalg.norm(y))
        if size < tolerance or (to_rounding and rounded):
            return CurvePoint(y * scale, tangent / np.linalg.norm(tangent), count + 1)
    return None


def locate(
    equations: Equations,
    a: CurvePoint,
    b: CurvePoint,
    test: Test,
    *,
    scale: Array,
    tolerance: float = 1e-10,
    known: tuple[float, float] | None = None,
) -> CurvePoint | None:
    """The point between neighbours ``a`` and ``b`` where ``test`` vanishes; None where it has the same sign at both.

    By Brent's method along the chord; ``known``: the test at a and b, where the caller has it already.
    """
    chord = (b.z - a.z) / scale
    across = chord / np.linalg.norm(chord)
    at_a, at_b = (test(a), test(b)) if known is None else known
    if not at_a * at_b < 0:
        return a if at_a == 0 else b if at_b == 0 else None
    tried = {0.0: (at_a, a), 1.0: (at_b, b)}

    def at(share: float) -> float:
        if share not in tried:
            start = a.z + share * (b.z - a.z)
            found = correct(equations, start, across, scale=scale, tolerance=tolerance, to_rounding=True)
            if found is None:
                raise _LostError
            tried[share] = test(found), found
        return tried[share][0]

    try:
        share = brentq(at, 0.0, 1.0, xtol=1e-12, rtol=1e-12, maxiter=MOST_BISECTIONS, disp=False)
        at(share)
    except _LostError:
        share = min(tried, key=lambda s: abs(tried[s][0]))
    return tried[share][1]


class _LostError(Exception):
    """The curve could not be found between two of its points."""


def _step(equations: Equations, point: CurvePoint, step: float, scale: Array, tolerance: float) -> CurvePoint | None:
    predicted = point.z + step * point.tangent * scale
    found = correct(equations, predicted, point.tangent, scale=scale, tolerance=tolerance)
    return found if found is not None and found.tangent @ point.tangent > STRAIGHT else None


def _on_edge(
    equations: Equations,
    inside: CurvePoint,
    outside: CurvePoint,
    bounds: tuple[float, float],
    scale: Array,
    tolerance: float,
) -> CurvePoint | None:
    edge = bounds[1] if outside.parameter > bounds[1] else bounds[0]
    if outside.parameter == inside.parameter:  # a curve along which the parameter stands still, on its bound
        return None
    share = (edge - inside.parameter) / (outside.parameter - inside.parameter)
    across = np.zeros(len(scale))
    across[-1] = np.sign(outside.parameter - inside.parameter)
    found = correct(equations, inside.z + share * (outside.z - inside.z), across, scale=scale, tolerance=tolerance)
    if found is None:
        return None
    z = found.z.copy()
    z[-1] = edge
    return CurvePoint(z, found.tangent, found.corrections)


def _back(first: CurvePoint, before: CurvePoint, now: CurvePoint, scale: Array) -> bool:
    """Whether the first point lies between the last two, on the same strand."""
    chord = (now.z - before.z) / scale
    length = float(np.linalg.norm(chord))
    along = (first.z - before.z) / scale
    share = float(along @ chord) / length**2
    aside = float(np.linalg.norm(along - share * chord))
    return 0 <= share <= 1 and aside < 0.1 * length and float(first.tangent @ now.tangent) > 0

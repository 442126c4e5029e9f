"""Newton's method: for one root, with steps cut back until the residual falls; and for many problems at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.numerics.harmonics import solved
from trunnion.waiting import keep_time

Map = Callable[[Array], tuple[Array, Array]]
"""x → P(x) − x, (m,), and its derivative, (m, m); NaN where P cannot be computed."""
Residual = Callable[[Array], Array]
"""The same without its derivative."""
CHORD = 0.2
"""Factor by which a step with a derivative that was computed before has to lessen the residual for another."""
Equations = Callable[[Places, Array], tuple[Array, Array]]


@dataclass(frozen=True)
class Root:
    """Where the iteration ended: x, the residual there and its derivative (that of the point before, where the last
    step was taken without), the residual's size in units of the scale, the number of iterations, and whether it is
    small enough."""

    x: Array
    residual: Array
    derivative: Array
    size: float
    iterations: int
    converged: bool


def solve(
    residual: Map, start: Array, scale: Array, *, tolerance: float, most: int = 30, alone: Residual | None = None
) -> Root:
    """Solve r(x) = 0 to |r_i| ≤ tolerance · (scale_i + |x_i|).

    A full step is halved up to six times while the residual does not fall. After the tolerance is met one more whole
    step is tried, which squares the error, or finds rounding there already. With ``alone``, the residual without its
    derivative, which takes far less, steps with the derivative that is known go before, as long as they bring much.
    """

    def size_of(r: Array, x: Array) -> float:
        with np.errstate(invalid="ignore"):
            return float(np.max(np.abs(r) / (scale + np.abs(x)))) if np.all(np.isfinite(r)) else np.inf

    def step_from(r: Array) -> Array:
        return np.asarray(np.linalg.lstsq(slope * scale[None, :], -r, rcond=1e-13)[0] * scale)

    def beyond(x: Array, r: Array, size: float) -> Iterator[Array]:
        """The farthest point that steps with the known derivative lead to, where they bring much."""
        reached = None
        while alone is not None and size > tolerance:
            keep_time()
            trial = x + step_from(r)
            r, before = alone(trial), size
            size = size_of(r, trial)
            if not size < CHORD * before:
                break
            x = reached = trial
        if reached is not None:
            yield reached

    x = np.array(start, dtype=float)
    r, slope = residual(x)
    size = size_of(r, x)
    best = Root(x, r, slope, size, 0, size <= tolerance)
    for count in range(1, most + 1):
        if not np.isfinite(size):
            break
        done, step = size <= tolerance, step_from(r)
        halved = (x + step / 2**halving for halving in range(1 if done else 7))
        for trial in halved if done else chain(beyond(x, r, size), halved):
            keep_time()
            r_new, slope_new = (alone(trial), slope) if done and alone is not None else residual(trial)
            new = size_of(r_new, trial)
            if new < size:
                break
        if not new < size:
            break
        x, r, slope, size = trial, r_new, slope_new, new
        best = Root(x, r, slope, size, count, size <= tolerance)
        if done:
            break
    return best


def solve_many(equations: Equations, start: Array, *, tolerance: float, most: int) -> tuple[Array, Flags]:
    """Roots (case, m) of many problems of one shape, and which were found (case,); whole steps, taken for all together.

    Parameters
    ----------
    equations : (cases (k,) still looked for, their unknowns (k, m)) → what is left (k, m) and its derivative (k, m, m).
    start : (case, m), in units in which a correction counts as one.
    tolerance : of the norm of the last correction. A case is given up where a correction is twice the one before it.
    """
    x, found = start.copy(), np.zeros(len(start), dtype=bool)
    before, left = np.full(len(x), np.inf), np.arange(len(x))
    for _ in range(most):
        keep_time()
        residual, slope = equations(left, x[left])
        change = solved(slope, -residual)
        size = np.linalg.norm(change, axis=1)
        closer = size < 2 * before[left]
        x[left] += change
        found[left], before[left] = closer & (size < tolerance), size
        left = left[closer & ~found[left]]
        if not len(left):
            break
    return x, found

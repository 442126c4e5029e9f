"""Propagator of a dense periodic linear system, with an error estimate by step halving.

    x″ = −Q(τ) x − D(τ) x′ + g(τ),   Q = M⁻¹K, D = M⁻¹C, g = M⁻¹F

is carried over one period in N equal steps of order 8, then in 2N, until both agree. Equal steps let the
coefficients be evaluated for all stages in one vectorised call, which is what a user's own function can do.
The integration runs in energy-like units (x scaled by √M, x′ by a typical frequency) so that one number
measures the error of Z. Coefficients are evaluated for as many steps at a time as ``CHUNK`` bytes hold, and only the
state is carried from step to step, so a long line needs little more memory than its matrices.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.errors import ComputationError
from trunnion.numerics.integration.runge_kutta import STAGES, A, B, C
from trunnion.numerics.jit import njit

FEWEST_STEPS, MOST_STEPS = 16, 1 << 15
EVEN = 32
"""Times at which units and a first number of steps are found."""
CHUNK = 32 * 2**20
"""Bytes that the coefficients evaluated together may take, per array."""
KEPT = 4 * 2**20
"""Bytes that the coefficients of a whole period may take, per array, to be kept for the motions that follow it."""
SMALL = 16
"""Coordinates up to which a compiled loop is quicker than matrix products."""


@dataclass(frozen=True)
class Propagation:
    """Propagator over one period.

    monodromy (2n, 2n): Z = Φ(period); particular (2n,): where the motion from rest under the forcing ends. State
    order: x, then x′. ``scale`` (2n,) are the units in which ``error``, the estimated error of Z, holds: |δZ_ij| ≲
    error · scale_i / scale_j. ``damping_trace`` is ∫ tr(M⁻¹C) dτ, which Liouville's identity equates to −ln det Z.
    ``states(start, least)`` follows one motion from ``start`` (2n,) over ``steps`` steps of equal length, or over
    ``least`` where that is more: states (steps + 1, 2n). ``adjoint(last, count)`` carries the row l = ``last`` (2n,)
    back from the end of the period, so that l·x stays for every free motion x: rows (count + 1, 2n) at equal distances.
    ``steps``, ``least`` and ``count`` are powers of two.
    """

    steps: int
    monodromy: Array
    particular: Array
    scale: Array
    error: float
    damping_trace: float
    states: Callable[[Array, int], Array]
    adjoint: Callable[[Complex, int], Complex]

    @property
    def scaled_monodromy(self) -> Array:
        """Z in the units of the error estimate; similar to Z, so its eigenvalues are the multipliers."""
        return self.monodromy * self.scale[None, :] / self.scale[:, None]


Parts = tuple[Array, Array, Array, Array]
CoefficientFunction = Callable[[Array], Parts]


def propagate(
    coefficients: CoefficientFunction, period: float, size: int, tolerance: float, least_steps: int = 0
) -> Propagation:
    """Propagate over one period with the error of Z (in energy-like units) below ``tolerance``.

    ``coefficients(τ)`` returns M, C, K (m, n, n) and F (m, n). The error of the finer of the last two runs is
    estimated as a sixteenth of their difference (order 8 would allow 1/255), plus rounding.

    Raises
    ------
    ComputationError : the coefficients are not finite or M is singular; no agreement in 32768 steps.
    """
    even, looked = _first_look(coefficients, period, size, max(FEWEST_STEPS, least_steps))
    scale, steps = _scales(even, period, size)
    steps = max(steps, least_steps)
    if steps >= MOST_STEPS:
        raise ComputationError(
            f"the fastest motion needs {steps:.3g} steps a period, more than {MOST_STEPS}: a stiffness is very large "
            "or an inertia very small beside the others; join the parts rigidly, or raise the speed"
        )
    problem = _Problem(coefficients, period, size, scale, looked)
    everything = np.concatenate([np.eye(2 * size), np.zeros((2 * size, 1))], axis=1)
    coarse = problem.march(everything, steps)
    while steps < MOST_STEPS:
        steps *= 2
        fine = problem.march(everything, steps)
        change = float(np.linalg.norm(fine.state[:, :-1] - coarse.state[:, :-1], 2)) if fine.finite else np.inf
        rounding = 4e-16 * float(np.sqrt(steps)) * max(1.0, fine.largest)
        if not np.isfinite(change):
            break
        if change / 16 <= max(tolerance, rounding):
            return Propagation(
                steps,
                fine.state[:, :-1] * scale[:, None] / scale[None, :],
                fine.state[:, -1] * scale,
                scale,
                change / 16 + rounding,
                fine.trace,
                partial(problem.follow, steps=steps),
                partial(problem.carry_back, steps=steps),
            )
        coarse = fine
    raise ComputationError(
        f"the motion over one period did not settle in {steps} steps; "
        "the coefficients vary too fast or are not smooth: raise the tolerance or, of a driveline, the speed"
    )


def _first_look(
    coefficients: CoefficientFunction, period: float, size: int, steps: int
) -> tuple[Parts, dict[int, Parts]]:
    """Coefficients at ``EVEN`` times, and at all stages by a number of steps.

    At all times that ``steps`` steps and twice as many need, which most often are all, in one call: of a small system a
    call costs more than its times. At 32 times where that would be much memory.
    """
    if 24 * steps * STAGES * size**2 > KEPT:
        return coefficients(period * np.arange(EVEN) / EVEN), {}
    stages = [_stages(0, count, period / count) for count in (steps, 2 * steps)]
    every = coefficients(np.concatenate(stages))
    cut = len(stages[0])
    coarse, fine = _part(every, slice(cut)), _part(every, slice(cut, None))
    even = slice(None, None, STAGES * max(1, 2 * steps // EVEN))  # the first stage stands where its step begins
    return _part(fine, even), {steps: coarse, 2 * steps: fine}


def _part(every: Parts, times: slice) -> Parts:
    mass, damping, stiffness, forcing = every
    return mass[times], damping[times], stiffness[times], forcing[times]


def _stages(first: int, count: int, step: float) -> Array:
    """Times of all stages of ``count`` steps, one step after the other."""
    return np.asarray(((first + np.arange(count)[:, None] + C[None, :]) * step).ravel())


def _scales(even: Parts, period: float, size: int) -> tuple[Array, int]:
    """Units of the state and a first number of steps, from the coefficients at a few times."""
    mass, damping, stiffness, _ = even
    try:
        diagonal = np.abs(np.einsum("tii->ti", mass)).mean(0)
        root = np.sqrt(diagonal)
        ratio = root[:, None] / root[None, :]
        solved = np.linalg.solve(mass, np.concatenate([stiffness, damping], axis=2))
    except np.linalg.LinAlgError:
        raise ComputationError("the mass matrix is singular: every coordinate needs an inertia") from None
    if not np.all(np.isfinite(solved)):
        raise ComputationError("the coefficients are not finite everywhere in the period")
    square = np.linalg.norm(solved[..., :size] * ratio, axis=(1, 2)).max()
    rate = np.linalg.norm(solved[..., size:] * ratio, axis=(1, 2)).max()
    frequency = max(np.sqrt(square), 2 * np.pi / period)
    steps = np.ceil(np.log2(period * max(frequency, rate) / 2 + 8))  # may be past what an integer of the machine holds
    scale = np.concatenate([1 / root, frequency / root])
    return scale, max(FEWEST_STEPS, 1 << int(steps))


@dataclass(frozen=True)
class _March:
    """Where a march ends, and the largest entry met on the way."""

    state: Array
    largest: float
    trace: float

    @property
    def finite(self) -> bool:
        return bool(np.isfinite(self.state).all())


@dataclass(frozen=True)
class _Problem:
    """The equations in energy-like units ``scale`` (2n,).

    ``looked``: by number of steps, the coefficients where they are known already. ``evaluated``: the same in the
    problem's units, of the last run whose are few.
    """

    coefficients: CoefficientFunction
    period: float
    size: int
    scale: Array
    looked: dict[int, Parts]
    evaluated: dict[int, tuple[Array, Array, Array, Array]] = field(default_factory=dict, repr=False)

    def march(self, start: Array, steps: int, kept: Array | None = None) -> _March:
        """Carry ``start`` (2n, columns) over a period.

        The last column is forced, and kept in ``kept`` if given.
        """
        state, largest, trace = start.copy(), 0.0, 0.0
        record = np.empty((0, 2 * self.size)) if kept is None else kept
        step = self.period / steps
        for first, count in self._pieces(steps, 1):
            q, d, g, damping = self._slopes(first, count, steps)
            trace += float(step * np.sum(damping * B))
            rows = record[first : first + count + 1]
            largest = max(largest, self._run(q, d, g, self._frequency, step, A, B, state[None], rows))
        return _March(state, largest, trace)

    def follow(self, start: Array, least: int, steps: int) -> Array:
        """States (steps + 1, 2n), or ``least`` + 1, of the forced motion from ``start`` (2n,), in the user's units."""
        steps = max(steps, least)
        kept = np.empty((steps + 1, 2 * self.size))
        kept[0] = start / self.scale
        self.march(kept[0][:, None], steps, kept)
        return kept * self.scale

    def carry_back(self, last: Complex, count: int, steps: int) -> Complex:
        """Rows (count + 1, 2n) of the adjoint motion that ends as ``last`` (2n,), in the user's units."""
        steps = max(steps, count)
        size, each = 2 * self.size, steps // count
        over, nothing = np.zeros((count, size, size + 1)), np.empty((0, size))
        over[:, np.arange(size), np.arange(size)] = 1.0
        for first, part in self._pieces(steps, each):
            q, d, g, _ = self._slopes(first, part, steps)
            some = over[first // each : (first + part) // each]
            self._run(q, d, g, self._frequency, self.period / steps, A, B, some, nothing)
        rows = np.empty((count + 1, size), dtype=complex)
        rows[count] = last * self.scale
        for k in reversed(range(count)):
            rows[k] = rows[k + 1] @ over[k, :, :-1]
        return np.asarray(rows / self.scale)

    @property
    def _frequency(self) -> Array:
        return self.scale[self.size :] / self.scale[: self.size]

    @property
    def _run(self) -> Callable[..., float]:
        return _march if self.size <= SMALL else _march_by_products

    def _pieces(self, steps: int, each: int) -> Iterator[tuple[int, int]]:
        """First step and number of steps of what is done together, a multiple of ``each``."""
        batch_size = each * max(1, CHUNK // (8 * STAGES * self.size**2 * each))
        return ((first, min(batch_size, steps - first)) for first in range(0, steps, batch_size))

    def _slopes(self, first: int, count: int, steps: int) -> tuple[Array, Array, Array, Array]:
        """Q/ν, D, g and tr D at the stages of ``count`` of the ``steps`` of a period, in the problem's units."""
        if 8 * steps * STAGES * self.size**2 > KEPT:
            return self._evaluated(first, count, steps)
        if steps not in self.evaluated:
            self.evaluated.clear()
            self.evaluated[steps] = self._evaluated(0, steps, steps)
        q, d, g, damping = (part[first : first + count] for part in self.evaluated[steps])
        return q, d, g, damping

    def _evaluated(self, first: int, count: int, steps: int) -> tuple[Array, Array, Array, Array]:
        n, unit = self.size, self.scale[: self.size]
        frequency = self.scale[n:] / unit
        known = self.looked.get(steps) if count == steps else None
        mass, damping, stiffness, forcing = known or self.coefficients(_stages(first, count, self.period / steps))
        diagonal = np.einsum("tii->ti", mass)
        if n > 1 and np.count_nonzero(mass) == np.count_nonzero(diagonal):
            over = 1 / diagonal
            q, d, g = stiffness * over[..., None], damping * over[..., None], forcing * over
        else:
            solved = np.linalg.solve(mass, np.concatenate([stiffness, damping, forcing[:, :, None]], axis=2))
            q, d, g = solved[..., :n], solved[..., n : 2 * n], solved[..., 2 * n]
        trace = np.trace(d, axis1=1, axis2=2).reshape(count, STAGES)
        ratio = unit[None, :] / unit[:, None]
        shape = (count, STAGES, n)
        return (
            np.ascontiguousarray(q * (ratio / frequency[:, None])).reshape(*shape, n),
            np.ascontiguousarray(d * ratio).reshape(*shape, n),
            np.ascontiguousarray(g / unit / frequency).reshape(shape),
            trace,
        )


@njit(nogil=True)
def _march(q, d, g, frequency, step, a, b, states, kept):  # type: ignore[no-untyped-def]
    """Carry each of ``states`` (part, 2n, columns) in place over as many of the steps, one part after the other.

    The last column is forced, and kept (steps + 1, 2n) unless empty.
    """
    stages, n, wide = q.shape[1], q.shape[2], states.shape[2]
    # Rows one behind the other: sums of stages then run over one long row.
    whole, each = 2 * n * wide, q.shape[0] // len(states)
    here, slopes = np.empty(whole), np.empty((stages, whole))
    largest = 0.0
    for s in range(q.shape[0]):
        flat = states[s // each].reshape(whole)
        for m in range(stages):
            slope = slopes[m]
            _weighted(flat, slopes, step, a[m], m, here)
            rows, at = slope.reshape(2 * n, wide), here.reshape(2 * n, wide)
            for i in range(n):
                rate, out = rows[i], rows[n + i]
                for c in range(wide):
                    rate[c] = frequency[i] * at[n + i, c]
                    out[c] = 0.0
                for j in range(n):
                    by_angle, by_rate, x, v = q[s, m, i, j], d[s, m, i, j], at[j], at[n + j]
                    for c in range(wide):
                        out[c] -= by_angle * x[c] + by_rate * v[c]
                out[wide - 1] += g[s, m, i]
        _weighted(flat, slopes, step, b, stages, flat)
        for k in range(whole):
            largest = max(largest, abs(flat[k]))
        if len(kept) > 0:
            for i in range(2 * n):
                kept[s + 1, i] = flat[i * wide + wide - 1]
    return largest


@njit(nogil=True, inner=True)
def _weighted(state, slopes, step, weights, stages, out):  # type: ignore[no-untyped-def]
    """out = state + step · Σ weights · slopes, all (entries,) or (stages, entries)."""
    for k in range(len(state)):
        out[k] = state[k]
    for p in range(stages):
        weight = step * weights[p]
        if weight != 0.0:
            for k in range(len(state)):
                out[k] += weight * slopes[p, k]


def _march_by_products(
    q: Array, d: Array, g: Array, frequency: Array, step: float, a: Array, b: Array, states: Array, kept: Array
) -> float:
    """``_march`` for many coordinates, where matrix products are all that counts."""
    steps, stages, n = q.shape[:3]
    slopes = np.zeros((stages, *states.shape[1:]))
    largest = 0.0
    for s in range(steps):
        state = states[s * len(states) // steps]
        for m in range(stages):
            here = state.copy()
            for p in np.flatnonzero(a[m, :m]).tolist():
                here += (step * a[m, p]) * slopes[p]
            slopes[m, :n] = frequency[:, None] * here[n:]
            slopes[m, n:] = -(q[s, m] @ here[:n] + d[s, m] @ here[n:])
            slopes[m, n:, -1] += g[s, m]
        for m in np.flatnonzero(b).tolist():
            state += (step * b[m]) * slopes[m]
        largest = max(largest, float(np.abs(state).max()))
        if len(kept):
            kept[s + 1] = state[:, -1]
    return largest

"""Propagator of a dense periodic linear system, with an error estimate by step halving.

    x″ = −Q(τ) x − D(τ) x′ + g(τ),   Q = M⁻¹K, D = M⁻¹C, g = M⁻¹F

is carried over one period in N equal steps of order 8, then in 2N, until both agree. Equal steps let the
coefficients be evaluated for all stages in one vectorised call, which is what a user's own function can do.
The integration runs in energy-like units (x scaled by √M, x′ by a typical frequency) so that one number
measures the error of Z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.errors import ComputationError
from trunnion.numerics.integration.runge_kutta import STAGES, A, B, C
from trunnion.numerics.jit import njit

Array = NDArray[np.float64]
MOST_STEPS = 1 << 15


@dataclass(frozen=True)
class Propagation:
    """Propagator over one period.

    tau (steps + 1,); matrix (steps + 1, 2n, 2n): Φ(τ) with Φ(0) = I; particular (steps + 1, 2n): the motion
    from rest under the forcing. State order: x, then x′. ``scale`` (2n,) are the units in which ``error``,
    the estimated error of Z = Φ(period), holds: |δZ_ij| ≲ error · scale_i / scale_j. ``damping_trace`` is
    ∫ tr(M⁻¹C) dτ, which Liouville's identity equates to −ln det Z.
    """

    tau: Array
    matrix: Array
    particular: Array
    scale: Array
    error: float
    damping_trace: float

    @property
    def monodromy(self) -> Array:
        """Z, shape (2n, 2n)."""
        return self.matrix[-1]

    @property
    def scaled_monodromy(self) -> Array:
        """Z in the units of the error estimate; similar to Z, so its eigenvalues are the multipliers."""
        return self.matrix[-1] * self.scale[None, :] / self.scale[:, None]


CoefficientFunction = Callable[[Array], tuple[Array, Array, Array, Array]]


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
    scale, steps = _scales(coefficients, period, size)
    steps = max(steps, least_steps)
    if steps >= MOST_STEPS:
        raise ComputationError(
            f"the fastest motion needs {steps} steps a period, more than {MOST_STEPS}: a stiffness is very large or an "
            "inertia very small beside the others; join the parts rigidly, or raise the speed"
        )
    coarse = _run(coefficients, period, size, steps, scale)
    while steps < MOST_STEPS:
        steps *= 2
        fine = _run(coefficients, period, size, steps, scale)
        change = float(np.linalg.norm(fine[0][-1] - coarse[0][-1], 2))
        rounding = 4e-16 * float(np.sqrt(steps)) * max(1.0, float(np.abs(fine[0]).max()))
        if not np.isfinite(change):
            break
        if change / 16 <= max(tolerance, rounding):
            matrix = fine[0] * scale[None, :, None] / scale[None, None, :]
            tau = np.linspace(0.0, period, steps + 1)
            return Propagation(tau, matrix, fine[1] * scale, scale, change / 16 + rounding, fine[2])
        coarse = fine
    raise ComputationError(
        f"the motion over one period did not settle in {steps} steps; "
        "the coefficients vary too fast or are not smooth: raise the tolerance or, of a driveline, the speed"
    )


def _scales(coefficients: CoefficientFunction, period: float, size: int) -> tuple[Array, int]:
    """Units of the state and a first number of steps, from the coefficients at a few times."""
    mass, damping, stiffness, _ = coefficients(period * np.arange(32) / 32)
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
    steps = int(np.ceil(period * max(frequency, rate) / 2)) + 8
    scale = np.concatenate([1 / root, frequency / root])
    return scale, 1 << max(4, int(np.ceil(np.log2(steps))))


def _run(
    coefficients: CoefficientFunction, period: float, size: int, steps: int, scale: Array
) -> tuple[Array, Array, float]:
    step = period / steps
    tau = (np.arange(steps)[:, None] + C[None, :]) * step
    mass, damping, stiffness, forcing = coefficients(tau.ravel())
    right = np.concatenate([stiffness, damping, forcing[:, :, None]], axis=2)
    solved = np.linalg.solve(mass, right)
    trace = np.trace(solved[:, :, size : 2 * size], axis1=1, axis2=2).reshape(steps, STAGES)
    unit, frequency = scale[:size], scale[size:] / scale[:size]
    ratio = unit[None, :] / unit[:, None]
    q = solved[:, :, :size] * ratio / frequency[:, None]
    d = solved[:, :, size : 2 * size] * ratio
    g = solved[:, :, 2 * size] / unit / frequency
    shape = (steps, STAGES)
    matrix, particular = _march(
        np.ascontiguousarray(q).reshape(*shape, size, size),
        np.ascontiguousarray(d).reshape(*shape, size, size),
        np.ascontiguousarray(g).reshape(*shape, size),
        frequency,
        step,
        A,
        B,
    )
    return matrix, particular, float(step * np.sum(trace * B))


@njit(cache=True, nogil=True)
def _march(q, d, g, frequency, step, a, b):  # type: ignore[no-untyped-def]
    steps, stages, n = q.shape[0], q.shape[1], q.shape[2]
    wide = 2 * n + 1  # the propagator's columns, and one for the forced motion
    states = np.zeros((steps + 1, 2 * n, wide))
    for i in range(2 * n):
        states[0, i, i] = 1.0
    slopes = np.zeros((stages, 2 * n, wide))
    here = np.zeros((2 * n, wide))
    for s in range(steps):
        for m in range(stages):
            here[:] = states[s]
            for p in range(m):
                if a[m, p] != 0.0:
                    here += (step * a[m, p]) * slopes[p]
            for i in range(n):
                slopes[m, i] = frequency[i] * here[n + i]
                row = slopes[m, n + i]
                row[:] = 0.0
                for j in range(n):
                    row -= q[s, m, i, j] * here[j] + d[s, m, i, j] * here[n + j]
                row[wide - 1] += g[s, m, i]
        states[s + 1] = states[s]
        for m in range(stages):
            if b[m] != 0.0:
                states[s + 1] += (step * b[m]) * slopes[m]
    return states[:, :, : wide - 1].copy(), states[:, :, wide - 1].copy()

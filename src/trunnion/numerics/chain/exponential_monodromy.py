"""Monodromy matrices of many periodic linear systems at once, by steps of exponentials: Magnus's method of order 6.

    x′ = A(τ) x,   x(τ + h) = exp Ω(h) x(τ),   Ω = a₁ + a₃/12 + [−20a₁ − a₃ + C₁, a₂ + C₂]/240,
    C₁ = [a₁, a₂],  C₂ = −[a₁, 2a₃ + C₁]/60,
    a₁ = hA₂,  a₂ = √15 h (A₃ − A₁)/3,  a₃ = 10h (A₃ − 2A₂ + A₁)/3   at Gauss's three nodes

(Blanes, Casas, Oteo and Ros 2009, eq 252). The length of a step follows how fast A changes, not how fast x oscillates:
a stiff line, whose modes turn many times while its joints turn once, takes few. Plain NumPy over all systems, so that
nothing is compiled. Each system is integrated in N steps and in 2N, until the multipliers that matter agree: what
fast modes leave in the matrix, they have no part in.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Places
from trunnion.numerics.spectrum import multipliers, spectral_radius
from trunnion.waiting import keep_time

Rates = Callable[[Places, Array], Array]
March = Callable[[Places, int], Array]
FIRST_STEPS = 8
MOST_STEPS = 1 << 12
CHUNK = 1 << 21
"""Numbers of A held at once."""
SHARE = 1e-3
"""Of the distance of a radius from 1, what its error may be: the verdict is then sure."""
RELEVANT = 0.9
"""Multipliers of this share of the largest modulus are compared one by one."""
_NODES = 0.5 + np.array([-1.0, 0.0, 1.0]) * np.sqrt(15) / 10
_FACTORIALS = np.cumprod(np.concatenate([[1.0], np.arange(1.0, 17.0)]))
NORM = 0.75
"""Norm up to which the Taylor series of degree 16 is exact to rounding."""


@dataclass(frozen=True)
class Monodromies:
    """matrix (case, m, m); radius and error (case,): largest modulus of a multiplier and what it may be off by;
    critical (case,): that multiplier; steps (case,). NaN where the steps did not settle."""

    matrix: Array
    radius: Array
    error: Array
    critical: Complex
    steps: Places


def exponential_monodromies(
    rates: Rates,
    cases: int,
    size: int,
    period: float,
    *,
    tolerance: float = 1e-9,
    share: float = SHARE,
    least_steps: int = FIRST_STEPS,
    aside: Callable[[Places, Array], Array] | None = None,
) -> Monodromies:
    """Monodromy matrices of ``cases`` systems x′ = A(τ)x over one period.

    Parameters
    ----------
    rates : (case numbers, τ (times,)) → A (case, times, size, size), its states in energy-like units.
    tolerance, share : difference of radii between N and 2N steps that is small enough, and the share of their distance
        from 1 that is as well; the last is sixty times better.
    least_steps : as many as follow the fastest change of A.
    aside : (case numbers, matrices) → matrices without what is not a disturbance, for the radius.
    """

    def march(which: Places, count: int) -> Array:
        return marched(rates, which, size, period, count)

    return step_halving(march, cases, size, tolerance=tolerance, share=share, least_steps=least_steps, aside=aside)


@np.errstate(over="ignore", invalid="ignore")  # steps that are far too long overflow, and are halved
def step_halving(
    march: March,
    cases: int,
    size: int,
    *,
    tolerance: float = 1e-9,
    share: float = SHARE,
    least_steps: int = FIRST_STEPS,
    aside: Callable[[Places, Array], Array] | None = None,
) -> Monodromies:
    """The same of whatever ``march`` steps: (case numbers, number of steps) → matrices (case, size, size)."""
    matrix = np.full((cases, size, size), np.nan)
    radius, error = np.full(cases, np.nan), np.full(cases, np.nan)
    critical, steps = np.full(cases, np.nan, dtype=complex), np.zeros(cases, dtype=np.intp)
    left, count = np.arange(cases), least_steps
    judged = aside or (lambda which, found: found)
    coarse = march(left, count)
    while len(left) and count < MOST_STEPS:
        count *= 2
        fine = march(left, count)
        found, off, value = _radius(judged(left, fine), judged(left, coarse))
        done = np.asarray(off <= np.maximum(tolerance, share * np.abs(1 - found)))
        matrix[left], steps[left] = fine, count
        radius[left[done]], error[left[done]], critical[left[done]] = found[done], off[done], value[done]
        left, coarse = left[~done], fine[~done]
    return Monodromies(matrix, radius, error, critical, steps)


def _radius(fine: Array, coarse: Array) -> tuple[Array, Array, Complex]:
    """ρ, the bound of its error, and the critical multiplier, of the finer matrices.

    The bound is the smaller of two: that of the matrices' difference, and how far the multipliers near the largest
    moved, which is what stiff systems go by. Rounding counts in both.
    """
    finite = np.asarray(np.isfinite(fine).all(axis=(1, 2)) & np.isfinite(coarse).all(axis=(1, 2)))
    fine, coarse = (np.where(finite[:, None, None], part, 0.0) for part in (fine, coarse))
    change = np.linalg.norm(fine - coarse, axis=(1, 2))
    values, bound = multipliers(fine, change / 16)
    radius, by_norm = spectral_radius(values, bound)
    before = np.linalg.eigvals(coarse)
    moved = np.abs(values[:, :, None] - before[:, None, :]).min(axis=2)
    near = np.abs(values) >= RELEVANT * radius[:, None]
    rounding = spectral_radius(*multipliers(fine, np.zeros(len(fine))))[1]
    # A multiplier of the coarse run that has no partner would be one that the finer lost.
    lost = np.abs(np.abs(before).max(axis=1) - radius)
    by_values = np.maximum(np.where(near, moved, 0.0).max(axis=1), lost) + rounding
    error = np.where(finite, np.minimum(by_norm, by_values), np.inf)
    critical = np.take_along_axis(values, np.abs(values).argmax(axis=1)[:, None], axis=1)[:, 0]
    return np.where(finite, radius, np.nan), error, critical


def marched(rates: Rates, which: Places, size: int, period: float, steps: int) -> Array:
    """Monodromy matrices of the systems ``which`` as products of ``steps`` exponentials."""
    out = np.empty((len(which), size, size))
    batch_size = max(1, CHUNK // (3 * min(steps, 16) * size**2))
    for first in range(0, len(which), batch_size):
        some = which[first : first + batch_size]
        product = np.broadcast_to(np.eye(size), (len(some), size, size)).copy()
        for begin in range(0, steps, 16):
            keep_time()
            count, h = min(16, steps - begin), period / steps
            tau = ((begin + np.arange(count))[:, None] + _NODES) * h
            a = rates(some, tau.ravel()).reshape(len(some), count, 3, size, size)
            for step in np.moveaxis(exponential(magnus(a, h)), 1, 0):
                product = step @ product
        out[first : first + batch_size] = product
    return out


def magnus(a: Array, step: float) -> Array:
    """Ω (…, m, m) of one step from A at Gauss's nodes (…, 3, m, m)."""
    a1 = step * a[..., 1, :, :]
    a2 = (np.sqrt(15) / 3 * step) * (a[..., 2, :, :] - a[..., 0, :, :])
    a3 = (10 / 3 * step) * (a[..., 2, :, :] - 2 * a[..., 1, :, :] + a[..., 0, :, :])
    c1 = _commutator(a1, a2)
    c2 = _commutator(a1, 2 * a3 + c1) / -60
    return np.asarray(a1 + a3 / 12 + _commutator(c1 - 20 * a1 - a3, a2 + c2) / 240)


def exponential(matrix: Array) -> Array:
    """exp of matrices (…, m, m): Taylor's series of degree 16 of matrix/2ˢ, squared s times, s for the largest."""
    largest = float(np.nanmax(np.abs(matrix).sum(axis=-1), initial=0.0))
    squarings = max(0, int(np.ceil(np.log2(largest / NORM)))) if 0 < largest < 1e12 else 0
    x = matrix / 2.0**squarings
    x2 = x @ x
    x3, x4 = x2 @ x, x2 @ x2
    one = np.eye(matrix.shape[-1])

    def block(k: int) -> Array:
        c = 1 / _FACTORIALS[k : k + 4]
        return np.asarray(c[0] * one + c[1] * x + c[2] * x2 + c[3] * x3)

    out = block(12) + x4 / _FACTORIALS[16]
    for k in (8, 4, 0):
        out = block(k) + x4 @ out
    for _ in range(squarings):
        out = out @ out
    return np.asarray(out)


def _commutator(a: Array, b: Array) -> Array:
    return np.asarray(a @ b - b @ a)

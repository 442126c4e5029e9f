"""Pixels of a patch in plain NumPy: as ``chart_pixels``, for pictures so small that compiling would take longer.

Bounds are those of ``numerics.chain.characteristic``, roots those of companion matrices.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.numerics.patches.patches import Patch


def numpy_pixels(patch: Patch, u: Array, v: Array, size: int) -> Pixels:
    """Pixels (v, u) of a patch of 2, 4 or 6 coefficients and the trace, of a line of ``size`` unknowns."""
    box, count = patch.box, patch.coefficients.shape[2]
    across = np.clip((2 * u - box.u0 - box.u1) / (box.u1 - box.u0), -1.0, 1.0)
    values = patch.weights(v) @ patch.coefficients @ np.polynomial.chebyshev.chebvander(across, count - 1).T
    bounds = patch.error_grid(u, v)
    flat, off = (part[:-1].reshape(len(part) - 1, -1) for part in (values, bounds))
    return Pixels.of(*numpy_radii(flat, off), values[-1].ravel(), size).shaped(values.shape[1:])


def numpy_radii(values: Array, bounds: Array) -> tuple[Array, Array, Complex]:
    """As ``characteristic.radii``: spectral radius, its error and the critical multiplier of columns (m, count)."""
    m, count = values.shape
    there = np.isfinite(values).all(axis=0) & np.isfinite(bounds).all(axis=0)
    e, off = values[:, there], bounds[:, there]
    roots = _pair(e) if m == 2 else _roots(e)
    size = np.abs(roots)
    which = size.argmax(axis=1)[:, None]
    largest = np.take_along_axis(size, which, axis=1)
    if m == 2:
        error = _pair_error(e, off, largest[:, 0])
    else:
        moved = _moved(size, off)
        # A root that cannot become the largest, whatever its neighbours, has no part in the error.
        inside = (0.5 * (largest - size)) ** m > moved
        inside[np.arange(len(inside)), which[:, 0]] = False
        upper = np.where(inside, 0.0, size + _bound(roots, moved))
        error = upper.max(axis=1) - largest[:, 0]
    radius, known = np.full(count, np.nan), np.full(count, np.nan)
    critical = np.full(count, np.nan, dtype=complex)
    radius[there], known[there] = largest[:, 0], error
    critical[there] = np.take_along_axis(roots, which, axis=1)[:, 0]
    return radius, known, critical


def _roots(e: Array) -> Complex:
    """Roots (count, m) of xᵐ − e₁xᵐ⁻¹ + e₂xᵐ⁻² − … from e (m, count)."""
    m, count = e.shape
    companion = np.zeros((count, m, m))
    companion[:, 0] = ((-1.0) ** np.arange(m)[:, None] * e).T
    companion[:, np.arange(1, m), np.arange(m - 1)] = 1.0
    return np.linalg.eigvals(companion).astype(complex)


def _pair(e: Array) -> Complex:
    """The two roots (count, 2) of x² − e₁x + e₂, without cancellation."""
    half, product = e[0] / 2, e[1]
    under = half * half - product
    far = half + np.copysign(np.sqrt(np.maximum(under, 0.0)), half)
    near = np.divide(product, far, out=np.zeros_like(far), where=far != 0)
    turning = half + 1j * np.sqrt(np.maximum(-under, 0.0))
    real = (under >= 0)[:, None]
    return np.where(real, np.stack([far, near], axis=1), np.stack([turning, turning.conj()], axis=1))


def _pair_error(e: Array, off: Array, radius: Array) -> Array:
    """How far the larger modulus of two roots can lie from ``radius``: its extremes over both intervals."""
    least, most = np.maximum(np.abs(e[0]) - off[0], 0.0), np.abs(e[0]) + off[0]
    low, high = e[1] - off[1], e[1] + off[1]
    upper = np.maximum(_larger_of_pair(most, low), _larger_of_pair(most, high))
    lower = _larger_of_pair(least, np.minimum(np.maximum(least * least / 4, low), high))
    return np.asarray(np.maximum(upper - radius, radius - lower) + 4e-16 * radius)


def _larger_of_pair(total: Array, product: Array) -> Array:
    under = total * total / 4 - product
    return np.where(under >= 0, total / 2 + np.sqrt(np.maximum(under, 0.0)), np.sqrt(np.maximum(product, 0.0)))


def _moved(size: Array, off: Array) -> Array:
    """How far the polynomial may be off at roots of these moduli (count, m)."""
    moved = np.zeros_like(size)
    for own in off:
        moved = moved * size + own[:, None]
    return moved


@np.errstate(divide="ignore", invalid="ignore")  # roots that coincide: the last bound is theirs
def _bound(roots: Complex, moved: Array) -> Array:
    """2 min (E/(d₁d₂⋯), (E/(d₂d₃⋯))^½, (E/(d₃⋯))^⅓, E^(1/m)) of each root, d its distances from the others by size."""
    m = roots.shape[1]
    distance = np.sort(np.abs(roots[:, :, None] - roots[:, None, :]), axis=2)[:, :, 1:]
    first, second = distance[..., 0], distance[..., 1]
    bound = moved ** (1 / m)
    alone = moved / distance[..., 2:].prod(axis=2)
    pair = alone / second
    for one in (alone ** (1 / 3), np.sqrt(pair), pair / first):
        bound = np.fmin(bound, one)
    return 2 * bound

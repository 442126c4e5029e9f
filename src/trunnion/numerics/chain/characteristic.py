"""Spectral radius from characteristic coefficients, for matrices of size 2, 4 and 6.

The characteristic polynomial of Z is Σ_k (−1)^k e_k x^{m−k}, e_0 = 1. Its coefficients are analytic in every
parameter of the system, the multipliers are not where they collide; so coefficients are what charts
interpolate, and this file turns them into multipliers per pixel. If e_k is off by ε_k, the polynomial at a
root σ moves by at most E = Σ ε_k |σ|^{m−k}, and with the other roots sorted by distance d₁ ≤ d₂ ≤ …

    |δσ| ≤ 2 min(E/(d₁d₂⋯), (E/(d₂d₃⋯))^{1/2}, (E/(d₃⋯))^{1/3}).
"""

from __future__ import annotations

import math

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.numerics.chain.quartic import CHUNK, ERROR, IMAGINARY, LEFT, RADIUS, REAL, ROWS, SETTLED, quartic_chunk
from trunnion.numerics.jit import njit
from trunnion.numerics.patches.chebyshev_rows import weighted_sum

LARGEST = 6
"""Largest matrix treated by coefficients; beyond, they are too ill-conditioned (interpolate Z itself)."""


@njit(nogil=True, fastmath=True)
def coefficients_from_matrices(matrix, error, values, bounds):  # type: ignore[no-untyped-def]
    """Fill ``values`` (count, m) with e₁…e_m of each matrix and ``bounds`` with their errors.

    Faddeev and Le Verrier: N₀ = I, e_k = tr(Z N_{k−1})/k, N_k = e_k I − Z N_{k−1}; ∂e_k/∂Z = N_{k−1}ᵀ up to
    sign, so an error ``error`` (count,) of Z in the Frobenius norm moves e_k by at most error·‖N_{k−1}‖.
    """
    m = matrix.shape[1]
    for p in range(matrix.shape[0]):
        n, product = np.empty((m, m)), np.empty((m, m))
        for i in range(m):
            for j in range(m):
                n[i, j] = 1.0 if i == j else 0.0
        for k in range(1, m + 1):
            square, trace = 0.0, 0.0
            for i in range(m):
                for j in range(m):
                    square += n[i, j] * n[i, j]
                    total = 0.0
                    for q in range(m):
                        total += matrix[p, i, q] * n[q, j]
                    product[i, j] = total
                trace += product[i, i]
            values[p, k - 1] = trace / k
            bounds[p, k - 1] = error[p] * math.sqrt(square) + 1e-16 * m * abs(trace)
            for i in range(m):
                for j in range(m):
                    n[i, j] = -product[i, j]
                n[i, i] += trace / k


def radii(values: Array, bounds: Array) -> tuple[Array, Array, Complex]:
    """Spectral radius, its error and the critical multiplier (count,) for columns of coefficients.

    values, bounds (m, count) with m = 2, 4 or 6. Columns that are not finite give NaN.
    """
    count = values.shape[1]
    radius, error, critical = np.empty((1, count)), np.empty((1, count)), np.empty((1, count, 2))
    each, row = (np.ascontiguousarray(part)[:, None] for part in (values, bounds)), np.zeros(1, dtype=np.intp)
    radii_on_rows(np.ones((1, 1)), *each, row, np.arange(count), radius, error, critical)
    return radius[0], error[0], critical.view(np.complex128)[0, :, 0]


@njit(nogil=True)
def radii_on_rows(up, along, errors, row_block, column_block, radius, error, critical):  # type: ignore[no-untyped-def]
    """``radii`` on rows of pixels whose coefficients are Σ_i up[v, i] along[k, i, u], with errors by block.

    up (v, i), along (m, i, u), errors (m, blocks, blocks), row_block (v,), column_block (u,); radius, error (v, u)
    and critical (v, u, 2), real and imaginary part, are filled. Nothing but the results passes through memory.
    """
    m, across = along.shape[0], along.shape[2]
    e, off, work = np.ones((m, CHUNK)), np.ones((m, CHUNK)), np.ones(ROWS * CHUNK)
    found, bound, root = np.empty(CHUNK), np.empty(CHUNK), np.empty((CHUNK, 2))
    high = max(1, CHUNK // max(1, across))  # rows of a narrow patch share a chunk
    for low in range(0, up.shape[0], high):
        top = min(low + high, up.shape[0])
        for at in range(0, across, CHUNK):
            end = min(at + CHUNK, across)
            wide = end - at
            for v in range(low, top):
                first = (v - low) * wide
                for k in range(m):
                    weighted_sum(up[v], along[k], at, end, e[k, first : first + wide])
                    own = errors[k, row_block[v]]
                    for u in range(wide):
                        off[k, first + u] = own[column_block[at + u]]
            count = (top - low) * wide
            _chunk(e, off, work, found[:count], bound[:count], root[:count])
            for v in range(low, top):
                first = (v - low) * wide - at
                for u in range(at, end):
                    radius[v, u], error[v, u] = found[first + u], bound[first + u]
                    critical[v, u, 0], critical[v, u, 1] = root[first + u, 0], root[first + u, 1]


@njit(nogil=True, inner=True)
def _chunk(values, bounds, work, radius, error, critical):  # type: ignore[no-untyped-def]
    """A chunk of columns, of which the first len(radius) count; roots start from those of the neighbour."""
    m = len(values)
    quartic = m == 4
    if quartic:
        quartic_chunk(values, bounds, work)
    roots, before = np.zeros(m, dtype=np.complex128), -2
    for p in range(len(radius)):
        if quartic and work[LEFT * CHUNK + p] < SETTLED:
            radius[p], error[p] = work[RADIUS * CHUNK + p], work[ERROR * CHUNK + p]
            critical[p, 0], critical[p, 1] = work[REAL * CHUNK + p], work[IMAGINARY * CHUNK + p]
        else:
            _one_radius(values, bounds, p, before == p - 1, roots, radius, error, critical)
            before = p


@njit(nogil=True, inner=True)
def _one_radius(values, bounds, p, warm, roots, radius, error, critical):  # type: ignore[no-untyped-def]
    """The same for one column; ``warm``: ``roots`` are those of its neighbour."""
    m = values.shape[0]
    total = 0.0
    for k in range(m):
        total += values[k, p] + bounds[k, p]
    if not math.isfinite(total):
        radius[p], error[p] = math.nan, math.nan
        critical[p, 0] = critical[p, 1] = roots[0] = math.nan
        return
    e, size = np.empty(m), np.empty(m)
    for k in range(m):
        e[k] = values[k, p]
    if m == 2:
        _quadratic(e[0], e[1], roots)
    elif m == 4 or not _aberth(e, roots, warm and math.isfinite(roots[0].real)):
        _companion(e, roots)
    which = 0
    for i in range(m):
        size[i] = math.sqrt(roots[i].real ** 2 + roots[i].imag ** 2)
        if size[i] > size[which]:
            which = i
    critical[p, 0], critical[p, 1] = roots[which].real, roots[which].imag
    if m == 2:
        radius[p], error[p] = size[which], _pair_error(e[0], e[1], bounds[0, p], bounds[1, p], size[which])
        return
    own = _bound(roots, size, which, bounds, p)
    upper = size[which] + own
    for i in range(m):
        if i != which and not _far_inside(size[i], size[which], bounds, p, m):
            upper = max(upper, size[i] + _bound(roots, size, i, bounds, p))
    radius[p], error[p] = size[which], upper - size[which]


@njit(nogil=True, inner=True)
def _pair_error(total, product, total_error, product_error, radius):  # type: ignore[no-untyped-def]
    """How far the larger modulus of two roots can lie from ``radius``: its extremes over both intervals.

    It rises with |total|, and falls with the product up to where the roots meet, beyond which it rises.
    """
    least, most = max(abs(total) - total_error, 0.0), abs(total) + total_error
    low, high = product - product_error, product + product_error
    upper = max(_larger_of_pair(most, low), _larger_of_pair(most, high))
    lower = _larger_of_pair(least, min(max(least * least / 4, low), high))
    return max(upper - radius, radius - lower) + 4e-16 * radius


@njit(nogil=True, inner=True)
def _larger_of_pair(total, product):  # type: ignore[no-untyped-def]
    """The larger modulus of the roots of x² − total x + product, total ≥ 0."""
    under = total * total / 4 - product
    return total / 2 + math.sqrt(under) if under >= 0 else math.sqrt(product)


@njit(nogil=True, inner=True)
def _moved(size, bounds, b, m):  # type: ignore[no-untyped-def]
    """E, how far the polynomial may be off at a root of this modulus."""
    moved = 0.0
    for k in range(m):
        moved = moved * size + bounds[k, b]
    return moved


@njit(nogil=True, inner=True)
def _far_inside(size, largest, bounds, b, m):  # type: ignore[no-untyped-def]
    """Whether a root cannot become the largest whatever its neighbours: |δσ| ≤ 2E^{1/m} at worst."""
    margin = 0.5 * (largest - size)
    power = margin
    for _ in range(m - 1):
        power *= margin
    return power > _moved(size, bounds, b, m)


@njit(nogil=True, inner=True)
def _bound(roots, size, i, bounds, b):  # type: ignore[no-untyped-def]
    m = len(roots)
    moved = _moved(size[i], bounds, b, m)
    first, second, rest = math.inf, math.inf, 1.0
    for j in range(m):
        if j != i:
            x, y = roots[i].real - roots[j].real, roots[i].imag - roots[j].imag
            d = math.sqrt(x * x + y * y)
            if d < first:
                first, second, d = d, first, second
            elif d < second:
                second, d = d, second
            if d < math.inf:
                rest *= d
    # rest: product of all but the two smallest distances. One root, two or three move together as the
    # distances are large or small beside what the error can do.
    if rest == 0.0:
        return 2 * moved ** (1 / m)
    alone = moved / rest
    if alone > second * second * second:
        bound = alone ** (1 / 3)
    else:
        pair = alone / second
        bound = math.sqrt(pair) if pair > first * first else pair / first
    # However close the roots, the product of all m distances to the true ones is at most E.
    return 2 * (min(bound, moved ** (1 / m)) if bound > 1e-3 else bound)


@njit(nogil=True, inner=True)
def _quadratic(total, product, roots):  # type: ignore[no-untyped-def]
    """Roots of x² − total x + product."""
    half = total / 2
    under = half * half - product
    if under >= 0:
        far = half + math.copysign(math.sqrt(under), half)
        roots[0], roots[1] = far, product / far if far != 0 else 0.0
    else:
        rise = math.sqrt(-under)
        roots[0], roots[1] = complex(half, rise), complex(half, -rise)


@njit(nogil=True, inner=True)
def _aberth(e, roots, warm):  # type: ignore[no-untyped-def]
    """All roots at once by Aberth's iteration, from the neighbouring pixel's roots where there are any."""
    m = len(e)
    if not warm:
        size = 1e-300
        for k in range(m):
            size = max(size, 0.5 * abs(e[k]) ** (1 / (k + 1)))
        for i in range(m):
            angle = 2 * math.pi * (i + 0.3) / m
            roots[i] = size * complex(math.cos(angle), math.sin(angle))
    largest = 1.0
    for i in range(m):
        # Two starts in one place would move together for ever.
        roots[i] *= complex(1.0 + 1e-9 * (i + 1), 1e-9 * (i - 2))
    for _ in range(60):
        largest = 0.0
        for i in range(m):
            # Real arithmetic: the compiler's complex division guards against overflow at five times the cost.
            xr, xi = roots[i].real, roots[i].imag
            size2 = xr * xr + xi * xi
            size = math.sqrt(size2)
            vr, vi, sr, si, sign, rounding = 1.0, 0.0, 0.0, 0.0, 1.0, 1.0
            for k in range(m):
                sign = -sign
                sr, si = sr * xr - si * xi + vr, sr * xi + si * xr + vi
                vr, vi = vr * xr - vi * xi + sign * e[k], vr * xi + vi * xr
                rounding = rounding * size + abs(e[k])
            value2 = vr * vr + vi * vi
            if value2 <= (1e-16 * rounding) ** 2:
                continue
            nr, ni = (sr * vr + si * vi) / value2, (si * vr - sr * vi) / value2
            for j in range(m):
                if j != i:
                    dr, di = xr - roots[j].real, xi - roots[j].imag
                    d2 = dr * dr + di * di
                    if d2 > 0:
                        nr -= dr / d2
                        ni += di / d2
            n2 = nr * nr + ni * ni
            if n2 == 0:
                return False
            roots[i] = complex(xr - nr / n2, xi + ni / n2)
            largest = max(largest, 1 / (n2 * (1e-300 + size2)))
        if largest < 1e-26:
            return True
    # Multiple roots converge slowly; what the iteration leaves is below their own sensitivity.
    return largest < 1e-14


@njit(nogil=True, inner=True)
def _companion(e, roots):  # type: ignore[no-untyped-def]
    m = len(e)
    companion = np.zeros((m, m), dtype=np.complex128)
    sign = 1.0
    for k in range(m):
        companion[0, k] = sign * e[k]
        sign = -sign
        if k + 1 < m:
            companion[k + 1, k] = 1.0
    found = np.linalg.eigvals(companion)
    for i in range(m):
        roots[i] = found[i]


def without_ones(values: Array, bounds: Array, count: int) -> tuple[Array, Array]:
    """Coefficients of the polynomial divided by (σ − 1)^count, and their bounds; ``count`` 1 or 2.

    A line that turns freely has as many multipliers that are exactly 1. Near a whole number of elastic cycles further
    ones come there, and no choice among computed roots tells them apart. An odd number of coefficients gets a root 0
    beside, which is never the largest: the result is (m − 2, points) for a pair and (m, points), the last 0, for one.
    """
    m, points = values.shape
    signs = (-1.0) ** np.arange(m + 1)[:, None]
    quotient = signs * np.concatenate([np.ones((1, points)), values])
    off = np.concatenate([np.zeros((1, points)), bounds])
    for _ in range(count):
        quotient, off = np.cumsum(quotient, axis=0), np.cumsum(off, axis=0)
    left, uncertain = (signs * quotient)[1 : m - count + 1], off[1 : m - count + 1]
    # Both have the same product of roots, which is known best.
    left[-1:], uncertain[-1:] = values[m - 1 : m], bounds[m - 1 : m]
    if count % 2:
        zero = np.zeros((1, points))
        left, uncertain = np.concatenate([left, zero]), np.concatenate([uncertain, zero])
    return np.ascontiguousarray(left), np.ascontiguousarray(uncertain)


def roots_of(values: Array) -> Complex:
    """All multipliers from one row of coefficients e₁…e_m."""
    signs = (-1.0) ** np.arange(1, len(values) + 1)
    return np.roots(np.concatenate([[1.0], signs * values])).astype(complex)

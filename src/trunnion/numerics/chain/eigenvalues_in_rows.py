"""Eigenvalues of many small matrices, eight at a time, and how sensitive one of each is.

A library finds the eigenvalues of one matrix after the other, in loops too short for vector registers. Here each
instruction serves eight matrices, as many as registers hold with all that a reflection needs (sixteen take a third
longer): reduction to Hessenberg form by reflections, then Francis's steps with double shifts (Golub and Van Loan,
Matrix Computations, algorithms 7.4.2 and 7.5.1). Each matrix has its own range of rows that are still to be parted;
outside of it nothing is reflected.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.batch import HALF
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import load, spread_half, store

MOST_SWEEPS = 30
"""Steps for one eigenvalue after which a matrix is given up."""
STUCK = 10
"""Steps after which shifts of another kind are tried once."""
EPS = 2.2e-16
EXACT = {"contract", "nsz"}
"""Liberties of the compiler that leave NaN what it is."""


@njit(nogil=True, error_model="numpy")
def eigenvalues_in_rows(matrices, size, values, hessenberg):
    """Eigenvalues of ``matrices`` (size², points), an even size, their entries by rows: values (size, points, 2) real
    and imaginary, NaN where they were not found; hessenberg (points, size, size) similar to each by rotations."""
    points = matrices.shape[1]
    h, work = np.empty(size * size * HALF), np.empty((size + 9) * HALF)
    low, high, tried = np.empty(HALF, np.int64), np.empty(HALF, np.int64), np.empty(HALF, np.int64)
    for at in range(0, points, HALF):
        used = min(HALF, points - at)
        for q in range(size * size):
            for l in range(HALF):
                h[q * HALF + l] = matrices[q, at + min(l, used - 1)]
        _reduce(h, size, work)
        for l in range(HALF):
            high[l], tried[l] = size - 1 if l < used else -1, 0
        for l in range(used):
            own = hessenberg[at + l]
            for i in range(size):
                values[i, at + l, 0] = values[i, at + l, 1] = np.nan
                for j in range(size):
                    own[i, j] = h[(i * size + j) * HALF + l]
        while True:
            first, last = size, -1
            for l in range(used):
                _part(h, size, l, low, high, tried, values[:, at + l])
                if high[l] >= 0:
                    first, last = min(first, low[l]), max(last, high[l])
            if last < 0:
                break
            _shifts(h, size, low, high, tried, work)
            _sweep(h, size, first, last, low, high, work)


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _reduce(h, size, work):
    """Hessenberg form in place."""
    for c in range(size - 2):
        first, count = c + 1, size - c - 1
        for l in range(HALF):
            square = 0.0
            for i in range(first + 1, size):
                entry = h[(i * size + c) * HALF + l]
                square += entry * entry
            head = h[(first * size + c) * HALF + l]
            norm = np.sqrt(head * head + square)
            beta = -norm if head >= 0.0 else norm
            v = head - beta
            # 2/‖v‖², v = (head − β, the rest); none where there is nothing to reflect.
            weight = 2.0 / (v * v + square) if square > 0.0 else 0.0
            work[l] = weight
            work[HALF + l] = v
            for i in range(first + 1, size):
                work[(i - first + 1) * HALF + l] = h[(i * size + c) * HALF + l]
                h[(i * size + c) * HALF + l] = 0.0
            h[(first * size + c) * HALF + l] = beta if square > 0.0 else head
        for j in range(c + 1, size):
            _reflect(h, (first * size + j) * HALF, size * HALF, count, work)
        for i in range(size):
            _reflect(h, (i * size + first) * HALF, HALF, count, work)


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _reflect(h, at, stride, count, work):
    """Reflect ``count`` numbers of every lane, ``stride`` apart from ``at`` on, by weight and vector in ``work``."""
    zero = spread_half(0.0)
    dot = zero
    for i in range(count):
        dot = dot + load(work, (i + 1) * HALF, zero) * load(h, at + i * stride, zero)
    dot = dot * load(work, 0, zero)
    for i in range(count):
        to = at + i * stride
        store(h, to, load(h, to, zero) - load(work, (i + 1) * HALF, zero) * dot)


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _part(h, size, lane, low, high, tried, values):
    """Take eigenvalues off the end of a lane's range while they stand apart, and find where what is left begins.

    A lane without anything left, or that has been tried too often, has the range … −1.
    """
    while high[lane] >= 0:
        last = high[lane]
        begin = last
        while begin > 0:
            here, above = h[(begin * size + begin) * HALF + lane], h[((begin - 1) * size + begin - 1) * HALF + lane]
            between = (begin * size + begin - 1) * HALF + lane
            if abs(h[between]) <= EPS * (abs(here) + abs(above)):
                h[between] = 0.0
                break
            begin -= 1
        low[lane] = begin
        if begin == last:
            values[last, 0], values[last, 1] = h[(last * size + last) * HALF + lane], 0.0
            high[lane], tried[lane] = last - 1, 0
        elif begin == last - 1:
            _pair(h, size, lane, last, values)
            high[lane], tried[lane] = last - 2, 0
        else:
            tried[lane] += 1
            if tried[lane] > MOST_SWEEPS or not abs(h[(last * size + last) * HALF + lane]) < np.inf:
                high[lane] = -1
            return


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _pair(h, size, lane, last, values):
    """Eigenvalues of rows ``last`` − 1 and ``last``, parted from all others."""
    upper, lower = ((last - 1) * size + last - 1) * HALF + lane, (last * size + last - 1) * HALF + lane
    p, q, r, s = h[upper], h[upper + HALF], h[lower], h[lower + HALF]
    mean, half = (p + s) / 2, (p - s) / 2
    inside = half * half + q * r
    root = np.sqrt(abs(inside))
    if inside >= 0.0:
        # The larger one without cancellation, the other from the product.
        large = mean + root if mean >= 0.0 else mean - root
        values[last, 0], values[last, 1] = large, 0.0
        values[last - 1, 0], values[last - 1, 1] = (p * s - q * r) / large if large != 0.0 else 0.0, 0.0
    else:
        values[last, 0], values[last, 1] = mean, root
        values[last - 1, 0], values[last - 1, 1] = mean, -root


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _shifts(h, size, low, high, tried, work):
    """First column of (H − σ₁)(H − σ₂) of each lane's range, σ the eigenvalues of its last two rows."""
    for l in range(HALF):
        if high[l] < 0:
            continue
        upper, lower = ((high[l] - 1) * size + high[l] - 1) * HALF + l, (high[l] * size + high[l] - 1) * HALF + l
        p, q, r, s = h[upper], h[upper + HALF], h[lower], h[lower + HALF]
        total, det = p + s, p * s - q * r
        if tried[l] % STUCK == 0:
            stride = abs(r) + abs(h[upper - HALF])
            total, det = 1.5 * stride + 2 * s, stride * stride + 1.5 * stride * s + s * s
        at, below = (low[l] * size + low[l]) * HALF + l, ((low[l] + 1) * size + low[l]) * HALF + l
        a, b, c, d, e = h[at], h[at + HALF], h[below], h[below + HALF], h[below + (size + 1) * HALF]
        work[6 * HALF + l] = a * (a - total) + b * c + det
        work[7 * HALF + l] = c * (a + d - total)
        work[8 * HALF + l] = c * e


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _sweep(h, size, first, last, low, high, work):
    """One step of Francis on rows ``first`` … ``last``, of each lane on those of its own range."""
    zero = spread_half(0.0)
    for k in range(first, last):
        three = k < last - 1
        for l in range(HALF):
            # Everything is read before anything is chosen: branches would be eight times as slow.
            x, y, z = work[l], work[HALF + l], work[2 * HALF + l]
            first_x, first_y, first_z = work[6 * HALF + l], work[7 * HALF + l], work[8 * HALF + l]
            begin, end = low[l], high[l]
            x, y, z = (first_x if k == begin else x), (first_y if k == begin else y), (first_z if k == begin else z)
            z = z if k < end - 1 else 0.0
            square = y * y + z * z
            norm = np.sqrt(x * x + square)
            v = x + norm if x >= 0.0 else x - norm
            length = v * v + square
            live = (k >= begin) & (k < end) & (length > 0.0)
            over, weight = 1.0 / v, 2.0 * v * v / length
            # v = (1, y, z) with its weight 2/‖v‖²
            work[3 * HALF + l] = weight if live else 0.0
            work[4 * HALF + l] = y * over if live else 0.0
            work[5 * HALF + l] = z * over if live else 0.0
        weight, y, z = load(work, 3 * HALF, zero), load(work, 4 * HALF, zero), load(work, 5 * HALF, zero)
        for j in range(max(first, k - 1), last + 1):
            _reflect_few(h, (k * size + j) * HALF, size * HALF, three, weight, y, z)
        for i in range(k + 1, min(k + 2, last) + 1):
            if k > first:
                store(h, (i * size + k - 1) * HALF, zero)
        for i in range(first, min(k + 3, last) + 1):
            _reflect_few(h, (i * size + k) * HALF, HALF, three, weight, y, z)
        for m in range(3):
            i = k + 1 + m
            if i <= last:
                store(work, m * HALF, load(h, (i * size + k) * HALF, zero))


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _reflect_few(h, at, stride, three, weight, y, z):
    """The same of two numbers or ``three``, by the vector (1, y, z)."""
    zero = spread_half(0.0)
    p, q = load(h, at, zero), load(h, at + stride, zero)
    if three:
        r = load(h, at + 2 * stride, zero)
        dot = weight * (p + y * q + z * r)
        store(h, at + 2 * stride, r - z * dot)
    else:
        dot = weight * (p + y * q)
    store(h, at, p - dot)
    store(h, at + stride, q - y * dot)


@njit(nogil=True, error_model="numpy")
def conditions(hessenberg, chosen, out):
    """‖left‖‖right‖/|left·right| of the eigenvalue ``chosen`` (points,) of each of ``hessenberg`` (points, m, m).

    Two steps of inverse iteration on each side, from one elimination with rows exchanged.
    """
    m = hessenberg.shape[1]
    a = np.empty((m, m), np.complex128)
    factor, swapped = np.empty(m, np.complex128), np.empty(m, np.bool_)
    right, left = np.empty(m, np.complex128), np.empty(m, np.complex128)
    for point in range(len(chosen)):
        own, value = hessenberg[point], chosen[point]
        if not (abs(value) < np.inf and abs(own[0, 0]) < np.inf):
            out[point] = np.nan
            continue
        shift, largest = value * (1 + 1e-9) + 1e-9j, 0.0
        for i in range(m):
            for j in range(max(i - 1, 0), m):
                a[i, j] = own[i, j]
                largest = max(largest, abs(own[i, j]))
            a[i, i] -= shift
            right[i] = left[i] = np.exp(1j * i)
        _eliminate(a, factor, swapped, EPS * largest)
        for _ in range(2):
            _solve(a, factor, swapped, right)
            _solve_transposed(a, factor, swapped, left)
        dot = 0j
        for i in range(m):
            dot += left[i] * right[i]
        out[point] = 1.0 / max(abs(dot), 1e-300)


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _eliminate(a, factor, swapped, least):
    """Upper triangle of a Hessenberg matrix in place, its diagonal inverted, what was subtracted, and rows that changed
    places."""
    m = len(factor)
    for k in range(m - 1):
        swapped[k] = _size(a[k + 1, k]) > _size(a[k, k])
        if swapped[k]:
            for j in range(k, m):
                a[k, j], a[k + 1, j] = a[k + 1, j], a[k, j]
        a[k, k] = 1 / (a[k, k] if _size(a[k, k]) >= least else least)
        factor[k] = a[k + 1, k] * a[k, k]
        for j in range(k + 1, m):
            a[k + 1, j] -= factor[k] * a[k, j]
    a[m - 1, m - 1] = 1 / (a[m - 1, m - 1] if _size(a[m - 1, m - 1]) >= least else least)


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _size(z):
    return abs(z.real) + abs(z.imag)


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _solve(a, factor, swapped, x):
    """x from a x = x, scaled to length 1."""
    m = len(x)
    for k in range(m - 1):
        if swapped[k]:
            x[k], x[k + 1] = x[k + 1], x[k]
        x[k + 1] -= factor[k] * x[k]
    for i in range(m - 1, -1, -1):
        for j in range(i + 1, m):
            x[i] -= a[i, j] * x[j]
        x[i] *= a[i, i]
    _to_length_one(x)


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _solve_transposed(a, factor, swapped, x):
    """x from aᵀ x = x, scaled to length 1."""
    m = len(x)
    for i in range(m):
        x[i] *= a[i, i]
        for j in range(i + 1, m):
            x[j] -= a[i, j] * x[i]
    for k in range(m - 2, -1, -1):
        x[k] -= factor[k] * x[k + 1]
        if swapped[k]:
            x[k], x[k + 1] = x[k + 1], x[k]
    _to_length_one(x)


@njit(nogil=True, fastmath=EXACT, error_model="numpy", inner=True)
def _to_length_one(x):
    largest = 0.0
    for value in x:
        largest = max(largest, _size(value))
    square, share = 0.0, 1 / max(largest, 1e-300)
    for i in range(len(x)):
        x[i] *= share
        square += x[i].real ** 2 + x[i].imag ** 2
    share = 1 / np.sqrt(square)
    for i in range(len(x)):
        x[i] *= share

"""Weighted sums of rows, the innermost work of evaluating patches on a grid.

A library's matrix product would start threads of its own under those that share a chart.
"""

from __future__ import annotations

from trunnion.numerics.batch import BATCH
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import load, spread, store


@njit(nogil=True, fastmath=True, error_model="numpy")
def weighted_sum(weights, rows, at, end, out):  # type: ignore[no-untyped-def]
    """out[u − at] = Σ_i weights[i] rows[i, u] for at ≤ u < end.

    Eight rows at a time, because ``out`` is loaded and stored once for all of them.
    """
    count, degrees = end - at, len(weights)
    whole = degrees - degrees % 8
    for u in range(count):
        out[u] = 0.0
    for i in range(0, whole, 8):
        a, b, c, d = weights[i], weights[i + 1], weights[i + 2], weights[i + 3]
        e, f, g, h = weights[i + 4], weights[i + 5], weights[i + 6], weights[i + 7]
        p, q, r, s = rows[i, at:end], rows[i + 1, at:end], rows[i + 2, at:end], rows[i + 3, at:end]
        t, w, x, y = rows[i + 4, at:end], rows[i + 5, at:end], rows[i + 6, at:end], rows[i + 7, at:end]
        for u in range(count):
            first = a * p[u] + b * q[u] + c * r[u] + d * s[u]
            out[u] += first + e * t[u] + f * w[u] + g * x[u] + h * y[u]
    for i in range(whole, degrees):
        a, p = weights[i], rows[i, at:end]
        for u in range(count):
            out[u] += a * p[u]


@njit(nogil=True, fastmath=True)
def weighted_sums(weights, rows, out):  # type: ignore[no-untyped-def]
    """out[q, v, u] = Σ_i weights[v, i] rows[q, i, u]; all in rows.

    Sixteen columns of two rows at a time stay in registers; what is left over is summed row by row.
    """
    count, degrees = weights.shape
    wide, zero = rows.shape[2], spread(0.0)  # type: ignore[call-arg, var-annotated]
    whole, paired = wide - wide % BATCH, count - count % 2
    for q in range(len(rows)):
        flat, to = rows[q].reshape(-1), out[q].reshape(-1)
        for v in range(0, paired, 2):
            a, b = weights[v], weights[v + 1]
            for at in range(0, whole, BATCH):
                first, second = zero, zero
                for i in range(degrees):
                    row = load(flat, i * wide + at, zero)
                    first = first + row * a[i]
                    second = second + row * b[i]
                store(to, v * wide + at, first)
                store(to, (v + 1) * wide + at, second)
        for v in range(count):
            done = whole if v < paired else 0
            weighted_sum(weights[v], rows[q], done, wide, out[q, v, done:])

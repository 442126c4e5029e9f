"""Source text of one Runge–Kutta step of a long chain: the columns of the propagator are the vector lanes.

From four unknowns on, straight-line code over all states no longer pays. Here one lane is integrated at a
time, its coefficients are scalars, and each stage is two loops over contiguous columns: the weighted sum of
earlier slopes (written out, so that every state is read and written once) and the chain's own structure.
"""

from __future__ import annotations

import numpy as np

from trunnion.numerics.integration.runge_kutta import E3, E5, STAGES, A, B

_HEAD = """\
@njit(cache=True, nogil=True, fastmath=True)
def wide_slope(parent, table, unknown, m, lane, h, x, at, k):
    n = len(parent)
    columns = 2 * n
    for i in range(n):
        o, own = i * PER_TABLE + m * PER_ROW + lane, i * PER_UNKNOWN + lane
        g, s = h * table[o + EXTRA_DAMPING * LANES], h * table[o + EXTRA_STIFFNESS * LANES]
        nu = h * unknown[own + FREQUENCY * LANES]
        for c in range(columns):
            k[at, i, c] = nu * x[n + i, c]
            k[at, n + i, c] = -g * x[n + i, c] - s * x[i, c]
    for i in range(n):
        p = parent[i]
        o, own = i * PER_TABLE + m * PER_ROW + lane, i * PER_UNKNOWN + lane
        kappa = h * unknown[own + STIFFNESS * LANES] * table[o + WAVE * LANES]
        d = h * unknown[own + DAMPING * LANES]
        if p < 0:
            for c in range(columns):
                k[at, n + i, c] -= kappa * x[i, c] + d * x[n + i, c]
        else:
            e = table[o + NEAR * LANES]
            ke, de = kappa * e + d * table[o + NEAR_SLOPE * LANES], d * e
            for c in range(columns):
                t = kappa * x[i, c] - ke * x[p, c] + d * x[n + i, c] - de * x[n + p, c]
                k[at, n + i, c] -= t
                k[at, n + p, c] += e * t
    for i in range(n):
        over = table[i * PER_TABLE + m * PER_ROW + OVER_MASS * LANES + lane]
        if over != 1.0:
            for c in range(columns):
                k[at, n + i, c] *= over
"""


def wide_step_source() -> str:
    """Function ``wide_step``: one step of one lane, any number of unknowns; also the squares of two errors and of Φ."""
    out = [
        _HEAD,
        "",
        "@njit(cache=True, nogil=True, fastmath=True)",
        "def wide_step(parent, table, unknown, lane, h, u, un, here, k):",
        "    size = u.size",
        "    flat_u, flat_n, flat_h = u.reshape(size), un.reshape(size), here.reshape(size)",
        "    flat_k = k.reshape((12, size))",
        "    wide_slope(parent, table, unknown, 0, lane, h, u, 0, k)",
    ]
    for m in range(1, STAGES):
        out += [
            "    for q in range(size):",
            f"        flat_h[q] = flat_u[q]{_sum(A[m, :m])}",
            f"    wide_slope(parent, table, unknown, {m}, lane, h, here, {m}, k)",
        ]
    out += [
        "    s5 = 0.0",
        "    s3 = 0.0",
        "    s0 = 0.0",
        "    for q in range(size):",
        f"        z = flat_u[q]{_sum(B)}",
        "        flat_n[q] = z",
        "        s0 += z * z",
        f"        five = {_sum(E5)[3:]}",
        f"        three = {_sum(E3)[3:]}",
        "        s5 += five * five",
        "        s3 += three * three",
        "    return s5, s3, s0",
    ]
    return "\n".join(out)


def _sum(weights: np.ndarray) -> str:
    return "".join(f" + {float(w)!r} * flat_k[{q}, q]" for q, w in enumerate(weights) if w != 0)

"""Source text of one Runge–Kutta step of a small chain, written out for the compiler.

For up to three unknowns the twelve stages of one column of the propagator are straight-line code over
scalars, looped over lanes: the compiler keeps them in vector registers. With unknown i, parent p,

    T_i = w_i κ_i (x_i − e_i x_p) + d_i (v_i − e_i v_p − f_i x_p)
    v_i′ = (−T_i + Σ_children e T − g_i v_i − h_i x_i)/m_i,     x_i′ = ν v_i

(κ, f, h over ν; w is the stiffness over its mean). Lines without w, g, h and m go by Taylor series instead, see
``series_step_source``.
"""

from __future__ import annotations

import numpy as np

from trunnion.numerics.chain.chain_tables import (
    DAMPING,
    EXTRA_DAMPING,
    EXTRA_STIFFNESS,
    FREQUENCY,
    LANES,
    NEAR,
    NEAR_SLOPE,
    OVER_MASS,
    PER_ROW,
    PER_TABLE,
    PER_UNKNOWN,
    STIFFNESS,
    WAVE,
)
from trunnion.numerics.integration.runge_kutta import E3, E5, STAGES, A, B


def step_source(parent: tuple[int, ...]) -> str:
    """Function ``step_with_error`` for a tree of ``len(parent)`` unknowns; squares per lane of two errors and Φ."""
    n = len(parent)
    wide = 2 * n
    out = [
        "@njit(cache=True, nogil=True, fastmath=True)",
        "def step_with_error(table, unknown, h, u, un, squares):",
        "    squares[:] = 0.0",
    ]
    out += [
        f"    for c in range({wide}):",
        f"        o = c * {wide} * LANES",
        "        for l in range(LANES):",
    ]
    body = [f"nu = h * unknown[{FREQUENCY * LANES} + l]"]
    for i in range(n):
        own = i * PER_UNKNOWN
        body += [
            f"k{i} = unknown[{own + STIFFNESS * LANES} + l]",
            f"d{i} = unknown[{own + DAMPING * LANES} + l]",
        ]
    body += [f"u{i} = u[o + {i} * LANES + l]" for i in range(wide)]
    for m in range(STAGES):
        body += _stage(m, parent)
    for i in range(wide):
        body += [f"z = u{i}{_sum(B, i)}", f"un[o + {i} * LANES + l] = z", "squares[2 * LANES + l] += z * z"]
        # A sum of squares vectorises; a running maximum takes the compiler minutes.
        body += [
            f"z = {_sum(E5, i)[3:]}",
            "squares[l] += z * z",
            f"z = {_sum(E3, i)[3:]}",
            "squares[LANES + l] += z * z",
        ]
    return "\n".join(out + ["            " + line for line in body])


def _stage(m: int, parent: tuple[int, ...]) -> list[str]:
    n = len(parent)
    lines = [f"x{i} = u{i}{_sum(A[m, :m], i)}" for i in range(2 * n)]
    lines += [f"K{m}_{i} = nu * x{n + i}" for i in range(n)]
    force = {i: f"-T{i}" for i in range(n)}
    for i, p in enumerate(parent):
        if p < 0:
            lines.append(f"T{i} = {_at(m, i, WAVE)} * k{i} * x{i} + d{i} * x{n + i}")
            continue
        lines.append(f"e{i} = {_at(m, i, NEAR)}")
        lines.append(
            f"T{i} = {_at(m, i, WAVE)} * k{i} * (x{i} - e{i} * x{p})"
            f" + d{i} * (x{n + i} - e{i} * x{n + p} - {_at(m, i, NEAR_SLOPE)} * x{p})"
        )
        force[p] += f" + e{i} * T{i}"
    for i in range(n):
        damping, stiffness = _at(m, i, EXTRA_DAMPING), _at(m, i, EXTRA_STIFFNESS)
        total = f"({force[i]} - {damping} * x{n + i} - {stiffness} * x{i}) * {_at(m, i, OVER_MASS)}"
        lines.append(f"K{m}_{n + i} = h * ({total})")
    return lines


def _at(m: int, i: int, row: int) -> str:
    return f"table[{i * PER_TABLE + m * PER_ROW + row * LANES} + l]"


def _sum(weights: np.ndarray, i: int) -> str:
    return "".join(f" + {float(w)!r} * K{q}_{i}" for q, w in enumerate(weights) if w != 0)

"""Source text of one Taylor step of a small chain, written out for the compiler.

A linear chain has a recurrence for its Taylor coefficients that costs one product of series per coupling.
With q_i = x_i − e_i x_p and θ in units of h (rates in units of ν),

    x_i′ = hν v_i,   T_i = κ_i q_i + d_i q_i′/hν,   v_i′ = h(−T_i + Σ_children e T).

At order 16 a step reaches four to five times as far as one of the order-8 Runge–Kutta pair for less than
twice the work, and its length is chosen after the coefficients are known, so that no step is ever in vain.
Everything stands in one array at constant offsets: only then does the compiler vectorise over lanes.
"""

from __future__ import annotations

import numpy as np

from trunnion.numerics.chain.chain_tables import LANES
from trunnion.numerics.chain.joint_series_source import ORDER

LAST = 4
"""Orders whose size tells how far a step may reach."""
TRACE_NODES = (ORDER + 2) // 2
"""Gauss nodes that integrate the square of a series as exactly as the series itself is known."""


class _Rows:
    """Places of rows of lanes in the work array."""

    def __init__(self, parent: tuple[int, ...]) -> None:
        self.count = 0
        n = len(parent)
        self.jointed = [i for i in range(n) if parent[i] >= 0]
        self.near = {i: self._take(ORDER + 1) for i in self.jointed}
        self.rate_damping = {i: self._take(1) for i in self.jointed}
        self.square = self._take(LAST + 1)
        self.shared = self.count
        self.stiffness = [self._take(1) for _ in range(n)]
        self.damping = [self._take(1) for _ in range(n)]
        self.frequency = self._take(1)
        self.state = [self._take(ORDER + 1) for _ in range(2 * n)]
        self.twist = {i: self._take(ORDER + 1) for i in self.jointed}
        self.torque = {i: self._take(ORDER) for i in self.jointed}

    def _take(self, rows: int) -> int:
        self.count += rows
        return self.count - rows


def series_step_source(parent: tuple[int, ...]) -> str:
    """Constants and functions of one step for a tree of ``len(parent)`` unknowns."""
    rows, n = _Rows(parent), len(parent)
    out = [
        f"WORK, SHARED = {rows.count} * LANES, {rows.shared} * LANES",
        f"NEAR_ROWS = np.array({[rows.near.get(i, -1) * LANES for i in range(n)]})",
        f"STIFFNESS_ROW, DAMPING_ROW = {rows.stiffness[0]} * LANES, {rows.damping[0]} * LANES",
        f"FREQUENCY_ROW, STATE_ROW = {rows.frequency} * LANES, {rows.state[0]} * LANES",
        f"SQUARE_ROW, SQUARES = {rows.square} * LANES, {LAST + 1} * LANES",
        *_function("column_series(w, h)"),
        *_loop(_start(n, rows)),
    ]
    for k in range(ORDER):
        out += _loop(_order(k, parent, rows))
    out += [*_function("begin_step(w, h)"), *_loop(_begin(rows))]
    out += [
        *_function("evaluate(w, wide, s, u)"),
        "    for c in range(wide):",
        "        for i in range(wide):",
        "            at, o = c * WORK + STATE_ROW + i * ROWS, (c * wide + i) * LANES",
        "            for l in range(LANES):",
        f"                u[o + l] = {_horner('w', 'at', 's')}",
    ]
    # Gauss and Legendre over the step: d (1 + e²) with e from its series.
    nodes, weights = np.polynomial.legendre.leggauss(TRACE_NODES)
    out += _function("add_damping_trace(w, i, h, s, trace)")
    out += ["    if NEAR_ROWS[i] < 0:"]
    out += ["        for l in range(LANES):", "            trace[l] += h * s * w[DAMPING_ROW + i * LANES + l]"]
    out += ["        return", "    at = NEAR_ROWS[i]", "    for l in range(LANES):", "        total = 1.0"]
    for node, weight in zip(nodes, weights, strict=True):
        out += [f"        z = {_horner('w', 'at', f'({float(node + 1) / 2!r} * s)')}"]
        out += [f"        total += {float(weight) / 2!r} * z * z"]
    out += ["        trace[l] += h * s * w[DAMPING_ROW + i * LANES + l] * total"]
    return "\n".join(out)


def _function(signature: str) -> list[str]:
    return ["", "", '@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")', f"def {signature}:"]


def _loop(body: list[str]) -> list[str]:
    return ["    for l in range(LANES):", *("        " + line for line in body)]


def _horner(array: str, at: str, s: str) -> str:
    """Value of the series of lane l at ``s``; its order 0 stands at ``at``."""
    text = f"{array}[{at} + {ORDER * LANES} + l]"
    for k in reversed(range(ORDER)):
        text = f"({text} * {s} + {array}[{at} + {k * LANES} + l])"
    return text


def _start(n: int, rows: _Rows) -> list[str]:
    """Size of Φ where the step begins."""
    squares = " + ".join(f"{_at(row)} * {_at(row)}" for row in rows.state)
    return [f"{_at(rows.square + LAST)} += {squares}"]


def _begin(rows: _Rows) -> list[str]:
    """What all columns share.

    The couplings must be as well known as the motion: the damping trace rests on them alone.
    """
    lines = [f"{_at(d)} = {_at(rows.damping[i])} / (h * {_at(rows.frequency)})" for i, d in rows.rate_damping.items()]
    for m in range(LAST):
        total = "".join(f" + {_at(row)} * {_at(row)}" for row in (e + ORDER + 1 - LAST + m for e in rows.near.values()))
        lines.append(f"{_at(rows.square + m)} = 0.0{total}")
    return [*lines, f"{_at(rows.square + LAST)} = 0.0"]


def _order(k: int, parent: tuple[int, ...], rows: _Rows) -> list[str]:
    """Coefficients of order k + 1 of one column from those up to k."""
    n = len(parent)
    lines = [f"nu = h * {_at(rows.frequency)}"]
    for i in range(n):
        lines.append(f"x{i} = nu * {_at(rows.state[n + i] + k)} * {1 / (k + 1)!r}")
        lines.append(f"{_at(rows.state[i] + k + 1)} = x{i}")
    for i, p in enumerate(parent):
        kappa = _at(rows.stiffness[i])
        if p < 0:
            rate = _at(rows.state[n + i] + k)
            lines.append(f"T{i} = {kappa} * {_at(rows.state[i] + k)} + {_at(rows.damping[i])} * {rate}")
            continue
        e, x, q = rows.near[i], rows.state[p], rows.twist[i]
        if k == 0:
            lines.append(f"{_at(q)} = {_at(rows.state[i])} - {_at(e)} * {_at(x)}")
        passed = "".join(f" - {_at(e + j)} * {_at(x + k + 1 - j)}" for j in range(1, k + 2))
        lines.append(f"q{i} = x{i} - {_at(e)} * x{p}{passed}")
        lines.append(f"{_at(q + k + 1)} = q{i}")
        lines.append(f"T{i} = {kappa} * {_at(q + k)} + {k + 1}.0 * {_at(rows.rate_damping[i])} * q{i}")
        lines.append(f"{_at(rows.torque[i] + k)} = T{i}")
    for i in range(n):
        force = f"-T{i}"
        for child in (c for c in rows.jointed if parent[c] == i):
            e, t = rows.near[child], rows.torque[child]
            force += f" + {_at(e)} * T{child}"
            force += "".join(f" + {_at(e + j)} * {_at(t + k - j)}" for j in range(1, k + 1))
        lines.append(f"v{i} = h * ({force}) * {1 / (k + 1)!r}")
        lines.append(f"{_at(rows.state[n + i] + k + 1)} = v{i}")
    if (last := k + LAST - ORDER) >= 0:
        squares = "".join(f" + x{i} * x{i} + v{i} * v{i}" for i in range(n))
        lines.append(f"{_at(rows.square + last)} += {squares[3:]}")
    return lines


def _at(row: int) -> str:
    return f"w[{row * LANES} + l]"

"""One Taylor step of a chain of unknowns, for sixteen lanes at a time.

A linear chain has a recurrence for its Taylor coefficients that costs one product of series per coupling.
With q_i = x_i − e_i x_p and θ in units of h (rates in units of ν),

    x_i′ = hν v_i,   T_i = κ_i q_i + d_i q_i′/hν,   v_i′ = h(−T_i + Σ_children e T).

At order 16 a step reaches four to five times as far as one of the order-8 Runge–Kutta pair for less than
twice the work, and its length is chosen after the coefficients are known, so that no step is ever in vain.
Two columns of the propagator go together, because they share the couplings e.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np

from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.chain_tables import DAMPING, FREQUENCY, PER_UNKNOWN, STIFFNESS
from trunnion.numerics.chain.joint_series import ORDER, ROWS
from trunnion.numerics.jit import njit
from trunnion.numerics.rows import load, spread, store

LAST = 4
"""Orders whose size tells how far a step may reach."""
LAST_SQUARE = LAST * BATCH
"""Place of the square of Φ behind the squares of those orders."""
TRACE_NODES = (ORDER + 2) // 2
"""Gauss nodes that integrate the square of a series as exactly as the series itself is known."""
_nodes, _weights = np.polynomial.legendre.leggauss(TRACE_NODES)
NODES, WEIGHTS = (_nodes + 1) / 2, _weights / 2

# Places of one unknown's numbers in the scratch of a pair of columns: twists, forces, and the series of torques.
TWIST, FORCE, TORQUE = 0, 2 * BATCH, 4 * BATCH
PER_SPARE = 4 * BATCH + 2 * ROWS


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def begin_step(parent, bent, near, squares):
    """Squares of the last orders of the couplings e: they must be as well known as the motion, since the damping trace
    rests on them alone."""
    zero = spread(0.0)
    for m in range(LAST):
        total = zero
        for i in range(len(parent)):
            if bent[i]:
                e = load(near, i * ROWS + (ORDER + 1 - LAST + m) * BATCH, zero)
                total = total + e * e
        store(squares, m * BATCH, total)
    store(squares, LAST_SQUARE, zero)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def pair_series(parent, bent, unknown, near, w, a, b, scratch, squares, h):
    """Coefficients of the columns at ``a`` and ``b`` of ``w``, whose order 0 stands there; squares are added to."""
    n = len(parent)
    zero = spread(0.0)
    nu = h * load(unknown, FREQUENCY * BATCH, zero)
    now = 0 * n  # not a constant: numba would compile for each of them anew
    _add_squares(w, a, b, now, 2 * n, squares, LAST_SQUARE + now)
    for i in range(n):
        if parent[i] >= 0:
            e, o, p = load(near, i * ROWS, zero), i * ROWS, parent[i] * ROWS
            at = i * PER_SPARE + TWIST
            store(scratch, at, load(w, a + o, zero) - e * load(w, a + p, zero))
            store(scratch, at + BATCH, load(w, b + o, zero) - e * load(w, b + p, zero))
    for k in range(ORDER):
        here, over = k * BATCH, 1.0 / (k + 1)
        for i in range(n):
            x, v, rate = i * ROWS + here + BATCH, (n + i) * ROWS + here, over * nu
            store(w, a + x, rate * load(w, a + v, zero))
            store(w, b + x, rate * load(w, b + v, zero))
            store(scratch, i * PER_SPARE + FORCE, zero)
            store(scratch, i * PER_SPARE + FORCE + BATCH, zero)
        for i in range(n):
            p, x, own = parent[i], i * ROWS + here, i * PER_SPARE
            kappa = load(unknown, i * PER_UNKNOWN + STIFFNESS * BATCH, zero)
            d = load(unknown, i * PER_UNKNOWN + DAMPING * BATCH, zero)
            fa, fb = load(scratch, own + FORCE, zero), load(scratch, own + FORCE + BATCH, zero)
            if p < 0:
                v = (n + i) * ROWS + here
                store(scratch, own + FORCE, fa - kappa * load(w, a + x, zero) - d * load(w, a + v, zero))
                store(scratch, own + FORCE + BATCH, fb - kappa * load(w, b + x, zero) - d * load(w, b + v, zero))
                continue
            e = load(near, i * ROWS, zero)
            up, torque, above = p * ROWS + here + BATCH, own + TORQUE + here, p * PER_SPARE + FORCE
            qa = load(w, a + x + BATCH, zero) - e * load(w, a + up, zero)
            qb = load(w, b + x + BATCH, zero) - e * load(w, b + up, zero)
            ga, gb = load(scratch, above, zero), load(scratch, above + BATCH, zero)
            if bent[i]:
                for j in range(BATCH, here + BATCH, BATCH):
                    c = load(near, i * ROWS + j, zero)
                    qa = qa - c * load(w, a + up - j, zero)
                    qb = qb - c * load(w, b + up - j, zero)
                    ga = ga + c * load(scratch, torque - j, zero)
                    gb = gb + c * load(scratch, torque + ROWS - j, zero)
                c = load(near, i * ROWS + here + BATCH, zero)
                qa = qa - c * load(w, a + up - here - BATCH, zero)
                qb = qb - c * load(w, b + up - here - BATCH, zero)
            slow = (k + 1.0) * d / nu
            ta = kappa * load(scratch, own + TWIST, zero) + slow * qa
            tb = kappa * load(scratch, own + TWIST + BATCH, zero) + slow * qb
            store(scratch, own + TWIST, qa)
            store(scratch, own + TWIST + BATCH, qb)
            store(scratch, torque, ta)
            store(scratch, torque + ROWS, tb)
            store(scratch, own + FORCE, fa - ta)
            store(scratch, own + FORCE + BATCH, fb - tb)
            store(scratch, above, ga + e * ta)
            store(scratch, above + BATCH, gb + e * tb)
        for i in range(n):
            v, own = (n + i) * ROWS + here + BATCH, i * PER_SPARE + FORCE
            store(w, a + v, (h * over) * load(scratch, own, zero))
            store(w, b + v, (h * over) * load(scratch, own + BATCH, zero))
        if k + LAST >= ORDER:
            _add_squares(w, a, b, here + BATCH, 2 * n, squares, (k + LAST - ORDER) * BATCH)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def _add_squares(w, a, b, order, states, squares, at):
    total = load(squares, at, spread(0.0))
    for i in range(order, order + states * ROWS, ROWS):
        x, y = load(w, a + i, total), load(w, b + i, total)
        total = total + x * x + y * y
    store(squares, at, total)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def evaluate(w, s):
    """Every state of every column after ``s`` units, into its own order 0."""
    zero = spread(0.0)
    for at in range(0, len(w), ROWS):
        total = load(w, at + ROWS - BATCH, zero)
        for k in range(ORDER - 1, -1, -1):
            total = total * s + load(w, at + k * BATCH, zero)
        store(w, at, total)


@njit(nogil=True, fastmath=True, error_model="numpy", inner=True)
def add_damping_trace(parent, bent, unknown, near, h, s, trace):
    """∫ tr(M⁻¹C) dτ over the step: d(1 + e²) by Gauss and Legendre, with e from its series."""
    total, zero = load(trace, 0, spread(0.0)), spread(0.0)
    for i in range(len(parent)):
        d = (h * s) * load(unknown, i * PER_UNKNOWN + DAMPING * BATCH, zero)
        total = total + d
        if parent[i] >= 0:
            if not bent[i]:
                e = load(near, i * ROWS, zero)
                total = total + d * e * e
            else:
                for q in range(TRACE_NODES):
                    e = load(near, i * ROWS + ROWS - BATCH, zero)
                    for k in range(ORDER - 1, -1, -1):
                        e = e * (NODES[q] * s) + load(near, i * ROWS + k * BATCH, zero)
                    total = total + WEIGHTS[q] * d * e * e
    store(trace, 0, total)

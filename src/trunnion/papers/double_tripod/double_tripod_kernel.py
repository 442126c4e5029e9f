# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
"""S4's equations (25), (26) and (29), (30) as C functions, and a third reading of them; see ``double_tripod``.

    φ̈ + 2ζΩ√g φ̇ + Ω² g φ = q(t, φ)/(1 + χ cos 2φ) · (1 − 3A sin 3φ),   g = (1 + c₁C)/((1 + c₂C)(1 + χC)),

C = cos 2φ in (25), (26) and cos Θ in (29), (30), Θ̇ = η; in the third reading φ is Θ/2 on the right side too.
q = m[1 + χ_e Σ₀⁵ cos(2ⁱωt)/2^{i+1}] of the motor,
m[1 + χ_e Σ₁⁷ cos(2^{j−1}φ)/2^j] of the mill, whose m is negative. p = (ζ, Ω, c₁, c₂, χ, m, χ_e, ω, A, mill, η).

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

from __future__ import annotations

import math

from numba import carray, cfunc, njit, types

_POINTER = types.CPointer(types.float64)
_RATE = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER)
ZETA, OMEGA, C1, C2, CHI, TORQUE, CHI_E, MOTOR, A, MILL, ETA = range(11)


@njit(cache=True, error_model="numpy")
def _depth(p, c):
    """g and dg/dC at C = c."""
    top, one, two = 1 + p[C1] * c, 1 + p[C2] * c, 1 + p[CHI] * c
    g = top / (one * two)
    return g, g * (p[C1] / top - p[C2] / one - p[CHI] / two)


@njit(cache=True, error_model="numpy")
def _push(p, t, phi):
    """The right side of the equation and its derivative by φ."""
    total, slope = 1.0, 0.0
    if p[MILL] != 0.0:
        for j in range(7):
            f = 2.0**j
            total += p[CHI_E] * math.cos(f * phi) / (2 * f)
            slope -= p[CHI_E] * math.sin(f * phi) / 2
    else:
        for i in range(6):
            f = 2.0**i
            total += p[CHI_E] * math.cos(f * p[MOTOR] * t) / (2 * f)
    below = 1 + p[CHI] * math.cos(2 * phi)
    joint = 1 - 3 * p[A] * math.sin(3 * phi)
    push = p[TORQUE] * total * joint / below
    by_joint = -9 * p[A] * math.cos(3 * phi)
    by_below = -2 * p[CHI] * math.sin(2 * phi)
    return push, p[TORQUE] * (slope * joint + total * by_joint) / below - push * by_below / below


@cfunc(_RATE, cache=True)
def own_phase(t, y_, p_, k, regime, out_):
    """(25), (26): states φ, φ̇; cos 2φ in the coefficients."""
    y, p, out = carray(y_, (2 + 2 * k,)), carray(p_, (11,)), carray(out_, (2 + 2 * k,))
    phi, v = y[0], y[1]
    g, bend = _depth(p, math.cos(2 * phi))
    push, by_phi = _push(p, t, phi)
    root = math.sqrt(g)
    loss, square = 2 * p[ZETA] * p[OMEGA], p[OMEGA] * p[OMEGA]
    out[0] = v
    out[1] = push - loss * root * v - square * g * phi
    by_phi -= square * g - 2 * math.sin(2 * phi) * bend * (loss * v / (2 * root) + square * phi)
    for b in range(2, 2 + 2 * k, 2):
        out[b] = y[b + 1]
        out[b + 1] = by_phi * y[b] - loss * root * y[b + 1]
    return 0


@cfunc(_RATE, cache=True)
def given_phase(t, y_, p_, k, regime, out_):
    """(29), (30): states φ, Θ, φ̇; cos Θ in the coefficients, Θ̇ = η."""
    y, p, out = carray(y_, (3 + 3 * k,)), carray(p_, (11,)), carray(out_, (3 + 3 * k,))
    phi, theta, v = y[0], y[1], y[2]
    g, bend = _depth(p, math.cos(theta))
    push, by_phi = _push(p, t, phi)
    root = math.sqrt(g)
    loss, square = 2 * p[ZETA] * p[OMEGA], p[OMEGA] * p[OMEGA]
    out[0] = v
    out[1] = p[ETA]
    out[2] = push - loss * root * v - square * g * phi
    by_phi -= square * g
    by_theta = math.sin(theta) * bend * (loss * v / (2 * root) + square * phi)
    for b in range(3, 3 + 3 * k, 3):
        out[b] = y[b + 2]
        out[b + 1] = 0.0
        out[b + 2] = by_phi * y[b] + by_theta * y[b + 1] - loss * root * y[b + 2]
    return 0


@cfunc(_RATE, cache=True)
def turning_phase(t, y_, p_, k, regime, out_):
    """(29), (30) with Θ/2 for φ in every cosine and sine of the right side, as (27) and (28) have it."""
    y, p, out = carray(y_, (3 + 3 * k,)), carray(p_, (11,)), carray(out_, (3 + 3 * k,))
    phi, theta, v = y[0], y[1], y[2]
    g, bend = _depth(p, math.cos(theta))
    push, by_half = _push(p, t, theta / 2)
    root = math.sqrt(g)
    loss, square = 2 * p[ZETA] * p[OMEGA], p[OMEGA] * p[OMEGA]
    out[0] = v
    out[1] = p[ETA]
    out[2] = push - loss * root * v - square * g * phi
    by_theta = math.sin(theta) * bend * (loss * v / (2 * root) + square * phi) + by_half / 2
    for b in range(3, 3 + 3 * k, 3):
        out[b] = y[b + 2]
        out[b + 1] = 0.0
        out[b + 2] = by_theta * y[b + 1] - square * g * y[b] - loss * root * y[b + 2]
    return 0

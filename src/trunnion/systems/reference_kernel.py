"""Right-hand sides of the reference systems as C functions; see ``trunnion.systems.system`` for the signature.

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import math

from numba import carray, cfunc, types

_POINTER = types.CPointer(types.float64)
_RATE = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER)
_GUARD = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER, _POINTER)


@cfunc(_RATE, cache=True)
def duffing(t, y_, p_, k, regime, out_):
    """x″ = −c x′ − k₁x − k₃x³ + B₀ + B₁ cos ωt; p = (c, k₁, k₃, B₀, B₁, ω)."""
    y, p, out = carray(y_, (2 + 2 * k,)), carray(p_, (6,)), carray(out_, (2 + 2 * k,))
    x = y[0]
    out[0] = y[1]
    out[1] = -p[0] * y[1] - (p[1] + p[2] * x * x) * x + p[3] + p[4] * math.cos(p[5] * t)
    for b in range(2, 2 + 2 * k, 2):
        out[b] = y[b + 1]
        out[b + 1] = -p[0] * y[b + 1] - (p[1] + 3 * p[2] * x * x) * y[b]
    return 0


@cfunc(_RATE, cache=True)
def pendulum(t, y_, p_, k, regime, out_):
    """x″ = −c x′ − sin x + B sin ωt; p = (c, B, ω)."""
    y, p, out = carray(y_, (2 + 2 * k,)), carray(p_, (3,)), carray(out_, (2 + 2 * k,))
    out[0] = y[1]
    out[1] = -p[0] * y[1] - math.sin(y[0]) + p[1] * math.sin(p[2] * t)
    slope = math.cos(y[0]) if k else 0.0
    for b in range(2, 2 + 2 * k, 2):
        out[b] = y[b + 1]
        out[b + 1] = -p[0] * y[b + 1] - slope * y[b]
    return 0


@cfunc(_RATE, cache=True)
def mathieu(t, y_, p_, k, regime, out_):
    """y″ = −2ζ y′ − (a − 2q cos 2t) y; p = (a, q, ζ)."""
    y, p, out = carray(y_, (2 + 2 * k,)), carray(p_, (3,)), carray(out_, (2 + 2 * k,))
    stiffness = p[0] - 2 * p[1] * math.cos(2 * t)
    for b in range(0, 2 + 2 * k, 2):
        out[b] = y[b + 1]
        out[b + 1] = -2 * p[2] * y[b + 1] - stiffness * y[b]
    return 0


@cfunc(_RATE, cache=True)
def lorenz(t, y_, p_, k, regime, out_):
    """x′ = σ(y − x), y′ = x(ρ − z) − y, z′ = xy − βz; p = (σ, ρ, β)."""
    u, p, out = carray(y_, (3 + 3 * k,)), carray(p_, (3,)), carray(out_, (3 + 3 * k,))
    x, y, z = u[0], u[1], u[2]
    out[0], out[1], out[2] = p[0] * (y - x), x * (p[1] - z) - y, x * y - p[2] * z
    for b in range(3, 3 + 3 * k, 3):
        out[b] = p[0] * (u[b + 1] - u[b])
        out[b + 1] = (p[1] - z) * u[b] - u[b + 1] - x * u[b + 2]
        out[b + 2] = y * u[b] + x * u[b + 1] - p[2] * u[b + 2]
    return 0


@cfunc(_RATE, cache=True)
def rossler(t, y_, p_, k, regime, out_):
    """x′ = −y − z, y′ = x + ay, z′ = b + z(x − c); p = (a, b, c)."""
    u, p, out = carray(y_, (3 + 3 * k,)), carray(p_, (3,)), carray(out_, (3 + 3 * k,))
    x, y, z = u[0], u[1], u[2]
    out[0], out[1], out[2] = -y - z, x + p[0] * y, p[1] + z * (x - p[2])
    for b in range(3, 3 + 3 * k, 3):
        out[b] = -u[b + 1] - u[b + 2]
        out[b + 1] = u[b] + p[0] * u[b + 1]
        out[b + 2] = z * u[b] + (x - p[2]) * u[b + 2]
    return 0


@cfunc(_RATE, cache=True)
def dead_zone(t, y_, p_, k, regime, out_):
    """x″ = −c x′ − g(x) + B₀ + B₁ cos ωt; p = (c, k, α, b, B₀, B₁, ω).

    Regime 0, |x| < b: g = αkx; 1, x > b: k(x − (1−α)b); 2, x < −b: k(x + (1−α)b).
    """
    y, p, out = carray(y_, (2 + 2 * k,)), carray(p_, (7,)), carray(out_, (2 + 2 * k,))
    inside = regime == 0
    stiffness = p[1] * p[2] if inside else p[1]
    shift = 0.0 if inside else (1 - p[2]) * (p[3] if regime == 1 else -p[3])
    out[0] = y[1]
    out[1] = -p[0] * y[1] - stiffness * (y[0] - shift) + p[4] + p[5] * math.cos(p[6] * t)
    for b in range(2, 2 + 2 * k, 2):
        out[b] = y[b + 1]
        out[b + 1] = -p[0] * y[b + 1] - stiffness * y[b]
    return 0


@cfunc(_GUARD, cache=True)
def dead_zone_ends(t, x_, p_, regime, sloped, g_, slope_):
    """x − b and x + b."""
    x, p, g = carray(x_, (2,)), carray(p_, (7,)), carray(g_, (2,))
    g[0], g[1] = x[0] - p[3], x[0] + p[3]
    if sloped:
        slope = carray(slope_, (6,))
        slope[:] = 0.0
        slope[0] = slope[3] = 1.0
    return 0

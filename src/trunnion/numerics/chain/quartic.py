"""Spectral radius of many 4 × 4 matrices at once from their characteristic coefficients.

Scaled so that e₄ = 1, x⁴ − ax³ + bx² − cx + 1 is (x² − px + q)(x² − sx + t) with real factors and qt = 1. Then
w = q + t ≥ 2 is the largest root of w³ − bw² + (ac − 4)w − (a² + c² − 4b), a cubic that is not positive at 2.

Every step is a loop over a chunk of pixels without branches, which the compiler turns into vector
instructions (in one loop they would take six times as long); the few that those steps did not settle take as many as
they need one by one, and what is left then is marked, for ``characteristic`` to treat.
"""

from __future__ import annotations

import math

from trunnion.numerics.jit import njit

CHUNK = 256
"""Pixels at a time: their working rows stay in the first-level cache."""
CUBIC_STEPS = 12
"""Newton steps on the resolvent: from beyond the root they halve the distance at first, then square it."""
POLISHING_STEPS = 2
PATIENT_STEPS = 200
"""Newton steps for those that had too few."""
SETTLED = 1e-13
"""Residual of the factors over the size of the coefficients."""
A, B, C, SCALE, SCALE2, W, P, S, Q, T, LEFT, RADIUS, ERROR, REAL, IMAGINARY = range(15)
ROWS = 15


@njit(nogil=True, inner=True)
def quartic_chunk(values, bounds, work):  # type: ignore[no-untyped-def]
    """Spectral radius, its error bound and the critical multiplier of ``CHUNK`` columns of e₁…e₄.

    values, bounds (4, CHUNK), contiguous; the results stand in the rows RADIUS, ERROR, REAL and IMAGINARY of
    ``work`` (ROWS · CHUNK,). Where the row LEFT, the residual of the factors, is not below ``SETTLED`` (e₄ ≤ 0,
    coefficients that are not finite, factors that coincide) nothing else holds.
    """
    _scale(values[0], values[1], values[2], values[3], work)
    _largest_resolvent_root(work)
    _factor(work)
    for _ in range(POLISHING_STEPS):
        _polish(work)
    _residual(work)
    _settle(work)
    _radii(bounds[0], bounds[1], bounds[2], bounds[3], work)


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _scale(e1, e2, e3, e4, w):  # type: ignore[no-untyped-def]
    for l in range(CHUNK):
        scale2 = math.sqrt(e4[l])
        scale = math.sqrt(scale2)
        w[SCALE * CHUNK + l], w[SCALE2 * CHUNK + l] = scale, scale2
        w[A * CHUNK + l] = e1[l] / scale
        w[B * CHUNK + l] = e2[l] / scale2
        w[C * CHUNK + l] = e3[l] / (scale2 * scale)


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _largest_resolvent_root(w):  # type: ignore[no-untyped-def]
    """From 2 where the cubic rises there, else from a bound of all roots, beyond which it is convex."""
    for l in range(CHUNK):
        a, b, c = w[A * CHUNK + l], w[B * CHUNK + l], w[C * CHUNK + l]
        c1, c0 = a * c - 4, 4 * b - a * a - c * c
        # With no rise at 2 all three roots are real, so this bound is close.
        beyond = b / 3 + 2 * math.sqrt(max(b * b / 9 - c1 / 3, 0.0))
        x = 2.0 if 8 - 4 * b + a * c > 0 else beyond
        for _ in range(CUBIC_STEPS):
            x -= (((x - b) * x + c1) * x + c0) / ((3 * x - 2 * b) * x + c1)
        w[W * CHUNK + l] = x


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _factor(w):  # type: ignore[no-untyped-def]
    for l in range(CHUNK):
        p, s, q, t = _factors(w[A * CHUNK + l], w[B * CHUNK + l], w[C * CHUNK + l], w[W * CHUNK + l])
        w[P * CHUNK + l], w[S * CHUNK + l], w[Q * CHUNK + l], w[T * CHUNK + l] = p, s, q, t


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _polish(w):  # type: ignore[no-untyped-def]
    for l in range(CHUNK):
        a, b, c = w[A * CHUNK + l], w[B * CHUNK + l], w[C * CHUNK + l]
        p, s, q, t = w[P * CHUNK + l], w[S * CHUNK + l], w[Q * CHUNK + l], w[T * CHUNK + l]
        p, s, q, t = _polished(a, b, c, p, s, q, t)
        w[P * CHUNK + l], w[S * CHUNK + l], w[Q * CHUNK + l], w[T * CHUNK + l] = p, s, q, t


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _residual(w):  # type: ignore[no-untyped-def]
    for l in range(CHUNK):
        a, b, c = w[A * CHUNK + l], w[B * CHUNK + l], w[C * CHUNK + l]
        p, s, q, t = w[P * CHUNK + l], w[S * CHUNK + l], w[Q * CHUNK + l], w[T * CHUNK + l]
        w[LEFT * CHUNK + l] = _left(a, b, c, p, s, q, t)


@njit(nogil=True, error_model="numpy", inner=True)
def _settle(w):  # type: ignore[no-untyped-def]
    """The few for which some steps were too few, as long as it takes: from beyond all roots Newton only descends."""
    for l in range(CHUNK):
        if w[LEFT * CHUNK + l] < SETTLED:
            continue
        a, b, c = w[A * CHUNK + l], w[B * CHUNK + l], w[C * CHUNK + l]
        c1, c0 = a * c - 4, 4 * b - a * a - c * c
        x = 1 + max(abs(b), max(abs(c1), abs(c0)))
        for _ in range(PATIENT_STEPS):
            step = (((x - b) * x + c1) * x + c0) / ((3 * x - 2 * b) * x + c1)
            x -= step
            if not step > 1e-15 * x:
                break
        p, s, q, t = _factors(a, b, c, x)
        for _ in range(2 * POLISHING_STEPS):
            p, s, q, t = _polished(a, b, c, p, s, q, t)
        w[P * CHUNK + l], w[S * CHUNK + l], w[Q * CHUNK + l], w[T * CHUNK + l] = p, s, q, t
        w[LEFT * CHUNK + l] = _left(a, b, c, p, s, q, t)


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _factors(a, b, c, x):  # type: ignore[no-untyped-def]
    """p, s, q, t from the root x of the resolvent."""
    spread = math.sqrt(max(0.25 * a * a - b + x, 0.0))
    apart = math.sqrt(max(0.25 * x * x - 1, 0.0))
    p, s = 0.5 * a + spread, 0.5 * a - spread
    q, t = 0.5 * x + apart, 0.5 * x - apart
    swapped = abs(p * q + s * t - c) < abs(p * t + s * q - c)
    return p, s, t if swapped else q, q if swapped else t


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _polished(a, b, c, p, s, q, t):  # type: ignore[no-untyped-def]
    """One Newton step on p + s = a, q + t + ps = b, pt + sq = c, qt = 1, if it is a small one."""
    r1, r2, r3, r4 = a - p - s, b - q - t - p * s, c - p * t - s * q, 1 - q * t
    # With ds = r1 − dp: dq + dt = u − v dp and s dq + p dt = g − h dp.
    v, u, h, g = s - p, r2 - p * r1, t - q, r3 - q * r1
    den = p - s
    slope = -t * v * den + (q - t) * (s * v - h)
    dp = ((r4 - t * u) * den - (q - t) * (g - s * u)) / slope
    dt = (g - h * dp - s * (u - v * dp)) / den
    dq = u - v * dp - dt
    small = abs(dp) + abs(dq) + abs(dt) < 1e-2 * (1 + abs(p) + abs(q))
    return (
        p + dp if small else p,
        s + r1 - dp if small else s,
        q + dq if small else q,
        t + dt if small else t,
    )


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _left(a, b, c, p, s, q, t):  # type: ignore[no-untyped-def]
    """What the factors leave of the polynomial, over its size."""
    left = abs(p + s - a) + abs(q + t + p * s - b) + abs(p * t + s * q - c) + abs(q * t - 1)
    return left / (1 + abs(a) + abs(b) + abs(c))


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _radii(b1, b2, b3, b4, w):  # type: ignore[no-untyped-def]
    """The largest modulus, how far the four moduli may be off, and the root itself."""
    for l in range(CHUNK):
        scale, scale2 = w[SCALE * CHUNK + l], w[SCALE2 * CHUNK + l]
        x1, x3, y1, big1, small1, apart1 = _pair(w[P * CHUNK + l] * scale, w[Q * CHUNK + l] * scale2)
        x2, x4, y2, big2, small2, apart2 = _pair(w[S * CHUNK + l] * scale, w[T * CHUNK + l] * scale2)
        d12, d34 = _distance(x1 - x2, y1 - y2), _distance(x3 - x4, y1 - y2)
        d14, d32 = _distance(x1 - x4, y1 + y2), _distance(x3 - x2, y1 + y2)
        upper1 = big1 + _bound(_moved(b1[l], b2[l], b3[l], b4[l], big1), apart1, d12, d14)
        upper2 = big2 + _bound(_moved(b1[l], b2[l], b3[l], b4[l], big2), apart2, d12, d32)
        upper3 = small1 + _bound(_moved(b1[l], b2[l], b3[l], b4[l], small1), apart1, d32, d34)
        upper4 = small2 + _bound(_moved(b1[l], b2[l], b3[l], b4[l], small2), apart2, d14, d34)
        largest = max(big1, big2)
        off = max(max(upper1, upper2), max(upper3, upper4)) - largest
        w[RADIUS * CHUNK + l], w[ERROR * CHUNK + l] = largest, off
        w[REAL * CHUNK + l] = x1 if big1 >= big2 else x2
        w[IMAGINARY * CHUNK + l] = y1 if big1 >= big2 else y2
        w[LEFT * CHUNK + l] += 0.0 * off


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _pair(total, product):  # type: ignore[no-untyped-def]
    """Roots of x² − total·x + product: real parts of the larger and the smaller, imaginary part of the first
    (minus that of the second), their moduli, their distance."""
    half = 0.5 * total
    under = half * half - product
    rise = math.sqrt(abs(under))
    far = half + (rise if half >= 0 else -rise)
    near, modulus = product / far, math.sqrt(abs(product))
    on_axis = under >= 0
    return (
        far if on_axis else half,
        near if on_axis else half,
        0.0 if on_axis else rise,
        abs(far) if on_axis else modulus,
        abs(near) if on_axis else modulus,
        2 * rise,
    )


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _distance(x, y):  # type: ignore[no-untyped-def]
    return math.sqrt(x * x + y * y)


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _moved(b1, b2, b3, b4, size):  # type: ignore[no-untyped-def]
    """How far the polynomial may be off at a root of this modulus."""
    return ((b1 * size + b2) * size + b3) * size + b4 + 1e-300


@njit(nogil=True, fastmath={"contract", "arcp"}, error_model="numpy", inner=True)
def _bound(moved, d1, d2, d3):  # type: ignore[no-untyped-def]
    """As in ``characteristic``: one root moves alone, or two together, or all four, whichever binds best."""
    low, high = min(d1, d2), max(d1, d2)
    nearest, rest = min(low, d3), max(low, d3)
    pair = moved / (rest * high + 1e-300)
    return 2 * min(min(pair / (nearest + 1e-300), math.sqrt(pair)), math.sqrt(math.sqrt(moved)))

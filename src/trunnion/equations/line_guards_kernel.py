# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
"""Switching functions of a line's stages and sliders, and what jumps there: for lines that have any.

Numbers are read as ``line_kernel`` does, on which this file builds; it stands apart because C functions are compiled
when their file is loaded, and most lines need none of these.

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

from __future__ import annotations

from numba import carray, cfunc, njit, types
from trunnion_kernels.line_kernel import (
    COMPLIANCES,
    COORDINATE,
    FAR,
    FAR_COORDINATE,
    GUARDS,
    HEAD,
    LAGS,
    LAW,
    MEAN,
    NEAR,
    NEAR_COORDINATE,
    OF,
    PER_COMPLIANCE,
    PER_GUARD,
    PER_SLIDER,
    PER_STAGE,
    PER_STATION,
    REACH,
    REFERENCE,
    SHARE,
    SLIDERS,
    SLIPS_ON,
    STAGES,
    STATIONS,
    STEP,
    STICKS,
    STRIDE,
    UNKNOWNS,
    course,
    mean_rotation,
    mesh_error,
    places,
    walk,
)

_POINTER = types.CPointer(types.float64)
_JUMP = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, types.int64, _POINTER)
_GUARD = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER, _POINTER)
SETBACK = 1e-12
"""Share of its deflection that a slider falls back by where it comes to stick: less than what counts, more than
rounding, which could let it slip again at rest."""


@njit(cache=True, nogil=True)
def gradient(row, p, q, by_twist, by_rate, omega, alpha, v, r, r1):
    """Gradient (2n + sliders + 1,), by the states and time, of by_twist times a twist and by_rate times its rate."""
    near, far, n = int(p[q + NEAR]), int(p[q + FAR]), int(p[UNKNOWNS])
    i, j = int(p[q + NEAR_COORDINATE]), int(p[q + FAR_COORDINATE])
    first = int(p[HEAD + near * PER_STATION + REFERENCE])
    turning = p[HEAD + first * PER_STATION + MEAN]
    row[:] = 0.0
    if j >= 0:
        row[j] += by_twist
        row[n + j] += by_rate
    if i >= 0:
        row[i] -= by_twist * r[near] + by_rate * r1[near] * v[first]
        row[n + i] -= by_rate * r[near]
    drift = (p[HEAD + near * PER_STATION + MEAN] - r[near] * turning) * omega
    growth = (p[HEAD + far * PER_STATION + MEAN] - r[near] * turning) * alpha - r1[near] * turning * omega * v[first]
    row[row.size - 1] = by_twist * drift + by_rate * growth


@cfunc(_GUARD, cache=True)
def line_guards(t, x_, p_, regime, sloped, g_, slope_):
    """GUARDS switching functions per spring with stages and per slider, and their gradients by x and t."""
    head = carray(p_, (HEAD,))
    n, count, joined, sliding = int(head[UNKNOWNS]), int(head[STATIONS]), int(head[COMPLIANCES]), int(head[SLIDERS])
    compliance, _, slider, scratch = places(head)
    p = carray(p_, (scratch + 5 * count,))
    x, g = carray(x_, (2 * n + sliding,)), carray(g_, (GUARDS * (joined + sliding),))
    wide = 2 * n + sliding + int(head[LAGS]) + 1
    slope = carray(slope_, (GUARDS * (joined + sliding) * wide,))
    theta, omega, alpha = course(t, p)
    space = p[scratch:]
    d, v = space[:count], space[count : 2 * count]
    r, r1, r2 = space[2 * count : 3 * count], space[3 * count : 4 * count], space[4 * count :]
    walk(theta, omega, x, p, count, HEAD, d, v, r, r1, r2)
    turned, turning = mean_rotation(theta, omega, p, count, d, v)
    m = 0
    for e in range(joined):
        q = compliance + e * PER_COMPLIANCE
        if p[q + STAGES] < 2.0:
            continue
        near, far = int(p[q + NEAR]), int(p[q + FAR])
        error, error_slope, bend = mesh_error(p, q, turned)
        twist, rate = d[far] - d[near] + error, v[far] - v[near] + error_slope * turning
        stage = int(p[q + LAW]) + (regime // int(p[q + STRIDE])) % int(p[q + STAGES]) * PER_STAGE
        for guard in range(GUARDS):
            at = stage + 3 + PER_GUARD * guard
            by_twist, by_rate = p[at], p[at + 1]
            g[m] = by_twist * twist + by_rate * rate - p[at + 2]
            if sloped != 0:
                row = slope[m * wide : (m + 1) * wide]
                gradient(row, p, q, by_twist, by_rate, omega, alpha, v, r, r1)
                by_turn = by_twist * error_slope + by_rate * bend * turning
                row[wide - 1] += by_turn * omega + by_rate * error_slope * alpha
                for s in range(count):
                    share = p[HEAD + s * PER_STATION + SHARE]
                    if share != 0.0:
                        i = int(p[HEAD + s * PER_STATION + COORDINATE])
                        row[i] += by_turn * share
                        row[n + i] += by_rate * error_slope * share
            m += 1
    for s in range(sliding):
        at = slider + s * PER_SLIDER
        q = compliance + int(p[at + OF]) * PER_COMPLIANCE
        rate = v[int(p[q + FAR])] - v[int(p[q + NEAR])]
        # Where it slips back and on from stick, and where the twist that it slips with turns.
        g[m], g[m + 1], g[m + 2] = x[2 * n + s] + p[at + REACH], x[2 * n + s] - p[at + REACH], rate
        if sloped != 0:
            slope[m * wide : (m + 2) * wide] = 0.0
            slope[m * wide + 2 * n + s] = slope[(m + 1) * wide + 2 * n + s] = 1.0
            gradient(slope[(m + 2) * wide : (m + GUARDS) * wide], p, q, 0.0, 1.0, omega, alpha, v, r, r1)
        m += GUARDS
    return 0


@cfunc(_JUMP, cache=True)
def line_jump(t, y_, p_, k, regime, which, delay_):
    """Deflections of sliders behind a guard: where one begins to slip it stands at its end exactly, and where the
    twist turns all that slip with it stick. The tangents know."""
    head = carray(p_, (HEAD,))
    n, joined, sliding = int(head[UNKNOWNS]), int(head[COMPLIANCES]), int(head[SLIDERS])
    compliance, _, slider, _ = places(head)
    p, y = carray(p_, (slider + sliding * PER_SLIDER,)), carray(y_, (2 * n + sliding,))
    first = 0
    for e in range(joined):
        if p[compliance + e * PER_COMPLIANCE + STAGES] >= 2.0:
            first += GUARDS
    if which < first:
        return 0
    one, guard = (which - first) // GUARDS, (which - first) % GUARDS
    at = slider + one * PER_SLIDER
    if guard < 2:
        y[2 * n + one] = p[at + REACH] if guard == 1 else -p[at + REACH]
        for s in range(sliding):
            # One that is about to slip at the same instant must not be past it by rounding: it follows at once.
            other = slider + s * PER_SLIDER
            if s != one and p[other + OF] == p[at + OF] and regime // int(p[other + STEP]) % 3 == STICKS:
                most = (1.0 - SETBACK) * p[other + REACH]
                y[2 * n + s] = min(max(y[2 * n + s], -most), most)
        return 0
    stage = regime // int(p[at + STEP]) % 3
    for s in range(sliding):
        other = slider + s * PER_SLIDER
        if p[other + OF] == p[at + OF] and regime // int(p[other + STEP]) % 3 == stage:
            y[2 * n + s] = (1.0 - SETBACK) * (p[other + REACH] if stage == SLIPS_ON else -p[other + REACH])
    return 0

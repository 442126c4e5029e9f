# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
"""What can be watched along a motion of a line, as one C function of a guard's signature.

Numbers: how many are watched, the address of the line's right-hand side, whether it is to be called (only it knows
torques), and where the line's own numbers begin; then per watched value its kind, the place of what it belongs to, a
factor, and the level that it is compared with, a cubic of the time since a given one.

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

from __future__ import annotations

from numba import carray, cfunc, njit, types
from trunnion_kernels.integration_kernel import call_rate
from trunnion_kernels.line_kernel import (
    COMPLIANCES,
    FAR,
    FROM_FIRST,
    HEAD,
    LAGS,
    LAW,
    MEAN,
    NEAR,
    PER_COMPLIANCE,
    PER_STATION,
    PLACE,
    SENSE,
    SLIDERS,
    STATIONS,
    UNKNOWNS,
    course,
    formula,
    mean_rotation,
    mesh_error,
    places,
    walk,
)

_POINTER = types.CPointer(types.float64)
_GUARD = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER, _POINTER)

COUNT, RATE, CALLED, NUMBERS = range(4)
FRONT = 4
KIND, OF, FACTOR, SINCE, LEVEL = range(5)
PER_WATCHED = LEVEL + 4
# Speed and angle of a station; twist, torque and rate of twist of a compliance; the speed of the mean rotation of the
# whole line; the torque on an unknown rotation; what a kink of an applied formula switches by, whose number stands in
# place of SINCE.
STATION_SPEED, STATION_ANGLE, TWIST, TORQUE, TWIST_RATE, MEAN_SPEED, ON_UNKNOWN, KINK = range(8)
STEP = 1e-6
"""Of the differences that gradients are taken from; they steer Newton's method and tell a sign, no more."""


@njit(cache=True, nogil=True)
def watched_values(t, x, asked, p, regime, out, g):
    """Every watched value less its level."""
    n, count = int(p[UNKNOWNS]), int(p[STATIONS])
    compliance, _, _, scratch = places(p)
    d, v = p[scratch : scratch + count], p[scratch + count : scratch + 2 * count]
    theta, omega, _ = course(t, p)
    if asked[CALLED] != 0.0:
        if call_rate(int(asked[RATE]), t, x, p, 0, regime, out) != 0:
            return 1
    else:
        r = p[scratch + 2 * count : scratch + 3 * count]
        r1, r2 = p[scratch + 3 * count : scratch + 4 * count], p[scratch + 4 * count : scratch + 5 * count]
        walk(theta, omega, x, p, count, HEAD, d, v, r, r1, r2)
    rest = scratch + 5 * count
    for j in range(int(asked[COUNT])):
        at = FRONT + j * PER_WATCHED
        kind, of, since = int(asked[at + KIND]), int(asked[at + OF]), t - asked[at + SINCE]
        value = 0.0
        if kind == STATION_SPEED:
            value = v[of]
        elif kind == STATION_ANGLE:
            value = p[HEAD + of * PER_STATION + MEAN] * theta + d[of]
        elif kind == TWIST or kind == TWIST_RATE:
            q = compliance + of * PER_COMPLIANCE
            near, far = int(p[q + NEAR]), int(p[q + FAR])
            error, slope, turning = 0.0, 0.0, 0.0
            if p[q + LAW] != 0.0:
                turned, turning = mean_rotation(theta, omega, p, count, d, v)
                error, slope, _ = mesh_error(p, q, turned)
            value = d[far] - d[near] + error if kind == TWIST else v[far] - v[near] + slope * turning
        elif kind == TORQUE:
            value = p[rest + 7 * n + of]
        elif kind == MEAN_SPEED:
            _, value = mean_rotation(theta, omega, p, count, d, v)
        elif kind == KINK:
            s, sense = int(p[of + PLACE]), p[of + SENSE]
            angle = sense * (p[HEAD + s * PER_STATION + MEAN] * theta + d[s])
            number = int(asked[at + SINCE])
            _, value = formula(p, int(p[of + FROM_FIRST]), t, sense * v[s], angle, number)
        else:
            value = p[rest + 3 * n + of]
        level = 0.0
        for i in range(3, -1, -1):
            level = level * since + asked[at + LEVEL + i]
        g[j] = asked[at + FACTOR] * value - level
    return 0


@cfunc(_GUARD, cache=True)
def line_watch(t, x_, asked_, regime, sloped, g_, slope_):
    """Every watched value less its level, and gradients by states and time."""
    front = carray(asked_, (FRONT,))
    first = int(front[NUMBERS])
    head = carray(asked_, (first + HEAD,))[first:]
    n, count, joined, sliding = int(head[UNKNOWNS]), int(head[STATIONS]), int(head[COMPLIANCES]), int(head[SLIDERS])
    _, _, _, scratch = places(head)
    m, wide = int(front[COUNT]), 2 * n + sliding + int(head[LAGS])
    size = scratch + 5 * count + 7 * n + 5 * joined
    asked = carray(asked_, (first + size + 2 * wide + 2 * m,))
    p = asked[first : first + size]
    out, y = asked[first + size : first + size + wide], asked[first + size + wide : first + size + 2 * wide]
    above = asked[first + size + 2 * wide : first + size + 2 * wide + m]
    below = asked[first + size + 2 * wide + m : first + size + 2 * wide + 2 * m]
    x, g = carray(x_, (wide,)), carray(g_, (m,))
    if sloped != 0:
        slope = carray(slope_, (m * (wide + 1),))
        for i in range(wide + 1):
            step = STEP * max(1.0, abs(x[i]) if i < wide else abs(t))
            for j in range(wide):
                y[j] = x[j]
            later = t
            if i < wide:
                y[i] = x[i] + step
            else:
                later = t + step
            if watched_values(later, y, asked, p, regime, out, above) != 0:
                return 1
            if i < wide:
                y[i] = x[i] - step
            else:
                later = t - step
            if watched_values(later, y, asked, p, regime, out, below) != 0:
                return 1
            for j in range(m):
                slope[j * (wide + 1) + i] = (above[j] - below[j]) / (2 * step)
    for j in range(wide):
        y[j] = x[j]
    return watched_values(t, y, asked, p, regime, out, g)

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
"""A stretch of a passage in one go: steps of DOP853 with error control, and nothing kept but where the line stands.

What a passage is judged by, mean speeds and when the line has the last one, needs no dense output and no located
switches. Tables of torque over speed are switched at the ends of steps: within the step in which a disk's speed comes
to a knot the piece before goes on beyond it. The reference that the line is observed from is taken anew where the line
is far from it.

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from trunnion_kernels.integration_kernel import (
    ALL_STAGES,
    EPS,
    _copy,
    _error,
    _first_step,
    _stages,
    call_rate,
)
from trunnion_kernels.line_kernel import (
    ALPHA,
    APPLIED_AT,
    OMEGA,
    PER_APPLIED,
    SINCE,
    STATIONS,
    THETA,
    course,
    places,
)

# How a call ends: at the time asked for, where the line has the last speed, after so many steps, where a torque says
# nothing, where the step becomes too small or a number is none.
REACHED, CROSSED, FULL, BEYOND, FAILED = range(5)
# Of clock: the time, the step tried next, then the time and the angle of the mean rotation at the last look, the time
# of the next, how far apart they are, and the highest mean speed between two; the last such mean speed (NaN at the
# start) and the middle of its time, and the least that mean speeds gained from one to the next, per time.
TIME, STEP, LOOKED, ANGLE, NEXT, APART, HIGHEST, BEFORE, MIDDLE, GAINED = range(10)
# Per torque: the variable of its pieces, its station, the sense of that, how many knots it has, where they begin, the
# row of its piece below the first, and the piece it is in.
VARIABLE, STATION, SENSE, KNOTS, FIRST_KNOT, FIRST_ROW, PIECE = range(7)
NONE, BY_TIME, BY_SPEED = range(3)


@njit(cache=True, nogil=True)
def mean_angle(t, y, p, n, share):
    """Angle of the mean rotation of the whole line."""
    total = course(t, p)[0]
    for i in range(n):
        total += share[i] * y[i]
    return total


@njit(cache=True, nogil=True)
def mean_speed(t, y, p, n, share):
    """Its speed."""
    total = course(t, p)[1]
    for i in range(n):
        total += share[i] * y[n + i]
    return total


@njit(cache=True, nogil=True)
def follow_anew(rate, t, y, p, n, share, turning, out):
    """Observe the line from a rotation that goes with it, and write the rates of its state into ``out``."""
    theta, omega, _ = course(t, p)
    angle, speed = 0.0, 0.0
    for i in range(n):
        angle += share[i] * y[i]
        speed += share[i] * y[n + i]
    for i in range(n):
        y[i] -= turning[i] * angle
        y[n + i] -= turning[i] * speed
    p[THETA], p[OMEGA], p[ALPHA], p[SINCE] = theta + angle, omega + speed, 0.0, t
    if call_rate(rate, t, y, p, 0, 0, out) != 0:
        return 1
    gained = 0.0
    for i in range(n):
        gained += share[i] * out[n + i]
    p[ALPHA] = gained
    return call_rate(rate, t, y, p, 0, 0, out)


@njit(cache=True, nogil=True)
def into_piece(p, h, torque, knots, rows, known, value):
    """Write the piece of torque ``h`` that holds a value; 0 where it says nothing there."""
    piece = -1
    first, count = torque[h, FIRST_KNOT], torque[h, KNOTS]
    while piece + 1 < count and knots[first + piece + 1] <= value:
        piece += 1
    torque[h, PIECE] = piece
    row = torque[h, FIRST_ROW] + piece + 1
    at = int(p[APPLIED_AT]) + h * PER_APPLIED
    for j in range(PER_APPLIED):
        p[at + j] = rows[row, j]
    return known[row]


@njit(cache=True, nogil=True)
def stretch(rate, p, y, n, share, turning, weight, tolerance, end, last, far, most, torque, knots, rows, known, clock):
    """Carry ``y`` on to ``end``; p[APPLIED_AT:] has the pieces that act."""
    wide = y.size
    k = np.zeros((ALL_STAGES, wide))
    new, scratch = np.empty(wide), np.empty(wide)
    t, h = clock[TIME], clock[STEP]
    count = int(p[STATIONS])
    speeds = places(p)[3] + count
    if follow_anew(rate, t, y, p, n, share, turning, k[0]) != 0:
        return FAILED
    if h <= 0.0:
        h = _first_step(rate, t, y, p, wide, 0, 0, tolerance, weight, k, scratch)
    before = mean_speed(t, y, p, n, share)
    rejected, taken = False, 0
    while t < end:
        if taken == most:
            clock[TIME], clock[STEP] = t, h
            return FULL
        until = end
        for one in range(torque.shape[0]):
            if torque[one, VARIABLE] == BY_TIME and torque[one, PIECE] + 1 < torque[one, KNOTS]:
                until = min(until, knots[torque[one, FIRST_KNOT] + torque[one, PIECE] + 1])
        step = until - t if t + 1.01 * h >= until else h
        if step < 16 * EPS * max(abs(t), 1e-6 * (end - t)):
            if step < h:
                t = until
                step = 0.0
            else:
                return FAILED
        if step > 0.0:
            refused = _stages(rate, t, step, y, p, 0, 0, k, new)
            error = np.nan if refused != 0 else _error(step, y, new, k, wide, 0, tolerance, weight)
            if not error <= 1.0:
                h = step * (0.2 if np.isnan(error) else max(0.2, 0.9 * error ** (-0.125)))
                rejected = True
                if h < 16 * EPS * max(abs(t), 1e-6 * (end - t)):
                    return FAILED
                continue
            grow = 6.0 if error == 0.0 else min(6.0, 0.9 * error ** (-0.125))
            proposed = step * (min(1.0, grow) if rejected else max(grow, 0.2))
            h = h if step < h else proposed
            rejected = False
            t = until if step == until - t else t + step
            _copy(new, y)
            taken += 1
            if call_rate(rate, t, y, p, 0, 0, k[0]) != 0:
                return FAILED
            for i in range(wide):
                if not np.isfinite(k[0, i]):
                    return FAILED
            speed = mean_speed(t, y, p, n, share)
            if speed >= last:
                clock[TIME] = t - step * (speed - last) / (speed - before) if speed > before else t
                if t - clock[MIDDLE] > clock[APART]:
                    clock[GAINED] = min(clock[GAINED], (speed - clock[BEFORE]) / (t - clock[MIDDLE]))
                return CROSSED
            before = speed
        changed, off = False, 0.0
        for i in range(n):
            off += share[i] * y[i]
        for one in range(torque.shape[0]):
            which = torque[one, VARIABLE]
            if which == NONE:
                continue
            s = torque[one, STATION]
            value = t if which == BY_TIME else torque[one, SENSE] * p[speeds + s]
            piece, first = torque[one, PIECE], torque[one, FIRST_KNOT]
            below = piece >= 0 and value < knots[first + piece]
            above = piece + 1 < torque[one, KNOTS] and value >= knots[first + piece + 1]
            if below or above:
                if not into_piece(p, one, torque, knots, rows, known, value):
                    return BEYOND
                changed = True
        if changed or abs(off) > far:
            if follow_anew(rate, t, y, p, n, share, turning, k[0]) != 0:
                return FAILED
            before = mean_speed(t, y, p, n, share)
        if t >= clock[NEXT]:
            angle = mean_angle(t, y, p, n, share)
            mean, middle = (angle - clock[ANGLE]) / (t - clock[LOOKED]), (t + clock[LOOKED]) / 2
            clock[HIGHEST] = max(clock[HIGHEST], mean)
            if not np.isnan(clock[BEFORE]):
                clock[GAINED] = min(clock[GAINED], (mean - clock[BEFORE]) / (middle - clock[MIDDLE]))
            clock[BEFORE], clock[MIDDLE] = mean, middle
            clock[LOOKED], clock[ANGLE] = t, angle
            clock[NEXT] = t + clock[APART]
    clock[TIME], clock[STEP] = t, h
    return REACHED

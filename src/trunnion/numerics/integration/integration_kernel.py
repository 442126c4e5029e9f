"""Compiled core of the integrator: steps of DOP853 with error control, dense output, events and regimes.

A system is one C function and an array of numbers, so one compiled integrator serves all of them:

    rate(t, y, p, k, regime, out) → 0, or another integer to refuse.

y holds the state x (n,) and k tangent vectors v (k, n), one after the other; out receives x′ and, for each v,
(∂x′/∂x) v. Switching functions g and jumps come the same way (see ``trunnion.systems.system``).

Within a step the right-hand side keeps the regime it started in, continued smoothly past the switching
surface; the step is then cut where the surface is crossed. The crossing is bracketed on the dense output and
finished by steps of the method itself, so the state there has the accuracy of a step, not of an interpolant.

Method: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, 2nd ed., sections II.4–II.6;
tangents across a switching surface: Leine, Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical
Systems, chapter 7 (saltation).

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from scipy.integrate._ivp import dop853_coefficients as _published

A = np.ascontiguousarray(_published.A)
B = np.ascontiguousarray(_published.B)
C = np.ascontiguousarray(_published.C)
E3 = np.ascontiguousarray(_published.E3)
E5 = np.ascontiguousarray(_published.E5)
D = np.ascontiguousarray(_published.D)
STAGES, ALL_STAGES, POWERS = 12, 16, 8

# How a call of ``advance`` ends.
REACHED, FULL, STOPPED, STEP_LIMIT, NOT_FINITE, TOO_SMALL, REFUSED, CHATTER, BEYOND = range(9)

# Places in ``whole`` and ``clock``, which carry the integration from one call to the next.
REGIME, QUICK, STEPS, REJECTED, EVENTS, STORED, FRESH = range(7)
TIME, STEP, LAST_EVENT, SPAN = range(4)

SAMPLES = 8
"""Places per step at which switching functions are looked at."""
MOST_QUICK_EVENTS = 60
MOMENT = 0.01
"""Share of a step by which the crossing of two surfaces may come in either order where one is only touched."""
LARGEST = 1e100
EPS = 2.220446049250313e-16

INNER = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""For functions that compiled code alone calls: their entrances for Python take longer to compile than they do."""


def _call(context: Any, builder: Any, signature: Any, args: Any) -> Any:
    """The C function at the address in front, of numbers and of pointers to the data of arrays; it returns an int64."""
    given = [
        context.make_array(kind)(context, builder, arg).data if isinstance(kind, types.Array) else arg
        for kind, arg in zip(signature.args[1:], args[1:], strict=True)
    ]
    function = ir.FunctionType(ir.IntType(64), [arg.type for arg in given])
    return builder.call(builder.inttoptr(args[0], function.as_pointer()), given)


@intrinsic
def _call_rate(typing: Any, address: Any, t: Any, y: Any, p: Any, count: Any, regime: Any, out: Any) -> Any:
    """int64(double, double* y, double* p, int64 count, int64 regime, double* out)."""
    whole = types.int64
    return whole(whole, types.float64, y, p, whole, whole, out), _call


@intrinsic
def _call_guard(typing: Any, address: Any, t: Any, x: Any, p: Any, regime: Any, sloped: Any, g: Any, slope: Any) -> Any:
    """int64(double, double* x, double* p, int64 regime, int64 sloped, double* values, double* gradients)."""
    whole = types.int64
    return whole(whole, types.float64, x, p, whole, whole, g, slope), _call


@intrinsic
def _call_jump(
    typing: Any, address: Any, t: Any, y: Any, p: Any, count: Any, regime: Any, which: Any, delay: Any
) -> Any:
    """int64(double, double* y, double* p, int64 count, int64 regime, int64 which, double* delays)."""
    whole = types.int64
    return whole(whole, types.float64, y, p, whole, whole, whole, delay), _call


@njit(cache=True, nogil=True, **INNER)
def _copy(source, out):
    """``source`` into ``out``: the compiler takes seconds for each slice that is set to another."""
    for i in range(source.size):
        out[i] = source[i]


@njit(cache=True, nogil=True)
def call_rate(address, t, y, p, count, regime, out):
    """Right-hand side of a system, for callers outside this file."""
    return _call_rate(address, t, y, p, count, regime, out)


@njit(cache=True, nogil=True)
def call_guard(address, t, x, p, regime, g, slope):
    """Switching functions g (m,) and their gradients (m, n + 1) by x and t, flat."""
    return _call_guard(address, t, x, p, regime, 1, g, slope)


@njit(cache=True, nogil=True, **INNER)
def _stages(rate, t, h, y, p, count, regime, k, out):
    """Stages 1–11 from k[0] = f(t, y), and the state of order 8 after the step in ``out``."""
    for s in range(1, STAGES):
        _copy(y, out)
        for j in range(s):
            a = h * A[s, j]
            if a != 0.0:
                for i in range(y.size):
                    out[i] += a * k[j, i]
        refused = _call_rate(rate, t + C[s] * h, out, p, count, regime, k[s])
        if refused != 0:
            return refused
    _copy(y, out)
    for j in range(STAGES):
        b = h * B[j]
        if b != 0.0:
            for i in range(y.size):
                out[i] += b * k[j, i]
    return 0


@njit(cache=True, nogil=True, **INNER)
def _error(h, y, new, k, n, count, tolerance, weight):
    """Largest error of the state and of each tangent vector over what is allowed; NaN where not finite.

    A tangent vector is allowed an error relative to its own length in units of ``weight``.
    """
    worst = 0.0
    for block in range(count + 1):
        length = 0.0
        if block > 0:
            for i in range(n):
                length = max(length, abs(new[block * n + i]) / weight[i])
        five, three = 0.0, 0.0
        for i in range(n):
            at = block * n + i
            e5, e3 = 0.0, 0.0
            for j in range(STAGES):
                e5 += E5[j] * k[j, at]
                e3 += E3[j] * k[j, at]
            allowed = tolerance * (weight[i] + max(abs(y[at]), abs(new[at])))
            if block > 0:
                allowed = tolerance * (weight[i] * length + 1e-300)
            five += (e5 / allowed) ** 2
            three += (e3 / allowed) ** 2
        if not np.isfinite(five + three):
            return np.nan
        if five + 0.01 * three > 0.0:  # of a state that has decayed to nothing both may underflow
            worst = max(worst, abs(h) * five / np.sqrt((five + 0.01 * three) * n))
    return worst


@njit(cache=True, nogil=True, **INNER)
def _dense(rate, t, h, y, new, p, n, regime, k, scratch, q):
    """Coefficients q (8, n) of the interpolant of order 7 of the state over an accepted step."""
    for s in range(STAGES + 1, ALL_STAGES):
        for i in range(n):
            scratch[i] = y[i]
        for j in range(s):
            a = h * A[s, j]
            if a != 0.0:
                for i in range(n):
                    scratch[i] += a * k[j, i]
        refused = _call_rate(rate, t + C[s] * h, scratch, p, 0, regime, k[s])
        if refused != 0:
            return refused
    for i in range(n):
        rise = new[i] - y[i]
        q[0, i] = y[i]
        q[1, i] = rise
        q[2, i] = h * k[0, i] - rise
        q[3, i] = 2 * rise - h * (k[0, i] + k[STAGES, i])
        for r in range(4):
            total = 0.0
            for j in range(ALL_STAGES):
                total += D[r, j] * k[j, i]
            q[4 + r, i] = h * total
    return 0


@njit(cache=True, nogil=True)
def interpolate(q, s, out):
    """State at the fraction s of a step."""
    for i in range(q.shape[1]):
        total = 0.0
        for r in range(POWERS - 1, 0, -1):
            total = (total + q[r, i]) * (s if (POWERS - 1 - r) % 2 == 0 else 1 - s)
        out[i] = q[0, i] + total


@njit(cache=True, nogil=True)
def evaluate(times, steps, coefficients, at, out):
    """States (m, n) at times ``at`` (m,) from the stored steps: start times, lengths and coefficients."""
    for j in range(at.size):
        low, high = 0, times.size  # the last step that does not begin after the time
        while high - low > 1:
            middle = (low + high) // 2
            if times[middle] <= at[j]:
                low = middle
            else:
                high = middle
        i = low
        interpolate(coefficients[i], (at[j] - times[i]) / steps[i], out[j])


@njit(cache=True, nogil=True, **INNER)
def _watched(functions, t, x, p, asked, n, regime, own, sloped, g, slope):
    """All switching functions: the system's own first, then those the caller asks for; gradients if sloped."""
    if own > 0:
        if _call_guard(functions[1], t, x, p, regime, sloped, g[:own], slope[: own * (n + 1)]) != 0:
            return 1
    if g.size > own:
        return _call_guard(functions[3], t, x, asked, regime, sloped, g[own:], slope[own * (n + 1) :])
    return 0


@njit(cache=True, nogil=True, **INNER)
def _sign(value):
    return 1.0 if value > 0 else (-1.0 if value < 0 else 0.0)


@njit(cache=True, nogil=True, **INNER)
def _crosses(side, value, direction):
    """Whether a function that was on ``side`` has crossed zero in a watched direction (±1; 2 for both)."""
    return side * value < 0 and (direction == 2 or direction == -side)


@njit(cache=True, nogil=True, **INNER)
def _bracket(functions, t, h, q, p, asked, n, regime, own, sides, directions, x, g, slope):
    """The first watched crossing within a step, as (function, fraction in front of it, fraction behind it).

    Function −1: none; −2: a function could not be evaluated. A function that returns to its side between two
    samples is found by following its extremum.
    """
    m = g.size
    now, last = np.empty(m), np.empty((3, m))
    _copy(sides, now)
    # One sample beyond each end, so that an extremum at the end of a step is seen from both sides.
    for j in range(-1, SAMPLES + 2):
        interpolate(q, j / SAMPLES, x)
        if _watched(functions, t + j / SAMPLES * h, x, p, asked, n, regime, own, 0, g, slope) != 0:
            return -2, 0.0, 0.0
        _copy(last[1], last[0])
        _copy(last[2], last[1])
        _copy(g, last[2])
        if j < 1:
            continue
        found, left, right = -1, 2.0, 2.0
        for i in range(m):
            if directions[i] == 0 or now[i] == 0.0:
                continue
            a, b, c = last[0, i] * now[i], last[1, i] * now[i], last[2, i] * now[i]
            if b > 0 and a > b and c > b and b < 2 * (a + c - 2 * b):
                # An extremum that points towards zero may hide a crossing and the way back.
                low, high = max(0.0, (j - 2) / SAMPLES), min(1.0, j / SAMPLES)
                s = _lowest(functions, t, h, q, p, asked, n, regime, own, i, now[i], low, high, x, g, slope)
                if s >= 0:
                    if not _crosses(now[i], -now[i], directions[i]):
                        low, s = s, high
                    if s < right:
                        found, left, right = i, low, s
                    continue
            if j <= SAMPLES and _crosses(now[i], last[2, i], directions[i]) and j / SAMPLES < right:
                found, left, right = i, (j - 1) / SAMPLES, j / SAMPLES
        if found >= 0:
            return found, left, right
        for i in range(m):
            if last[2, i] != 0.0 and j <= SAMPLES:
                now[i] = _sign(last[2, i])
    return -1, 0.0, 0.0


@njit(cache=True, nogil=True, **INNER)
def _lowest(functions, t, h, q, p, asked, n, regime, own, i, side, low, high, x, g, slope):
    """A fraction between ``low`` and ``high`` where function i is beyond zero, or −1 (golden section)."""
    golden = 0.6180339887498949
    a, b = low, high
    for _ in range(40):
        one, two = b - golden * (b - a), a + golden * (b - a)
        interpolate(q, one, x)
        if _watched(functions, t + one * h, x, p, asked, n, regime, own, 0, g, slope) != 0:
            return -1.0
        first = g[i] * side
        if first < 0:
            return one
        interpolate(q, two, x)
        if _watched(functions, t + two * h, x, p, asked, n, regime, own, 0, g, slope) != 0:
            return -1.0
        second = g[i] * side
        if second < 0:
            return two
        if first < second:
            b = two
        else:
            a = one
    return -1.0


@njit(cache=True, nogil=True, **INNER)
def _locate(functions, t, h, q, p, asked, n, regime, own, i, side, low, high, x, g, slope):
    """Fraction of the step at which function i leaves ``side``, by bisection on the dense output."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        interpolate(q, middle, x)
        if _watched(functions, t + middle * h, x, p, asked, n, regime, own, 0, g, slope) != 0:
            return -1.0
        if g[i] * side < 0:
            high = middle
        else:
            low = middle
    return high


@njit(cache=True, nogil=True, **INNER)
def _earlier(functions, t, h, q, p, asked, n, regime, own, which, low, high, directions, x, g, slope):
    """Another function that crosses between ``low`` and ``high``, in front of ``which``, and its side; −1 for none.

    Two crossings between neighbouring samples come in either order.
    """
    interpolate(q, low, x)
    if _watched(functions, t + low * h, x, p, asked, n, regime, own, 0, g, slope) != 0:
        return -1, 0.0
    before = np.empty(g.size)
    _copy(g, before)
    interpolate(q, high, x)
    if _watched(functions, t + high * h, x, p, asked, n, regime, own, 0, g, slope) != 0:
        return -1, 0.0
    for i in range(g.size):
        side = _sign(before[i])
        if i != which and directions[i] != 0 and _crosses(side, g[i], directions[i]):
            return i, side
    return -1, 0.0


@njit(cache=True, nogil=True, **INNER)
def _first_step(rate, t, y, p, n, count, regime, tolerance, weight, k, scratch):
    """A step to begin with, from the sizes of f and of its change (Hairer et al., section II.4)."""
    size, slope = 0.0, 0.0
    for i in range(n):
        allowed = weight[i] + abs(y[i])
        size += (y[i] / allowed) ** 2
        slope += (k[0, i] / allowed) ** 2
    size, slope = np.sqrt(size / n), np.sqrt(slope / n)
    h = 1e-6 if size < 1e-5 or slope < 1e-5 else 0.01 * size / slope
    for i in range(y.size):
        scratch[i] = y[i] + h * k[0, i]
    if _call_rate(rate, t + h, scratch, p, count, regime, k[1]) != 0:
        return h
    bend = 0.0
    for i in range(n):
        bend += ((k[1, i] - k[0, i]) / (weight[i] + abs(y[i]))) ** 2
    bend = np.sqrt(bend / n) / h
    if not np.isfinite(bend):
        return h
    most = max(slope, bend)
    other = max(1e-6, h * 1e-3) if most <= 1e-15 else (tolerance / most) ** (1.0 / 8.0)
    return min(100 * h, other)


@njit(cache=True, nogil=True, **INNER)
def _pass_event(functions, t, y, p, asked, n, count, regime, then, which, jumps, g, slope, k, scratch):
    """Carry state and tangents across switching surface ``which`` into regime ``then`` (saltation).

    A neighbour v meets the surface δτ = −∇g·v/ġ later: it moves on with f⁻ for that long, jumps, and moves
    with f⁺ for that much less.
    """
    if _watched(functions, t, y[:n], p, asked, n, regime, g.size, 1, g, slope) != 0:
        return 1
    delay = np.zeros(max(count, 1))
    if count > 0:
        row = slope[which * (n + 1) : (which + 1) * (n + 1)]
        if _call_rate(functions[0], t, y[:n], p, 0, regime, k[0, :n]) != 0:
            return 1
        speed = row[n]
        for i in range(n):
            speed += row[i] * k[0, i]
        for block in range(1, count + 1):
            total = 0.0
            for i in range(n):
                total += row[i] * y[block * n + i]
            delay[block - 1] = -total / speed if speed != 0.0 else 0.0
            for i in range(n):
                y[block * n + i] += k[0, i] * delay[block - 1]
    if jumps and _call_jump(functions[2], t, y, p, count, regime, which, delay) != 0:
        return 1
    if count > 0:
        if _call_rate(functions[0], t, y[:n], p, 0, then, k[0, :n]) != 0:
            return 1
        for block in range(1, count + 1):
            for i in range(n):
                y[block * n + i] -= k[0, i] * delay[block - 1]
    return 0


@njit(cache=True, nogil=True, **INNER)
def _new_sides(functions, t, h, y, p, asked, n, regime, own, fired, side, jumped, directions, due, g, slope, k, sides):
    """On which side of each surface the motion goes on; the surface that it at once crosses, −1 for none, −2 refused.

    ``fired``, reached from ``side``, stands at zero to rounding: its new side is that of its rate of change. Where a
    motion just touches ``fired``, a surface that is ``due`` (own,), one that leads back or was awaited before, may have
    been crossed a moment earlier, far less than the step ``h``; it is crossed now.
    """
    if _watched(functions, t, y[:n], p, asked, n, regime, own, 1, g, slope) != 0:
        return -2
    again = -1
    for i in range(g.size):
        size = 0.0
        if i == fired or fired < 0:  # a start on a surface is like an event there
            for j in range(n):
                size += abs(slope[i * (n + 1) + j] * y[j])
            size = (1e-9 if i == fired else 1e-13) * (size + abs(slope[i * (n + 1) + n] * t)) + 1e-14
        if abs(g[i]) > size:
            sides[i] = _sign(g[i])
            if i < own and due[i] and directions[i] == sides[i]:
                speed = _change(functions, t, y, p, n, regime, slope, i, k)
                if 0 < g[i] * speed and abs(g[i]) < MOMENT * h * abs(speed):
                    again = i
            continue
        sides[i] = _sign(_change(functions, t, y, p, n, regime, slope, i, k))
        if i == fired and i < own and sides[i] != 0.0:
            returns = sides[i] == side and (directions[i] == side or directions[i] == 2)
            if (not jumped and returns) or (jumped and directions[i] == sides[i]):
                again = i
    return again


@njit(cache=True, nogil=True, **INNER)
def _change(functions, t, y, p, n, regime, slope, i, k):
    """dg/dt of a function along the motion; 0 where it cannot be evaluated."""
    if _call_rate(functions[0], t, y[:n], p, 0, regime, k[0, :n]) != 0:
        return 0.0
    total = slope[i * (n + 1) + n]
    for j in range(n):
        total += slope[i * (n + 1) + j] * k[0, j]
    return total


@njit(cache=True, nogil=True, **INNER)
def _directions(transitions, directions, watched, regime, out):
    """Directions in which each function is watched while in ``regime``; 0 where it is not."""
    own = transitions.shape[1]
    for i in range(own):
        out[i] = directions[regime, i] if transitions[regime, i] >= 0 else 0
    for i in range(watched.size):
        out[own + i] = watched[i]


@njit(cache=True, nogil=True)
def advance(
    functions, p, asked, y, n, count, transitions, directions, watched, stops,
    clock, whole, sides, end, tolerance, weight, longest, most_steps, dense,
    step_start, step_length, step_regime, step_states, coefficients,
    event_time, event_which, event_before, event_after,
):  # fmt: skip
    """Carry ``y`` on to ``end`` or until the buffers are full; returns how it ended.

    functions (4,): addresses of rate, guard, jump, and of the functions the caller watches, which receive the
        numbers ``asked`` in place of ``p`` (0: none).
    transitions, directions (regimes, guards): the regime a guard leads to (−1: not watched) and its direction.
    watched, stops (events,): directions of the caller's functions, and whether they end the integration. Where nothing
        at all is watched ``watched`` is None: all that has to do with events is then left out when this is compiled.
    clock, whole, sides: carried from call to call; whole[FRESH] = 1 on the first.
    step_… (capacity, …): start, length, regime and end state of each step; ``coefficients`` if ``dense``.
    event_…: time, function and the states on both sides of each event.
    """
    rate, own = functions[0], transitions.shape[1]
    m = 0
    if watched is not None:
        m = own + watched.size
    wide = y.size
    k = np.zeros((ALL_STAGES, wide))
    new, scratch = np.empty(wide), np.empty(wide)
    x, q = np.empty(n), np.zeros((POWERS, n))
    g, slope = np.zeros(m), np.zeros(m * (n + 1))
    active, due = np.zeros(m, dtype=np.int64), np.zeros(own, dtype=np.bool_)
    t, h, regime = clock[TIME], clock[STEP], whole[REGIME]
    whole[STORED], whole[EVENTS] = 0, 0
    if whole[FRESH] == 1:
        clock[SPAN] = end - t
        clock[LAST_EVENT] = -np.inf
    if watched is not None:
        _directions(transitions, directions, watched, regime, active)
        if whole[FRESH] == 1 and m > 0:
            if (
                _new_sides(
                    functions, t, 0.0, y, p, asked, n, regime, own, -1, 0.0, False, active, due, g, slope, k, sides
                )
                == -2
            ):
                return REFUSED
    if _call_rate(rate, t, y, p, count, regime, k[0]) != 0:
        return REFUSED
    for i in range(wide):
        if not np.isfinite(k[0, i]):
            return NOT_FINITE
    if whole[FRESH] == 1:
        if h <= 0.0:
            h = _first_step(rate, t, y, p, n, count, regime, tolerance, weight, k, scratch)
        whole[FRESH] = 0
    rejected = False
    while t < end:
        clock[TIME], clock[STEP] = t, h
        if whole[STORED] == step_start.size or whole[EVENTS] + MOST_QUICK_EVENTS + 2 > event_time.size:
            return FULL
        if whole[STEPS] >= most_steps:
            return STEP_LIMIT
        h = min(h, longest)
        step = end - t if t + 1.01 * h >= end else h
        least = 16 * EPS * max(abs(t), 1e-6 * clock[SPAN])
        if step < least:
            if end - t < least:
                break
            return TOO_SMALL
        refused = _stages(rate, t, step, y, p, count, regime, k, new)
        error = np.nan if refused != 0 else _error(step, y, new, k, n, count, tolerance, weight)
        if not error <= 1.0:
            factor = 0.2 if np.isnan(error) else max(0.2, 0.9 * error ** (-0.125))
            h = step * factor
            rejected = True
            whole[REJECTED] += 1
            if np.isnan(error) and h < least:
                return REFUSED if refused != 0 else NOT_FINITE
            continue
        grow = 6.0 if error == 0.0 else min(6.0, 0.9 * error ** (-0.125))
        proposed = step * (min(1.0, grow) if rejected else max(grow, 0.2))
        if _call_rate(rate, t + step, new, p, count, regime, k[STAGES]) != 0:
            return REFUSED
        which, side = -1, 0.0
        if (m > 0 or dense) and _dense(rate, t, step, y, new, p, n, regime, k, scratch, q) != 0:
            return REFUSED
        if watched is not None:
            if m > 0:
                which, low, high = _bracket(functions, t, step, q, p, asked, n, regime, own, sides, active, x, g, slope)
                if which == -2:
                    return REFUSED
            if which >= 0:
                side = 1.0 if active[which] == -1 else (-1.0 if active[which] == 1 else 0.0)
                if side == 0.0:
                    interpolate(q, high, x)
                    _watched(functions, t + high * step, x, p, asked, n, regime, own, 0, g, slope)
                    side = -_sign(g[which])
                fraction = _locate(functions, t, step, q, p, asked, n, regime, own, which, side, low, high, x, g, slope)
                for _ in range(m):
                    other, beside = _earlier(
                        functions, t, step, q, p, asked, n, regime, own, which, low, fraction, active, x, g, slope
                    )
                    if fraction < 0 or other < 0:
                        break
                    which, side = other, beside
                    fraction = _locate(
                        functions, t, step, q, p, asked, n, regime, own, which, side, low, fraction, x, g, slope
                    )
                if fraction < 0:
                    return REFUSED
                step = fraction * step
                for _ in range(4):
                    if _stages(rate, t, step, y, p, count, regime, k, new) != 0:
                        return REFUSED
                    _call_rate(rate, t + step, new, p, 0, regime, k[STAGES])
                    _watched(functions, t + step, new[:n], p, asked, n, regime, own, 1, g, slope)
                    speed = slope[which * (n + 1) + n]
                    for i in range(n):
                        speed += slope[which * (n + 1) + i] * k[STAGES, i]
                    change = -g[which] / speed if speed != 0.0 else 0.0
                    if not abs(change) <= 1e-3 * step + 1e-12 * abs(t) or step + change <= 0:
                        break  # tangential: the dense output's answer stands
                    if abs(change) <= 4 * EPS * (abs(t) + step):
                        break
                    step += change
                _call_rate(rate, t + step, new, p, count, regime, k[STAGES])
                if dense:
                    _dense(rate, t, step, y, new, p, n, regime, k, scratch, q)
        row = whole[STORED]
        step_start[row], step_length[row], step_regime[row] = t, step, regime
        _copy(new[:n], step_states[row])
        if dense:
            for r in range(POWERS):
                _copy(q[r], coefficients[row, r])
        whole[STORED] += 1
        whole[STEPS] += 1
        if which < 0:
            t = end if step == end - t else t + step
            h = h if step < h else proposed  # a step cut short at the end proves nothing
            _copy(k[STAGES], k[0])
        else:
            t += step
        clock[TIME], clock[STEP] = t, h
        _copy(new, y)
        rejected = False
        if watched is not None:
            if m > 0 and which < 0:
                _watched(functions, t, y[:n], p, asked, n, regime, own, 0, g, slope)
                for i in range(m):
                    if g[i] != 0.0:
                        sides[i] = _sign(g[i])
            while which >= 0:
                at = whole[EVENTS]
                event_time[at], event_which[at] = t, which
                _copy(y[:n], event_before[at])
                then = transitions[regime, which] if which < own else regime
                jumped = which < own and functions[2] != 0
                if (
                    which < own
                    and _pass_event(
                        functions, t, y, p, asked, n, count, regime, then, which, jumped, g[:own], slope, k, scratch
                    )
                    != 0
                ):
                    return REFUSED
                _copy(y[:n], event_after[at])
                whole[EVENTS] += 1
                near = t - clock[LAST_EVENT] <= 256 * EPS * max(abs(t), 1e-3 * clock[SPAN])
                whole[QUICK] = whole[QUICK] + 1 if near else 0
                clock[LAST_EVENT] = t
                for i in range(own):
                    awaited = directions[then, i] == directions[regime, i] and sides[i] == -directions[then, i]
                    due[i] = transitions[then, i] == regime or (transitions[regime, i] >= 0 and awaited)
                regime = then
                whole[REGIME] = regime
                _directions(transitions, directions, watched, regime, active)
                again = _new_sides(
                    functions, t, h, y, p, asked, n, regime, own, which, side, jumped, active, due, g, slope, k, sides
                )
                if again == -2 or _call_rate(rate, t, y, p, count, regime, k[0]) != 0:
                    return REFUSED
                if whole[QUICK] > MOST_QUICK_EVENTS:
                    return CHATTER
                if which >= own and stops[which - own] != 0:
                    return STOPPED
                if again != which:
                    side = -active[again] if again >= 0 else 0.0
                elif not jumped:
                    side = -side
                which = again
        for i in range(wide):
            if not abs(y[i]) < LARGEST:
                return BEYOND
    return REACHED

"""Motion of many masses joined by springs that are linear stage by stage, to rounding within every stage.

With q the twists of the springs of a tree (m,), f their torques and G = E M⁻¹ Eᵀ,

    q″ = −G f − D q′ + b(t),   f_e = c q_e′ + s q_e + d in its stage,   b = B₀ + Σ_j Re[B_j e^{iω_j t}].

Within a combination of stages this is linear with constant coefficients, so the Taylor coefficients of the motion
follow from each other, q_{k+1} = v_k/(k+1) and v_{k+1} = (−G f_k − D v_k + b_k)/(k+1), and a step is so long that the
last of them is below rounding. Nothing is divided by an eigenvalue: free flight and resonance are not exceptions.

A slider (Jenkins element: spring in series with dry friction) is one more row on the twist of its ``source``, whose
rate it has: q is the deflection of its spring, which stands still in the stages where it slips (``moves`` 0), so that
its torque is a law of q like any other.

A stage is left where one of its guards g = a q_e + h q_e′ − r crosses zero in the direction given. On a step g is a
known polynomial and |g″| ≤ Σ k(k−1)|g_k|τ^{k−2}, so the first zero is approached from one side, quadratically, and
none is overlooked.

This file imports nothing of the package: a cached copy of it is compiled.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
import math

import numpy as np
from numba import njit

ORDER = 26
"""Of the Taylor polynomials."""
ROUNDING = 1e-17
LEADING = 3
"""Terms that the last one is compared with."""
GUARDS = 3
DONE, TOO_MANY_EVENTS, STALLED = 0, 1, 2
MOST_IDLE = 1000
"""Steps too short to move the time, one after the other."""
MOST_APPROACHES = 200
TOUCH = 1e-9
"""Share of a step in which a guard that touches zero changes by less than rounding does."""
PARTS = 8
"""Of a step, in which the extrema of its polynomials are told apart."""
RECORDED = 5
"""Columns of the record: time, spring, stage begun, twist rate, rate of the guard in units of twist."""
LOW, HIGH, TORQUE_LOW, TORQUE_HIGH, TWIST_SUM, TORQUE_SUM, CLEARANCE, SHARES = range(8)
"""Columns of what is seen of every spring; from SHARES on the time in each stage."""


@njit(cache=True, error_model="numpy")
def polynomial(coefficients, tau):
    """Value of Σ c_k τ^k."""
    total = 0.0
    for k in range(len(coefficients) - 1, -1, -1):
        total = total * tau + coefficients[k]
    return total


@njit(cache=True, error_model="numpy")
def slope(coefficients, tau):
    """Derivative of Σ c_k τ^k."""
    total = 0.0
    for k in range(len(coefficients) - 1, 0, -1):
        total = total * tau + k * coefficients[k]
    return total


@njit(cache=True, error_model="numpy")
def excite(t, constant, frequencies, force, out):
    """Taylor coefficients (m, ORDER + 1) of b at time t."""
    for e in range(len(out)):
        for k in range(ORDER + 1):
            out[e, k] = constant[e] if k == 0 else 0.0
    for j in range(len(frequencies)):
        w = frequencies[j]
        turn = complex(math.cos(w * t), math.sin(w * t))
        for e in range(len(out)):
            if force[j, e] == 0:
                continue
            term = force[j, e] * turn
            for k in range(ORDER + 1):
                out[e, k] += term.real
                term *= 1j * w / (k + 1)


@njit(cache=True, error_model="numpy")
def excite_slope(t, constant_slope, frequencies, frequency_slope, force, force_slope, out):
    """Taylor coefficients of the derivative of b by a parameter: Re Σ (B_j′ + i ω_j′ t B_j) e^{iω_j t}."""
    for e in range(len(out)):
        for k in range(ORDER + 1):
            out[e, k] = constant_slope[e] if k == 0 else 0.0
    for j in range(len(frequencies)):
        w = frequencies[j]
        turn = complex(math.cos(w * t), math.sin(w * t))
        for e in range(len(out)):
            growing = 1j * frequency_slope[j] * force[j, e] * turn
            term, before = force_slope[j, e] * turn + growing * t, 0j
            for k in range(ORDER + 1):
                out[e, k] += (term + before).real
                before = growing
                term *= 1j * w / (k + 1)
                growing *= 1j * w / (k + 1)


@njit(cache=True, error_model="numpy")
def expand(z, stages, g_matrix, drag, pieces, moves, source, push, whole, q, v, f):
    """Taylor coefficients q, v, f (m, ORDER + 1) of the motion from z (2m,) under ``push``; a tangent, for which
    ``whole`` is 0, does not have the offsets of the stages. An int64: for a literal numba compiles anew."""
    m = len(stages)
    for e in range(m):
        q[e, 0], v[e, 0] = z[e], z[m + source[e]]
    for k in range(ORDER + 1):
        for e in range(m):
            s = stages[e]
            f[e, k] = pieces[e, s, 0] * v[e, k] + pieces[e, s, 1] * q[e, k]
            if k == 0 and whole:
                f[e, k] += pieces[e, s, 2]
        if k == ORDER:
            break
        for e in range(m):
            a = push[e, k]
            for i in range(m):
                a -= g_matrix[e, i] * f[i, k] + drag[e, i] * v[i, k]
            q[e, k + 1] = moves[e, stages[e]] * v[e, k] / (k + 1)
            v[e, k + 1] = a / (k + 1)


@njit(cache=True, error_model="numpy")
def length(rows):
    """How far polynomials (m, ORDER + 1) hold to rounding: last terms against the first ones of the same column."""
    h = math.inf
    for e in range(len(rows)):
        for n in (ORDER - 1, ORDER):
            last = abs(rows[e, n])
            if last == 0.0:
                continue
            longest, compared = 0.0, 0
            for k in range(n - 1):
                if rows[e, k] != 0.0:
                    longest = max(longest, (ROUNDING * abs(rows[e, k]) / last) ** (1.0 / (n - k)))
                    compared += 1
                    if compared == LEADING:
                        break
            if compared:
                h = min(h, longest)
    return h


@njit(cache=True, error_model="numpy")
def carry(
    t,
    span,
    w,
    stages,
    g_matrix,
    drag,
    pieces,
    moves,
    source,
    by_parameter,
    constant_slope,
    frequencies,
    frequency_slope,
    force,
    force_slope,
    push,
    q,
    v,
    f,
):
    """Move a tangent w (2m,) from time t over ``span`` within its stages; q, v, f, push are room to work in."""
    m, done = len(stages), 0.0
    for e in range(m):
        for k in range(ORDER + 1):
            push[e, k] = 0.0
    while done < span:
        if by_parameter:
            excite_slope(t + done, constant_slope, frequencies, frequency_slope, force, force_slope, push)
        expand(w, stages, g_matrix, drag, pieces, moves, source, push, np.int64(0), q, v, f)
        step = min(span - done, length(q), length(v))
        for e in range(m):
            w[e], w[m + e] = polynomial(q[e], step), polynomial(v[e], step)
        done = span if done + step >= span or done + step == done else done + step


@njit(cache=True, error_model="numpy")
def first_crossing(g, direction, span, size):
    """When the polynomial of a guard first crosses zero in ``direction`` within ``span``, and whether it does: if not,
    up to when it surely does not. ``size``: of the terms whose difference the guard is."""
    bound, power = 1e-300, 1.0
    for k in range(2, len(g)):
        if g[k] != 0.0:
            bound += k * (k - 1) * abs(g[k]) * power
        power *= span
    if abs(g[1]) * span + bound * span * span <= 4e-16 * size:
        return span, False  # rests, up to rounding
    tau = 0.0
    for _ in range(MOST_APPROACHES):
        value, rate = -direction * polynomial(g, tau), -direction * slope(g, tau)
        if rate < 0 and (value <= 2e-16 * size or value < -rate * 1e-15 * span):
            return tau, True
        value = max(value, 0.0)
        root = math.sqrt(rate * rate + 2 * bound * value)
        safe = 2 * value / (root - rate) if rate < 0 else (rate + root) / bound
        if abs(rate) <= TOUCH * span * bound:
            safe = max(safe, TOUCH * span)
        tau += safe
        if tau > span:
            return span, False
    return tau, False


@njit(cache=True, error_model="numpy")
def turning_point(c, low, high):
    """Where the slope of a polynomial, of two signs at the ends, vanishes."""
    falls = slope(c, low) < 0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (slope(c, middle) < 0) == falls:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@njit(cache=True, error_model="numpy")
def extent(c, span):
    """Least and largest value of a polynomial on [0, span]; least modulus at an extremum inside (or inf)."""
    first, last = polynomial(c, 0.0), polynomial(c, span)
    low, high, nearest = min(first, last), max(first, last), math.inf
    before = slope(c, 0.0)
    for i in range(PARTS):
        after = slope(c, span * (i + 1) / PARTS)
        if (before < 0) != (after < 0):
            value = polynomial(c, turning_point(c, span * i / PARTS, span * (i + 1) / PARTS))
            low, high = min(low, value), max(high, value)
            nearest = min(nearest, abs(value))
        before = after
    return low, high, nearest


@njit(cache=True, error_model="numpy")
def watch(span, stages, q, v, f, source, guards, then, g, seen):
    """Add a step to what is seen of every spring; its torque holds that of its sliders, in place."""
    for e in range(len(stages)):
        if source[e] != e:
            for k in range(ORDER + 1):
                f[source[e], k] += f[e, k]
    for e in range(len(stages)):
        row = seen[e]
        low, high, _ = extent(q[e], span)
        row[LOW], row[HIGH] = min(row[LOW], low), max(row[HIGH], high)
        low, high, _ = extent(f[e], span)
        row[TORQUE_LOW], row[TORQUE_HIGH] = min(row[TORQUE_LOW], low), max(row[TORQUE_HIGH], high)
        twist, torque = 0.0, 0.0
        for k in range(ORDER, -1, -1):
            twist = twist * span + q[e, k] / (k + 1)
            torque = torque * span + f[e, k] / (k + 1)
        row[TWIST_SUM] += twist * span
        row[TORQUE_SUM] += torque * span
        row[SHARES + stages[e]] += span
        for i in range(GUARDS):
            if then[e, stages[e], i] >= 0:
                a, h, r, direction = guards[e, stages[e], i]
                for k in range(ORDER + 1):
                    g[k] = -direction * (a * q[e, k] + h * v[e, k])
                g[0] += direction * r
                row[CLEARANCE] = min(row[CLEARANCE], extent(g, span)[2] / (abs(a) if a != 0.0 else 1.0))


@njit(cache=True, error_model="numpy")
def locate(z, counts, guards, then, stages):
    """The stages (m,) of a state: those whose guards are all on the side where the stage lasts, or nearest to it."""
    m = len(counts)
    for e in range(m):
        best, depth = 0, -math.inf
        for stage in range(counts[e]):
            least = math.inf
            for i in range(GUARDS):
                if then[e, stage, i] >= 0:
                    a, h, r, direction = guards[e, stage, i]
                    least = min(least, -direction * (a * z[e] + h * z[m + e] - r))
            if least > depth:
                best, depth = stage, least
        stages[e] = best


@njit(cache=True, error_model="numpy")
def advance(
    start,
    end,
    z,
    stages,
    g_matrix,
    drag,
    constant,
    frequencies,
    force,
    constant_slope,
    frequency_slope,
    force_slope,
    pieces,
    moves,
    source,
    guards,
    then,
    tangents,
    moved,
    record,
    times,
    states,
    shown_stages,
    seen,
    final_rate,
):
    """Move ``z`` (2m,), ``stages`` (m,) and ``tangents`` (columns, 2m) from ``start`` to ``end``.

    g_matrix, drag (m, m); constant (m,), frequencies (waves,), force (waves, m) complex: b, and their derivatives by a
    parameter, which the last ``moved`` (0 or 1) columns of the tangents belong to; pieces (m, stages, 3): c, s, d;
    moves (m, stages): 0 where q stands still, else 1; source (m,): whose rate it has, its own or that of another row;
    guards (m, stages, GUARDS, 4): a, h, r, direction; then (m, stages, GUARDS): next stage or −1. record (rows,
    RECORDED) receives the events; states (times, 2m) and shown_stages (times, m) the motion at rising ``times``; seen
    (m or 0, SHARES + stages) what is seen of it; final_rate (m,) q″ at the end. Returns the time reached, the number
    of events and how it ended.
    """
    m, t, events, shown, idle = len(stages), start, 0, 0, 0
    rows = (m, ORDER + 1)
    q, v, f, force_now = np.zeros(rows), np.zeros(rows), np.zeros(rows), np.zeros(rows)
    wq, wv, wf, push = np.zeros(rows), np.zeros(rows), np.zeros(rows), np.zeros(rows)
    g, columns = np.zeros(ORDER + 1), len(tangents)
    while True:
        excite(t, constant, frequencies, force, force_now)
        expand(z, stages, g_matrix, drag, pieces, moves, source, force_now, np.int64(1), q, v, f)
        step, last = min(length(q), length(v)), False
        if not t + step < end:
            step, last = end - t, True
        which, guard = -1, -1
        for e in range(m):
            for i in range(GUARDS):
                if then[e, stages[e], i] < 0:
                    continue
                a, h, r, direction = guards[e, stages[e], i]
                for k in range(ORDER + 1):
                    g[k] = a * q[e, k] + h * v[e, k]
                size = abs(a * q[e, 0]) + abs(h * v[e, 0]) + abs(r)
                g[0] -= r
                tau, crossed = first_crossing(g, direction, step, size)
                if crossed:
                    step, which, guard, last = tau, e, i, False
                elif tau < step:
                    step, which, last = tau, -1, False
        while shown < len(times) and (times[shown] <= t + step or (last and times[shown] <= end)):
            for e in range(m):
                states[shown, e] = polynomial(q[e], times[shown] - t)
                states[shown, m + e] = polynomial(v[e], times[shown] - t)
                shown_stages[shown, e] = stages[e]
            shown += 1
        if len(seen) > 0 and step > 0:
            watch(step, stages, q, v, f, source, guards, then, g, seen)
        for column in range(columns):
            # The steps of a tangent are its own: it has in it what the motion itself does not excite.
            carry(
                t, step, tangents[column], stages, g_matrix, drag, pieces, moves, source, column >= columns - moved,
                constant_slope, frequencies, frequency_slope, force, force_slope, push, wq, wv, wf,
            )  # fmt: skip
        for e in range(m):
            z[e], z[m + e] = polynomial(q[e], step), polynomial(v[e], step)
            final_rate[e] = slope(v[e], step)
        idle = 0 if t + step > t else idle + 1
        t = end if last else t + step
        if last:
            return t, events, DONE
        if idle > MOST_IDLE:
            return t, events, STALLED
        if which < 0:
            continue
        if events >= len(record):
            return t, events, TOO_MANY_EVENTS
        a, h, r, direction = guards[which, stages[which], guard]
        rate = a * moves[which, stages[which]] * z[m + which] + h * final_rate[which]
        old, new = pieces[which, stages[which]], pieces[which, then[which, stages[which], guard]]
        jump = (new[0] - old[0]) * z[m + which] + (new[1] - old[1]) * z[which] + new[2] - old[2]
        onward = moves[which, then[which, stages[which], guard]] - moves[which, stages[which]]
        stages[which] = then[which, stages[which], guard]
        for column in range(columns):
            # Saltation: a neighbour meets the surface a little later, and has the other torque for that long.
            along = (a * tangents[column, which] + h * tangents[column, m + which]) / rate
            tangents[column, which] += onward * z[m + which] * along
            for e in range(m):
                tangents[column, m + e] -= g_matrix[e, which] * jump * along
        if onward < 0:
            z[which] = r / a  # it slips at its torque exactly
        elif onward > 0:
            z[m + source[which]], z[m + which] = 0.0, 0.0  # or the sign of what is rounding would let it slip again
        row = record[events]
        row[0], row[1], row[2], row[3] = t, which, stages[which], z[m + which]
        row[4] = rate / (abs(a) if a != 0.0 else 1.0)
        events += 1

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
"""The nonlinear right-hand side of lines with slip clutches, on top of that of any line.

``line_kernel`` knows a slip clutch as a compliance without stiffness or damping. Here its torque is added. It is T(v)
against the slip v while it slips, and while it sticks what keeps v where it is: with w₀ = v̇ without any of their
torques and A what a unit torque of one takes off the v̇ of another, Σ A T = w₀ over those that stick.

Numbers of the clutches stand last among those of the line, in front of the room to work in; the last two of them are
how many clutches there are and how many numbers they take. Tangents are those without their torques: nothing that
needs tangents takes such lines.

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

from __future__ import annotations

import math

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic
from trunnion_kernels.line_guards_kernel import gradient, line_guards, line_jump
from trunnion_kernels.line_kernel import (
    COMPLIANCES,
    FAR,
    FAR_COORDINATE,
    GUARDS,
    HEAD,
    MEAN,
    NEAR,
    NEAR_COORDINATE,
    PER_COMPLIANCE,
    PER_STATION,
    REFERENCE,
    SLIDERS,
    SLIPS_BACK,
    SLIPS_ON,
    STAGES,
    STATIONS,
    STICKS,
    STRIDE,
    UNKNOWNS,
    course,
    line,
    places,
)

_POINTER = types.CPointer(types.float64)
_RATE = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER)
_GUARD = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER, _POINTER)
_JUMP = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, types.int64, _POINTER)
# Per clutch: its compliance, T_s, T_c, v_s, the stride of its stages among the regimes, how many points its table of
# shares over time has, and where that begins behind these: time and share of each.
OF, HOLDS, SLIDES, OVER, STEP, POINTS, TABLE = range(7)
PER_CLUTCH = 7
MOST = 4
"""Clutches of a line."""
REST = 1e-9
"""Slip over the speeds of the two sides that counts as none where nothing tells whether a clutch slips."""

_rate, _guards, _jump = (njit(nogil=True)(one.__wrapped__) for one in (line, line_guards, line_jump))


@intrinsic
def _pointer(typing, array):
    """To the data of an array that lies in one piece."""

    def data(context, builder, signature, args):
        return context.make_array(signature.args[0])(context, builder, args[0]).data

    return _POINTER(array), data


@intrinsic
def _call(typing, address, t, x, p, regime, out):
    """The right-hand side at an address: int64(double, double* x, double* p, int64 0, int64 regime, double* out)."""

    def code(context, builder, signature, args):
        given = [
            context.make_array(kind)(context, builder, arg).data if isinstance(kind, types.Array) else arg
            for kind, arg in zip(signature.args[1:], args[1:], strict=True)
        ]
        given.insert(3, ir.Constant(ir.IntType(64), 0))
        function = ir.FunctionType(ir.IntType(64), [arg.type for arg in given])
        return builder.call(builder.inttoptr(args[0], function.as_pointer()), given)

    whole = types.int64
    return whole(whole, types.float64, x, p, whole, out), code


@njit(cache=True, nogil=True)
def clutches(p, scratch):
    """Number of clutches and where their numbers begin."""
    return int(p[scratch - 2]), scratch - int(p[scratch - 1])


@njit(cache=True, nogil=True)
def clamped(t, p, first, c):
    """Share of its capacity that clutch ``c`` is clamped with."""
    at = first + c * PER_CLUTCH
    points, table = int(p[at + POINTS]), first + int(p[at + TABLE])
    if points == 0:
        return 1.0
    if t <= p[table]:
        return p[table + 1]
    for i in range(1, points):
        one, other = table + 2 * (i - 1), table + 2 * i
        if t < p[other]:
            return p[one + 1] + (p[other + 1] - p[one + 1]) * (t - p[one]) / (p[other] - p[one])
    return p[table + 2 * points - 1]


@njit(cache=True, nogil=True)
def holds(t, p, first, c):
    """T_s of clutch ``c`` as it is clamped."""
    return p[first + c * PER_CLUTCH + HOLDS] * clamped(t, p, first, c)


@njit(cache=True, nogil=True)
def slides(t, slip, p, first, c):
    """T(|v|) of clutch ``c`` as it is clamped."""
    at = first + c * PER_CLUTCH
    full = p[at + SLIDES] + (p[at + HOLDS] - p[at + SLIDES]) * math.exp(-abs(slip) / p[at + OVER])
    return full * clamped(t, p, first, c)


@njit(cache=True, nogil=True)
def effects(p, scratch, n, count, alpha, slip, without, mutual):
    """Slips v, their rates w₀ without torques (clutch,), and A (clutch, clutch), from what the right-hand side left in
    its room to work."""
    number, first = clutches(p, scratch)
    compliance, _, _, _ = places(p)
    v = scratch + count
    r, r1 = scratch + 2 * count, scratch + 3 * count
    inertia, acceleration = scratch + 5 * count, scratch + 5 * count + 6 * n
    for c in range(number):
        q = compliance + int(p[first + c * PER_CLUTCH + OF]) * PER_COMPLIANCE
        near, far = int(p[q + NEAR]), int(p[q + FAR])
        i, j = int(p[q + NEAR_COORDINATE]), int(p[q + FAR_COORDINATE])
        reference = int(p[HEAD + near * PER_STATION + REFERENCE])
        slip[c] = p[v + far] - p[v + near]
        turning = p[acceleration + i] if i >= 0 else p[HEAD + reference * PER_STATION + MEAN] * alpha
        without[c] = p[acceleration + j] - p[r + near] * turning - p[r1 + near] * p[v + reference] ** 2
        for e in range(number):
            s = compliance + int(p[first + e * PER_CLUTCH + OF]) * PER_COMPLIANCE
            other, k, m = int(p[s + NEAR]), int(p[s + NEAR_COORDINATE]), int(p[s + FAR_COORDINATE])
            total = 0.0
            if m == j:
                total += 1.0 / p[inertia + j]
            if k == j:
                total -= p[r + other] / p[inertia + j]
            if i >= 0 and m == i:
                total -= p[r + near] / p[inertia + i]
            if i >= 0 and k == i:
                total += p[r + near] * p[r + other] / p[inertia + i]
            mutual[c, e] = total


@njit(cache=True, nogil=True)
def solved(stage, torque, without, mutual, number):
    """Put the torques of those that stick into ``torque``, those of the others being there (elimination in place)."""
    a, b, which = np.empty((MOST, MOST)), np.empty(MOST), np.empty(MOST, dtype=np.int64)
    m = 0
    for c in range(number):
        if stage[c] == STICKS:
            which[m] = c
            m += 1
    for row in range(m):
        c = which[row]
        b[row] = without[c]
        for e in range(number):
            if stage[e] != STICKS:
                b[row] -= mutual[c, e] * torque[e]
        for column in range(m):
            a[row, column] = mutual[c, which[column]]
    for k in range(m):  # A is positive definite
        for row in range(k + 1, m):
            f = a[row, k] / a[k, k]
            for column in range(k, m):
                a[row, column] -= f * a[k, column]
            b[row] -= f * b[k]
    for k in range(m - 1, -1, -1):
        for column in range(k + 1, m):
            b[k] -= a[k, column] * torque[which[column]]
        torque[which[k]] = b[k] / a[k, k]


@njit(cache=True, nogil=True)
def sliding(t, p, first, number, stage, slip, torque):
    """Torques of those that slip."""
    for c in range(number):
        if stage[c] == SLIPS_ON:
            torque[c] = slides(t, slip[c], p, first, c)
        elif stage[c] == SLIPS_BACK:
            torque[c] = -slides(t, slip[c], p, first, c)


@njit(cache=True, nogil=True)
def stages_of(regime, p, first, number, stage):
    """Of every clutch in a regime of the line."""
    for c in range(number):
        stage[c] = regime // int(p[first + c * PER_CLUTCH + STEP]) % 3


@cfunc(_RATE, cache=True)
def slipping_line(t, y_, p_, k, regime, out_):
    """Rates of the unknowns; the torques of the clutches stand in the room to work in, among those of the shafts."""
    refused = _rate(t, y_, p_, k, regime, out_)
    if refused != 0:
        return refused
    head = carray(p_, (HEAD,))
    n, count, joined = int(head[UNKNOWNS]), int(head[STATIONS]), int(head[COMPLIANCES])
    compliance, _, _, scratch = places(head)
    p, out = carray(p_, (scratch + 5 * count + 7 * n + 5 * joined,)), carray(out_, (2 * n,))
    _, _, alpha = course(t, p)
    slip, without, mutual = np.empty(MOST), np.empty(MOST), np.empty((MOST, MOST))
    stage, torque = np.empty(MOST, dtype=np.int64), np.zeros(MOST)
    number, first = clutches(p, scratch)
    effects(p, scratch, n, count, alpha, slip, without, mutual)
    stages_of(regime, p, first, number, stage)
    sliding(t, p, first, number, stage, slip, torque)
    solved(stage, torque, without, mutual, number)
    r, inertia, shaft = scratch + 2 * count, scratch + 5 * count, scratch + 5 * count + 7 * n
    for c in range(number):
        e = int(p[first + c * PER_CLUTCH + OF])
        q = compliance + e * PER_COMPLIANCE
        i, j = int(p[q + NEAR_COORDINATE]), int(p[q + FAR_COORDINATE])
        p[shaft + e] = torque[c]
        out[n + j] -= torque[c] / p[inertia + j]
        if i >= 0:
            out[n + i] += p[r + int(p[q + NEAR])] * torque[c] / p[inertia + i]
    return 0


@cfunc(_GUARD, cache=True)
def slipping_guards(t, x_, p_, regime, sloped, g_, slope_):
    """Switching functions of the line's stages and sliders, and GUARDS of every clutch behind them.

    Sticking: the torque beyond − T_s and beyond T_s. Slipping: the slip, where it ends in sticking as the last of the
    three, and where the torque at rest would exceed the capacity, so that it slips the other way at once, as the first
    or the second.
    """
    head = carray(p_, (HEAD,))
    n, count, joined, friction = int(head[UNKNOWNS]), int(head[STATIONS]), int(head[COMPLIANCES]), int(head[SLIDERS])
    compliance, _, _, scratch = places(head)
    p = carray(p_, (scratch + 5 * count + 7 * n + 5 * joined,))
    wide = 2 * n + friction + 1
    number, first = clutches(p, scratch)
    _guards(t, x_, p_, regime, sloped, g_, slope_)
    m = GUARDS * friction
    for e in range(joined):
        if p[compliance + e * PER_COMPLIANCE + STAGES] >= 2.0:
            m += GUARDS
    g, every = carray(g_, (m + GUARDS * number,)), carray(slope_, ((m + GUARDS * number) * wide,))
    rates = np.empty(wide - 1)
    _rate(t, x_, p_, 0, regime, _pointer(rates))
    _, omega, alpha = course(t, p)
    slip, without, mutual = np.empty(MOST), np.empty(MOST), np.empty((MOST, MOST))
    stage, torque = np.empty(MOST, dtype=np.int64), np.zeros(MOST)
    effects(p, scratch, n, count, alpha, slip, without, mutual)
    v, r, r1 = p[scratch + count :], p[scratch + 2 * count :], p[scratch + 3 * count :]
    for c in range(number):
        stages_of(regime, p, first, number, stage)
        own = stage[c]
        stage[c] = STICKS
        sliding(t, p, first, number, stage, slip, torque)
        solved(stage, torque, without, mutual, number)
        most = holds(t, p, first, c)
        for guard in range(GUARDS):
            g[m + guard] = 1.0
            if sloped != 0:
                every[(m + guard) * wide : (m + guard + 1) * wide] = 0.0
        if own == STICKS:
            g[m], g[m + 1] = torque[c] + most, torque[c] - most
        else:
            through = torque[c] < -most if own == SLIPS_ON else torque[c] > most
            place = 2
            if through:
                place = 0 if own == SLIPS_ON else 1
            for guard in range(GUARDS):
                g[m + guard] = slip[c] if guard == place else (1.0 if own == SLIPS_ON else -1.0)
            if sloped != 0:
                q = compliance + int(p[first + c * PER_CLUTCH + OF]) * PER_COMPLIANCE
                gradient(every[(m + place) * wide : (m + place + 1) * wide], p, q, 0.0, 1.0, omega, alpha, v, r, r1)
        m += GUARDS
    return 0


@cfunc(_JUMP, cache=True)
def slipping_jump(t, y_, p_, k, regime, which, delay_):
    """As that of the line's sliders; clutches leave the state as it is."""
    head = carray(p_, (HEAD,))
    compliance, _, _, _ = places(head)
    joined = int(head[COMPLIANCES])
    p = carray(p_, (compliance + joined * PER_COMPLIANCE,))
    m = GUARDS * int(head[SLIDERS])
    for e in range(joined):
        if p[compliance + e * PER_COMPLIANCE + STAGES] >= 2.0:
            m += GUARDS
    return _jump(t, y_, p_, k, regime, which, delay_) if which < m else 0


@njit(cache=True, nogil=True)
def located(rate, t, x, p, regime):
    """``regime`` of the springs and sliders with the stages of the clutches that the state tells: one whose sides turn
    alike sticks where it can."""
    n, count = int(p[UNKNOWNS]), int(p[STATIONS])
    compliance, _, _, scratch = places(p)
    number, first = clutches(p, scratch)
    _, _, alpha = course(t, p)
    rates = np.empty(x.size)
    _call(rate, t, x, p, regime, rates)
    slip, without, mutual = np.empty(MOST), np.empty(MOST), np.empty((MOST, MOST))
    stage, torque = np.full(MOST, STICKS), np.zeros(MOST)
    effects(p, scratch, n, count, alpha, slip, without, mutual)
    for c in range(number):
        q = compliance + int(p[first + c * PER_CLUTCH + OF]) * PER_COMPLIANCE
        size = abs(p[scratch + count + int(p[q + FAR])]) + abs(p[scratch + count + int(p[q + NEAR])])
        if abs(slip[c]) > REST * size:
            stage[c] = SLIPS_ON if slip[c] > 0.0 else SLIPS_BACK
    for _ in range(number):
        sliding(t, p, first, number, stage, slip, torque)
        solved(stage, torque, without, mutual, number)
        worst, beyond = -1, 0.0
        for c in range(number):
            if stage[c] == STICKS and abs(torque[c]) - holds(t, p, first, c) > beyond:
                worst, beyond = c, abs(torque[c]) - holds(t, p, first, c)
        if worst < 0:
            break
        stage[worst] = SLIPS_ON if torque[worst] > 0.0 else SLIPS_BACK
    for c in range(number):
        regime += stage[c] * int(p[first + c * PER_CLUTCH + STEP])
    return regime


@njit(cache=True, nogil=True)
def observe_clutches(rate, times, states, p, regimes, stages, torque, slip):
    """Torque into (m, compliances), and slip (m, clutches) of every clutch along a motion.

    ``regimes`` (m,) : those that the motion was in, or −1 where the state is to tell, of which ``stages`` (m,
    compliances) are those of the springs.
    """
    n, count = int(p[UNKNOWNS]), int(p[STATIONS])
    compliance, _, _, scratch = places(p)
    number, first = clutches(p, scratch)
    rates = np.empty(states.shape[1])
    for m in range(times.size):
        regime = regimes[m]
        if regime < 0:
            regime = 0
            for e in range(int(p[COMPLIANCES])):
                q = compliance + e * PER_COMPLIANCE
                if p[q + STAGES] > 0.0:
                    regime += stages[m, e] * int(p[q + STRIDE])
            regime = located(rate, times[m], states[m], p, regime)
        _call(rate, times[m], states[m], p, regime, rates)
        for c in range(number):
            e = int(p[first + c * PER_CLUTCH + OF])
            q = compliance + e * PER_COMPLIANCE
            torque[m, e] = p[scratch + 5 * count + 7 * n + e]
            slip[m, c] = p[scratch + count + int(p[q + FAR])] - p[scratch + count + int(p[q + NEAR])]

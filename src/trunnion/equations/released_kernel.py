# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
"""The nonlinear right-hand side of lines with slip clutches and centrifugal pendulums, on top of that of any line.

``line_kernel`` knows both as compliances without stiffness or damping. Here their torques are added.

A clutch carries T(v) against the slip v while it slips, and while it sticks what keeps v where it is: with w₀ = v̇
without any of their torques and A what a unit torque of one takes off the v̇ of another, Σ A T = w₀ over those that
stick.

A pendulum of mass m at S along its path, X(S) the square of its distance from the axis and G = √(X − ¼X′²), on a host
of rotation θ (Denman 1992), its damper F = c S′:

    m (S″ + G θ″ − ½X′θ′²) = −F
    torque on the host: −m (X θ″ + G S″ + X′S′θ′ + G′S′²).

S is c = R + r times the twist of its ring against the host, and S″ is put into the torque, so that m(X − G²) counts as
inertia of the host.

Numbers of pendulums and clutches stand last among those of the line, in front of the room to work in; the last three
of them are how many pendulums and clutches there are and how many numbers they take together. Tangents are differences
of fourth order.

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
    LAGS,
    MEAN,
    NEAR,
    NEAR_COORDINATE,
    OMEGA,
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
# shares over time has, where that begins behind these: time and share of each; and what it carries while friction keeps
# both of its sides at rest.
OF, HOLDS, SLIDES, OVER, STEP, POINTS, TABLE, HELD = range(8)
PER_CLUTCH = 8
# Per pendulum: its compliance, m, R, r, whether its path is an epicycloid, and c of S′ [N s/m].
MASS, RADIUS, CURVATURE, EPICYCLOID, DRAG = range(1, 6)
PER_PENDULUM = 6
STEP_SIZE = 1e-3
"""Of differences, in units of 0.01 rad and of that times the speed: 1e-12 of truncation and of rounding."""
MOVES, WEIGHTS = (1.0, -1.0, 2.0, -2.0), (8.0, -8.0, -1.0, 1.0)
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
def path(at, travel, p):
    """X, X′, G and G′ of the path of the pendulum whose numbers stand at ``at``."""
    big, small = p[at + RADIUS], p[at + CURVATURE]
    if p[at + EPICYCLOID] != 0.0:
        square, arm = big / small, big + small
        bend = square + square * square
        along = math.sqrt(arm * arm - bend * travel * travel)
        return arm * arm - square * travel * travel, -2.0 * square * travel, along, -bend * travel / along
    c, s = math.cos(travel / small), math.sin(travel / small)
    return big * big + small * small + 2.0 * big * small * c, -2.0 * big * s, small + big * c, -big / small * s


@njit(cache=True, nogil=True)
def pendulum(a, p, scratch, count):
    """Where numbers of pendulum ``a`` stand, its compliance's place, S, S′ and the host's speed."""
    _, first = clutches(p, scratch)
    at = scratch - 3 - (int(p[scratch - 3]) - a) * PER_PENDULUM
    compliance, _, _, _ = places(p)
    q = compliance + int(p[at + OF]) * PER_COMPLIANCE
    near, far = int(p[q + NEAR]), int(p[q + FAR])
    arm, v = p[at + RADIUS] + p[at + CURVATURE], scratch + count
    travel, rate = arm * (p[scratch + far] - p[scratch + near]), arm * (p[v + far] - p[v + near])
    return at, q, travel, rate, p[v + near]


@njit(cache=True, nogil=True)
def swing_hosts(p, scratch, n, count, out):
    """What pendulums put on their hosts, into the inertias and accelerations in the room to work and into ``out``."""
    v, r, r1 = scratch + count, scratch + 2 * count, scratch + 3 * count
    inertia, acceleration = scratch + 5 * count, scratch + 5 * count + 6 * n
    for a in range(int(p[scratch - 3])):
        at, q, travel, rate, turning = pendulum(a, p, scratch, count)
        near, i = int(p[q + NEAR]), int(p[q + NEAR_COORDINATE])
        if i < 0:
            continue
        x, x1, g, g1 = path(at, travel, p)
        mass = p[at + MASS]
        torque = g * p[at + DRAG] * rate
        torque -= mass * (0.5 * g * x1 * turning * turning + x1 * rate * turning + g1 * rate * rate)
        more, reference = mass * (x - g * g), int(p[HEAD + near * PER_STATION + REFERENCE])
        pushed = torque - more * p[r1 + near] * p[v + reference] ** 2
        before = p[acceleration + i]
        felt = p[inertia + i] + more * p[r + near] ** 2
        p[acceleration + i] = (p[inertia + i] * before + p[r + near] * pushed) / felt
        p[inertia + i] = felt
        out[n + i] += p[acceleration + i] - before


@njit(cache=True, nogil=True)
def swing(p, scratch, n, count, alpha, out):
    """Accelerations of pendulums, by those of their hosts in ``out``; their torques among those of the shafts."""
    v, r, r1 = scratch + count, scratch + 2 * count, scratch + 3 * count
    shaft = scratch + 5 * count + 7 * n
    for a in range(int(p[scratch - 3])):
        at, q, travel, rate, turning = pendulum(a, p, scratch, count)
        near, i, j = int(p[q + NEAR]), int(p[q + NEAR_COORDINATE]), int(p[q + FAR_COORDINATE])
        reference = int(p[HEAD + near * PER_STATION + REFERENCE])
        host = p[HEAD + reference * PER_STATION + MEAN] * alpha + (out[n + i] if i >= 0 else 0.0)
        host = p[r + near] * host + p[r1 + near] * p[v + reference] ** 2
        x, x1, g, g1 = path(at, travel, p)
        mass, arm = p[at + MASS], p[at + RADIUS] + p[at + CURVATURE]
        along = 0.5 * x1 * turning * turning - g * host - p[at + DRAG] * rate / mass
        far = int(p[HEAD + int(p[q + FAR]) * PER_STATION + REFERENCE])
        out[n + j] = host + along / arm - p[HEAD + far * PER_STATION + MEAN] * alpha
        p[shaft + int(p[at + OF])] = -mass * (x * host + g * along + x1 * rate * turning + g1 * rate * rate)


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
def solved(stage, torque, without, mutual, number, p, first):
    """Put the torques of those that stick into ``torque``, those of the others being there (elimination in place).
    Between two that friction keeps at rest no motion tells what a clutch carries: it is HELD."""
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
    for k in range(m):  # A is positive definite, but for what stands on both sides
        for row in range(k + 1, m):
            f = a[row, k] / a[k, k] if a[k, k] != 0.0 else 0.0
            for column in range(k, m):
                a[row, column] -= f * a[k, column]
            b[row] -= f * b[k]
    for k in range(m - 1, -1, -1):
        for column in range(k + 1, m):
            b[k] -= a[k, column] * torque[which[column]]
        torque[which[k]] = b[k] / a[k, k] if a[k, k] != 0.0 else p[first + which[k] * PER_CLUTCH + HELD]


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


@njit(cache=True, nogil=True)
def rates(t, x, p, regime, out):
    """Rates of a state x, as an array; torques of clutches and pendulums stand in the room to work in, among those of
    the shafts."""
    refused = _rate(t, _pointer(x), _pointer(p), 0, regime, _pointer(out))
    if refused != 0:
        return refused
    n, count = int(p[UNKNOWNS]), int(p[STATIONS])
    compliance, _, _, scratch = places(p)
    _, _, alpha = course(t, p)
    swing_hosts(p, scratch, n, count, out)
    number, first = clutches(p, scratch)
    if number > 0:
        slip, without, mutual = np.empty(MOST), np.empty(MOST), np.empty((MOST, MOST))
        stage, torque = np.empty(MOST, dtype=np.int64), np.zeros(MOST)
        effects(p, scratch, n, count, alpha, slip, without, mutual)
        stages_of(regime, p, first, number, stage)
        sliding(t, p, first, number, stage, slip, torque)
        solved(stage, torque, without, mutual, number, p, first)
        r, inertia, shaft = scratch + 2 * count, scratch + 5 * count, scratch + 5 * count + 7 * n
        pulled = scratch + 5 * count + 3 * n
        for c in range(number):
            e = int(p[first + c * PER_CLUTCH + OF])
            q = compliance + e * PER_COMPLIANCE
            i, j = int(p[q + NEAR_COORDINATE]), int(p[q + FAR_COORDINATE])
            p[shaft + e] = torque[c]
            out[n + j] -= torque[c] / p[inertia + j]
            p[pulled + j] -= torque[c]
            if i >= 0:
                out[n + i] += p[r + int(p[q + NEAR])] * torque[c] / p[inertia + i]
                p[pulled + i] += p[r + int(p[q + NEAR])] * torque[c]
    swing(p, scratch, n, count, alpha, out)
    return 0


@cfunc(_RATE, cache=True)
def released_line(t, y_, p_, k, regime, out_):
    """Rates of the unknowns and of k tangent vectors."""
    head = carray(p_, (HEAD,))
    n, count, joined, friction = int(head[UNKNOWNS]), int(head[STATIONS]), int(head[COMPLIANCES]), int(head[SLIDERS])
    _, _, _, scratch = places(head)
    p, wide = carray(p_, (scratch + 5 * count + 7 * n + 5 * joined,)), 2 * n + friction + int(head[LAGS])
    y, out = carray(y_, ((1 + k) * wide,)), carray(out_, ((1 + k) * wide,))
    refused = rates(t, y[:wide], p, regime, out[:wide])
    if refused != 0 or k == 0:
        return refused
    x, f = np.empty(wide), np.empty(wide)
    unit = 0.01 * max(1.0, abs(head[OMEGA]))
    for block in range(1, k + 1):
        w, o = y[block * wide : (block + 1) * wide], out[block * wide : (block + 1) * wide]
        size = 0.0
        for i in range(wide):
            size = max(size, abs(w[i]) / (unit if n <= i < 2 * n else 0.01))
        step = STEP_SIZE / size if size > 0.0 else 1.0
        o[:] = 0.0
        for move in range(4):
            for i in range(wide):
                x[i] = y[i] + MOVES[move] * step * w[i]
            refused = rates(t, x, p, regime, f)
            if refused != 0:
                return refused
            for i in range(wide):
                o[i] += WEIGHTS[move] * f[i] / (12.0 * step)
    return 0


@cfunc(_GUARD, cache=True)
def released_guards(t, x_, p_, regime, sloped, g_, slope_):
    """Switching functions of the line's stages and sliders, and GUARDS of every clutch behind them.

    Sticking: the torque beyond − T_s and beyond T_s. Slipping: the slip, where it ends in sticking as the last of the
    three, and where the torque at rest would exceed the capacity, so that it slips the other way at once, as the first
    or the second.
    """
    head = carray(p_, (HEAD,))
    n, count, joined, friction = int(head[UNKNOWNS]), int(head[STATIONS]), int(head[COMPLIANCES]), int(head[SLIDERS])
    compliance, _, _, scratch = places(head)
    p = carray(p_, (scratch + 5 * count + 7 * n + 5 * joined,))
    wide = 2 * n + friction + int(head[LAGS]) + 1
    number, first = clutches(p, scratch)
    _guards(t, x_, p_, regime, sloped, g_, slope_)
    m = GUARDS * friction
    for e in range(joined):
        if p[compliance + e * PER_COMPLIANCE + STAGES] >= 2.0:
            m += GUARDS
    g, every = carray(g_, (m + GUARDS * number,)), carray(slope_, ((m + GUARDS * number) * wide,))
    free = np.empty(wide - 1)
    _rate(t, x_, p_, 0, regime, _pointer(free))
    swing_hosts(p, scratch, n, count, free)
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
        solved(stage, torque, without, mutual, number, p, first)
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
def released_jump(t, y_, p_, k, regime, which, delay_):
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
    alike sticks where it can. ``rate``: address of ``released_line``."""
    n, count = int(p[UNKNOWNS]), int(p[STATIONS])
    compliance, _, _, scratch = places(p)
    number, first = clutches(p, scratch)
    _, _, alpha = course(t, p)
    out = np.empty(x.size)
    _call(rate, t, x, p, regime, out)
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
        solved(stage, torque, without, mutual, number, p, first)
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
def observe_released(rate, times, states, p, regimes, stages, torque, slip):
    """Torques of clutches and pendulums into (m, compliances), and slip (m, clutches) of every clutch along a motion.

    ``regimes`` (m,) : those that the motion was in, or −1 where the state is to tell, of which ``stages`` (m,
    compliances) are those of the springs.
    """
    n, count = int(p[UNKNOWNS]), int(p[STATIONS])
    compliance, _, _, scratch = places(p)
    number, first = clutches(p, scratch)
    out = np.empty(states.shape[1])
    for m in range(times.size):
        regime = regimes[m]
        if regime < 0:
            regime = 0
            for e in range(int(p[COMPLIANCES])):
                q = compliance + e * PER_COMPLIANCE
                if p[q + STAGES] > 0.0:
                    regime += stages[m, e] * int(p[q + STRIDE])
            regime = located(rate, times[m], states[m], p, regime)
        _call(rate, times[m], states[m], p, regime, out)
        for c in range(number):
            e = int(p[first + c * PER_CLUTCH + OF])
            q = compliance + e * PER_COMPLIANCE
            torque[m, e] = p[scratch + 5 * count + 7 * n + e]
            slip[m, c] = p[scratch + count + int(p[q + FAR])] - p[scratch + count + int(p[q + NEAR])]
        for a in range(int(p[scratch - 3])):
            e = int(p[scratch - 3 - (a + 1) * PER_PENDULUM + OF])
            torque[m, e] = p[scratch + 5 * count + 7 * n + e]

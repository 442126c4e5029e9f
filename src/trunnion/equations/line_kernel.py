# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
"""The nonlinear right-hand side of any line, reading the line from an array of numbers.

Unknowns are the deviations d_i of the groups' first stations from a uniform rotation ρ_i θ(t) and their rates;
θ is the input's angle and ρ the mean speed ratio. Fork phases are constants of the joints' input angles, so d
stays small however many turns the line makes: a twist is never a difference of large angles.

Within a group every station follows the first by r = da_s/da, with slopes r₁ and r₂ (see ``kinematics``), and

    J ä = Q − ½ J′ ȧ²,   J = Σ I r²,   ½J′ = Σ I r r₁,   ½J″ = Σ I (r₁² + r r₂)
    δä = (δQ − ½J″ ȧ² δa − J′ ȧ δȧ − ä J′ δa) / J.

Room to work in stands at the end of the numbers: an allocation would cost a fifth of the whole. Whoever calls
from several threads gives each a copy of the numbers, as the integrator does.

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

from __future__ import annotations

import math

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic

_POINTER = types.CPointer(types.float64)
_RATE = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER)

# The head of the numbers.
UNKNOWNS, STATIONS, COMPLIANCES, HARMONICS, PRESCRIBED, THETA, OMEGA, ALPHA, SINCE, LAWS, SLIDERS = range(11)
# How many torques are applied from outside, and where they stand among the numbers; how many of them lag, whose values
# are the last states.
APPLIED, APPLIED_AT, LAGS = 11, 12, 13
# How many torque converters there are, and where they stand.
CONVERTERS, CONVERTERS_AT = 14, 15
HEAD = 16
# Per station.
BEFORE, LINK, COORDINATE, REFERENCE, MEAN, PHASE, SIZE, COSINE, SQUARE, OVER = range(10)
# LOAD, BY_SPEED and BY_SQUARE: a torque that goes with the input's prescribed speed, whatever the station's own.
# SHARE: of the station's deviation in that of the mean rotation, by which meshes run; 0 where the input is prescribed.
# STANDS: other than 0 where friction keeps the station, the first of its group, at rest.
INERTIA, LOAD, VISCOUS, QUADRATIC, BY_SPEED, BY_SQUARE, SHARE, STANDS = range(10, 18)
PER_STATION = 18
# Per compliance.
NEAR, FAR, NEAR_COORDINATE, FAR_COORDINATE, STIFFNESS, DAMPING = range(6)
LAW, STRIDE, STAGES, ERRORS, WAVES = range(6, 11)
PER_COMPLIANCE = 11
# A spring with stages has its law at p[LAW], else LAW is 0: per stage damping, slope, offset and GUARDS guards of four
# numbers (a, e, h, direction): the stage ends where a q + e q′ − h crosses zero in that direction (0: no such guard);
# at IMPACT two more, of damping that goes with the depth of contact, by the twist and at twist 0;
# then ERRORS and WAVES mesh harmonics of amplitude, cycles per turn of the input and phase: those of e, over the output
# radius, and of the stiffness.
GUARDS, PER_GUARD, PER_WAVE = 3, 4, 3
IMPACT = 3 + GUARDS * PER_GUARD
PER_STAGE = IMPACT + 2
# Per harmonic torque A cos(order · angle + frequency · t + phase): its station and these numbers, the phase and its
# cosine and sine.
AT, AMPLITUDE, ORDER, FREQUENCY, ANGLE, ANGLE_COSINE, ANGLE_SINE = range(7)
# Where A goes with the speed of the mean rotation, a complex number, it has PIECES (else 0) at p[CURVE]: each the speed
# that it begins at and is counted from, and powers from 0 to 3 of A's real and of its imaginary part. The first holds
# below where it begins too.
CURVE, PIECES = 7, 8
PER_HARMONIC, PER_PIECE = 9, 9
# Per slider of a clutch: its compliance, the stiffness of its spring, the deflection at which it slips, and the stride
# of its stages among the regimes. Its deflection is a state behind the rates; it follows the twist where it sticks.
OF, SPRING, REACH, STEP = range(4)
PER_SLIDER = 4
SLIPS_BACK, STICKS, SLIPS_ON = range(3)
# Per torque applied from outside: its station; WAY, its sign in the station's rotation; SENSE, in which the station's
# speed and angle count as positive; two variables, each one of NONE, TIME, SPEED and TURNED, with the value that it is
# counted from; then the powers u^i v^j, i, j < POWERS, of the two, and those of v in the denominator.
PLACE, WAY, SENSE, FIRST, FROM_FIRST, SECOND, FROM_SECOND, NUMERATOR = range(8)
NONE, TIME, SPEED, TURNED = range(4)
POWERS = 4
# Instead, with FIRST one of these: a formula, whose program stands at p[FROM_FIRST], or a function of time, speed and
# angle at the address FROM_FIRST.
FORMULA, FUNCTION = 4, 5
# Of a program: how many instructions it has, how many kinks, the side of each kink (±1, or 0: as it is), the
# instructions, each a code and a number, and room for the values in hand.
INSTRUCTIONS, KINKS, SIDES = range(3)
(CONSTANT, TIME_NOW, SPEED_NOW, ANGLE_NOW, PLUS, MINUS, TIMES, OVER_BY, POWER, NEGATIVE) = range(10)
(SIN, COS, TAN, ARCTAN, EXP, LOG, SQRT, TANH) = range(10, 18)
# These have a kink or jump, where what they switch by changes its sign: an argument, or the difference of two. Their
# number is 1 where they are as they are on whatever side, for a root or power is taken of them.
ABS, MIN, MAX, STEP_AT = range(18, 22)
DENOMINATOR = NUMERATOR + POWERS * POWERS
# CORNER, other than 0: it follows what all this says with a first-order lag of that corner frequency; its value is the
# state number LAGGED of those that lag.
CORNER = DENOMINATOR + POWERS
LAGGED = CORNER + 1
PER_APPLIED = LAGGED + 1
# Per torque converter: the stations of its pump and turbine, its compliance, in which SENSE both turn, and its POINTS;
# of each its speed ratio, and powers from 0 to 3 of capacity and torque ratio above it.
PUMP, TURBINE, SPRINGLESS, SENSE_OF_BOTH, POINTS = range(5)
PER_POINT = 9
# Links; joints by the form of their law. Of a cross SIZE is t, COSINE and SQUARE go with it; of a Fourier law COSINE is
# the number of its harmonics and SIZE their place among the numbers: order, amplitude and phase of each.
ROOT, SHAFT, CROSS, RATIO, FOURIER = range(5)
PER_RIPPLE = 3


@njit(cache=True, nogil=True)
def places(p):
    """Where compliances, harmonics and sliders begin among the numbers, and the room to work in."""
    compliance = HEAD + int(p[STATIONS]) * PER_STATION
    harmonic = compliance + int(p[COMPLIANCES]) * PER_COMPLIANCE
    slider = harmonic + int(p[HARMONICS]) * PER_HARMONIC
    return compliance, harmonic, slider, slider + int(p[SLIDERS]) * PER_SLIDER + int(p[LAWS])


@njit(cache=True, nogil=True)
def course(t, p):
    """Angle, speed and acceleration of the input."""
    since = t - p[SINCE]
    return p[THETA] + (p[OMEGA] + 0.5 * p[ALPHA] * since) * since, p[OMEGA] + p[ALPHA] * since, p[ALPHA]


@njit(cache=True, nogil=True)
def walk(theta, omega, d_rate, p, count, place, d, v, r, r1, r2):
    """Deviation d, speed v, and r, r₁, r₂ of every station, from the unknowns and their rates in d_rate."""
    n = int(p[UNKNOWNS])
    for s in range(count):
        q = place + s * PER_STATION
        link, i = int(p[q + LINK]), int(p[q + COORDINATE])
        if link == ROOT or link == SHAFT:
            r[s], r1[s], r2[s] = 1.0, 0.0, 0.0
            d[s] = d_rate[i] if i >= 0 else 0.0
            v[s] = p[q + MEAN] * omega + (d_rate[n + i] if i >= 0 else 0.0)
            continue
        b = int(p[q + BEFORE])
        if link == RATIO:
            over = p[q + OVER]
            d[s], v[s] = d[b] * over, v[b] * over
            r[s], r1[s], r2[s] = r[b] * over, r1[b] * over, r2[b] * over
            continue
        chi = p[q + MEAN] * theta + d[b] + p[q + PHASE]
        if link == CROSS:
            c, sn = math.cos(2 * chi), math.sin(2 * chi)
            t, cosine, square = p[q + SIZE], p[q + COSINE], p[q + SQUARE]
            lead = math.atan(t * sn / (1 - t * c))
            below = 1 / (1 - square * (1 + c) / 2)
            eta = cosine * below
            slope = -eta * square * sn * below
            curvature = -2 * eta * square * below * (c - square * sn * sn * below)
        else:
            lead, eta, slope, curvature = 0.0, 1.0, 0.0, 0.0
            for i in range(int(p[q + COSINE])):
                at = int(p[q + SIZE]) + i * PER_RIPPLE
                m, a = p[at], p[at + 1]
                c, sn = a * math.cos(m * chi + p[at + 2]), a * math.sin(m * chi + p[at + 2])
                lead, eta, slope, curvature = lead + sn, eta + m * c, slope - m * m * sn, curvature - m * m * m * c
        d[s], v[s] = d[b] + lead, eta * v[b]
        r[s] = eta * r[b]
        r1[s] = eta * r1[b] + slope * r[b] * r[b]
        r2[s] = eta * r2[b] + 3 * slope * r[b] * r1[b] + curvature * r[b] * r[b] * r[b]


@njit(cache=True, nogil=True)
def mean_rotation(theta, omega, p, count, d, v):
    """Angle and speed of the mean rotation: those of the input where it is prescribed, else those with which the whole
    line turns as a rigid body, Σ Jρφ/Σ Jρ²."""
    for s in range(count):
        q = HEAD + s * PER_STATION
        if p[q + SHARE] != 0.0:
            theta += p[q + SHARE] * d[s]
    turning = omega
    for s in range(count):
        q = HEAD + s * PER_STATION
        if p[q + SHARE] != 0.0:
            turning += p[q + SHARE] * (v[s] - p[q + MEAN] * omega)
    return theta, turning


@njit(cache=True, nogil=True)
def swing(p, at, count, theta):
    """A sum of mesh harmonics at p[at:], its slope and its bend by the mean rotation."""
    value, slope, bend = 0.0, 0.0, 0.0
    for i in range(count):
        size, cycles, phase = p[at + 3 * i], p[at + 3 * i + 1], p[at + 3 * i + 2]
        c, s = size * math.cos(cycles * theta + phase), size * math.sin(cycles * theta + phase)
        value += c
        slope -= s * cycles
        bend -= c * cycles * cycles
    return value, slope, bend


@njit(cache=True, nogil=True)
def mesh_error(p, q, theta):
    """Transmission error of the compliance at p[q:] as an angle, its slope and its bend by the mean rotation."""
    return swing(p, int(p[q + LAW]) + int(p[q + STAGES]) * PER_STAGE, int(p[q + ERRORS]), theta)


@njit(cache=True, nogil=True)
def mesh_wave(p, q, theta):
    """Stiffness of the compliance at p[q:] over its mean less 1, its slope and its bend by the mean rotation."""
    at = int(p[q + LAW]) + int(p[q + STAGES]) * PER_STAGE + int(p[q + ERRORS]) * PER_WAVE
    return swing(p, at, int(p[q + WAVES]), theta)


@njit(cache=True, nogil=True)
def amplitude(p, q, speed):
    """Real and imaginary part of the amplitude of the harmonic at p[q:] at a mean ``speed``."""
    first, low, high = int(p[q + CURVE]), 0, int(p[q + PIECES])
    while high - low > 1:
        middle = (low + high) // 2
        if p[first + middle * PER_PIECE] <= speed:
            low = middle
        else:
            high = middle
    at = first + low * PER_PIECE
    x = speed - p[at]
    real = p[at + 1] + x * (p[at + 2] + x * (p[at + 3] + x * p[at + 4]))
    return real, p[at + 5] + x * (p[at + 6] + x * (p[at + 7] + x * p[at + 8]))


@njit(cache=True, nogil=True)
def variable(which, t, angle, speed):
    """The value of one variable of an applied torque."""
    if which == TIME:
        return t
    if which == SPEED:
        return speed
    return angle if which == TURNED else 0.0


@intrinsic
def _called(typing, address, t, speed, angle):
    """The function at an address: double(double, double, double)."""

    def code(context, builder, signature, args):
        function = ir.FunctionType(ir.DoubleType(), [ir.DoubleType()] * 3)
        return builder.call(builder.inttoptr(args[0], function.as_pointer()), list(args[1:]))

    return types.float64(types.int64, types.float64, types.float64, types.float64), code


@njit(cache=True, nogil=True)
def formula(p, at, t, speed, angle, kink):
    """The value of the program at p[at:], and what its ``kink`` switches by (0.0 of none)."""
    count, kinks = int(p[at + INSTRUCTIONS]), int(p[at + KINKS])
    begin = at + SIDES + kinks
    top, met, switch = begin + 2 * count - 1, 0, 0.0
    for i in range(count):
        code, number = int(p[begin + 2 * i]), p[begin + 2 * i + 1]
        if code == CONSTANT:
            top += 1
            p[top] = number
        elif code == TIME_NOW:
            top += 1
            p[top] = t
        elif code == SPEED_NOW:
            top += 1
            p[top] = speed
        elif code == ANGLE_NOW:
            top += 1
            p[top] = angle
        elif code <= POWER:
            top -= 1
            a, b = p[top], p[top + 1]
            if code == PLUS:
                p[top] = a + b
            elif code == MINUS:
                p[top] = a - b
            elif code == TIMES:
                p[top] = a * b
            elif code == OVER_BY:
                p[top] = a / b if b != 0.0 else math.nan
            else:
                p[top] = a**b if a >= 0.0 or b == math.floor(b) else math.nan
        elif code == NEGATIVE:
            p[top] = -p[top]
        elif code == SIN:
            p[top] = math.sin(p[top])
        elif code == COS:
            p[top] = math.cos(p[top])
        elif code == TAN:
            p[top] = math.tan(p[top])
        elif code == ARCTAN:
            p[top] = math.atan(p[top])
        elif code == EXP:
            p[top] = math.exp(p[top]) if p[top] < 700.0 else math.inf
        elif code == LOG:
            p[top] = math.log(p[top]) if p[top] > 0.0 else math.nan
        elif code == SQRT:
            p[top] = math.sqrt(p[top]) if p[top] >= 0.0 else math.nan
        elif code == TANH:
            p[top] = math.tanh(p[top])
        else:
            if code == MIN or code == MAX:
                top -= 1
                by = p[top] - p[top + 1]
            else:
                by = p[top]
            if met == kink:
                switch = by
            side = p[at + SIDES + met] if number == 0.0 else 0.0
            above = side > 0.0 or (side == 0.0 and by >= 0.0)
            if code == ABS:
                p[top] = p[top] if above else -p[top]
            elif code == STEP_AT:
                p[top] = 1.0 if above else 0.0
            elif (code == MAX) != above:
                p[top] = p[top + 1]
            met += 1
    return p[top], switch


@njit(cache=True, nogil=True)
def formulas(p, at, t, speed, angle, out):
    """The values of a program along a motion (m,)."""
    for i in range(t.size):
        out[i] = formula(p, at, t[i], speed[i], angle[i], -1)[0]


@njit(cache=True, nogil=True)
def applied(p, q, t, angle, speed):
    """The applied torque at p[q:] without its WAY, and its slopes by angle and speed of its station, both counted in
    its SENSE; of a formula or a function no slopes are known."""
    first, second = int(p[q + FIRST]), int(p[q + SECOND])
    if first == FORMULA:
        return formula(p, int(p[q + FROM_FIRST]), t, speed, angle, -1)[0], 0.0, 0.0
    if first == FUNCTION:
        return _called(int(p[q + FROM_FIRST]), t, speed, angle), 0.0, 0.0
    u = variable(first, t, angle, speed) - p[q + FROM_FIRST]
    v = variable(second, t, angle, speed) - p[q + FROM_SECOND]
    above, by_u, by_v = 0.0, 0.0, 0.0
    for i in range(POWERS - 1, -1, -1):
        row, slope = 0.0, 0.0
        for j in range(POWERS - 1, -1, -1):
            slope = slope * v + row
            row = row * v + p[q + NUMERATOR + i * POWERS + j]
        by_u = by_u * u + above
        above = above * u + row
        by_v = by_v * u + slope
    below, slope = 0.0, 0.0
    for j in range(POWERS - 1, -1, -1):
        slope = slope * v + below
        below = below * v + p[q + DENOMINATOR + j]
    torque = above / below
    by_u, by_v = by_u / below, (by_v - torque * slope) / below
    by_angle = (by_u if first == TURNED else 0.0) + (by_v if second == TURNED else 0.0)
    by_speed = (by_u if first == SPEED else 0.0) + (by_v if second == SPEED else 0.0)
    return torque, by_angle, by_speed


@njit(cache=True, nogil=True)
def converted(p, q, pump, turbine):
    """Torques that the converter at p[q:] takes at its pump and gives at its turbine, at the speeds of both, and their
    slopes by the two. Below its first point it is as there, beyond its last not a number."""
    count, first = int(p[q + POINTS]), q + POINTS + 1
    if pump == 0.0 and turbine <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if not pump > 0.0:
        return math.nan, math.nan, math.nan, math.nan, math.nan, math.nan
    ratio, held = turbine / pump, False
    if ratio < p[first]:
        ratio, held = p[first], True
    if ratio > p[first + (count - 1) * PER_POINT]:
        return math.nan, math.nan, math.nan, math.nan, math.nan, math.nan
    at = first
    for i in range(count - 1):
        if ratio >= p[first + i * PER_POINT]:
            at = first + i * PER_POINT
    x = ratio - p[at]
    k = p[at + 1] + x * (p[at + 2] + x * (p[at + 3] + x * p[at + 4]))
    m = p[at + 5] + x * (p[at + 6] + x * (p[at + 7] + x * p[at + 8]))
    k1 = 0.0 if held else p[at + 2] + x * (2 * p[at + 3] + x * 3 * p[at + 4])
    m1 = 0.0 if held else p[at + 6] + x * (2 * p[at + 7] + x * 3 * p[at + 8])
    h, h1 = m * k, m1 * k + m * k1
    square = pump * pump
    return (
        k * square, h * square, (2 * k - ratio * k1) * pump, k1 * pump, (2 * h - ratio * h1) * pump, h1 * pump
    )  # fmt: skip


@njit(cache=True, nogil=True)
def next_converter(p, q):
    """Where the numbers of the converter behind the one at p[q:] begin."""
    return q + POINTS + 1 + int(p[q + POINTS]) * PER_POINT


@njit(cache=True, nogil=True)
def stage_at(p, q, twist, rate):
    """The stage whose guards are all on the side where it lasts, or nearest to it."""
    best, depth = 0, -math.inf
    for stage in range(int(p[q + STAGES])):
        least = math.inf
        for j in range(GUARDS):
            g = int(p[q + LAW]) + stage * PER_STAGE + 3 + PER_GUARD * j
            if p[g + 3] != 0.0:
                least = min(least, -p[g + 3] * (p[g] * twist + p[g + 1] * rate - p[g + 2]))
        if least > depth:
            best, depth = stage, least
    return best


@cfunc(_RATE, cache=True)
def line(t, y_, p_, k, regime, out_):
    """Rates of the unknowns and of k tangent vectors."""
    head = carray(p_, (HEAD,))
    n, count, joined, sliding = int(head[UNKNOWNS]), int(head[STATIONS]), int(head[COMPLIANCES]), int(head[SLIDERS])
    compliance, harmonic, slider, scratch = places(head)
    p = carray(p_, (scratch + 5 * count + 7 * n + 5 * joined,))
    wide = 2 * n + sliding + int(head[LAGS])
    y, out = carray(y_, ((1 + k) * wide,)), carray(out_, ((1 + k) * wide,))
    theta, omega, alpha = course(t, p)
    space = p[scratch:]
    d, v = space[:count], space[count : 2 * count]
    r, r1, r2 = space[2 * count : 3 * count], space[3 * count : 4 * count], space[4 * count : 5 * count]
    rest = space[5 * count :]
    inertia, half_slope, half_bend = rest[:n], rest[n : 2 * n], rest[2 * n : 3 * n]
    torque, by_angle, by_rate = rest[3 * n : 4 * n], rest[4 * n : 5 * n], rest[5 * n : 6 * n]
    acceleration, shaft = rest[6 * n : 7 * n], rest[7 * n : 7 * n + joined]
    stiff, damp = rest[7 * n + joined : 7 * n + 2 * joined], rest[7 * n + 2 * joined : 7 * n + 3 * joined]
    by_turn, by_turning = rest[7 * n + 3 * joined : 7 * n + 4 * joined], rest[7 * n + 4 * joined :]
    rest[: 6 * n] = 0.0
    walk(theta, omega, y, p, count, HEAD, d, v, r, r1, r2)
    turned, turning = mean_rotation(theta, omega, p, count, d, v)
    for s in range(count):
        q = HEAD + s * PER_STATION
        i = int(p[q + COORDINATE])
        if i < 0:
            continue
        mass = p[q + INERTIA]
        if mass != 0.0:
            inertia[i] += mass * r[s] * r[s]
            half_slope[i] += mass * r[s] * r1[s]
            half_bend[i] += mass * (r1[s] * r1[s] + r[s] * r2[s])
        load = p[q + LOAD] + (p[q + BY_SPEED] + p[q + BY_SQUARE] * omega) * omega
        viscous, quadratic = p[q + VISCOUS], p[q + QUADRATIC]
        if load != 0.0 or viscous != 0.0 or quadratic != 0.0:
            load += (viscous + quadratic * abs(v[s])) * v[s]
            growth = viscous + 2 * quadratic * abs(v[s])
            reference = int(p[q + REFERENCE])
            torque[i] -= r[s] * load
            by_angle[i] -= r1[s] * load + r[s] * growth * r1[s] * v[reference]
            by_rate[i] -= r[s] * growth * r[s]
    # Of a torque of even orders the next harmonic is turned on from the last: an engine's take one sine, not dozens.
    at, last, step, c, sn, c_step, s_step = -1, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0
    for h in range(int(p[HARMONICS])):
        q = harmonic + h * PER_HARMONIC
        s = int(p[q + AT])
        i = int(p[HEAD + s * PER_STATION + COORDINATE])
        if i < 0:
            continue
        order, angle = p[q + ORDER], p[HEAD + s * PER_STATION + MEAN] * theta + d[s]
        if s != at or p[q + FREQUENCY] != 0.0:
            argument = p[q + FREQUENCY] * t + order * angle
            c, sn, step = math.cos(argument), math.sin(argument), 0.0
        elif order != last:
            if order - last != step:
                step = order - last
                c_step, s_step = math.cos(step * angle), math.sin(step * angle)
            c, sn = c * c_step - sn * s_step, sn * c_step + c * s_step
        at, last = s if p[q + FREQUENCY] == 0.0 else -1, order
        turned_c = c * p[q + ANGLE_COSINE] - sn * p[q + ANGLE_SINE]
        turned_s = sn * p[q + ANGLE_COSINE] + c * p[q + ANGLE_SINE]
        if p[q + PIECES] == 0.0:
            push, slope = p[q + AMPLITUDE] * turned_c, -p[q + AMPLITUDE] * turned_s
        else:
            if k:
                return 1  # tangents would want its slope by the speed
            real, other = amplitude(p, q, turning)
            push, slope = real * turned_c - other * turned_s, -real * turned_s - other * turned_c
        torque[i] += r[s] * push
        by_angle[i] += r1[s] * push + r[s] * r[s] * order * slope
    for h in range(int(p[APPLIED])):
        q = int(p[APPLIED_AT]) + h * PER_APPLIED
        s = int(p[q + PLACE])
        i = int(p[HEAD + s * PER_STATION + COORDINATE])
        if i < 0:
            continue
        sense, reference = p[q + SENSE], int(p[HEAD + s * PER_STATION + REFERENCE])
        angle = sense * (p[HEAD + s * PER_STATION + MEAN] * theta + d[s])
        push, turned_by, sped_by = applied(p, q, t, angle, sense * v[s])
        if k and int(p[q + FIRST]) >= FORMULA:
            return 1  # tangents would want slopes
        if p[q + CORNER] != 0.0:
            if k:
                return 1  # tangents of what lags are not written
            at = 2 * n + sliding + int(p[q + LAGGED])
            out[at] = p[q + CORNER] * (push - y[at])
            push, turned_by, sped_by = y[at], 0.0, 0.0
        way = p[q + WAY]
        push, turned_by, sped_by = way * push, way * sense * turned_by, way * sense * sped_by
        torque[i] += r[s] * push
        by_angle[i] += r1[s] * push + r[s] * (turned_by * r[s] + sped_by * r1[s] * v[reference])
        by_rate[i] += r[s] * sped_by * r[s]
    q = int(p[CONVERTERS_AT])
    for _ in range(int(p[CONVERTERS])):
        one, other, sense = int(p[q + PUMP]), int(p[q + TURBINE]), p[q + SENSE_OF_BOTH]
        takes, gives, by_one, _, _, by_other = converted(p, q, sense * v[one], sense * v[other])
        for s, push, slope in ((one, -takes, -by_one), (other, gives, by_other)):
            i = int(p[HEAD + s * PER_STATION + COORDINATE])
            if i >= 0:
                reference = int(p[HEAD + s * PER_STATION + REFERENCE])
                torque[i] += r[s] * sense * push
                by_angle[i] += r1[s] * sense * push + r[s] * slope * r1[s] * v[reference]
                by_rate[i] += r[s] * slope * r[s]
        q = next_converter(p, q)
    for e in range(joined):
        q = compliance + e * PER_COMPLIANCE
        near, far = int(p[q + NEAR]), int(p[q + FAR])
        stiff[e], damp[e], by_turn[e], by_turning[e] = p[q + STIFFNESS], p[q + DAMPING], 0.0, 0.0
        if p[q + LAW] == 0.0:
            shaft[e] = stiff[e] * (d[far] - d[near]) + damp[e] * (v[far] - v[near])
        else:
            stage = int(p[q + LAW]) + (regime // int(p[q + STRIDE])) % int(p[q + STAGES]) * PER_STAGE
            error, slope, bend = mesh_error(p, q, turned)
            wave, swell, _ = mesh_wave(p, q, turned)
            wave += 1.0
            twist, rate = d[far] - d[near] + error, v[far] - v[near] + slope * turning
            damp[e] = p[stage] + p[stage + IMPACT] * twist + p[stage + IMPACT + 1]
            shaft[e] = wave * (p[stage + 1] * twist + p[stage + 2]) + damp[e] * rate
            stiff[e] = wave * p[stage + 1] + p[stage + IMPACT] * rate
            by_turn[e] = stiff[e] * slope + damp[e] * bend * turning + swell * (p[stage + 1] * twist + p[stage + 2])
            by_turning[e] = damp[e] * slope
        for s in range(sliding):
            at = slider + s * PER_SLIDER
            if int(p[at + OF]) == e:
                shaft[e] += p[at + SPRING] * y[2 * n + s]
                sticks = regime // int(p[at + STEP]) % 3 == STICKS
                out[2 * n + s] = v[far] - v[near] if sticks else 0.0
        i, j = int(p[q + NEAR_COORDINATE]), int(p[q + FAR_COORDINATE])
        if j >= 0:
            torque[j] -= shaft[e]
        if i >= 0:
            torque[i] += r[near] * shaft[e]
    q = int(p[CONVERTERS_AT])
    for _ in range(int(p[CONVERTERS])):
        sense = p[q + SENSE_OF_BOTH]
        gives = converted(p, q, sense * v[int(p[q + PUMP])], sense * v[int(p[q + TURBINE])])[1]
        shaft[int(p[q + SPRINGLESS])] = -sense * gives
        q = next_converter(p, q)
    for s in range(count):
        q = HEAD + s * PER_STATION
        i = int(p[q + COORDINATE])
        if i >= 0 and int(p[q + REFERENCE]) == s:
            speed = v[s]
            if p[q + STANDS] != 0.0:
                inertia[i] = math.inf
            acceleration[i] = (torque[i] - half_slope[i] * speed * speed) / inertia[i]
            out[i] = y[n + i]
            out[n + i] = acceleration[i] - p[q + MEAN] * alpha
            by_angle[i] -= half_bend[i] * speed * speed + 2 * acceleration[i] * half_slope[i]
            by_rate[i] -= 2 * half_slope[i] * speed
    for block in range(1, k + 1):
        w, o = y[block * wide : (block + 1) * wide], out[block * wide : (block + 1) * wide]
        for i in range(n):
            o[i] = w[n + i]
            o[n + i] = by_angle[i] * w[i] + by_rate[i] * w[n + i]
        more, faster = 0.0, 0.0
        for s in range(count):
            q = HEAD + s * PER_STATION
            if p[q + SHARE] != 0.0:
                more += p[q + SHARE] * w[int(p[q + COORDINATE])]
                faster += p[q + SHARE] * w[n + int(p[q + COORDINATE])]
        for e in range(joined):
            q = compliance + e * PER_COMPLIANCE
            near = int(p[q + NEAR])
            i, j = int(p[q + NEAR_COORDINATE]), int(p[q + FAR_COORDINATE])
            twist, rate = 0.0, 0.0
            if j >= 0:
                twist, rate = w[j], w[n + j]
            if i >= 0:
                reference = int(p[HEAD + near * PER_STATION + REFERENCE])
                twist -= r[near] * w[i]
                rate -= r1[near] * v[reference] * w[i] + r[near] * w[n + i]
            change = stiff[e] * twist + damp[e] * rate + by_turn[e] * more + by_turning[e] * faster
            for s in range(sliding):
                at = slider + s * PER_SLIDER
                if int(p[at + OF]) == e:
                    change += p[at + SPRING] * w[2 * n + s]
                    o[2 * n + s] = rate if regime // int(p[at + STEP]) % 3 == STICKS else 0.0
            if j >= 0:
                o[n + j] -= change
            if i >= 0:
                o[n + i] += r1[near] * shaft[e] * w[i] + r[near] * change
        q = int(p[CONVERTERS_AT])
        for _ in range(int(p[CONVERTERS])):
            one, other, sense = int(p[q + PUMP]), int(p[q + TURBINE]), p[q + SENSE_OF_BOTH]
            _, _, _, by_other, by_one, _ = converted(p, q, sense * v[one], sense * v[other])
            for on, by, slope in ((one, other, -by_other), (other, one, by_one)):
                i, j = int(p[HEAD + on * PER_STATION + COORDINATE]), int(p[HEAD + by * PER_STATION + COORDINATE])
                if i >= 0 and j >= 0:
                    turns = r1[by] * v[int(p[HEAD + by * PER_STATION + REFERENCE])] * w[j] + r[by] * w[n + j]
                    o[n + i] += r[on] * slope * turns
            q = next_converter(p, q)
        for i in range(n):
            o[n + i] /= inertia[i]
    return 0


@njit(cache=True, nogil=True)
def locate(t, x, p):
    """The regime of a state: the stages of all springs in one number."""
    count, joined = int(p[STATIONS]), int(p[COMPLIANCES])
    twist, torque, stages = np.empty((1, joined)), np.empty((1, joined)), np.zeros((1, joined), dtype=np.int64)
    rotation, speed = np.empty((1, count)), np.empty((1, count))
    observe(np.array([t]), x.reshape(1, -1), p, twist, torque, rotation, speed, stages)
    compliance, _, slider, _ = places(p)
    regime = 0
    for e in range(joined):
        if p[compliance + e * PER_COMPLIANCE + STAGES] > 0.0:
            regime += stages[0, e] * int(p[compliance + e * PER_COMPLIANCE + STRIDE])
    for s in range(int(p[SLIDERS])):
        at = slider + s * PER_SLIDER
        q, deflection = compliance + int(p[at + OF]) * PER_COMPLIANCE, x[2 * int(p[UNKNOWNS]) + s]
        rate, stage = speed[0, int(p[q + FAR])] - speed[0, int(p[q + NEAR])], STICKS
        if deflection >= p[at + REACH] and rate > 0.0:
            stage = SLIPS_ON
        elif deflection <= -p[at + REACH] and rate < 0.0:
            stage = SLIPS_BACK
        regime += stage * int(p[at + STEP])
    return regime


@njit(cache=True, nogil=True)
def observe(times, states, p, twist, torque, rotation, speed, stages):
    """Twist and torque (m, compliances), deviation and speed of every station (m, stations) along a motion.

    ``stages`` (m, compliances), zeros: becomes the stage of every spring, as its twist and rate tell.
    """
    count = int(p[STATIONS])
    compliance, _, slider, _ = places(p)
    r, r1, r2 = np.empty(count), np.empty(count), np.empty(count)
    for m in range(times.size):
        theta, omega, _ = course(times[m], p)
        walk(theta, omega, states[m], p, count, HEAD, rotation[m], speed[m], r, r1, r2)
        turned, turning = mean_rotation(theta, omega, p, count, rotation[m], speed[m])
        for e in range(int(p[COMPLIANCES])):
            q = compliance + e * PER_COMPLIANCE
            near, far = int(p[q + NEAR]), int(p[q + FAR])
            twist[m, e] = rotation[m, far] - rotation[m, near]
            rate = speed[m, far] - speed[m, near]
            if p[q + LAW] == 0.0:
                torque[m, e] = p[q + STIFFNESS] * twist[m, e] + p[q + DAMPING] * rate
                continue
            error, slope, _ = mesh_error(p, q, turned)
            twist[m, e] += error
            rate += slope * turning
            stages[m, e] = stage_at(p, q, twist[m, e], rate)
            at = int(p[q + LAW]) + stages[m, e] * PER_STAGE
            damping = p[at] + p[at + IMPACT] * twist[m, e] + p[at + IMPACT + 1]
            wave = 1.0 + mesh_wave(p, q, turned)[0]
            torque[m, e] = wave * (p[at + 1] * twist[m, e] + p[at + 2]) + damping * rate
        for s in range(int(p[SLIDERS])):
            at = slider + s * PER_SLIDER
            torque[m, int(p[at + OF])] += p[at + SPRING] * states[m, 2 * int(p[UNKNOWNS]) + s]
        q = int(p[CONVERTERS_AT])
        for _ in range(int(p[CONVERTERS])):
            sense = p[q + SENSE_OF_BOTH]
            pump, turbine = sense * speed[m, int(p[q + PUMP])], sense * speed[m, int(p[q + TURBINE])]
            torque[m, int(p[q + SPRINGLESS])] = -sense * converted(p, q, pump, turbine)[1]
            q = next_converter(p, q)

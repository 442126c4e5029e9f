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
from numba import carray, cfunc, njit, types

_POINTER = types.CPointer(types.float64)
_RATE = types.int64(types.float64, _POINTER, _POINTER, types.int64, types.int64, _POINTER)

# The head of the numbers.
UNKNOWNS, STATIONS, COMPLIANCES, HARMONICS, PRESCRIBED, THETA, OMEGA, ALPHA, SINCE = range(9)
HEAD = 9
# Per station.
BEFORE, LINK, COORDINATE, REFERENCE, MEAN, PHASE, SIZE, COSINE, SQUARE, OVER = range(10)
INERTIA, LOAD, VISCOUS, QUADRATIC = range(10, 14)
PER_STATION = 14
# Per compliance.
NEAR, FAR, NEAR_COORDINATE, FAR_COORDINATE, STIFFNESS, DAMPING = range(6)
PER_COMPLIANCE = 6
# Per harmonic torque; order 0 means in time.
AT, AMPLITUDE, ORDER, FREQUENCY, ANGLE = range(5)
PER_HARMONIC = 5
# Links, as in ``topology.Link``.
ROOT, SHAFT, HOOKE, RATIO, TRIPOD = range(5)


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
        if link == HOOKE:
            c, sn = math.cos(2 * chi), math.sin(2 * chi)
            t, cosine, square = p[q + SIZE], p[q + COSINE], p[q + SQUARE]
            lead = math.atan(t * sn / (1 - t * c))
            below = 1 / (1 - square * (1 + c) / 2)
            eta = cosine * below
            slope = -eta * square * sn * below
            curvature = -2 * eta * square * below * (c - square * sn * sn * below)
        else:
            a = p[q + SIZE]
            c, sn = math.cos(3 * chi), math.sin(3 * chi)
            lead, eta, slope, curvature = a * sn, 1 + 3 * a * c, -9 * a * sn, -27 * a * c
        d[s], v[s] = d[b] + lead, eta * v[b]
        r[s] = eta * r[b]
        r1[s] = eta * r1[b] + slope * r[b] * r[b]
        r2[s] = eta * r2[b] + 3 * slope * r[b] * r1[b] + curvature * r[b] * r[b] * r[b]


@cfunc(_RATE, cache=True)
def line(t, y_, p_, k, regime, out_):
    """Rates of the unknowns and of k tangent vectors."""
    head = carray(p_, (HEAD,))
    n, count, joined, shaken = int(head[0]), int(head[1]), int(head[2]), int(head[3])
    compliance = HEAD + count * PER_STATION
    harmonic = compliance + joined * PER_COMPLIANCE
    scratch = harmonic + shaken * PER_HARMONIC
    p = carray(p_, (scratch + 5 * count + 7 * n + joined,))
    wide = 2 * n
    y, out = carray(y_, ((1 + k) * wide,)), carray(out_, ((1 + k) * wide,))
    since = t - p[SINCE]
    omega, alpha = p[OMEGA] + p[ALPHA] * since, p[ALPHA]
    theta = p[THETA] + (p[OMEGA] + 0.5 * p[ALPHA] * since) * since
    space = p[scratch:]
    d, v = space[:count], space[count : 2 * count]
    r, r1, r2 = space[2 * count : 3 * count], space[3 * count : 4 * count], space[4 * count : 5 * count]
    rest = space[5 * count :]
    inertia, half_slope, half_bend = rest[:n], rest[n : 2 * n], rest[2 * n : 3 * n]
    torque, by_angle, by_rate = rest[3 * n : 4 * n], rest[4 * n : 5 * n], rest[5 * n : 6 * n]
    acceleration, shaft = rest[6 * n : 7 * n], rest[7 * n :]
    rest[: 6 * n] = 0.0
    walk(theta, omega, y, p, count, HEAD, d, v, r, r1, r2)
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
        load, viscous, quadratic = p[q + LOAD], p[q + VISCOUS], p[q + QUADRATIC]
        if load != 0.0 or viscous != 0.0 or quadratic != 0.0:
            load += (viscous + quadratic * abs(v[s])) * v[s]
            growth = viscous + 2 * quadratic * abs(v[s])
            reference = int(p[q + REFERENCE])
            torque[i] -= r[s] * load
            by_angle[i] -= r1[s] * load + r[s] * growth * r1[s] * v[reference]
            by_rate[i] -= r[s] * growth * r[s]
    for h in range(shaken):
        q = harmonic + h * PER_HARMONIC
        s = int(p[q + AT])
        i = int(p[HEAD + s * PER_STATION + COORDINATE])
        if i < 0:
            continue
        order = p[q + ORDER]
        argument = p[q + ANGLE] + p[q + FREQUENCY] * t
        if order != 0.0:
            argument = p[q + ANGLE] + order * (p[HEAD + s * PER_STATION + MEAN] * theta + d[s])
        push = p[q + AMPLITUDE] * math.cos(argument)
        torque[i] += r[s] * push
        by_angle[i] += r1[s] * push - r[s] * r[s] * order * p[q + AMPLITUDE] * math.sin(argument)
    for e in range(joined):
        q = compliance + e * PER_COMPLIANCE
        near, far = int(p[q + NEAR]), int(p[q + FAR])
        shaft[e] = p[q + STIFFNESS] * (d[far] - d[near]) + p[q + DAMPING] * (v[far] - v[near])
        i, j = int(p[q + NEAR_COORDINATE]), int(p[q + FAR_COORDINATE])
        if j >= 0:
            torque[j] -= shaft[e]
        if i >= 0:
            torque[i] += r[near] * shaft[e]
    for s in range(count):
        q = HEAD + s * PER_STATION
        i = int(p[q + COORDINATE])
        if i >= 0 and int(p[q + REFERENCE]) == s:
            speed = v[s]
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
            change = p[q + STIFFNESS] * twist + p[q + DAMPING] * rate
            if j >= 0:
                o[n + j] -= change
            if i >= 0:
                o[n + i] += r1[near] * shaft[e] * w[i] + r[near] * change
        for i in range(n):
            o[n + i] /= inertia[i]
    return 0


@njit(cache=True, nogil=True)
def observe(times, states, p, twist, torque, rotation):
    """Twist and torque (m, compliances) and deviation of every station (m, stations) along a motion."""
    count, joined = int(p[STATIONS]), int(p[COMPLIANCES])
    compliance = HEAD + count * PER_STATION
    v, r, r1, r2 = np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    for m in range(times.size):
        since = times[m] - p[SINCE]
        omega = p[OMEGA] + p[ALPHA] * since
        theta = p[THETA] + (p[OMEGA] + 0.5 * p[ALPHA] * since) * since
        walk(theta, omega, states[m], p, count, HEAD, rotation[m], v, r, r1, r2)
        for e in range(joined):
            q = compliance + e * PER_COMPLIANCE
            near, far = int(p[q + NEAR]), int(p[q + FAR])
            twist[m, e] = rotation[m, far] - rotation[m, near]
            torque[m, e] = p[q + STIFFNESS] * twist[m, e] + p[q + DAMPING] * (v[far] - v[near])


@njit(cache=True, nogil=True)
def energy(times, states, p, kinetic, potential):
    """Kinetic and elastic energy (m,) along a motion."""
    count, joined = int(p[STATIONS]), int(p[COMPLIANCES])
    compliance = HEAD + count * PER_STATION
    d, v = np.empty(count), np.empty(count)
    r, r1, r2 = np.empty(count), np.empty(count), np.empty(count)
    for m in range(times.size):
        since = times[m] - p[SINCE]
        omega = p[OMEGA] + p[ALPHA] * since
        theta = p[THETA] + (p[OMEGA] + 0.5 * p[ALPHA] * since) * since
        walk(theta, omega, states[m], p, count, HEAD, d, v, r, r1, r2)
        kinetic[m], potential[m] = 0.0, 0.0
        for s in range(count):
            kinetic[m] += 0.5 * p[HEAD + s * PER_STATION + INERTIA] * v[s] * v[s]
        for e in range(joined):
            q = compliance + e * PER_COMPLIANCE
            twist = d[int(p[q + FAR])] - d[int(p[q + NEAR])]
            potential[m] += 0.5 * p[q + STIFFNESS] * twist * twist

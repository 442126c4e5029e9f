"""Motion of one mass under a force that is linear piece by piece, each piece by its closed form.

In regime r:  x″ + c_r x′ + s_r x + d_r = F₀ + Σ_k Re[(p_k − i q_k) e^{i k ω t}],  c_r, s_r ≥ 0. A regime is left where
one of its guards g = a x + e x′ − h falls through zero.

The next crossing is never overlooked: with z = (x − x_forced)′ the energy z′² + s z² cannot grow, which bounds
|g″| ≤ G from here on, so no zero lies before the positive root of g + g′τ − Gτ²/2. Steps of that length
approach the crossing from one side, quadratically. Everything is evaluated from the start of the regime, so
rounding does not add up over its steps.

This file imports nothing of the package: a cached copy of it is compiled.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
import math

import numpy as np
from numba import njit

RECORDED = 4
"""Columns of the record: time, x, x′, regime begun (or EXTREMUM)."""
EXTREMUM = -1
DONE, TOO_MANY_EVENTS, TOO_MANY_STEPS = 0, 1, 2
LEAST_DETUNING = 2e-8
"""An undamped piece driven closer to its own frequency than this share is taken this far from it."""
MEASURING_PHASE = 0.05
"""Largest phase of a step while means are taken [rad]."""


@njit(cache=True, error_model="numpy")
def homogeneous(c, s, t):
    """Transition matrix of y″ + cy′ + sy = 0 over time t ≥ 0, and the response y to a unit step of force."""
    half, split = 0.5 * c, 0.25 * c * c - s
    if split > 0:
        root = math.sqrt(split)
        slow = math.exp((-s / (half + root)) * t)
        fast = math.exp(-(half + root) * t)
        even = 0.5 * (slow + fast)
        odd = 0.5 * (slow - fast) / root if root * t > 1e-4 else math.exp(-half * t) * t * (1 + split * t * t / 6)
    else:
        root = math.sqrt(-split)
        decay = math.exp(-half * t)
        even = decay * math.cos(root * t)
        odd = decay * (math.sin(root * t) / root if root * t > 1e-4 else t * (1 + split * t * t / 6))
    first = even + half * odd
    if c * t < 0.5 and s * t * t < 0.5:
        # 1 − first would cancel; the power series does not.
        term_0, term_1, step, n = 0.0, 0.5 * t * t, 0.5 * t * t, 1
        while abs(term_1) + abs(term_0) > 1e-18 * step and n < 40:
            term = -(c * t * (n + 1) * term_1 + s * t * t * term_0) / ((n + 1) * (n + 2))
            step += term
            term_0, term_1, n = term_1, term, n + 1
    elif s > 0:
        step = (1 - first) / s
    else:
        step = (t + math.expm1(-c * t) / c) / c
    return first, odd, -s * odd, even - half * odd, step


@njit(cache=True, error_model="numpy")
def amplitudes(c, s, omega, force, response, slope):
    """Complex response to each harmonic of the force, and its derivative by ω."""
    for k in range(1, len(force)):
        if force[k] == 0:
            response[k], slope[k] = 0.0, 0.0
            continue
        w = k * omega
        real = s - w * w
        if abs(real) + abs(w * c) < LEAST_DETUNING * w * w:
            real = LEAST_DETUNING * w * w
        over = complex(real, w * c)
        response[k] = force[k] / over
        slope[k] = -response[k] * complex(-2 * k * w, k * c) / over


@njit(cache=True, error_model="numpy")
def forced(t, omega, response):
    """The forced part x, x′, x″ at time t."""
    x, v, a = 0.0, 0.0, 0.0
    for k in range(1, len(response)):
        if response[k] != 0:
            w = k * omega
            turned = response[k] * complex(math.cos(w * t), math.sin(w * t))
            x += turned.real
            v -= w * turned.imag
            a -= w * w * turned.real
    return x, v, a


@njit(cache=True, error_model="numpy")
def forced_by_frequency(t, omega, response, slope):
    """Derivative by ω, at fixed time, of the forced x and x′."""
    x, v = 0.0, 0.0
    for k in range(1, len(response)):
        if response[k] != 0:
            w = k * omega
            turn = complex(math.cos(w * t), math.sin(w * t))
            change = slope[k] + 1j * k * t * response[k]
            x += (change * turn).real
            v += (1j * (k * response[k] + w * change) * turn).real
    return x, v


@njit(cache=True, error_model="numpy")
def turned(x, v, a, omega, t):
    """x e^{−iωt} and its two derivatives."""
    turn, w = complex(math.cos(omega * t), -math.sin(omega * t)), 1j * omega
    return x * turn, (v - w * x) * turn, (a - 2 * w * v + w * w * x) * turn


@njit(cache=True, error_model="numpy")
def regime_at(x, v, guards, then):
    """The regime whose guards are all positive at (x, x′), or nearest to it."""
    best, depth = 0, -np.inf
    for r in range(guards.shape[0]):
        least = np.inf
        for i in range(guards.shape[1]):
            if then[r, i] >= 0:
                least = min(least, guards[r, i, 0] * x + guards[r, i, 1] * v - guards[r, i, 2])
        if least > depth:
            best, depth = r, least
    return best


@njit(cache=True, error_model="numpy")
def advance(t, end, state, regime, omega, force, pieces, guards, then, tangents, record, measure, sums):
    """Move ``state`` (2,) and ``tangents`` (2, m) from t to ``end``; the last of m ≥ 3 columns is ∂/∂ω.

    pieces (regimes, 3): c, s, d; guards (regimes, most, 3): a, e, h; then (regimes, most): the next regime or −1.
    force (harmonics + 1,) complex: F₀ and p_k − i q_k. record (rows, 4) receives the events; measure > 0 also
    records extrema and adds ∫x dt, ∫x cos ωt dt and −∫x sin ωt dt to sums; an int64, as for a literal numba compiles
    anew. Returns regime, number of events and how it ended.
    """
    events, n = 0, len(force)
    response, slope = np.zeros(n, dtype=np.complex128), np.zeros(n, dtype=np.complex128)
    vectors = tangents.shape[1]
    unit = 2 * math.pi / omega
    for _ in range(10_000_000):
        c, s, d = pieces[regime, 0], pieces[regime, 1], pieces[regime, 2]
        amplitudes(c, s, omega, force, response, slope)
        second, third = 0.0, 0.0
        for k in range(1, n):
            size = abs(response[k]) * (k * omega) ** 2
            second += size
            third += size * k * omega
        x0, v0 = state[0], state[1]
        fx, fv, fa = forced(t, omega, response)
        y0, w0 = x0 - fx, v0 - fv
        load = force[0].real - d
        longest = end - t
        tau, x, v = 0.0, x0, v0
        y, w = y0, w0
        crossed, last_tau, last_x, last_v, last_a = -2, 0.0, x, v, 0.0
        side = 1.0 if (v > 0 or (v == 0 and load - c * w - s * y + fa > 0)) else -1.0
        steps = 0
        while True:
            jerk = load - c * w - s * y
            a = fa + jerk
            energy = math.sqrt(jerk * jerk + s * w * w)
            bound_x = energy + second
            bound_v = (c + math.sqrt(s)) * energy + third
            if measure and steps > 0:
                h = tau - last_tau
                sums[0] += h * (0.5 * (x + last_x) + h * ((last_v - v) / 10 + h * (a + last_a) / 120))
                # ∫x e^{−iωt} by the same rule, from both derivatives of the product.
                q0, q1, q2 = turned(last_x, last_v, last_a, omega, t + last_tau)
                r0, r1, r2 = turned(x, v, a, omega, t + tau)
                part = h * (0.5 * (r0 + q0) + h * ((q1 - r1) / 10 + h * (r2 + q2) / 120))
                sums[1] += part.real
                sums[2] += part.imag
            last_tau, last_x, last_v, last_a = tau, x, v, a
            step = longest - tau
            if step <= 0:
                crossed = -1
                break
            if measure:
                step = min(step, MEASURING_PHASE / max(omega * (n - 1), math.sqrt(s), c, 1e-300))
            for i in range(guards.shape[1] + measure):
                if i < guards.shape[1]:
                    if then[regime, i] < 0:
                        continue
                    ga, ge, gh = guards[regime, i, 0], guards[regime, i, 1], guards[regime, i, 2]
                else:
                    ga, ge, gh = 0.0, side, 0.0
                g = ga * x + ge * v - gh
                rate = ga * v + ge * a
                size = abs(ga) * (abs(y) + abs(fx)) + abs(ge) * (abs(w) + abs(fv)) + abs(gh)
                bound = abs(ga) * bound_x + abs(ge) * bound_v + 1e-300
                if rate < 0 and (g <= 1e-15 * size or g < -rate * (1e-15 * unit + 4e-16 * abs(t + tau))):
                    crossed = i
                    break
                g = max(g, 0.0)
                root = math.sqrt(rate * rate + 2 * bound * g)
                safe = 2 * g / (root - rate) if rate < 0 else (rate + root) / bound
                # Resting on a surface: such a step changes a guard by less than rounding does.
                if abs(rate) <= 1e-9 * unit * bound:
                    safe = max(safe, 1e-9 * unit)
                if safe < step:
                    step = safe
            if crossed >= 0:
                break
            steps += 1
            if steps > 100_000:
                return regime, events, TOO_MANY_STEPS
            tau = min(tau + step, longest)
            p, q, u, r, pushed = homogeneous(c, s, tau)
            fx, fv, fa = forced(t + tau, omega, response)
            y, w = p * y0 + q * w0 + load * pushed, u * y0 + r * w0 + load * q
            x, v = y + fx, w + fv
        if vectors > 0:
            p, q, u, r, pushed = homogeneous(c, s, tau)
            sx, sv = forced_by_frequency(t, omega, response, slope)
            ex, ev = forced_by_frequency(t + tau, omega, response, slope)
            for j in range(vectors):
                moved = j == vectors - 1
                one = tangents[0, j] - (sx if moved else 0.0)
                two = tangents[1, j] - (sv if moved else 0.0)
                tangents[0, j] = p * one + q * two + (ex if moved else 0.0)
                tangents[1, j] = u * one + r * two + (ev if moved else 0.0)
        state[0], state[1] = x, v
        t += tau
        if crossed == -1:
            return regime, events, DONE
        if events >= len(record):
            return regime, events, TOO_MANY_EVENTS
        if crossed < guards.shape[1]:
            ga, ge, gh = guards[regime, crossed, 0], guards[regime, crossed, 1], guards[regime, crossed, 2]
            before, rate = a, ga * v + ge * a
            regime = then[regime, crossed]
            # Saltation: the force may jump there (damping in contact only).
            now = forced_total(t, omega, force) - pieces[regime, 0] * v - pieces[regime, 1] * x - pieces[regime, 2]
            for j in range(vectors):
                tangents[1, j] += (now - before) * (ga * tangents[0, j] + ge * tangents[1, j]) / rate
            record[events, 3] = regime
        else:
            record[events, 3] = EXTREMUM
            # The next stretch starts on the other side of rest.
            state[1] = 0.0
        record[events, 0], record[events, 1], record[events, 2] = t, x, v
        events += 1
    return regime, events, TOO_MANY_EVENTS


@njit(cache=True, error_model="numpy")
def forced_total(t, omega, force):
    """F(t)."""
    total = force[0].real
    for k in range(1, len(force)):
        total += force[k].real * math.cos(k * omega * t) - force[k].imag * math.sin(k * omega * t)
    return total


ROW = 13
"""Columns of a measured motion: smallest and largest x, mean, impacts, Σ½v² and Σ|v| of them, contact (1 upper,
2 lower, 3 both), settled (1) or not, periods run, fundamental Re and Im (x = Re c e^{iωt}), x and x′ at phase zero."""


@njit(cache=True, error_model="numpy")
def measure(state, regime, periods, omega, force, pieces, guards, then, side, record, row):
    """What a motion does in ``periods`` periods from phase zero; fills ``row`` (ROW,) but for its columns 7, 8."""
    length = 2 * math.pi / omega
    none = np.zeros((2, 0))
    sums = np.zeros(3)
    low, high, impacts, energy, impulse, touched = state[0], state[0], 0, 0.0, 0.0, 0
    ended = DONE
    for _ in range(periods):
        if side[regime] != 0:
            touched |= 1 if side[regime] > 0 else 2
        before = regime
        after, events, ended = advance(
            0.0, length, state, regime, omega, force, pieces, guards, then, none, record, np.int64(1), sums
        )
        for e in range(events):
            x, v, kind = record[e, 1], record[e, 2], int(record[e, 3])
            low, high = min(low, x), max(high, x)
            if kind == EXTREMUM:
                continue
            if side[kind] != 0:
                touched |= 1 if side[kind] > 0 else 2
                if side[before] != side[kind]:
                    impacts += 1
                    energy += 0.5 * v * v
                    impulse += abs(v)
            before = kind
        regime = after
        low, high = min(low, state[0]), max(high, state[0])
        if ended != DONE:
            break
    row[0], row[1], row[2] = low, high, sums[0] / (periods * length)
    row[3], row[4], row[5], row[6] = impacts / periods, energy / periods, impulse / periods, touched
    row[9], row[10] = 2 * sums[1] / (periods * length), 2 * sums[2] / (periods * length)
    row[11], row[12] = state[0], state[1]
    return regime, ended


@njit(cache=True, error_model="numpy")
def settle(state, regime, least, most, tolerance, omega, force, pieces, guards, then, record):
    """Run at least ``least`` and at most ``most`` periods, until x and x′ at phase zero change by no more than
    ``tolerance`` (of |x| + |x′| + tolerance) three times running. Returns regime, periods run, settled, ended."""
    length = 2 * math.pi / omega
    none, sums = np.zeros((2, 0)), np.zeros(3)
    calm = 0
    for count in range(1, most + 1):
        x, v = state[0], state[1]
        regime, _, ended = advance(
            0.0, length, state, regime, omega, force, pieces, guards, then, none, record, np.int64(0), sums
        )
        if ended != DONE:
            return regime, count, 0, ended
        if abs(state[0]) + abs(state[1]) > 1e12:
            return regime, count, 0, DONE
        change = abs(state[0] - x) + abs(state[1] - v)
        calm = calm + 1 if change <= tolerance * (abs(state[0]) + abs(state[1]) + tolerance) else 0
        if calm >= 3 and count >= least:
            return regime, count, 1, DONE
    return regime, most, 0, DONE


@njit(cache=True, error_model="numpy")
def basins(starts, least, most, tolerance, omega, force, pieces, guards, then, record, ends, counts):
    """Where motions from many starts (m, 2) settle: ends (m, 2), counts (m,) of periods, negative if they did not."""
    for i in range(len(starts)):
        ends[i] = starts[i]
        regime = regime_at(starts[i, 0], starts[i, 1], guards, then)
        _, count, settled, ended = settle(
            ends[i], regime, least, most, tolerance, omega, force, pieces, guards, then, record
        )
        counts[i] = count if settled and ended == DONE else -count

"""Compiled loop over samples of a motion: its states, and how an orthonormal frame of tangents grows.

The frame is orthonormalised every few steps of the integrator, whatever their length: between two times its
vectors then cannot align, so the volumes they span, and with them the sum of the exponents, keep their digits
however unlike the exponents are. Method: Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15 (1980).

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np
from numba import njit
from trunnion_kernels.integration_kernel import (
    FRESH,
    FULL,
    MOST_QUICK_EVENTS,
    POWERS,
    REACHED,
    REFUSED,
    STEPS,
    STORED,
    TIME,
    advance,
    call_rate,
    interpolate,
)

STEPS_BETWEEN = 6
"""Steps of the integrator between two orthonormalisations."""
_GAUSS = np.array([0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263])
_WEIGHT = np.array([0.17392742256872692, 0.32607257743127307, 0.32607257743127307, 0.17392742256872692])


@njit(cache=True, nogil=True)
def orthonormalise(frame, weight, growth):
    """Modified Gram–Schmidt in units of ``weight``; adds the logarithms of the lengths to ``growth``.

    Returns 1 where a vector has vanished (a jump may do that): its growth is then −inf and the frame is useless.
    """
    count, n = frame.shape
    lost = 0
    for j in range(count):
        for i in range(j):
            product = 0.0
            for m in range(n):
                product += frame[i, m] * frame[j, m] / (weight[m] * weight[m])
            for m in range(n):
                frame[j, m] -= product * frame[i, m]
        length = 0.0
        for m in range(n):
            length += (frame[j, m] / weight[m]) ** 2
        length = np.sqrt(length)
        growth[j] += np.log(length)
        if not length > 0.0:
            lost = 1
            length = 1.0
        for m in range(n):
            frame[j, m] /= length
    return lost


@njit(cache=True, nogil=True, no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _trace(rate, t, x, p, regime, block, out):
    """tr ∂f/∂x from the images of the unit vectors."""
    n = x.size
    block[n:] = 0.0
    for i in range(n):
        block[i], block[n + i * n + i] = x[i], 1.0
    if call_rate(rate, t, block, p, n, regime, out) != 0:
        return np.nan
    total = 0.0
    for i in range(n):
        total += out[n + i * n + i]
    return total


@njit(cache=True, nogil=True)
def follow(
    functions, p, y, n, count, transitions, directions, weight, clock, whole, interval, wrap, tolerance, most_steps,
    traced, growth, states, divergence,
):  # fmt: skip
    """Carry state and frame in ``y`` (1 + count, n, flat) over as many samples as ``states`` has rows.

    clock, whole : of the integrator, carried from call to call; clock[TIME] is the time.
    interval : of a sample. wrap : the time returns to its remainder by this; 0 puts it back to 0 each sample.
    traced : integrate tr ∂f/∂x along the motion into ``divergence`` (samples,).
    growth (samples, count), states (samples, n) : at the end of each.
    Returns the integrator's code (REACHED if all went well) and the number of samples finished.
    """
    own = transitions.shape[1]
    capacity = STEPS_BETWEEN if count > 0 else 4096
    step_start, step_length = np.empty(capacity), np.empty(capacity)
    step_regime, step_states = np.empty(capacity, dtype=np.int64), np.empty((capacity, n))
    coefficients = np.empty((capacity if traced else 0, POWERS, n))
    events = 128 if own > 0 else MOST_QUICK_EVENTS + 4
    event_time, event_which = np.empty(events), np.empty(events, dtype=np.int64)
    event_before, event_after = np.empty((events, n)), np.empty((events, n))
    asked, none, sides = np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros(own)
    block, out, x = np.empty(n * (n + 1)), np.empty(n * (n + 1)), np.empty(n)
    for s in range(states.shape[0]):
        end = clock[TIME] + interval
        growth[s] = 0.0
        divergence[s] = 0.0
        whole[FRESH] = 1
        whole[STEPS] = 0
        while True:
            code = advance(
                functions, p, asked, y, n, count, transitions, directions, none, none,
                clock, whole, sides, end, tolerance, weight, np.inf, most_steps, traced,
                step_start, step_length, step_regime, step_states, coefficients,
                event_time, event_which, event_before, event_after,
            )  # fmt: skip
            if traced:
                for j in range(whole[STORED]):
                    for g in range(4):
                        interpolate(coefficients[j], _GAUSS[g], x)
                        at = step_start[j] + _GAUSS[g] * step_length[j]
                        slope = _trace(functions[0], at, x, p, step_regime[j], block, out)
                        divergence[s] += _WEIGHT[g] * step_length[j] * slope
            if count > 0 and (code == FULL or code == REACHED):
                if orthonormalise(y[n:].reshape((count, n)), weight, growth[s]) != 0:
                    clock[TIME] = end - interval
                    return REFUSED, s
            if code != FULL:
                break
        if code != REACHED:
            clock[TIME] = end - interval
            return code, s
        for i in range(n):
            states[s, i] = y[i]
        if wrap > 0.0:
            clock[TIME] = end - wrap * np.floor(end / wrap + 1e-12)
        else:
            clock[TIME] = 0.0
    return REACHED, states.shape[0]

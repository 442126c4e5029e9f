"""Compiled loop over samples of a periodic motion: rates and Jacobians of a system in whatever regime it is.

This file imports nothing of the package: it is compiled from a copy in the cache folder.
"""

# mypy: ignore-errors
# Types are inferred by the compiler of this code, from its arguments.
from __future__ import annotations

import numpy as np
from numba import njit
from trunnion_kernels.integration_kernel import call_guard, call_rate

MOST_SWITCHES = 8
"""Changes of regime between two samples; more are a motion that no regime will have."""


@njit(cache=True, nogil=True)
def sampled_rates(rate, guard, transitions, directions, times, states, p, regime, rates, jacobians, regimes):
    """rates (samples, n), jacobians (samples, n, n) and regimes (samples,) at states (samples, n).

    ``regime`` is that of the first sample; from one to the next it follows the guards. Returns 0, or what the
    system answers where it cannot be evaluated.
    """
    n = states.shape[1]
    block, out = np.zeros((1 + n) * n), np.zeros((1 + n) * n)
    guards = transitions.shape[1]
    g, slope = np.zeros(guards), np.zeros(guards * (n + 1))
    for j in range(n):
        block[(1 + j) * n + j] = 1.0
    for i in range(times.size):
        for j in range(n):
            block[j] = states[i, j]
        if guards > 0:
            for _ in range(MOST_SWITCHES):
                refused = call_guard(guard, times[i], block[:n], p, regime, g, slope)
                if refused != 0:
                    return refused
                then = -1
                for m in range(guards):
                    watched = directions[regime, m]
                    # A crossing both ways leads on from either side, so it says nothing about where one stands.
                    if (watched == 1 and g[m] > 0.0) or (watched == -1 and g[m] < 0.0):
                        then = transitions[regime, m]
                if then < 0:
                    break
                regime = then
        refused = call_rate(rate, times[i], block, p, n, regime, out)
        if refused != 0:
            return refused
        for j in range(n):
            rates[i, j] = out[j]
            for k in range(n):
                jacobians[i, k, j] = out[(1 + j) * n + k]
        regimes[i] = regime
    return 0


@njit(cache=True, nogil=True)
def sampled_rates_of_cases(rate, transitions, directions, times, states, numbers, rates, jacobians):
    """The same of many systems of one shape without guards: times (cases, samples), states (cases, samples, n),
    numbers (cases, k). What one cannot be evaluated at is NaN.
    """
    regimes = np.zeros(times.shape[1], dtype=np.int64)
    for case in range(times.shape[0]):
        refused = sampled_rates(
            rate, 0, transitions, directions, times[case], states[case], numbers[case], 0, rates[case],
            jacobians[case], regimes,
        )  # fmt: skip
        if refused != 0:
            rates[case], jacobians[case] = np.nan, np.nan

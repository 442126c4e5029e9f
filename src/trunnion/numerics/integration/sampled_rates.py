"""Rates and Jacobians of a system along samples of a motion, or of many."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.numerics.compiled import kernel_file
from trunnion.numerics.integration.integration import Equations


@cache
def _kernel() -> ModuleType:
    here = Path(__file__)
    return kernel_file(str(here.with_name("sampled_rates_kernel.py")), str(here.with_name("integration_kernel.py")))


def sampled_rates(
    equations: Equations, times: Array, states: Array, regime: int
) -> tuple[Array, Array, Integers] | None:
    """Rates (samples, n), Jacobians (samples, n, n) and regimes (samples,) at states (samples, n).

    ``regime`` is that of the first sample, the others follow from the guards; None where the system refuses.
    """
    count, n = states.shape
    rates, jacobians = np.empty((count, n)), np.empty((count, n, n))
    regimes = np.zeros(count, dtype=np.int64)
    refused = _kernel().sampled_rates(
        equations.rate, equations.guard, equations.transitions, equations.directions, times,
        np.ascontiguousarray(states), equations.numbers.copy(), regime, rates, jacobians, regimes,
    )  # fmt: skip
    if refused or not (np.isfinite(rates).all() and np.isfinite(jacobians).all()):
        return None
    return rates, jacobians, regimes


def sampled_rates_of_cases(rate: int, times: Array, states: Array, numbers: Array) -> tuple[Array, Array]:
    """Rates (case, sample, n) and Jacobians (case, sample, n, n) of one system without guards, ``rate`` the address of
    its function, with many ``numbers`` (case, k), at times (case, sample) and states (case, sample, n); NaN throughout
    a case that it refuses or that is not finite."""
    unguarded = np.zeros((1, 0), dtype=np.int64)
    rates, jacobians = np.empty(states.shape), np.empty((*states.shape, states.shape[-1]))
    _kernel().sampled_rates_of_cases(
        rate, unguarded, unguarded, times, np.ascontiguousarray(states), numbers.copy(), rates, jacobians
    )
    lost = ~(np.isfinite(rates).all(axis=(1, 2)) & np.isfinite(jacobians).all(axis=(1, 2, 3)))
    rates[lost], jacobians[lost] = np.nan, np.nan
    return rates, jacobians

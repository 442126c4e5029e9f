"""Rates and Jacobians of a system along samples of a motion."""

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

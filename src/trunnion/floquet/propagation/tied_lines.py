"""Monodromy matrices of lines whose shafts are tied to two others or close a loop, many at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.equations.first_order import FEWEST_SAMPLES, LineRates
from trunnion.numerics.chain.exponential_monodromy import MOST_STEPS, marched
from trunnion.waiting import keep_time

MOST_NUMBERS = 1 << 23
"""Held of the coefficients at a time, while their means are taken."""
ROUNDING = 2e-15
"""Of a product of exponentials, per state and over its norm."""
FALLS = 16.0
"""By how much the error of twice the steps is smaller, at least: its order is 6."""


def tied_matrices(
    assembly: Assembly, table: Array, twisted: bool, tolerance: float, units: tuple[Array, float] | None = None
) -> tuple[Array, Array, Array]:
    """Monodromy matrices of rows of ``table`` (case, 2n, 2n), bounds of their errors (case,) and ∫ tr(M⁻¹C) dτ.

    units : √m (n,) and νΩ [rad/s] that all states are counted in (``first_order``); each line's own by default.
    """
    size = assembly.topology.size
    at_once = max(1, MOST_NUMBERS // (FEWEST_SAMPLES * size**2))
    parts = []
    for first in range(0, len(table), at_once):
        keep_time()
        rates = LineRates.of(assembly, table[first : first + at_once], twisted)
        if units is not None:
            root, frequency = units
            unit = frequency / rates.table[:, 0]
            rates = replace(rates, root=np.broadcast_to(root, rates.root.shape), unit=unit, kept={})
        parts.append((*matrices_by_halving(rates, tolerance), rates.trace))
    matrix, error, trace = (np.concatenate(part) for part in zip(*parts, strict=True))
    return matrix, error, trace


@np.errstate(over="ignore", invalid="ignore")  # steps that are far too long overflow, and are halved
def matrices_by_halving(rates: LineRates, tolerance: float) -> tuple[Array, Array]:
    """Matrices of the period (case, m, m) in the units of ``rates``, and bounds of their errors (case,) by Frobenius's
    norm; NaN where the shortest steps do not reach ``tolerance`` or rounding."""
    cases, states = len(rates.table), 2 * rates.root.shape[1]
    matrix, error = np.full((cases, states, states), np.nan), np.full(cases, np.nan)
    left, count = np.arange(cases), rates.steps
    coarse = marched(rates, left, states, rates.period, count)
    while len(left) and count < MOST_STEPS:
        count *= 2
        fine = marched(rates, left, states, rates.period, count)
        rounding = ROUNDING * states * np.linalg.norm(fine, axis=(1, 2))
        off = np.linalg.norm(fine - coarse, axis=(1, 2)) / FALLS + rounding
        done = np.asarray(off <= np.maximum(tolerance, 4 * rounding))
        matrix[left[done]], error[left[done]] = fine[done], off[done]
        left, coarse = left[~done], fine[~done]
    return matrix, error

"""Multipliers of lines about the periodic motions that they make, at many values of one parameter together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array, Codes, Complex
from trunnion.equations.first_order import fastest_cycles, steps_that_see
from trunnion.numerics.chain.exponential_monodromy import SHARE, exponential_monodromies
from trunnion.results.verdict import Verdict, verdicts
from trunnion.steady.free.free_balance import FreeBalance
from trunnion.steady.free.periodic_steady_states import SteadyStateCurve, SteadyStateSlopes, slopes_along


@dataclass(frozen=True)
class SteadyStateMultipliers:
    """radius, error (its estimate), critical (the largest multiplier), verdict (code), each (value,); NaN and FAILED
    where there is no motion that is known. matrix (value, 2n, 2n): what a disturbance becomes in a period, in
    energy-like units."""

    radius: Array
    error: Array
    critical: Complex
    verdict: Codes
    matrix: Array


def multipliers_about(
    motions: SteadyStateSlopes, *, tolerance: float = 1e-9, share: float = SHARE
) -> SteadyStateMultipliers:
    """Of all motions, without what is not a disturbance of them; ``tolerance`` and ``share`` as of
    ``exponential_monodromies``."""
    count, size = len(motions.value), 2 * len(motions.solved.balance.turn)
    there = np.flatnonzero(motions.found)
    radius, error = np.full(count, np.nan), np.full(count, np.nan)
    critical, matrix = np.full(count, np.nan, dtype=complex), np.full((count, size, size), np.nan)
    if len(there):
        found = exponential_monodromies(
            lambda which, tau: motions.rates(there[which], tau),
            len(there),
            size,
            motions.period,
            tolerance=tolerance,
            share=share,
            least_steps=steps_that_see(fastest_cycles(motions.solved.balance.assembly, motions.period)),
            aside=lambda which, z: motions.beside_neutral(there[which], z),
        )
        radius[there], error[there], critical[there] = found.radius, found.error, found.critical
        matrix[there] = found.matrix
    code = np.where(np.isfinite(radius), verdicts(radius, error, motions.undamped), Verdict.FAILED)
    return SteadyStateMultipliers(radius, error, critical, code.astype(np.int8), matrix)


def beside_neutral_multipliers(motions: SteadyStateSlopes, found: SteadyStateMultipliers) -> Complex:
    """Every multiplier (value, m) but those of what is not a disturbance; NaN where no motion is known."""
    known = np.flatnonzero(np.isfinite(found.radius))
    left = motions.beside_neutral(known, found.matrix[known])
    every = np.full((len(found.radius), left.shape[1]), np.nan, dtype=complex)
    every[known] = np.linalg.eigvals(left)
    return every


def pixels_of_rows(balance: FreeBalance, table: Array, *, tolerance: float = 1e-9) -> SteadyStateMultipliers:
    """Of lines that lie anywhere, rows of packed numbers (line, column): about the motion that rigid shafts lead to,
    else that of a line nearby in the table.

    Critical multipliers are those with a positive imaginary part.
    """

    def rows(value: Array) -> Array:
        """Between two lines the way from one to the other, along which a motion is followed."""
        before = np.clip(np.floor(value).astype(int), 0, max(len(table) - 2, 0))
        share = (value - before)[:, None]
        return np.asarray(table[before] * (1 - share) + table[np.minimum(before + 1, len(table) - 1)] * share)

    curve = SteadyStateCurve(balance.along(rows), (0.0, float(len(table) - 1)))
    found = multipliers_about(slopes_along(curve, np.arange(len(table), dtype=float)), tolerance=tolerance)
    return replace(found, critical=np.where(found.critical.imag < 0, found.critical.conj(), found.critical))

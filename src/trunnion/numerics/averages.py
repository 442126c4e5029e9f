"""Averages of a correlated series, with an interval of confidence from the means of its batches.

    plain      m = Σ a_i / N
    windowed   m = Σ w_i a_i / Σ w_i,   w(u) = exp(−1/(u(1−u))),   u = (i + ½)/N

The plain mean is the better one of a chaotic series. On a quasi-periodic series its error falls as 1/N only,
while that of the windowed mean falls faster than any power (Das, Saiki, Sander, Yorke, Nonlinearity 30, 2017,
"Quantitative quasiperiodicity"). Each batch is averaged both ways, and the way whose batches agree much better is
taken.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array

BATCHES = 20
CONFIDENCE = 0.95
MUCH_BETTER = 3.0
"""Ratio of scatters from which the windowed mean is taken."""


@dataclass(frozen=True)
class Average:
    """mean (k,) of a series and half_width (k,) of its interval of confidence; batches (batches, k)."""

    mean: Array
    half_width: Array
    batches: Array
    windowed: bool


def average(series: Array) -> Average:
    """Average of each column of ``series`` (samples, k); all columns by the same weights, so sums stay sums."""
    plain, windowed = batch_means(series, BATCHES, False), batch_means(series, BATCHES, True)
    smooth = _scatter(windowed) * MUCH_BETTER < _scatter(plain)
    return pooled(windowed if smooth else plain, smooth)


def pooled(batches: Array, windowed: bool) -> Average:
    """The average over batches (batches, k), which may come from several series; NaN of none."""
    if not len(batches):
        return Average(np.full(batches.shape[1:], np.nan), np.full(batches.shape[1:], np.nan), batches, windowed)
    mean = batches.mean(axis=0)
    if len(batches) < 2:
        return Average(mean, np.full(mean.shape, np.inf), batches, windowed)
    error = batches.std(axis=0, ddof=1) / np.sqrt(len(batches))
    return Average(mean, _student(len(batches) - 1) * error, batches, windowed)


def batch_means(series: Array, batches: int, windowed: bool) -> Array:
    """Means (batches, k) of consecutive batches of equal length; the remainder at the front is left out."""
    length = len(series) // batches
    if length == 0:
        return np.array(series[:0] if not len(series) else series.mean(axis=0)[None])
    blocks = series[len(series) - length * batches :].reshape(batches, length, -1)
    if not windowed:
        return np.asarray(blocks.mean(axis=1))
    u = (np.arange(length) + 0.5) / length
    weight = np.exp(-1 / (u * (1 - u)))
    return np.asarray(np.tensordot(weight / weight.sum(), blocks, (0, 1)))


def _student(freedom: int) -> float:
    """Two-sided quantile of Student's t."""
    from scipy.stats import t

    return float(t.ppf(0.5 + CONFIDENCE / 2, freedom))


def _scatter(batches: Array) -> float:
    return float(np.sqrt(np.sum(batches.var(axis=0)))) if len(batches) else 0.0

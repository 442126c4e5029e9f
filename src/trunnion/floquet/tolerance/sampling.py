"""Scrambled Sobol sequences in several independent scrambles, and the interval of a share from their scatter."""

from __future__ import annotations

import numpy as np
from scipy.stats import beta, qmc
from scipy.stats import t as student

from trunnion.arrays import Array, Flags

SCRAMBLES = 16


def sobol(parameters: int, each: int, seed: int) -> Array:
    """Shares (scrambles · each, parameters), one scrambled sequence after another."""
    generators = (np.random.default_rng([seed, k]) for k in range(SCRAMBLES))
    return np.concatenate([qmc.Sobol(parameters, scramble=True, seed=g).random(each) for g in generators])


def interval(stable: Flags, confidence: float) -> tuple[float, float]:
    """Of the share of True: from the scatter of the rows' means, or where there is none from the count."""
    means, count = stable.mean(axis=1), stable.size
    middle = float(means.mean())
    half = float(student.ppf(0.5 + confidence / 2, len(means) - 1) * means.std(ddof=1) / np.sqrt(len(means)))
    # A scatter below what one line more or less would make says nothing.
    if half < 1 / count:
        yes, tail = int(stable.sum()), (1 - confidence) / 2
        low = 0.0 if yes == 0 else float(beta.ppf(tail, yes, count - yes + 1))
        high = 1.0 if yes == count else float(beta.ppf(1 - tail, yes + 1, count - yes))
        return low, high
    return max(0.0, middle - half), min(1.0, middle + half)

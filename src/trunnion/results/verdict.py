"""Stable, unstable, marginal or undecided: the verdict on a spectral radius and its error."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Codes


class Verdict(IntEnum):
    """Codes of the int8 arrays in datasets; ``str(verdict)`` is the word."""

    FAILED = -1
    STABLE = 0
    UNSTABLE = 1
    MARGINAL = 2
    UNDECIDED = 3

    def __str__(self) -> str:
        return self.name.lower()


MEANING = {
    Verdict.STABLE: "every disturbance dies out",
    Verdict.UNSTABLE: "a small disturbance grows",
    Verdict.MARGINAL: "without damping disturbances neither grow nor die out (all multipliers on the unit circle)",
    Verdict.UNDECIDED: "the spectral radius is 1 to within its error",
    Verdict.FAILED: "the integration failed",
}


def verdicts(radius: ArrayLike, error: ArrayLike, undamped: ArrayLike = False) -> Codes:
    """Codes from spectral radius and error estimate; ``undamped`` turns undecided into marginal."""
    radius, error = np.asarray(radius, dtype=float), np.asarray(error, dtype=float)
    straddling = np.where(undamped, Verdict.MARGINAL, Verdict.UNDECIDED)
    code = np.where(radius - error > 1, Verdict.UNSTABLE, np.where(radius + error < 1, Verdict.STABLE, straddling))
    return np.where(np.isfinite(radius) & np.isfinite(error), code, Verdict.FAILED).astype(np.int8)


def flag_attributes() -> dict[str, Any]:
    """CF attributes that spell the codes out in a dataset."""
    return {
        "flag_values": np.array([int(v) for v in Verdict], dtype=np.int8),
        "flag_meanings": " ".join(str(v) for v in Verdict),
    }

"""What counts as a closed orbit where the motion is exact, and the verdict on its multipliers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from trunnion.errors import InputError
from trunnion.results.verdict import Verdict

CLOSED = 1e-11
"""How well an orbit must close, in units of its size."""
UNTOLD = 1e-9
"""A spectral radius nearer to 1 than this is not told from it."""
SETTLING = (0, 50, 500)
"""Periods that pass before each attempt at shooting."""


def verdict_of(multipliers: NDArray[np.complex128]) -> Verdict:
    """The verdict on multipliers known to rounding."""
    radius = float(np.abs(multipliers).max())
    if not np.isfinite(radius):
        return Verdict.FAILED
    if abs(radius - 1) <= UNTOLD:
        return Verdict.UNDECIDED
    return Verdict.STABLE if radius < 1 else Verdict.UNSTABLE


def checked_periods(periods: int) -> int:
    """The number of periods, if it is one.

    Raises
    ------
    InputError : not a whole number from 1.
    """
    if isinstance(periods, bool) or periods != int(periods) or periods < 1:
        raise InputError("must be a whole number from 1", key="periods", value=periods)
    return int(periods)


def refuse_speed(oscillator: str, speed: float | None) -> None:
    """Refuse a speed given beside an oscillator, which has none.

    Raises
    ------
    InputError : so.
    """
    if speed is not None:
        raise InputError("belongs to a driveline", element=oscillator, key="speed", value=speed, remedy="leave it out")

"""What counts as a closed orbit where the motion is exact, and the verdict on its multipliers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from trunnion.errors import InputError
from trunnion.results.verdict import Verdict, verdicts

CLOSED = 1e-11
"""How well an orbit must close, in units of its size."""
RADIUS_ERROR = 1e-9
"""What the spectral radius of an exact orbit may be off by; nearer to 1 it is undecided."""
SETTLING = (0, 50, 500)
"""Periods that pass before each attempt at shooting."""


def verdict_of(multipliers: NDArray[np.complex128]) -> Verdict:
    """The verdict on multipliers of an exact orbit."""
    return Verdict(int(verdicts(np.abs(multipliers).max(), RADIUS_ERROR)))


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

"""Sizes and times known before anything is begun: what would not fit or not end is refused with its numbers."""

from __future__ import annotations

from trunnion.errors import InputError

MOST = 2 * 2**30
"""Bytes one result may take, working space included."""
MOST_SECONDS = 3600.0
"""Processor time beyond which nothing is begun."""


def require_memory(needed: float, *, key: str, value: object, remedy: str, element: str = "") -> None:
    """Refuse what would need more than ``MOST`` bytes.

    Raises
    ------
    InputError : says how much it would need, how much it may take, and the remedy.
    """
    if needed > MOST:
        problem = f"would need {size_text(needed)} of memory, at most {size_text(MOST)} is taken"
        raise InputError(problem, element=element, key=key, value=value, remedy=remedy)


def require_estimate(
    size: int, what: str, seconds: float, memory: float, *, remedy: str, most: float = MOST_SECONDS
) -> None:
    """Refuse ``what`` of a driveline with ``size`` unknowns that would take more than ``most`` seconds of processor
    time, or more than ``MOST`` bytes.

    Raises
    ------
    InputError : says how long it would take, how much memory, and the remedy.
    """
    if seconds > most or memory > MOST:
        problem = (
            f"has {size} unknowns: {what} would take about {seconds / 3600:.2g} h of processor time and "
            f"{size_text(memory)} of memory"
        )
        raise InputError(problem, element="driveline", remedy=remedy)


def size_text(size: float) -> str:
    """Bytes as people say them: 3.1 GB."""
    for unit, one in (("PB", 2**50), ("TB", 2**40), ("GB", 2**30), ("MB", 2**20)):
        if size >= one:
            return f"{size / one:.3g} {unit}"
    return f"{size / 2**10:.3g} kB"

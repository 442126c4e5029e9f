"""Sizes known before anything is allocated: what would not fit is refused with the number it would need."""

from __future__ import annotations

from trunnion.errors import InputError

MOST = 2 * 2**30
"""Bytes one result may take, working space included."""


def require_memory(needed: float, *, key: str, value: object, remedy: str, element: str = "") -> None:
    """Refuse what would need more than ``MOST`` bytes.

    Raises
    ------
    InputError : says how much it would need, how much it may take, and the remedy.
    """
    if needed > MOST:
        problem = f"would need {size_text(needed)} of memory, at most {size_text(MOST)} is taken"
        raise InputError(problem, element=element, key=key, value=value, remedy=remedy)


def size_text(size: float) -> str:
    """Bytes as people say them: 3.1 GB."""
    for unit, one in (("PB", 2**50), ("TB", 2**40), ("GB", 2**30), ("MB", 2**20)):
        if size >= one:
            return f"{size / one:.3g} {unit}"
    return f"{size / 2**10:.3g} kB"

"""Which elements a text names: one by its name, all of a kind, or all whose names fit a pattern.

::

    "half shaft left"    the element of that name
    "half shaft *"       all whose names begin with "half shaft "; a star stands for any letters
    "Shaft *"            all of the kind Shaft, whatever their names

A pattern speaks of each element by itself: "Shaft *" with a tolerance of 5 % lets every shaft scatter by 5 % of what
it states, not all together. What is said of one element overrides a pattern of names, and that a kind.
"""

from __future__ import annotations

import re
from functools import cache

from trunnion.driveline.kinds import KINDS

OF_A_KIND, OF_A_PATTERN, OF_ONE = range(3)
"""How closely a text names an element."""


def closeness(of: str) -> int:
    """Whether a text is about a kind, a pattern of names or one element."""
    if kind_in(of) is not None:
        return OF_A_KIND
    return OF_A_PATTERN if "*" in of else OF_ONE


def kind_in(of: str) -> str | None:
    """The kind that "Shaft *" is about; None of other texts."""
    return of[:-2] if of.endswith(" *") and of[:-2] in KINDS else None


def names(of: str, name: str, kind: str) -> bool:
    """Whether a text names an element of a ``name`` and ``kind``."""
    if of == name:
        return True
    asked = kind_in(of)
    if asked is not None:
        return asked == kind
    return "*" in of and _pattern(of).fullmatch(name) is not None


@cache
def _pattern(of: str) -> re.Pattern[str]:
    return re.compile(".*".join(map(re.escape, of.split("*"))), re.DOTALL)

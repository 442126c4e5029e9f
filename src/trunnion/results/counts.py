"""Numbers of things in sentences."""

from __future__ import annotations

from collections.abc import Sequence


def few(names: Sequence[str], most: int = 3) -> str:
    """ "a, b and 4 more": at most ``most`` names, or one more where only one would be left."""
    if len(names) <= most + 1:
        return listed(names)
    return f"{listed(names[:most])} and {len(names) - most} more"


def listed(names: Sequence[str]) -> str:
    """ "a, b, c"; names that hold commas are told apart by semicolons."""
    return ("; " if any("," in name for name in names) else ", ").join(names)


def counted(number: int, noun: str) -> str:
    """ "1 speed", "2 speeds", "0 speeds"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def all_of(words: Sequence[str]) -> str:
    """ "a", "a and b", "a, b and c"."""
    return " and ".join(one for one in (", ".join(words[:-1]), *words[-1:]) if one)


def any_of(words: Sequence[str]) -> str:
    """ "a", "a or b", "a, b or c"."""
    return " or ".join(one for one in (", ".join(words[:-1]), *words[-1:]) if one)

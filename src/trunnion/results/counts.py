"""Numbers of things in sentences."""

from __future__ import annotations


def counted(number: int, noun: str) -> str:
    """ "1 speed", "2 speeds", "0 speeds"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"

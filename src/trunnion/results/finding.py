"""Findings: what an engineer should read, in plain sentences, ordered by gravity."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum


class Gravity(IntEnum):
    """How much a finding matters; the lowest comes first."""

    DANGER = 0
    CAUTION = 1
    NOTE = 2

    def __str__(self) -> str:
        return self.name.lower()


@dataclass(frozen=True)
class Finding:
    """One sentence and how grave it is."""

    gravity: Gravity
    sentence: str

    def __str__(self) -> str:
        return f"{self.gravity}: {self.sentence}"


def by_gravity(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The gravest first; otherwise in the order found."""
    return tuple(sorted(findings, key=lambda f: f.gravity))

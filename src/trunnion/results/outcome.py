"""Outcomes: how a computation ended, as a sentence that says what happened and what to change."""

from __future__ import annotations

from dataclasses import dataclass

from trunnion.errors import ComputationError


@dataclass(frozen=True)
class Outcome:
    """``ok``, a word for the kind of ending, and a sentence; what was computed until then is kept."""

    ok: bool
    kind: str
    sentence: str

    def require(self) -> None:
        """Raise ComputationError unless it went well."""
        if not self.ok:
            raise ComputationError(self.sentence)

    def __str__(self) -> str:
        return self.sentence

"""Results of motions whose words name speeds in a unit that no field of theirs states."""

from __future__ import annotations

from abc import abstractmethod

from trunnion.results.finding import Finding
from trunnion.results.result import Result


class Described(Result):
    """A result whose words name speeds: in the unit of the line's description, or in another that is asked for."""

    @abstractmethod
    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""

    def __str__(self) -> str:
        return self.describe()


class DescribedWithFindings(Described):
    """One whose findings name speeds too."""

    unit: str

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first; speeds in the unit of the line's description."""
        return self.findings_in(self.unit)

    @abstractmethod
    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, gravest first, speeds in ``unit``."""

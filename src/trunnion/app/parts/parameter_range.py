"""A parameter over a range, in the unit that the browser shows it in."""

from __future__ import annotations

from dataclasses import dataclass, replace

from trunnion.driveline.parameters import SPEED
from trunnion.errors import InputError


@dataclass(frozen=True)
class ParameterRange:
    """A parameter along an axis: its ends in SI, and the unit it is shown in with its size in SI."""

    path: str
    low: float
    high: float
    unit: str
    size: float

    def typed(self, low: float | None, high: float | None) -> ParameterRange:
        """The same with the ends that were typed, as shown; None leaves one where it is."""
        first = self.low if low is None else low * self.size
        last = self.high if high is None else high * self.size
        return replace(self, low=first, high=last)

    def require_rising(self, unit: str = "") -> None:
        """InputError where the ends do not rise; ``unit`` stands behind them."""
        if not self.low < self.high:
            low, high = self.ends
            remedy = "type two ends that rise, or leave the fields empty"
            raise InputError(f"runs from {low:g} to {high:g}{unit}", key=self.path, remedy=remedy)

    def request(self, points: int) -> tuple[str, float, float, int]:
        """As ``stability_chart`` takes it."""
        return (self.path, self.low, self.high, points)

    @property
    def ends(self) -> tuple[float, float]:
        """As shown."""
        return self.low / self.size, self.high / self.size

    @property
    def label(self) -> str:
        """With its unit."""
        return f"{'input speed' if self.path == SPEED else self.path} [{self.unit}]"

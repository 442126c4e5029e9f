"""One axis of a stability chart in the browser."""

from __future__ import annotations

from dataclasses import dataclass

from trunnion.driveline.parameters import SPEED


@dataclass(frozen=True)
class Axis:
    """A parameter along an axis: its ends in SI, and the unit it is shown in with its size in SI."""

    path: str
    low: float
    high: float
    unit: str
    size: float

    def request(self, points: int) -> tuple[str, float, float, int]:
        """As ``stability_chart`` takes it."""
        return (self.path, self.low, self.high, points)

    @property
    def label(self) -> str:
        """With its unit."""
        return f"{'input speed' if self.path == SPEED else self.path} [{self.unit}]"

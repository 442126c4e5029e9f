"""What leads where a check binds: an order, and the mode that it is nearest to."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, pi

from trunnion.laws.harmonic import forward
from trunnion.results.speeds import order_name

CLOSE, FAR = 5e-4, 0.5
"""Distance from a mode, as a share of its frequency, within which one is on it, and beyond which it says nothing."""


@dataclass(frozen=True)
class Cause:
    """The order that leads, and the mode that it is nearest to.

    order [cycles per turn of the input] and frequency [rad/s] to add to it, with the signs that turn forward; mode: its
    number, 0 where there is none; natural [rad/s] of the mode; off: what meets it over that, less 1.
    """

    order: float
    frequency: float
    mode: int = 0
    natural: float = nan
    off: float = nan

    @property
    def name(self) -> str:
        """ "order 2", "the excitation at 25 Hz", "the excitation at 100 Hz -4 per turn"."""
        sense = forward(self.order, self.frequency)
        name = order_name(sense * self.order, sense * self.frequency)
        return f"the excitation at {name}" if self.frequency else name

    @property
    def critical(self) -> float:
        """Input speed [rad/s] at which the order meets the mode; NaN for an excitation fixed in time."""
        return (self.natural - self.frequency) / self.order if self.order and self.mode else nan

    def __str__(self) -> str:
        if not self.mode:
            return f"led by {self.name}"
        return f"led by {self.name}, {self._side} mode {self.mode} ({self.natural / (2 * pi):.4g} Hz)"

    @property
    def _side(self) -> str:
        if self.off > FAR or self.off < 1 / (1 + FAR) - 1:
            return "far above" if self.off > 0 else "far below"
        if abs(self.off) < CLOSE:
            return "on"
        return f"{abs(100 * self.off):.2g} % {'above' if self.off > 0 else 'below'}"

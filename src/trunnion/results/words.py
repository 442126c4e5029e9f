"""Numbers in text, speeds in the unit that a reader thinks in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from trunnion.results import speeds
from trunnion.results.quantity_axes import QuantityAxis, parameter_axis
from trunnion.results.stretches import ranges_in_words
from trunnion.results.units import angle_words, figures, in_words, order_words, range_words, rounded_down, rounded_up


@dataclass(frozen=True)
class Words:
    """Turns numbers in SI into text; ``unit`` is that of speeds: "rpm", "Hz" or "rad/s", None of equations of one's
    own, whose numbers read as they are."""

    unit: str | None = "rad/s"

    @property
    def of_speeds(self) -> str:
        """The unit of speeds, rad/s where nothing else is known."""
        return self.unit or "rad/s"

    @property
    def factor(self) -> float:
        """What a speed [rad/s] is multiplied with to read in the unit."""
        return speeds.speed_factor(self.of_speeds)

    @property
    def of_frequencies(self) -> Words:
        """For frequencies: Hz, or rad/s of a line in rad/s and of equations of one's own."""
        return Words(speeds.frequency_unit(self.unit))

    def speed(self, speed: float, most: int = 6) -> str:
        """ "1500 rpm": six figures, or at ``most`` others."""
        known = speed if most == 6 else float(f"{speed * self.factor:.{most}g}") / self.factor
        return speeds.show_speed(known, self.of_speeds)

    def rounded(self, speed: float) -> str:
        """ "1234 rpm": four figures, as points of a grid deserve."""
        return speeds.rounded_speed(speed, self.of_speeds)

    def about(self, low: float, high: float | None = None) -> str:
        """ "1230 rpm", "1230 to 1250 rpm": three figures, of a speed that fluctuates; one of two that read alike."""
        return speeds.about_span(low, low if high is None else high, self.of_speeds)

    def ends(self, low: float, high: float) -> str:
        """ "300 rpm to 2400 rpm"."""
        return range_words(self.speed(low), self.speed(high))

    def over(self, low: float, high: float) -> str:
        """ "from 300 rpm to 2400 rpm", "at 1475 rpm" of a line that runs at one speed."""
        return f"at {self.speed(low)}" if low == high else f"from {self.ends(low, high)}"

    def barred(self, ranges: Sequence[tuple[float, float]], most: int = 4) -> str:
        """ "62.08 rpm to 73.08 rpm": so many figures, rounded outward, of ranges that are kept clear of."""
        return " and ".join(range_words(*(self.speed(end) for end in self._outward(one, most))) for one in ranges)

    def _outward(self, ends: tuple[float, float], most: int) -> tuple[float, float]:
        low, high = (float(f"{end * self.factor:.9g}") for end in ends)  # without what the change of units rounded
        return rounded_down(low, most) / self.factor, rounded_up(high, most) / self.factor

    def span(self, low: float, high: float, between: str = "to") -> str:
        """ "300 to 2400 rpm": four figures each."""
        return speeds.rounded_span(low, high, self.of_speeds, between)

    def ranges(self, ranges: Sequence[tuple[float, float]], digits: int = 6) -> str:
        """ "300 to 400 rpm, 500 rpm and 2 more stretches"."""
        return ranges_in_words(ranges, self.of_speeds, digits)

    def acceleration(self, low: float, high: float | None = None) -> str:
        """ "100 rpm/s", "5 to 10 rad/s²": four figures each, one of two that read alike."""
        return speeds.acceleration_span(low, low if high is None else high, self.of_speeds)

    def angle(self, angle: float, most: int = 3) -> str:
        """ "14.3°"."""
        return angle_words(angle, most)

    def order(self, order: float) -> str:
        """ "order 2", "order 0.9474"."""
        return order_words(order)

    def number(self, value: float, most: int = 4) -> str:
        """ "1890", "0.9474": never as a power of ten below 1e10."""
        return figures(value, most)

    def value(self, value: float, unit: str, digits: int = 4) -> str:
        """ "32.8 kN m/rad", of a value in SI; what is in rad/s is a frequency."""
        return in_words(value, unit, digits)

    def parameter(self, label: str, unit: str) -> QuantityAxis:
        """How a parameter reads, on axes and in sentences."""
        return parameter_axis(label, unit, self.unit)


HERTZ = Words("Hz")
"""For frequencies [rad/s], which read in Hz beside speeds of any unit."""

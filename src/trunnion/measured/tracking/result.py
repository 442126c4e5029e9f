"""What ``track_orders`` gives: amplitudes by order over the speed of a run, and how sure they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.measured.tracking.rotation import MeasuredRotation
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.units import figures

TWO_SIDED = 1.959963984540054
"""Standard deviations of an interval that holds 95 %."""
PRINTED = {"torque": "N m", "acceleration": "rad/s²", "speed": "rad/s"}
"""Units of kinds of channels, but for rotations."""


def unit_of(kind: str, largest: float) -> tuple[str, float]:
    """The unit in which amplitudes of a kind of channel read, up to the ``largest`` [SI], and its size."""
    if kind == "rotation":
        return ("mrad", 1e-3) if largest >= 1e-3 else ("µrad", 1e-6)
    return PRINTED.get(kind, ""), 1.0


@dataclass(frozen=True)
class OrderCut:
    """One order of one channel over speed.

    speed (window,) [rad/s]; amplitude (window,), complex; low and high (window,): an interval of 95 % of its size.
    """

    speed: Array
    amplitude: Complex
    low: Array
    high: Array


@labelled
class MeasuredOrders(Result):
    """Complex amplitudes by window, order and channel.

    Re[Y e^{iKφ}] with φ the mean rotation of the input, from the first pulse of the reference. Rotations are those of
    the shaft of each channel; the others are in SI units of their kind. ``deviation`` is the standard deviation of the
    real and of the imaginary part by noise, and by what windows miss of amplitudes that change within them
    (``curvature``); ``floor`` is what pitch errors leave beside it at every window alike.
    """

    time: Array = variable("window", "s", "of the middle")
    speed: Array = coordinate("window", "rad/s", "of the input", name="speed")
    order: Array = coordinate("order", "1", "cycles per turn of the input")
    channels: tuple[str, ...] = coordinate("channel")
    places: tuple[str, ...] = internal("of the line that channels show")
    kinds: tuple[str, ...] = variable("channel", "", "kind of signal")
    ratios: tuple[float, ...] = variable("channel", "1", "turns for one of the input")
    amplitude: Complex = variable("window order channel", "", "in SI of the kind")
    deviation: Array = variable("window order channel", "", "standard deviation of either part, by noise")
    curvature: Array = internal("the part of the deviation that windows miss (window, order, channel)")
    degree: int = internal("of the polynomials that amplitudes follow within a window")
    hidden: Flags = variable("order channel", "1", "1 where pitch errors of the wheel, or gravity, are in it too")
    floor: Array = variable("order channel", "", "rms amplitude that pitch errors leave, or what gravity adds")
    residual: Array = variable("window channel", "", "rms of what is not an order asked for")
    extreme: Array = variable("window channel", "", "largest size of a sampled signal, its mean counted")
    acceleration: float = attribute("of the input, the middle of all windows", "rad/s^2")
    window: int = attribute("turns")
    calibrated: bool = attribute("whether pitch errors are taken off")
    rotation: MeasuredRotation = internal("how the input turned")
    findings: tuple[Finding, ...] = internal("what to read first")
    unit: str = internal("that speeds are printed in")

    @property
    @computed(variable("window order channel", "", "half width of the interval of 95 % of the size, all counted"))
    def half_width(self) -> Array:
        """Half of the interval that holds the size of an amplitude with 95 % (window, order, channel)."""
        return np.asarray(TWO_SIDED * np.sqrt(self.deviation**2 + self.floor**2 / 2))

    def column(self, channel: str) -> int:
        """Where a channel stands.

        Raises
        ------
        InputError : there is none of this name.
        """
        if channel not in self.channels:
            raise InputError("is not a channel", key="channel", value=channel, remedy=nearest(channel, self.channels))
        return self.channels.index(channel)

    def row(self, order: float) -> int:
        """Where an order stands.

        Raises
        ------
        InputError : it was not tracked.
        """
        near = np.flatnonzero(np.abs(self.order - order) < 1e-6)
        if not len(near):
            known = ", ".join(f"{one:g}" for one in self.order)
            raise InputError("was not tracked", key="order", value=order, remedy=f"there are {known}")
        return int(near[0])

    def cut(self, order: float, channel: str) -> OrderCut:
        """One order of one channel over speed, with its interval.

        Raises
        ------
        InputError : no such channel or order.
        """
        k, c = self.row(order), self.column(channel)
        size = np.abs(self.amplitude[:, k, c])
        half = self.half_width[:, k, c]
        return OrderCut(self.speed, self.amplitude[:, k, c], np.maximum(size - half, 0.0), size + half)

    def twist(self, first: str, second: str) -> tuple[Complex, Array]:
        """Twist between two pickups (window, order) [rad of the second's shaft], and its standard deviation.

        The rotation of the first counts by the ratio of both shafts. What turns the shaft as a whole is not in it, nor
        its mean, which pulses do not show.

        Raises
        ------
        InputError : no such channel, or one that is not a rotation.
        """
        columns = [self.column(first), self.column(second)]
        for name, column in zip((first, second), columns, strict=True):
            if self.kinds[column] != "rotation":
                raise InputError("is not a rotation", key="channel", value=name, remedy="name two pulse trains")
        a, b = columns
        ratio = self.ratios[b] / self.ratios[a]
        spread = np.sqrt(self.deviation[:, :, b] ** 2 + (ratio * self.deviation[:, :, a]) ** 2)
        wheels = (self.floor[:, b] ** 2 + (ratio * self.floor[:, a]) ** 2) / 2
        twist = self.amplitude[:, :, b] - ratio * self.amplitude[:, :, a]
        return np.asarray(twist), np.asarray(np.sqrt(spread**2 + wheels))

    def largest(self, channel: str) -> list[tuple[float, float, float, float]]:
        """Order, largest size, its interval's half width, and its speed [rad/s], by order."""
        c, found = self.column(channel), []
        for k, order in enumerate(self.order.tolist()):
            size = np.abs(self.amplitude[:, k, c])
            if np.all(np.isnan(size)):
                continue
            at = int(np.nanargmax(size))
            found.append((order, float(size[at]), float(self.half_width[at, k, c]), float(self.speed[at])))
        return found

    def table(self) -> list[dict[str, object]]:
        """One row an order of a channel: largest size, interval, speed."""
        rows: list[dict[str, object]] = []
        for channel, kind in zip(self.channels, self.kinds, strict=True):
            for order, value, half, speed in self.largest(channel):
                unit, size = unit_of(kind, value)
                own = bool(self.hidden[self.row(order), self.column(channel)])
                rows.append(
                    {
                        "channel": channel,
                        "order": f"{order:g}",
                        "largest": f"{figures(value / size, 4)} {unit}".rstrip(),
                        "±": figures(half / size, 2),
                        "at": self.words.rounded(speed),
                        "wheel's too": "yes" if own else "",
                    }
                )
        return rows

    def plot(self, axes: Axes | None = None, *, channel: str = "") -> Axes:
        """Every order over speed with its interval; see ``pictures.measured.orders``."""
        return drawing(self, "plot")(self, axes, channel=channel)

    @property
    def headline(self) -> str:
        """What was tracked."""
        span = self.words.span(float(self.speed.min()), float(self.speed.max()))
        return (
            f"{counted(len(self.order), 'order')} of {counted(len(self.channels), 'channel')} in "
            f"{counted(len(self.speed), 'window')} of {counted(self.window, 'turn')}, {span}"
        )

    def _lines(self) -> Iterator[str]:
        yield self.headline
        for channel, kind in zip(self.channels, self.kinds, strict=True):
            parts = []
            for order, value, half, speed in self.largest(channel):
                unit, size = unit_of(kind, value)
                words = f"{figures(value / size, 4)} ± {figures(half / size, 2)} {unit}".rstrip()
                parts.append(f"order {order:g} {words} at {self.words.rounded(speed)}")
            yield f"  {channel}: {'; '.join(parts)}"

"""Recorders whose clocks differ: offset and drift from the rotation, which both saw.

A pulse train of another clock has times t' = t + a + b t. Where its shaft turns θ = r φ(t) + c, as it does on the
average of whole turns,

    θ(t') − r φ(t') ≈ c − r Ω(t') (a + b t'),

linear in the three: a run whose speed changes tells the offset a from the constant c, which is unknown in any case. A
mean twist that changes with the speed counts for an offset; so does nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trunnion.measured.signals.measurement import Channel, PulseTrain, SampledSignal
from trunnion.measured.tracking.rotation import RotationWindow
from trunnion.results.units import figures

ROUNDS = 6
LEAST_CHANGE = 0.1
"""Relative change of speed from which an offset is told from a constant angle."""


@dataclass(frozen=True)
class ClockCorrection:
    """t' = t + offset + drift·t of a clock, offset [s] and drift [-] with their standard deviations."""

    clock: str
    offset: float
    drift: float
    offset_deviation: float
    drift_deviation: float

    @property
    def knows_offset(self) -> bool:
        """Whether the speed changed enough to tell the offset."""
        return bool(np.isfinite(self.offset_deviation))

    def applied(self, channel: Channel) -> Channel:
        """The channel in the time of the reference."""
        if isinstance(channel, PulseTrain):
            made = replace(channel, times=(channel.times - self.offset) / (1 + self.drift), count=channel.number)
            for key in ("missing", "double"):
                object.__setattr__(made, key, getattr(channel, key))
            return made
        start = (channel.start - self.offset) / (1 + self.drift)
        made_signal: SampledSignal = replace(channel, start=start, rate=channel.rate * (1 + self.drift))
        return made_signal

    @property
    def sentence(self) -> str:
        """What was corrected."""
        drift = f"{figures(1e6 * self.drift, 4)} ± {figures(2e6 * self.drift_deviation, 2)} ppm"
        if not self.knows_offset:
            return (
                f"Clock {self.clock} runs {drift} fast; at one speed its offset is not known, nor are phases between "
                "its channels and the others."
            )
        offset = f"{figures(1e3 * self.offset, 4)} ± {figures(2e3 * self.offset_deviation, 2)} ms"
        return (
            f"Clock {self.clock} runs {drift} fast and is {offset} ahead, by the rotation; a mean twist that follows "
            "the speed would count as an offset."
        )


def clock_correction(train: PulseTrain, windows: tuple[RotationWindow, ...], ratio: float) -> ClockCorrection | None:
    """The correction of a train's clock; None where fewer than four windows hold its pulses."""
    offset = drift = 0.0
    found: ClockCorrection | None = None
    for _ in range(ROUNDS):
        times = (train.times - offset) / (1 + drift)
        rows = []
        for one in windows:
            first, last = np.searchsorted(times, (one.middle - one.half, one.middle + one.half))
            if last - first < 4:
                continue
            inside, own = one.local(times[first:last]), train.angle[first:last] - ratio * one.angle(times[first:last])
            # The value in the middle, of a straight line: the ends of a window need not be ends of turns of this shaft.
            middle = np.polynomial.polynomial.polyfit(inside, own, 1)[0]
            rows.append((middle, one.speed, one.middle))
        if len(rows) < 4:
            return found
        value, speed, at = np.array(rows).T
        changes = np.ptp(speed) > LEAST_CHANGE * speed.mean()
        columns = [np.ones(len(value)), -ratio * speed * at]
        if changes:
            columns.append(-ratio * speed)
        matrix = np.stack(columns, axis=1)
        scale = np.abs(matrix).max(axis=0)
        solved = np.linalg.lstsq(matrix / scale, value, rcond=None)[0]
        left = value - matrix @ (solved / scale)
        noise = float(left @ left) / max(len(value) - len(columns), 1)
        spread = np.sqrt(np.diag(np.linalg.inv((matrix / scale).T @ (matrix / scale))) * noise) / scale
        step = solved / scale
        drift += float(step[1])
        offset += float(step[2]) if changes else 0.0
        found = ClockCorrection(train.clock, offset, drift, float(spread[2]) if changes else np.inf, float(spread[1]))
    return found

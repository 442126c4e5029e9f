"""Errors of the pitch of wheels: from a reference run whose shafts turn without vibration at orders of the wheel."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array, Flags, Integers
from trunnion.errors import InputError
from trunnion.measured.signals.measurement import TURN, Measurement, PulseTrain
from trunnion.measured.tracking.rotation import SMOOTH, fitted, tooth_means, window_edges
from trunnion.results.counts import counted
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity
from trunnion.results.result import Result
from trunnion.results.units import figures

WINDOW = 4
"""Turns over which the speed of a reference run is taken as a cubic."""
ROUNDS = 40
SAME = 4.0
"""Standard deviations by which the two halves of a run may differ."""


@labelled
class PitchErrors(Result):
    """Pitch errors of the wheels of a bench.

    The wheel has turned by ``error`` more at the edge of a tooth than even teeth would have it; NaN beyond the teeth of
    a wheel.
    """

    channels: tuple[str, ...] = coordinate("channel")
    tooth: Array = coordinate("tooth")
    error: Array = variable("channel tooth", "rad", "rotation at the edge beyond that of even teeth")
    deviation: Array = variable("channel", "rad", "standard deviation of each, by the noise of the reference run")
    difference: Array = variable("channel", "1", "of the halves of the run, over what their noise explains")
    turns: Array = variable("channel", "1", "of the wheel that were averaged")
    low_speed: float = attribute("of the run", "rad/s")
    high_speed: float = attribute("of the run", "rad/s")
    unit: str = internal("of speeds in print")

    def of(self, train: PulseTrain) -> tuple[Array, float]:
        """Pitch errors (tooth,) [rad] of the wheel of a pulse train, and their standard deviation.

        Raises
        ------
        InputError : the reference run has no such channel, or another number of teeth.
        """
        if train.name not in self.channels:
            remedy = f"the reference run has {', '.join(self.channels)}"
            raise InputError("has no pitch errors", key="channel", value=train.name, remedy=remedy)
        row = self.channels.index(train.name)
        own = self.error[row][np.isfinite(self.error[row])]
        if len(own) != train.pulses_per_turn:
            raise InputError(
                f"is not the {len(own)} of the reference run", element=train.name, key="pulses_per_turn",
                value=train.pulses_per_turn, remedy="take the reference run with the same wheel",
            )  # fmt: skip
        return own, float(self.deviation[row])

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Wheels whose errors changed within the run: the shaft vibrated."""
        return tuple(
            Finding(
                Gravity.CAUTION,
                f"{name}: the two halves of the reference run differ by {figures(float(ratio), 2)} times their noise: "
                "the shaft vibrated at orders of the wheel; take it with the joints straight and without load.",
            )
            for name, ratio in zip(self.channels, self.difference, strict=True)
            if ratio > SAME
        )

    def _lines(self) -> Iterator[str]:
        span = self.words.span(self.low_speed, self.high_speed)
        yield f"pitch errors of {counted(len(self.channels), 'wheel')} from a reference run at {span}"
        for k, name in enumerate(self.channels):
            own = self.error[k][np.isfinite(self.error[k])]
            share = figures(100 * float(own.std()) * len(own) / TURN, 3)
            noise = figures(1e6 * float(self.deviation[k]), 2)
            yield f"  {name}: {share} % of the pitch of {len(own)} teeth (rms), each known to {noise} µrad"


def pitch_errors(reference: Measurement, *, unit: str = "rpm") -> PitchErrors:
    """Pitch errors of all wheels of a bench, from a run in which nothing vibrates at orders of the wheels.

    A run with the joints straight and without load is such a run. What does vibrate in it is taken for an error of the
    wheel; a run whose speed changes shows it, as a wheel's error does not change with the speed.

    Parameters
    ----------
    reference : the run; every pulse train is averaged over its turns.
    unit : of speeds in print.

    Raises
    ------
    InputError : no pulse train, or fewer than two windows of four turns.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> error = 1e-3 * np.sin(2 * np.pi * np.arange(30) / 30)
    >>> number = np.arange(30 * 40)
    >>> times = (2 * np.pi * number / 30 + error[number % 30]) / 100.0
    >>> found = tn.pitch_errors(tn.Measurement([tn.PulseTrain(times, 30, name="wheel")]))
    >>> bool(np.allclose(found.error[0], error, atol=1e-9))
    True
    """
    if not reference.pulses:
        raise InputError("has no pulse train", key="reference", remedy="pitch errors are those of wheels")
    most = max(one.pulses_per_turn for one in reference.pulses)
    error = np.full((len(reference.pulses), most), np.nan)
    deviation, difference, turns, speeds = [], [], [], []
    for row, train in zip(error, reference.pulses, strict=True):
        own, spread, ratio, whole, ends = _of(train)
        row[: len(own)] = own
        deviation.append(spread)
        difference.append(ratio)
        turns.append(whole)
        speeds += ends
    return PitchErrors(
        channels=tuple(one.name for one in reference.pulses), tooth=np.arange(most, dtype=float), error=error,
        deviation=np.array(deviation), difference=np.array(difference), turns=np.array(turns), low_speed=min(speeds),
        high_speed=max(speeds), unit=unit,
    )  # fmt: skip


def _of(train: PulseTrain) -> tuple[Array, float, float, float, list[float]]:
    """Errors, their deviation, difference of halves, turns, speeds."""
    windows = window_edges(train, WINDOW)
    if len(windows) < 2:
        raise InputError(
            f"has {figures(train.turns, 3)} turns", element=train.name, key="reference",
            remedy=f"record at least {2 * WINDOW}",
        )  # fmt: skip
    teeth = train.pulses_per_turn
    pattern, every_tooth, every_angle = np.zeros(teeth), train.tooth, train.angle
    # What a window's cubic takes of the pattern comes back in a few rounds.
    for _ in range(ROUNDS):
        residual: list[Array] = []
        tooth: list[Integers] = []
        part: list[Flags] = []
        speeds: list[float] = []
        for place, (first, last) in enumerate(windows):
            times, numbers = train.times[first:last], every_tooth[first:last]
            middle, half = (times[0] + times[-1]) / 2, (times[-1] - times[0]) / 2
            angle = every_angle[first:last]
            y = angle - angle[0] + pattern[numbers]
            found = fitted(y, (times - middle) / half, angle, np.zeros(0), SMOOTH, 0)
            if found is None:
                continue
            residual.append(found.residual)
            tooth.append(numbers)
            part.append(np.full(len(numbers), 2 * place < len(windows)))
            speeds.append(float(found.smooth[1] / half))
        values, numbers, early = np.concatenate(residual), np.concatenate(tooth), np.concatenate(part)
        step, count = tooth_means(values, numbers, teeth)
        step = np.nan_to_num(step)
        pattern = pattern - step
        pattern -= pattern.mean()
        if np.abs(step - step.mean()).max() < 1e-13:
            break
    left = values - np.nan_to_num(tooth_means(values, numbers, teeth)[0])[numbers]
    noise = float(np.sqrt(left @ left / max(len(left) - teeth - SMOOTH * len(windows), 1)))
    spread = noise / np.sqrt(max(float(count.min()), 1.0))
    halves = [tooth_means(values[chosen], numbers[chosen], teeth)[0] for chosen in (early, ~early)]
    apart = np.nan_to_num(halves[0] - halves[1])
    ratio = float(apart.std() / (2 * spread)) if spread > 0 else 0.0
    return pattern, spread, ratio, len(values) / teeth, [min(speeds), max(speeds)]

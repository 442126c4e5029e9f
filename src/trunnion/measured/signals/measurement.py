"""What a test bench records: pulses of encoders and gears, sampled signals, and both together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.arguments import one_number, whole_number
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.measured.signals.mended import mended
from trunnion.portable import Portable
from trunnion.results.counts import counted
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.units import figures

TURN = 2 * np.pi
USUAL_PITCH_ERROR = 0.02
MENDS = ("missing", "double", "doubtful", "swings")
"""What is known of the mending of a pulse train."""
"""Standard deviation of the position of an edge, as a share of the pitch, where nobody knows better."""


@dataclass(frozen=True)
class PulseTrain(Portable):
    """Times at which the teeth of a wheel pass a pickup, each with its number.

    Parameters
    ----------
    times : of the edges [s], rising (edge,).
    pulses_per_turn : of the wheel.
    name : of the channel.
    at : the disk of the line whose rotation it shows; "" where it is not said.
    pitch_error : standard deviation of the position of an edge as a share of the pitch [-]; what is not calibrated
        may hide an order behind it.
    reversed : the wheel turns against the sense that its pulses are counted in.
    clock : name of the recorder's clock; channels of one clock share their time.
    count : number of each edge since the first (edge,); default: found from the gaps, missing and double pulses
        mended.

    Raises
    ------
    InputError : times that do not rise or are not finite, fewer than two turns.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> times = np.delete(np.arange(400) / 600.0, 77)
    >>> wheel = tn.PulseTrain(times, 60, name="flywheel")
    >>> wheel.missing, wheel.double, int(wheel.number[-1])
    (1, 0, 399)
    """

    times: Array
    pulses_per_turn: int
    name: str = "pulses"
    at: str = ""
    pitch_error: float = USUAL_PITCH_ERROR
    reversed: bool = False
    clock: str = ""
    count: Integers | None = None
    number: Integers = field(init=False, repr=False)
    missing: int = field(init=False, default=0)
    double: int = field(init=False, default=0)
    doubtful: tuple[float, ...] = field(init=False, default=())
    swings: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        teeth = whole_number(self.pulses_per_turn, f"{self.name}.pulses_per_turn", 1)
        times = np.asarray(self.times, dtype=float)
        if times.ndim != 1 or not np.all(np.isfinite(times)):
            remedy = "give the times of the edges in seconds"
            raise InputError("must be one row of finite numbers", element=self.name, key="times", remedy=remedy)
        if np.any(np.diff(times) <= 0):
            at = int(np.argmax(np.diff(times) <= 0))
            remedy = "sort them, and take each once"
            raise InputError("must rise", element=self.name, key="times", value=float(times[at + 1]), remedy=remedy)
        if one_number(self.pitch_error, f"{self.name}.pitch_error") < 0 or self.pitch_error >= 0.5:
            raise InputError(
                "must be a share of the pitch from 0 to 0.5", element=self.name, key="pitch_error",
                value=self.pitch_error, remedy='write 0.02 or "2 %"',
            )  # fmt: skip
        if self.count is None:
            found = mended(times, teeth)
            number, times = found.number, times[found.kept]
            mends = {key: getattr(found, key) for key in MENDS}
        else:
            number, mends = np.asarray(self.count, dtype=np.int64), {}
        if len(times) < 2 or number[-1] - number[0] < 2 * teeth:
            raise InputError(
                f"holds less than two turns of {teeth} pulses", element=self.name, key="times", value=len(times),
                remedy="record longer, or correct pulses_per_turn",
            )  # fmt: skip
        for key, value in {"times": times, "number": number, **mends}.items():
            object.__setattr__(self, key, value)
        object.__setattr__(self, "count", number)

    @property
    def turns(self) -> float:
        """Turns of the wheel from the first edge to the last."""
        return float(self.number[-1] - self.number[0]) / self.pulses_per_turn

    @property
    def tooth(self) -> Integers:
        """Which tooth of the wheel each edge is, from 0."""
        return np.asarray(self.number % self.pulses_per_turn)

    @property
    def angle(self) -> Array:
        """Rotation of the wheel at each edge [rad], teeth taken as even."""
        return np.asarray(TURN * self.number / self.pulses_per_turn)

    def within(self, first: float, last: float) -> PulseTrain:
        """The edges between two times [s]; their teeth keep their numbers."""
        kept = (self.times >= first) & (self.times <= last)
        found = replace(self, times=self.times[kept], count=self.number[kept])
        for key in MENDS:
            object.__setattr__(found, key, getattr(self, key))
        return found


@dataclass(frozen=True)
class SampledSignal(Portable):
    """A signal at equal steps of time.

    Parameters
    ----------
    values : in SI units (sample,).
    rate : samples per second [Hz].
    name : of the channel.
    kind : "torque" [N m] of a spring, "acceleration" [rad/s²] or "speed" [rad/s] of a disk, or "other".
    at : the spring or disk of the line.
    start : time of the first sample [s].
    clock : as of ``PulseTrain``.
    gravity : what gravity adds once a turn of its shaft [rad/s²], g over the radius of a single tangential
        accelerometer on a horizontal shaft; 0 for a pair that stands opposite each other.

    Raises
    ------
    InputError : values that are not a row of numbers, a rate that is not positive, a kind that is not known.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> signal = tn.SampledSignal(np.sin(np.arange(100) / 10), 1000.0, name="gauge", kind="torque", at="front tube")
    >>> signal.duration
    0.1
    """

    values: Array
    rate: float
    name: str = "signal"
    kind: str = "other"
    at: str = ""
    start: float = 0.0
    clock: str = ""
    gravity: float = 0.0

    def __post_init__(self) -> None:
        if not one_number(self.rate, f"{self.name}.rate") > 0:
            raise InputError("must be positive", element=self.name, key="rate", value=self.rate, remedy="in Hz")
        if np.ndim(self.values) != 1 or not len(self.values):
            raise InputError("must be one row of numbers", element=self.name, key="values", remedy="one channel each")
        if self.kind not in SAMPLED:
            raise InputError(
                "is not a kind of sampled signal", element=self.name, key="kind", value=self.kind,
                remedy=nearest(self.kind, SAMPLED),
            )  # fmt: skip
        gaps = ~np.isfinite(self.values)
        if gaps.any():
            at = self.start + float(np.argmax(gaps)) / self.rate
            raise InputError(
                f"has no number in {counted(int(gaps.sum()), 'sample')}, the first at {at:.6g} s",
                element=self.name, key="values", remedy="cut the gap out, or read the parts on either side",
            )  # fmt: skip

    @property
    def duration(self) -> float:
        """Length [s]."""
        return len(self.values) / self.rate

    @property
    def times(self) -> Array:
        """Of the samples [s] (sample,)."""
        return np.asarray(self.start + np.arange(len(self.values)) / self.rate)

    @property
    def clipped(self) -> Flags:
        """Samples (sample,) that stand at the largest or smallest value together with both neighbours."""
        values = self.values
        at_end = (values == values.max()) | (values == values.min())
        flat = at_end.copy()
        flat[1:-1] &= at_end[:-2] & at_end[2:]
        flat[[0, -1]] = False
        return np.asarray(flat & (np.ptp(values) > 0))


SAMPLED = ("torque", "acceleration", "speed", "other")
Channel = PulseTrain | SampledSignal


@dataclass(frozen=True)
class Measurement(Portable):
    """Channels that were recorded together.

    Parameters
    ----------
    channels : ``PulseTrain`` and ``SampledSignal``, each with a name of its own.
    source : what it was read from, for messages.
    remarks : what to know about it, as sentences.

    Raises
    ------
    InputError : no channel, or two of one name.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> wheel = tn.PulseTrain(np.arange(1200) / 600.0, 60, name="flywheel")
    >>> print(tn.Measurement([wheel]))
    measurement of 1 channel
      flywheel: 1200 pulses, 60 a turn, 19.98 turns in 1.998 s
    """

    channels: Sequence[Channel]
    source: str = ""
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(self.channels))
        names = [one.name for one in self.channels]
        if not names:
            raise InputError("has no channel", element="measurement", key="channels", remedy="give one or more")
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise InputError(
                "is the name of two channels", element="measurement", key="name", value=twice, remedy="name each"
            )

    @property
    def pulses(self) -> tuple[PulseTrain, ...]:
        """Its pulse trains."""
        return tuple(one for one in self.channels if isinstance(one, PulseTrain))

    @property
    def sampled(self) -> tuple[SampledSignal, ...]:
        """Its sampled signals."""
        return tuple(one for one in self.channels if isinstance(one, SampledSignal))

    def channel(self, name: str) -> Channel:
        """The channel of a name.

        Raises
        ------
        InputError : there is none.
        """
        for one in self.channels:
            if one.name == name:
                return one
        known = [one.name for one in self.channels]
        raise InputError("is not a channel", key="channel", value=name, remedy=nearest(name, known))

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What was mended and what is doubtful, gravest first."""
        return by_gravity([*(Finding(Gravity.NOTE, one) for one in self.remarks), *self._doubts()])

    def _doubts(self) -> Iterator[Finding]:
        for one in self.pulses:
            yield from _mends(one)
        for signal in self.sampled:
            clipped = int(signal.clipped.sum())
            if clipped:
                share = figures(100 * clipped / len(signal.values), 2)
                yield Finding(
                    Gravity.CAUTION,
                    f"{signal.name} is clipped: {counted(clipped, 'sample')} ({share} %) stand at its largest or "
                    "smallest value; its orders are too small and have false harmonics.",
                )

    def __str__(self) -> str:
        lines = [f"measurement of {counted(len(self.channels), 'channel')}"]
        for one in self.channels:
            if isinstance(one, PulseTrain):
                took = figures(float(one.times[-1] - one.times[0]))
                lines.append(
                    f"  {one.name}: {len(one.times)} pulses, {one.pulses_per_turn} a turn, {figures(one.turns)} turns "
                    f"in {took} s"
                )
            else:
                lines.append(f"  {one.name}: {one.kind}, {figures(one.rate)} Hz over {figures(one.duration)} s")
        return "\n".join([*lines, *(f"  {finding}" for finding in self.findings)])


def _mends(one: PulseTrain) -> Iterator[Finding]:
    if not (one.missing or one.double):
        return
    parts = [(one.missing, "missing"), (one.double, "double")]
    words = " and ".join(f"{count} {what}" for count, what in parts if count)
    share = (one.missing + one.double) / max(int(one.number[-1] - one.number[0]), 1)
    gravity = Gravity.CAUTION if share > DOUBTFUL_SHARE else Gravity.NOTE
    every = one.missing / max(one.turns, 1.0)
    each_turn = one.missing > 1 and abs(every - round(every)) < 0.1 and round(every) > 0
    index = "; as many every turn: a wheel with a mark" if each_turn else ""
    if one.doubtful:
        places = ", ".join(figures(time, 4) for time in one.doubtful[:4]) + (" …" if len(one.doubtful) > 4 else "")
        yield Finding(
            Gravity.CAUTION,
            f"{one.name}: how many pulses are missing after {places} s cannot be told surely, and angles behind may be "
            "off by whole teeth; take what lies between such gaps.",
        )
    if one.swings:
        yield Finding(
            Gravity.CAUTION,
            f"{one.name}: its speed swings so far within a turn that slow pulses and missing ones look alike, and no "
            "turn is whole enough to tell them by: how many are missing is uncertain, angles may be off by teeth.",
        )
    yield Finding(gravity, f"{one.name}: {words} of {one.number[-1] - one.number[0] + 1} pulses mended{index}.")


DOUBTFUL_SHARE = 0.01
"""Share of mended pulses from which a pickup should be looked at."""


def even_times(values: ArrayLike, key: str) -> tuple[float, float]:
    """Start [s] and rate [Hz] of times (sample,) at equal steps.

    Raises
    ------
    InputError : there are none, some are not finite, or one is half a step or more from where equal steps have it.
    """
    times = np.asarray(values, dtype=float)
    if not len(times):
        raise InputError("holds no samples", key=key, remedy="record again")
    if len(times) < 2 or not np.all(np.isfinite(times)):
        raise InputError("is not a column of times", key=key, remedy="name another, or give rate")
    step = (times[-1] - times[0]) / (len(times) - 1)
    off = np.abs(np.diff(times) - step)
    if not step > 0 or off.max() > 0.5 * step:
        at = float(times[int(off.argmax())])
        raise InputError(
            "has steps that are not equal: there is a gap", key=key, value=at,
            remedy="cut the file there, or give the times of edges as kind = \"edges\"",
        )  # fmt: skip
    astray = np.abs(times - times[0] - step * np.arange(len(times)))
    if astray.max() > 0.5 * step:
        raise InputError(
            f"has steps that change: equal ones are {figures(float(astray.max()), 2)} s off at "
            f"{figures(float(times[int(astray.argmax())]), 5)} s", key=key,
            remedy="bring the samples to equal steps first",
        )  # fmt: skip
    return float(times[0]), float(1 / step)

"""How a run-up of a line that starts free ended, in numbers and in a sentence."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from trunnion.motion.simulation.strongest_order import StrongestOrder
from trunnion.results.counts import few
from trunnion.results.declared import Held, remarks
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import about_span, about_speed, frequency_unit, rounded_speed
from trunnion.results.units import order_words

WANDERS = 0.02
"""Change of the mean speed from turn to turn, relative, that shows a motion which does not repeat."""
BEYOND = 0.05
"""Share of the last speed by which a line may have passed it without a word."""


@dataclass(frozen=True)
class Hanging:
    """From ``since`` to ``until`` [s] a line stayed about ``speed`` [rad/s], though much more was asked for; in the
    later half of that its mean speed over a turn was between ``lowest`` and ``highest``."""

    since: float
    until: float
    speed: float
    lowest: float
    highest: float

    @property
    def duration(self) -> float:
        """How long [s]."""
        return self.until - self.since


@dataclass(frozen=True)
class Slip:
    """A clutch that let go: its name, by how many ``turns`` its ends left each other in all, and the mean speed [rad/s]
    that what is behind it has over the last turn, ``lost`` [rad/s] slower than without slip."""

    clutch: str
    turns: float
    speed: float
    lost: float


@dataclass(frozen=True)
class RunUpEnding:
    """How a line that starts free came to the speed it was run up to, or how a clutch let go.

    kind:

    - "reached": its own mean speed over a turn is within 1 % of the range of the last speed;
    - "captured": a resonance on the way holds it; the torque would do at the last speed;
    - "short of torque": loads and losses take all that the drives give, at the last speed too;
    - "stalled": it stopped turning;
    - "slipped": a clutch let go by more than a turn, so that what is behind it was not run up;
    - "undecided": it still gained speed when it was given up, or does one thing at one tolerance and another at
    another;
    - any other: what stopped the integration.

    time: when that was [s]; scheduled: when the last speed was asked for [s]; speed: own mean speed over the last turn
    [rad/s]; first, asked: the first and the last speed asked for [rad/s]; hanging: the longest stretch in which it
    gained less than a tenth of what was asked, None where there was none worth the name; strongest: what vibrated most
    in it; drive, load: torque of the drives at the end, and of the loads where it was captured or ended [N m at the
    input]; ways: the kinds at two tolerances, where they differ.
    """

    kind: str
    time: float
    scheduled: float
    speed: float
    first: float
    asked: float
    hanging: Hanging | None = None
    strongest: StrongestOrder | None = None
    drive: float = 0.0
    load: float = 0.0
    ways: tuple[str, str] | None = None
    slip: Slip | None = None

    @property
    def on_time(self) -> bool:
        """Whether the line reached the last speed when it was asked for, and hung nowhere."""
        return self.kind == "reached" and self.time <= self.scheduled and self.hanging is None

    def declared(self) -> Iterator[Held]:
        """When, how fast, and where it hung."""
        yield from remarks(ended=self.time, scheduled=self.scheduled, end_speed=self.speed)
        if self.hanging is not None:
            hung = self.hanging
            yield from remarks(hung_speed=hung.speed, hung_since=hung.since, hung_until=hung.until)
            yield from remarks(drive_torque=self.drive, load_torque=self.load)
        if self.slip is not None:
            yield from remarks(slipped=self.slip.clutch, slipped_turns=self.slip.turns, slipped_speed=self.slip.speed)
        if self.hanging is not None and self.strongest is not None:
            yield from remarks(hung_order=self.strongest.order, hung_mode=self.strongest.mode or None)

    def outcome(self, failed: Outcome, unit: str) -> Outcome:
        """The outcome, speeds in ``unit``; ``failed`` is the integration's, which counts where it did not get
        through."""
        if not failed.ok:
            return failed
        return Outcome(True, self.kind, self.sentence(unit))

    def sentence(self, unit: str) -> str:
        """What happened, why, and what to change."""
        asked = rounded_speed(self.asked, unit)
        if self.ways:
            one, other = (self._brief(kind, unit) for kind in self.ways)
            return (
                f"not decided whether it reaches {asked}: {one}, and at another tolerance {other}, so that it stands "
                "on the edge; accelerate faster"
            )
        if self.slip is not None:
            return (
                f"{self.slip.clutch} slipped by {self.slip.turns:.3g} turns: what is behind it turns at "
                f"{about_speed(self.slip.speed, unit)}, {about_speed(self.slip.lost, unit)} slower than without slip; "
                "raise its friction torque, or accelerate slower"
            )
        match self.kind:
            case "reached":
                return self._reached(asked, unit)
            case "captured":
                return self._captured(asked, unit)
            case "short of torque":
                return (
                    f"does not reach {asked}: at {about_speed(self.speed, unit)} loads ({self.load:.3g} N m at the "
                    f"input) and losses in joints and dampers take all of the {self.drive:.3g} N m that the drives "
                    "give, and would at the last speed too; accelerate faster, which makes the drives give more, or "
                    "lower joint angles or damping"
                )
            case "stalled":
                return (
                    f"stalled: the line stops turning before {asked}, at t = {self.time:.4g} s{self._excited()}; "
                    "start at a higher speed, accelerate faster, or lower the excitation"
                )
        return (
            f"not decided whether it reaches {asked}: {self.time - self.scheduled:.3g} s after it was asked for the "
            f"line turns at {about_speed(self.speed, unit)} and still gains speed; accelerate faster"
        )

    def _brief(self, kind: str, unit: str) -> str:
        """A kind in three words."""
        return {
            "reached": "it does",
            "captured": f"it is captured at {about_speed(self.hung_speed, unit)}",
            "stalled": "it stalls",
            "short of torque": "the torque is too small",
        }.get(kind, "it still gains speed")

    @property
    def hung_speed(self) -> float:
        """Where it hung [rad/s]; at the end its own speed, or that behind a clutch that let go."""
        if self.slip is not None:
            return self.slip.speed
        return self.hanging.speed if self.hanging else self.speed

    def _reached(self, asked: str, unit: str) -> str:
        late = self.time - self.scheduled
        after = f", {late:.3g} s later than asked" if late > 0 else ""
        if (self.speed - self.asked) * (self.asked - self.first) > 0 and abs(self.speed / self.asked - 1) > BEYOND:
            after = f", and went on to {about_speed(self.speed, unit)}"
        if not self.hanging:
            return f"reached {asked} at t = {self.time:.4g} s{after}"
        return (
            f"hung at {about_speed(self.hanging.speed, unit)} for {self.hanging.duration:.3g} s{self._excited()}, then "
            f"passed; reached {asked} at t = {self.time:.4g} s{after}"
        )

    def _captured(self, asked: str, unit: str) -> str:
        at, strongest = about_speed(self.hung_speed, unit), self.strongest
        shaken, damped, lower = "vibration takes what should accelerate it", "the line", "what excites it"
        if strongest is not None:
            shaken = f"{order_words(strongest.order)}{_of(strongest.sources)} shakes {_mode(strongest, unit)}"
            damped, lower = strongest.spring, f"what excites {order_words(strongest.order)}"
        since, free = "", ""
        if self.hanging is not None:
            since = f" from t = {self.hanging.since:.3g} s to the end at {self.time:.4g} s"
            if self.hanging.highest > (1 + WANDERS) * self.hanging.lowest:
                span = about_span(self.hanging.lowest, self.hanging.highest, unit)
                free = f", wandering from {span}, so that it may come free by itself"
        return (
            f"captured at {at}, short of {asked}: {shaken}, and the line gains no speed{since}{free}; of the "
            f"{self.drive:.3g} N m that the drives give at the input the loads take {self.load:.3g} N m there, "
            f"vibration the rest; accelerate faster, damp {damped} more, or lower {lower}"
        )

    def _excited(self) -> str:
        """The order that vibrated, in brackets; nothing where it is not known."""
        if self.strongest is None:
            return ""
        return f" ({order_words(self.strongest.order)}{_of(self.strongest.sources)})"


def _of(sources: tuple[str, ...]) -> str:
    named = " and ".join(sources) if len(sources) == 2 else few(sources)
    return f" of {named}" if named else ""


def _mode(strongest: StrongestOrder, unit: str) -> str:
    """The mode in words, or the spring and frequency where none is near."""
    shown = frequency_unit(unit)
    if not strongest.mode:
        return f"{strongest.spring} at {about_speed(strongest.frequency, shown)}"
    return f"mode {strongest.mode} ({rounded_speed(strongest.mode_frequency, shown)})"

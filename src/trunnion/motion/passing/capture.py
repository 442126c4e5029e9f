"""Does a free–free line reach the speed it is run up to, or does a resonance hold it?

Its drives give the torque that the schedule asks for, whatever the line does: what balances the loads at the speed
asked for, and what accelerates the inertia. A resonance takes power from the rotation, the more the longer the line
stays near it, and may take all that accelerates: the line then hangs below it while the schedule goes on (Sommerfeld's
effect).

A line that is behind at the end of the schedule is therefore followed further, its drives holding their last torque,
until it either reaches the speed or gains no more. Then the same torque is tried on the line at the speed it should
have reached: if it keeps that, a resonance on the way is what holds the line, and otherwise the torque is too small.

A. Sommerfeld, Z. VDI 46 (1902) 391; V. O. Kononenko, *Vibrating Systems with a Limited Power Supply* (1969).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.line_system import line_system
from trunnion.equations.loads import load_at_input
from trunnion.equations.speed_profile import SpeedProfile
from trunnion.errors import InputError
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.motion.passing.schedule import SpeedSchedule
from trunnion.motion.simulation.input_rotation import TURN, InputRotation
from trunnion.motion.simulation.simulate import prolonged, simulate_line
from trunnion.motion.simulation.simulation import LineSimulation
from trunnion.motion.simulation.strongest_order import StrongestOrder, strongest_order
from trunnion.results.counts import few
from trunnion.results.outcome import Outcome
from trunnion.results.speeds import about_span, about_speed, frequency_unit, rounded_speed
from trunnion.results.units import order_words
from trunnion.results.variables import Attribute, attributes
from trunnion.waiting import time_is_up

WANDERS = 0.02
"""Change of the mean speed from turn to turn, relative, that shows a motion which does not repeat."""
BEYOND = 0.05
"""Share of the last speed by which a line may have passed it without a word."""
CLOSE = 0.01
"""Share of the speed range by which a line that has reached the last speed may be behind it."""
STOPPED, STANDING = 0.02, 1e-3
"""Share of the lower end of the range below which a line no longer turns, and of its way that it need not have made
when it is said to stand."""
LOOKS = 4
"""Mean speeds a turn."""
FEWEST_TURNS, DECAYS = 30, 10.0
"""A line is followed at its last torque for so many turns, and so many times as long as its vibration takes to decay,
before it is asked whether it still gains speed."""
PATIENCE = 4.0
"""Durations of the schedule within which the last speed must be in sight."""
WANDERING, WANDERING_TURNS = 2.0, 200
"""A motion that does not repeat may come free by itself: it is watched for so many durations of the schedule and turns
more."""
SLOW, HUNG = 0.1, 0.1
"""A line hangs while it gains less than this share of what is asked, and while this share of the range is asked."""
HANGING_TURNS = 5.0
"""Fewer are a swing of the rotation."""
FELL = 0.5
"""Share of the way from the last speed back to where a line hangs, fallen under its torque, that shows it too small."""


@dataclass(frozen=True)
class SpeedCapture:
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
class ClutchSlip:
    """A clutch that let go: its name, by how many ``turns`` its ends left each other in all, and the mean speed [rad/s]
    that what is behind it has over the last turn, ``lost`` [rad/s] slower than without slip."""

    clutch: str
    turns: float
    speed: float
    lost: float


@dataclass(frozen=True)
class RunUpEnding:
    """How a free–free line came to the speed it was run up to, or how a clutch let go.

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
    hanging: SpeedCapture | None = None
    strongest: StrongestOrder | None = None
    drive: float = 0.0
    load: float = 0.0
    ways: tuple[str, str] | None = None
    slip: ClutchSlip | None = None

    @property
    def on_time(self) -> bool:
        """Whether the line reached the last speed when it was asked for, and hung nowhere."""
        return self.kind == "reached" and self.time <= self.scheduled and self.hanging is None

    def declared(self) -> Iterator[Attribute]:
        """When, how fast, and where it hung."""
        yield from attributes(ended=self.time, scheduled=self.scheduled, end_speed=self.speed)
        if self.hanging is not None:
            hung = self.hanging
            yield from attributes(hung_speed=hung.speed, hung_since=hung.since, hung_until=hung.until)
            yield from attributes(drive_torque=self.drive, load_torque=self.load)
        if self.slip is not None:
            yield from attributes(
                slipped=self.slip.clutch, slipped_turns=self.slip.turns, slipped_speed=self.slip.speed
            )
        if self.hanging is not None and self.strongest is not None:
            yield from attributes(hung_order=self.strongest.order, hung_mode=self.strongest.mode or None)

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


def run_to_the_end(
    run: LineSimulation, schedule: SpeedSchedule, extra: float, tolerance: float
) -> tuple[LineSimulation, RunUpEnding]:
    """A scheduled ``run`` of a free–free line, prolonged as far as its ending takes, and the ending.

    ``extra`` [N m at the input]: what its drives give from the first speed on beyond loads and inertia.
    """
    drive = extra + schedule.sense * schedule.acceleration * _inertia(run)
    run, kind = _followed(run, schedule, drive, tolerance)
    if kind == "hanging":
        kept = _keeps_the_last_speed(run, schedule, drive, tolerance)
        kind = "undecided" if time_is_up() else "captured" if kept else "short of torque"
    return run, _ending(kind, run, schedule, drive)


def slipped(run: LineSimulation, schedule: SpeedSchedule) -> RunUpEnding | None:
    """The ending of a scheduled run in which a clutch let go by more than a turn; None where none did."""
    clutches = sorted({slider.compliance for slider in run.line.sliders})
    if not clutches:
        return None
    since, speed = run.whole.last_turn()
    twist = run.motion_at(np.array([0.0, since, run.end])).twist
    turns = np.abs(twist[2] - twist[0])[clutches] / TURN
    worst = clutches[int(np.argmax(turns))]
    if turns.max() < 1.0:
        return None
    topo = run.line.assembly.topology
    ratio = float(topo.mean_speeds[topo.reference[topo.compliances[worst].far_group]])
    place = topo.coordinate[topo.compliances[worst].far_group]
    states = run.at(np.array([since, run.end]))[:, place]
    asked = float(schedule.profile.angle(run.end) - schedule.profile.angle(since)) / (run.end - since)
    own = ratio * asked + float(states[1] - states[0]) / (run.end - since)
    slip = ClutchSlip(run.shafts[worst], float(turns.max()), abs(own), abs(ratio) * asked - abs(own))
    return RunUpEnding("slipped", run.end, schedule.duration, speed, schedule.first, schedule.last, slip=slip)


def _followed(
    run: LineSimulation, schedule: SpeedSchedule, drive: float, tolerance: float
) -> tuple[LineSimulation, str]:
    """The run until it reaches the last speed, hangs, stops, or is given up; and which of these."""
    if not run.outcome.ok:
        return run, run.outcome.kind
    if _stopped(run.whole, schedule, run.whole.last_turn()[0]):
        return run, "stalled"
    if _behind(run.whole, schedule) <= CLOSE * schedule.range:
        return run, "reached"
    span = _span(run, schedule)
    while True:
        begun = run
        run = prolonged(begun, span, drive, tolerance=tolerance)
        if not run.outcome.ok:
            return run, run.outcome.kind
        times, speeds = mean_speeds(run.whole, begun.end)
        there = times[schedule.sense * (speeds - schedule.last) >= -CLOSE * schedule.range]
        if len(there):
            return prolonged(begun, float(there[0]) - begun.end, drive, tolerance=tolerance), "reached"
        if _stopped(run.whole, schedule, begun.end) or not len(speeds):
            return run, "stalled"
        gain, left = schedule.sense * _gain(times, speeds), schedule.sense * (schedule.last - float(speeds[-1]))
        since = run.end - schedule.duration
        watched = since >= WANDERING * schedule.duration and since * float(speeds.mean()) >= WANDERING_TURNS * TURN
        if left > PATIENCE * schedule.duration * gain and (watched or not wanders(speeds)):
            return run, "hanging"
        if since > PATIENCE * schedule.duration + 2 * span and watched:
            return run, "undecided"
        span *= 2


def mean_speeds(turning: InputRotation, since: float) -> tuple[Array, Array]:
    """Times [s] after ``since``, some in every turn, and the mean speed [rad/s] of the turn before each."""
    first = max(float(turning.angle(since)[0]), TURN)
    angles = np.arange(first, turning.furthest, TURN / LOOKS)[1:]
    times = turning.times_at(angles)
    return times, TURN / (times - turning.times_at(angles - TURN))


def wanders(speeds: Array) -> bool:
    """Whether the later half of mean speeds (m,) [rad/s] still changes from turn to turn."""
    later = speeds[len(speeds) // 2 :]
    return bool(np.ptp(later) > WANDERS * later.mean())


def longest_hanging(times: Array, speeds: Array, schedule: SpeedSchedule) -> SpeedCapture | None:
    """The longest stretch in which the mean speed gained less than a tenth of what was asked, where that is at least a
    tenth of the range and several turns; None without."""
    asked = schedule.continued(times)
    level = schedule.sense * (speeds - SLOW * asked)
    lowest = np.minimum.accumulate(level[::-1])[::-1]
    best, until = None, 0
    for since in range(len(times)):
        while until < len(times) and lowest[until] <= level[since]:
            until += 1
        last = until - 1  # the last place that is not above this one
        gained = abs(float(asked[last] - asked[since])) if last > since else 0.0
        if gained >= HUNG * schedule.range and (best is None or times[last] - times[since] > best.duration):
            within = speeds[since : last + 1]
            best = SpeedCapture(float(times[since]), float(times[last]), float(within.mean()), *_range(within))
    return best if best is not None and best.duration * best.speed >= HANGING_TURNS * TURN else None


def _ending(kind: str, run: LineSimulation, schedule: SpeedSchedule, drive: float) -> RunUpEnding:
    """The ending with what hung and vibrated."""
    assembly, speed = run.line.assembly, run.whole.last_turn()[1]
    end = run.end
    if kind == "stalled":  # where it stood furthest
        end = float(run.whole.times_at(np.array([(1 - STANDING) * run.whole.furthest]))[0])
    found = RunUpEnding(kind, end, schedule.duration, speed, schedule.first, schedule.last)
    if not run.outcome.ok:
        return found
    times, speeds = mean_speeds(run.whole, 0.0)
    hanging = longest_hanging(times, speeds, schedule)
    if kind == "captured":
        behind = times >= schedule.duration
        since = hanging.since if hanging else schedule.duration
        hanging = SpeedCapture(since, run.end, float(speeds[behind].mean()), *_range(speeds[behind]))
    at = hanging.speed if hanging and kind == "captured" else max(speed, 0.0)
    column = assembly.packed.column
    last, load = (float(load_at_input(assembly.topology, column, assembly.table(1, w))[0]) for w in (schedule.last, at))
    strongest = strongest_order(run, hanging.since, hanging.until) if hanging else None
    return replace(found, hanging=hanging, strongest=strongest, drive=last + drive, load=load)


def _range(speeds: Array) -> tuple[float, float]:
    """Lowest and highest of the later half of mean speeds (m,)."""
    later = speeds[len(speeds) // 2 :]
    return float(later.min()), float(later.max())


def _inertia(run: LineSimulation) -> float:
    """The whole inertia at the input [kg m²], were the line rigid and its joints straight."""
    assembly = run.line.assembly
    co = run.line.untwisted(assembly.table(1, run.profile.speed[0]))
    return float(co.inertia[0] @ assembly.topology.mean_speeds**2)


def _behind(turning: InputRotation, schedule: SpeedSchedule) -> float:
    """By how much the input turned slower than asked over its last turn [rad/s]; faster, where it runs down."""
    since, speed = turning.last_turn()
    asked = float(schedule.profile.angle(turning.end) - schedule.profile.angle(since)) / (turning.end - since)
    return schedule.sense * (asked - speed)


def _stopped(turning: InputRotation, schedule: SpeedSchedule, since: float) -> bool:
    """Whether a line has hardly turned since a time, or back."""
    low, high = (float(a) for a in turning.angle([since, turning.end]))
    return high - low <= STOPPED * min(schedule.first, schedule.last) * (turning.end - since)


def _span(run: LineSimulation, schedule: SpeedSchedule) -> float:
    """Seconds in which vibration has settled and many turns are made."""
    turns = FEWEST_TURNS * TURN / max(run.whole.last_turn()[1], STOPPED * schedule.first)
    try:
        modes = natural_frequencies(run.line.assembly)
        decay = [float(rate) for rate in modes.decay_rate[modes.still :].ravel() if rate > 0]
    except InputError:  # no linear line, by play or friction
        decay = []
    settled = DECAYS / min(decay) if decay else np.inf
    return max(turns, min(settled, schedule.duration))


def _gain(times: Array, speeds: Array) -> float:
    """Mean acceleration [rad/s²], from the first to the last third."""
    third = max(len(times) // 3, 1)
    apart = times[-third:].mean() - times[:third].mean()
    return float((speeds[-third:].mean() - speeds[:third].mean()) / apart) if apart > 0 else 0.0


def _keeps_the_last_speed(run: LineSimulation, schedule: SpeedSchedule, drive: float, tolerance: float) -> bool:
    """Whether the torque under which a line hangs, put on it at the last speed, keeps it well above where it hangs."""
    assembly, span = run.line.assembly, _span(run, schedule)
    way = abs(schedule.last - run.whole.last_turn()[1])
    tried = simulate_line(
        assembly, span, speed=SpeedProfile([0.0, span], [schedule.last, schedule.last]), drive=drive,
        start=line_system(assembly, schedule.last).twisted(), tolerance=tolerance,
    )  # fmt: skip
    since = 0.0
    while tried.outcome.ok and tried.end < (1 + PATIENCE) * schedule.duration + 2 * span:
        times, speeds = mean_speeds(tried.whole, since)
        if not len(times):
            return False
        fallen, falling = schedule.sense * (schedule.last - float(speeds[-1])), -schedule.sense * _gain(times, speeds)
        if fallen >= FELL * way:
            return False
        if FELL * way - fallen > PATIENCE * schedule.duration * falling:
            return True
        since, span = tried.end, 2 * span
        tried = prolonged(tried, span, drive, tolerance=tolerance)
    return False

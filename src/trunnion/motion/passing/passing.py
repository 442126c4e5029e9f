"""``passing``: does a line come from one speed to another under its torques, or does a resonance capture it?

The torques are those of the drives, whatever they were asked for: a motor's curve, a table, a constant. A line that
turns freely gives some of it to what vibrates, near a resonance the more the slower it passes, and may hang there
(Sommerfeld's effect; with an angled joint at half of a mode's frequency too, for it shakes twice a turn).

It has passed when its mean rotation, Σ Jρφ/Σ Jρ², first has the last speed. It is followed in stretches of many turns,
of several times what its vibration takes to decay, and of a tenth at least of the time in which the rigid line would be
there. It is captured where its mean speed has settled: where each of the last stretches gains so little that it would
take another twenty times the rigid time at least, what acts having come to its last point in time.

A. Sommerfeld, Z. VDI 46 (1902) 391; V. O. Kononenko, *Vibrating Systems with a Limited Power Supply* (1969).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.arguments import one_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.applied_torques import placed_frictions, placed_torques, time_knots
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem
from trunnion.errors import InputError
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.motion.passing.passing_result import Passing, PassingEnd
from trunnion.motion.passing.quick_passage import LOOKS, QuickPassage, is_quick
from trunnion.motion.passing.rigid import rigid_time
from trunnion.motion.passing.start import begun_line, ends_of, lasting
from trunnion.motion.simulation.input_rotation import TURN
from trunnion.motion.simulation.strongest_order import strongest_order
from trunnion.motion.transients.place import Place
from trunnion.motion.transients.prepare import Actions, follow, require_begun, stepper_of
from trunnion.motion.transients.result import Transient
from trunnion.motion.transients.stepping import Stepper
from trunnion.numerics.integration.integration import MOST_STEPS
from trunnion.steady.shooting.integration_outcomes import OUT_OF_TIME
from trunnion.waiting import keeps_time, time_is_up

DWELT = 3.0
"""Times the rigid line's time beyond which a line has dwelt."""
FEWEST_TURNS, DECAYS, SHARE = 40, 4.0, 0.1
"""Of a stretch: turns at the speed it has, times that the slowest mode takes to decay by e, and rigid times."""
FAR = 20.0
"""Rigid times that a captured line would take at the rate at which it still gains speed."""
STRETCHES = 3
"""The last ones that must all be so."""
LONGEST = 60.0
"""Rigid times, and as many stretches, after which it is not decided."""
PLAINLY = 0.3
"""Share of the rigid line's mean acceleration that a line which passes plainly gains at least, from look to look."""
LOOSER = 30.0
"""How much looser the tolerance of a second run is, whose ending must be the same."""


@keeps_time
def passing(
    line: Driveline | Assembly,
    speeds: Sequence[float | str],
    *,
    torque: Sequence[AppliedTorque] = (),
    friction: Sequence[FrictionTorque] = (),
    scenario: Scenario | str | None = None,
    phase: float = 0.0,
    tolerance: float = 1e-9,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Passing:
    """Whether a free–free line comes from one speed to another under its torques.

    Parameters
    ----------
    line : a ``Driveline`` (or its ``Assembly``) without a ConstantSpeed.
    speeds : the first and the last [rad/s] of its input, numbers or texts with a unit; from 0, rising.
    torque : what drives it, and what acts besides; tables over time last beyond their ends. A Motor of the line drives
        by its own curve.
    friction : dry friction on its disks.
    scenario : instead of both, a scenario or the name of one of the line's, whose torques and friction act.
    phase : angle [rad] of the input when it begins; whether a line passes may depend on it.
    tolerance : error allowed per step. A second run at thirty times as much must end alike, or nothing is decided.
    within : seconds of computing after which it ends undecided.
    progress : called as progress(share of the way made that lies between the speeds, over both runs).

    Returns
    -------
    Passing: ``outcome.kind`` is "passed", "dwelt" (passed, in more than three times the time of the rigid line under
    the same torques), "captured", "short of torque" (the rigid line would not come there either) or "undecided".

    Raises
    ------
    InputError : a ConstantSpeed; speeds that do not rise; no torque; what ``transient`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
    >>> line = tn.Driveline([disks[0], tn.HookeJoint(angle="15 deg"), tn.Shaft(stiffness=2e3, damping=1.0), disks[1]])
    >>> weak = tn.AppliedTorque(on="motor", time=[0], torque=[2.0], between="steps")
    >>> tn.passing(line, (10.0, 40.0), torque=[weak]).outcome.kind
    'captured'
    """
    description = line.line if isinstance(line, Assembly) else line
    first, last = ends_of(speeds)
    asked = lasting(line, torque, friction, scenario)
    prepared, acting = begun_line(description, asked, first)
    angle, rigid = one_number(phase, "phase", "np.pi / 2, say"), rigid_time(prepared, acting, first, last)
    made = _Follower(prepared, acting, first, last, angle, rigid)
    report_progress = progress or (lambda share: None)
    made.progress = lambda way: report_progress(way / 2)
    run, kind = made.ending(tolerance)
    require_begun(run.outcome, run.pieces)
    made.progress = lambda way: report_progress((1 + way) / 2)
    other = made.other_kind(kind, tolerance)
    report_progress(1.0)
    return _result(description, made, run, kind, other, tolerance)


def passing_kinds(
    prepared: LineSystem, asked: Actions, first: float, last: float, phases: Array, rigid: float, tolerance: float
) -> list[str]:
    """The kinds of ending alone, from every starting phase [rad], each as ``passing`` has it."""
    made = _Follower(prepared, asked, first, last, 0.0, rigid)
    found = []
    for phase in phases:
        made.phase = float(phase)
        kind, plainly = made.kind(tolerance)
        sure = plainly or _alike(kind, made.other_kind(kind, tolerance))
        found.append(kind if sure else "undecided")
    return found


def _alike(kind: str, other: str) -> bool:
    return kind == other or {kind, other} <= {"passed", "dwelt"}


class _Follower:
    """A line on its way from ``first`` to ``last`` [rad/s], which takes a rigid one ``rigid`` [s]."""

    def __init__(self, line: LineSystem, asked: Actions, first: float, last: float, phase: float, rigid: float) -> None:
        self.line, self.asked, self.first, self.last, self.phase, self.rigid = line, asked, first, last, phase, rigid
        knots = time_knots(placed_torques(line.assembly, asked[0]), placed_frictions(line.assembly, asked[1]))
        self.progress: Callable[[float], None] = lambda way: None
        self.steppers: dict[float, Stepper] = {}
        self.steady = float(max(knots, default=0.0)) if np.isfinite(rigid) else 0.0
        try:
            modes = natural_frequencies(line.assembly)
            known = [(float(z), float(w)) for z, w in zip(modes.damping_ratio, modes.frequency, strict=True) if w > 0]
        except InputError:  # no linear line, by play or friction
            known = []
        self.decay = max((1 / (z * w) for z, w in known if z > 0), default=0.0)
        slow = [w for _, w in known]
        self.usual = self.rigid if np.isfinite(self.rigid) else 200 * TURN / min(slow, default=1.0)

    def ending(self, tolerance: float) -> tuple[Transient, str]:
        """The run, and how it ended."""
        way = _WholeWay(self, tolerance)
        kind = self._judged(way)
        assert way.run is not None
        return way.run, kind

    def kind(self, tolerance: float) -> tuple[str, bool]:
        """How it ends, without the motion, by compiled stretches where nothing switches; and whether it passes so
        plainly that no other tolerance could end otherwise.

        Beside the edge of capture the motion comes near the one that neither passes nor is caught, gains nothing there,
        and leaves it by e in a time that is not shorter than some periods of the mode. From a distance of its error
        that takes over a dozen of these, which looks of a few turns see.
        """
        if tolerance not in self.steppers:
            self.steppers[tolerance] = stepper_of(self.line, self.asked, tolerance)
        stepper = self.steppers[tolerance]
        if is_quick(stepper):
            begun = stepper.with_lags(Place(0.0, self.start(), angle=self.phase, speed=self.first))
            way = QuickPassage(stepper, begun.state, self.phase, self.first, self.last, tolerance)
            if way.fits and (kind := self._judged(way)):
                usual = (self.last - self.first) / self.rigid
                return kind, kind == "passed" and way.gained > PLAINLY * usual
        return self.ending(tolerance)[1], False

    def start(self) -> Array:
        """The state that it begins with."""
        state = self.line.rest(self.phase)
        if self.first == 0:
            n = self.line.assembly.topology.size
            state[n : 2 * n] = 0.0
        return np.asarray(state)

    def _judged(self, way: _WholeWay | QuickPassage) -> str:
        """How it ends; "" for what a quick passage cannot follow."""
        stretches: list[tuple[float, float, float]] = []
        unsteady = 0  # stretches in which what acts still changes over time: nothing has settled there
        while True:
            speed = max(abs(float(stretches[-1][1] if stretches else self.first)), 0.1 * self.last)
            length = max(FEWEST_TURNS * TURN / speed, DECAYS * self.decay, SHARE * self.usual)
            since = way.time
            ended, mean, highest = way.on(length)
            if ended != "reached":
                break
            if time_is_up():
                return "undecided"
            stretches.append((way.time - since, mean, highest))
            self.progress(float(np.clip((highest - self.first) / (self.last - self.first), 0.0, 1.0)))
            if since < self.steady:
                unsteady = len(stretches)
            if self._settled(stretches[unsteady:]):
                return "captured" if np.isfinite(self.rigid) else "short of torque"
            if way.time > LONGEST * self.usual and len(stretches) > LONGEST:
                return "undecided"
        if ended == "crossed":
            return "dwelt" if way.time > DWELT * self.rigid else "passed"
        return "" if ended == "other" and isinstance(way, QuickPassage) else "undecided"

    def other_kind(self, kind: str, tolerance: float) -> str:
        """How it ends at a looser tolerance; as it did where there is no time for that."""
        return kind if time_is_up() else self.kind(min(LOOSER * tolerance, 1e-3))[0]

    def _settled(self, stretches: list[tuple[float, float, float]]) -> bool:
        """Whether the last stretches gain too little ever to come to the last speed."""
        if len(stretches) <= STRETCHES:
            return False
        for before, behind in zip(stretches[-STRETCHES - 1 :], stretches[-STRETCHES:], strict=False):
            way = self.last - behind[2]
            rate = max(behind[1] - before[1], behind[2] - before[2], 0.0) / ((before[0] + behind[0]) / 2)
            if rate * FAR * self.usual > way:
                return False
        return True


class _WholeWay:
    """The same with the whole motion kept."""

    def __init__(self, made: _Follower, tolerance: float) -> None:
        self.made, self.tolerance = made, tolerance
        self.run: Transient | None = None
        self.begun = Place(0.0, made.start(), angle=made.phase, speed=made.first)

    @property
    def time(self) -> float:
        """Where it stands [s]."""
        return self.run.end if self.run else 0.0

    def on(self, length: float) -> tuple[str, float, float]:
        """Go on for ``length`` [s]: how that ended, mean speed, and highest mean speed of a look [rad/s]."""
        since, made, asked = self.time, self.made, self.made.asked
        place = self.run.place if self.run else self.begun
        found = follow(made.line, place, length, asked, self.tolerance, MOST_STEPS, made.last)
        if self.run is None and found.outcome.kind != OUT_OF_TIME:
            require_begun(found.outcome, found.pieces)
        more = Transient.of(made.line, found, asked, self.tolerance, place.time, "", made.line.assembly.line)
        run = self.run = more if self.run is None else self.run.joined(more)
        if run.outcome.kind != "reached":
            return run.outcome.kind, np.nan, np.nan
        times = np.linspace(since, run.end, LOOKS + 1)
        means = np.diff(run.whole.angle(times)) / np.diff(times)
        return "reached", float(means.mean()), float(means.max())


def _result(
    description: Driveline, made: _Follower, run: Transient, kind: str, other: str, tolerance: float
) -> Passing:
    hung = _slowest(made, run)
    since, until = hung
    strongest = strongest_order(run, since, until)
    angle = run.whole.angle(np.array([since, until]))
    speed = float((angle[1] - angle[0]) / (until - since))
    ways = None if _alike(kind, other) else (kind, other)
    end = PassingEnd(
        kind="undecided" if ways else kind,
        time=run.end,
        rigid=made.rigid,
        first=made.first,
        last=made.last,
        speed=speed,
        stretch=(since, until),
        strongest=strongest,
        ways=ways,
    )
    return Passing(
        ending=end, peak_torque=run.peak_torque, peak_time=run.peak_time, shafts=run.shafts,
        run=replace(run, name="passing"), phase=made.phase, unit=speed_unit(description),
    )  # fmt: skip


def _slowest(made: _Follower, run: Transient) -> tuple[float, float]:
    """The stretch in which the line gained least for its time [s]: where it hung, or what it passed most slowly."""
    turns = run.whole.turns[0]
    if len(turns) < 12:
        return 0.0, run.end
    if run.outcome.kind == "reached":
        return float(turns[max(len(turns) - 30, 0)]), float(turns[-1])
    # Where it vibrates most: the largest swing of torque within eight turns.
    ends = turns[:: max((len(turns) - 1) // 200, 1)]
    swing = np.array([_swing(run, a, b) for a, b in zip(ends, ends[1:], strict=False)])
    worst = int(np.argmax(swing))
    middle = int(np.searchsorted(turns, (ends[worst] + ends[worst + 1]) / 2))
    return float(turns[max(middle - 5, 0)]), float(turns[min(middle + 5, len(turns) - 1)])


def _swing(run: Transient, since: float, until: float) -> float:
    torque: Array = run.torque_at(np.linspace(since, until, 33))
    return float((torque.max(axis=0) - torque.min(axis=0)).max())

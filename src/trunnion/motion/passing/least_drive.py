"""``least_drive``: which share of its drive's torque a line needs to come from one speed to another.

Whether a line passes need not be monotone in the torque, so that factors are sampled first. The least one is that from
which every factor tried passes from every starting phase; what passes below it too is said.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags
from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.arguments import one_number, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.motion.passing.start import ends_of, lasting
from trunnion.motion.passing.trials import FACTOR, passes, trials_of
from trunnion.results.counts import counted
from trunnion.results.fields import attribute, computed, coordinate, internal, labelled, members, variable
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result
from trunnion.results.speeds import rounded_speed
from trunnion.results.variables import Attribute, Variable
from trunnion.waiting import keeps_time, time_is_up

MOST_POINTS = 10_000


@labelled
class DriveTrial:
    """Passages with one factor of the drive torque, from every starting phase."""

    factor: float = variable("", "1")
    share: float = variable("", "1", "of the starting phases that passed", name="passed")
    undecided: float = variable("", "1", "of the starting phases")
    worst: str = variable("", "", "how the passages ended that did not pass", name="otherwise")

    @property
    def passes(self) -> bool:
        """Whether the line passed from every starting phase."""
        return self.share == 1.0


@labelled
class LeastDrive(Result):
    """The least factor of the drive torque from which every factor tried passes."""

    trials: tuple[DriveTrial, ...] = members(
        DriveTrial, "factor", "every factor that was tried, rising", only="share undecided worst"
    )
    phases: Array = coordinate("phase", "rad", "of the input when it begins")
    drive: str = attribute("disk whose torque is scaled")
    first: float = attribute("speed at the start [rad/s]")
    last: float = attribute("speed asked for [rad/s]")
    accuracy: float = attribute("of the least factor, relative")
    tolerance: float = attribute("error allowed per step")
    stopped: str = internal("what ended the search early")
    unit: str = internal("of speeds in print")

    @property
    @computed(coordinate("factor", "1"))
    def factor(self) -> Array:
        """What was tried (trial,)."""
        return np.array([one.factor for one in self.trials])

    @property
    def passes(self) -> Flags:
        """Whether each passed from every starting phase (trial,)."""
        return np.array([one.passes for one in self.trials], dtype=bool)

    @property
    @computed(variable("", "1"))
    def least(self) -> float:
        """The least factor from which every one tried passes; NaN where the highest does not."""
        place = self._place
        return self.trials[place].factor if place < len(self.trials) else np.nan

    @property
    @computed(variable("", "1"))
    def below(self) -> float:
        """The highest factor tried that does not pass from every phase; NaN where all do."""
        return self.trials[self._place - 1].factor if self._place else np.nan

    @property
    def passing_below(self) -> Array:
        """Factors below ``below`` that pass all the same: passing is not monotone there."""
        return np.array([one.factor for one in self.trials[: self._place] if one.passes])

    @property
    def _place(self) -> int:
        failing = np.flatnonzero(~self.passes)
        return int(failing[-1]) + 1 if len(failing) else 0

    @property
    def outcome(self) -> Outcome:
        """Whether it was found, and a sentence."""
        if self.stopped:
            return Outcome(False, "ended early", f"{self.stopped} after {len(self.trials)} factors")
        if np.isnan(self.least):
            return Outcome(False, "not found", "no factor that was tried is enough")
        return Outcome(True, "found", f"{self.least:.4g} of the torque of {self.drive} is enough")

    def declared(self) -> Iterator[Variable | Attribute]:
        """Trials, ends of the search, and the sentence."""
        yield from super().declared()
        yield Attribute("outcome", self.outcome.kind)
        yield Attribute("says", "; ".join(self._lines()))

    def _lines(self) -> Iterator[str]:
        trials, place = self.trials, self._place
        asked = rounded_speed(self.last, self.unit)
        count = counted(len(self.phases), "starting phase")
        if not trials:
            yield f"nothing was tried: {self.stopped}"
            return
        span = f"{len(trials)} factors tried from {trials[0].factor:.4g} to {trials[-1].factor:.4g}"
        if place == len(trials):
            yield f"none of the {span} of the torque of {self.drive} brings the line to {asked} up to the highest"
        else:
            yield (
                f"{trials[place].factor:.4g} of the torque of {self.drive} brings the line to {asked}: each of the "
                f"{len(trials) - place} factors tried from there to {trials[-1].factor:.4g} passes from {count}"
            )
        if place:
            one = trials[place - 1]
            yield f"  {one.factor:.4g} passes from {100 * one.share:.3g} % of them, and is otherwise {one.worst}"
        else:
            yield "  nothing less was tried"
        if len(self.passing_below):
            several = ", ".join(f"{one:.4g}" for one in self.passing_below)
            yield f"  passing is not monotone in the torque: {several} pass too, though more does not"
        if len(trials) > 1:
            apart = 100 * float(np.max(self.factor[1:] / self.factor[:-1]) - 1)
            yield f"  {span}, up to {apart:.3g} % apart; nothing was run between them"
        if self.stopped:
            yield f"  {self.outcome}"


@keeps_time
def least_drive(
    line: Driveline | Assembly,
    speeds: Sequence[float | str],
    *,
    torque: Sequence[AppliedTorque] = (),
    friction: Sequence[FrictionTorque] = (),
    scenario: Scenario | str | None = None,
    drive: str | None = None,
    factors: tuple[float, float] = (0.1, 10.0),
    points: int = 17,
    accuracy: float = 0.01,
    phases: int | ArrayLike = 8,
    tolerance: float = 1e-9,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> LeastDrive:
    """The least factor of the drive torque with which a line comes from one speed to another, whatever its phase.

    Parameters
    ----------
    line : a ``Driveline`` (or its ``Assembly``) without a ConstantSpeed.
    speeds : the first and the last [rad/s] of its input, numbers or texts with a unit; from 0, rising.
    torque, friction, scenario : what acts, as in ``passing``.
    drive : name of the disk whose torques are scaled; by default the one that torques act on, or the line's Motor.
    factors : the smallest and the largest that are tried, of the torque as it is given.
    points : how many of them first, evenly in the logarithm; then the least one is found by bisection.
    accuracy : of the least factor, relative: between it and one that does not pass.
    phases : how many starting phases, even over half a turn and every other one half a turn on; or angles [rad].
    tolerance : error allowed per step; every passage is judged at two, as by ``passing``.
    within : seconds of computing after which it ends with what it has.
    progress : called as progress(share done).

    Returns
    -------
    LeastDrive: ``least``, from which on every factor tried passes, ``below``, which does not, and every trial.

    Raises
    ------
    InputError : a range that is not one, less than two points, an accuracy that is none; what ``passing`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
    >>> line = tn.Driveline([disks[0], tn.HookeJoint(angle="9 deg"), tn.Shaft(stiffness=2e3, damping=1.0), disks[1]])
    >>> weak = tn.AppliedTorque(on="motor", time=[0], torque=[2.5], between="steps")
    >>> found = tn.least_drive(line, (15.0, 40.0), torque=[weak], factors=(0.5, 4.0), points=3, accuracy=0.1, phases=1)
    >>> 1.0 < found.least < 1.6
    True
    """
    trials = trials_of(line, ends_of(speeds), lasting(line, torque, friction, scenario), drive, phases, tolerance)
    low, high = _range(factors)
    count = whole_number(points, "points", 2)
    if count > MOST_POINTS:
        raise InputError("are too many", key="points", value=count, remedy=f"at most {MOST_POINTS}; 17, say")
    if not 1e-12 < one_number(accuracy, "accuracy", "0.01, say") < 1:
        raise InputError("must lie between 1e-12 and 1", key="accuracy", value=accuracy, remedy="0.01, say")
    report_progress, expected = progress or (lambda share: None), count + _halvings(low, high, count, accuracy)
    made: list[DriveTrial] = []

    def found(stopped: str = "") -> LeastDrive:
        return LeastDrive(
            trials=tuple(sorted(made, key=lambda one: one.factor)), phases=trials.phases, drive=trials.drive,
            first=trials.first, last=trials.last, accuracy=accuracy, tolerance=tolerance, stopped=stopped,
            unit=speed_unit(trials.line),
        )  # fmt: skip

    waiting = [float(one) for one in np.geomspace(high, low, count)]
    while waiting:
        kinds = [] if time_is_up() else trials.kinds({FACTOR: waiting[0]})
        if stopped := time_is_up():
            return found(stopped)
        made.append(_trial(waiting.pop(0), kinds))
        report_progress(min(len(made) / expected, 1.0))
        if not waiting:
            waiting = _between(found())
    report_progress(1.0)
    return found()


def _trial(factor: float, kinds: list[str]) -> DriveTrial:
    other = sorted({kind for kind in kinds if not passes([kind])})
    return DriveTrial(factor, passes(kinds) / len(kinds), kinds.count("undecided") / len(kinds), " or ".join(other))


def _between(found: LeastDrive) -> list[float]:
    """The factor between the least one and what does not pass below it; none where these are near enough."""
    low, high = found.below, found.least
    return [float(np.sqrt(low * high))] if high / low > 1 + found.accuracy else []


def _halvings(low: float, high: float, count: int, accuracy: float) -> int:
    """How many are expected."""
    return max(int(np.ceil(np.log2(np.log(high / low) / (count - 1) / np.log1p(accuracy)))), 0)


def _range(factors: tuple[float, float]) -> tuple[float, float]:
    ends = [one_number(one, "factors", "(0.5, 2.0), say") for one in factors]
    if len(ends) != 2 or not np.all(np.isfinite(ends)) or not 0 < ends[0] < ends[1]:
        raise InputError("must be two rising positive numbers", key="factors", value=list(factors), remedy="(0.5, 2.0)")
    return ends[0], ends[1]

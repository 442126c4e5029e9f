"""``least_drive``: which share of its drive's torque a line needs to come from one speed to another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.coefficients import Assembly
from trunnion.motion.passing.least_found import LeastFound, TriedValue, search, summary
from trunnion.motion.passing.start import ends_of, lasting
from trunnion.motion.passing.trials import FACTOR, trials_of
from trunnion.results.fields import computed, coordinate, labelled, members, variable
from trunnion.waiting import keeps_time


@labelled
class DriveTrial(TriedValue):
    """Passages with one factor of the drive torque, from every starting phase."""

    factor: float = variable("", "1")

    @property
    def value(self) -> float:
        """The factor."""
        return self.factor


@labelled
class LeastDrive(LeastFound):
    """The least factor of the drive torque from which every factor tried passes, and the nature of the boundary there.

    ``nature`` has, by starting phase, how often the outcome changes as the torque rises and between which factors it
    does for the last time, the width of the narrowest strip, and what was searched.
    """

    trials: tuple[DriveTrial, ...] = members(
        DriveTrial, "factor", "every factor that was tried, rising", only="share undecided worst"
    )
    WHAT: ClassVar[tuple[str, str]] = ("factor", "factors")

    @property
    def _tried(self) -> tuple[Any, ...]:
        return self.trials

    def _said(self, value: float) -> str:
        return f"{value:.4g} of the torque of {self.drive}"

    @property
    @computed(coordinate("factor", "1"))
    def factor(self) -> Array:
        """What was tried (trial,)."""
        return self.values

    @property
    @computed(variable("", "1"))
    def least(self) -> float:
        """The least factor from which every one tried passes; NaN where the highest does not."""
        return self._least()

    @property
    @computed(variable("", "1"))
    def below(self) -> float:
        """The highest factor tried that does not pass from every phase; NaN where all do."""
        return self._below()


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
    around: int = 17,
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
    around : how many factors more, even in the logarithm and up to eight times ``accuracy`` on both sides of the
        boundary, for its nature; 0 for none.
    phases : how many starting phases, even over half a turn and every other one half a turn on; or angles [rad].
    tolerance : error allowed per step; every passage is judged at two, as by ``passing``.
    within : seconds of computing after which it ends with what it has.
    progress : called as progress(share done).

    Returns
    -------
    LeastDrive: ``least``, from which on every factor tried passes, ``below``, which does not, and every trial.

    Raises
    ------
    InputError : a range that is not one, less than two points, an accuracy out of range; what ``passing`` refuses.

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

    def found(made: Sequence[tuple[float, list[str]]], band: Array, stopped: str) -> LeastDrive:
        ordered = sorted(made, key=lambda one: one[0])
        return LeastDrive(
            trials=tuple(DriveTrial(*summary(kinds), factor=value) for value, kinds in ordered),
            phases=trials.phases, drive=trials.drive, first=trials.first, last=trials.last, accuracy=accuracy,
            tolerance=tolerance, band=band, stopped=stopped, unit=speed_unit(trials.line),
        )  # fmt: skip

    return search(
        trials, path=FACTOR, ends=factors, key="factors", points=points, accuracy=accuracy, around=around, found=found,
        progress=progress,
    )  # fmt: skip

"""``least_acceleration``: how fast a line must be run up to pass its resonances."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Rotor
from trunnion.driveline.machines import Motor
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.motion.passing.least_found import LeastFound, TriedValue, search, summary
from trunnion.motion.passing.start import ends_of, lasting
from trunnion.motion.passing.trials import ACCELERATION, trials_of
from trunnion.results.counts import few
from trunnion.results.fields import computed, coordinate, labelled, members, variable
from trunnion.results.speeds import show_acceleration
from trunnion.waiting import keeps_time


@labelled
class AccelerationTrial(TriedValue):
    """Passages with one acceleration of the rigid line, from every starting phase."""

    acceleration: float = variable("", "rad/s^2")

    @property
    def value(self) -> float:
        """The acceleration [rad/s²]."""
        return self.acceleration


@labelled
class LeastAcceleration(LeastFound):
    """The least acceleration from which every one tried passes, and the nature of the boundary there.

    ``nature`` has, by starting phase, how often the outcome changes as the acceleration rises and between which it does
    for the last time, the width of the narrowest strip, and what was searched.
    """

    trials: tuple[AccelerationTrial, ...] = members(
        AccelerationTrial, "acceleration", "every acceleration that was tried, rising", only="share undecided worst"
    )
    WHAT: ClassVar[tuple[str, str]] = ("acceleration", "accelerations")

    @property
    def _tried(self) -> tuple[Any, ...]:
        return self.trials

    def _said(self, value: float) -> str:
        return show_acceleration(value, self.unit)

    @property
    @computed(coordinate("acceleration", "rad/s^2"))
    def acceleration(self) -> Array:
        """What was tried (trial,) [rad/s²]."""
        return self.values

    @property
    @computed(variable("", "rad/s^2"))
    def least(self) -> float:
        """The least acceleration from which every one tried passes [rad/s²]; NaN where the highest does not."""
        return self._least()

    @property
    @computed(variable("", "rad/s^2"))
    def below(self) -> float:
        """The highest acceleration tried that does not pass from every phase [rad/s²]; NaN where all do."""
        return self._below()


@keeps_time
def least_acceleration(
    line: Driveline | Assembly,
    speeds: Sequence[float | str],
    accelerations: tuple[float, float],
    *,
    torque: Sequence[AppliedTorque] = (),
    friction: Sequence[FrictionTorque] = (),
    scenario: Scenario | str | None = None,
    drive: str | None = None,
    points: int = 17,
    accuracy: float = 0.01,
    around: int = 17,
    phases: int | ArrayLike = 8,
    tolerance: float = 1e-9,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> LeastAcceleration:
    """The least acceleration with which a line comes from one speed to another, whatever its phase.

    The drive gives, at whatever speed it has, what balances the loads and curves there and what would accelerate the
    rigid line so; nothing more where the line falls behind. Torques over time or angle act besides.

    Parameters
    ----------
    line : a ``Driveline`` (or its ``Assembly``) without a ConstantSpeed.
    speeds : the first and the last [rad/s] of its input, numbers or texts with a unit; from 0, rising.
    accelerations : the smallest and the largest that are tried [rad/s²], of the input.
    torque, friction, scenario : what acts besides, as in ``passing``; what acts on the drive itself is replaced.
    drive : name of the disk that drives; by default the line's Motor, or the only disk that is given a torque or has a
        drive_share.
    points : how many accelerations first, evenly in the logarithm; then the least one is found by bisection.
    accuracy : of the least one, relative: between it and one that does not pass.
    around : how many more, even in the logarithm and up to eight times ``accuracy`` on both sides of the boundary, for
        its nature; 0 for none.
    phases : how many starting phases, even over half a turn and every other one half a turn on; or angles [rad].
    tolerance : error allowed per step; every passage is judged at two, as by ``passing``.
    within : seconds of computing after which it ends with what it has.
    progress : called as progress(share done).

    Returns
    -------
    LeastAcceleration: ``least`` [rad/s²], from which on every one tried passes, ``below``, which does not, every trial
    and the ``nature`` of the boundary.

    Raises
    ------
    InputError : a range that is not one, no drive or several, less than two points; what ``passing`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
    >>> line = tn.Driveline([disks[0], tn.HookeJoint(angle="9 deg"), tn.Shaft(stiffness=2e3, damping=1.0), disks[1]])
    >>> asked = dict(drive="motor", points=3, accuracy=0.2, around=0, phases=1)
    >>> found = tn.least_acceleration(line, (15.0, 40.0), (0.3, 2.0), **asked)
    >>> 0.4 < found.below < found.least < 0.8
    True
    """
    description = line.line if isinstance(line, Assembly) else line
    named = _drive(description, torque, scenario, drive)
    still = AppliedTorque(on=named, time=[0], torque=[0.0], between="steps")  # its place is taken by each acceleration
    acting = lasting(line, torque, friction, scenario)
    others = tuple(one for one in acting[0] if one.on != named)
    trials = trials_of(line, ends_of(speeds), ((*others, still), *acting[1:]), named, phases, tolerance)

    def found(made: Sequence[tuple[float, list[str]]], band: Array, stopped: str) -> LeastAcceleration:
        ordered = sorted(made, key=lambda one: one[0])
        return LeastAcceleration(
            trials=tuple(AccelerationTrial(*summary(kinds), acceleration=value) for value, kinds in ordered),
            phases=trials.phases, drive=named, first=trials.first, last=trials.last, accuracy=accuracy,
            tolerance=tolerance, band=band, stopped=stopped, unit=speed_unit(description),
        )  # fmt: skip

    return search(
        trials, path=ACCELERATION, ends=accelerations, key="accelerations", points=points, accuracy=accuracy,
        around=around, found=found, progress=progress,
    )  # fmt: skip


def _drive(line: Driveline, torque: Sequence[AppliedTorque], scenario: Scenario | str | None, drive: str | None) -> str:
    """The disk that drives.

    Raises
    ------
    InputError : none, or several.
    """
    stated = line.scenario(scenario) if isinstance(scenario, str) else scenario
    given = [one.on for one in (*torque, *(stated.torques if stated else ()))]
    motors = [name for name, e in line.parts if isinstance(e, Motor)]
    sharing = [name for name, e in line.parts if getattr(e, "drive_share", None)]
    known = list(dict.fromkeys(motors or sharing or given))
    if drive is None and len(known) != 1:
        what = "is missing, for several may drive" if known else "is missing, for nothing says what drives"
        remedy = f"name {few(known, 3)}" if known else 'name a disk: drive="motor", say'
        raise InputError(what, key="drive", remedy=remedy)
    rotors = [name for name, e in line.parts if isinstance(e, Rotor)]
    if drive is not None and drive not in rotors:
        raise InputError("is not a disk of this line", key="drive", value=drive, remedy=f"it has {few(rotors, 5)}")
    return drive or known[0]

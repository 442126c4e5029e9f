"""What a transient is prepared from: a line as its torques drive it, and the steps that follow it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.converter_balance import running_line
from trunnion.driveline.elements import Rotor
from trunnion.driveline.machines import Motor
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.scenarios import LevelCrossing, wrong_places_of
from trunnion.equations.applied_torques import PlacedTorque, placed_frictions, placed_torques
from trunnion.equations.coupling_tables import refuse_torque_tables
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.released import refuse_pendulums
from trunnion.errors import InputError
from trunnion.motion.transients.engines import on_throws
from trunnion.motion.transients.excited import without_varying
from trunnion.motion.transients.machines import without_curves
from trunnion.motion.transients.place import Found, Place
from trunnion.motion.transients.stepping import Stepper
from trunnion.numerics.integration.integration import MOST_STEPS

if TYPE_CHECKING:
    from trunnion.driveline.driveline import Driveline
    from trunnion.results.outcome import Outcome

Actions = tuple[tuple[AppliedTorque, ...], tuple[FrictionTorque, ...], tuple[LevelCrossing, ...]]
"""What acts and what is watched."""


def actions_of(
    torque: Sequence[AppliedTorque], friction: Sequence[FrictionTorque], crossing: Sequence[LevelCrossing]
) -> Actions:
    """The three of them as they are kept."""
    return tuple(torque), tuple(friction), tuple(crossing)


def refuse_others(several: Sequence[object], kind: type, key: str) -> None:
    """Refuse what is of another kind.

    Raises
    ------
    InputError : so.
    """
    for one in several:
        if not isinstance(one, kind):
            remedy = f"write [tn.{kind.__name__}(…)]"
            raise InputError(f"is not a list of {kind.__name__}", key=key, value=one, remedy=remedy)


def driven_line(line: Driveline, asked: Actions, speed: float) -> tuple[Driveline, Actions]:
    """The line as its torques drive it from an input ``speed`` [rad/s] on, and all that acts on it: a disk that is
    given a torque has no share any more, and machines act by their curves."""
    kinds = {"torque": AppliedTorque, "friction": FrictionTorque, "crossing": LevelCrossing}
    for (key, kind), several in zip(kinds.items(), asked, strict=True):
        refuse_others(several, kind, key)
    if wrong := [*wrong_places_of(*asked, line.parts)]:
        raise InputError.together(wrong)
    asked = (*on_throws(asked[0], asked[1], line.parts), asked[2])
    line, excited = without_varying(line, asked[0], {one.on for one in asked[1]}, speed)
    given = {one.on for one in asked[0]}
    asked = ((*asked[0], *excited), *asked[1:])
    sharing = [name for name, e in line.parts if isinstance(e, Rotor) and bool(getattr(e, "drive_share", False))]
    replaced = [name for name in sharing if name in given]
    if not replaced:
        return _curved(line, asked, speed)
    left = [name for name in sharing if name not in given]
    if left:
        raise InputError(
            f"shares the drive with {replaced[0]}, which is given a torque instead", element=left[0],
            key="drive_share", remedy=f"give {left[0]} a torque too, or no drive_share",
        )  # fmt: skip
    disks = [name for name in replaced if not isinstance(line.elements[line.index(name)], Motor)]
    plain = line.replace_all({name: {"drive_share": None} for name in disks}) if disks else line
    return _curved(plain, asked, speed, frozenset(replaced))


def _curved(
    line: Driveline, asked: Actions, speed: float, driven: frozenset[str] = frozenset()
) -> tuple[Driveline, Actions]:
    plain, torques, frictions = without_curves(line, speed, driven)
    return plain, (asked[0] + torques, asked[1] + frictions, asked[2])


def prepared_line(line: Driveline, asked: Actions, speed: float) -> tuple[LineSystem, Actions]:
    """The line as its torques drive it, ready to be followed from an input ``speed`` [rad/s] of either sense, and all
    that acts on it.

    Raises
    ------
    InputError : what acts where nothing can; a pendulum; an excitation that varies with the speed.
    """
    refuse_pendulums(line)
    refuse_torque_tables(line, "write the stiffness at the torque that matters")
    driven, acting = driven_line(running_line(line, max(speed, 0.0)), asked, speed)
    prepared = line_system(driven, abs(speed), leaves=True, slips=True)
    for one in prepared.torques:
        one.refuse_change()
    return prepared, acting


def follow(
    prepared: LineSystem,
    place: Place,
    duration: float,
    asked: Actions,
    tolerance: float,
    most_steps: int,
    mean_speed: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Found:
    """The motion from ``place`` on for ``duration`` [s].

    Raises
    ------
    InputError : a tolerance out of range; times beyond a table; what acts on a disk that a ConstantSpeed turns.
    """
    stepper = stepper_of(prepared, asked, tolerance, most_steps, mean_speed)
    for one in stepper.torques:
        _require_times(one, place.time, place.time + duration)
    return stepper.run(place, duration, progress)


def stepper_of(
    prepared: LineSystem,
    asked: Actions,
    tolerance: float,
    most_steps: int = MOST_STEPS,
    mean_speed: float | None = None,
) -> Stepper:
    """What follows a line under what is asked for.

    Raises
    ------
    InputError : a tolerance out of range; what acts on a disk that a ConstantSpeed turns.
    """
    if not (np.isfinite(tolerance) and 1e-15 <= tolerance < 1):
        raise InputError("must lie between 1e-15 and 1", key="tolerance", value=tolerance, remedy="1e-9, say")
    torques = placed_torques(prepared.assembly, asked[0])
    frictions = placed_frictions(prepared.assembly, asked[1])
    return Stepper(
        prepared, torques, frictions, asked[2], tolerance=tolerance, most_steps=most_steps,
        unit=speed_unit(prepared.assembly.line), mean_speed=mean_speed,
    )  # fmt: skip


def require_begun(outcome: Outcome, pieces: Sequence[object]) -> None:
    """Refuse a run that ended before its first step: there is no motion to say anything of.

    Raises
    ------
    InputError : so, in the words of its outcome.
    """
    if not pieces:
        raise InputError(f"ends where it begins: {outcome.sentence}", element="run")


def _require_times(torque: PlacedTorque, since: float, until: float) -> None:
    for axis in torque.axes:
        if axis.variable != "time" or axis.hold:
            continue
        first, last = float(axis.knots[0]), float(axis.knots[-1])
        if since < first or until > last * (1 + 1e-12):
            raise InputError(
                f"says nothing from t = {since:g} to {until:g} s, for its table goes from {first:g} to {last:g} s",
                element=f"torque on {torque.stated.on}", key="time",
                remedy="end the run there, add points, or write hold = true",
            )  # fmt: skip

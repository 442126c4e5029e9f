"""``transient``: what happens when torques act on a line over time, speed or angle, from any speed or from rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.driveline.arguments import one_speed
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.driveline.scenarios import AppliedTorque, Crossing, FrictionTorque, Scenario, wrong_places_of
from trunnion.equations.applied_torques import PlacedTorque, placed_frictions, placed_torques
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_system import LineSystem, line_system
from trunnion.equations.steady_base import imbalance
from trunnion.errors import InputError
from trunnion.motion.simulation.simulate import positive_time
from trunnion.motion.transients.result import Transient
from trunnion.motion.transients.stepping import LOCATED, Found, Place, Stepper
from trunnion.numerics.integration.integration import MOST_STEPS, TOLERANCE
from trunnion.waiting import keeps_time

Asked = tuple[tuple[AppliedTorque, ...], tuple[FrictionTorque, ...], tuple[Crossing, ...]]


@keeps_time
def transient(
    line: Driveline | Assembly,
    duration: float | Scenario | str | None = None,
    *,
    torque: Sequence[AppliedTorque] = (),
    friction: Sequence[FrictionTorque] = (),
    crossing: Sequence[Crossing] = (),
    speed: float | str | None = None,
    start: ArrayLike | None = None,
    tolerance: float = TOLERANCE,
    most_steps: int = MOST_STEPS,
    within: float | None = None,
) -> Transient:
    """Follow a line while torques act on its disks: starts, blows, faults, brakes.

    Parameters
    ----------
    line : a ``Driveline`` (or its ``Assembly``).
    duration : [s]; or a ``Scenario``, or the name of one of the line's, which says all that follows.
    torque : what acts over time, speed or angle; several on one disk add up, and come to what the description puts
        there. A disk with a drive_share that is given a torque is driven by that instead.
    friction : dry friction that resists disks and keeps them at rest.
    crossing : levels that are watched; the run ends at the first that ``ends``.
    speed : of the input when it begins [rad/s], by default the file's operating speed; 0 is standstill and negative
        turns backwards. Drives with a share go on giving what balances the loads at that speed.
    start : initial state (2n,): deviations [rad] from uniform rotation at t = 0 and their rates [rad/s]; by default
        turning evenly, twisted by the loads where they balance, and without twist elsewhere.
    tolerance : error allowed per step.
    most_steps : steps after which the run ends.
    within : seconds of computing after which it ends with what it has.

    Returns
    -------
    Transient; its ``outcome`` says how it ended, and a failure keeps what was computed.

    Raises
    ------
    InputError : no duration; a torque, friction or crossing where there is nothing for it; times beyond a table; some
        drives with a share given a torque and others not; an excitation that varies with speed.

    Examples
    --------
    >>> import trunnion as tn
    >>> disks = tn.Disk(name="motor", inertia=0.5), tn.Disk(name="mill", inertia=2.0)
    >>> line = tn.Driveline([disks[0], tn.Shaft(stiffness=2e4, damping=4.0), disks[1]])
    >>> blow = tn.AppliedTorque(on="mill", time=[0, 0.1, 0.15], torque=[0, -300, 0], between="steps")
    >>> run = tn.transient(line, 0.3, torque=[blow], speed=100.0)
    >>> run.outcome.kind, round(float(run.speed[-1].mean()), 2), run.energy.error < 1e-8
    ('reached', 94.0, True)
    """
    description = line.line if isinstance(line, Assembly) else line
    name = ""
    if isinstance(duration, str):
        duration = description.scenario(duration)
    if isinstance(duration, Scenario):
        scenario = duration
        if torque or friction or crossing:
            raise InputError("says what acts by itself", key="scenario", value=scenario.name, remedy="give a duration")
        duration, name = scenario.duration, scenario.name
        torque, friction, crossing = scenario.torque, scenario.friction, scenario.crossing
        speed = scenario.speed if speed is None else speed
    length = positive_time(duration, "give seconds, or the name of a scenario")
    asked = (tuple(torque), tuple(friction), tuple(crossing))
    changed = _checked(description, asked)
    begin = operating_speed(description, None) if speed is None else one_speed(speed, "speed")
    if not np.isfinite(begin):
        raise InputError("must be finite", key="speed", value=begin)
    prepared = line_system(changed, abs(begin), leaves=True)
    if not prepared.assembly.topology.free and not begin > 0:
        raise InputError(
            "is prescribed by a ConstantSpeed and must be positive", key="speed", value=begin,
            remedy="leave out the ConstantSpeed, so that the line starts by its torques",
        )  # fmt: skip
    for one in prepared.torques:
        one.refuse_change()
    place = Place(0.0, _start(prepared, start, begin), speed=begin)
    found = _run(prepared, place, length, asked, tolerance, most_steps)
    return _result(prepared, found, asked, tolerance, 0.0, name, description)


def gone_on(
    run: Transient,
    duration: float,
    torque: Sequence[AppliedTorque] | None,
    friction: Sequence[FrictionTorque] | None,
    crossing: Sequence[Crossing] | None,
    line: Driveline | None,
    tolerance: float | None,
) -> Transient:
    """See ``Transient.then``."""
    given = (torque, friction, crossing)
    asked: Any = tuple(old if new is None else tuple(new) for old, new in zip(run.asked, given, strict=True))
    description = run.description if line is None else line
    prepared = line_system(_checked(description, asked), run.line.speed, leaves=True)
    if (
        prepared.names != run.line.names
        or prepared.shafts != run.line.shafts
        or (len(prepared.system.states) != len(run.line.system.states))
    ):
        raise InputError(
            "has other disks or springs than the run", key="line", remedy="change numbers of the same line alone"
        )
    place, state = run.place, prepared.system.within_limits(run.place.state)
    if line is not None:
        place = replace(place, state=state, regime=LOCATED)
    length = positive_time(duration, "give seconds")
    tolerance = run.tolerance if tolerance is None else tolerance
    found = _run(prepared, place, length, asked, tolerance, MOST_STEPS)
    return run.joined(_result(prepared, found, asked, tolerance, place.time, run.name, description))


def _checked(line: Driveline, asked: Asked) -> Driveline:
    """The line as its torques drive it: a disk that is given one has no share any more."""
    kinds = {"torque": AppliedTorque, "friction": FrictionTorque, "crossing": Crossing}
    for (key, kind), several in zip(kinds.items(), asked, strict=True):
        for one in several:
            if not isinstance(one, kind):
                remedy = f"write [tn.{kind.__name__}(…)]"
                raise InputError(f"is not a list of {kind.__name__}", key=key, value=one, remedy=remedy)
    if wrong := [*wrong_places_of(*asked, line.parts)]:
        raise InputError.together(wrong)
    given = {one.on for one in asked[0]}
    sharing = [name for name, e in line.parts if isinstance(e, Disk) and e.drive_share]
    replaced = [name for name in sharing if name in given]
    if not replaced:
        return line
    left = [name for name in sharing if name not in given]
    if left:
        raise InputError(
            f"shares the drive with {replaced[0]}, which is given a torque instead", element=left[0],
            key="drive_share", remedy=f"give {left[0]} a torque too, or no drive_share",
        )  # fmt: skip
    return line.replace_all({name: {"drive_share": None} for name in replaced})


def _start(prepared: LineSystem, start: ArrayLike | None, speed: float) -> Any:
    if start is not None:
        return prepared.system.checked_start(start)
    assembly = prepared.assembly
    loaded = speed != 0 and not imbalance(assembly, assembly.table(1, abs(speed)))[0]
    state = prepared.twisted() if loaded else prepared.rest()
    if speed <= 0:  # joints turn backwards, or not at all
        n = assembly.topology.size
        state[n : 2 * n] *= -1.0 if speed < 0 else 0.0
    return state


def _run(prepared: LineSystem, place: Place, duration: float, asked: Asked, tolerance: float, most_steps: int) -> Found:
    if not (np.isfinite(tolerance) and 1e-15 <= tolerance < 1):
        raise InputError("must lie between 1e-15 and 1", key="tolerance", value=tolerance, remedy="1e-9, say")
    torques = placed_torques(prepared.assembly, asked[0])
    frictions = placed_frictions(prepared.assembly, asked[1])
    for one in torques:
        _require_times(one, place.time, place.time + duration)
    stepper = Stepper(
        prepared, torques, frictions, asked[2], tolerance=tolerance, most_steps=most_steps,
        unit=speed_unit(prepared.assembly.line),
    )  # fmt: skip
    return stepper.run(place, duration)


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


def _result(
    prepared: LineSystem, found: Found, asked: Asked, tolerance: float, since: float, name: str, description: Driveline
) -> Transient:
    return Transient(
        line=prepared, pieces=tuple(found.pieces), place=found.place, outcome=found.outcome,
        crossings=tuple(found.crossed), tolerance=tolerance, start_time=since, name=name, description=description,
        asked=asked, unit=speed_unit(prepared.assembly.line),
    )  # fmt: skip

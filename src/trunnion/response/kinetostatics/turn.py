"""The question ``kinetostatics`` asks of a driveline, from the arguments to the result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import quantity
from trunnion.driveline.converter_balance import refuse_converters
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import known_speed, speed_unit
from trunnion.driveline.quantities import LENGTH, SPEED, TORQUE
from trunnion.driveline.refusals import nearest
from trunnion.equations.kinematics import Rotations
from trunnion.equations.released import refuse_pendulums
from trunnion.errors import InputError
from trunnion.response.kinetostatics.bearings import Bearings
from trunnion.response.kinetostatics.chain import KinematicChain, chain
from trunnion.response.kinetostatics.couples import cross_tilts, secondary_couples
from trunnion.response.kinetostatics.elastic import constant_twist, solve
from trunnion.response.kinetostatics.friction import CrossFriction
from trunnion.response.kinetostatics.measures import largest
from trunnion.response.kinetostatics.motion import Drive, assembled
from trunnion.response.kinetostatics.remarks import remarks
from trunnion.response.kinetostatics.result import ConstantTwist, Kinetostatics
from trunnion.response.kinetostatics.supports import support_forces
from trunnion.response.kinetostatics.torques import Torques, refuse_locking

FEWEST_POINTS = 8
MOST_POINTS = 72_000
"""Points that are computed unless more turns are asked for, or a joint turns so slowly that it needs more."""


def kinetostatics(
    line: Driveline,
    speed: float | str | None = None,
    acceleration: float = 0.0,
    *,
    rigid: bool = True,
    output_torque: float | str | Mapping[str, float | str] = 0.0,
    inertia: bool = False,
    friction: CrossFriction | None = None,
    supports: Bearings | None = None,
    lengths: Mapping[str, float | str] | None = None,
    turns: int | None = None,
    points: int = 720,
    branch: str | None = None,
) -> Kinetostatics:
    """Motion, torques, secondary couples and support forces of ``line`` over a turn of its input.

    Behind a ratio one turn of the input is less than the motion takes to repeat: by default all turns until it does.

    All branches are computed together: the shafts in front of a fork carry what its branches ask for.

    >>> r = kinetostatics(line, speed=tn.rpm(1500), supports=[("Shaft 1", -0.3, -0.1)])  # doctest: +SKIP

    Parameters
    ----------
    line : the driveline; its first element is driven, whatever it is.
    speed, acceleration : of the input, the same at every angle [rad/s, rad/s²]; by default the speed that the
        description operates at, 1 rad/s where it says none.
    rigid : shafts do not twist; False solves the twist under the torque at every angle.
    output_torque : at the end of the line [N m], beside the Disks' own loads; positive resists rotation. With
        branches: at the end of ``branch``, or by name of an element on each branch.
    inertia : count the inertia torques of the rigid line.
    friction : in the bearings of every cross.
    supports : (shaft, position, position) or (shaft, position) each [m]; see ``supports.support_forces``.
    lengths : joint-to-joint lengths [m] by shaft, where the shaft is not a tube of known length.
    turns : of the input; by default those after which the motion repeats, as far as 72 000 points go (100 turns) unless
        the slowest joint needs more.
    points : per turn of the input; behind a step-up so many times more that the fastest joint has as many a turn.
    branch : name of an element on the branch that "the output" is the end of; default the last of the line.
        ``result.on_branch(name)`` gives the same turn with the output of another.

    Raises
    ------
    InputError : an argument out of its range, a prescribed output, bearings that cannot carry the load.
    ComputationError : shafts so soft that the twist does not settle.
    """
    if speed is None:
        speed = known_speed(line) or 1.0
    drive_speed = quantity(speed, SPEED, "speed")
    if not drive_speed > 0:
        raise InputError("must be positive", key="speed", value=speed, remedy="write tn.rpm(1500), say")
    if turns is not None:
        _whole("turns", turns, 1)
    _whole("points", points, FEWEST_POINTS)
    if friction is not None and not isinstance(friction, CrossFriction):
        raise InputError(
            "is not a CrossFriction",
            key="friction",
            value=friction,
            remedy='write tn.CrossFriction(coefficient=0.005, pin_radius="12 mm", arm="40 mm")',
        )
    refuse_converters(line, "a turn does")
    refuse_pendulums(
        line, "swings with the orders of the rotation, and a turn is quasi-static", "leave it out of the turn"
    )
    train = chain(line, _lengths(line, lengths), branch, drive_speed)
    pin_moment = friction.pin_moment if friction else 0.0
    refuse_locking(train, pin_moment)
    points *= train.fastest
    turns = turns or min(train.turns, max(MOST_POINTS // points, train.turns_of_the_slowest))
    input_angle: Array = np.arange(turns * points, dtype=np.float64) * (2 * np.pi / points)
    torque = _output_torques(train, output_torque)
    drive = Drive(input_angle, drive_speed, _acceleration(acceleration), torque, pin_moment, inertia)
    motion, passed, twist = solve(train, drive, rigid=rigid)
    couples = secondary_couples(train, motion, passed, pin_moment)
    forces = support_forces(train, couples, supports) if supports is not None else None
    constant = None if rigid else _constant(train, drive, motion, twist)
    names, ends = line.names, tuple(train.behind[i] for i in train.ends)
    zero = np.array(assembled(train))
    steps, joints = train.steps, train.joints

    def derivative(stations: Sequence[int], order: int) -> Array:
        factor = (1, 1, 2)[order]
        values = [factor * motion.angle[i][order] - (zero[i] if order == 0 else 0.0) for i in stations]
        return np.reshape(values, (len(stations), len(input_angle)))

    def stack(values: list[Array]) -> Array:
        return np.reshape(values, (len(values), len(input_angle)))

    return Kinetostatics(
        line=line,
        input_speed=drive_speed,
        input_acceleration=drive.acceleration,
        turns=turns,
        repeats_after=train.turns,
        rigid=rigid,
        inertia=inertia,
        branches=tuple(names[i] for i in train.ends),
        branch=names[train.output],
        end_ratio=np.array([float(steps[i].speed) for i in ends]),
        end_angle=derivative(ends, 0),
        end_speed=derivative(ends, 1),
        end_acceleration=derivative(ends, 2),
        end_torque=np.array([torque.get(i, 0.0) for i in train.ends]),
        input_angle=input_angle,
        shafts=tuple(steps[i].name for i in train.shafts),
        shaft_elements=tuple(names[steps[i].element] for i in train.shafts),
        shaft_ratio=np.array([float(steps[i].speed) for i in train.shafts]),
        angle=derivative(train.shafts, 0),
        speed=derivative(train.shafts, 1),
        acceleration=derivative(train.shafts, 2),
        twist=stack([twist[i][0] if i in twist else np.zeros_like(input_angle) for i in train.shafts]),
        torque=stack([-passed.out[i][0] for i in train.shafts]),
        drive_torque=passed.out[0][0],
        joints=tuple(steps[i].name for i in joints),
        joint_angle=stack([motion.chi[i][0] for i in joints]),
        joint_torque_in=stack([passed.into[i][0] for i in joints]),
        joint_torque_out=stack([passed.out[i][0] for i in joints]),
        forks=couples.names,
        fork_ratio=np.array([float(train.members[m].speed) for m in couples.member]),
        cross_tilt=cross_tilts(train, motion),
        secondary_couple=couples.standing,
        secondary_couple_rotating=couples.rotating,
        supports=forces,
        constant_twists=constant,
        findings=remarks(train, drive, rigid, forces, turns, twist),
        power_loss=couples.friction_power,
        power_residual=_power_residual(train, drive, motion, passed, twist, couples.friction_power),
        unit=speed_unit(line),
    )


def _output_torques(train: KinematicChain, given: float | str | Mapping[str, float | str]) -> dict[int, float]:
    """Torque [N m] by the element at the end of a branch."""
    if not isinstance(given, Mapping):
        return {train.output: quantity(given, TORQUE, "output_torque")}
    found: dict[int, float] = {}
    for name, value in given.items():
        end = train.end_behind(name, "output_torque")
        if end in found:
            remedy = "give one torque a branch"
            raise InputError(
                "names a branch that has its torque already", key="output_torque", value=name, remedy=remedy
            )
        found[end] = quantity(value, TORQUE, f"output_torque[{name!r}]")
    return found


def _constant(
    train: KinematicChain, drive: Drive, motion: Rotations, twist: dict[int, Array]
) -> tuple[ConstantTwist, ...]:
    """One for every end."""
    approximate = constant_twist(train, drive, twist).angle
    variation = []
    for i in train.shafts:
        mean, swing = float(np.mean(twist[i][0])), float(np.ptp(twist[i][0]))
        variation.append(swing / (2 * abs(mean)) if mean else np.nan)
    found = []
    for end in (train.behind[i] for i in train.ends):
        errors = [np.abs(approximate[end][k] - motion.angle[end][k]) for k in range(3)]
        angle, speed, half = (float(largest(error)) for error in errors)
        found.append(ConstantTwist(np.array(variation), angle, speed, 2 * half))
    return tuple(found)


def _power_residual(
    train: KinematicChain, drive: Drive, motion: Rotations, passed: Torques, twist: dict[int, Array], heat: Array
) -> float:
    """Largest imbalance of power over the largest power [-].

    Supplied power = what loads, inertias and springs take up + heat of the joints. With elastic shafts the inertia
    torques are those of the rigid line; the balance is that of the torques as they are used.
    """
    taken = [out[0].copy() for out in passed.out]
    for i, step in enumerate(train.steps[1:], start=1):
        taken[step.parent] -= passed.into[i][0]
    powers = [torque * motion.angle[i][1] for i, torque in enumerate(taken) if torque.any()]
    powers += [-passed.out[i][0] * jet[1] for i, jet in twist.items()]
    supplied = passed.out[0][0] * drive.speed - heat
    scale = float(np.max(np.abs([supplied, *powers])))
    return float(np.max(np.abs(supplied - sum(powers)))) / scale if scale else 0.0


def _lengths(line: Driveline, lengths: Mapping[str, float | str] | None) -> dict[str, float]:
    known = {}
    for name, length in (lengths or {}).items():
        if name not in line.names:
            raise InputError(
                "is not a Shaft of this driveline",
                key="lengths",
                value=name,
                remedy=nearest(name, line.names),
            )
        known[name] = quantity(length, LENGTH, f"lengths[{name!r}]")
        if not known[name] > 0:
            raise InputError("must be positive", element=name, key="lengths", value=length, remedy="write 0.8 [m]")
    return known


def _acceleration(value: float) -> float:
    if isinstance(value, Real) and np.isfinite(value):
        return float(value)
    raise InputError("must be a finite number", key="acceleration", value=value, remedy="write it in rad/s²")


def _whole(key: str, value: int, least: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise InputError("must be a whole number", key=key, value=value, remedy=f"write {least} or more")

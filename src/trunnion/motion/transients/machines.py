"""Machines as a motion in time has them: their inertia as a disk, and their torque over speed as a torque applied.

Linear analyses take a machine's curve by its tangent at one speed. A transient leaves that speed, so that here each
follows its curve itself: Kloss's formula, the points, a speed controller within its torque limit, constant power; with
its first-order lag, where it has one.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.brakes import Brake
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk, Rotor
from trunnion.driveline.machines import ElectricMachine, Generator, Machine, Motor, Propeller
from trunnion.driveline.vehicle import Vehicle
from trunnion.equations.coefficients import assemble
from trunnion.equations.loads import own_load
from trunnion.errors import InputError


class CurveFromRest(AppliedTorque):
    """The curve of a machine from standstill on: backwards it has the torque of standstill."""

    below: ClassVar[bool] = True


class LessFriction(AppliedTorque):
    """What friction that falls with the speed lacks of its torque at rest; its work is friction's."""

    rubs: ClassVar[bool] = True


SPAN = 1e3
"""How far from the speed at which a run begins constant power is followed, of either way: beyond, it ends."""


def without_curves(
    line: Driveline, speed: float, driven: frozenset[str] = frozenset()
) -> tuple[Driveline, tuple[AppliedTorque, ...], tuple[FrictionTorque, ...]]:
    """The line with its machines that act by curves as disks of their inertia, and their torques and frictions.

    What a curve resists with at standstill resists either way, and keeps the machine at rest: it is dry friction.

    Parameters
    ----------
    speed : of the input at the start [rad/s], at which a converter has set a motor with a drive_share.
    driven : names of motors whose drive_share a torque from outside replaces.

    Raises
    ------
    InputError : a propeller's damping_factor; constant power, or a motor set by a converter, from standstill.
    """
    machines = {name: one for name, one in line.parts if isinstance(one, Machine) and one.tangent}
    brakes = {name: one for name, one in line.parts if isinstance(one, Brake)}
    rolling = {name: one for name, one in line.parts if isinstance(one, Vehicle) and one.rolling_resistance}
    if not machines and not brakes and not rolling:
        return line, (), ()
    torques, unshared = _shares(line, speed, driven)
    frictions: list[FrictionTorque] = []
    disks: dict[str, Rotor] = dict(unshared)
    for name, car in rolling.items():
        rolls, climbs = (one.load.value(0.0) for one in (car, car.but(rolling_resistance=0.0)))
        frictions.append(FrictionTorque(on=name, torque=float(rolls - climbs)))
        disks[name] = disks.get(name, car).but(rolling_resistance=0.0, name=name)
    for name, machine in machines.items():
        _refuse(name, machine)
        if name not in driven:
            torque = machine_torque(line, name, machine, speed)
            lag = machine.lag_frequency if isinstance(machine, ElectricMachine) else None
            torques.append(torque if lag is None else torque.but(corner_frequency=lag))
        if rubs := at_rest(machine):
            frictions.append(FrictionTorque(on=name, torque=rubs))
        disks[name] = Disk(
            name=name, inertia=machine.moment_of_inertia, excitation=machine.excitation, after=machine.after
        )
    for name, brake in brakes.items():
        if brake.stribeck_speed is not None:
            assert brake.static_torque is not None
            frictions.append(FrictionTorque(on=name, torque=brake.static_torque))
            torques.append(_falling(name, brake))
        elif brake.torque or brake.static_torque:
            frictions.append(FrictionTorque(on=name, torque=brake.torque, static=brake.static_torque))
        disks[name] = Disk(name=name, inertia=brake.inertia, excitation=brake.excitation, after=brake.after)
    # Names that count disks would shift by those that come in.
    named = [one if one.name else one.but(name=name) if isinstance(one, Disk) else one for name, one in line.parts]
    elements = [disks.get(name, one) for name, one in zip(line.names, named, strict=True)]
    return line.but(elements=elements), tuple(torques), tuple(frictions)


def _shares(line: Driveline, speed: float, driven: frozenset[str]) -> tuple[list[AppliedTorque], dict[str, Rotor]]:
    """What disks with a drive_share give at the start, as torques that last, and these disks without their share: loads
    that become torques or friction would no longer be counted in what they balance."""
    assembly = assemble(line)
    topo, column = assembly.topology, assembly.packed.column
    sharing = {
        name: one for name, one in line.parts
        if isinstance(one, Rotor) and getattr(one, "drive_share", None) and name not in driven
        and not isinstance(one, Machine)
    }  # fmt: skip
    if not sharing or not topo.free:
        return [], {}
    table = assembly.table(1, max(speed, 0.0))
    alone = table.copy()
    for name in sharing:
        alone[:, column(line.index(name), "drive_share")] = 0.0
    torques = []
    for name in sharing:
        own, load = (float(own_load(topo, column, one, line.index(name))[0]) for one in (table, alone))
        torques.append(AppliedTorque(on=name, time=[0.0], torque=[load - own], between="steps", hold=True))
    return torques, {name: one.but(drive_share=None, name=name) for name, one in sharing.items()}


def at_rest(machine: Machine) -> float:
    """Torque [N m] that a machine that is driven resists with at standstill by its curve."""
    if isinstance(machine, Motor) or not machine.curve or machine.table.range[0] > 0:
        return 0.0
    return max(float(machine.table.torques[0]), 0.0)


def _falling(name: str, brake: Brake) -> AppliedTorque:
    """How much friction is below its static torque T_s, in the sense of ω: (T_s − T_c)(1 − e^(−|ω|/ω_s)), nothing
    at rest, where T_s holds.

    With t = tanh(ω/2ω_s) that is (T_s − T_c) 2t/(1 + |t|), which has no kink for the integration to stop at.
    """
    assert brake.static_torque is not None and brake.stribeck_speed is not None
    less, t = brake.static_torque - brake.torque, f"tanh(speed/{2 * brake.stribeck_speed!r})"
    return LessFriction(on=name, formula=f"{2 * less!r}*{t}/(1 + sqrt({t}^2))")


def _refuse(name: str, machine: Machine) -> None:
    if isinstance(machine, Propeller) and machine.damping_factor is not None:
        raise InputError(
            "holds about one mean speed, which changes here", element=name, key="damping_factor",
            value=machine.damping_factor, remedy="leave it out: the torque goes with the square of the speed",
        )  # fmt: skip


def machine_torque(line: Driveline, name: str, machine: Machine, speed: float) -> AppliedTorque:
    """What drives or resists, as a torque over speed."""
    if isinstance(machine, Motor) and machine.set:
        return _set(line, name, machine, speed)
    if machine.curve:
        sense, rubs = 1.0 if isinstance(machine, Motor) else -1.0, at_rest(machine)
        torque = [sense * (float(one) - rubs) for one in machine.table.torques]
        kind = CurveFromRest if machine.table.range[0] == 0 else AppliedTorque
        return kind(on=name, speed=machine.table.speeds, torque=torque, between="cubic")
    if isinstance(machine, Generator) and machine.power is not None:
        if not speed > 0:
            raise InputError(
                "takes constant power, which has no torque at standstill", element=name, key="power",
                value=machine.power, remedy="start at a positive speed, or give its curve by points",
            )  # fmt: skip
        own = speed * abs(_ratio(line, name))
        return AppliedTorque(on=name, power=-machine.power, speed=[own / SPAN, own * SPAN])
    assert isinstance(machine, ElectricMachine)
    if machine.breakdown_torque is not None:
        assert machine.breakdown_slip is not None and machine.synchronous_speed is not None
        return _kloss(name, machine.breakdown_torque, machine.breakdown_slip, machine.synchronous_speed)
    assert machine.set_speed is not None
    return _controlled(name, machine, machine.set_speed)


def _set(line: Driveline, name: str, motor: Motor, speed: float) -> AppliedTorque:
    """A motor that a converter has set so that it carries its share of the loads at the speed of the start: its curve
    is moved along the speed, and stays there."""
    if not speed > 0:
        raise InputError(
            "is set by its converter to the speed at which the run begins, which must be positive", element=name,
            key="drive_share", value=motor.drive_share,
            remedy="leave out drive_share, so that it starts by its own curve, or give it a torque",
        )  # fmt: skip
    assembly = assemble(line)
    topo = assembly.topology
    place = line.index(name)
    station = next(s for s, i in topo.disks if i == place)
    torque = -float(own_load(topo, assembly.packed.column, assembly.table(1, speed), place)[0])
    own = speed * abs(float(topo.mean_speeds[station]))
    if (most := motor.most) is not None and abs(torque) > most[1]:
        raise InputError(
            f"would have to drive with {torque:.5g} N m at the start, more than its {most[0].replace('_', ' ')}",
            element=name, key=most[0], value=most[1], remedy="raise it, or lower the load",
        )  # fmt: skip
    if motor.breakdown_torque is None:
        assert motor.gain is not None
        return _controlled(name, motor, own + torque / motor.gain)
    assert motor.breakdown_slip is not None and motor.synchronous_speed is not None
    root = float(np.sqrt(motor.breakdown_torque**2 - torque**2))
    slip = motor.breakdown_slip * torque / (motor.breakdown_torque + root)
    moved = own + slip * motor.synchronous_speed
    # The same curve counts its slip by another synchronous speed.
    return _kloss(name, motor.breakdown_torque, motor.breakdown_slip * motor.synchronous_speed / moved, moved)


def _kloss(name: str, torque: float, slip: float, synchronous: float) -> AppliedTorque:
    return AppliedTorque(on=name, breakdown_torque=torque, breakdown_slip=slip, synchronous_speed=synchronous)


def _controlled(name: str, machine: ElectricMachine, set_speed: float) -> AppliedTorque:
    """gain (set_speed − ω) within the limit; without one the line goes on far beyond any speed."""
    assert machine.gain is not None
    most = SPAN * machine.gain * set_speed if machine.torque_limit is None else machine.torque_limit
    points = [set_speed - most / machine.gain, set_speed + most / machine.gain]
    return AppliedTorque(on=name, speed=points, torque=[most, -most], hold=True)


def _ratio(line: Driveline, name: str) -> float:
    """Mean speed of a rotor over that of the input."""
    topo, place = assemble(line).topology, line.index(name)
    return float(topo.mean_speeds[next(s for s, i in topo.disks if i == place)])

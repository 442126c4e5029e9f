"""Excitations whose amplitude goes with the load or the speed, as a motion in time has them.

What goes with the mean torque of a disk whose drive keeps its torque, as one with a drive_share does here, has one
amplitude all the way; what goes with a torque that its disk is given follows that (``given_load``). What goes with the
square of the speed, the oscillating masses of an engine, is a torque over angle and speed, at each instant by the speed
that the disk has; so is a share of what its disk resists with by powers of its speed, or of a machine's curve.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from trunnion.driveline.applied_torque import AppliedTorque
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk, Rotor
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.machines import Machine
from trunnion.equations.amplitudes import BEYOND, Running, amplitude, beyond
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.harmonics import cylinders
from trunnion.errors import InputError
from trunnion.laws.torque_curve import PowerCurve
from trunnion.motion.transients.given_load import by_given, of_share
from trunnion.motion.transients.machines import at_rest, machine_torque
from trunnion.motion.transients.torque_text import lines, phase_text, torque_text


class Shaking(AppliedTorque):
    """An excitation by the speed: not what drives, though it acts on the same disk."""


def without_varying(
    line: Driveline, torque: Sequence[AppliedTorque], rubbed: Collection[str], speed: float
) -> tuple[Driveline, tuple[AppliedTorque, ...]]:
    """The line with the amplitudes that its excitations have from an input ``speed`` [rad/s] on, and torques for those
    by the speed or by the ``torque`` that their disk is given. Excitations by the load of disks that are ``rubbed``,
    or whose own load goes otherwise with the speed, are kept: these are not followed.

    Raises
    ------
    InputError : a load beyond the table of an excitation; a given torque that no amplitude can be made by.
    """
    varying = [
        (name, one) for name, one in line.parts if isinstance(one, Rotor) and any(e.varies for e in one.excitation)
    ]
    if not varying:
        return line, ()
    assembly, torques, changed = assemble(line), list[AppliedTorque](), dict[str, dict[str, object]]()
    for name, rotor in varying:
        kept: list[Excitation] = []
        given = [one for one in torque if one.on == name]
        loaded = list[tuple[int, Excitation]]()
        for number, law in enumerate(rotor.excitation, start=1):
            if law.quadratic_amplitude is not None:
                torques.append(_by_square(name, rotor, law))
            elif law.speeds and not law.torques:
                torques += _by_table(name, rotor, law)
            elif law.speeds and given and not isinstance(rotor, Machine):
                raise InputError(
                    "goes by speed and load, and the load of its disk is given here", element=name,
                    key=f"excitation {number}", remedy="give a table over torques or over speeds alone",
                )  # fmt: skip
            elif not law.varies or name in rubbed or (given and isinstance(rotor, Machine)):
                kept.append(law)
            elif given:
                loaded.append((number, law))
            elif law.share is not None and isinstance(rotor, Machine) and rotor.tangent:
                torques.append(of_share(name, rotor, (number, law), _of_machine(line, name, rotor, speed)))
            elif law.share is not None and (load := _own_curve(rotor)) is not None:
                torques.append(_by_share(name, rotor, law, load))
            elif law.speeds and _steady(rotor):
                torques += _by_table(name, rotor, _over_speeds(assembly, name, number, law, speed))
            elif _steady(rotor):
                kept.append(_at_load(assembly, name, number, law, speed))
            else:
                kept.append(law)
        if loaded:
            torques += by_given(name, rotor, loaded, given)
        changed[name] = {"excitation": kept or None}
        if not kept and isinstance(rotor, Disk) and rotor.firing_angles:
            changed[name] |= {"firing_angles": None, "misfiring": None}
    return line.replace_all(changed), tuple(torques)


def _steady(rotor: Rotor) -> bool:
    """Whether the torque that it drives with stays while the speed changes."""
    load = rotor.load
    return isinstance(load, PowerCurve) and not (load.viscous or load.quadratic)


def _of_machine(line: Driveline, name: str, machine: Machine, speed: float) -> str:
    """What a machine drives with by its curve, as a formula of its speed.

    Raises
    ------
    InputError : what ``machine_torque`` refuses.
    """
    text = torque_text(machine_torque(line, name, machine, speed))
    assert text is not None
    return f"{text} - ({at_rest(machine)!r})"


def _own_curve(rotor: Rotor) -> PowerCurve | None:
    """What a rotor without a share of the drive resists with, where that is a sum of powers of its speed, none of them
    negative; of a propeller or a pump by its square, say."""
    load = rotor.load
    if getattr(rotor, "drive_share", None) or not isinstance(load, PowerCurve):
        return None
    return load if min(load.constant, load.viscous, load.quadratic) >= 0 else None


def _by_share(name: str, rotor: Rotor, law: Excitation, load: PowerCurve) -> AppliedTorque:
    """A share of what its disk resists with at each instant, by the speed that it has."""
    constant, viscous, quadratic = (float(part) for part in (load.constant, load.viscous, load.quadratic))
    size = f"(({constant!r}) + ({viscous!r})*speed + ({quadratic!r})*speed^2)"
    return _turning(name, rotor, law, float(law.share or 0), size)


def _by_square(name: str, rotor: Rotor, law: Excitation) -> AppliedTorque:
    return _turning(name, rotor, law, float(law.quadratic_amplitude or 0), "speed^2")


def _by_table(name: str, rotor: Rotor, law: Excitation) -> tuple[AppliedTorque, ...]:
    """A e^{iφ} linear between the points of a table over the speed, and a torque of nothing that says as little beyond
    its ends, which ends a run there."""
    points, phases = np.array(law.speeds), np.array(law.phases or np.zeros(len(law.speeds)))
    values = np.array(law.amplitudes) * np.exp(1j * phases) * cylinders(rotor, law)
    slack, turned = BEYOND * float(points[-1]), phase_text(law, float(law.phase))
    waves = ((values.real, "cos"), (-values.imag, "sin"))
    terms = [f"({lines(points, part)})*{wave}({turned})" for part, wave in waves if part.any()]
    ends = [max(float(points[0]) - slack, 0.0), float(points[-1]) + slack]
    covers = Shaking(on=name, speed=ends, torque=[0.0, 0.0])
    return Shaking(on=name, formula=" + ".join(terms) or "0"), covers


def _turning(name: str, rotor: Rotor, law: Excitation, factor: float, size: str) -> AppliedTorque:
    """``factor`` times ``size`` at the angle that the disk has."""
    together = cylinders(rotor, law)
    factor, phase = abs(together) * factor, float(law.phase + np.angle(together))
    return Shaking(on=name, formula=f"({factor!r})*{size}*cos({phase_text(law, phase)})")


def _over_speeds(assembly: Assembly, name: str, number: int, law: Excitation, speed: float) -> Excitation:
    """Of a table over speed and load the one over speed, at the load that the disk drives with."""
    load = float(-assembly.exciting_load(assembly.line.index(name), assembly.table(1, abs(speed)))[0])
    if beyond(law.torques, np.array([load]))[0]:
        problem = law.does_not_cover("torques", load)
        raise InputError(problem, element=name, key=f"excitation {number}", remedy="extend the table")
    return law.at_torque(load)


def _at_load(assembly: Assembly, name: str, number: int, law: Excitation, speed: float) -> Excitation:
    place, table = assembly.line.index(name), assembly.table(1, abs(speed))
    running = Running(np.abs(table[:, 0]), lambda: -assembly.exciting_load(place, table))
    try:
        found = complex(amplitude(law, np.array([law.largest]), running)[0])
    except InputError as error:
        raise error.but(element=name, key=f"excitation {number}") from None
    return law.but(
        share=None, speeds=None, torques=None, amplitudes=None, phases=None, amplitude=abs(found),
        phase=float(law.phase + np.angle(found)),
    )  # fmt: skip

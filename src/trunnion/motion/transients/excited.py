"""Excitations whose amplitude goes with the load or the speed, as a motion in time has them.

What goes with the mean torque of a disk whose drive keeps its torque, as one with a drive_share does here, has one
amplitude all the way. What goes with the square of the speed, the oscillating masses of an engine, and a share of what
its disk resists with by powers of its speed, as of a propeller's blades, is a torque over angle and speed: at each
instant by the speed that the disk has.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.applied_torque import AppliedTorque
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk, Rotor
from trunnion.driveline.excitation import Excitation
from trunnion.equations.amplitudes import BEYOND, Running, amplitude
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.harmonics import cylinders
from trunnion.errors import InputError
from trunnion.laws.torque_curve import PowerCurve


def without_varying(
    line: Driveline, given: Collection[str], speed: float
) -> tuple[Driveline, tuple[AppliedTorque, ...]]:
    """The line with the amplitudes that its excitations have from an input ``speed`` [rad/s] on, and torques for those
    by the speed. Disks that are ``given`` a torque keep excitations by their load, as do those whose own load goes
    otherwise with the speed: these are not followed.

    Raises
    ------
    InputError : a load beyond the table of an excitation.
    """
    varying = [
        (name, one) for name, one in line.parts if isinstance(one, Rotor) and any(e.varies for e in one.excitation)
    ]
    if not varying:
        return line, ()
    assembly, torques, changed = assemble(line), list[AppliedTorque](), dict[str, dict[str, object]]()
    for name, rotor in varying:
        kept: list[Excitation] = []
        for number, law in enumerate(rotor.excitation, start=1):
            if law.quadratic_amplitude is not None:
                torques.append(_by_square(name, rotor, law))
            elif law.speeds:
                torques += _by_table(name, rotor, law)
            elif law.share is not None and name not in given and (load := _own_curve(rotor)) is not None:
                torques.append(_by_share(name, rotor, law, load))
            elif law.varies and name not in given and _steady(rotor):
                kept.append(_at_load(assembly, name, number, law, speed))
            else:
                kept.append(law)
        changed[name] = {"excitation": kept or None}
        if not kept and isinstance(rotor, Disk) and rotor.firing_angles:
            changed[name] |= {"firing_angles": None, "misfiring": None}
    return line.replace_all(changed), tuple(torques)


def _steady(rotor: Rotor) -> bool:
    """Whether the torque that it drives with stays while the speed changes."""
    load = rotor.load
    return isinstance(load, PowerCurve) and not (load.viscous or load.quadratic)


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
    slack, turned = BEYOND * float(points[-1]), _turned(law, float(law.phase))
    waves = ((values.real, "cos"), (-values.imag, "sin"))
    terms = [f"({_lines(points, part)})*{wave}({turned})" for part, wave in waves if part.any()]
    ends = [max(float(points[0]) - slack, 0.0), float(points[-1]) + slack]
    covers = AppliedTorque(on=name, speed=ends, torque=[0.0, 0.0])
    return AppliedTorque(on=name, formula=" + ".join(terms) or "0"), covers


def _lines(points: Array, values: Array) -> str:
    """Straight lines of ``speed`` through points, as a formula."""
    slopes = np.diff(values) / np.diff(points)
    terms = [repr(float(values[0])), f"({float(slopes[0])!r})*(speed - ({float(points[0])!r}))"]
    for point, change in zip(points[1:-1], np.diff(slopes), strict=True):
        if change:
            terms.append(f"({float(change)!r})*max(speed - ({float(point)!r}), 0)")
    return " + ".join(terms)


def _turned(law: Excitation, phase: float) -> str:
    """Its angle at each instant, as a formula."""
    return f"({float(law.order or 0)!r})*angle + ({float(law.frequency or 0)!r})*time + ({phase!r})"


def _turning(name: str, rotor: Rotor, law: Excitation, factor: float, size: str) -> AppliedTorque:
    """``factor`` times ``size`` at the angle that the disk has."""
    together = cylinders(rotor, law)
    factor, phase = abs(together) * factor, float(law.phase + np.angle(together))
    return AppliedTorque(on=name, formula=f"({factor!r})*{size}*cos({_turned(law, phase)})")


def _at_load(assembly: Assembly, name: str, number: int, law: Excitation, speed: float) -> Excitation:
    place, table = assembly.line.index(name), assembly.table(1, abs(speed))
    running = Running(np.abs(table[:, 0]), lambda: -assembly.own_load(place, table))
    try:
        found = complex(amplitude(law, np.array([law.largest]), running)[0])
    except InputError as error:
        raise error.but(element=name, key=f"excitation {number}") from None
    return law.but(
        share=None, torques=(), amplitudes=(), phases=(), amplitude=abs(found),
        phase=float(law.phase + np.angle(found)),
    )  # fmt: skip

"""What shakes a line from outside: harmonic torques of disks and transmission errors of meshes, by order.

An exciter of order K (cycles per turn of the input) acts as Re[g(τ) e^{iKτ}] on the unknowns, one fixed in time as
Re[g(τ) e^{iωt}]; g repeats with the joints and is constant on a straight line. The torque of a disk follows the base
motion of its disk, joints' lead and static twist included,

    A cos(k (|R| τ + d̄(τ)) + phase),

so K = k |R| with R the mean speed ratio of the disk. A transmission error e adds to the twist of its mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk
from trunnion.driveline.gears import GearPair
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonic_torques import harmonic_torque, size_of
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Topology


@dataclass(frozen=True)
class Exciter:
    """One harmonic of one element.

    ``order`` is K in cycles per turn of the input, 0 for a torque fixed in time, whose frequency [rad/s] stands in
    the packed column ``frequency`` (−1 otherwise); ``own_order`` counts per turn of the disk. ``station`` is where a
    torque acts, ``compliance`` the mesh of a transmission error; the other is −1. ``held`` torques act on a rotation
    that a ConstantSpeed prescribes, and do nothing. ``amplitude`` and ``phase`` are packed columns, ``number`` counts
    the harmonics of the disk from 1 that is element ``place`` of the line.
    """

    element: str
    order: Fraction
    own_order: float
    amplitude: int
    phase: int
    frequency: int = -1
    station: int = -1
    compliance: int = -1
    over: float = 1.0
    held: bool = False
    number: int = 0
    place: int = -1

    @property
    def in_time(self) -> bool:
        """Whether its frequency is fixed, whatever the speed."""
        return self.frequency >= 0


def exciters(assembly: Assembly) -> tuple[Exciter, ...]:
    """Every harmonic torque and transmission error of a line, those of no amplitude included."""
    topo, line, column = assembly.topology, assembly.line, assembly.packed.column
    found = []
    for s, place in topo.disks:
        element = line.elements[place]
        assert isinstance(element, Disk)
        held = bool(topo.unknown_of[s] < 0)
        for h, harmonic in enumerate(element.excitation, start=1):
            own = harmonic.order or 0.0
            found.append(
                Exciter(
                    line.names[place],
                    Fraction(str(own)) * abs(topo.speed_ratio[s]),
                    own,
                    column(place, f"excitation {h} {size_of(harmonic)}"),
                    column(place, f"excitation {h} phase"),
                    column(place, f"excitation {h} frequency"),
                    station=s,
                    number=h,
                    place=place,
                    held=held,
                )
            )
    for mesh in topo.meshes:
        place = mesh.element
        pair = line.elements[place]
        assert isinstance(pair, GearPair)
        for h, own_order in enumerate(mesh.error, start=1):
            amplitude, phase = (column(place, f"transmission_error {h} {k}") for k in ("amplitude", "phase"))
            order, over = own_order * mesh.teeth, 1 / pair.radii[1]
            name = line.names[place]
            found.append(Exciter(name, order, own_order, amplitude, phase, compliance=mesh.compliance, over=over))
    return tuple(found)


def tabled_by_speed(line: Driveline, exciter: Exciter) -> bool:
    """Whether an amplitude stands in a table over the speed, and so is no polynomial in it."""
    if exciter.station < 0:
        return False
    disk = line.elements[exciter.place]
    assert isinstance(disk, Disk)
    return bool(disk.excitation[exciter.number - 1].speeds)


def quiet(line: Driveline) -> Driveline:
    """``line`` without its ``exciters``: excitations of disks and transmission errors."""
    for name, element in zip(line.names, line.elements, strict=True):
        if isinstance(element, Disk) and element.excitation:
            line = line.replace(name, excitation=None, firing_angles=None, misfiring=None)
        if isinstance(element, GearPair) and element.transmission_error:
            line = line.replace(name, transmission_error=())
    return line


def size(assembly: Assembly, exciter: Exciter, table: Array) -> Complex:
    """A e^{i phase} of an exciter, (case,): torque [N m], or transmission error as a twist [rad]."""
    if exciter.station >= 0:
        return harmonic_torque(
            assembly.packed, assembly.topology, exciter.station, exciter.place, exciter.number, table
        )
    phase = table[:, exciter.phase]
    return np.asarray(exciter.over * table[:, exciter.amplitude] * np.exp(1j * phase))


@dataclass(frozen=True)
class BaseOfExcitation:
    """What exciters need of the base motion at the input angles asked for.

    relative (case, time, station): r from a group's first station; rotation (case, time, station): deviation of the
    base motion from uniform rotation [rad].
    """

    relative: Array
    rotation: Array


def base_of_excitation(
    topo: Topology, coefficients: LineCoefficients, untwisted: LineCoefficients, tau: Array
) -> BaseOfExcitation:
    """``untwisted`` are the coefficients without static twist, whose straight line turns uniformly."""
    motion = base_motion(topo, coefficients, tau)
    uniform = base_motion(topo, untwisted.straight, tau)
    return BaseOfExcitation(motion.relative, motion.angle - uniform.angle)


def torque_on_unknowns(topo: Topology, exciter: Exciter, sizes: Complex, base: BaseOfExcitation) -> Complex:
    """g (case, time, n) of a disk's torque [N m]; ``sizes`` as of ``size``."""
    s = exciter.station
    sense = float(np.sign(float(topo.speed_ratio[s])))
    turned = np.exp(1j * exciter.own_order * sense * base.rotation[..., s])
    g = np.zeros((*turned.shape, topo.size), dtype=complex)
    g[..., topo.unknown_of[s]] = base.relative[..., s] * sense * sizes[:, None] * turned
    return g


def twist_on_unknowns(topo: Topology, exciter: Exciter, torque: Complex, relative: Array) -> Complex:
    """g (case, time, n) of a mesh whose transmission error alone gives it the ``torque`` (case, time) [N m]."""
    far, near = topo.ends[exciter.compliance]
    g = np.zeros((*torque.shape, topo.size), dtype=complex)
    if far >= 0:
        g[..., far] -= torque
    if near >= 0:
        g[..., near] += relative[..., topo.compliances[exciter.compliance].near] * torque
    return g

"""What shakes a line, harmonic by harmonic: torques of disks and transmission errors of meshes.

A harmonic of order K (cycles per turn of the input) and frequency ν acts as Re[g(τ) e^{i(Kτ + νt)}] on the unknowns; g
repeats with the joints and is constant on a straight line. The torque of a disk follows the base motion of its disk,
joints' lead and static twist included,

    A cos(k (|R| τ + d̄(τ)) + νt + phase),

so K = k |R| with R the mean speed ratio of the disk, which counts k in its own sense of rotation. Cylinders that fire
at α_c repeat what is listed once: A becomes A Σ_c e^{−ikα_c}. A transmission error e adds to the twist of its mesh.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np

from trunnion.arrays import Array, Complex, Integers
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Disk, Rotor
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.gears import GearPair
from trunnion.equations.amplitudes import Running, amplitude, where
from trunnion.equations.coefficients import Assembly, mesh_harmonics
from trunnion.equations.graph_matrices import turning_of
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import LinkKind, Mesh, Topology
from trunnion.errors import InputError
from trunnion.laws.harmonic import Harmonic

CANCELLED = 1e-12
"""Share of what cylinders would do together below which their sum is rounding: angles are read to as much."""
Spring = Callable[[int], Complex]
Runnings = dict[int, Running]
"""How disks run, by the place of their element, at the rows of one table."""


@dataclass(frozen=True)
class BaseOfExcitation:
    """What harmonics need of the base motion at the input angles asked for.

    relative (case, time, station): r from a group's first station; rotation (case, time, station): deviation of the
    base motion from uniform rotation [rad]; turning (case, time, station, n): rotation per rotation of every unknown,
    of a line that is not a tree; even: stations that turn evenly with their group, whatever the angles.
    """

    relative: Array
    rotation: Array
    turning: Array | None = None
    even: frozenset[int] = frozenset()


def base_of_excitation(
    topo: Topology, coefficients: LineCoefficients, untwisted: LineCoefficients, tau: Array
) -> BaseOfExcitation:
    """``untwisted`` are the coefficients without static twist, whose straight line turns uniformly."""
    motion = base_motion(topo, coefficients, tau)
    alike = untwisted is coefficients and not any(law.nonuniform for law in coefficients.joints)
    uniform = motion if alike else base_motion(topo, untwisted.straight, tau)
    turning = turning_of(topo, coefficients, tau).value if topo.graph else None
    return BaseOfExcitation(motion.relative, motion.angle - uniform.angle, turning, _in_front_of_joints(topo))


def _in_front_of_joints(topo: Topology) -> frozenset[int]:
    """Stations that no joint drives."""
    found: set[int] = set()
    for s, station in enumerate(topo.stations):
        before = [one for one, _ in station.of] or [station.before]
        if s == 0 or station.link is not LinkKind.JOINT and found.issuperset(before):
            found.add(s)
    return frozenset(found)


@dataclass(frozen=True)
class LineHarmonic(Harmonic):
    """A harmonic of an element, by turns of the line's input and at one row of packed numbers; ``name`` of the element,
    ``number`` of the harmonic there, from 1."""

    name: str
    number: int

    @property
    def acts(self) -> bool:
        """Whether it moves anything."""
        return bool(self.amplitude != 0)

    @abstractmethod
    def size(self, assembly: Assembly, table: Array, running: Runnings | None = None) -> Complex:
        """A e^{i phase} (case,) at rows of packed numbers: torque [N m], or transmission error as a twist [rad];
        ``running``: how disks run there, as far as it is known already."""

    @abstractmethod
    def forcing(
        self, topo: Topology, size: Complex, base: BaseOfExcitation, spring: Spring
    ) -> tuple[Integers, Complex]:
        """Unknowns (k,) that it acts on and g (case, time, k) [N m] there, of ``size`` (case,); one time where g does
        not vary over the turn. ``spring``: what a compliance resists its twist with (case, time) [N m/rad]."""


@dataclass(frozen=True)
class DiskTorque(LineHarmonic):
    """A harmonic torque on the disk at a ``station``, an ``element`` of the line: amplitude as its ``law`` makes it of
    the packed number there, of all ``cylinders`` together.

    columns: of that number, of the phase, and of the frequency (−1 without one); prescribed: a ConstantSpeed gives the
    rotation that it acts on.
    """

    columns: tuple[int, ...]
    station: int
    element: int
    law: Excitation
    cylinders: complex
    prescribed: bool

    @property
    def acts(self) -> bool:
        return super().acts and not self.prescribed and self.cylinders != 0

    @property
    def own_order(self) -> float:
        """Cycles per turn of the disk."""
        return self.law.order or 0.0

    def size(self, assembly: Assembly, table: Array, running: Runnings | None = None) -> Complex:
        known = None if running is None else running.get(self.element)
        if known is None:
            known = self._running(assembly, table)
            if running is not None:
                running[self.element] = known
        number, phase = table[:, self.columns[0]], table[:, self.columns[1]]
        try:
            size = amplitude(self.law, number, known)
        except InputError as error:
            raise error.but(element=self.name, key=f"excitation {self.number}") from None
        return np.asarray(size * np.exp(1j * phase) * self.cylinders)

    def places(self, assembly: Assembly, table: Array) -> list[tuple[tuple[float, ...], Array]]:
        """Points of the table of its amplitude, and where it is read (case,): at speeds [rad/s] or torques [N m] of its
        disk, or both."""
        return where(self.law, self._running(assembly, table))

    def load(self, assembly: Assembly, table: Array) -> Array:
        """The mean torque that its disk drives with (case,) [N m]."""
        return -assembly.exciting_load(self.element, table)

    def _running(self, assembly: Assembly, table: Array) -> Running:
        speed = table[:, 0] * abs(float(assembly.topology.speed_ratio[self.station]))
        return Running(speed, cache(lambda: self.load(assembly, table)))

    def forcing(
        self, topo: Topology, size: Complex, base: BaseOfExcitation, spring: Spring
    ) -> tuple[Integers, Complex]:
        s = self.station
        times = slice(0, 1) if s in base.even and base.turning is None else slice(None)
        sense = float(np.sign(float(topo.speed_ratio[s])))
        turned = sense * size[:, None] * np.exp(1j * self.own_order * sense * base.rotation[:, times, s])
        if base.turning is not None:
            return _where_it_acts(turned[..., None] * base.turning[:, :, s])
        return topo.unknown_of[[s]], (base.relative[:, times, s] * turned)[..., None]

    def refuse_change(self, elsewhere: str = "tn.order_response") -> None:
        """Refuse an amplitude by the speed where the speed changes; ``elsewhere``: what has it.

        Raises
        ------
        InputError : so.
        """
        if self.law.varies:
            raise InputError(
                "has an amplitude that depends on the speed, which changes here", element=self.name, key="excitation",
                remedy=f"give it an amplitude, or use {elsewhere}",
            )  # fmt: skip


@dataclass(frozen=True)
class MeshError(LineHarmonic):
    """A harmonic of the transmission error of a ``mesh``: what it is along the line of action over the ``radius``
    [m] of the output gear, a twist [rad]."""

    mesh: Mesh
    radius: float

    def size(self, assembly: Assembly, table: Array, running: Runnings | None = None) -> Complex:
        own = mesh_harmonics(assembly.packed, self.mesh, "transmission_error", table)[self.number - 1]
        return np.asarray(own.complex_amplitude / self.radius)

    def forcing(
        self, topo: Topology, size: Complex, base: BaseOfExcitation, spring: Spring
    ) -> tuple[Integers, Complex]:
        e = self.mesh.compliance
        (far, near), station, torque = topo.ends[e], topo.compliances[e].near, spring(e) * size[:, None]
        if base.turning is not None:
            far_end = topo.reference[topo.compliances[e].far_group]
            return _where_it_acts(-torque[..., None] * (base.turning[:, :, far_end] - base.turning[:, :, station]))
        parts = [(i, part) for i, part in ((far, -torque), (near, base.relative[..., station] * torque)) if i >= 0]
        return np.array([i for i, _ in parts], dtype=np.int64), np.stack([part for _, part in parts], axis=-1)


def _where_it_acts(g: Complex) -> tuple[Integers, Complex]:
    """The unknowns (k,) on which g (case, time, n) acts at all, and g there."""
    acted = np.flatnonzero(g.any(axis=(0, 1)))
    return acted, g[..., acted]


def line_harmonics(assembly: Assembly, row: Array | None = None) -> tuple[LineHarmonic, ...]:
    """Every harmonic torque and transmission error of a line, those of no amplitude included, at a row of packed
    numbers, by default as described."""
    values = assembly.packed.values if row is None else row
    errors = (one for mesh in assembly.topology.meshes for one in mesh_errors(assembly, mesh, values))
    return (*disk_torques(assembly, row), *errors)


def disk_torques(assembly: Assembly, row: Array | None = None) -> tuple[DiskTorque, ...]:
    """The harmonic torques of all disks alone; those as described are made once."""
    if row is None or np.array_equal(row[1:], assembly.packed.values[1:]):
        found: tuple[DiskTorque, ...] = assembly.derived(_disk_torques)
        return found
    return _disk_torques(assembly, row)


def _disk_torques(assembly: Assembly, row: Array | None = None) -> tuple[DiskTorque, ...]:
    topo, packed = assembly.topology, assembly.packed
    row = packed.values if row is None else row
    found = []
    for s, place in topo.disks:
        disk = packed.line.elements[place]
        assert isinstance(disk, Rotor)
        for i, law in enumerate(disk.excitation, start=1):
            keys = ("amplitude" if law.axes else law.stated_as, "phase", "frequency")
            columns = tuple(packed.column(place, f"excitation {i} {key}") for key in keys)
            number, phase, frequency = (float(row[column]) if column >= 0 else 0.0 for column in columns)
            order = Fraction(str(law.order or 0)) * abs(topo.speed_ratio[s])
            own = packed.line.names[place], i, columns, s, place, law, cylinders(disk, law), not topo.turning[s].any()
            found.append(DiskTorque(order, frequency, number, phase, *own))
    return tuple(found)


def mesh_errors(assembly: Assembly, mesh: Mesh, row: Array) -> tuple[MeshError, ...]:
    """The harmonics of the transmission error of one mesh, as twists [rad] of its output gear."""
    pair, name = assembly.line.elements[mesh.element], assembly.line.names[mesh.element]
    assert isinstance(pair, GearPair)
    found, radius = mesh_harmonics(assembly.packed, mesh, "transmission_error", row), pair.radii[1]
    return tuple(
        MeshError(one.order, one.frequency, float(one.amplitude) / radius, float(one.phase), name, i, mesh, radius)
        for i, one in enumerate(found, start=1)
    )


def cylinders(disk: Rotor, law: Excitation) -> complex:
    """Σ_c e^{−ikα_c} over a disk's firing angles, without a cylinder that misfires; 0 where they cancel but for
    rounding, which would excite a resonance; 1 where it has none."""
    if not isinstance(disk, Disk) or not disk.firing_angles or law.order is None:
        return 1.0
    turned = np.exp(-1j * law.order * np.array(disk.firing_angles))
    if disk.misfiring is not None and law.quadratic_amplitude is None:
        turned = np.delete(turned, disk.misfiring - 1)
    total = complex(turned.sum())
    return total if abs(total) > CANCELLED * len(turned) else 0.0


def unexcited(line: Driveline) -> Driveline:
    """``line`` without excitations of disks and transmission errors."""
    changes: dict[str, dict[str, Any]] = {}
    for name, element in zip(line.names, line.elements, strict=True):
        if isinstance(element, Rotor) and element.excitation:
            keys = ("excitation", "firing_angles", "misfiring")
            changes[name] = {key: None for key in keys if key in type(element).model_fields}
        if isinstance(element, GearPair) and element.transmission_error:
            changes[name] = {"transmission_error": ()}
    return line.replace_all(changes)

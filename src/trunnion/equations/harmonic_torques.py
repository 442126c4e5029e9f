"""The amplitude of a disk's harmonic torque at one speed: constant, by the square of the speed, or from a table.

Cylinders that fire at α_c repeat what is listed once: of order k, A e^{ikφ} becomes A Σ_c e^{ik(φ − α_c)}.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.elements import Disk
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.parameters import PackedLine
from trunnion.equations.loads import mean_loads
from trunnion.equations.topology import Topology
from trunnion.errors import InputError

BEYOND = 1e-9
"""Share by which a speed may lie beyond the end of a table, as rounding."""


def harmonic_torque(packed: PackedLine, topo: Topology, station: int, place: int, number: int, table: Array) -> Complex:
    """A e^{i phase} (case,) [N m] of the harmonic ``number`` (from 1) of a disk, all its cylinders together, at every
    row of packed numbers ``table`` (case, column), whose first one is the input speed.

    The disk is element ``place`` and stands at ``station``, where others may be rigidly joined to it.

    Raises
    ------
    InputError : a speed or a torque beyond the ends of a table.
    """
    disk = packed.line.elements[place]
    assert isinstance(disk, Disk)
    harmonic = disk.excitation[number - 1]
    sizes = table[:, packed.column(place, f"excitation {number} {size_of(harmonic)}")].astype(complex)
    speed = table[:, 0] * abs(float(topo.speed_ratio[station]))
    if harmonic.quadratic_amplitude is not None:
        sizes = sizes * speed**2
    elif harmonic.points:
        where = speed
        if harmonic.torques:
            where = -mean_loads(topo, packed.column, table)[:, station]
        sizes = sizes * _shape(harmonic, packed.line.names[place], number, where)
    phase = table[:, packed.column(place, f"excitation {number} phase")]
    return np.asarray(sizes * np.exp(1j * phase) * cylinders(disk, harmonic))


def size_of(harmonic: Excitation) -> str:
    """The key of its amplitude."""
    return "amplitude" if harmonic.quadratic_amplitude is None else "quadratic_amplitude"


def cylinders(disk: Disk, harmonic: Excitation) -> complex:
    """Σ_c e^{−ikα_c} over a disk's firing angles, without a cylinder that misfires; 1 where it has none."""
    if not disk.firing_angles or harmonic.order is None:
        return 1.0
    turned = np.exp(-1j * harmonic.order * np.array(disk.firing_angles))
    if disk.misfiring is not None and harmonic.quadratic_amplitude is None:
        turned = np.delete(turned, disk.misfiring - 1)
    return complex(turned.sum())


def _shape(harmonic: Excitation, name: str, number: int, where: Array) -> Complex:
    """A e^{i phase} of a table over its largest |A|, linear between its points."""
    points, largest = np.array(harmonic.points), harmonic.largest
    slack = BEYOND * np.abs(points).max()
    outside = ~((where >= points[0] - slack) & (where <= points[-1] + slack))
    if np.any(outside):
        apart = np.maximum(points[0] - where, where - points[-1])
        beyond = where[int(np.argmax(np.where(np.isnan(apart), np.inf, apart)))]
        asked = f"{beyond * 30 / np.pi:.5g} rpm of its disk" if harmonic.speeds else f"{beyond:.5g} N*m"
        raise InputError(
            f"is a table from {harmonic.covers}, which does not cover {asked}",
            element=name,
            key=f"excitation {number}",
            remedy="extend the table, or narrow the range of speeds",
        )
    phases = np.array(harmonic.phases) if harmonic.phases else np.zeros(len(points))
    values = np.array(harmonic.amplitudes) * np.exp(1j * phases) / (largest or 1.0)
    return np.asarray(np.interp(where, points, values.real) + 1j * np.interp(where, points, values.imag))

"""Newton's method for the periodic motions of long lines, whose slopes are entries of a tree.

About rotations x the linearised equations of ``linear`` are those of a correction δ, and their forcing what x leaves
unbalanced:

    M δ″ + C δ′ + K δ = f + T g,    phaseᵀ(x₀ + δ₀) = 0

g is what one N m more of the drives does. Harmonics of the matrices couple those of δ: Hill's blocks, eliminated along
the tree (``tree_hill``). A shift of the phase of a free line solves them without forcing, so that its first rotation is
held by as much stiffness as it has, and T takes the torque of that away again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Places
from trunnion.equations.given_rotation import GivenRotation
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.topology import Topology
from trunnion.equations.tree_matrices import tree_matrices
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.tree_blocks import TreeMatrix
from trunnion.steady.hill.tree_hill import TreeHill
from trunnion.waiting import keep_time


@dataclass(frozen=True)
class TreeMotions:
    """Rotations ``rows`` (case, n, 2h + 1) [rad], the ``torque`` (case,) [N m at the input] of the drives, and the size
    of the last correction (case,), in the units asked for."""

    rows: Array
    torque: Array
    size: Array

    def part(self, at: Places) -> TreeMotions:
        """Some of them."""
        return TreeMotions(self.rows[at], self.torque[at], self.size[at])


@dataclass(frozen=True)
class TreeNewton:
    """Motions of the lines ``co`` over a ``period`` [rad of input angle]; ``drive`` (case, station) [N m]: the loads of
    one N m of the drives at the input; ``held``: the rotation whose mean is 0, None of a line behind a prescribed
    speed."""

    topo: Topology
    co: LineCoefficients
    period: float
    drive: Array
    held: int | None

    def given(self, motions: TreeMotions) -> GivenRotation:
        """What the line is linearised about."""
        return GivenRotation(motions.rows, self.period, self.drive * motions.torque[:, None])

    def corrected(self, motions: TreeMotions, unit: Array, scale: float) -> TreeMotions:
        """One step further; a correction of ``scale`` [rad] counts as one, and of ``unit`` (case,) [N m]."""
        h = fourier.order(motions.rows)
        forcing, hill, driven = self.written(self.given(motions), 4 * h + 4)
        count = np.arange(-h, h + 1)
        s = np.asarray(1j * hill.step[:, None] * count, dtype=np.complex128)
        matrix, right, torque = hill.at(s, count), forcing[..., count], np.zeros(len(s))
        if self.held is None:
            change = matrix.solved(right)
        else:
            missing = -motions.rows[:, self.held, 0]
            change, drive = held_solution(matrix, right, driven[..., count], self.held, h, missing)
            torque = drive.real
        series = np.moveaxis(change[..., h:], 0, 1)
        rows = np.concatenate([series[..., :1].real, 2 * series[..., 1:].real, -2 * series[..., 1:].imag], axis=2)
        size = np.sqrt((np.abs(rows / scale) ** 2).sum(axis=(1, 2)) + (torque / unit) ** 2)
        return TreeMotions(motions.rows + rows, motions.torque + torque, size)

    def written(self, given: GivenRotation, times: int) -> tuple[Complex, TreeHill, Complex]:
        """What a motion leaves unbalanced, its linearised equations, and what one N m of the drives does, as spectra
        (n, case, time) of so many ``times`` of the period."""
        tau = self.period * np.arange(times) / times
        matrices = tree_matrices(self.topo, self.co, tau, given)
        rate = 2 * np.pi * self.co.speed / self.period
        hill = TreeHill(self.topo, matrices, np.zeros((len(rate), len(self.topo.compliances))), rate)
        both = [np.fft.fft(part, axis=1) / times for part in (matrices.forcing, self.driven(tau, given))]
        forcing, driven = (np.ascontiguousarray(np.moveaxis(part, 2, 0)) for part in both)
        return forcing, hill, driven

    def driven(self, tau: Array, given: GivenRotation) -> Array:
        """Torques (case, time, n) that one N m of the drives puts on the unknowns."""
        topo = self.topo
        found = np.zeros((len(self.drive), len(tau), topo.size))
        if not self.drive.any():
            return found
        motion = base_motion(topo, self.co, tau, given=given)
        sense = np.sign(topo.mean_speeds)
        for s in np.flatnonzero(self.drive.any(axis=0)).tolist():
            i = topo.coordinate[topo.group_of(s)]
            if i >= 0:
                found[..., i] -= motion.relative[..., s] * (self.drive[:, s] * sense[s])[:, None]
        return found


def held_solution(
    matrix: TreeMatrix, right: Complex, driven: Complex, held: int, still: int, value: Array
) -> tuple[Complex, Complex]:
    """Solutions (n, case, h) under ``right`` and as much of ``driven``, both of that shape, that the unknown ``held``
    has the ``value`` (case,) at the harmonic ``still``; and how much of it (case,).

    ``matrix`` is changed: nothing else resists a shift of the phase.
    """
    stiff = np.abs(matrix.own[..., still]).max(axis=0)
    matrix.own[held, :, still] += stiff
    right = right.astype(complex)
    right[held, :, still] += stiff * value
    first, second = matrix.solved(right), matrix.solved(driven)
    with np.errstate(all="ignore"):
        share = (value - first[held, :, still]) / second[held, :, still]
    return first + share[:, None] * second, share


def solved(
    lines: Callable[[Places], TreeNewton], rows: Array, unit: Array, scale: float, *, tolerance: float, most: int
) -> tuple[TreeMotions, Flags]:
    """Motions of ``lines``, by their numbers, from a guess ``rows`` (case, n, 2h + 1) on, and which were found; a case
    is given up where a correction is twice the one before it. ``unit`` and ``scale`` as of ``corrected``."""
    motions = TreeMotions(rows.copy(), np.zeros(len(rows)), np.full(len(rows), np.inf))
    found, left = np.zeros(len(rows), dtype=bool), np.arange(len(rows))
    for _ in range(most):
        keep_time()
        further = lines(left).corrected(motions.part(left), unit[left], scale)
        closer = further.size < 2 * motions.size[left]
        motions.rows[left], motions.torque[left], motions.size[left] = further.rows, further.torque, further.size
        found[left] = closer & (further.size < tolerance)
        left = left[closer & ~found[left]]
        if not len(left):
            break
    return motions, found

"""Small disturbances of the periodic motion of a free–free line under torques, solved by Hill's blocks: by the slopes
of the compiled equations, or along the tree of a long line.

At no frequency a shift of the phase solves the equations without forcing: the torque of the drives is one more unknown
there, and the mean deviation of the input is none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Integers
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.sparse_matrices import SparseMatrices
from trunnion.steady.free.free_balance import SteadyStates
from trunnion.steady.free.tree_newton import TreeMotions, held_solution
from trunnion.steady.hill.tree_hill import TreeHill


@dataclass(frozen=True)
class StateSlopes:
    """Fourier coefficients of the slopes of accelerations, ``by_state`` (case, harmonic, n, 2n) and ``by_drive`` (case,
    harmonic, n), the drives' torque; ``phase`` (n,): the input among the unknowns; ``rate`` (case,) [rad/s]."""

    by_state: Complex
    by_drive: Complex
    phase: Array
    rate: Array

    @classmethod
    def of(cls, motions: SteadyStates) -> StateSlopes:
        """Along the motions."""
        times = motions.times
        return cls(
            np.fft.fft(motions.sampled()[1], axis=1) / times,
            np.fft.fft(motions.by_drive(), axis=1) / times,
            motions.balance.phase,
            motions.rate,
        )

    def solved(self, carrier: Array, h: Integers, right: Complex) -> Complex:
        """X (case, h, n) [rad] at harmonics ``h`` under accelerations ``right`` (case, h, n).

        ``carrier`` (case,) [rad/s] is κΩ + ν. NaN where nothing resists the motion.
        """
        cases, times, n = self.by_drive.shape
        s = 1j * (carrier[:, None] + self.rate[:, None] * h)
        parts = fourier.hill_matrices(s, h, (-self.by_state[..., :n], -self.by_state[..., n:]))
        size = len(h) * n
        matrix = np.zeros((cases, size + 1, size + 1), dtype=complex)
        matrix[:, :size, :size] = SparseMatrices.added(size, parts).dense()
        every = np.arange(size)
        matrix[:, every, every] += np.repeat(s**2, n, axis=1)
        unit = np.abs(matrix[:, :size, :size]).max(axis=(1, 2))
        matrix[:, size, size] = unit
        if not carrier.any() and h[0] <= 0 <= h[-1]:
            column = self.by_drive[:, h % times].reshape(cases, size)
            at = int(-h[0]) * n
            matrix[:, :size, size] = -column * (unit / np.abs(column).max(axis=1))[:, None]
            matrix[:, size, at : at + n], matrix[:, size, size] = unit[:, None] * self.phase, 0.0
        forced = np.concatenate([right.reshape(cases, size), np.zeros((cases, 1))], axis=1)
        return np.asarray(fourier.solved(matrix, forced)[:, :size].reshape(cases, len(h), n))


@dataclass(frozen=True)
class TreeSlopes:
    """Entries of the tree along the motions, and the spectrum of the torques of one N m of the drives, ``driven`` (n,
    case, time); ``held``: the input among the unknowns."""

    hill: TreeHill
    driven: Complex
    held: int

    @classmethod
    def of(cls, motions: SteadyStates) -> TreeSlopes:
        """Along the motions."""
        newton = motions.balance.newton(motions.table)
        given = newton.given(TreeMotions(motions.rows, motions.torque, motions.torque))
        _, hill, driven = newton.written(given, motions.times)
        return cls(hill, driven, int(motions.balance.phase.argmax()))

    def solved(self, carrier: Array, h: Integers, right: Complex) -> Complex:
        """X (case, h, n) [rad] at harmonics ``h`` under torques ``right`` (case, h, n), as of ``StateSlopes``."""
        s = np.asarray(1j * (carrier[:, None] + self.hill.step[:, None] * h), dtype=np.complex128)
        matrix, torques = self.hill.at(s, h), np.ascontiguousarray(np.moveaxis(right, 2, 0))
        if not carrier.any() and h[0] <= 0 <= h[-1]:
            times = self.driven.shape[2]
            driven = np.where(2 * np.abs(h) < times, self.driven[..., h % times], 0.0)
            x = held_solution(matrix, torques, driven, self.held, int(-h[0]), np.zeros(len(carrier)))[0]
        else:
            x = matrix.solved(torques)
        return np.moveaxis(x, 0, 2)

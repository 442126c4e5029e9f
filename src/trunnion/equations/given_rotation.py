"""Periodic rotations of a line about which it is linearised, in place of those of rigid shafts at constant speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.numerics import harmonics as fourier


@dataclass(frozen=True)
class GivenRotation:
    """``rows`` (case, n, 2h + 1) [rad]: deviations of the unknowns from even rotation at the mean speed, as series of a
    ``period`` [rad of input angle]; ``load`` (case, station) [N m]: what acts on it besides the loads of the line,
    against the mean sense of rotation."""

    rows: Array
    period: float
    load: Array

    def at(self, tau: Array) -> tuple[Array, Array, Array]:
        """Deviations and their first and second derivatives by the input angle (case, time, n), at ``tau`` (time,)."""
        rate = 2 * np.pi / self.period
        parts, rows = list[Array](), self.rows
        for _ in range(3):
            parts.append(fourier.at(rows, rate * tau).swapaxes(1, 2))
            rows = fourier.rate(rows, rate)
        return parts[0], parts[1], parts[2]

    def shift(self, turn: Sequence[float] | Array) -> Array:
        """The states (x, dx/dτ) (case, 2n) that shift the phase of the motion, at τ = 0; the line turns as a whole by
        ``turn`` (n,) at its mean speed."""
        _, rate, bend = (part[:, 0] for part in self.at(np.zeros(1)))
        return np.concatenate([rate + np.asarray(turn), bend], axis=1)

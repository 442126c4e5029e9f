"""Speeds that a line is asked at to be compared with windows, in which its amplitudes change with the speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial
from numpy.polynomial.legendre import leggauss

from trunnion.arrays import Array, Complex, Flags, Places
from trunnion.measured.tracking.result import MeasuredOrders
from trunnion.measured.tracking.track import ROW
from trunnion.measured.tracking.within import middle_weights


@dataclass(frozen=True)
class WindowSpeeds:
    """speed (place,) [rad/s], the places of a window one after another; begin (window,): the first of each; weight
    (place, channel): by which amplitudes there count in the window's."""

    speed: Array
    begin: Places
    weight: Array

    def means(self, amplitude: Complex) -> Complex:
        """Amplitudes (line, window, order, channel) as windows show those (line, place, order, channel)."""
        if len(self.begin) == len(self.speed):
            return amplitude
        return np.asarray(np.add.reduceat(amplitude * self.weight[None, :, None, :], self.begin, axis=1))


def bent_windows(data: MeasuredOrders, rows: Places, columns: tuple[int, ...]) -> Flags:
    """Windows (row,) in which amplitudes bend by more than noise, and all of a run that has few."""
    if len(data.speed) < ROW:
        return np.ones(len(rows), dtype=bool)
    bend = np.nan_to_num(data.curvature[rows][:, :, list(columns)])
    whole = np.nan_to_num(data.deviation[rows][:, :, list(columns)])
    return np.asarray(np.any(2 * bend**2 > whole**2, axis=(1, 2)))


def window_speeds(
    data: MeasuredOrders, rows: Places, columns: tuple[int, ...], bent: Flags, nodes: int
) -> WindowSpeeds:
    """The middle of each window, and Gauss's nodes of those that are ``bent`` (row,)."""
    node = leggauss(nodes)[0]
    pulses = np.array([data.kinds[c] == "rotation" for c in columns])
    speeds, weights = [], []
    for row, many in zip(rows.tolist(), bent.tolist(), strict=True):
        if not many:
            speeds.append(data.speed[row : row + 1])
            weights.append(np.ones((1, len(columns))))
            continue
        window = data.rotation.windows[row]
        there = polynomial.polyval(node, polynomial.polyder(window.smooth)) / window.half
        # Teeth pass more densely where the shaft is faster; signals are sampled evenly in time.
        by_kind = middle_weights(data.degree, np.stack([np.ones(nodes), there / window.speed], axis=1), nodes)
        speeds.append(there)
        weights.append(by_kind[:, pulses.astype(int)])
    begin = np.cumsum([0, *(len(one) for one in speeds[:-1])])
    return WindowSpeeds(np.concatenate(speeds), begin.astype(np.intp), np.concatenate(weights))

"""How a line lags in a run, for lines beside one of which that is known.

The lag is linear in the steady response: an amplitude that is larger, turned or of the other sign lags alike. It is
scaled as that is, of each order and channel, and what is left changes with the free parameters to first order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.measured.identification.window_speeds import WindowSpeeds
from trunnion.measured.run_response import RunResponse


@dataclass(frozen=True)
class LinearLag:
    """The response on a run of a line and of lines beside it.

    at (free,): values of the line in SI units, of ranges ``width`` (free,). runs: of it, and of the lines in which one
    value is moved by ``step`` (free,); of it alone where its lag is too small to change.
    """

    at: Array
    width: Array
    step: Array
    runs: tuple[RunResponse, ...]

    def in_windows(self, speeds: WindowSpeeds) -> WindowLag:
        """As windows show it."""
        steady, lag = self._means(self.runs[0], speeds)
        slopes = np.zeros((len(self.at), *lag.shape), dtype=complex)
        for k, run in enumerate(self.runs[1:]):
            other, moved = self._means(run, speeds)
            share = share_of(other, steady)
            scaled = np.divide(moved, share, out=np.zeros_like(moved), where=share != 0)
            slopes[k] = (scaled - lag) * self.width[k] / self.step[k]
        before = speeds.means(self.runs[0].unsure_at(speeds.speed)[None].astype(complex))[0].real
        return WindowLag(self.at, self.width, steady, lag, slopes, np.asarray(np.maximum(before, 0.0)))

    @staticmethod
    def _means(run: RunResponse, speeds: WindowSpeeds) -> tuple[Complex, Complex]:
        steady, lag = (speeds.means(one(speeds.speed)[None])[0] for one in (run.steady_at, run.lag))
        return steady, lag


@dataclass(frozen=True)
class WindowLag:
    """Of a line at values ``at`` (free,): amplitudes (window, order, channel) of its steady response, its lag, the
    slopes of that (free, …) over shares of the ranges ``width``, and what is not known of it."""

    at: Array
    width: Array
    steady: Complex
    lag: Complex
    slopes: Complex
    before: Array

    def of(self, values: Array, steady: Complex) -> Complex:
        """The lag (window, order, channel) of a line at values (free,) whose steady response is ``steady``."""
        moved = np.tensordot((values - self.at) / self.width, self.slopes, axes=1)
        return np.asarray(share_of(steady, self.steady) * (self.lag + moved))

    def distance(self, values: Array) -> float:
        """How far values (free,) are, by the share of the ranges."""
        return float(np.abs((values - self.at) / self.width).max(initial=0.0))


def share_of(amplitude: Complex, other: Complex) -> Complex:
    """The complex factor of each order and channel (order, channel) by which ``other`` (window, order, channel) comes
    nearest to ``amplitude``; 0 where there is none."""
    square = (np.abs(other) ** 2).sum(axis=0)
    both = (other.conj() * amplitude).sum(axis=0)
    return np.asarray(np.divide(both, square, out=np.zeros_like(both), where=square > 0))

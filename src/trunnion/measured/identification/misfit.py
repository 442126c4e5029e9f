"""How badly a line fits measured orders: residuals over their standard deviations, constants of wheels set free.

A wheel's pitch errors add one constant to an order of a pickup at all speeds, known to a standard deviation τ: that of
the reference run's noise, or of the pitch errors as they are stated. Of each order and channel the constant that fits
best is taken off, and counts by itself: (Y − P e^{ikα} − C)/σ, and C/τ. Both are linear in P.

Where the line's amplitude P bends within a window, the window's mean of it is compared, and σ is that of noise alone.
Where the speed changes, P lags behind the steady response as ``linear_lag`` says.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from trunnion.arrays import Array, Complex, Flags, Places
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.tolerance.parameter_intervals import ParameterInterval, table_at
from trunnion.measured.identification.linear_lag import LinearLag, WindowLag
from trunnion.measured.identification.window_speeds import WindowSpeeds, bent_windows, window_speeds
from trunnion.measured.lag import channels_on_run
from trunnion.measured.predicted import PredictedChannels, best_angle, predicted_channels, turned, usable
from trunnion.measured.tracking.result import MeasuredOrders

STEP = 1e-4
"""Share of a parameter's range by which it is moved for a derivative, to either side."""
NODES, MOST_NODES = 12, 192
"""Speeds of a window in which amplitudes bend, doubled until they suffice."""
SETTLED = 0.05
"""Standard deviations by which means over a window may differ from those over twice as many speeds."""


@dataclass(frozen=True)
class Misfit:
    """Residuals of a line at values of its free parameters.

    channels : the measured ones. free : parameters. begin : rotation of the input [rad] at the first pulse, None where
    it is free too, and then the last of the unknowns. nodes : speeds of a window in which amplitudes bend. passed : how
    the line lags in the run, about some values; none where that is not counted.
    """

    channels: PredictedChannels
    free: tuple[ParameterInterval, ...]
    begin: float | None
    rows: Places
    nodes: int = NODES
    passed: tuple[LinearLag, ...] = ()

    @property
    def data(self) -> MeasuredOrders:
        """What was measured."""
        return self.channels.data

    def thinned(self, count: int) -> Misfit:
        """Over at most so many of its windows, spread evenly."""
        if len(self.rows) <= count:
            return self
        return replace(self, rows=self.rows[np.linspace(0, len(self.rows) - 1, count).astype(np.intp)])

    @cached_property
    def measured(self) -> Complex:
        """Amplitudes (window, order, channel) at the places."""
        return np.asarray(self.data.amplitude[self.rows][:, :, list(self.channels.columns)])

    @cached_property
    def bent(self) -> Flags:
        """Windows (window,) of which the line's mean is compared, not its amplitude in the middle."""
        return bent_windows(self.data, self.rows, self.channels.columns)

    @cached_property
    def speeds(self) -> WindowSpeeds:
        """That the line is asked at."""
        return window_speeds(self.data, self.rows, self.channels.columns, self.bent, self.nodes)

    @cached_property
    def _noise(self) -> Array:
        """Of the measurement alone."""
        columns = list(self.channels.columns)
        whole, bend = (one[self.rows][:, :, columns] for one in (self.data.deviation, self.data.curvature))
        counted = np.where(self.bent[:, None, None], whole**2 - bend**2, whole**2)
        known = usable(self.data, self.channels.columns)[self.rows] & (counted > 0)
        return np.asarray(np.where(known, np.sqrt(np.where(known, counted, 1.0)), np.inf))

    @cached_property
    def deviation(self) -> Array:
        """Standard deviations (window, order, channel) of either part, infinite of what is not known."""
        # How the line moved before the run is as little known as noise.
        return np.asarray(np.hypot(self._noise, self._lags[0].before)) if self.passed else self._noise

    @cached_property
    def constant(self) -> Array:
        """Standard deviations (order, channel) of either part of what a wheel adds."""
        return np.asarray(self.data.floor[:, list(self.channels.columns)] / np.sqrt(2))

    @property
    def count(self) -> int:
        """Real numbers that are compared."""
        return 2 * int(np.isfinite(self.deviation).sum())

    def predicted(self, values: Array) -> Complex:
        """Amplitudes (line, window, order, channel) at values (line, free)."""
        speeds = self.speeds.speed
        table = np.repeat(table_at(self.channels.assembly, self.free, values), len(speeds), axis=0)
        table[:, 0] = np.tile(speeds, len(values))
        made = self.channels.at(table)
        steady = self.speeds.means(made.reshape(len(values), len(speeds), *made.shape[1:]))
        if not self.passed:
            return steady
        return np.array([one + self._lag(own, one) for own, one in zip(values, steady, strict=True)])

    @cached_property
    def _lags(self) -> tuple[WindowLag, ...]:
        return tuple(one.in_windows(self.speeds) for one in self.passed)

    def _lag(self, values: Array, steady: Complex) -> Complex:
        """By the nearest of the lines whose lag is known."""
        return min(self._lags, key=lambda one: one.distance(values)).of(values, steady)

    def passing(self, points: Sequence[Array]) -> Misfit | None:
        """The misfit of lines that lag in the run, as about values (free,); None where that is not known."""
        found = [self._lag_about(one) for one in points]
        known = [one for one in found if one is not None]
        return replace(self, passed=tuple(known)) if len(known) == len(found) else None

    def _lag_about(self, values: Array) -> LinearLag | None:
        width = np.array([one.high - one.low for one in self.free])
        base = channels_on_run(self.channels, self._row(values))
        if base is None:
            return None
        alone = LinearLag(values, width, np.zeros(len(values)), (base,))
        lag = alone.in_windows(self.speeds).lag
        if float(np.linalg.norm(lag / self._noise)) < SETTLED:
            return alone
        runs, step = (
            [base],
            np.where(values + STEP * width <= [one.high for one in self.free], 1.0, -1.0) * STEP * width,
        )
        for k in range(len(values)):
            point = values.copy()
            point[k] += step[k]
            # At as many speeds, so that errors between them do not count as slopes.
            run = channels_on_run(self.channels, self._row(point), base.grid)
            if run is None:
                return None
            runs.append(run)
        return LinearLag(values, width, step, tuple(runs))

    def _row(self, values: Array) -> Array:
        return np.asarray(table_at(self.channels.assembly, self.free, values[None])[0])

    def apart(self, other: Misfit, values: Array) -> float:
        """How far the lag at values (free,) is from that of another misfit, in standard deviations, all windows
        together."""
        steady = replace(self, passed=()).predicted(values[None])[0]
        lags = [one._lag(values, steady) if one.passed else np.zeros_like(steady) for one in (self, other)]
        return float(np.linalg.norm((lags[0] - lags[1]) / self.deviation))

    def finer(self, values: Array) -> Misfit | None:
        """Over twice as many speeds a window, where means at values (free,) differ by them; None where they do not."""
        if not self.bent.any():
            return None
        twice = replace(self, nodes=2 * self.nodes)
        apart = np.abs(twice.predicted(values[None])[0] - self.predicted(values[None])[0]) / self.deviation
        return twice if apart.max(initial=0.0) > SETTLED else None

    def angle(self, predicted: Complex) -> float:
        """Rotation of the input at the first pulse [rad] that fits best."""
        if self.begin is not None:
            return self.begin
        # What a constant may take counts for little in the search.
        weight = 1 / (self.deviation**2 + self.constant**2)
        return best_angle(self.measured, predicted, weight, self.data.order)

    def residuals(self, predicted: Complex, angle: float) -> Array:
        """(residual,) of amplitudes (window, order, channel)."""
        return self._weighed(self.measured - turned(predicted, self.data.order, angle))

    def _weighed(self, off: Complex) -> Array:
        """Differences (window, order, channel) over deviations, their constants taken off."""
        weight = 1 / self.deviation
        known = np.where(weight > 0, off, 0.0)
        tau = self.constant
        with np.errstate(divide="ignore"):
            prior = np.where(tau > 0, 1 / tau, 0.0)
        held = (weight**2).sum(axis=0) + prior**2
        constant = np.where(tau > 0, (weight**2 * known).sum(axis=0) / np.where(held > 0, held, 1.0), 0.0)
        own = (weight * (known - constant)).ravel()
        beside = (prior * constant).ravel()
        return np.concatenate([own.real, own.imag, beside.real, beside.imag])

    def chi_square(self, predicted: Complex) -> float:
        """Sum of squares at the best angle."""
        found = self.residuals(predicted, self.angle(predicted))
        return float(found @ found)

    def linear(self, values: Array, angle: float, *, both: bool = True) -> tuple[Array, Array]:
        """Residuals (residual,) and their slopes (residual, unknown) over shares of the ranges, and over the angle.

        both : whether slopes are by differences to either side; else to one, as descents need them, in fewer lines.
        """
        moved, ends = [values], []
        for k, one in enumerate(self.free):
            step = STEP * (one.high - one.low)
            low, high = max(values[k] - step, one.low), min(values[k] + step, one.high)
            if not both:
                low, high = (values[k], high) if high > values[k] else (low, values[k])
            places = []
            for end in (low, high):
                if end != values[k] or both:
                    point = values.copy()
                    point[k] = end
                    moved.append(point)
                    places.append(len(moved) - 1)
                else:
                    places.append(0)
            ends.append((places, (high - low) / (one.high - one.low)))
        every = self.predicted(np.array(moved))
        orders = self.data.order
        slopes = [self._weighed(-turned(every[b] - every[a], orders, angle)) / width for (a, b), width in ends]
        if self.begin is None:
            slopes.append(self._weighed(-turned(1j * orders[:, None] * every[0], orders, angle)))
        return self.residuals(every[0], angle), np.stack(slopes, axis=1)


def misfit_of(
    assembly: Assembly,
    data: MeasuredOrders,
    free: Sequence[ParameterInterval],
    begin: float | None,
    rows: Places | None = None,
) -> Misfit:
    """The misfit of a line whose numbers are free, over some ``rows`` (window,) of the data."""
    every = np.arange(len(data.speed)) if rows is None else rows
    return Misfit(predicted_channels(assembly, data), tuple(free), begin, every)

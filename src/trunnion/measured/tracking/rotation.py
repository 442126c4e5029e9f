"""How a shaft turned: windows of whole turns of a pulse train, and the smooth rotation under them.

Within a window the angle counted by the teeth is

    θ_j + p_n = P(t_j) + Σ_k Re[Y_k(t_j) e^{ikφ(t_j)}],        φ = P/ratio,

P a cubic of time, Y_k quadratics (constants of a steady run), p_n how far beyond its even place the edge of tooth n
stands. With φ known it is linear
in all of these; φ is P itself and comes by a few rounds. P is the mean rotation: what repeats with the shaft is not in
it, as a window is whole turns long.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicHermiteSpline

from trunnion.arrays import Array, Complex, Flags, Integers
from trunnion.errors import InputError
from trunnion.measured.signals.measurement import PulseTrain
from trunnion.measured.tracking.within import missed_in_the_middle
from trunnion.results.counts import counted

SMOOTH = 4
"""Coefficients of the cubic of a window."""
ROUNDS, SETTLED = 8, 1e-12
"""Rounds of φ, and the change of an angle [rad] that ends them."""
WORST_CONDITION = 1e10
"""Condition number of the normal equations up to which a window counts."""


@dataclass(frozen=True)
class WindowFit:
    """Least squares over one window.

    amplitude (order,), and its standard deviation (order,) of either part; smooth (c,): coefficients of powers of the
    time from the middle over half the length; residual (sample,); freedom: samples beyond the unknowns; noise: standard
    deviation of a sample; s, phase, orders, trend: what was fitted to.
    """

    amplitude: Complex
    deviation: Array
    smooth: Array
    residual: Array
    freedom: int
    noise: float
    s: Array
    phase: Array
    orders: Array
    trend: int

    @cached_property
    def _misses(self) -> tuple[Array, Array]:
        # Not of every fit: the rounds of a rotation and of pitch errors ask for none.
        return missed_in_the_middle(self.residual, self.s, self.phase, self.orders, self.trend, self.noise)

    @property
    def missed(self) -> Array:
        """How far amplitudes (order,) are off where they change otherwise than their polynomials, by the residual."""
        return self._misses[0]

    @property
    def chance(self) -> Array:
        """What noise makes of ``missed`` (order,)."""
        return self._misses[1]


def fitted(y: Array, s: Array, phase: Array, orders: Array, smooth: int, trend: int) -> WindowFit | None:
    """Fit ``y`` (sample,) at times ``s`` (sample,) from −1 to 1 and rotations ``phase`` (sample,) [rad].

    smooth : coefficients of the polynomial beside the orders. trend : degree to which amplitudes follow ``s``.
    None where the samples do not tell the unknowns apart.
    """
    powers = s[:, None] ** np.arange(max(smooth, trend + 1))
    swing = np.exp(1j * np.multiply.outer(phase, orders))
    waves = (powers[:, : trend + 1, None] * swing[:, None, :]).reshape(len(y), -1)
    matrix = np.concatenate([powers[:, :smooth], waves.real, -waves.imag], axis=1)
    freedom = len(y) - matrix.shape[1]
    if freedom < 1:
        return None
    scale = np.sqrt((matrix**2).sum(axis=0))
    if not np.all(scale > 0):
        return None
    normal = (matrix / scale).T @ (matrix / scale)
    if np.linalg.cond(normal) > WORST_CONDITION:
        return None
    inverse = np.linalg.inv(normal)
    found = (inverse @ (matrix.T @ y / scale)) / scale
    residual = y - matrix @ found
    noise = float(np.sqrt(residual @ residual / freedom))
    spread = np.sqrt(np.diag(inverse)) * noise / scale
    count, each = len(orders), (trend + 1) * len(orders)
    real, imaginary = slice(smooth, smooth + count), slice(smooth + each, smooth + each + count)
    deviation = np.sqrt((spread[real] ** 2 + spread[imaginary] ** 2) / 2)
    amplitude = found[real] + 1j * found[imaginary]
    return WindowFit(
        amplitude, deviation, found[:smooth], residual, freedom, noise=noise, s=s, phase=phase, orders=orders,
        trend=trend,
    )  # fmt: skip


@dataclass(frozen=True)
class RotationWindow:
    """A window of a reference pickup: edges from ``first`` to before ``last``, its middle and half its length [s].

    ``smooth``: the mean rotation of the input [rad], coefficients as of ``WindowFit``.
    """

    first: int
    last: int
    middle: float
    half: float
    smooth: Array

    def local(self, times: ArrayLike) -> Array:
        """Times from the middle over half the length."""
        return np.asarray((np.asarray(times) - self.middle) / self.half)

    def angle(self, times: ArrayLike) -> Array:
        """Mean rotation of the input [rad] at times (m,)."""
        return np.asarray(np.polynomial.polynomial.polyval(self.local(times), self.smooth))

    @property
    def speed(self) -> float:
        """Of the input in the middle [rad/s]."""
        return float(self.smooth[1] / self.half)

    @property
    def acceleration(self) -> float:
        """In the middle [rad/s²]."""
        return float(2 * self.smooth[2] / self.half**2)


@dataclass(frozen=True)
class MeasuredRotation:
    """The mean rotation of the input over time, from a reference pickup.

    windows : by time. ratio : turns of the pickup's shaft for one of the input.
    """

    windows: tuple[RotationWindow, ...]
    ratio: float

    @cached_property
    def _spline(self) -> CubicHermiteSpline:
        first, last = self.windows[0], self.windows[-1]
        times = [first.middle - first.half, *(one.middle for one in self.windows), last.middle + last.half]
        owners = [first, *self.windows, last]
        angles = [float(one.angle(t)) for one, t in zip(owners, times, strict=True)]
        slopes = [
            float(np.polynomial.polynomial.polyval(one.local(t), np.polynomial.polynomial.polyder(one.smooth)))
            / one.half
            for one, t in zip(owners, times, strict=True)
        ]
        return CubicHermiteSpline(times, angles, slopes)

    def angle_at(self, times: ArrayLike) -> Array:
        """Mean rotation of the input [rad] at ``times`` (m,) [s]."""
        return np.asarray(self._spline(times))

    def speed_at(self, times: ArrayLike) -> Array:
        """Its speed [rad/s]."""
        return np.asarray(self._spline(times, 1))

    @property
    def span(self) -> tuple[float, float]:
        """First and last time [s] that it is known at."""
        return float(self._spline.x[0]), float(self._spline.x[-1])

    def time_at(self, angle: Array) -> Array:
        """Times [s] at rotations ``angle`` (m,) [rad] within the span."""
        first, last = self.span
        grid = np.linspace(first, last, 8 * len(self.windows) + 1)
        times = np.interp(angle, self.angle_at(grid), grid)
        for _ in range(30):
            step = (self.angle_at(times) - angle) / self.speed_at(times)
            times = np.clip(times - step, first, last)
            if np.abs(step).max(initial=0.0) <= 1e-15 * max(abs(last), 1.0):
                break
        return times


def window_edges(train: PulseTrain, turns: int) -> list[tuple[int, int]]:
    """Places of the edges that begin and end windows of whole turns, one after another, the last end included."""
    step = turns * train.pulses_per_turn
    starts = np.arange(train.number[0], train.number[-1] - step + 1, step)
    first, last = np.searchsorted(train.number, starts), np.searchsorted(train.number, starts + step)
    least = step // 2
    return [(int(a), int(b)) for a, b in zip(first, last, strict=True) if b - a >= least]


def rotation_windows(
    train: PulseTrain, ratio: float, turns: int, orders: Array, pattern: Array, trend: int
) -> tuple[tuple[RotationWindow, ...], list[WindowFit]]:
    """Windows of a reference pickup with the mean rotation of the input, and their fits [rad of the pickup].

    pattern : pitch error of every tooth (tooth,) [rad].

    Raises
    ------
    InputError : no window, or none that tells its orders apart.
    """
    windows: list[RotationWindow] = []
    fits: list[WindowFit] = []
    angle = train.angle + pattern[train.tooth]
    for first, last in window_edges(train, turns):
        times = train.times[first:last]
        middle, half = (times[0] + times[-1]) / 2, (times[-1] - times[0]) / 2
        s, y, phase = (times - middle) / half, angle[first:last], angle[first:last] / ratio
        offset = y[len(y) // 2]
        found: WindowFit | None = None
        for _ in range(ROUNDS):
            found = fitted(y - offset, s, phase, orders, SMOOTH, trend)
            if found is None:
                break
            before, phase = phase, (np.polynomial.polynomial.polyval(s, found.smooth) + offset) / ratio
            if np.abs(phase - before).max() < SETTLED * max(1.0, abs(offset)):
                break
        if found is None:
            continue
        smooth = found.smooth.copy()
        smooth[0] += offset
        windows.append(RotationWindow(first, last, float(middle), float(half), smooth / ratio))
        fits.append(found)
    if not windows:
        raise InputError(
            f"has no window of {turns} turns that tells {counted(len(orders), 'order')} apart", element=train.name,
            key="window", value=turns,
            remedy="ask for fewer orders or longer windows; a wheel shows orders below half its pulses",
        )  # fmt: skip
    return tuple(windows), fits


def tooth_means(values: Array, tooth: Integers, teeth: int) -> tuple[Array, Array]:
    """Mean of ``values`` (edge,) by ``tooth`` (edge,), NaN where there is none, and how many each has."""
    count = np.bincount(tooth, minlength=teeth)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.bincount(tooth, values, minlength=teeth) / count, count.astype(float)


def repeated(residuals: list[Array], tooth: list[Integers], teeth: int) -> Array:
    """Pitch errors (tooth,) [rad] that take off what repeats with the teeth in residuals, of whole turns each."""
    means = tooth_means(np.concatenate(residuals), np.concatenate(tooth), teeth)[0]
    return -np.asarray(np.nan_to_num(means - np.nanmean(means)))


def is_whole(values: Array) -> Flags:
    """Which are whole numbers, up to rounding."""
    return np.asarray(np.abs(values - np.rint(values)) < 1e-6)

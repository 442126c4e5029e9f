"""What a line answers while its speed changes evenly: the steady response, and how far it lags behind that.

An order n of the speed Ω(t), Ω′ = α, has the frequency ν = nΩ. Of a response h(s) to a force F e^{iψ}, ψ′ = ν, the
phase of the past is ψ(t − s) = ψ − νs + nα s²/2, and so

    Y = ∫ h(s) e^{−iνs + inαs²/2} ds F = exp(−iα/(2n) d²/dΩ²) G,        G = H(nΩ) F,

where F does not change with the speed, or slowly. A wave e^{iκΩ} of G over the speed is multiplied by e^{iακ²/(2n)}:
two Fourier transforms. At the top of a mode of decay d (half width of its resonance in ν) the first term is nα/d² of G:
a run has to stay in a resonance for several times that its motion takes to die out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.fft import fft, ifft, next_fast_len
from scipy.interpolate import CubicSpline

from trunnion.arrays import Array, Complex
from trunnion.errors import ComputationError, InputError
from trunnion.waiting import keep_time

FIRST_GRID, LAST_GRID = 65, 16385
"""Speeds at which the response is computed, doubled until it is smooth between them."""
BETWEEN = 2e-5
"""Largest error between speeds, relative to the largest amplitude of a channel."""
REACH = 6.0
"""Widths √(2π|α/n|) behind the end of a run by which the line beyond it still matters."""
LOWEST = 0.25
"""Share of the last speed of a run-down below which nothing is asked of the line."""


class SharpError(ComputationError):
    """A response that is not smooth over as many speeds as there may be, most of all ``at`` one [rad/s]."""

    def __init__(self, message: str, at: float) -> None:
        super().__init__(message)
        self.at = at


@dataclass(frozen=True)
class RunResponse:
    """Amplitudes over the speed of a run.

    speed (speed,) [rad/s], rising and covering the run; steady, passing (speed, order, channel): of the steady response
    and on the run; unsure (speed, order, channel): how far the motion before the run, which is not known, may change
    that; error: of ``passing``, relative to the largest amplitude of a channel; grid: number of speeds at which the
    steady response was asked for.
    """

    speed: Array
    steady: Complex
    passing: Complex
    unsure: Array
    error: float
    grid: int

    @cached_property
    def _splines(self) -> tuple[CubicSpline, CubicSpline, CubicSpline]:
        lag = self.passing - self.steady
        return tuple(CubicSpline(self.speed, one) for one in (self.steady, lag, self.unsure))  # type: ignore[return-value]

    def steady_at(self, speed: Array) -> Complex:
        """The steady response (m, order, channel) at speeds (m,) of the run."""
        return np.asarray(self._splines[0](speed))

    def lag(self, speed: Array) -> Complex:
        """What is added to it on the run (m, order, channel)."""
        return np.asarray(self._splines[1](speed))

    def unsure_at(self, speed: Array) -> Array:
        """How far the motion before the run may change that (m, order, channel)."""
        return np.asarray(np.abs(self._splines[2](speed)))

    @property
    def largest(self) -> Array:
        """Of the steady response (order, channel)."""
        return np.asarray(np.abs(self.steady).max(axis=0))


def run_response(
    respond: Callable[[Array], Complex],
    low: float,
    high: float,
    acceleration: float,
    order: Array,
    first: int = FIRST_GRID,
) -> RunResponse:
    """The response on a run between two speeds [rad/s] at ``acceleration`` [rad/s²], negative for a run-down.

    respond : speeds (m,) → steady amplitudes (m, order, channel). order (order,): cycles per turn of the input.
    first : number of speeds to begin with.

    Raises
    ------
    ComputationError : the response is not smooth over many speeds. InputError : as of ``respond``.
    """
    begin, end = (low, high) if acceleration > 0 else (high, low)
    turning = np.abs(order[order != 0])
    reach = REACH * np.sqrt(2 * np.pi * abs(acceleration) / turning.min()) if len(turning) else 0.0
    before, beyond = _beyond(begin, acceleration, -reach), _beyond(end, acceleration, reach)
    speed, steady, error = _as_far_as_stated(respond, (low, high), (before, beyond), first)
    sense = 1.0 if acceleration > 0 else -1.0
    step = float(speed[1] - speed[0])
    run = _Run(CubicSpline(speed, steady), begin, sense, reach, acceleration, order)
    ahead, past = (float(max(sense * (one - begin) * turn for one in speed[[0, -1]])) for turn in (1, -1))
    count = 2 * round(ahead / step / 2) + 1
    there, passing, unsure = run.passing(ahead / (count - 1), count, past)
    half = run.passing(2 * ahead / (count - 1), count // 2 + 1, past)[1]
    scale = np.abs(steady).max(axis=(0, 1), initial=0.0)
    off = np.abs(half - passing[::2]).max(axis=(0, 1), initial=0.0) / 16
    error = max(error, float(np.max(off / np.where(scale > 0, scale, 1.0), initial=0.0)))
    rank = np.argsort(there)
    rank = rank[(there[rank] > low - 1.5 * step) & (there[rank] < high + 1.5 * step)]
    return RunResponse(there[rank], run.steady(there[rank]), passing[rank], unsure[rank], error, len(speed))


def _beyond(end: float, acceleration: float, reach: float) -> float:
    """A speed further on by ``reach``, not far below the slower."""
    there = end + float(np.copysign(1.0, acceleration)) * reach
    return max(there, LOWEST * end)


def _as_far_as_stated(
    respond: Callable[[Array], Complex], run: tuple[float, float], beyond: tuple[float, float], first: int
) -> tuple[Array, Complex, float]:
    """As ``smooth_response``, of the run with what is before and behind it where the line answers there.

    beyond : speeds before the begin of the run and behind its end.
    """
    low, high = run
    for far in ((*run, *beyond), (*run, beyond[1])):
        try:
            return smooth_response(respond, min(far), max(far), first)
        except SharpError as error:
            if low <= error.at <= high:  # so it is without what lies beyond
                raise
        except (ComputationError, InputError):
            continue  # what a line states over the speed may end with the run, or a resonance beyond it be sharp
    return smooth_response(respond, low, high, first)


@dataclass(frozen=True)
class _Run:
    """Steady amplitudes over the speed, and a run from ``begin`` on, ``sense`` 1 up or −1 down; ``reach`` [rad/s]
    within which amplitudes go on evenly beyond what is known of them."""

    steady: CubicSpline
    begin: float
    sense: float
    reach: float
    acceleration: float
    order: Array

    def passing(self, step: float, count: int, past: float) -> tuple[Array, Complex, Array]:
        """Speeds (count,) at even steps, amplitudes there, and by how much these differ if before the run the line kept
        the motion of its begin, or came from as far as ``past`` [rad/s] before it."""
        size = next_fast_len(3 * count)
        speed = np.asarray(self.begin + self.sense * step * np.arange(count), dtype=float)
        own = np.asarray(self.steady(speed))
        away = step * np.arange(1, size - count + 1)
        reach = min(self.reach, away[-1] / 4)
        after = self._evenly(speed[-1], away, reach)
        before = away[::-1]
        evenly = self._evenly(self.begin, -before, reach)
        kept = np.broadcast_to(own[0], evenly.shape)
        known = before <= past
        came = self._evenly(self.begin - self.sense * past, past - before, reach)
        came[known] = self.steady(self.begin - self.sense * before[known])
        over = _step((away / away[-1] - 0.25) / 0.5)[:, None, None]
        turning = self.order != 0
        part = np.where(turning, 0.5 * self.acceleration / np.where(turning, self.order, 1.0), 0.0)
        turned = np.exp(1j * np.multiply.outer((2 * np.pi * np.fft.fftfreq(size, step)) ** 2, part))[:, :, None]

        def on_run(earlier: Complex) -> Complex:
            whole = np.concatenate([own, (1 - over) * after + over * earlier])
            return np.asarray(ifft(turned * fft(whole, axis=0), axis=0)[:count])

        passing = on_run(evenly)
        unsure = np.maximum(*(np.abs(passing - on_run(other)) for other in (kept, came)))
        return np.asarray(speed), passing, np.asarray(unsure)

    def _evenly(self, speed: float, away: Array, reach: float) -> Complex:
        """What goes on (m, …) from a speed by value, slope and bend there, ``away`` (m,) in the sense of the run; slope
        and bend fade within ``reach``."""
        value, slope, bend = (self.steady(speed, nu) for nu in range(3))
        far = self.sense * away[:, None, None]
        fades = 1 - _step(np.abs(away) / reach if reach > 0 else np.ones(len(away)))
        return np.asarray(value + (slope * far + bend * far**2 / 2) * fades[:, None, None])


def _step(share: Array) -> Array:
    """From 0 to 1 between 0 and 1, every derivative of it zero at both."""

    def rises(x: Array) -> Array:
        inside = x > 0
        return np.where(inside, np.exp(-1 / np.where(inside, x, 1.0)), 0.0)

    up, down = rises(np.asarray(share)), rises(1 - np.asarray(share))
    return np.asarray(up / (up + down))


def smooth_response(
    respond: Callable[[Array], Complex], low: float, high: float, first: int
) -> tuple[Array, Complex, float]:
    """Speeds so near that amplitudes (speed, order, channel) are smooth between them, these, and the error of a spline
    between them, relative to the largest of a channel.

    Raises
    ------
    SharpError : they are not smooth over ``LAST_GRID`` speeds, or infinite.
    """
    speed = np.linspace(low, high, first)
    values = respond(speed)
    while True:
        keep_time()
        error = between(speed, values)
        if error <= BETWEEN:
            return speed, values, error
        count = 2 * len(speed) - 1
        if count > LAST_GRID or not np.isfinite(error):
            raise SharpError(
                f"the response is not smooth over {len(speed)} speeds (error {error:.2g}): a resonance without "
                "damping; give the line damping, or ask for a smaller range",
                _sharpest(speed, values),
            )
        finer = np.linspace(low, high, count)
        every = np.empty((count, *values.shape[1:]), dtype=complex)
        every[::2], every[1::2] = values, respond(finer[1::2])
        speed, values = finer, every


def _sharpest(speed: Array, values: Complex) -> float:
    """The speed beside which amplitudes (speed, order, channel) bend most, or are not finite."""
    size = np.abs(values).max(axis=(1, 2))
    if not np.isfinite(size).all():
        return float(speed[int(np.argmin(np.isfinite(size)))])
    scale = np.abs(values).max(axis=(0, 1))
    bend = np.abs(np.diff(values, 4, axis=0)).max(axis=1) / np.where(scale > 0, scale, 1.0)
    return float(speed[2 + int(bend.max(axis=1).argmax())])


def between(speed: Array, values: Complex) -> float:
    """Error in the middles of a spline through amplitudes (speed, order, channel), relative to the largest of a
    channel; infinite where one is not finite."""
    if not values.size:
        return 0.0
    if not np.isfinite(values).all():
        return np.inf
    whole = CubicSpline(speed[::2], values[::2])(speed[1::2])
    scale = np.abs(values).max(axis=(0, 1))
    # A spline's error falls with the fourth power of the step: half the step has a sixteenth.
    off = np.abs(whole - values[1::2]).max(axis=(0, 1)) / 16
    return float(np.max(off / np.where(scale > 0, scale, 1.0), initial=0.0))

"""Orders of measured channels, window by window of whole turns, with what noise and wheels leave uncertain."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from scipy.ndimage import maximum_filter1d

from trunnion.arrays import Array, Complex, Flags
from trunnion.driveline.arguments import numbers, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.refusals import nearest
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.measured.signals.measurement import TURN, Channel, Measurement, PulseTrain, SampledSignal
from trunnion.measured.signals.thinning import thinned
from trunnion.measured.tracking.clocks import ClockCorrection, clock_correction
from trunnion.measured.tracking.pitch import PitchErrors
from trunnion.measured.tracking.places import speed_ratios
from trunnion.measured.tracking.result import MeasuredOrders
from trunnion.measured.tracking.rotation import (
    MeasuredRotation,
    RotationWindow,
    WindowFit,
    fitted,
    is_whole,
    repeated,
    rotation_windows,
)
from trunnion.measured.tracking.run_ups import MeasuredRamp, longest_ramp, run_ups
from trunnion.measured.tracking.standing_out import standing_out
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.units import figures
from trunnion.waiting import keep_time

WINDOW = 8
SMOOTH_BESIDE = 3
"""Coefficients of the polynomial beside the orders of a channel that is not the reference."""
STEADY = 2e-3
"""Relative change of speed within a window up to which amplitudes are taken as constant."""
MOST_ORDERS, SHARE = 12, 0.02
"""Orders found by themselves: how many, and their least share of the largest."""
HIGHEST = 24.0
OVERSAMPLED = 16.0
"""Samples per cycle of the highest order that a sampled signal keeps."""
SAME_RATIO, SWING = 5e-4, 0.05
"""Share within which ratios of speeds are one, and turns by which a shaft may swing at the ends of what is counted."""
ROW = 5
"""Windows from which a row of them tells how amplitudes bend."""
SHARP = 2.0
"""Times of what noise looks like beyond which residuals of a window in such a row tell of a bend within it."""
TOO_LONG = 0.01
"""Share of the largest amplitude that windows may miss beside a resonance before that is said."""
LIKE_A_WHEEL = 3.0
"""Times of what pitch errors leave below which a whole order is not taken for the shaft's by itself."""
SEEN, ALIKE = 3.0, 0.25
"""Noise from which a wheel has pitch errors at all, and the share of what the second best tooth leaves that the best
may leave."""


def track_orders(
    measurement: Measurement,
    orders: Iterable[float] | None = None,
    *,
    line: Driveline | Assembly | None = None,
    reference: str = "",
    calibration: PitchErrors | None = None,
    window: int = WINDOW,
    between: tuple[float, float] | None = None,
    unit: str = "",
    progress: Callable[[float], None] | None = None,
) -> MeasuredOrders:
    """Amplitude and phase of orders over speed, of every channel, by least squares over windows of whole turns.

    Orders, and phases, are taken by the mean rotation of the input, which the reference pickup gives: the angle at the
    edge is known, and what repeats with the shaft averages out over whole turns.

    Parameters
    ----------
    measurement : the signals; one channel at least is a pulse train.
    orders : in cycles per turn of the input; default: those that stand out of the noise of the pulse trains, twelve at
        most.
    line : gives the speed ratio of each channel's place; without it ratios are counted, and the reference's shaft is
        the input.
    reference : name of the pulse train that the rotation is taken from; default the first.
    calibration : pitch errors of the wheels, from ``pitch_errors``.
    window : turns of the reference's shaft in a window.
    between : first and last time [s]; default the longest run-up or run-down, or all where there is none.
    unit : of speeds in print, default of the line, else rpm.
    progress : called as progress(share done).

    Raises
    ------
    InputError : no pulse train; a channel or order that cannot be; windows that do not tell the orders apart.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> rotation = 2 * np.pi * np.arange(60 * 40) / 60
    >>> times = (rotation - 1e-3 * np.cos(2 * rotation)) / 100.0
    >>> found = tn.track_orders(tn.Measurement([tn.PulseTrain(times, 60, name="wheel")]), [2])
    >>> round(float(abs(found.amplitude[0, 0, 0])), 7)
    0.001
    """
    trains = measurement.pulses
    if not trains:
        raise InputError(
            "has no pulse train, so nothing says how the shaft turned", key="measurement", value=measurement.source,
            remedy='describe one channel as kind = "pulses"',
        )  # fmt: skip
    main = trains[0] if not reference else measurement.channel(reference)
    if not isinstance(main, PulseTrain):
        raise InputError("is not a pulse train", key="reference", value=reference, remedy=f"take {trains[0].name}")
    turns = whole_number(window, "window", 1)
    given = None if line is None else assemble(line)
    places = {} if given is None else speed_ratios(given)
    if places and main.at and main.at not in places:
        remedy = nearest(main.at, list(places))
        raise InputError("is not a disk of the line", element=main.name, key="at", value=main.at, remedy=remedy)
    problem = _Tracking(measurement, main, places, calibration, turns)
    stretch = _stretch(main, between)
    problem.cut(stretch[0], stretch[1])
    wanted = problem.own_orders() if orders is None else _orders_of(orders)
    unit = unit or (speed_unit(given.line) if given is not None else "rpm")
    return problem.result(wanted, unit, stretch, progress)


def _orders_of(orders: Iterable[float]) -> Array:
    found = np.unique(numbers(list(orders), "orders", "[1, 2, 4], say"))
    if not (np.all(np.isfinite(found)) and np.all(found > 0)):
        raise InputError("must be positive", key="orders", value=found.tolist(), remedy="[1, 2, 4], say")
    return found


def _stretch(main: PulseTrain, between: tuple[float, float] | None) -> MeasuredRamp:
    whole = MeasuredRamp(float(main.times[0]), float(main.times[-1]), 0.0, 0.0)
    if between is None:
        return longest_ramp(run_ups(main)) or whole
    first, last = (float(one) for one in between)
    if not whole.first_time <= last > first <= whole.last_time:
        raise InputError(
            f"is outside the recording, {figures(whole.first_time)} to {figures(whole.last_time)} s", key="between",
            value=[first, last], remedy="give two rising times in seconds",
        )  # fmt: skip
    return MeasuredRamp(first, last, 0.0, 0.0)


@dataclass(frozen=True)
class _Tracked:
    """What was found of one channel; missed and chance (window, order) as of ``WindowFit``."""

    amplitude: Complex
    deviation: Array
    missed: Array
    chance: Array
    residual: Array
    extreme: Array

    def curvature(self, degree: int) -> Array:
        """What polynomials of a ``degree`` over the windows miss (window, order)."""
        if len(self.amplitude) < ROW:
            # Nothing beside a window tells how an amplitude bends: its own residuals do, noise and all.
            return np.asarray(np.sqrt(np.maximum(self.missed**2 - self.chance**2, 0.0)))
        # The row of windows tells better, but not of what bends within one of them alone.
        sharp = np.where(self.missed > SHARP * self.chance, self.missed, 0.0)
        return np.maximum(bent(self.amplitude), sharp) if degree else sharp


def _tracked(
    fits: Sequence[WindowFit | None], orders: Array, *, reversed_: bool = False, extreme: Array | None = None
) -> _Tracked:
    """Fits window by window as one channel; NaN of windows that have none."""
    nothing = np.full(len(orders), np.nan)

    def rows(of: Callable[[WindowFit], Array]) -> Array:
        return np.array([nothing if fit is None else of(fit) for fit in fits])

    residual = [np.nan if one is None else np.sqrt(one.residual @ one.residual / one.freedom) for one in fits]
    return _Tracked(
        np.array([nothing + 0j if one is None else -one.amplitude if reversed_ else one.amplitude for one in fits]),
        rows(lambda one: one.deviation), rows(lambda one: one.missed), rows(lambda one: one.chance),
        np.array(residual), np.full(len(fits), np.nan) if extreme is None else extreme,
    )  # fmt: skip


class _Tracking:
    """One measurement, its reference and ratios."""

    def __init__(
        self,
        measurement: Measurement,
        main: PulseTrain,
        places: dict[str, float],
        calibration: PitchErrors | None,
        turns: int,
    ) -> None:
        self.measurement, self.main, self.places = measurement, main, places
        self.calibration, self.turns = calibration, turns
        self.ratio = abs(places.get(main.at) or 1.0)
        self.aligned: dict[str, tuple[Array, float]] = {}
        self.findings: list[Finding] = list(measurement.findings)
        if calibration is not None:
            self.findings += calibration.findings

    def cut(self, first: float, last: float) -> None:
        """Keep what lies between two times."""
        self.span = first, last
        self.main = self.main.within(first, last)

    def own_orders(self) -> Array:
        """Whole and half orders that stand out of the noise of the pulse trains."""
        found: dict[float, float] = {}
        left: set[float] = set()
        for train in self.measurement.pulses:
            one = train.within(*self.span)
            ratio = self._ratio_of(one)
            pattern, floor = self._known_pattern(one)
            for order, size in standing_out(one, pattern, self.turns):
                key = round(order * ratio, 6)
                if size < LIKE_A_WHEEL * floor and float(order).is_integer():
                    left.add(key)
                else:
                    found[key] = max(found.get(key, 0.0), size / ratio)
        highest = min(HIGHEST, 0.45 * min(one.pulses_per_turn * self._ratio_of(one) for one in self.measurement.pulses))
        strong = sorted((size, order) for order, size in found.items() if order <= highest)[::-1][:MOST_ORDERS]
        kept = [order for size, order in strong if size >= SHARE * strong[0][0]]
        if several := sorted(left - set(kept)):
            words = ", ".join(f"{one:g}" for one in several[:8]) + (" …" if len(several) > 8 else "")
            known = "as stated" if self.calibration is None else "as far as the reference run tells them"
            self.findings.append(
                Finding(
                    Gravity.NOTE,
                    f"Whole orders no larger than the wheels' pitch errors, {known}, are not listed ({words}): name "
                    "those that matter in orders.",
                )
            )
        if not kept:
            hidden = bool(left) and self.calibration is None
            wheels = " and the pitch errors of its wheels, as stated" if hidden else ""
            raise InputError(
                f"shows no order above its noise{wheels}", key="measurement", value=self.measurement.source,
                remedy=f"name the orders, or {'take a reference run' if hidden else 'record longer'}",
            )  # fmt: skip
        return np.array(sorted(kept))

    def _known_pattern(self, train: PulseTrain) -> tuple[Array, float]:
        """Pitch errors (tooth,) that the reference run tells, by the teeth of this run, and the rms amplitude that they
        leave at whole orders: before orders are known, the higher half of those that the wheel shows tells the tooth.
        """
        even = np.zeros(train.pulses_per_turn)
        if self.calibration is None:
            return even, pitch_floor(train)
        pattern, spread = self.calibration.of(train)
        windows, fits = rotation_windows(train, 1.0, self.turns, np.zeros(0), even, 0)
        own = self._own_pattern(train, [(w.first, w.last) for w in windows], [fit.residual for fit in fits])
        low = np.arange(1.0, train.pulses_per_turn // 4 + 1)
        try:
            place = shift_between(pattern, own, low, spread, train.name)
        except InputError:
            return even, pitch_floor(train)  # with its orders known the tooth may still be found, else it is refused
        return np.roll(pattern, -place), 2 * spread / np.sqrt(train.pulses_per_turn)

    def _align(self, train: PulseTrain, ratio: float, orders: Array, own: Array) -> Array:
        """Pitch errors of the reference run by the teeth of this one, which began at another tooth; ``own`` (tooth,)
        is what repeats with the teeth of this run beside the orders."""
        assert self.calibration is not None
        pattern, spread = self.calibration.of(train)
        place = shift_between(pattern, own, own_orders(orders, ratio), spread, train.name)
        self.aligned[train.name] = np.roll(pattern, -place), spread
        return self.aligned[train.name][0]

    def _spread(self, train: PulseTrain) -> float:
        """Standard deviation of each pitch error that is taken off."""
        return self.aligned[train.name][1] if train.name in self.aligned else 0.0

    def _ratio_of(self, train: PulseTrain) -> float:
        """Turns of a pickup's shaft for one of the input: of the line, else counted."""
        stated = self.places.get(train.at)
        if stated is not None:
            return abs(stated)
        if train.name == self.main.name:
            return self.ratio
        return self.ratio * counted_ratio(train, self.main)[0]

    def result(
        self, orders: Array, unit: str, stretch: MeasuredRamp, progress: Callable[[float], None] | None
    ) -> MeasuredOrders:
        """All channels at all windows."""
        self._refuse_high(self.main, orders, self.ratio)
        windows, fits, trend = self._windows(orders)
        rotation = MeasuredRotation(windows, self.ratio)
        corrections = self._clocks(windows)
        found: dict[str, _Tracked] = {}
        share = 1.0 / len(self.measurement.channels)
        hidden: list[Flags] = []
        floor: list[Array] = []
        for place, recorded in enumerate(self.measurement.channels):
            channel = corrections[recorded.clock].applied(recorded) if recorded.clock in corrections else recorded
            if isinstance(channel, PulseTrain):
                train, ratio = channel.within(*self.span), self._ratio_of(channel.within(*self.span))
                self._refuse_high(train, orders, ratio)
                self._check_ratio(train)
                if train.name == self.main.name:
                    found[train.name] = _tracked(fits, orders, reversed_=train.reversed)
                else:
                    found[train.name] = self._beside(train, ratio, windows, orders, trend)
                own = is_whole(orders / ratio)
                hidden.append(own if self.calibration is None else np.zeros_like(own))
                size = pitch_floor(train)
                left = 2 * self._spread(train) / np.sqrt(train.pulses_per_turn)
                floor.append(np.where(own, size if self.calibration is None else left, 0.0))
            else:
                found[channel.name] = self._sampled(channel, windows, orders, trend)
                falls = np.abs(orders - self._channel_ratio(channel)) < SAME_RATIO * orders
                hidden.append(falls & (channel.gravity > 0))
                floor.append(np.where(falls, channel.gravity, 0.0))
            if progress:
                progress(share * (place + 1))
        names = tuple(found)
        amplitude = np.stack([one.amplitude for one in found.values()], axis=2)
        curvature = np.stack([one.curvature(trend) for one in found.values()], axis=2)
        self._say_hidden(names, orders, amplitude, np.stack(hidden, axis=1), np.stack(floor, axis=1))
        self._say_short(names, amplitude, curvature, windows)
        if stretch.last_speed and between_words(stretch, unit):
            self.findings.append(Finding(Gravity.NOTE, between_words(stretch, unit)))
        return MeasuredOrders(
            time=np.array([one.middle for one in windows]),
            speed=np.array([one.speed for one in windows]),
            order=orders,
            channels=names,
            places=tuple(one.at for one in self.measurement.channels),
            kinds=tuple(
                one.kind if isinstance(one, SampledSignal) else "rotation" for one in self.measurement.channels
            ),
            ratios=tuple(self._channel_ratio(one) for one in self.measurement.channels),
            amplitude=amplitude,
            deviation=np.hypot(np.stack([one.deviation for one in found.values()], axis=2), curvature),
            curvature=curvature,
            degree=trend,
            extreme=np.stack([one.extreme for one in found.values()], axis=1),
            hidden=np.stack(hidden, axis=1),
            floor=np.stack(floor, axis=1),
            residual=np.stack([one.residual for one in found.values()], axis=1),
            acceleration=float(np.median([one.acceleration for one in windows])),
            window=self.turns,
            calibrated=self.calibration is not None,
            rotation=rotation,
            findings=by_gravity(self.findings),
            unit=unit,
        )

    def _clocks(self, windows: tuple[RotationWindow, ...]) -> dict[str, ClockCorrection]:
        """What brings other clocks than the reference's into its time."""
        found: dict[str, ClockCorrection] = {}
        for train in self.measurement.pulses:
            if train.clock == self.main.clock or train.clock in found:
                continue
            correction = clock_correction(train, windows, self._ratio_of(train))
            if correction is not None:
                found[train.clock] = correction
                grave = Gravity.NOTE if correction.knows_offset else Gravity.CAUTION
                self.findings.append(Finding(grave, correction.sentence))
        for one in self.measurement.channels:
            if one.clock != self.main.clock and one.clock not in found:
                raise InputError(
                    "has a clock that no pulse train tells", element=one.name, key="clock", value=one.clock,
                    remedy="record a wheel with the same clock too",
                )  # fmt: skip
        return found

    def _channel_ratio(self, channel: Channel) -> float:
        if isinstance(channel, PulseTrain):
            return self._ratio_of(channel.within(*self.span))
        return abs(self.places.get(channel.at) or 1.0)

    def _windows(self, orders: Array) -> tuple[tuple[RotationWindow, ...], list[WindowFit], int]:
        even = np.zeros(self.main.pulses_per_turn)
        windows, fits = rotation_windows(self.main, self.ratio, self.turns, orders, even, 0)
        change = max(abs(one.acceleration) * 2 * one.half / one.speed for one in windows)
        trend = 0 if change < STEADY else 2
        if trend:
            windows, fits = rotation_windows(self.main, self.ratio, self.turns, orders, even, trend)
        # What repeats with the teeth beside the orders asked for is taken for the wheel, else it would count as noise.
        own = self._own_pattern(self.main, [(w.first, w.last) for w in windows], [fit.residual for fit in fits])
        if self.calibration is not None:
            own = self._align(self.main, self.ratio, orders, own)
        windows, fits = rotation_windows(self.main, self.ratio, self.turns, orders, own, trend)
        return windows, fits, trend

    def _own_pattern(self, train: PulseTrain, places: list[tuple[int, int]], residuals: list[Array]) -> Array:
        of_edge = train.tooth
        return repeated(residuals, [of_edge[first:last] for first, last in places], train.pulses_per_turn)

    def _beside(
        self, train: PulseTrain, ratio: float, windows: tuple[RotationWindow, ...], orders: Array, trend: int
    ) -> _Tracked:
        def fits_with(teeth: Array) -> tuple[list[WindowFit | None], list[tuple[int, int]]]:
            fits: list[WindowFit | None] = []
            places: list[tuple[int, int]] = []
            angle = train.angle + teeth[train.tooth]
            for one in windows:
                keep_time()
                begin, end = one.middle - one.half, one.middle + one.half
                first, last = np.searchsorted(train.times, (begin, end))
                if last - first < (SMOOTH_BESIDE + 2 * (trend + 1) * len(orders)) + 1:
                    fits.append(None)
                    places.append((0, 0))
                    continue
                times = train.times[first:last]
                phase = one.angle(times)
                y = angle[first:last] - ratio * phase
                fits.append(fitted(y - y[0], one.local(times), phase, orders, SMOOTH_BESIDE, trend))
                places.append((int(first), int(last)))
            return fits, places

        fits, places = fits_with(np.zeros(train.pulses_per_turn))
        known = [(place, fit) for place, fit in zip(places, fits, strict=True) if fit is not None]
        if known:
            own = self._own_pattern(train, [place for place, _ in known], [fit.residual for _, fit in known])
            if self.calibration is not None:
                own = self._align(train, ratio, orders, own)
            fits, _ = fits_with(own)
        return _tracked(fits, orders, reversed_=train.reversed)

    def _sampled(
        self, signal: SampledSignal, windows: tuple[RotationWindow, ...], orders: Array, trend: int
    ) -> _Tracked:
        fastest = max(abs(one.speed) for one in windows) * float(orders[-1]) / TURN
        if signal.rate < 2.5 * fastest:
            raise InputError(
                f"is too low for order {orders[-1]:g} at {figures(fastest)} Hz", element=signal.name, key="rate",
                value=signal.rate, remedy="record faster, or ask for lower orders",
            )  # fmt: skip
        kept = thinned(signal, OVERSAMPLED * fastest)
        times = kept.times
        fits, extreme = [], []
        for one in windows:
            keep_time()
            first, last = np.searchsorted(times, (one.middle - one.half, one.middle + one.half))
            phase = one.angle(times[first:last])
            y = kept.values[first:last]
            extreme.append(np.abs(y).max(initial=np.nan if not len(y) else 0.0))
            local = one.local(times[first:last])
            fits.append(fitted(y, local, phase, orders, SMOOTH_BESIDE, trend) if len(y) else None)
        return _tracked(fits, orders, extreme=np.array(extreme))

    def _refuse_high(self, train: PulseTrain, orders: Array, ratio: float) -> None:
        limit = train.pulses_per_turn * ratio / 2
        if orders[-1] >= limit:
            raise InputError(
                f"is not seen by {train.name}: {train.pulses_per_turn} pulses a turn show orders below {limit:g}",
                key="orders", value=float(orders[-1]), remedy="ask for lower orders, or leave the channel out",
            )  # fmt: skip

    def _check_ratio(self, train: PulseTrain) -> None:
        """A pickup that turns otherwise than the line says: wrong pulses per turn, or another shaft."""
        stated = self.places.get(train.at)
        if stated is None or train.name == self.main.name or self.places.get(self.main.at) is None:
            return
        seen, same = counted_ratio(train, self.main)
        seen *= self.ratio
        if abs(seen / abs(stated) - 1) > same:
            fits = seen * train.pulses_per_turn / abs(stated)
            raise InputError(
                f"turns {figures(seen, 5)} times a turn of the input, where {train.at} turns {figures(abs(stated), 5)} "
                "times", element=train.name, key="pulses_per_turn", value=train.pulses_per_turn,
                remedy=f"{figures(fits, 5)} pulses a turn would fit; or correct its place or that of {self.main.name}",
            )  # fmt: skip

    def _say_short(
        self, names: tuple[str, ...], amplitude: Complex, bend: Array, windows: tuple[RotationWindow, ...]
    ) -> None:
        """Resonances that a window is too long for."""
        for column, name in enumerate(names):
            largest = float(np.nanmax(np.abs(amplitude[:, :, column]), initial=0.0))
            own = np.nan_to_num(bend[:, :, column])
            if own.max(initial=0.0) > TOO_LONG * largest:
                at = int(own.max(axis=1).argmax())
                share = figures(100 * float(own.max()) / largest, 2)
                self.findings.append(
                    Finding(
                        Gravity.CAUTION,
                        f"Windows of {self.turns} turns are long for a resonance of {name} near "
                        f"{figures(windows[at].speed, 3)} rad/s: up to {share} % of its amplitude is uncertain by "
                        "that; take shorter windows, or a slower run-up.",
                    )
                )

    def _say_hidden(
        self, names: tuple[str, ...], orders: Array, amplitude: Complex, hidden: Flags, floor: Array
    ) -> None:
        for column, (name, channel) in enumerate(zip(names, self.measurement.channels, strict=True)):
            if isinstance(channel, SampledSignal):
                if hidden[:, column].any():
                    order, size = orders[hidden[:, column]][0], figures(channel.gravity, 3)
                    self.findings.append(
                        Finding(
                            Gravity.CAUTION,
                            f"{name}: order {order:g} holds gravity, {size} rad/s² at a single accelerometer of a "
                            "horizontal shaft; sum two that stand opposite each other (gravity = false).",
                        )
                    )
                continue
            sizes = np.nanmax(np.abs(amplitude[:, :, column]), axis=0, initial=0.0)
            weak = [
                f"{orders[k]:g}" for k in range(len(orders)) if hidden[k, column] and sizes[k] < 4 * floor[k, column]
            ]
            if weak:
                size = figures(1e6 * float(floor[:, column].max()), 3)
                plural = "s" if len(weak) > 1 else ""
                self.findings.append(
                    Finding(
                        Gravity.CAUTION,
                        f"{name}: order{plural} {', '.join(weak)} may be the wheel's: its pitch errors, as stated, "
                        f"leave {size} µrad at every whole order of its shaft; take a reference run (pitch_errors).",
                    )
                )


def pitch_floor(train: PulseTrain) -> float:
    """Rms amplitude [rad] of a whole order of a wheel whose N teeth are off by σ each: 2σ/√N."""
    return float(train.pitch_error * TURN / train.pulses_per_turn * 2 / np.sqrt(train.pulses_per_turn))


def bent(amplitude: Complex) -> Array:
    """What quadratics over windows miss of a curve (window, order): h⁴|d⁴Y|/280 of windows of ± h, one after another.

    The fourth difference of the middles, 2h apart, is 16h⁴ d⁴Y, and holds next to no noise; beside a narrow resonance
    higher ones follow it, so it counts twice.
    """
    fourth = _nearest_known(np.abs(np.diff(amplitude, 4, axis=0)) / (8 * 280))
    # What one order misses goes to the others of the window too.
    whole = np.broadcast_to(np.sqrt((fourth**2).sum(axis=1, keepdims=True)), fourth.shape)
    # The sharpest bend may lie between two windows.
    return np.asarray(maximum_filter1d(np.pad(whole, ((2, 2), (0, 0)), mode="edge"), 3, axis=0, mode="nearest"))


def _nearest_known(rows: Array) -> Array:
    """Rows (row, order) with those that are not known, beside windows without pulses, replaced by the nearest known."""
    known = np.flatnonzero(np.isfinite(rows).all(axis=1))
    if not len(known):
        return np.zeros(rows.shape)
    at = np.arange(len(rows))
    right = np.minimum(np.searchsorted(known, at), len(known) - 1)
    left = np.maximum(right - 1, 0)
    nearer = np.where(np.abs(known[left] - at) < np.abs(known[right] - at), left, right)
    return np.asarray(rows[known[nearer]])


def own_orders(orders: Array, ratio: float) -> Array:
    """Those of ``orders`` (order,) of the input that repeat with the teeth of a shaft, by its own turns."""
    own = orders / ratio
    return np.asarray(np.rint(own[is_whole(own)]))


def shift_between(pattern: Array, own: Array, orders: Array, spread: float, name: str) -> int:
    """At which tooth of ``pattern`` (tooth,) a run began whose teeth have ``own`` (tooth,), ``orders`` set aside.

    Raises
    ------
    InputError : no tooth fits better than the others: another wheel, or one whose teeth cannot be told apart.
    """
    teeth = len(pattern)
    waves = np.exp(2j * np.pi * np.multiply.outer(np.arange(teeth), orders) / teeth)
    basis = np.linalg.qr(np.column_stack([np.ones(teeth), waves.real, waves.imag]))[0]
    left = pattern - basis @ (basis.T @ pattern)
    mine = own - basis @ (basis.T @ own)
    if np.sqrt(np.mean(left**2)) < SEEN * spread and np.sqrt(np.mean(mine**2)) < SEEN * spread:
        return 0  # even wheels
    apart = np.array([np.mean((mine - np.roll(left, -shift)) ** 2) for shift in range(teeth)])
    best = int(apart.argmin())
    second = np.delete(apart, best).min(initial=np.inf)
    if not apart[best] < ALIKE * second:
        raise InputError(
            "has other pitch errors than in the reference run, whose teeth cannot be found again", element=name,
            key="calibration", remedy="take the reference run with the same wheel, or ask for fewer orders",
        )  # fmt: skip
    return best


def between_words(stretch: MeasuredRamp, unit: str) -> str:
    """ "Taken from the run-up between 3 and 27 s."."""
    what = "run-up" if stretch.last_speed > stretch.first_speed else "run-down"
    return f"Taken from the {what} between {figures(stretch.first_time, 4)} and {figures(stretch.last_time, 4)} s."


def counted_ratio(train: PulseTrain, main: PulseTrain) -> tuple[float, float]:
    """Turns of a train's shaft for one of the main's, a fraction of small numbers where it is near to one, and the
    share within which that is known."""
    first, last = max(train.times[0], main.times[0]), min(train.times[-1], main.times[-1])
    if not last > first:
        raise InputError(
            "was not recorded at the same time", element=train.name, key="times",
            remedy=f"its clock and that of {main.name} differ: record them together",
        )  # fmt: skip
    turned = [np.diff(np.interp((first, last), one.times, one.angle))[0] for one in (train, main)]
    ratio = float(turned[0] / turned[1])
    simple = Fraction(ratio).limit_denominator(60)
    # Within few turns a shaft that swings at a resonance has not made as many as its ratio says.
    same = max(SAME_RATIO, SWING * TURN / float(np.min(np.abs(turned))))
    return (float(simple) if abs(float(simple) / ratio - 1) < SAME_RATIO else ratio), same

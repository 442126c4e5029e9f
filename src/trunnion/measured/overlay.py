"""Measured orders over what a line predicts: each order of each channel, with a sentence on what differs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.measured.lag import channels_on_run, lag_findings
from trunnion.measured.peaks import PredictedPeaks, predicted_peaks
from trunnion.measured.predicted import best_angle, predicted_channels, turned, usable
from trunnion.measured.tracking.result import MeasuredOrders, unit_of
from trunnion.numerics.curves import parabola
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.result import Result
from trunnion.results.units import figures

ALIKE = 0.05
"""Share of the largest amplitude of an order by which both may differ to agree."""
SAME_PEAK = 0.005
"""Relative difference of the speeds of two peaks that is said."""
FLAT_TOP = 0.5
"""Share by which the neighbours of a measured top may lie below it for a parabola through them to tell where it is."""
WRONG_WAY = 0.25
"""Share of the squares that a reversed or exchanged pickup has to leave, to be asked about."""


@labelled
class MeasuredComparison(Result):
    """Measured and predicted orders of the channels that stand at places of a line."""

    speed: Array = coordinate("window", "rad/s", "of the input", name="speed")
    order: Array = coordinate("order", "1", "cycles per turn of the input")
    channels: tuple[str, ...] = coordinate("channel")
    kinds: tuple[str, ...] = variable("channel", "", "kind of signal")
    measured: Complex = variable("window order channel", "", "in SI of the kind")
    predicted: Complex = variable("window order channel", "", "by the line, at the angle that fits best")
    half_width: Array = variable("window order channel", "", "of the interval of 95 % of what was measured")
    peak: Array = variable("order channel", "", "largest that is predicted between the lowest and highest speed")
    peak_speed: Array = variable("order channel", "rad/s", "of the input, where that is")
    peak_error: Array = variable("order channel", "", "what that may be low by; infinite where it was not searched")
    begin: float = attribute("rotation of the input at the first pulse, that fits best", "rad")
    off: Array = variable("order channel", "1", "rms of the difference over the largest amplitude that was measured")
    outside: Array = variable("order channel", "1", "share of windows where the size is outside its interval")
    findings: tuple[Finding, ...] = internal("what to read first")
    unit: str = internal("that speeds are printed in")
    curve: PredictedPeaks = internal("what is predicted between the tracked speeds, too")
    extreme: Array = variable("window channel", "", "largest size of a sampled signal, its mean counted")
    acceleration: float = attribute("of the input", "rad/s^2")
    places: tuple[str, ...] = internal("of the line that channels show")
    assembly: Assembly = internal("the line")
    doubts: tuple[Finding, ...] = internal("what speaks against the comparison itself", default=())

    def plot(self, axes: Axes | None = None, *, channel: str = "") -> Axes:
        """Measured marks over predicted curves; see ``pictures.measured.comparison``."""
        return drawing(self, "plot")(self, axes, channel=channel)

    def plot_campbell(self, axes: Axes | None = None, *, channel: str = "") -> Axes:
        """Measured orders on the Campbell diagram of the line; see ``pictures.measured.on_campbell``."""
        return drawing(self, "plot_campbell")(self, axes, channel=channel)

    def plot_run_up(self, axes: Axes | None = None, *, channel: str = "") -> Axes:
        """Largest measured torques on the run-up of the line; see ``pictures.measured.on_run_up``."""
        return drawing(self, "plot_run_up")(self, axes, channel=channel)

    def torque_channel(self, channel: str) -> int:
        """The channel of this name, or the first ("") that measures a torque.

        Raises
        ------
        InputError : there is none, or it measures something else.
        """
        torques = [name for name, kind in zip(self.channels, self.kinds, strict=True) if kind == "torque"]
        if channel not in ("", *torques):
            remedy = f"there are {', '.join(torques)}" if torques else "record the torque of a shaft"
            raise InputError("measures no torque", key="channel", value=channel, remedy=remedy)
        if not torques:
            raise InputError(
                "has no torque channel, and a run-up is told by torques", key="data",
                remedy="record the torque of a shaft, or look at plot()",
            )  # fmt: skip
        return self.channels.index(channel or torques[0])

    def measured_peak(self, order: int, channel: int) -> tuple[int, float, float]:
        """Window at which an order of a channel, by their places, is largest; the speed [rad/s] of its top, by a
        parabola through that window and its neighbours; and how closely that is known [rad/s]."""
        size = np.abs(self.measured[:, order, channel])
        rank = np.argsort(self.speed)
        rank = rank[np.isfinite(size[rank])]
        x, v = self.speed[rank], size[rank]
        i = int(np.argmax(v))
        apart = float(np.max(np.diff(x[max(i - 1, 0) : i + 2]), initial=0.0)) / 2
        if 0 < i < len(x) - 1:
            place, height, fall = parabola(x, v, np.array([i]))
            # A parabola through one window that stands out tells no place within it.
            if np.isfinite(place[0]) and fall[0] < FLAT_TOP * height[0]:
                return int(rank[i]), float(np.clip(place[0], x[i - 1], x[i + 1])), apart / 2
        return int(rank[i]), float(x[i]), apart

    def sentence(self, order: int, channel: int) -> str:
        """What differs in one order of one channel, by their places."""
        measured, predicted = (np.abs(one[:, order, channel]) for one in (self.measured, self.predicted))
        name = f"order {self.order[order]:g} of {self.channels[channel]}"
        if np.all(np.isnan(measured)):
            return f"{name}: not measured"
        at, top, known = self.measured_peak(order, channel)
        unit, size = unit_of(self.kinds[channel], float(measured[at]))
        half = float(self.half_width[at, order, channel])
        both = f"{figures(float(measured[at]) / size, 4)} ± {figures(half / size, 2)} {unit}".rstrip()
        both += f" at {self.words.rounded(float(self.speed[at]))}"
        peak, where = float(self.peak[order, channel]), float(self.peak_speed[order, channel])
        if peak < half:
            stray = "" if measured[at] < 2 * half else ", where the line predicts none"
            return f"{name}: {both}{stray}"
        tracked = float(predicted.max())
        missed = peak > (1 + ALIKE) * tracked
        text = f"{name}: {both}"
        if self.off[order, channel] < ALIKE and not missed:
            return f"{text}, as predicted to {figures(100 * float(self.off[order, channel]), 2)} %"
        text += f", predicted {figures(peak / size, 4)} {unit}".rstrip() + f" at {self.words.rounded(where)}"
        if missed and abs(where - self.speed[int(predicted.argmax())]) <= 2 * known:
            text += f", between the tracked speeds; at those up to {figures(tracked / size, 4)} {unit}".rstrip()
            return f"{text}: {_larger(float(measured[at] / tracked) - 1)}"
        shift, low, high = top / where - 1, float(self.speed.min()), float(self.speed.max())
        ends = abs(top - low) <= known or abs(top - high) <= known or where in (low, high)
        moved = not ends and abs(top - where) > max(SAME_PEAK * where, known)
        if moved:
            text += f": its peak comes {figures(100 * abs(shift), 2)} % {'later' if shift > 0 else 'earlier'}"
        return f"{text}{',' if moved else ':'} {_larger(float(measured[at] / peak) - 1)}"

    def table(self) -> list[dict[str, object]]:
        """One row an order of a channel."""
        return [
            {
                "channel": channel, "order": f"{order:g}", "differs by": f"{100 * self.off[k, c]:.3g} %",
                "outside its interval": f"{100 * self.outside[k, c]:.0f} % of windows",
            }
            for c, channel in enumerate(self.channels)
            for k, order in enumerate(self.order.tolist())
        ]  # fmt: skip

    @property
    def headline(self) -> str:
        """What was compared."""
        span = self.words.span(float(self.speed.min()), float(self.speed.max()))
        return f"{len(self.order)} orders of {len(self.channels)} channels against the line, {span}"

    def _lines(self) -> Iterator[str]:
        yield self.headline
        for c in range(len(self.channels)):
            yield from (f"  {self.sentence(k, c)}" for k in range(len(self.order)))


def _larger(share: float) -> str:
    if abs(share) < 0.01:
        return "as large"
    return f"{figures(100 * abs(share), 2)} % {'larger' if share > 0 else 'smaller'}"


def compare_measured(line: Driveline | Assembly, data: MeasuredOrders) -> MeasuredComparison:
    """Measured orders beside those that a line predicts at the same speeds, places and kinds of signals.

    The rotation of the input at the first pulse, which pulses do not tell, is the one that fits best. Where the speed
    changes, the line lags behind its steady response, as in the run that was measured.

    Parameters
    ----------
    line : the driveline.
    data : of ``track_orders``; its channels name places of the line.

    Raises
    ------
    InputError : places that the line does not have; as of ``order_response``.

    Examples
    --------
    >>> import trunnion as tn
    >>> joint, hub = tn.HookeJoint(angle="12 deg"), tn.Disk(inertia=0.5, name="hub")
    >>> line = tn.Driveline([tn.ConstantSpeed(), joint, tn.Shaft(stiffness=2e4, damping=25, name="tube"), hub])
    >>> data = tn.track_orders(tn.measure(line, (60.0, 200.0), 16.0, {"hub": 30}, pitch_error=0.0), [2])
    >>> found = tn.compare_measured(line.replace("tube", stiffness=1.9e4), data)
    >>> print(found.sentence(0, 0).partition("predicted")[2])
     44.7 mrad at 922.5 rpm: its peak comes 2.6 % later, 1.1 % larger
    """
    assembly = assemble(line)
    channels = predicted_channels(assembly, data)
    table = assembly.table(len(data.speed))
    table[:, 0] = data.speed
    bare, columns = channels.at(table), list(channels.columns)
    run = channels_on_run(channels, table[0])
    if run is not None:
        bare = bare + run.lag(data.speed)
    measured, deviation = data.amplitude[:, :, columns], data.deviation[:, :, columns]
    known = usable(data, channels.columns)
    constant = data.floor[:, columns]
    with np.errstate(divide="ignore"):
        weight = np.where(known, 1 / (deviation**2 + constant**2 / 2), 0.0)
    weight = np.where(np.isfinite(weight), weight, 0.0)
    # Of an exact measurement no deviation is known: all count alike.
    angle = best_angle(measured, bare, weight if weight.any() else known.astype(float), data.order)
    peaks = predicted_peaks(channels, bare, run)
    predicted = turned(bare, data.order, angle)
    difference = np.where(known, measured - predicted, np.nan)
    largest = np.nanmax(np.where(known, np.abs(measured), np.nan), axis=0)
    off = np.sqrt(np.nanmean(np.abs(difference) ** 2, axis=0)) / largest
    half = data.half_width[:, :, columns]
    outside = np.nanmean(np.where(known, np.abs(np.abs(measured) - np.abs(predicted)) > half, np.nan), axis=0)
    made = MeasuredComparison(
        speed=data.speed, order=data.order, channels=tuple(data.channels[c] for c in columns),
        kinds=tuple(data.kinds[c] for c in columns), measured=measured, predicted=predicted, half_width=half,
        peak=peaks.value, peak_speed=peaks.at, peak_error=peaks.error, begin=angle, off=off, outside=outside,
        findings=(), unit=data.unit or speed_unit(assembly.line), curve=peaks,
        extreme=data.extreme[:, columns], acceleration=data.acceleration,
        places=tuple(data.places[c] for c in columns), assembly=assembly,
    )  # fmt: skip
    moves = [k for k, even in enumerate(channels.even) if not even]
    unsearched = f"Predicted peaks are read at the tracked speeds alone: {peaks.why}"
    read = [Finding(Gravity.NOTE, f"{unsearched.rstrip('.')}.")] if peaks.why else []
    own = (*wrong_way(made, bare, weight, moves), *lag_findings(channels, run))
    said = (*data.findings, *read, *own, *left_out("compare_measured", assembly.line))
    return replace(made, doubts=own, findings=by_gravity(said))


def wrong_way(found: MeasuredComparison, bare: Complex, weight: Array, moves: list[int]) -> Iterator[Finding]:
    """Pickups that would fit better reversed, or exchanged with another of their kind, wherever the input begins.

    bare : what the line predicts (window, order, channel) at the angle 0. weight : as of ``best_angle``. moves :
    channels of places that move.
    """
    measured = np.nan_to_num(found.measured)

    def off(predicted: Complex) -> float:
        there = turned(predicted, found.order, best_angle(measured, predicted, weight, found.order))
        return float((weight * np.abs(measured - there) ** 2).sum())

    own = off(bare)
    for k in moves:
        # Of a single pickup the angle at which the input begins may stand for a sign.
        other = bare.copy()
        other[:, :, k] *= -1
        if len(moves) > 1 and off(other) < WRONG_WAY * own:
            name = found.channels[k]
            yield Finding(Gravity.CAUTION, f"{name} fits better with its sign changed: is it reversed?")
    # A pickup of a place that cannot move, the input say, is exchanged as easily.
    every = range(len(found.channels))
    for i, j in ((i, j) for i in every for j in every if i < j and found.kinds[i] == found.kinds[j]):
        if i not in moves and j not in moves:
            continue
        other = bare.copy()
        other[:, :, [i, j]] = bare[:, :, [j, i]]
        if off(other) < WRONG_WAY * own:
            both = f"{found.channels[i]} and {found.channels[j]}"
            yield Finding(Gravity.CAUTION, f"{both} fit better exchanged: are they swapped?")

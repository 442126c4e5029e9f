"""Vold–Kalman filter of the second generation: the envelopes of several orders at once, as smooth as a bandwidth asks.

The envelopes x_k of y = Re Σ x_k e^{iΘ_k} minimise |y − Re Σ x_k e^{iΘ_k}|² + r² Σ |∇^p x_k|², the differences of p-th
order of each: with complex y and the factor 2 of the real part, a Hermitian band matrix (Tůma 2005; Feldbauer and
Höldrich 2000). A single order passes as through 1/(1 + r²(2 − 2cos ω)^p): r² = (√2 − 1)/(2 − 2cos(πB/f_s))^p has the
bandwidth B between points of −3 dB.

The condition number grows as r² 4^p: at 200 kHz and 1 Hz nothing is left of double precision. The signal is taken to as
low a rate as its orders allow before, and what is then still ill-conditioned is refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from scipy.linalg import solveh_banded
from scipy.special import comb

from trunnion.arrays import Array, Complex
from trunnion.driveline.arguments import numbers, one_number
from trunnion.errors import InputError
from trunnion.measured.signals.measurement import TURN, SampledSignal
from trunnion.measured.signals.thinning import thinned
from trunnion.measured.tracking.rotation import MeasuredRotation
from trunnion.numerics.memory import require_memory
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.result import Result
from trunnion.results.units import figures

POLES = 2
OVERSAMPLED = 5.0
"""Samples per cycle of the highest order that are kept."""
ENDS = 1.0
"""Times one over the bandwidth that an end of the signal is felt."""
MOST_CONDITION = 1e12
"""Condition number up to which four figures are left."""


@labelled
class OrderEnvelopes(Result):
    """Complex envelopes of the orders of a signal over time: Re[Y e^{iKφ}], φ the mean rotation of the input."""

    time: Array = coordinate("time", "s")
    order: Array = coordinate("order", "1", "cycles per turn of the input")
    speed: Array = variable("time", "rad/s", "of the input")
    amplitude: Complex = variable("time order", "", "in units of the signal")
    residual: Array = variable("time", "", "what no order explains")
    change: Array = variable(
        "order", "", "of an envelope where the bandwidth is doubled, the largest away from the ends"
    )
    bandwidth: float = attribute("between points of −3 dB", "Hz")
    rate: float = attribute("samples kept per second", "Hz")
    condition: float = attribute("bound of the condition number", "1")
    name: str = attribute("of the channel")
    unit: str = internal("that speeds are printed in")

    def _lines(self) -> Iterator[str]:
        band, rate = figures(self.bandwidth, 3), figures(self.rate, 4)
        yield f"envelopes of {self.name}: Vold–Kalman, second generation, {band} Hz wide, at {rate} Hz"
        for k, order in enumerate(self.order.tolist()):
            size = np.abs(self.amplitude[:, k])
            at = int(size.argmax())
            where = self.words.rounded(float(self.speed[at]))
            smooth = figures(float(self.change[k]), 2)
            yield f"  order {order:g}: largest {figures(float(size[at]))} at {where}, {smooth} other at twice the width"


def vold_kalman(
    signal: SampledSignal,
    rotation: MeasuredRotation,
    orders: Iterable[float],
    *,
    bandwidth: float = 2.0,
    unit: str = "rpm",
) -> OrderEnvelopes:
    """Envelopes of several orders of a signal at every moment, also where they cross or beat.

    Parameters
    ----------
    signal : a sampled channel.
    rotation : of the input, of ``track_orders``.
    orders : in cycles per turn of the input.
    bandwidth : between points of −3 dB [Hz]; changes of an amplitude that are faster are smoothed.
    unit : of speeds in print.

    Raises
    ------
    InputError : orders above half the rate; a bandwidth that is too narrow for them to be computed.

    Examples
    --------
    >>> import numpy as np, trunnion as tn
    >>> number = np.arange(60 * 40)
    >>> wheel = tn.PulseTrain(2 * np.pi * number / 60 / 100.0, 60, name="wheel")
    >>> rotation = tn.track_orders(tn.Measurement([wheel]), [1]).rotation
    >>> gauge = tn.SampledSignal(5 * np.cos(200.0 * np.arange(5000) / 2000), 2000.0, name="gauge")
    >>> found = tn.vold_kalman(gauge, rotation, [2], bandwidth=2.0)
    >>> round(float(abs(found.amplitude[150, 0])), 2)
    5.0
    """
    wanted = np.unique(numbers(list(orders), "orders", "[1, 2, 4], say"))
    width = one_number(bandwidth, "bandwidth")
    if not width > 0 or not np.all(wanted > 0):
        raise InputError("must be positive", key="bandwidth" if np.all(wanted > 0) else "orders", value=bandwidth)
    first, last = rotation.span
    inside = (signal.times >= first) & (signal.times <= last)
    if inside.sum() < 100:
        raise InputError(
            "has not 100 samples while the rotation is known", element=signal.name, key="values",
            remedy="record both together",
        )  # fmt: skip
    begin = int(np.argmax(inside))
    part = SampledSignal(
        signal.values[inside], signal.rate, signal.name, signal.kind, signal.at, float(signal.times[begin])
    )
    fastest = float(rotation.speed_at(part.times[:: max(1, len(part.values) // 1000)]).max()) * wanted[-1] / TURN
    if part.rate < 2.5 * fastest:
        raise InputError(
            f"is too low for order {wanted[-1]:g} at {figures(fastest)} Hz", element=signal.name, key="rate",
            value=signal.rate, remedy="record faster, or ask for lower orders",
        )  # fmt: skip
    kept = thinned(part, max(OVERSAMPLED * fastest, 20 * width))
    angle = rotation.angle_at(kept.times)
    # The mean is an envelope too: near order 0 it would be taken for the lowest.
    phase = np.multiply.outer(angle, np.concatenate([[0.0], wanted]))
    whole, condition = envelopes_of(kept.values, phase, width / kept.rate, signal.name)
    whole[:, 0] /= 2  # what does not turn has no other half
    left = kept.values - (whole * np.exp(1j * phase)).real.sum(axis=1)
    change = np.abs(envelopes_of(kept.values, phase, 2 * width / kept.rate, signal.name)[0] - whole)
    away = np.minimum(kept.times - kept.times[0], kept.times[-1] - kept.times) > ENDS / width
    change = np.where(away[:, None], change, 0.0).max(axis=0)
    return OrderEnvelopes(
        time=kept.times, order=wanted, speed=rotation.speed_at(kept.times), amplitude=whole[:, 1:], residual=left,
        change=change[1:], bandwidth=width, rate=kept.rate, condition=condition, name=signal.name, unit=unit,
    )  # fmt: skip


def envelopes_of(values: Array, phase: Array, width: float, name: str = "signal") -> tuple[Complex, float]:
    """Envelopes (sample, order) of real ``values`` (sample,) with ``phase`` (sample, order) [rad], and a bound of the
    condition number.

    width : bandwidth over the rate.

    Raises
    ------
    InputError : the bandwidth is too narrow for double precision, or the band matrix would not fit.
    """
    samples, count = phase.shape
    weight = (np.sqrt(2.0) - 1) / (2 - 2 * np.cos(np.pi * width)) ** POLES
    condition = 1 + weight * 4.0**POLES
    if condition > MOST_CONDITION:
        raise InputError(
            f"is too narrow at {figures(1 / width, 3)} times it as the rate: the equations' condition number would be "
            f"{condition:.1g}", element=name, key="bandwidth", remedy="take a wider one, or leave out the high orders",
        )  # fmt: skip
    reach = POLES * count
    require_memory(
        48.0 * samples * (reach + 1), element=name, key="orders", value=count, remedy="take fewer, or a shorter signal"
    )
    differences = np.array([(-1.0) ** k * comb(POLES, k) for k in range(POLES + 1)])
    rows = np.zeros((reach + 1, samples * count), dtype=complex)  # upper form: row reach − d holds the d-th diagonal
    for apart in range(POLES + 1):
        own = np.zeros(samples)
        for k in range(POLES + 1 - apart):
            own[k + apart : samples - POLES + k + apart] += differences[k] * differences[k + apart]
        rows[reach - apart * count, :] = np.repeat(weight * own, count)
    swing = np.exp(1j * phase)
    for i in range(count):
        rows[reach, i::count] += 1.0
        for j in range(i + 1, count):  # what two orders have in common at one sample
            rows[reach - (j - i), j::count] += swing[:, i].conj() * swing[:, j]
    right = 2.0 * (swing.conj() * values[:, None]).ravel()
    found = solveh_banded(rows, right, overwrite_ab=True, overwrite_b=True, check_finite=False)
    return np.asarray(found.reshape(samples, count)), float(condition)

"""Peaks of what is asked of a line in one box: no line of it has a larger one.

The responses of all carriers are trigonometric polynomials in the time that the speed counts, linear in the parameters,
with a bound of what they leave out. A polynomial of degree n that is at most 1 on N even points is at most 1/cos(πn/N)
between them (Ehlich and Zeller 1964). Half of peak to peak is no more than the largest distance from any one value.
What a rate squared comes to on the mean is Σ½|Y|² (Parseval), of a sum at most the sum of roots squared; what is left
out counts in a rated torque with the S_f of the highest order known, or of ``RATED_UP_TO``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial
from math import gcd, lcm

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.certificate.box_coefficients import NumberRange
from trunnion.floquet.certificate.box_equations import NotEnclosed
from trunnion.floquet.certificate.periodic_lyapunov import modal_box
from trunnion.floquet.certificate.waves import OUTWARD
from trunnion.response.orders.result import frequency_factor
from trunnion.response.peaks.energy_bound import energy_bound
from trunnion.response.peaks.forced_box import ForcedBox, forced_box
from trunnion.response.peaks.periodic_enclosure import (
    CarrierResponse,
    NotContracting,
    carriers_of,
    modal_forced,
    response_of,
)
from trunnion.response.peaks.quantities import RATED_UP_TO, quantities_of

PER_CYCLE = 32
"""Points of time per cycle of the highest order."""
MOST_TIMES = 1 << 16


@dataclass(frozen=True)
class BoxPeaks:
    """Quantities as of ``quantities_of``. ``upper`` : no line of the box has more; ``computed`` : of its middle,
    floating point; ``blame`` (1 + ranges, quantity): what each parameter brings between them."""

    upper: Array
    computed: Array
    blame: Array


def box_peaks(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> BoxPeaks:
    """Of all lines with numbers within ``ranges`` at all ``speeds`` [rad/s]; infinite where nothing is enclosed."""
    many, count = 1 + len(ranges), len(quantities_of(assembly))

    def nothing(blame: Array) -> BoxPeaks:
        return BoxPeaks(np.full(count, np.inf), np.full(count, np.nan), np.repeat(blame[:, None], count, axis=1))

    try:
        box = forced_box(assembly, speeds, ranges)
    except NotEnclosed:
        return nothing(np.ones(many))
    modal = modal_box(box.matrix)
    line = None if modal is None else modal_forced(box, modal)
    if modal is None or line is None:
        return nothing(np.ones(many))
    energy = cache(partial(energy_bound, box.matrix, modal, line.off))
    sums = _Sums.of(box, many, len(assembly.topology.compliances))
    for carrier in carriers_of(box):
        found = response_of(line, carrier, energy)
        if isinstance(found, NotContracting):
            return nothing(found.blame)
        sums.add(found, carrier.order, carrier.frequency, box.rate)
    return sums.peaks()


@dataclass
class _Sums:
    """Amplitudes (1 + parameters, Q) by order, of Re[Y e^{i order τ}]; of what comes at frequencies of its own, sums
    of sizes (Q,), of sizes by S_f, and of half their squares, each of the middle and at most."""

    box: ForcedBox
    many: int
    springs: int
    amplitude: dict[Fraction, Complex]
    still: Complex
    rest: Array
    apart: Array
    rated: Array
    square: Array
    blame: Array
    highest: float = 0.0

    @classmethod
    def of(cls, box: ForcedBox, many: int, springs: int) -> _Sums:
        rows, last = box.base.shape[2], box.base.shape[1] // 2
        none, amplitude = np.zeros((2, rows)), dict[Fraction, Complex]()
        still, blame = box.base[:, last], np.zeros((many, rows))
        found = cls(
            box, many, springs, amplitude, still, rest=box.base_rest.copy(), apart=none, rated=none, square=none,
            blame=blame,
        )  # fmt: skip
        for k in range(-last, last + 1):
            found._put(k * box.rate, box.base[:, k + last])
        return found

    def _put(self, order: Fraction, values: Complex) -> None:
        if not values.any():
            return
        key, own = (order, values) if order >= 0 else (-order, values.conj())
        self.amplitude[key] = self.amplitude[key] + own if key in self.amplitude else own

    def add(self, found: CarrierResponse, order: Fraction, frequency: float, rate: Fraction) -> None:
        """Add what one carrier makes."""
        self.rest = self.rest + found.rest
        self.blame = self.blame + found.blame
        for j in range(found.parts.shape[1]):
            own = order + (found.first + j) * rate
            if not frequency:
                self._put(own, found.parts[:, j])
                continue
            size = _sizes(found.parts[:, j])
            self.apart = self.apart + size
            self.rated = self.rated + size * self._factors(float(own), frequency)
            self.square = self.square + size**2 / 2

    def _factors(self, order: float, frequency: float = 0.0) -> Array:
        """S_f of an order in the middle of the box, and the largest there (2, 1)."""
        middle, half = self.box.matrix.speed
        here = abs(order * middle + frequency)
        self.highest = max(self.highest, here + abs(order) * half)
        return frequency_factor(np.array([[here], [(here + abs(order) * half) * OUTWARD]]))

    def peaks(self) -> BoxPeaks:
        """Of the sum."""
        times, step, degree = self._times()
        slack = self.rest + self.apart[1]
        if times < 4 * degree:
            every = np.full(self._arranged(self.rest, self.rest, self.rest, self.rest).shape, np.inf)
            return BoxPeaks(every, every, np.ones((self.many, len(every))))
        spectrum = np.zeros((times // 2 + 1, 1 + self.many, len(self.rest)), dtype=complex)
        for order, values in self.amplitude.items():
            # Re[Y e^{inτ}] counts once: half with n, half with −n.
            spectrum[int(order / step)] += values if not order else values / 2
        wave = np.fft.irfft(spectrum, n=times, axis=0) * times
        sizes = np.sum([np.abs(one).sum(axis=0) for one in self.amplitude.values()] or [0 * self.rest], axis=0)
        over = OUTWARD / np.cos(np.pi * degree / times)
        slack = slack + 1e-13 * sizes
        moved, middle = np.abs(wave[:, 1:]).sum(axis=1), wave[:, 0]
        # A mean that goes with the parameters is no swing.
        swinging = np.abs(wave[:, 1:] - wave[:, 1:].mean(axis=0)).sum(axis=1)
        low, high = middle.min(axis=0), middle.max(axis=0)
        centre = (low + high) / 2
        swing = ((np.abs(middle - centre) + swinging).max(axis=0) * over + slack) * OUTWARD
        largest = ((np.abs(middle) + moved).max(axis=0) * over + slack) * OUTWARD
        half, most = (high - low) / 2 + self.apart[0], np.maximum(np.abs(low), np.abs(high)) + self.apart[0]
        rated, square = self._by_order()
        factor = float(frequency_factor(np.array(max(self.highest, 2 * np.pi * RATED_UP_TO))))
        rated[1] = (rated[1] + self.rest * factor) * OUTWARD
        power = np.stack([square[0], ((np.sqrt(square[1]) + self.rest) * OUTWARD) ** 2])
        blame = self._arranged(self.blame, self.blame, self.blame, self.blame)
        return BoxPeaks(
            self._arranged(swing, largest, rated[1], power[1], self.box.damping[1] * OUTWARD),
            self._arranged(half, most, rated[0], power[0], self.box.damping[0]),
            blame,
        )

    def _times(self) -> tuple[int, Fraction, int]:
        """Points of time, the order that all others are multiples of, and the highest of these multiples."""
        orders = [order for order in self.amplitude if order]
        step = Fraction(1)
        if orders:
            step = Fraction(gcd(*(o.numerator for o in orders)), lcm(*(o.denominator for o in orders)))
        degree = max((int(order / step) for order in orders), default=0)
        return 1 << int(np.ceil(np.log2(max(64, min(PER_CYCLE * degree, MOST_TIMES))))), step, degree

    def _by_order(self) -> tuple[Array, Array]:
        """Σ S_f|Y| and Σ ½|Y|² (2, Q) of the middle and at most, the line's mean left out."""
        rated, square = self.rated.copy(), self.square.copy()
        for order, values in self.amplitude.items():
            size = _sizes(values if order else values - self.still)
            rated += size * self._factors(float(order))
            square += size**2 / 2 if order else size**2
        return rated, square * OUTWARD

    def _arranged(
        self, swing: Array, largest: Array, rated: Array, power: Array, damping: Array | float = 1.0
    ) -> Array:
        """Of rows (…, Q) the quantities."""
        torque, twist, rate = (slice(k * self.springs, (k + 1) * self.springs) for k in range(3))
        parts = (
            swing[..., torque], largest[..., torque], swing[..., twist], largest[..., twist], rated[..., torque],
            power[..., rate] * damping, swing[..., 3 * self.springs :],
        )  # fmt: skip
        return np.concatenate(parts, axis=-1)


def _sizes(values: Complex) -> Array:
    """Of amplitudes (1 + parameters, Q) those of the middle and the largest (2, Q)."""
    size = np.abs(values)
    return np.stack([size[0], size.sum(axis=0)])

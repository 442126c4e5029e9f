"""Peaks of what is asked of a line in one box: no line of it has a larger one.

The responses of all carriers are trigonometric polynomials in the time that the speed counts, linear in the parameters,
with a bound of what they leave out. A polynomial of degree n that is at most 1 on N even points is at most 1/cos(πn/N)
between them (Ehlich and Zeller 1964). Half of peak to peak is no more than the largest distance from any one value.
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
from trunnion.response.peaks.energy_bound import energy_bound
from trunnion.response.peaks.forced_box import ForcedBox, forced_box
from trunnion.response.peaks.periodic_enclosure import (
    CarrierResponse,
    NotContracting,
    carriers_of,
    modal_forced,
    response_of,
)

PER_CYCLE = 32
"""Points of time per cycle of the highest order."""
MOST_TIMES = 1 << 16


@dataclass(frozen=True)
class BoxPeaks:
    """Quantities (3 S + P,): of every spring half of peak to peak of its torque [N m], the largest |torque| [N m], half
    of peak to peak of its twist [rad]; of every point half of peak to peak of its speed [rad/s].

    ``upper`` : no line of the box has more; ``computed`` : of its middle, floating point; ``blame`` (1 + ranges,
    3 S + P): what each parameter brings between them.
    """

    upper: Array
    computed: Array
    blame: Array


def box_peaks(assembly: Assembly, speeds: tuple[float, float], ranges: Sequence[NumberRange]) -> BoxPeaks:
    """Of all lines with numbers within ``ranges`` at all ``speeds`` [rad/s]; infinite where nothing is enclosed."""
    springs, many = len(assembly.topology.compliances), 1 + len(ranges)
    count = 3 * springs + len(assembly.topology.points)

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
    sums = _Sums.of(box, many, springs)
    for carrier in carriers_of(box):
        found = response_of(line, carrier, energy)
        if isinstance(found, NotContracting):
            return nothing(found.blame)
        sums.add(found, carrier.order, carrier.frequency, box.rate)
    return sums.peaks()


@dataclass
class _Sums:
    """Amplitudes (1 + parameters, Q) by order, of Re[Y e^{i order τ}]; what comes at frequencies of its own, added
    up."""

    rows: int
    many: int
    springs: int
    amplitude: dict[Fraction, Complex]
    rest: Array
    apart: Array
    blame: Array

    @classmethod
    def of(cls, box: ForcedBox, many: int, springs: int) -> _Sums:
        rows, last = box.base.shape[2], box.base.shape[1] // 2
        amplitude: dict[Fraction, Complex] = {}
        found = cls(rows, many, springs, amplitude, box.base_rest.copy(), np.zeros(rows), np.zeros((many, rows)))
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
            if frequency:
                self.apart = self.apart + np.abs(found.parts[:, j]).sum(axis=0)
            else:
                self._put(order + (found.first + j) * rate, found.parts[:, j])

    def peaks(self) -> BoxPeaks:
        """Of the sum."""
        orders = [order for order in self.amplitude if order]
        step = (
            Fraction(gcd(*(o.numerator for o in orders)), lcm(*(o.denominator for o in orders)))
            if orders
            else Fraction(1)
        )
        degree = max((int(order / step) for order in orders), default=0)
        times = 1 << int(np.ceil(np.log2(max(64, min(PER_CYCLE * degree, MOST_TIMES)))))
        if times < 4 * degree:
            every = np.full(self.rows + self.springs, np.inf)
            return BoxPeaks(every, every, np.ones((self.many, len(every))))
        spectrum = np.zeros((times // 2 + 1, 1 + self.many, self.rows), dtype=complex)
        for order, values in self.amplitude.items():
            # Re[Y e^{inτ}] counts once: half with n, half with −n.
            spectrum[int(order / step)] += values if not order else values / 2
        wave = np.fft.irfft(spectrum, n=times, axis=0) * times
        sizes = np.sum([np.abs(one).sum(axis=0) for one in self.amplitude.values()] or [np.zeros(self.rows)], axis=0)
        over = OUTWARD / np.cos(np.pi * degree / times)
        slack = self.rest + self.apart + 1e-13 * sizes
        moved, middle = np.abs(wave[:, 1:]).sum(axis=1), wave[:, 0]
        # A mean that goes with the parameters is no swing.
        swinging = np.abs(wave[:, 1:] - wave[:, 1:].mean(axis=0)).sum(axis=1)
        low, high = middle.min(axis=0), middle.max(axis=0)
        centre = (low + high) / 2
        swing = ((np.abs(middle - centre) + swinging).max(axis=0) * over + slack) * OUTWARD
        largest = ((np.abs(middle) + moved).max(axis=0) * over + slack) * OUTWARD
        torque, others = slice(None, self.springs), slice(self.springs, None)
        half, most = (high - low) / 2 + self.apart, np.maximum(np.abs(low), np.abs(high)) + self.apart

        def in_order(swings: Array, largest: Array) -> Array:
            return np.concatenate([swings[..., torque], largest[..., torque], swings[..., others]], axis=-1)

        return BoxPeaks(in_order(swing, largest), in_order(half, most), in_order(self.blame, self.blame))

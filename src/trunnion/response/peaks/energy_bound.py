"""How far a forced motion may lie from one that solves its equations but for a residual, by a Lyapunov function.

Let ż = Az + f and V = z*Pz as in ``floquet.certificate.proof``, so that V falls as e^(−2μt) at least where nothing
acts. The error e of a motion with residual r has V̇ ≤ −2μV + 2√V √(r*Pr), so that in the steady state
√V ≤ sup √(r*Pr)/μ, and |e_i| ≤ √((P⁻¹)_ii V). Slow speeds do not matter to that, nor how many harmonics lie between an
order and a mode.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.floquet.certificate.box_equations import BoxMatrix
from trunnion.floquet.certificate.periodic_lyapunov import LyapunovSeries, ModalBox, lyapunov_series
from trunnion.floquet.certificate.proof import check
from trunnion.floquet.certificate.waves import OUTWARD

SLACK = 1e-6
"""By what share inverses of P are widened: more than rounding makes of them below ``WORST``."""
WORST = 1e8
"""Condition of P from which nothing is said."""
TIMES = 256
"""Angles at which P is looked at."""


@dataclass(frozen=True)
class EnergyBound:
    """``size`` (D, D) bounds P in moduli, ``reach`` (D,) bounds √(P⁻¹)_ii, ``decay`` μ [1/s]; in modal coordinates,
    which are off by ``off`` (D, D)."""

    size: Array
    reach: Array
    decay: float
    off: Array

    def error(self, residual: Array) -> Array:
        """|e| (D,) of moduli of a residual (D,), both at any time."""
        acting = residual + self.off @ residual
        found = self.reach * np.sqrt(acting @ self.size @ acting) / self.decay
        return np.asarray((found + self.off @ found) * OUTWARD)


def energy_bound(box: BoxMatrix, modal: ModalBox, off: Array) -> EnergyBound | None:
    """Of a box; None where it is not proved stable as a whole."""
    for sides in (0, None):
        series = lyapunov_series(box, modal, sides)
        found = check(box, modal, series)
        if found.proved and found.decay > 0:
            reach = _reach(series)
            size = np.abs(series.parts).sum(axis=(0, 1)) * OUTWARD
            return None if reach is None else EnergyBound(size, reach, found.decay, off)
    return None


def _reach(series: LyapunovSeries) -> Array | None:
    """At even angles P ≥ P_j − Δ ≥ (1 − d)P_j, Δ what parameters and angles between make of it in moduli."""
    last = series.parts.shape[1] // 2
    times = TIMES if last else 1
    order = np.arange(-last, last + 1)
    turned = np.exp(2j * np.pi * np.outer(np.arange(times) / times, order))
    at = np.tensordot(turned, series.parts[0], 1)
    size = np.abs(series.parts).sum(axis=1)
    between = (np.abs(order)[:, None, None] * np.abs(series.parts[0])).sum(axis=0) * (np.pi / times)
    beside = (size[1:].sum(axis=0) + between) * OUTWARD + 1e-12 * size[0]
    reach = np.zeros(at.shape[1])
    for one in (at + at.conj().swapaxes(1, 2)) / 2:
        values, vectors = np.linalg.eigh(one)
        if not values[0] > values[-1] / WORST:
            return None
        half = np.abs(vectors / np.sqrt(values))  # |L⁻¹| of P_j = LL*
        share = float((half.T @ beside @ half).sum(axis=1).max()) * (1 + SLACK)
        if not share < 0.9:
            return None
        reach = np.maximum(reach, np.sqrt((half**2).sum(axis=1) / (1 - share)) * (1 + SLACK))
    return reach

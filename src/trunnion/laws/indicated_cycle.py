"""The ideal cycle of an engine whose work is known (Seiliger's, with heat at constant volume and at constant pressure).

In units of the swept volume the clearance is v₂ = 1/(ε − 1) and the largest volume v₁ = ε/(ε − 1). From the bottom
dead centre the charge p₁ is compressed as p vⁿ stays what it is, to p₂ = p₁ εⁿ at the top dead centre. There the
pressure jumps to the highest one, p₃, and stays while the piston gives way to the volume ρ v₂, ρ the cut-off ratio;
then p vᵐ stays what it is, until the valve opens at the bottom dead centre and leaves p₁ for the rest of the cycle.
Its work over the swept volume, the mean indicated pressure, is what the three parts of ∮ p dv give:

    p_mi = p₃ v₂ (ρ − 1) + p₃ ρ v₂ (1 − (ρ/ε)^(m−1))/(m − 1) − p₁ v₁ (ε^(n−1) − 1)/(n − 1)

with the logarithm where an exponent is 1. Its slope by ρ is p₃ v₂ m/(m − 1) (1 − (ρ/ε)^(m−1)), positive up to ρ = ε,
so that a mean indicated pressure between those of ρ = 1 and ρ = ε belongs to one cut-off ratio. Gas exchange costs
nothing: the loop between exhaust and charge is left out. So is how combustion takes its time, which rounds off the
corners that carry the high orders. No table is used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.laws.gas_torque import harmonics_between, piston_depth


@dataclass(frozen=True)
class IndicatedCycle:
    """ε, p₁ [Pa], n, m and p₃ [Pa]."""

    ratio: float
    charge: float
    compression: float
    expansion: float
    peak: float

    @property
    def compressed(self) -> float:
        """p₂ [Pa] at the end of compression."""
        return float(self.charge * self.ratio**self.compression)

    def mean_pressure(self, cut_off: float) -> float:
        """p_mi [Pa] for a cut-off ratio from 1 to ε."""
        clearance, largest = 1 / (self.ratio - 1), self.ratio / (self.ratio - 1)
        burning = self.peak * clearance * (cut_off - 1)
        expanding = -self.peak * cut_off * clearance * _power(cut_off / self.ratio, self.expansion - 1)
        return burning + expanding - self.charge * largest * _power(self.ratio, self.compression - 1)

    @property
    def least(self) -> float:
        """p_mi [Pa] that the highest pressure gives by itself, all heat at constant volume."""
        return self.mean_pressure(1.0)

    @property
    def most(self) -> float:
        """p_mi [Pa] at most, with heat until the end of the stroke."""
        return self.mean_pressure(self.ratio)

    def cut_off(self, mean: float) -> float:
        """ρ at which p_mi is ``mean`` [Pa], between ``least`` and ``most``."""
        from scipy.optimize import brentq

        return float(brentq(lambda ratio: self.mean_pressure(ratio) - mean, 1.0, self.ratio, xtol=1e-15, rtol=1e-14))

    def harmonics(
        self, cut_off: float, share: float, cycle: float, behind: float, orders: Array
    ) -> tuple[float, Complex]:
        """Mean T₀ and c_k (orders,) of T/(A r), as of ``gas_harmonics``, for a cut-off ratio.

        share : λ = r/l; cycle : 2π or 4π [rad]; behind : pressure behind the piston [Pa].
        """

        def pressure(angle: Array) -> Array:
            volume = 1 + (self.ratio - 1) * piston_depth(angle, share) / 2  # over the clearance
            rising = self.charge * (self.ratio / volume) ** self.compression
            falling = self.peak * np.minimum(cut_off / volume, 1.0) ** self.expansion
            closed = np.where(angle < 0, rising, falling)
            return np.asarray(np.where(np.abs(angle) < np.pi, closed, self.charge) - behind)

        corner = burning_angle(cut_off, self.ratio, share)
        knots = np.unique([-cycle / 2, -np.pi, 0.0, corner, np.pi, cycle / 2])
        return harmonics_between(knots, pressure, share, orders)


def without_fire(ratio: float, charge: float, exponent: float) -> IndicatedCycle:
    """Of a charge that is compressed and expands again: p Vⁿ stays what it is, at a cut-off ratio of 1."""
    return IndicatedCycle(ratio, charge, exponent, exponent, charge * ratio**exponent)


def burning_angle(cut_off: float, ratio: float, share: float) -> float:
    """Crank angle [rad] at which the piston has given way to ``cut_off`` times the clearance volume."""
    crank, rod = 1.0, 1 / share
    reach = crank + rod - 2 * (cut_off - 1) / (ratio - 1)  # from the centre of the crank to the pin of the piston
    return float(np.arccos(np.clip((crank**2 + reach**2 - rod**2) / (2 * crank * reach), -1.0, 1.0)))


def _power(base: float, exponent: float) -> float:
    """(base^exponent − 1)/exponent, the logarithm at 0."""
    return float(np.log(base) if exponent == 0 else np.expm1(exponent * np.log(base)) / exponent)

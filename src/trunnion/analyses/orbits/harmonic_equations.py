"""The balance of the harmonics of a periodic motion, as equations of its Fourier series and one parameter.

For ẋ = f(t, x) with period T the series x(t) of H harmonics must satisfy the first H harmonics of the equation.
f is evaluated in the time domain, at samples of the period, and transformed (alternating frequency–time: Cameron
and Griffin, J. Appl. Mech. 56, 1989); the Jacobian is exact, from ∂f/∂x at the same samples, also across the kinks
of a piecewise force.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from trunnion.analyses.orbits.balancing import Series
from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.integration.sampled_rates import sampled_rates
from trunnion.systems.system import System

FEWEST = 8
"""Harmonics to begin with, and those whose samples are the fewest taken."""
SMOOTH_SAMPLES, KINKED_SAMPLES = 8, 128
"""Samples per harmonic: what is not resolved of a kink folds back, and must stay below what the series leaves out."""


class Family(Protocol):
    """Systems by a value: ``at``; scale (n + 1,): size of each state and of the value that counts as one."""

    @property
    def at(self) -> Callable[..., System]:
        """value → system."""

    @property
    def scale(self) -> Array:
        """(n + 1,)."""


@dataclass
class HarmonicEquations(Series):
    """The balance of h harmonics as equations of a curve z = (series, value)."""

    over: Family
    periods: int
    h: int

    @property
    def size(self) -> int:
        return len(self.over.scale) - 1

    @property
    def scale(self) -> Array:
        wide = 2 * self.h + 1
        return np.append(np.repeat(self.over.scale[:-1], wide), self.over.scale[-1])

    def equations(self, z: Array) -> tuple[Array, Array]:
        """What the balance leaves over one radian, in units of the states' scales, and its derivative."""
        n, wide, value = self.size, 2 * self.h + 1, float(z[-1])
        nothing = np.full(n * wide, np.nan), np.full((n * wide, n * wide + 1), np.nan)
        here = self._left(z[:-1].reshape(n, wide), value, with_slope=True)
        if here is None:
            return nothing
        left, slope = here
        # The parameter enters in any way, the period included: central differences, good to some 1e-9.
        step = 1e-4 * float(self.over.scale[-1])
        beside = [self._left(z[:-1].reshape(n, wide), value + side * step, with_slope=False) for side in (-1, 1)]
        if beside[0] is None or beside[1] is None:
            return nothing
        by_parameter = (beside[1][0] - beside[0][0]) / (2 * step)
        over = 1 / np.repeat(self.over.scale[:-1], wide)
        return left * over, np.hstack([slope, by_parameter[:, None]]) * over[:, None]

    def _left(self, rows: Array, value: float, *, with_slope: bool) -> tuple[Array, Array] | None:
        """(D X − F)/ω (n (2h + 1),) and its derivative by the rows."""
        try:
            system = self.over.at(value)
        except InputError:  # a trial value may be no value of this parameter
            return None
        if system.forcing_period is None or not np.isfinite(rows).all():
            return None
        n, wide, h = self.size, 2 * self.h + 1, self.h
        period = self.periods * system.forcing_period
        omega = 2 * np.pi / period
        per_harmonic = SMOOTH_SAMPLES if system.regimes is None else KINKED_SAMPLES
        count = 1 << int(np.ceil(np.log2(per_harmonic * max(h, FEWEST))))
        states = np.ascontiguousarray(fourier.samples(rows, count).T)
        evaluated = sampled_rates(
            system.equations, period * np.arange(count) / count, states, system.regime_at(0.0, states[0])
        )
        if evaluated is None:
            return None
        rates, jacobians, _ = evaluated
        left = (fourier.rate(rows, omega) - fourier.rows_of(rates.T, h)) / omega
        if not with_slope:
            return left.ravel(), np.zeros((0, 0))
        slope = -fourier.product_blocks(jacobians, h)
        slope[np.arange(n), :, np.arange(n), :] += fourier.rate_matrix(h, omega)
        return left.ravel(), slope.reshape(n * wide, n * wide) / omega

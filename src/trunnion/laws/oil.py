"""Complex stiffness of silicone oil, K′ + iK″, over frequency and temperature, from points of a maker's sheet.

Log K′ and log K″ follow a monotone cubic of log f between the points of one temperature, and a straight line of the
temperature between those of two: both fall about exponentially with it. Nothing is said beyond the points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.laws.monotone_cubic import monotone_cubic

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator


@dataclass(frozen=True)
class Isotherm:
    """At one ``temperature`` [K] rising ``frequencies`` [rad/s] with ``storage`` K′ and ``loss`` K″ [N m/rad]."""

    temperature: float
    frequencies: tuple[float, ...]
    storage: tuple[float, ...]
    loss: tuple[float, ...]

    @cached_property
    def _through(self) -> PchipInterpolator:
        logs = np.log([self.storage, self.loss]).T
        return monotone_cubic(np.log(self.frequencies), logs)

    def logs(self, frequency: Any) -> Array:
        """Log K′ and log K″ (…, 2) at frequencies [rad/s]; NaN beyond its own."""
        low, high = self.frequencies[0], self.frequencies[-1]
        near = np.where(np.abs(frequency / low - 1) < ROUNDING, low, frequency)
        near = np.where(np.abs(near / high - 1) < ROUNDING, high, near)
        with np.errstate(divide="ignore"):
            return (
                np.asarray(self._through(np.clip(np.log(near), np.log(low), np.log(high))))
                + np.where((near < low) | (near > high), np.nan, 0.0)[..., None]
            )


ROUNDING = 1e-12
"""Relative difference of a frequency from an end of the table that rounding makes."""


@dataclass(frozen=True)
class OilStiffness:
    """All temperatures of a sheet, rising.

    >>> oil = OilStiffness((Isotherm(300.0, (100.0, 1000.0), (10.0, 1000.0), (100.0, 1000.0)),))
    >>> print(complex(oil.at(1000.0, 300.0)).real.__round__(6))
    1000.0
    """

    isotherms: tuple[Isotherm, ...]

    def at(self, frequency: Any, temperature: Any) -> Complex:
        """K′ + iK″ at frequencies [rad/s] of either sign and temperatures [K] that broadcast; NaN beyond the points.

        A spring that turns backwards is the same: K(−ω) is the conjugate.
        """
        f, t = np.broadcast_arrays(np.asarray(frequency, float), np.asarray(temperature, float))
        size = np.abs(f)
        if len(self.isotherms) == 1:
            only = self.isotherms[0]
            same = np.abs(t - only.temperature) <= ROUNDING * abs(only.temperature)
            logs = np.where(same[..., None], only.logs(size), np.nan)
        else:
            temperatures = np.array([one.temperature for one in self.isotherms])
            place = np.clip(np.searchsorted(temperatures, t, side="right") - 1, 0, len(temperatures) - 2)
            every = np.stack([one.logs(size) for one in self.isotherms])
            below, above = (np.take_along_axis(every, (place + k)[None, ..., None], axis=0)[0] for k in (0, 1))
            share = (t - temperatures[place]) / (temperatures[place + 1] - temperatures[place])
            inside = (share >= 0) & (share <= 1)
            share = np.where(inside, share, np.nan)[..., None]
            # At a temperature of the sheet itself the other one says nothing.
            logs = np.where(share == 0, below, np.where(share == 1, above, below + share * (above - below)))
        storage, loss = np.exp(logs[..., 0]), np.exp(logs[..., 1])
        return np.asarray(storage + 1j * np.sign(f) * loss)

    def beyond(self, frequency: Any, temperature: Any) -> tuple[float, float] | None:
        """The first frequency and temperature that its points do not reach; None where they reach all."""
        unknown = np.isnan(self.at(frequency, temperature))
        if not unknown.any():
            return None
        first, at = (np.broadcast_to(one, unknown.shape)[unknown][0] for one in (frequency, temperature))
        return float(first), float(at)

    def apart(
        self,
        frequency: float,
        temperature: float,
        side_by_side: tuple[float, float],
        series: tuple[float, float, float],
    ) -> tuple[float, float]:
        """Largest errors over its size, within a factor of √2 of a frequency or of its points, of a spring and a damper
        (k, c) side by side, and of those in series with an inertia between (k, c, J)."""
        low, high = self.reach(temperature)
        span = np.geomspace(max(low, frequency / 2**0.5), min(high, frequency * 2**0.5), 65)
        truth, (k, c), (spring, damper, between) = self.at(span, temperature), side_by_side, series
        error = np.abs((k + 1j * span * c) / truth - 1)
        other = np.abs(1 / (1 / spring + 1 / (1j * span * damper)) / truth - 1) + span**2 * between / spring
        return float(np.nanmax(error)), float(np.nanmax(other))

    def reach(self, temperature: float) -> tuple[float, float]:
        """Lowest and highest frequency [rad/s] known at a temperature."""
        near = [one for one in self.isotherms if one.temperature == temperature] or list(self._beside(temperature))
        return max(one.frequencies[0] for one in near), min(one.frequencies[-1] for one in near)

    def _beside(self, temperature: float) -> tuple[Isotherm, ...]:
        if len(self.isotherms) == 1:
            return self.isotherms
        known = [one.temperature for one in self.isotherms]
        place = int(np.clip(np.searchsorted(known, temperature) - 1, 0, len(known) - 2))
        return self.isotherms[place : place + 2]

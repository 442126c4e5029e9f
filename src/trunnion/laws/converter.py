"""A hydrodynamic torque converter: what its pump takes and its turbine gives, by the speeds of both.

With ν = ω_t/ω_p the pump takes T_p = K(ν) ω_p² and the turbine gives T_t = μ(ν) T_p; capacity K and torque ratio μ are
those of its sheet (SAE J643), a monotone cubic between their points, as torques over speed are. Both are of second
order in the speeds together, so that with h = μK

    ∂T_p/∂ω_p = (2K − νK′) ω_p,   ∂T_p/∂ω_t = K′ω_p,   ∂T_t/∂ω_p = (2h − νh′) ω_p,   ∂T_t/∂ω_t = h′ω_p.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.arrays import Array
from trunnion.laws.balance import balances as all_balances
from trunnion.laws.monotone_cubic import monotone_cubic
from trunnion.laws.torque_curve import TorqueCurve

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator

STANDS = 1e-6
"""Share of the highest ratio of speeds below which no balance is looked for: the turbine stands."""


@dataclass(frozen=True)
class ConverterCurves:
    """Capacity K [N m s²/rad²] and torque ratio μ [1] at rising speed ratios.

    >>> curves = ConverterCurves((0.0, 0.5, 1.0), (2.0, 1.5, 1.0), (4e-3, 4e-3, 0.0))
    >>> print(float(curves.pump(0.5)), float(curves.turbine(0.5)))
    0.004 0.006
    """

    ratios: tuple[float, ...]
    torque_ratios: tuple[float, ...]
    capacities: tuple[float, ...]

    @cached_property
    def capacity(self) -> PchipInterpolator:
        """K over ν."""
        return monotone_cubic(self.ratios, self.capacities)

    @cached_property
    def torque_ratio(self) -> PchipInterpolator:
        """μ over ν."""
        return monotone_cubic(self.ratios, self.torque_ratios)

    def pump(self, ratio: Array | float) -> Array:
        """K."""
        return np.asarray(self.capacity(ratio))

    def turbine(self, ratio: Array | float) -> Array:
        """h = μK."""
        return np.asarray(self.capacity(ratio) * self.torque_ratio(ratio))

    def slopes(self, ratio: float) -> tuple[float, float]:
        """K′ and h′."""
        k, m = float(self.capacity(ratio)), float(self.torque_ratio(ratio))
        k1, m1 = float(self.capacity(ratio, 1)), float(self.torque_ratio(ratio, 1))
        return k1, m1 * k + m * k1

    @cached_property
    def pieces(self) -> Array:
        """Per point the ratio, and powers from 0 to 3 of K and of μ above it (point, 9)."""
        found = np.zeros((len(self.ratios), 9))
        found[:, 0] = self.ratios
        found[:-1, 1:5], found[:-1, 5:] = self.capacity.c[::-1].T, self.torque_ratio.c[::-1].T
        return found

    def at(self, ratio: float, pump_speed: float) -> ConverterRun:
        """Torques and slopes at a ratio of speeds and a speed of the pump [rad/s]."""
        k, h = float(self.pump(ratio)), float(self.turbine(ratio))
        k1, h1 = self.slopes(ratio)
        return ConverterRun(
            ratio, pump_speed, k * pump_speed**2, h * pump_speed**2,
            ((2 * k - ratio * k1) * pump_speed, k1 * pump_speed),
            ((2 * h - ratio * h1) * pump_speed, h1 * pump_speed),
        )  # fmt: skip


@dataclass(frozen=True)
class ConverterRun:
    """How a converter runs: ω_t/ω_p, ω_p [rad/s], T_p and T_t [N m], and the slopes of each by ω_p and by ω_t
    [N m s/rad]."""

    ratio: float
    pump_speed: float
    pump_torque: float
    turbine_torque: float
    pump_slopes: tuple[float, float]
    turbine_slopes: tuple[float, float]

    @property
    def heat(self) -> float:
        """What does not come out at the turbine [W]."""
        return (self.pump_torque - self.ratio * self.turbine_torque) * self.pump_speed

    @property
    def lost_torque(self) -> float:
        """T_p − νT_t [N m], by which it resists at the pump beyond what it passes on as power."""
        return self.pump_torque - self.ratio * self.turbine_torque

    @property
    def link(self) -> float:
        """Damping [N m s/rad] of a viscous link between the turbine and a shaft that turns ν times as fast as the pump,
        which equations have as the part of it that acts on both sides alike: any positive one, of its size."""
        acting = abs(self.turbine_torque) + abs(self.pump_torque)
        return acting / self.pump_speed if acting else 0.0

    @property
    def left(self) -> Array:
        """What that link leaves of the damping [N m s/rad] that acts on pump and turbine (row) by the speed of either
        (column)."""
        (pp, pt), (tp, tt), v, c = self.pump_slopes, self.turbine_slopes, self.ratio, self.link
        return np.array([[pp - c * v * v, pt + c * v], [-tp + c * v, -tt - c]])


STANDING = ConverterRun(1.0, 0.0, 0.0, 0.0, (0.0, 0.0), (0.0, 0.0))
"""Pump and turbine at rest."""


@dataclass(frozen=True)
class TurbineCurve:
    """What the turbine takes off its loads over its own speed, −h(ω_t/ω_p) ω_p² at one speed of the pump [rad/s]."""

    curves: ConverterCurves
    pump_speed: float

    @property
    def range(self) -> tuple[float, float]:
        """The speeds of its points."""
        return self.curves.ratios[0] * self.pump_speed, self.curves.ratios[-1] * self.pump_speed

    @property
    def knots(self) -> tuple[float, ...]:
        """Likewise."""
        return tuple(ratio * self.pump_speed for ratio in self.curves.ratios)

    def _ratio(self, speed: Any) -> Array:
        first, last = self.curves.ratios[0], self.curves.ratios[-1]
        return np.clip(np.asarray(speed) / self.pump_speed, first, last)

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        return np.asarray(-self.curves.turbine(self._ratio(speed)) * self.pump_speed**2)

    def slope(self, speed: Any) -> Array:
        """Its derivative by the speed of the turbine [N m s/rad]."""
        ratio = self._ratio(speed)
        k, m = self.curves.capacity, self.curves.torque_ratio
        return np.asarray(-(m(ratio, 1) * k(ratio) + m(ratio) * k(ratio, 1)) * self.pump_speed)


def balances(
    curves: ConverterCurves, loads: Sequence[tuple[float, TorqueCurve]], pump_speed: float
) -> Iterator[tuple[float, bool]]:
    """All ratios of speeds above 0, rising, at which the turbine carries its ``loads`` at a speed of the pump, and
    whether each lasts: a turbine that turns a little faster is braked. Each load goes with the ratio of its shaft's
    speed to the turbine's."""
    own = TurbineCurve(curves, pump_speed)
    for one in all_balances([(1.0, own), *loads], STANDS * own.range[1], own.range[1]):
        yield one.speed / pump_speed, one.stable


def _slope(
    curves: ConverterCurves, loads: Sequence[tuple[float, TorqueCurve]], pump_speed: float, ratio: float
) -> float:
    """By the speed of the turbine, of what drives it beyond its loads [N m s/rad]."""
    resists = sum(r * r * float(load.slope(r * ratio * pump_speed)) for r, load in loads)
    return curves.slopes(ratio)[1] * pump_speed - resists


def pump_slope(curves: ConverterCurves, loads: Sequence[tuple[float, TorqueCurve]], point: ConverterRun) -> float:
    """By which T_p rises with the speed of the pump [N m s/rad], where the turbine follows its balance."""
    (pp, pt), (tp, _) = point.pump_slopes, point.turbine_slopes
    return pp - pt * tp / _slope(curves, loads, point.pump_speed, point.ratio)

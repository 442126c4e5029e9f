"""Torque over speed as a curve: value, slope and where it holds; tables, Kloss's formula, powers of the speed.

Between the points of a table the torque follows a monotone cubic (Fritsch and Carlson, *SIAM J. Numer. Anal.* 17, 1980,
as scipy's ``PchipInterpolator``): it goes through the points, has no maximum or minimum of its own, and its slope is
continuous. Kloss's formula of an asynchronous motor is, with slip s = 1 − ω/ω_s,

    T = 2 T_b s s_b / (s² + s_b²),

odd about the synchronous speed ω_s, steepest there, and largest at the breakdown slip s_b.

Between two neighbours among its ``knots`` every curve is smooth, by which ``trunnion.laws.balance`` finds all balances
of curves. Whether a torque drives or resists is for its owner to say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.polynomial import Polynomial

from trunnion.arrays import Array
from trunnion.laws.monotone_cubic import monotone_cubic

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator


class TorqueCurve(Protocol):
    """A torque [N m] over a speed ω [rad/s] of any shape; numbers in, arrays out. Beyond its range it is NaN."""

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest speed [rad/s] at which it says something; infinite where it says so everywhere."""
        ...

    @property
    def knots(self) -> tuple[float, ...]:
        """Rising speeds [rad/s] within its range between which it is smooth: one formula."""
        ...

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        ...

    def slope(self, speed: Any) -> Array:
        """Its derivative by the speed [N m s/rad]."""
        ...


@dataclass(frozen=True)
class PowerCurve:
    """c₀ + c₁ω + c₂ω|ω|: constant, viscous and quadratic; c₀ [N m], c₁ [N m s/rad], c₂ [N m s²/rad²].

    >>> fan = PowerCurve(quadratic=0.02)
    >>> print(float(fan.value(100.0)), float(fan.slope(100.0)))
    200.0 4.0
    """

    constant: Any = 0.0
    viscous: Any = 0.0
    quadratic: Any = 0.0

    @property
    def range(self) -> tuple[float, float]:
        """Everywhere."""
        return -np.inf, np.inf

    @property
    def knots(self) -> tuple[float, ...]:
        """The quadratic part turns its sign with the speed."""
        return (0.0,)

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        return np.asarray(self.constant + self.viscous * speed + self.quadratic * speed * np.abs(speed))

    def slope(self, speed: Any) -> Array:
        """c₁ + 2c₂|ω| [N m s/rad]."""
        return np.asarray(self.viscous + 2 * self.quadratic * np.abs(speed))


@dataclass(frozen=True)
class KlossCurve:
    """Kloss's formula of an asynchronous machine: it drives below its synchronous speed and brakes above.

    breakdown_torque T_b [N m]; breakdown_slip s_b, between 0 and 1; synchronous_speed ω_s [rad/s]. Numbers, or arrays
    that broadcast with the speeds asked for.

    >>> motor = KlossCurve(breakdown_torque=120.0, breakdown_slip=0.1, synchronous_speed=100.0)
    >>> print(round(float(motor.value(90.0)), 9), round(float(motor.slope(100.0)), 9))
    120.0 -24.0
    """

    breakdown_torque: Any
    breakdown_slip: Any
    synchronous_speed: Any

    @property
    def range(self) -> tuple[float, float]:
        """Everywhere."""
        return -np.inf, np.inf

    @property
    def knots(self) -> tuple[float, ...]:
        """One formula."""
        return ()

    def slip(self, speed: Any) -> Array:
        """1 − ω/ω_s."""
        return np.asarray(1 - speed / self.synchronous_speed)

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        s, b = self.slip(speed), self.breakdown_slip
        return np.asarray(2 * self.breakdown_torque * s * b / (s**2 + b**2))

    def slope(self, speed: Any) -> Array:
        """dT/dω = −(2 T_b s_b/ω_s) (s_b² − s²)/(s² + s_b²)² [N m s/rad]."""
        s, b = self.slip(speed), self.breakdown_slip
        steepest = 2 * self.breakdown_torque * b / self.synchronous_speed
        return np.asarray(-steepest * (b**2 - s**2) / (s**2 + b**2) ** 2)

    def slope_at_torque(self, torque: Any) -> Array:
        """Slope [N m s/rad] where a converter moves the curve along the speed, unchanged, so that it gives ``torque``
        on its falling branch; NaN beyond the breakdown torque.

        At the slip s = s_b T/(T_b + √(T_b² − T²)).
        """
        with np.errstate(invalid="ignore"):
            root = np.sqrt(self.breakdown_torque**2 - np.square(torque))
        slip = self.breakdown_slip * torque / (self.breakdown_torque + root)
        return self.slope(self.synchronous_speed * (1 - slip))

    def ratio(self, speed: float) -> tuple[Polynomial, Polynomial]:
        """Numerator and positive denominator, polynomials of ω: the formula by the slip, a polynomial of ω itself."""
        slip, b = Polynomial([1.0, -1.0 / float(self.synchronous_speed)]), float(self.breakdown_slip)
        return 2 * float(self.breakdown_torque) * b * slip, slip**2 + b**2


@dataclass(frozen=True)
class TableCurve:
    """Through points, speeds [rad/s] rising and torques [N m]; two or more. NaN beyond the first and the last.

    >>> curve = TableCurve((0.0, 100.0, 150.0), (300.0, 260.0, 120.0))
    >>> print(float(curve.value(100.0)), curve.range)
    260.0 (0.0, 150.0)
    """

    speeds: Sequence[float]
    torques: Sequence[float]

    @cached_property
    def _through(self) -> PchipInterpolator:
        return monotone_cubic(self.speeds, self.torques)

    @property
    def range(self) -> tuple[float, float]:
        """From the first to the last point."""
        return float(self.speeds[0]), float(self.speeds[-1])

    @property
    def knots(self) -> tuple[float, ...]:
        """Its points."""
        return tuple(map(float, self.speeds))

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        return np.asarray(self._through(speed))

    def slope(self, speed: Any) -> Array:
        """Derivative of the cubic [N m s/rad]."""
        return np.asarray(self._through.derivative()(speed))


@dataclass(frozen=True)
class ClippedLine:
    """A speed controller of gain g: g (ω_set − ω), at most ``limit`` of either sign; slope 0 beyond.

    gain [N m s/rad], set_speed [rad/s] and limit [N m] (infinite: none) are numbers or arrays.

    >>> control = ClippedLine(gain=10.0, set_speed=150.0, limit=200.0)
    >>> print(float(control.value(145.0)), float(control.value(100.0)), float(control.slope(100.0)))
    50.0 200.0 0.0
    """

    gain: Any
    set_speed: Any
    limit: Any = np.inf

    @property
    def range(self) -> tuple[float, float]:
        """Everywhere."""
        return -np.inf, np.inf

    @property
    def knots(self) -> tuple[float, ...]:
        """Where the limit begins, below and above the speed that is set."""
        if not np.isfinite(self.limit):
            return ()
        reach = float(self.limit / self.gain)
        return float(self.set_speed) - reach, float(self.set_speed) + reach

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        return np.asarray(np.clip(self.gain * (self.set_speed - speed), -self.limit, self.limit))

    def slope(self, speed: Any) -> Array:
        """−g within the limit [N m s/rad]."""
        within = np.abs(self.gain * (self.set_speed - speed)) < self.limit
        return np.asarray(np.where(within, -self.gain, 0.0))


@dataclass(frozen=True)
class PowerLimit:
    """Constant power: T = P/ω at positive speeds, NaN at others; its slope −P/ω² falls. ``power`` [W]: one or many.

    >>> print(float(PowerLimit(3000.0).value(150.0)))
    20.0
    """

    power: Any

    @property
    def range(self) -> tuple[float, float]:
        """From standstill on."""
        return 0.0, np.inf

    @property
    def knots(self) -> tuple[float, ...]:
        """One formula."""
        return (0.0,)

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        return np.asarray(self.power / np.where(np.asarray(speed) > 0, speed, np.nan))

    def slope(self, speed: Any) -> Array:
        """−P/ω² [N m s/rad]."""
        return np.asarray(-self.power / np.where(np.asarray(speed) > 0, speed, np.nan) ** 2)


@dataclass(frozen=True)
class Opposite:
    """Minus a curve: what drives by it resists by this.

    >>> print(float(Opposite(PowerCurve(quadratic=0.02)).value(100.0)))
    -200.0
    """

    curve: TorqueCurve

    @property
    def range(self) -> tuple[float, float]:
        """As of the curve."""
        return self.curve.range

    @property
    def knots(self) -> tuple[float, ...]:
        """As of the curve."""
        return self.curve.knots

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        return np.asarray(-self.curve.value(speed))

    def slope(self, speed: Any) -> Array:
        """Its derivative [N m s/rad]."""
        return np.asarray(-self.curve.slope(speed))


@dataclass(frozen=True)
class StribeckCurve:
    """Dry friction that falls with the speed of slip: sign(ω) (T_c + (T_s − T_c) e^(−|ω|/ω_s)).

    sliding T_c and static T_s [N m], falling ω_s [rad/s]: numbers or arrays.

    >>> brake = StribeckCurve(sliding=200.0, static=260.0, falling=2.0)
    >>> print(round(float(brake.value(2.0)), 3), round(float(brake.slope(2.0)), 3))
    222.073 -11.036
    """

    sliding: Any
    static: Any
    falling: Any

    @property
    def range(self) -> tuple[float, float]:
        """Everywhere."""
        return -np.inf, np.inf

    @property
    def knots(self) -> tuple[float, ...]:
        """It turns its sign with the speed."""
        return (0.0,)

    def _falls(self, speed: Any) -> Any:
        return (self.static - self.sliding) * np.exp(-np.abs(speed) / self.falling)

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        return np.asarray(np.where(np.asarray(speed) < 0, -1.0, 1.0) * (self.sliding + self._falls(speed)))

    def slope(self, speed: Any) -> Array:
        """−(T_s − T_c)/ω_s e^(−|ω|/ω_s) [N m s/rad]."""
        return np.asarray(-self._falls(speed) / self.falling)


@dataclass(frozen=True)
class FlowCurve:
    """A torque T by the square of the speed whose slope is ``factor`` T/ω and not 2 T/ω: the flow does not follow.

    ``quadratic`` c₂ [N m s²/rad²] gives the mean torque c₂ω|ω|; the slope is that of speeds which swing about a mean
    speed of the flow, so it is not a derivative of ``value``.

    >>> wheel = FlowCurve(0.02, factor=2.8)
    >>> print(float(wheel.value(100.0)), round(float(wheel.slope(100.0)), 9))
    200.0 5.6
    """

    quadratic: Any
    factor: Any

    @property
    def range(self) -> tuple[float, float]:
        """Everywhere."""
        return -np.inf, np.inf

    @property
    def knots(self) -> tuple[float, ...]:
        """The torque turns its sign with the speed."""
        return (0.0,)

    def value(self, speed: Any) -> Array:
        """Torque [N m]."""
        return np.asarray(self.quadratic * speed * np.abs(speed))

    def slope(self, speed: Any) -> Array:
        """factor T/ω [N m s/rad]."""
        return np.asarray(self.factor * self.quadratic * np.abs(speed))

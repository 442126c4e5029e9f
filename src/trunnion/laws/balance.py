"""Speeds at which torques over speed balance each other, all of them, and whether each lasts.

Curves M_i that resist at shafts of speed ratio R_i > 0 balance at the input speed Ω where

    f(Ω) = Σ R_i M_i(R_i Ω) = 0,

and the balance is stable where f rises: a line that turns a little faster is braked. Between two knots every curve is a
ratio of polynomials, so f times all denominators is one polynomial, whose roots are all balances.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from trunnion.laws.torque_curve import ONE, TorqueCurve

Geared = Sequence[tuple[float, TorqueCurve]]
"""Each curve that resists with the speed ratio R > 0 of its shaft."""
NEAR = 1e-5
"""How far from the real axis, over half a piece, a root may lie that rounding may have moved off it: a double root."""
ROUNDING, ZERO = 1e-13, 1e-9
"""Shares of the torques: of a coefficient that is rounding, and of what is left that counts as none."""
ALIKE = 1e-7
"""Relative difference of two balances that count as one, at a knot between two pieces."""
STEPS = 8


@dataclass(frozen=True)
class TorqueBalance:
    """A speed [rad/s] of the input where torques balance, and the slope [N m s/rad] of f there."""

    speed: float
    slope: float

    @property
    def stable(self) -> bool:
        """Whether what turns faster is braked."""
        return self.slope > 0


def torque_left(curves: Geared, speed: float) -> float:
    """f, the torque [N m] at the input that resists at an input speed [rad/s]; NaN beyond a curve."""
    return float(sum(ratio * curve.value(ratio * speed) for ratio, curve in curves))


def slope_left(curves: Geared, speed: float) -> float:
    """Its slope [N m s/rad], as that of what swings about the speed."""
    return float(sum(ratio**2 * curve.slope(ratio * speed) for ratio, curve in curves))


def balances(curves: Geared, low: float, high: float) -> tuple[TorqueBalance, ...]:
    """All balances between two input speeds [rad/s] that lie within all curves, rising.

    Speeds over a stretch of which the torques balance everywhere are none: nothing there tells one from the other.
    """
    low = max(low, *(curve.range[0] / ratio for ratio, curve in curves))
    high = min(high, *(curve.range[1] / ratio for ratio, curve in curves))
    if not low < high:
        return ()
    knots = sorted({knot / ratio for ratio, curve in curves for knot in curve.knots})
    pieces = [low, *(knot for knot in knots if low < knot < high), high]
    found: list[float] = []
    for first, last in zip(pieces, pieces[1:], strict=False):
        for root in _roots(curves, first, last):
            if not found or root - found[-1] > ALIKE * high:
                found.append(root)
    return tuple(TorqueBalance(speed, slope_left(curves, speed)) for speed in found)


def _roots(curves: Geared, low: float, high: float) -> Iterator[float]:
    """Rising roots of f between two speeds, no knot between them."""
    middle, half = (low + high) / 2, (high - low) / 2
    total = _numerator(curves, middle, half)
    if total.degree() < 1:
        return
    for root in sorted(map(complex, total.roots()), key=lambda one: one.real):
        if abs(root.imag) <= NEAR and abs(root.real) <= 1 + NEAR:
            at = _polished(curves, middle + half * min(max(root.real, -1.0), 1.0), low, high)
            acting = sum(abs(ratio * float(curve.value(ratio * at))) for ratio, curve in curves)
            if abs(torque_left(curves, at)) <= ZERO * acting:
                yield at


def _numerator(curves: Geared, middle: float, half: float) -> Polynomial:
    """f times all denominators as a polynomial of x, Ω = middle + half x, without what is rounding at its end."""
    over, under = Polynomial([0.0]), ONE
    for ratio, curve in curves:
        p, q = (part(Polynomial([ratio * middle, ratio * half])) for part in curve.ratio(ratio * middle))
        over, under = over * q + ratio * p * under, under * q
    acting = sum(abs(ratio * float(curve.value(ratio * middle))) for ratio, curve in curves)
    size = max(np.abs(over.coef).max(), acting * abs(under(0.0)))
    return Polynomial(np.where(np.abs(over.coef) > ROUNDING * size, over.coef, 0.0)).trim()


def _polished(curves: Geared, speed: float, low: float, high: float) -> float:
    """A root after a few steps of Newton's rule, which end where they no longer help."""
    left = abs(torque_left(curves, speed))
    for _ in range(STEPS):
        slope = sum(ratio**2 * _derivative(curve, ratio * speed) for ratio, curve in curves)
        if not left or not slope:
            break
        nearer = float(np.clip(speed - torque_left(curves, speed) / slope, low, high))
        if not abs(torque_left(curves, nearer)) < left:
            break
        speed, left = nearer, abs(torque_left(curves, nearer))
    return speed


def _derivative(curve: TorqueCurve, speed: float) -> float:
    """dT/dω of the piece there."""
    over, under = curve.ratio(speed)
    a, b = over(speed), under(speed)
    return float((over.deriv()(speed) * b - a * under.deriv()(speed)) / b**2)

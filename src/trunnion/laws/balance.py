"""Speeds at which torques over speed balance each other, all of them, and whether each lasts.

Curves M_i that resist at shafts of speed ratio R_i > 0 balance at the input speed Ω where

    f(Ω) = Σ R_i M_i(R_i Ω) = 0,

and the balance is stable where f rises: a line that turns a little faster is braked. Between two knots f is smooth.
Pieces are halved there until a polynomial through Chebyshev's points follows f to rounding, and the roots of these
polynomials (eigenvalues of the colleague matrix, Good, *Quarterly Journal of Mathematics* 12, 1961) are all balances.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial import chebyshev as chebyshev_series

from trunnion.arrays import Array
from trunnion.laws.torque_curve import TorqueCurve

Geared = Sequence[tuple[float, TorqueCurve]]
"""Each curve that resists with the speed ratio R > 0 of its shaft."""
DEGREE, TAIL = 24, 4
"""Degree of the polynomial over one piece, and how many of its last coefficients tell whether it follows f."""
FOLLOWED, ROUNDING, ZERO = 1e-11, 1e-14, 1e-9
"""Shares of the torques: of coefficients at the end of a polynomial that follows f, of f that is rounding alone, and of
what is left that counts as none."""
NARROWEST, LEAST = 1e-7, 1e-9
"""Width over the speed of a piece that is not halved again; the least speed over the highest that is looked at."""
NEAR = 1e-4
"""How far from the real axis, over half a piece, a root may lie that rounding may have moved off it: a double root."""
ALIKE = 1e-7
"""Relative difference of two balances that count as one, at a knot between two pieces."""
STEPS = 8

_POINTS = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
_TO_SERIES = np.linalg.inv(chebyshev_series.chebvander(_POINTS, DEGREE))


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
    return float(_at_input(curves, speed).sum())


def slope_left(curves: Geared, speed: float) -> float:
    """Its slope [N m s/rad], as that of what swings about the speed."""
    return float(sum(ratio**2 * curve.slope(ratio * speed) for ratio, curve in curves))


def balances(curves: Geared, low: float, high: float) -> tuple[TorqueBalance, ...]:
    """All balances between two input speeds [rad/s] that lie within all curves, rising.

    Speeds over a stretch of which the torques balance everywhere are none: nothing there tells one from the other.
    """
    high = min(high, *(curve.range[1] / ratio for ratio, curve in curves))
    low = max(low, LEAST * high, *(curve.range[0] / ratio for ratio, curve in curves))
    if not low < high:
        return ()
    knots = sorted({knot / ratio for ratio, curve in curves for knot in curve.knots})
    pieces = np.array([low, *(knot for knot in knots if low < knot < high), high])
    found: list[float] = []
    for root in sorted(_roots(curves, pieces[:-1], pieces[1:])):
        if not found or root - found[-1] > ALIKE * root:
            found.append(root)
    return tuple(TorqueBalance(speed, slope_left(curves, speed)) for speed in found)


def _roots(curves: Geared, low: Array, high: Array) -> Iterator[float]:
    """Roots of f in pieces (piece,) without a knot between their ends, in no order: all are looked at together, and
    where no polynomial follows f, their halves are; of wide ones by ratio."""
    while len(low):
        middle, half = (low + high) / 2, (high - low) / 2
        torques = _at_input(curves, middle[:, None] + half[:, None] * _POINTS)
        acting = np.abs(torques).sum(axis=0).max(axis=-1)
        series = torques.sum(axis=0) @ _TO_SERIES.T
        wide = high > 4 * low
        followed = (np.abs(series[:, -TAIL:]).max(axis=-1) <= FOLLOWED * acting) & ~wide
        followed |= 2 * half <= NARROWEST * high
        for i in np.flatnonzero(followed & np.isfinite(acting)):
            above = np.flatnonzero(np.abs(series[i]) > ROUNDING * acting[i])
            if above.size and abs(series[i, 0]) <= np.abs(series[i, 1:]).sum() + ZERO * acting[i]:
                smooth = Chebyshev(series[i, : above[-1] + 1], (low[i], high[i]))
                yield from _balanced(curves, smooth, float(middle[i]), float(half[i]))
        cut, at = ~followed & np.isfinite(acting), np.where(wide, np.sqrt(low * high), middle)
        low, high = np.append(low[cut], at[cut]), np.append(at[cut], high[cut])


def _balanced(curves: Geared, smooth: Chebyshev, middle: float, half: float) -> Iterator[float]:
    """Roots of f among those of the polynomial that follows it over a piece."""
    for root in (np.asarray(smooth.roots(), complex) - middle) / half:
        if abs(root.imag) <= NEAR and abs(root.real) <= 1 + NEAR:
            at = _polished(curves, smooth, middle + half * min(max(root.real, -1.0), 1.0))
            if abs(torque_left(curves, at)) <= ZERO * np.abs(_at_input(curves, at)).sum():
                yield float(at)


def _at_input(curves: Geared, speeds: Array | float) -> Array:
    """R M(RΩ) [N m] of every curve, (curve, *speeds.shape)."""
    return np.array([ratio * curve.value(ratio * speeds) for ratio, curve in curves])


def _polished(curves: Geared, smooth: Chebyshev, speed: float) -> float:
    """A root after a few steps of Newton's rule, which end where they no longer help."""
    left, rise = torque_left(curves, speed), smooth.deriv()
    for _ in range(STEPS):
        slope = float(rise(speed))
        if not left or not slope:
            break
        nearer = float(np.clip(speed - left / slope, *smooth.domain))
        found = torque_left(curves, nearer)
        if not abs(found) < abs(left):
            break
        speed, left = nearer, found
    return speed

"""Intervals by the profile likelihood: how far a parameter may go before χ² has risen by 3.84, all others refitted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.measured.identification.fitting import FitPoint, descend, values_at
from trunnion.measured.identification.misfit import Misfit

RISE = 3.841458820694124
"""χ² with one degree of freedom that 95 % stay below."""
NEAR = 0.03
"""By how much the rise may be missed."""
MOST = 24
LEFT = 1e-6
"""Share by which a better minimum has to be better to be one."""


@dataclass(frozen=True)
class ProfileInterval:
    """Between low and high (SI units) the parameter fits; open ends are those of its bounds."""

    low: float
    high: float
    low_open: bool
    high_open: bool


class BetterFit(Exception):
    """A profile came to a point that fits better than the best."""

    def __init__(self, point: FitPoint) -> None:
        self.point = point


def profile_interval(misfit: Misfit, best: FitPoint, place: int, spread: float, scale: float) -> ProfileInterval:
    """The interval of one parameter; ``spread`` [share] is its standard deviation as far as it is linear.

    scale : by which χ² counts: that of the best fit over its degrees of freedom where it is above 1.

    Raises
    ------
    BetterFit : a point was found that fits better than the best.
    """
    low, low_open = _end(misfit, best, place, -1.0, spread, scale)
    high, high_open = _end(misfit, best, place, 1.0, spread, scale)
    values = values_at(misfit, best.share)
    ends = []
    for share in (low, high):
        one = misfit.free[place]
        ends.append(one.low + share * (one.high - one.low))
    return ProfileInterval(min(ends[0], values[place]), max(ends[1], values[place]), low_open, high_open)


def _end(misfit: Misfit, best: FitPoint, place: int, sense: float, spread: float, scale: float) -> tuple[float, bool]:
    """Share at which the profile has risen enough, and whether that is the bound, where it has not."""
    held = np.zeros(len(misfit.free), dtype=bool)
    held[place] = True
    room = 1.0 - best.share[place] if sense > 0 else float(best.share[place])
    if room <= 0:
        return float(best.share[place]), True
    warm = best

    def rise(distance: float) -> float:
        nonlocal warm
        share = warm.share.copy()
        share[place] = np.clip(best.share[place] + sense * distance, 0.0, 1.0)
        # Where the input begins may make up for much of the parameter at once.
        angle = misfit.angle(misfit.predicted(values_at(misfit, share)[None])[0])
        warm = descend(misfit, share, angle, held)
        if warm.chi_square < best.chi_square - max(NEAR * scale, LEFT * best.chi_square):
            raise BetterFit(warm)
        return (warm.chi_square - best.chi_square) / scale

    inside, outside = (0.0, 0.0), (np.inf, np.inf)
    distance = min(room, max(1.96 * spread, 1e-9))
    for _ in range(MOST):
        value = rise(distance)
        if abs(value - RISE) < NEAR:
            return float(best.share[place] + sense * distance), False
        if value < RISE:
            if distance >= room:
                return float(best.share[place] + sense * room), True
            inside = distance, value
        else:
            outside = distance, value
        if not np.isfinite(outside[0]):
            # χ² rises as a square, at least near the best.
            factor = np.sqrt(RISE / max(value, 1e-3))
            distance = min(room, distance * float(np.clip(factor, 1.2, 6.0)))
            continue
        # Its root is all but straight.
        a, b = np.sqrt(max(inside[1], 0.0)), np.sqrt(outside[1])
        share = (np.sqrt(RISE) - a) / (b - a) if b > a else 0.5
        distance = inside[0] + float(np.clip(share, 0.05, 0.95)) * (outside[0] - inside[0])
        if outside[0] - inside[0] < 1e-12:
            break
    return float(best.share[place] + sense * distance), False


def covariance_of(slopes: Array) -> Array:
    """Covariance (unknown, unknown) of shares by Fisher's information; infinite directions are very large."""
    normal = slopes.T @ slopes
    values, vectors = np.linalg.eigh(normal)
    floor = max(float(values.max(initial=0.0)), 1e-300) * 1e-14
    return np.asarray((vectors / np.maximum(values, floor)) @ vectors.T)

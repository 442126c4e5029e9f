"""Intervals by the profile likelihood: how far a parameter may go before χ² has risen by 3.84, all others refitted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.measured.identification.fitting import FitPoint, descend, values_at
from trunnion.measured.identification.misfit import Misfit
from trunnion.waiting import keep_time

RISE = 3.841458820694124
"""χ² with one degree of freedom that 95 % stay below."""
NEAR = 0.03
"""By how much the rise may be missed."""
MOST = 24
LEFT = 1e-6
"""Share by which a better minimum has to be better to be one."""
FEW_STEPS, STEP_LEFT = 6, 1e-3
"""Steps by the slopes at the best, and what one more would take from χ² when they end."""
PARABOLA = 0.1
"""Share by which χ² may rise otherwise than a parabola, to be taken for one."""
NO_SLOPE = 1e-24
"""What χ² rises by over a whole range in a direction that the data do not see at all."""


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


def profile_interval(misfit: Misfit, best: FitPoint, slope: Array, place: int, scale: float) -> ProfileInterval:
    """The interval of one parameter.

    slope : of residuals (residual, unknown) over shares and the angle, at the best. scale : by which χ² counts: that
    of the best fit over its degrees of freedom where it is above 1.

    Raises
    ------
    BetterFit : a point was found that fits better than the best.
    """
    refit = _Refit(misfit, best, slope, place, scale)
    low, low_open = _end(misfit, refit, -1.0)
    high, high_open = _end(misfit, refit, 1.0)
    values = values_at(misfit, best.share)
    ends = []
    for share in (low, high):
        one = misfit.free[place]
        ends.append(one.low + share * (one.high - one.low))
    return ProfileInterval(min(ends[0], values[place]), max(ends[1], values[place]), low_open, high_open)


class _Refit:
    """All unknowns but one, fitted anew where that one is moved.

    Where the likelihood is Gaussian the others move along its covariance, and a few steps by the slopes at the best
    bring them to their minimum: each costs one line, a descent five times as much. Where χ² does not rise as a parabola
    does, they descend by slopes of their own.
    """

    def __init__(self, misfit: Misfit, best: FitPoint, slope: Array, place: int, scale: float) -> None:
        self.misfit, self.best, self.slope, self.place, self.scale = misfit, best, slope, place, scale
        self.count = len(misfit.free)
        covariance = covariance_of(slope)
        self.spread = float(np.sqrt(scale * covariance[place, place]))
        self.along = covariance[:, place] / covariance[place, place]
        self.others = np.arange(slope.shape[1]) != place
        self.gaussian = True
        self.warm = best

    def rise(self, distance: float) -> float:
        """By how much χ² has risen, the others refitted, where the parameter is moved by a share of its range."""
        best, place = self.best, self.place
        share = float(np.clip(best.share[place] + distance, 0.0, 1.0))
        found = self._by_slopes_of_best(share) if self.gaussian else None
        if found is None:
            self.gaussian = False
            found = self._descended(share)
        self.warm = found
        if found.chi_square < best.chi_square - max(NEAR * self.scale, LEFT * best.chi_square):
            raise BetterFit(found)
        return (found.chi_square - best.chi_square) / self.scale

    def _descended(self, to: float) -> FitPoint:
        held = ~self.others[: self.count]
        share = self.warm.share.copy()
        share[self.place] = to
        # Where the input begins may make up for much of the parameter at once.
        angle = self.misfit.angle(self.misfit.predicted(values_at(self.misfit, share)[None])[0])
        return descend(self.misfit, share, angle, held)

    def _by_slopes_of_best(self, to: float) -> FitPoint | None:
        """The minimum by the slopes at the best; None where a parabola does not describe it."""
        moved = to - float(self.best.share[self.place])
        unknown = np.append(self.best.share, self.best.angle)[: len(self.along)] + moved * self.along
        part = self.slope[:, self.others]
        normal = part.T @ part
        last = np.inf
        for _ in range(FEW_STEPS):
            keep_time()
            share = unknown[: self.count]
            if np.any((share < 0) | (share > 1)):
                return None
            angle = float(unknown[self.count]) if len(unknown) > self.count else self.best.angle
            residual = self.misfit.residuals(self.misfit.predicted(values_at(self.misfit, share)[None])[0], angle)
            value = float(residual @ residual)
            if not value < last:
                return None
            gradient = part.T @ residual
            try:
                step = -np.linalg.solve(normal, gradient)
            except np.linalg.LinAlgError:
                return None
            if -float(gradient @ step) < STEP_LEFT * self.scale:
                risen = (value - self.best.chi_square) / self.scale
                wanted = (moved / self.spread) ** 2
                is_parabola = abs(risen - wanted) < PARABOLA * max(wanted, RISE)
                return FitPoint(share, angle, value, True) if is_parabola else None
            last = value
            unknown[self.others] += step
        return None


def _end(misfit: Misfit, refit: _Refit, sense: float) -> tuple[float, bool]:
    """Share at which the profile has risen enough, and whether that is the bound, where it has not."""
    at = float(refit.best.share[refit.place])
    refit.warm = refit.best
    room = 1.0 - at if sense > 0 else at
    if room <= 0:
        return at, True
    inside, outside = (0.0, 0.0), (np.inf, np.inf)
    distance = min(room, max(1.96 * refit.spread, 1e-9))
    for _ in range(MOST):
        value = refit.rise(sense * distance)
        if abs(value - RISE) < NEAR:
            return at + sense * distance, False
        if value < RISE:
            if distance >= room:
                return at + sense * room, True
            inside = distance, value
        else:
            outside = distance, value
        if not np.isfinite(outside[0]):
            # χ² rises as a square, at least near the best.
            factor = np.sqrt(RISE / max(value, 1e-3))
            least = 1.0 if refit.gaussian else 1.2
            distance = min(room, distance * float(np.clip(factor, least, 6.0)))
            continue
        # Its root is all but straight.
        a, b = np.sqrt(max(inside[1], 0.0)), np.sqrt(outside[1])
        share = (np.sqrt(RISE) - a) / (b - a) if b > a else 0.5
        distance = inside[0] + float(np.clip(share, 0.05, 0.995)) * (outside[0] - inside[0])
        if outside[0] - inside[0] < 1e-12:
            break
    return at + sense * distance, False


def covariance_of(slopes: Array) -> Array:
    """Covariance (unknown, unknown) of shares by Fisher's information; infinite directions are very large."""
    normal = slopes.T @ slopes
    values, vectors = np.linalg.eigh(normal)
    floor = max(float(values.max(initial=0.0)) * 1e-14, NO_SLOPE)
    return np.asarray((vectors / np.maximum(values, floor)) @ vectors.T)

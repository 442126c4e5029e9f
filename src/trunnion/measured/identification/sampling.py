"""Draws from a likelihood of any shape, for where profiles say that it is not Gaussian.

An ensemble of walkers: each is moved along the line to another one, by a factor of density 1/√z (Goodman & Weare 2010,
Commun. Appl. Math. Comput. Sci. 5, 65), which is the same in any units and along any valley; every fifth time by the
difference of two others (ter Braak 2006, Stat. Comput. 16, 239), which leaps from one hill to another. Halves of the
ensemble move by turns, all of a half at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.measured.identification.fitting import FitPoint, values_at
from trunnion.measured.identification.misfit import Misfit
from trunnion.measured.identification.profile import ProfileInterval
from trunnion.waiting import keep_time

STRETCH = 2.0
LEAPS = 0.2
"""Share of the moves that are differences of two others."""
BLUR = 1e-3
"""Spread of a leap, as a share of the difference."""
FEWEST_WALKERS, EACH_FREE = 24, 6
PARABOLA = 0.15
"""Share by which an end of a profile may be nearer or farther than a Gaussian's."""
AT_ONCE = 16
"""Lines that are predicted at once."""
WINDOW = 5.0
"""Times of its autocorrelation that a series is summed over for it (Sokal)."""


@dataclass(frozen=True)
class LikelihoodDraws:
    """Points (draw, unknown), the share of moves that was taken, and how many independent draws they are worth."""

    points: Array
    accepted: float
    effective: float


def walkers_for(count: int) -> int:
    """An even number of walkers for so many unknowns."""
    return max(FEWEST_WALKERS, 2 * ((EACH_FREE * count + 1) // 2))


def draws(log_density: Callable[[Array], Array], start: Array, steps: int, seed: int) -> LikelihoodDraws:
    """So many steps of an ensemble that begins at ``start`` (walker, unknown); the first third of them is left out.

    log_density : of points (point, unknown), −∞ where none may be.
    """
    rng = np.random.default_rng(seed)
    at, count = start.copy(), start.shape[1]
    high = log_density(at)
    half, kept, taken = len(at) // 2, [], 0
    for step in range(steps):
        keep_time()
        for first in (True, False):
            own = np.arange(half) if first else np.arange(half, len(at))
            others = at[half:] if first else at[:half]
            pick = np.array([rng.choice(len(others), 2, replace=False) for _ in own])
            factor = (1 + (STRETCH - 1) * rng.random(len(own))) ** 2 / STRETCH
            along = others[pick[:, 0]] + factor[:, None] * (at[own] - others[pick[:, 0]])
            apart = others[pick[:, 0]] - others[pick[:, 1]]
            leap = at[own] + apart * (1 + BLUR * rng.standard_normal((len(own), 1)))
            leaps = rng.random(len(own)) < LEAPS
            there = np.where(leaps[:, None], leap, along)
            value = log_density(there)
            gain = value - high[own] + np.where(leaps, 0.0, (count - 1) * np.log(factor))
            accept = np.log(rng.random(len(own))) < gain
            at[own[accept]], high[own[accept]] = there[accept], value[accept]
            taken += int(accept.sum()) if step >= steps // 3 else 0
        if step >= steps // 3:
            kept.append(at.copy())
    series = np.array(kept)
    points = series.reshape(-1, count)
    worth = len(points) / max(_correlation_time(series[:, :, k]) for k in range(count))
    return LikelihoodDraws(points, taken / len(points), worth)


def _correlation_time(series: Array) -> float:
    """Steps between draws (step, walker) that are as good as independent: autocorrelations summed over a window."""
    off = series - series.mean()
    padded = np.fft.rfft(off, n=2 * len(off), axis=0)
    together = np.fft.irfft(np.abs(padded) ** 2, axis=0)[: len(off)].mean(axis=1)
    if not together[0] > 0:
        return 1.0
    times = 2 * np.cumsum(together / together[0]) - 1
    inside = np.arange(len(times)) >= WINDOW * times
    return float(max(times[int(np.argmax(inside)) if inside.any() else -1], 1.0))


def gaussian_of(misfit: Misfit, values: Array, intervals: list[ProfileInterval], spread: Array) -> Flags:
    """Which parameters (parameter,) have intervals as a Gaussian of deviations ``spread`` (parameter,) [SI] has."""
    half = 1.959963984540054 * spread
    off = [
        max(abs((value - one.low) / own - 1), abs((one.high - value) / own - 1))
        for value, one, own in zip(values, intervals, half, strict=True)
    ]
    shut = [not (one.low_open or one.high_open) for one in intervals]
    return np.asarray(np.array(shut) & (np.array(off) < PARABOLA))


def likelihood_draws(
    misfit: Misfit, minima: list[FitPoint], spread: Array, scale: float, steps: int, seed: int
) -> tuple[LikelihoodDraws, Array]:
    """Draws of the parameters and of the rotation at which the input began, equally likely anywhere within the bounds;
    and the values (draw, parameter) of the parameters.

    minima : the best and those that fit as well, around which walkers begin. spread : of shares (parameter,).
    """
    count, rng = len(misfit.free), np.random.default_rng(seed)

    def log_density(points: Array) -> Array:
        found = np.full(len(points), -np.inf)
        inside = np.flatnonzero(np.all((points[:, :count] >= 0) & (points[:, :count] <= 1), axis=1))
        for first in range(0, len(inside), AT_ONCE):
            rows = inside[first : first + AT_ONCE]
            predicted = misfit.predicted(np.array([values_at(misfit, points[k, :count]) for k in rows]))
            for k, one in zip(rows.tolist(), predicted, strict=True):
                angle = float(points[k, count]) if misfit.begin is None else misfit.begin
                residual = misfit.residuals(one, angle)
                found[k] = -0.5 * float(residual @ residual) / scale
        return found

    begun = []
    for walker in range(walkers_for(count + (misfit.begin is None))):
        at = minima[walker % len(minima)]
        share = at.share + np.minimum(spread, 0.5) * rng.standard_normal(count)
        out = (share < 0) | (share > 1)
        share[out] = rng.random(int(out.sum()))
        if misfit.begin is None:
            predicted = misfit.predicted(values_at(misfit, share)[None])[0]
            share = np.append(share, misfit.angle(predicted))
            share[count] = at.angle + (share[count] - at.angle + np.pi) % (2 * np.pi) - np.pi
        begun.append(share)
    found = draws(log_density, np.array(begun), steps, seed)
    return found, np.array([values_at(misfit, one[:count]) for one in found.points])

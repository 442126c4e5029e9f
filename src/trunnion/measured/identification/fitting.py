"""The values that fit best: a look around, descents from the best of it, and twins that fit as well."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from trunnion.arrays import Array, Flags
from trunnion.measured.identification.misfit import Misfit
from trunnion.waiting import keep_time

FEW = 24
"""Windows that the search goes by."""
FAR_OFF = 4.0
"""Times the best χ² of the search beyond which an end of it is not followed."""
LOOKS, STARTS = 64, 5
"""Points looked at within the bounds, and descents from the best of them."""
ROUNDS = 60
SMALL, SETTLED = 1e-9, 1e-7
"""Step, as a share of the ranges, and change of χ², over what a number adds to it, at which a descent ends."""
ROUGHLY = 1e-3
"""The same change in the look around: where noise does not explain the misfit, descents creep."""
TWIN = 1.0
"""Difference of χ² up to which another minimum cannot be told from the best."""
APART = 0.02
"""Share of its range by which one parameter of a twin differs at least."""


@dataclass(frozen=True)
class FitPoint:
    """A minimum: shares (free,) of the ranges, rotation of the input at the first pulse, χ²."""

    share: Array
    angle: float
    chi_square: float
    settled: bool


def values_at(misfit: Misfit, share: Array) -> Array:
    """Values (free,) in SI units at shares of the ranges."""
    low = np.array([one.low for one in misfit.free])
    high = np.array([one.high for one in misfit.free])
    return np.asarray(low + share * (high - low))


def shares_of(misfit: Misfit, values: Array) -> Array:
    """The inverse, within the bounds."""
    low = np.array([one.low for one in misfit.free])
    high = np.array([one.high for one in misfit.free])
    return np.asarray(np.clip((values - low) / (high - low), 0.0, 1.0))


def descend(misfit: Misfit, share: Array, angle: float, held: Flags, settled_by: float = SETTLED) -> FitPoint:
    """Levenberg and Marquardt's descent within the bounds; parameters ``held`` (free,) stay."""
    count, damping = len(misfit.free), 1e-3
    residual, slope = misfit.linear(values_at(misfit, share), angle, both=False)
    best, settled = float(residual @ residual), False
    for _ in range(ROUNDS):
        keep_time()
        gradient = slope.T @ residual
        # A parameter at a bound that the descent would leave by it stays there.
        stuck = ((share <= 0) & (gradient[:count] > 0)) | ((share >= 1) & (gradient[:count] < 0)) | held
        moving = np.concatenate([~stuck, np.ones(slope.shape[1] - count, dtype=bool)])
        if not moving.any():
            return FitPoint(share, angle, best, True)
        part = slope[:, moving]
        normal = part.T @ part
        scale = np.maximum(np.diag(normal), 1e-12 * max(float(np.diag(normal).max()), 1e-300))
        improved = False
        while damping < 1e12:
            step = np.zeros(slope.shape[1])
            step[moving] = -np.linalg.solve(normal + damping * np.diag(scale), part.T @ residual)
            there = np.clip(share + step[:count], 0.0, 1.0)
            turned = angle + (step[count] if len(step) > count else 0.0)
            found, steeper = misfit.linear(values_at(misfit, there), turned, both=False)
            value = float(found @ found)
            if np.isfinite(value) and value < best:
                improved = True
                break
            damping *= 8
            if float(np.abs(there - share).max(initial=0.0)) < SMALL and abs(turned - angle) < SMALL:
                break
        if not improved:
            return FitPoint(share, angle, best, True)
        gained, damping = best - value, max(damping / 10, 1e-9)
        share, angle, residual, slope, best = there, turned, found, steeper, value
        if gained < settled_by * max(1.0, best / len(residual)):
            settled = True
            break
    return FitPoint(share, angle, best, settled)


def search(whole: Misfit, start: Array, seed: int) -> list[FitPoint]:
    """Minima, the best first: from ``start`` (free,) shares and from the best of a look around.

    Looks and descents go by some windows; different ends of these go on by all.
    """
    misfit = whole.thinned(FEW)
    count = len(misfit.free)
    looks = qmc.Sobol(count, seed=seed).random(LOOKS)
    looks = np.concatenate([start[None], looks])
    values = np.array([values_at(misfit, one) for one in looks])
    low_cost = np.full(len(looks), np.inf)
    angles = np.zeros(len(looks))
    for first in range(0, len(looks), 16):
        keep_time()
        for k, predicted in enumerate(misfit.predicted(values[first : first + 16]), start=first):
            angles[k] = misfit.angle(predicted)
            residual = misfit.residuals(predicted, angles[k])
            low_cost[k] = float(residual @ residual)
    picked = [0, *(k for k in np.argsort(low_cost).tolist() if k)][: STARTS + 1]
    free = np.zeros(count, dtype=bool)
    ends = [descend(misfit, looks[k], float(angles[k]), free, ROUGHLY) for k in picked]
    ends.sort(key=lambda one: one.chi_square)
    found: list[FitPoint] = []
    for one in ends:
        far = all(np.abs(one.share - other.share).max() > APART for other in found)
        if far and (not found or one.chi_square < FAR_OFF * ends[0].chi_square):
            found.append(one)
    found = [descend(whole, one.share, one.angle, free) for one in found]
    return sorted(found, key=lambda one: one.chi_square)


def twins_of(misfit: Misfit, minima: list[FitPoint], known: Flags) -> list[FitPoint]:
    """Others that fit as well as the best: found by the search, or by the best's mirror images and exchanges.

    known : parameters (free,) whose likelihood is not flat; twins differ in one of them.
    """
    best = minima[0]
    free = np.zeros(len(misfit.free), dtype=bool)
    found: list[FitPoint] = []
    candidates = list(minima[1:])
    for share in images(misfit, best.share):
        values = values_at(misfit, share)
        own = (misfit.passing([values]) or misfit) if misfit.passed else misfit
        predicted = own.predicted(values[None])[0]
        if own.chi_square(predicted) < best.chi_square + 1e3:
            candidates.append(descend(own, share, own.angle(predicted), free))
    for one in candidates:
        near = [np.abs(one.share - other.share)[known].max(initial=0.0) for other in (best, *found)]
        if one.chi_square < best.chi_square + TWIN and min(near) > APART:
            found.append(one)
    return found


def images(misfit: Misfit, share: Array) -> list[Array]:
    """Shares with an angle's sign changed, a phase half a turn on, or two parameters of one unit exchanged."""
    values, made = values_at(misfit, share), []
    for k, one in enumerate(misfit.free):
        options = [-values[k]] if one.unit == "rad" else []
        options += [values[k] - np.pi, values[k] + np.pi] if one.unit == "rad" else []
        for value in options:
            if one.low <= value <= one.high and value != values[k]:
                point = values.copy()
                point[k] = value
                made.append(shares_of(misfit, point))
        for j in range(k):
            other = misfit.free[j]
            fits = one.low <= values[j] <= one.high and other.low <= values[k] <= other.high
            if other.unit == one.unit and fits and values[j] != values[k]:
                point = values.copy()
                point[j], point[k] = values[k], values[j]
                made.append(shares_of(misfit, point))
    return made

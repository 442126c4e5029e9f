"""Where two multipliers meet along a row, found from their phases: the second pass over rows that are sampled.

A region begins where two multipliers meet on their way along the circle, or one meets its conjugate on the real axis,
and every resonance is such a meeting: the phases of two modes add up to N turns. Phases move evenly however narrow the
region is, so that a gap between two of them that closes between two samples is seen from its neighbours, where a radius
above 1 is not. Each such place is closed in on: it lies in the middle of the region, if there is one.

A region that hides between two samples is no wider than the phases move there, and raises ln ρ by less than that: so
multipliers that decay by more are left alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from trunnion.arrays import Array, Complex, Places

Multipliers = Callable[[Array, Places], Complex]
"""Multipliers (points, m) at θ (points,) of rows (points,)."""

SLACK = 1.1
"""A gap closes where it is no more than so many times what it changes by from one sample to the next."""
STILL = 1e-9
"""Changes of phase [rad] from one sample to the next that are rounding, as of conjugates."""
DECAYS = 2.0
"""Decay ln|σ| over the change of the gap above which no narrow region makes up for it."""
FINER = 16
"""Parts into which the two steps about a sample are cut where a gap closes."""
ROUNDS = 10


def multiplier_collisions(multipliers: Multipliers, theta: Array, values: Complex) -> tuple[Places, Array]:
    """Rows and θ of all places where two of ``values`` (row, sample, m) at ``theta`` (sample,) meet."""
    row, place, _, _ = _closing(values, DECAYS)
    row, place = np.unique(np.stack([row, place]), axis=1)
    if not len(row):
        return row, np.zeros(0)
    # Several meetings may lie between two samples: each gap that closes is sampled anew.
    low, high = theta[np.maximum(place - 1, 0)], theta[np.minimum(place + 1, len(theta) - 1)]
    fine = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, FINER + 1)
    again = multipliers(fine.ravel(), np.repeat(row, FINER + 1)).reshape(*fine.shape, -1)
    own, place, which, rise = _closing(again, DECAYS * FINER / 2)
    row, t = row[own], fine[own, place]
    step = (high - low)[own] / FINER
    low, high = t - step, t + step
    gap, slope = _gaps(again)[0][own, place, which], rise / step
    for _ in range(ROUNDS if len(row) else 0):
        # The gap is |L(θ)| of a smooth L: its zero lies to one side or the other.
        tried = np.clip(np.stack([t - gap / slope, t + gap / slope]), low, high)
        every = _gaps(multipliers(tried.ravel(), np.tile(row, 2)))[0]
        found = every[np.arange(2 * len(row)), np.tile(which, 2)].reshape(2, -1)
        side, each = found.argmin(axis=0), np.arange(len(row))
        better = found[side, each] < gap
        t, gap = np.where(better, tried[side, each], t), np.where(better, found[side, each], gap)
        slope = np.where(better, slope, 2 * slope)
    return row, t


def _closing(values: Complex, decays: float) -> tuple[Places, Places, Places, Array]:
    """Rows, samples and numbers of gaps that close beside a sample, and what they change by from it to the next."""
    gap, decay = _gaps(values)
    before = np.concatenate([np.full_like(gap[:, :1], np.inf), gap[:, :-1]], axis=1)
    behind = np.concatenate([gap[:, 1:], np.full_like(gap[:, :1], np.inf)], axis=1)
    rise = np.where(np.isinf(before), behind, np.where(np.isinf(behind), before, np.maximum(before, behind))) - gap
    closes = (gap <= before) & (gap <= behind) & (rise > STILL) & (gap <= SLACK * rise) & (decay <= decays * rise)
    row, place, which = np.nonzero(closes)
    return row, place, which, rise[row, place, which]


def _gaps(values: Complex) -> tuple[Array, Array]:
    """Gaps [rad] between neighbouring phases (…, m + 1), the real axis on both sides counted, and the mean decay −ln|σ|
    of the two multipliers about each."""
    phase = np.abs(np.angle(values))
    order = np.argsort(phase, axis=-1)
    phase = np.take_along_axis(phase, order, axis=-1)
    with np.errstate(divide="ignore"):
        decay = -np.log(np.abs(np.take_along_axis(values, order, axis=-1)))
    gap = np.concatenate([phase[..., :1], np.diff(phase, axis=-1), np.pi - phase[..., -1:]], axis=-1)
    mean = np.concatenate([decay[..., :1], (decay[..., 1:] + decay[..., :-1]) / 2, decay[..., -1:]], axis=-1)
    return gap, mean

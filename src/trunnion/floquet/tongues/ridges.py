"""The highest point of the spectral radius across a tongue, and the tip at which it is 1."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.floquet.tongues.region import Region
from trunnion.numerics.bracketing import bracketed

LOOKS = 9
"""Points across the window in each round."""
ROUNDS = 15
"""Rounds of looking at most, each a quarter as wide as the one before."""
SMOOTH, ROUNDING = 1e-7, 1e-13
"""Looking closer ends where a quartic fits to this share of what heights differ by, and to their rounding."""
TIP = 1e-13
"""How closely the height of a tip is solved, as a share of the box."""
ASIDE = 1e-3
"""How far inside its window a tip must lie, as a share of it."""
_T = np.linspace(-1.0, 1.0, LOOKS)
_FIT = np.linalg.pinv(np.vander(_T, 5, increasing=True))


def ridge(region: Region, low: Array, high: Array, v: Array) -> tuple[Array, Array, Array]:
    """Where ρ is highest between ``low`` and ``high`` on rows ``v``, ρ − 1 there less its error, and that error; each
    (points,).

    The last round fits a quartic, so that the place is known far better than its points are apart.
    """
    centre, half = (low + high) / 2, (high - low) / 2
    best, top, off = centre.copy(), np.full(len(low), -np.inf), np.zeros(len(low))
    here = np.arange(len(low))
    for _ in range(ROUNDS):
        u = np.clip(centre[here, None] + half[here, None] * _T, low[here, None], high[here, None])
        found = region.judged(u.ravel(), np.repeat(v[here], LOOKS))
        height, error = (found.radius - 1).reshape(u.shape), found.error.reshape(u.shape)
        known = np.where(np.isfinite(height - error), height - error, -np.inf)
        at = known.argmax(axis=1)[:, None]
        seen, over, off[here] = (np.take_along_axis(part, at, 1)[:, 0] for part in (u, known, error))
        best[here], top[here] = _fitted(u, height, off[here], seen, over, centre[here], half[here])
        centre[here], half[here] = seen, half[here] / 4
        here = here[_misfit(height) >= SMOOTH * np.ptp(height, axis=1) + ROUNDING]
        if not len(here):
            break
    return best, top, off


def _misfit(height: Array) -> Array:
    """How far a quartic passes by points (ridges, LOOKS) at most; infinite where one is not known."""
    off = height - np.where(np.isfinite(height), height, 0.0) @ (np.vander(_T, 5, increasing=True) @ _FIT).T
    return np.asarray(np.where(np.isfinite(off), np.abs(off), np.inf).max(axis=1))


def _fitted(
    u: Array, height: Array, error: Array, best: Array, top: Array, centre: Array, half: Array
) -> tuple[Array, Array]:
    """Highest point of the quartic through the last points, where it is one and lies among them."""
    even = np.ptp(u, axis=1) > 1.99 * half
    c = _FIT @ np.where(np.isfinite(height), height, 0.0).T
    with np.errstate(all="ignore"):
        t = np.clip(-c[1] / (2 * c[2]), -1, 1)
        for _ in range(6):
            slope = c[1] + t * (2 * c[2] + t * (3 * c[3] + t * 4 * c[4]))
            bend = 2 * c[2] + t * (6 * c[3] + t * 12 * c[4])
            t = np.clip(t - slope / bend, -1, 1)
        peak = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4])))
        off = np.abs(np.vander(_T, 5, increasing=True) @ c - height.T).max(axis=0)
    good = even & (np.abs(t) < 0.999) & (bend < 0) & (off < 0.05 * np.ptp(height, axis=1) + 1e-13) & np.isfinite(peak)
    return np.where(good, centre + half * t, best), np.where(good, np.maximum(peak - error, top), top)


def tips(
    region: Region, outside: Array, inside: Array, centre: Array, slope: Array, width: Array, walls: Array
) -> tuple[Array, Array, Flags]:
    """Where tongues close between a row without them, ``outside``, and one with them, ``inside`` (tongues,), in v.

    centre, slope, width: of each tongue at its row ``inside`` and how its middle moves with v; walls (tongues, 2):
    bounds in u that keep neighbours out. Returns u and v of the tips and whether each was found. A tongue is told from
    none by more than the error of ρ; its tip is where ρ itself is 1, lest that error, a bound, cut it short.
    """

    def window(v: Array, which: Places) -> tuple[Array, Array]:
        shift = slope[which] * (v - inside[which])
        reach = 0.75 * width[which] + np.abs(shift) + 1e-9 * (region.box.u1 - region.box.u0)
        middle = centre[which] + shift
        low, high = np.maximum(middle - reach, walls[which, 0]), np.minimum(middle + reach, walls[which, 1])
        return np.minimum(low, high), np.maximum(low, high)

    everyone = np.arange(len(inside))
    (_, below, error), (_, above, _) = (ridge(region, *window(v, everyone), v) for v in (outside, inside))
    found = (below < 0) & (above > 0)
    # Without damping ρ is 1 outside as well, and only its error tells where it grows.
    falls = below + error < 0

    def height(v: Array, which: Places) -> Array:
        _, known, off = ridge(region, *window(v, which), v)
        return known + np.where(falls[which], off, 0.0)

    v = inside.copy()
    pick = np.flatnonzero(found)
    if len(pick):
        exact = TIP * (region.box.v1 - region.box.v0)
        v[pick] = bracketed(lambda at, own: height(at, pick[own]), outside[pick], inside[pick], exact)
    low, high = window(v, everyone)
    u, top, _ = ridge(region, low, high, v)
    # Highest at an end of the window is the flank of a neighbour that came in.
    inner = np.minimum(u - low, high - u) > ASIDE * (high - low)
    return u, v, found & np.isfinite(top) & inner

"""Zeros of many functions at once, each in a bracket of its own."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from trunnion.arrays import Array, Places

ROUNDS = 60
FIRST = 0.05
"""Share of a bracket beside its ends where the first step does not lead."""


def bracketed(
    function: Callable[[Array, Places], Array],
    low: Array,
    high: Array,
    tolerance: Array | float,
    known: tuple[Array, Array] | None = None,
) -> Array:
    """Zeros (brackets,) by Chandrupatla's method: inverse quadratic steps where they are safe, halves elsewhere.

    ``function(points, which)`` gives the values of the functions number ``which`` at one point each; it must change its
    sign between ``low`` and ``high``, or the end where it is nearest to zero is returned. ``tolerance`` is absolute.
    ``known``: values at ``low`` and at ``high``, where they need not be computed.
    (T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145.)
    """
    everyone = np.arange(len(low))
    b, a = np.asarray(low, dtype=float).copy(), np.asarray(high, dtype=float).copy()
    fb, fa = (function(b, everyone), function(a, everyone)) if known is None else (one.copy() for one in known)
    c, fc = a.copy(), fa.copy()
    bound = np.broadcast_to(np.asarray(tolerance, dtype=float), a.shape)
    share = np.full(len(a), 0.5)
    if known is not None:  # as of ends that stand close already
        share = np.clip(fa / np.where(fa == fb, 1.0, fa - fb), FIRST, 1 - FIRST)
    open_ = np.sign(fa) * np.sign(fb) < 0  # products of small values vanish
    for _ in range(ROUNDS):
        which = np.flatnonzero(open_)
        if not len(which):
            break
        x = a[which] + share[which] * (b[which] - a[which])
        fx = function(x, which)
        same = np.sign(fx) == np.sign(fa[which])
        c[which], fc[which] = np.where(same, a[which], b[which]), np.where(same, fa[which], fb[which])
        b[which], fb[which] = np.where(same, b[which], a[which]), np.where(same, fb[which], fa[which])
        a[which], fa[which] = x, fx
        width = np.abs(b[which] - a[which])
        least_share = np.minimum(bound[which] / np.maximum(width, 1e-300), 0.5)
        open_[which] = (least_share < 0.5) & (fx != 0) & np.isfinite(fx)
        share[which] = np.clip(_step(a, b, c, fa, fb, fc, which), least_share, 1 - least_share)
    # Not the least value seen on the way: what is flat on one side, as ρ − 1 without damping, has that anywhere.
    return np.where(~(np.abs(fb) < np.abs(fa)) & np.isfinite(fa), a, b)


def _step(a: Array, b: Array, c: Array, fa: Array, fb: Array, fc: Array, which: Places) -> Array:
    """The share of the way from a to b at which to look next."""
    a, b, c, fa, fb, fc = (part[which] for part in (a, b, c, fa, fb, fc))
    with np.errstate(all="ignore"):
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        quadratic = (phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi)
        t = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
    return np.where(quadratic & np.isfinite(t), t, 0.5)

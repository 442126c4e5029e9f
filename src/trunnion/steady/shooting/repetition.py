"""After how many points a sampled motion repeats, and whether it still settles: the one answer that all analyses give.

Points x_j lie one period of the forcing, one passage of a section or any other fixed time apart. Their later half is
asked. The motion repeats after k points where

    |x_{j+m} − x_j| ≤ δ   for all m that are multiples of k,   δ = 1e-5 of the motion and 1e-8 of the states' scale,

so a slow drift does not count as a return, though each step of it is small. A motion that settles slowly on one with a
shorter period returns nearly as well: what is still left of its way, from how its way shrinks from one half of these
points to the other, must be small beside the distance of points that count as different.

Where nothing repeats, the mean squares of the best returns are taken by blocks. If they fall from block to block the
motion is still settling, or beats more slowly than these points can show.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array

LONGEST_REPEAT = 64
"""Returns after which a motion that has not closed is not called periodic."""
CLOSED = 1e-5
"""Distance between a point and its return, over the size of the motion, that counts as none."""
ROUNDED = 1e-8
"""The same over the scale of the system, for motions that have come to rest."""
LEAST = 4
"""Points of the later half below which nothing is said."""
NOISE, FINE = 1e-2, 1e-3
"""Way over the distance that counts as none, below which it is rounding and not a drift; share of it where a shorter
period is the question."""
STRAIGHT = 0.5
"""Way between the ends over the length of the path, above which points drift and do not scatter."""
LEFT = 0.1
"""What is left of the way over the distance of points that count as different, at most."""
FEWEST_BLOCKS, BLOCKS = 6, 8
"""Blocks of returns, from each of which to the next their mean squares must fall."""
FALLEN = 1e-6
"""By how much at least in all, as a share: less is rounding."""


class Repetition(NamedTuple):
    """after: points after which a motion repeats, 0 where it does not within ``longest``; settling: whether it does not
    repeat yet but comes closer to it; longest: the largest number of points that was tried."""

    after: int
    settling: bool
    longest: int

    def __str__(self) -> str:
        if self.after:
            return f"repeats after {self.after} point{'s' if self.after > 1 else ''}"
        if self.settling:
            return "still settling: its returns come closer from one to the next; raise transient"
        if not self.longest:
            return "too few points to tell whether it repeats"
        return f"does not repeat within {self.longest} point{'s' if self.longest > 1 else ''}"


def repetition(points: Array, size: Array, scale: Array, turns: Array) -> Repetition:
    """After how many of ``points`` (m, n) their later half comes back to itself.

    Parameters
    ----------
    size : how far each state (n,) of the motion moves between the points.
    scale : size of each state (n,) that counts as one.
    turns : vectors (k, n) by which points may differ and count as one, as a turn of an angle; see ``modulo``.
    """
    later = points[len(points) // 2 :]
    longest = min(LONGEST_REPEAT, (len(later) - 1) // 3) if len(later) >= LEAST else 0
    if not longest or not np.all(np.isfinite(later)):
        return Repetition(0, False, 0)
    size = size.copy()
    for turn in turns:
        moved = turn != 0
        size[moved] = np.minimum(size[moved], np.abs(turn[moved]))
    far = CLOSED * size + ROUNDED * (scale + np.abs(modulo(later, turns, scale)).max(axis=0))

    def apart(a: Array, b: Array) -> Array:
        return np.asarray(np.abs(modulo(a - b, turns, scale) / far).max(axis=-1))

    returns = [apart(later[k:], later[:-k]) for k in range(1, longest + 1)]
    for k in range(1, longest + 1):
        last = later[-k:][np.arange(-len(later), 0) % k]
        if apart(later, last).max() <= 1:
            different = min((float(r.max()) for r in returns[: k - 1]), default=1 / CLOSED)
            # Steps from point to point do not feel a drift of all, as of an angle that nothing holds.
            moving, noise = (later, NOISE) if k == 1 else (later[1:] - later[:-1], FINE * NOISE)
            settled = _left(moving, k, apart, noise) <= LEFT * different
            return Repetition(k if settled else 0, not settled, longest)
    return Repetition(0, _settles(returns), longest)


def modulo(points: Array, turns: Array, scale: Array) -> Array:
    """Points (…, n) moved by whole ``turns`` (k, n) as near to zero as they come; angles lie between −π and π then."""
    out = np.array(points, dtype=float)
    for turn in turns:
        weight = turn / scale**2
        out -= np.round(out @ weight / (turn @ weight))[..., None] * turn
    return out


def _left(later: Array, k: int, apart: Callable[[Array, Array], Array], noise: float) -> float:
    """Way that points which repeat after ``k`` still have to go, over the distance that counts as none.

    Points that go straight on by more than ``noise`` drift: their way falls from half to half by one factor.
    """
    half = (len(later) // k - 1) // 2
    cycles = later[-(2 * half + 1) * k :].reshape(2 * half + 1, k, -1)
    path = apart(cycles[1:], cycles[:-1]).sum(axis=0)
    way, first, second = (apart(cycles[i], cycles[j]) for i, j in ((0, -1), (0, half), (half, -1)))
    drifts = (way > noise) & (way > STRAIGHT * path)
    shrinks = second < first
    ratio = np.where(drifts & shrinks, second / np.where(shrinks, first, 1.0), 0.0)
    ahead = np.where(drifts, np.where(shrinks, second * ratio / (1 - ratio), np.inf), way)
    return float(ahead.max())


def _settles(returns: list[Array]) -> bool:
    """Whether the nearest of the returns come closer from block to block."""
    tried = [k for k, r in enumerate(returns, start=1) if len(r) >= FEWEST_BLOCKS * k]
    if not tried:
        return False
    k = min(tried, key=lambda k: float(np.median(returns[k - 1])))
    near = returns[k - 1]
    blocks = min(BLOCKS, len(near) // k)
    length = len(near) // blocks // k * k  # whole cycles, or what differs within one would be seen
    square = (near[len(near) - blocks * length :].reshape(blocks, length) ** 2).mean(axis=1)
    return bool(np.all(np.diff(square) < 0) and square[-1] < (1 - FALLEN) * square[0])

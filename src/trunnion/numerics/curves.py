"""Extremes and Fourier coefficients of curves that are smooth between given cuts, as dense output is between steps.

Neither rests on a fixed number of samples of the whole: a curve is looked at between each two cuts, and an extremum is
then closed in on until what is left of it is known.

    extremes   eight parts of every cell, then every cell that may hold the extremum, by shrinking brackets;
    fourier    c_k = ∫ x e^{−2πikt/T} dt / T by Gauss's rule in every cell, of which the highest order asked for
               turns by two radians at most, so that orders above cannot fold back.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy import fft

from trunnion.arrays import Array, Complex, Integers, Places

Curves = Callable[[Array], Array]
"""Times (m,) → values (m, curves)."""

PARTS = 8
"""Of a cell. An integrator's step holds much less than a swing."""
ZOOMS, ZOOM_PARTS = 3, 16
"""Each zoom shrinks a bracket of two parts to two of sixteen."""
EDGE = 1e-10
"""How far inside its cell, as a share of it, a curve is looked at: at a cut it may jump or bend."""
BLOCK = 16_384
"""Cells looked at in one go."""
NODES = 10
"""Of Gauss's rule in a cell: exact for polynomials of degree 19."""
RADIANS = 2.0
"""Of the highest order asked for in one cell."""
WIDTH = 15
"""Points of a grid, twice as fine as the highest order needs, that a value is spread over."""
BETA = 2.30 * WIDTH
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(NODES)
_SMOOTH, _SMOOTH_WEIGHTS = np.polynomial.legendre.leggauss(64)
"""Of what a value is spread by."""


@dataclass(frozen=True)
class Extremes:
    """low and high (windows, curves), where they are (low_at, high_at), and error (windows, curves): what the last
    bracket leaves open. The error of the curve itself, of an integration say, comes on top."""

    low: Array
    high: Array
    low_at: Array
    high_at: Array
    error: Array

    @property
    def span(self) -> Array:
        """Highest minus lowest value."""
        return self.high - self.low

    @property
    def largest(self) -> Array:
        """Largest absolute value."""
        return np.maximum(np.abs(self.low), np.abs(self.high))

    def of(self, window: int) -> Extremes:
        """Those of one window, every array (curves,)."""
        i = window
        return Extremes(self.low[i], self.high[i], self.low_at[i], self.high_at[i], self.error[i])


def extremes(curves: Curves, cuts: Array) -> Extremes:
    """Smallest and largest values between the first and the last cut; every array of the result is (curves,).

    Parameters
    ----------
    cuts : rising; between neighbours the curves are smooth and eight parts of a cell show each of their swings.
    """
    return extremes_in(curves, cuts, cuts[[0, -1]]).of(0)


def extremes_in(curves: Curves, cuts: Array, edges: Array) -> Extremes:
    """The same in every window between neighbours of ``edges`` (windows + 1,), which lie within the cuts."""
    cuts = np.union1d(cuts[(cuts >= edges[0]) & (cuts <= edges[-1])], edges)
    window = np.searchsorted(edges, cuts[:-1], side="right") - 1
    parts = [_top(curves, cuts[i : i + BLOCK + 1]) for i in range(0, len(cuts) - 1, BLOCK)]
    tops = parts[0] if len(parts) == 1 else _Tops(*map(np.concatenate, zip(*parts, strict=True)))
    at, most, error = _best(curves, cuts, window, tops)
    count = at.shape[1] // 2
    below, above = slice(count), slice(count, None)
    return Extremes(
        -most[:, below], most[:, above], at[:, below], at[:, above], np.maximum(error[:, below], error[:, above])
    )


class _Tops(NamedTuple):
    """Of −x and of x in every cell (cells, 2 · curves): the largest of the samples, what it may grow to between them,
    its place."""

    value: Array
    most: Array
    place: Integers


def _inside(begin: Array, length: Array, place: Array) -> Array:
    """Times at shares ``place`` of cells, none on a cut as far as rounding lets tell."""
    edge = np.maximum(EDGE * length, 2 * np.spacing(np.abs(begin) + length))
    return np.minimum(np.maximum(begin + place * length, begin + edge), begin + np.maximum(length - edge, edge))


def _top(curves: Curves, cuts: Array) -> _Tops:
    """Of −x and of x."""
    begin, length = cuts[:-1, None], np.diff(cuts)[:, None]
    times = _inside(begin, length, np.arange(PARTS + 1) / PARTS)
    values = curves(times.ravel()).reshape(*times.shape, -1)
    # Of a curve that bends, a parabola through three samples rises by an eighth of the bend at most.
    bend = np.abs(values[:, 2:] - 2 * values[:, 1:-1] + values[:, :-2]).max(axis=1)
    lowest, highest = np.argmin(values, axis=1), np.argmax(values, axis=1)
    low = -np.take_along_axis(values, lowest[:, None], 1)[:, 0]
    high = np.take_along_axis(values, highest[:, None], 1)[:, 0]
    value = np.concatenate([low, high], axis=1)
    return _Tops(value, value + np.concatenate([bend, bend], axis=1) / 4, np.concatenate([lowest, highest], axis=1))


def _best(curves: Curves, cuts: Array, window: Integers, tops: _Tops) -> tuple[Array, Array, Array]:
    """Where −x and x are largest in every window, how large, and how well that is known, each (windows, 2 · curves)."""
    starts = np.flatnonzero(np.diff(window, prepend=-1))
    best = np.maximum.reduceat(tops.value, starts, axis=0)
    floor = best[window]
    cell, curve = np.nonzero((tops.value == floor) | (tops.most > floor + 1e-13 * np.abs(floor)))
    begin, length = cuts[:-1][cell], np.diff(cuts)[cell]
    at, value, error = np.empty(len(cell)), np.empty(len(cell)), np.empty(len(cell))
    for i in range(0, len(cell), BLOCK):
        part = slice(i, i + BLOCK)
        middle = tops.place[cell[part], curve[part]] / PARTS
        at[part], value[part], error[part] = _closed_in(
            curves, begin[part], length[part], middle, curve[part], tops.value.shape[1] // 2
        )
    order = np.lexsort((-value, window[cell], curve))
    first = np.flatnonzero(np.diff(curve[order] * (window[-1] + 1) + window[cell[order]], prepend=-1))
    chosen = order[first].reshape(tops.value.shape[1], -1).T
    return at[chosen], value[chosen], error[chosen]


def _closed_in(
    curves: Curves, begin: Array, length: Array, middle: Array, column: Integers, count: int
) -> tuple[Array, Array, Array]:
    """The largest −x (``column`` below ``count``) or x of one curve in a bracket of each cell, one part to either side
    of ``middle``."""
    rows, half = np.arange(len(begin)), 1 / PARTS
    curve, sign = (column % count)[:, None], np.where(column < count, -1.0, 1.0)[:, None]
    for _ in range(ZOOMS):
        low, high = np.maximum(middle - half, 0.0), np.minimum(middle + half, 1.0)
        places = low[:, None] + (high - low)[:, None] * np.arange(ZOOM_PARTS + 1) / ZOOM_PARTS
        times = _inside(begin[:, None], length[:, None], places)
        seen = curves(times.ravel()).reshape(*times.shape, -1)
        values = sign * seen[rows[:, None], np.arange(ZOOM_PARTS + 1), curve]
        best = np.argmax(values, axis=1)
        middle, half = places[rows, best], 2 * half / ZOOM_PARTS
    inner = np.minimum(np.maximum(best, 1), ZOOM_PARTS - 1)
    left, here, right = (values[rows, inner + k] for k in (-1, 0, 1))
    bend = left - 2 * here + right
    steep = (best == inner) & (bend < 0)
    gain = np.where(steep, (right - left) ** 2 / (8 * np.abs(np.where(steep, bend, -1.0))), 0.0)
    return times[rows, best], values[rows, best] + gain, np.abs(bend) / 8


def fourier(curves: Curves, cuts: Array, highest: int) -> Complex:
    """Fourier coefficients (highest + 1, curves) over the period from the first to the last cut.

    x = Re Σ c_k e^{2πik(t − t₀)/T}: |c_k| is the amplitude, c_0 the mean. Integrated, not sampled: what repeats faster
    than the highest order does not fold back on it, and a curve may jump or bend at its cuts. Good to about 1e-13 of
    the largest amplitude, the error of the curve itself aside.

    Parameters
    ----------
    cuts : rising, over one period; between neighbours the curves are smooth.
    """
    begin, period = cuts[0], cuts[-1] - cuts[0]
    most = RADIANS * period / (2 * np.pi * max(highest, 1))
    count = np.maximum(np.ceil(np.diff(cuts) / most).astype(np.int64), 1)
    length = np.repeat(np.diff(cuts) / count, count)
    within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    left = np.repeat(cuts[:-1], count) + within * length
    if highest < WIDTH:
        return _directly(curves, begin, period, left, length, highest)
    size = 2 * fft.next_fast_len(max(2 * (highest + 1), WIDTH))
    every = _weighed(curves, period, left, length)
    grid = sum(_spread((times - begin) / period, weighed, size) for times, weighed in every)
    out = fft.rfft(grid, axis=0)[: highest + 1] / _spreading(np.arange(highest + 1) / size)[:, None]
    out[1:] *= 2
    return np.asarray(out)


def _weighed(curves: Curves, period: float, left: Array, length: Array) -> Iterator[tuple[Array, Array]]:
    """Gauss's nodes in cells, block by block, and the values there (times, curves) by their weights over the period."""
    for i in range(0, len(left), BLOCK):
        half = length[i : i + BLOCK, None] / 2
        times = (left[i : i + BLOCK, None] + half * (1 + _GAUSS)).ravel()
        yield times, curves(times) * ((half * _WEIGHTS).ravel()[:, None] / period)


def _directly(curves: Curves, begin: float, period: float, left: Array, length: Array, highest: int) -> Complex:
    """``fourier`` by a sum for each order, less work than spreading where they are few."""
    turns = -2j * np.pi * np.arange(highest + 1)[:, None]
    out = sum(
        np.exp(turns * ((times - begin) / period)) @ weighed
        for times, weighed in _weighed(curves, period, left, length)
    )
    out[1:] *= 2
    return np.asarray(out)


def _spread(place: Array, values: Array, size: int) -> Array:
    """A grid (size, curves) of the period whose points hold the values (m, curves) at places (m,), 0 to 1, around each,
    so that its Fourier transform is a sum over the places (Barnett, Magland, af Klinteberg, SIAM J. Sci. Comput. 41,
    2019)."""
    grid = np.zeros((size, values.shape[1]))
    first = np.ceil(place * size - WIDTH / 2).astype(np.int64)
    for k in range(WIDTH):
        share = _kernel((first + k - place * size) / (WIDTH / 2))
        for j in range(grid.shape[1]):
            grid[:, j] += np.bincount((first + k) % size, share * values[:, j], size)
    return grid


def _kernel(z: Array) -> Array:
    return np.asarray(np.exp(BETA * (np.sqrt(np.maximum(1 - z * z, 0.0)) - 1)))


def _spreading(frequency: Array) -> Array:
    """Fourier transform of the spreading at frequencies in cycles per point of the grid."""
    turns = np.cos(np.pi * WIDTH * np.outer(frequency, _SMOOTH))
    return np.asarray(turns @ (_SMOOTH_WEIGHTS * _kernel(_SMOOTH)) * (WIDTH / 2))


def places_at(values: Array, level: float) -> Array:
    """Where a polyline through ``values`` (points,) meets a level, in order, as places among its points: 2.25 is a
    quarter of the way from the third to the fourth. NaN parts stretches."""
    side = values - level
    before, after = side[:-1], side[1:]
    first = np.flatnonzero((before * after < 0) | (before == 0))
    apart = before[first] - after[first]
    found = first + before[first] / np.where(before[first] == 0, 1.0, apart)
    return np.append(found, len(side) - 1.0) if len(side) and side[-1] == 0 else found


def at_place(values: Array, place: float) -> Any:
    """What lies at a place among ``values`` (points, …), linear between two of them."""
    before, after = values[int(np.floor(place))], values[int(np.ceil(place))]
    return before + (place - np.floor(place)) * (after - before)


def parabola(x: Array, v: Array, i: Places) -> tuple[Array, Array, Array]:
    """Of parabolas through places i − 1, i, i + 1: where their tops are and how high, NaN without one between the outer
    two; and how far the lower of these lies below the highest of the three."""
    back, on = x[i] - x[i - 1], x[i + 1] - x[i]
    left, right = (v[i] - v[i - 1]) / back, (v[i + 1] - v[i]) / on
    bend = (right - left) / (back + on)
    slope = (left * on + right * back) / (back + on)
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = -slope / (2 * bend)
        inside = (bend < 0) & (shift >= -back) & (shift <= on)
        shift = np.where(inside, shift, np.nan)
        height = v[i] + shift * (slope + bend * shift)
    three = np.stack([v[i - 1], v[i], v[i + 1]])
    return x[i] + shift, height, three.max(axis=0) - np.minimum(three[0], three[2])

"""All zeros of functions of cosine series along rows, or where they cannot be told from none.

Quantities are e(θ) = Σ_j c_j cos jθ, 0 ≤ θ ≤ π, and f(e) a polynomial of them, so f is a cosine series too, of a known
degree, and |f″(θ)| ≤ K = Σ_j j² |f_j|. A cell of width h at whose ends |f| exceeds Kh²/8 with one sign holds no zero;
one across which f changes by more than Kh² with a change of sign holds one. Other cells are halved, until Kh²/8 is less
than what f is known to. So no zero is passed over, however close to its neighbour; what stays open is handed on as
touching.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.fft import dct

from trunnion.arrays import Array, Places
from trunnion.numerics.bracketing import bracketed

Functions = Callable[[Array], Array]
"""Quantities (q, …) → functions (f, …)."""

HALVINGS = 40
ROUNDING = 4e-16
"""Of a series, relative to the sum of its coefficients."""
AT_ONCE = 4_000_000
"""Numbers in one array of quantities."""


@dataclass(frozen=True)
class RowRoots:
    """Zeros ``theta`` of function ``which`` on row ``row``, each (zeros,); and stretches in which one may be
    touched."""

    row: Places
    which: Places
    theta: Array
    touched_row: Places
    touched: Array


def row_roots(series: Array, errors: Array, functions: Functions, degree: int) -> RowRoots:
    """Zeros of ``functions`` along rows.

    Parameters
    ----------
    series : (rows, q, J) coefficients of cos jθ.
    errors : (rows, q) bounds on the quantities.
    degree : the highest power of quantities in any function.

    ``touched`` (stretches, 2) are ranges of θ, rising, in which a function comes closer to 0 than it is known.
    """
    rows, _, terms = series.shape
    nodes = degree * (terms - 1) + 1
    exact = functions(values_at(series, np.pi * (np.arange(nodes) + 0.5) / nodes))
    coefficients = np.abs(dct(exact, type=2, axis=-1)) / nodes
    bend = coefficients @ np.arange(nodes, dtype=float) ** 2
    edges = np.pi * np.arange(2 * nodes + 1) / (2 * nodes)
    at_edges = functions(values_at(series, edges))
    count, h = len(at_edges), float(edges[1])
    which, row, cell = (part.ravel() for part in np.indices((count, rows, 2 * nodes)))
    begin = edges[cell]
    left, right = at_edges[:, :, :-1].ravel(), at_edges[:, :, 1:].ravel()
    found: list[tuple[Array, ...]] = []
    touched: list[tuple[Array, ...]] = []
    search = _RootSearch(series, errors, functions, ROUNDING * coefficients.sum(axis=-1))
    for _ in range(HALVINGS):
        small = bend[which, row] * h**2
        near = (np.minimum(np.abs(left), np.abs(right)) <= small / 8) | (left * right <= 0)
        which, row, begin, left, right, small = (a[near] for a in (which, row, begin, left, right, small))
        if not len(row):
            break
        known = np.maximum(search.noise(which, row, begin), search.noise(which, row, begin + h))
        clear = (left * right < 0) & (np.minimum(np.abs(left), np.abs(right)) > known)
        single = clear & ((np.abs(right - left) > small) | (small / 8 <= known))
        found.append((row[single], which[single], begin[single], np.full(single.sum(), h)))
        blurred = ~single & (small / 8 <= known)
        touched.append((row[blurred], begin[blurred], np.full(blurred.sum(), h)))
        split = ~single & ~blurred
        which, row, begin, left, right = (a[split] for a in (which, row, begin, left, right))
        h /= 2
        middle = search.at(which, row, begin + h)
        which, row = np.tile(which, 2), np.tile(row, 2)
        begin = np.concatenate([begin, begin + h])
        left, right = np.concatenate([left, middle]), np.concatenate([middle, right])
    row, which, theta = _solved(search, found)
    return RowRoots(row, which, theta, *_merged(touched))


def values_at(series: Array, theta: Array) -> Array:
    """Quantities (q, rows, θ) of all rows at the same places."""
    basis = np.cos(np.arange(series.shape[2])[:, None] * theta)
    return np.asarray((series @ basis).transpose(1, 0, 2))


@dataclass(frozen=True)
class _RootSearch:
    series: Array
    errors: Array
    functions: Functions
    rounding: Array

    def quantities(self, row: Places, theta: Array) -> Array:
        """Quantities (q, points) at points of rows."""
        terms = np.arange(self.series.shape[2])
        step = max(1, AT_ONCE // (self.series.shape[1] * len(terms)))
        parts = [
            np.einsum("pqj,pj->qp", self.series[row[a : a + step]], np.cos(theta[a : a + step, None] * terms))
            for a in range(0, len(row), step)
        ]
        return np.concatenate(parts, axis=1) if parts else np.zeros((self.series.shape[1], 0))

    def at(self, which: Places, row: Places, theta: Array) -> Array:
        """The function of each point."""
        return np.asarray(self.functions(self.quantities(row, theta))[which, np.arange(len(row))])

    def noise(self, which: Places, row: Places, theta: Array) -> Array:
        """What errors of the quantities do to the function at each point."""
        e, points = self.quantities(row, theta), np.arange(len(row))
        base = self.functions(e)[which, points]
        total = self.rounding[which, row]
        for k in range(len(e)):
            moved = e.copy()
            moved[k] += self.errors[row, k]
            total = total + np.abs(self.functions(moved)[which, points] - base)
        return total


def _solved(search: _RootSearch, found: list[tuple[Array, ...]]) -> tuple[Places, Places, Array]:
    """Zeros in cells that hold one each: (row, function, θ)."""
    own, function, begin, width = (np.concatenate(part) for part in zip(*found, strict=True)) if found else _NONE
    row, which = own.astype(np.intp), function.astype(np.intp)
    return row, which, bracketed(lambda t, p: search.at(which[p], row[p], t), begin, begin + width, 1e-14)


def _merged(touched: list[tuple[Array, ...]]) -> tuple[Places, Array]:
    """Stretches of cells that lie side by side: their rows (stretches,) and ends (stretches, 2)."""
    own, begin, width = (np.concatenate(part) for part in zip(*touched, strict=True)) if touched else _NONE[:3]
    order = np.lexsort((begin, own))
    row, begin, end = own[order].astype(np.intp), begin[order], (begin + width)[order]
    if not len(row):
        return row, np.zeros((0, 2))
    reach = np.maximum.accumulate(end + 10.0 * row) - 10.0 * row  # rows apart: θ stays below 10
    first = np.concatenate([[True], (row[1:] != row[:-1]) | (begin[1:] > reach[:-1] + 1e-12)])
    last = np.concatenate([first[1:], [True]])
    return row[first], np.stack([begin[first], reach[last]], axis=1)


_NONE = tuple(np.zeros(0) for _ in range(4))

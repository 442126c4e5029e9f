"""Batches of matrices that share a pattern of numbers other than zero, solved as bands: their rows and columns are put
in an order that keeps the pattern beside the diagonal (reverse Cuthill–McKee)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from trunnion.arrays import Flags, Integers
from trunnion.numerics.harmonics import solved

Part = tuple[Integers, Integers, NDArray[Any]]
"""Rows, columns, and the numbers there of every case: (…,), (…,), (case, …)."""
NARROW = 0.15
"""A band that reaches over less than this share of a matrix is worth more than all its numbers."""
LONG = 100
"""Unknowns from which on it is."""


class Pattern:
    """Places ``row`` and ``column`` (entry,) of the numbers of matrices (size, size), none twice; what follows from
    them is found once for all matrices of the pattern."""

    def __init__(self, size: int, row: Integers, column: Integers) -> None:
        self.size, self.row, self.column = size, row, column
        self._parts: dict[bytes, tuple[Pattern, Integers]] = {}

    def among(self, kept: Flags) -> tuple[Pattern, Integers]:
        """That of the rows and columns ``kept`` (size,), and which entries are there."""
        if (known := self._parts.get(key := kept.tobytes())) is None:
            place, both = np.cumsum(kept) - 1, np.flatnonzero(kept[self.row] & kept[self.column])
            row, column = place[self.row[both]], place[self.column[both]]
            known = self._parts[key] = Pattern(int(kept.sum()), row, column), both
        return known

    @cached_property
    def band(self) -> tuple[Integers, int]:
        """The place of each unknown along the band, and how far from the diagonal the band reaches."""
        pattern = csr_array((np.ones(len(self.row)), (self.row, self.column)), shape=(self.size, self.size))
        place = np.empty(self.size, dtype=np.int64)
        place[reverse_cuthill_mckee(pattern.tocsr())] = np.arange(self.size)
        return place, int(np.abs(place[self.row] - place[self.column]).max(initial=0))


@dataclass(frozen=True, eq=False)
class SparseMatrices:
    """Matrices (case, size, size): ``values`` (case, entry) at the places of a ``pattern``."""

    pattern: Pattern
    values: NDArray[Any]

    @property
    def size(self) -> int:
        """Rows, and columns."""
        return self.pattern.size

    @property
    def row(self) -> Integers:
        """Of every entry (entry,)."""
        return self.pattern.row

    @property
    def column(self) -> Integers:
        """Of every entry (entry,)."""
        return self.pattern.column

    @staticmethod
    def added(size: int, parts: Sequence[Part]) -> SparseMatrices:
        """The sum of ``parts``, each (row, column, values), which may name a place again."""
        row, column = (np.concatenate([part[k].ravel() for part in parts]) for k in range(2))
        values = np.concatenate([part[2].reshape(len(part[2]), -1) for part in parts], axis=1)
        place, of = np.unique(row * size + column, return_inverse=True)
        if len(place) == len(row):
            return SparseMatrices(Pattern(size, row, column), values)
        order = np.argsort(of, kind="stable")
        first = np.searchsorted(of[order], np.arange(len(place)))
        pattern = Pattern(size, place // size, place % size)
        return SparseMatrices(pattern, np.add.reduceat(values[:, order], first, axis=1))

    def dense(self) -> NDArray[Any]:
        """All numbers, (case, size, size)."""
        out = np.zeros((len(self.values), self.size * self.size), dtype=self.values.dtype)
        out[:, self.row * self.size + self.column] = self.values
        return out.reshape(-1, self.size, self.size)

    def among(self, kept: Flags) -> SparseMatrices:
        """The rows and columns ``kept`` (size,)."""
        pattern, both = self.pattern.among(kept)
        return SparseMatrices(pattern, self.values[:, both])

    def rows(self, kept: Flags) -> NDArray[Any]:
        """The rows ``kept`` (size,) alone, all numbers of them, (case, kept, size)."""
        place, own = np.cumsum(kept) - 1, kept[self.row]
        out = np.zeros((len(self.values), int(kept.sum()), self.size), dtype=self.values.dtype)
        out[:, place[self.row[own]], self.column[own]] = self.values[:, own]
        return out

    def only(self, kept: Flags) -> SparseMatrices:
        """The entries ``kept`` (entry,)."""
        return SparseMatrices(Pattern(self.size, self.row[kept], self.column[kept]), self.values[:, kept])

    def times(self, x: NDArray[Any]) -> NDArray[Any]:
        """Products (case, size, …) with x (case, size, …), or with the one of all cases (1, size, …)."""
        shape = (self.size, self.size)
        every = np.broadcast_to(x, (len(self.values), *x.shape[1:]))
        made = [csr_array((v, (self.row, self.column)), shape) @ one for v, one in zip(self.values, every, strict=True)]
        return np.stack(made)

    def solved(self, right: NDArray[Any]) -> NDArray[Any]:
        """Solutions (case, size) or (case, size, k) under ``right`` of that shape; NaN where a matrix is singular or
        not finite. One matrix serves any number of cases."""
        alone = len(self.values) == 1 and right.ndim == 2
        columns = right.T[None] if alone else right.reshape(len(right), self.size, -1)
        wide = self.size < LONG or self.pattern.band[1] > NARROW * self.size
        found = solved(self.dense(), columns) if wide else self._by_band(columns)
        return np.ascontiguousarray(found[0].T) if alone else found.reshape(right.shape)

    def _by_band(self, right: NDArray[Any]) -> NDArray[Any]:
        """``solved`` of matrices and right sides (case, size, k), as many of them."""
        place, reach = self.pattern.band
        (solve,) = lapack.get_lapack_funcs(("gbsv",), (self.values, right))
        out = np.full(right.shape, np.nan, dtype=np.result_type(self.values, right))
        for values, given, found in zip(self.values, right, out, strict=True):
            if not (np.isfinite(values).all() and np.isfinite(given).all()):
                continue
            band = np.zeros((3 * reach + 1, self.size), dtype=values.dtype, order="F")
            band[2 * reach + place[self.row] - place[self.column], place[self.column]] = values
            ordered = np.empty_like(given, order="F")
            ordered[place] = given
            _, _, x, singular = solve(reach, reach, band, ordered, overwrite_ab=True, overwrite_b=True)
            if not singular:
                found[:] = x[place]
        return out

"""Linear systems of a few places whose entries are matrices, of all harmonics by all, or diagonals.

Places are taken out one after the other, those first whose own matrix is a diagonal: they need no inverse. Taking one
out joins those that it was joined to.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Complex


@dataclass(frozen=True)
class _TakenOut:
    """One ``place`` taken out: the inverse of its matrix, and that times the couplings with each of the ``fronts``,
    which are taken out later, from the right and from the left."""

    place: int
    fronts: tuple[int, ...]
    inverse: Complex
    behind: tuple[Complex, ...]
    ahead: tuple[Complex, ...]


class JoinedPlaces:
    """Of places 0 to m − 1; each matrix (case, h, h), or (case, h) of a diagonal."""

    def __init__(self, own: list[Complex], couplings: dict[tuple[int, int], Complex]) -> None:
        """``couplings`` : by row and column, of each pair both; both arguments are written over."""
        self._taken_out: list[_TakenOut] = []
        left = list(range(len(own)))
        with np.errstate(all="ignore"):
            while left:
                k = _next(left, own, couplings)
                left.remove(k)
                inverse, fronts = _inverse(own[k]), tuple(a for a in left if (a, k) in couplings)
                behind = tuple(_times(inverse, couplings[k, a]) for a in fronts)
                ahead = tuple(_times(couplings[a, k], inverse) for a in fronts)
                for a in fronts:
                    for b, part in zip(fronts, behind, strict=True):
                        less = _times(couplings[a, k], part)
                        if a == b:
                            own[a] = _minus(own[a], less)
                        else:
                            couplings[a, b] = _minus(couplings[a, b], less) if (a, b) in couplings else -less
                self._taken_out.append(_TakenOut(k, fronts, inverse, behind, ahead))

    def solved(self, x: Complex, *, transposed: bool = False) -> Complex:
        """Solutions (m, case, h) under ``x`` (m, case, h), in place, of the transpose where that is asked for."""
        with np.errstate(all="ignore"):
            for one in self._taken_out:
                for a, part in zip(one.fronts, one.behind if transposed else one.ahead, strict=True):
                    x[a] -= _applied(part, x[one.place], transposed)
            for one in reversed(self._taken_out):
                x[one.place] = _applied(one.inverse, x[one.place], transposed)
                for a, part in zip(one.fronts, one.ahead if transposed else one.behind, strict=True):
                    x[one.place] -= _applied(part, x[a], transposed)
        return x


def _next(left: list[int], own: list[Complex], couplings: dict[tuple[int, int], Complex]) -> int:
    """Which place to take out next: a diagonal one that the fewest others are joined to, else the last."""

    def cost(k: int) -> tuple[bool, int, int]:
        whole = own[k].ndim > 2
        return whole, 0 if whole else sum((a, k) in couplings for a in left), -k

    return min(left, key=cost)


def _times(a: Complex, b: Complex) -> Complex:
    if a.ndim == 2:
        return np.asarray(a * b if b.ndim == 2 else a[:, :, None] * b)
    return np.asarray(a * b[:, None, :] if b.ndim == 2 else a @ b)


def _minus(a: Complex, b: Complex) -> Complex:
    if a.ndim == b.ndim:
        return np.asarray(a - b)
    whole, diagonal = (a.copy(), -b) if a.ndim > 2 else (-b, a)
    every = np.arange(whole.shape[-1])
    whole[:, every, every] += diagonal
    return whole


def _applied(matrix: Complex, x: Complex, transposed: bool) -> Complex:
    """Products (case, h) of matrices with x (case, h)."""
    if matrix.ndim == 2:
        return np.asarray(matrix * x)
    return np.asarray((x[:, None] @ matrix)[:, 0] if transposed else (matrix @ x[..., None])[..., 0])


def _inverse(matrix: Complex) -> Complex:
    """Inverses; NaN where there is none."""
    if matrix.ndim == 2:
        return np.asarray(1 / matrix)
    try:
        return np.asarray(np.linalg.inv(matrix))
    except np.linalg.LinAlgError:
        found = np.full_like(matrix, np.nan)
        for one, made in zip(matrix, found, strict=True):
            try:
                made[:] = np.linalg.inv(one)
            except np.linalg.LinAlgError:
                continue
        return found

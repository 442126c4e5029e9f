"""From analytic quantities to what a chart shows: spectral radius, its error, the critical multiplier."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from trunnion.arrays import Array, Codes, Complex, Flags, Places
from trunnion.numerics.chain.characteristic import LARGEST, radii, radii_on_rows, roots_of, without_ones
from trunnion.numerics.chain.eigenvalues_in_rows import conditions, eigenvalues_in_rows
from trunnion.numerics.patches.patches import Patch
from trunnion.numerics.spectrum import multipliers, spectral_radius
from trunnion.results.verdict import Verdict, verdicts

FEW, SMALL = 256, 24
"""Matrices that a library is quick enough for, and their size."""
ROUNDING = 4e-15
"""Of a matrix's norm, what of it eigenvalues are found for."""


class Pixels(NamedTuple):
    """Arrays of any one shape: spectral radius, error bound, critical multiplier (of a pair the one with the positive
    imaginary part), verdict code."""

    radius: Array
    error: Array
    critical: Complex
    verdict: Codes

    @staticmethod
    def of(radius: Array, error: Array, critical: Complex, trace: Array, size: int) -> Pixels:
        """With their verdicts, of lines of ``size`` unknowns by ∫ tr(M⁻¹C) dτ; ``critical`` is changed in place."""
        np.abs(critical.imag, out=critical.imag)
        return Pixels(radius, error, critical, verdicts(radius, error, undamped(trace, size)))

    @staticmethod
    def failed(shape: tuple[int, ...]) -> Pixels:
        """Pixels of which nothing is known yet."""
        radius, error, critical = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan, dtype=complex)
        return Pixels(radius, error, critical, np.full(shape, Verdict.FAILED, dtype=np.int8))

    def at(self, places: Any) -> Pixels:
        """Those at ``places``, as NumPy picks entries of an array."""
        return Pixels._make(part[places] for part in self)

    def put(self, places: Any, found: Pixels) -> None:
        """Set those at ``places``, in place."""
        self.radius[places], self.error[places] = found.radius, found.error
        self.critical[places], self.verdict[places] = found.critical, found.verdict

    def put_better(self, found: Pixels, *places: Places) -> None:
        """Put in place what is better known of the pixels at ``places``, an array of numbers an axis."""
        better = found.error < self.error[places]
        self.put(tuple(axis[better] for axis in places), found.at(better))

    def shaped(self, shape: tuple[int, ...]) -> Pixels:
        """The same pixels in another shape."""
        return Pixels._make(part.reshape(shape) for part in self)


def undamped(trace: Array, size: int) -> Flags:
    """Where nothing damps a line of ``size`` unknowns, by ∫ tr(M⁻¹C) dτ (points,)."""
    return np.abs(trace) < 1e-12 * size


def judge(values: Array, bounds: Array, size: int, set_aside: int) -> Pixels:
    """Pixels from quantities (q, points) and their bounds (q, points), ``set_aside`` multipliers exactly 1 left out.

    See ``chart_families.quantities`` for what the quantities are, and ``leading_group`` for those of stiff lines.
    """
    m, trace = _multipliers_in(values, size), values[-1]
    if m == set_aside:
        # One inertia that turns freely neither grows nor decays.
        one = np.where(np.isfinite(values[0]), 1.0, np.nan)
        radius, error, critical = one, 0.0 * one, one.astype(complex)
    elif m <= LARGEST:
        left = (values[:m], bounds[:m])
        radius, error, critical = radii(*(without_ones(*left, set_aside) if set_aside else left))
    else:
        radius, error, critical = _largest(values[:-1], np.sqrt(np.sum(bounds[:-1] ** 2, axis=0)), m, set_aside)
    return Pixels.of(radius, error, critical, trace, size)


def judge_matrices(matrix: Array, error: Array, trace: Array) -> Pixels:
    """Pixels (points,) from whole monodromy matrices, whose eigenvalues are better known than coefficients' roots."""
    every, bound = multipliers(matrix, error)
    radius, off = spectral_radius(every, bound)
    critical = np.take_along_axis(every, np.abs(every).argmax(axis=1)[:, None], axis=1)[:, 0]
    return Pixels.of(radius, off, critical, trace, matrix.shape[1] // 2)


def judge_rows(patch: Patch, along: Array, u: Array, v: Array, size: int, set_aside: int) -> Pixels:
    """Pixels (v, u) of rows ``v`` of a patch, whose columns ``along`` belong to ``u``."""
    m, shape = _multipliers_in(along, size), (len(v), len(u))
    column_block, row_block = patch.blocks(u, v)
    if m > LARGEST or set_aside:
        values = patch.rows(along, v)
        flat = values.reshape(len(values), -1)
        return _judge_in_blocks(flat, patch, row_block, column_block, size, set_aside).shaped(shape)
    radius, error, critical = np.empty(shape), np.empty(shape), np.empty((*shape, 2))
    bounds = np.ascontiguousarray(patch.error[:m])  # however its file kept it: compiled once
    radii_on_rows(patch.weights(v), along[:m], bounds, row_block, column_block, radius, error, critical)
    return Pixels.of(radius, error, critical.view(np.complex128)[..., 0], patch.rows(along[-1:], v)[0], size)


def _judge_in_blocks(values: Array, patch: Patch, rows: Places, columns: Places, size: int, set_aside: int) -> Pixels:
    """``judge`` of pixels that lie in the blocks ``rows`` × ``columns`` of a patch.

    Of matrices only the norm of the bounds is needed, which is the same all over a block.
    """
    m = _multipliers_in(values, size)
    if m <= LARGEST:
        return judge(values, patch.error[:, rows[:, None], columns].reshape(len(values), -1), size, set_aside)
    norm = np.sqrt(np.sum(patch.error[:-1] ** 2, axis=0))[rows[:, None], columns].ravel()
    return Pixels.of(*_largest(values[:-1], norm, m, set_aside), values[-1], size)


def _multipliers_in(quantities: Array, size: int) -> int:
    """How many multipliers the quantities tell: all, or the largest of a stiff line by their coefficients alone."""
    return min(len(quantities) - 1, 2 * size)


def tells_all(quantities: Array, size: int) -> bool:
    """Whether the quantities tell every multiplier."""
    return _multipliers_in(quantities, size) == 2 * size


def multipliers_of(values: Array, size: int, set_aside: int) -> Complex:
    """All multipliers of one point from its quantities, by falling modulus."""
    m = _multipliers_in(values, size)
    if m > LARGEST:
        found = np.linalg.eigvals(values[:-1].reshape(m, m)).astype(complex)
    elif set_aside:
        left = without_ones(values[:m, None], np.zeros((m, 1)), set_aside)[0][: m - set_aside, 0]
        found = np.concatenate([np.ones(set_aside), roots_of(left)])
    else:
        found = roots_of(values[:m])
    return np.asarray(found[np.argsort(-np.abs(found))])


def _largest(matrices: Array, bound: Array, m: int, set_aside: int) -> tuple[Array, Array, Complex]:
    """Critical eigenvalue of matrices (m², points) known to ``bound`` (points,), with its own condition number.

    Eigenvectors of the critical multiplier alone come from two steps of inverse iteration; a full
    decomposition would cost several times more.
    """
    matrix_error = bound + ROUNDING * np.sqrt(np.sum(matrices**2, axis=0))
    every, hessenberg = _eigenvalues(matrices, m)
    if set_aside:
        keep = np.argsort(np.abs(every - 1), axis=1)[:, set_aside:]
        every = np.take_along_axis(every, keep, axis=1)
    which = np.abs(every).argmax(axis=1)[:, None]
    critical = np.take_along_axis(every, which, axis=1)[:, 0]
    apart = np.abs(every - critical[:, None])
    np.put_along_axis(apart, which, np.inf, axis=1)
    nearest = apart.min(axis=1)
    moved = matrix_error * _condition(hessenberg, critical)
    error = 2 * np.minimum(moved, np.sqrt(moved * np.maximum(nearest, matrix_error)))
    return np.abs(critical), error, critical


def _eigenvalues(matrices: Array, m: int) -> tuple[Complex, Array]:
    """Eigenvalues (points, m) of matrices (m², points), and matrices (points, m, m) similar to these by rotations.

    NaN where they are not finite. Few are left to the library: nothing is compiled for them.
    """
    points = matrices.shape[1]
    alike = np.ascontiguousarray(matrices.T).reshape(points, m, m)
    every = np.full((points, m), np.nan, dtype=complex)
    if points > FEW or m > SMALL:
        parts = np.empty((m, points, 2))
        eigenvalues_in_rows(np.ascontiguousarray(matrices), m, parts, hessenberg := np.empty((points, m, m)))
        every, alike = parts.view(np.complex128)[..., 0].T.copy(), hessenberg
    left = np.isnan(every).any(axis=1) & np.isfinite(alike).all(axis=(1, 2))
    if left.any():
        every[left] = np.linalg.eigvals(alike[left])
    return every, alike


def _condition(matrix: Array, value: Complex) -> Array:
    """‖left‖‖right‖/|left·right| of one eigenvalue of each matrix."""
    count, m = matrix.shape[:2]
    out = np.full(count, np.nan)
    if count > FEW or m > SMALL:
        conditions(matrix, value, out)
        return np.clip(out, 1.0, 1e10)
    finite = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(value)
    if not finite.any():
        return out
    a, shift = matrix[finite], value[finite]
    offset = shift * (1 + 1e-9) + 1e-9j
    shifted = a - offset[:, None, None] * np.eye(m)
    inverse = np.linalg.inv(shifted)
    start = np.exp(1j * np.arange(m))[:, None]
    right = inverse @ (inverse @ start)
    left = inverse.transpose(0, 2, 1) @ (inverse.transpose(0, 2, 1) @ start)
    dot = np.abs(np.sum(left * right, axis=(1, 2)))
    norms = np.linalg.norm(left, axis=(1, 2)) * np.linalg.norm(right, axis=(1, 2))
    out[finite] = np.clip(norms / np.maximum(dot, 1e-300), 1.0, 1e10)
    return out

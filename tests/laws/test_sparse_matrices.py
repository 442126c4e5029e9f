"""Matrices of one pattern against the same written out: sums, parts, products, solutions by bands."""

from __future__ import annotations

import numpy as np
import pytest

from trunnion.numerics.sparse_matrices import LONG, Pattern, SparseMatrices


def banded(cases: int, size: int, seed: int = 0) -> SparseMatrices:
    """Complex, with numbers near the diagonal of rows and columns in a random order."""
    rng = np.random.default_rng(seed)
    near = np.abs(np.subtract.outer(np.arange(size), np.arange(size)))
    row, column = np.nonzero(near <= 3)
    values = rng.normal(size=(cases, len(row))) + 1j * rng.normal(size=(cases, len(row))) + 9.0 * (row == column)
    place = rng.permutation(size)
    return SparseMatrices(Pattern(size, place[row], place[column]), values)


@pytest.mark.parametrize("size", [LONG // 4, 3 * LONG])
def test_solutions_are_those_of_the_whole_matrices(size: int) -> None:
    matrices, rng = banded(4, size), np.random.default_rng(1)
    right = rng.normal(size=(4, size, 2)) + 0j
    x = matrices.solved(right)
    assert matrices.dense() @ x == pytest.approx(right, abs=1e-11)
    assert matrices.times(x) == pytest.approx(right, abs=1e-11)
    assert matrices.solved(right[..., 0]) == pytest.approx(x[..., 0], abs=1e-12)
    alone = SparseMatrices(matrices.pattern, matrices.values[:1])
    for one, given in zip(alone.solved(right[..., 0]), right[..., 0], strict=True):  # one matrix, four cases
        assert alone.dense()[0] @ one == pytest.approx(given, abs=1e-11)


@pytest.mark.parametrize("size", [LONG // 4, 3 * LONG])
def test_a_singular_or_unknown_matrix_has_no_solution_and_spoils_no_other(size: int) -> None:
    matrices = banded(4, size)
    matrices.values[1, matrices.row == 7] = 0.0
    matrices.values[2, 5] = np.nan
    found = np.isnan(matrices.solved(np.ones((4, size), dtype=complex))).all(axis=1)
    assert found.tolist() == [False, True, True, False]


def test_parts_that_name_a_place_again_are_added() -> None:
    first = np.array([0, 1, 1]), np.array([0, 0, 1]), np.array([[1.0, 2.0, 3.0]])
    again = np.array([[1, 0]]), np.array([[1, 1]]), np.array([[[10.0, 20.0]]])
    found = SparseMatrices.added(2, [first, again])
    assert found.dense()[0].tolist() == [[1.0, 20.0], [2.0, 13.0]] and len(found.row) == 4


def test_some_rows_and_columns() -> None:
    matrices = banded(2, 30)
    kept = np.random.default_rng(2).random(30) < 0.5
    whole = matrices.dense()
    assert np.array_equal(matrices.among(kept).dense(), whole[:, kept][:, :, kept])
    assert np.array_equal(matrices.rows(kept), whole[:, kept])
    right = matrices.row >= matrices.column
    assert np.array_equal(matrices.only(right).dense(), np.tril(whole))

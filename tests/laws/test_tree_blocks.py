"""Systems with the pattern of a tree, solved by elimination along it, against all their numbers at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from trunnion.numerics.condensation import Plan
from trunnion.numerics.tree_blocks import TreeBlock, TreeMatrix

CASES, HARMONICS = 3, 4


def random_system(seed: int, *, blocks: int = 3) -> TreeMatrix:
    """A tree of 12 places with entries that join harmonics at some of them."""
    rng, n = np.random.default_rng(seed), 12
    parent = np.array([-1, *(int(rng.integers(0, i)) for i in range(1, n))])

    def numbers(*shape: int) -> Any:
        return rng.normal(size=shape) + 1j * rng.normal(size=shape)

    kept, made = np.zeros(n, dtype=bool), []
    far, near = (part.ravel() for part in np.indices((HARMONICS, HARMONICS)))
    for i in rng.choice(np.arange(1, n), size=blocks, replace=False).tolist():
        p = int(parent[i])
        kept[[i, p]] = True
        made += [TreeBlock(a, b, far, near, numbers(CASES, len(far))) for a, b in ((i, i), (i, p), (p, i))]
    own, coupling = numbers(n, CASES, HARMONICS), numbers(n, CASES, HARMONICS)
    coupling[0] = 0.0
    return TreeMatrix(Plan.of(parent, kept), parent, own, coupling, made)


def by_all_numbers(matrix: TreeMatrix, right: Any) -> Any:
    flat = np.moveaxis(right, 1, 0).reshape(CASES, -1, 1)
    return np.moveaxis(np.linalg.solve(matrix.whole().dense(), flat).reshape(CASES, -1, HARMONICS), 0, 1)


@pytest.mark.parametrize("seed", range(6))
def test_solutions_products_and_transposes(seed: int) -> None:
    """Of every case and of the transpose; products are those of all numbers."""
    matrix = random_system(seed, blocks=seed % 4)
    rng = np.random.default_rng(seed + 100)
    right = rng.normal(size=(12, CASES, HARMONICS)) + 0j
    expected = by_all_numbers(matrix, right)
    assert matrix.solved(right) == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert matrix.times(expected) == pytest.approx(right, rel=1e-9, abs=1e-9)
    turned = matrix.eliminated(right, transposed=True)
    assert matrix.times(turned, transposed=True) == pytest.approx(right, rel=1e-7, abs=1e-7)


def test_a_part_in_resonance_by_itself_costs_no_figures() -> None:
    """Its pivot is zero; the whole is not singular."""
    matrix = random_system(1)
    leaf = max(set(range(1, 12)) - set(matrix.parent.tolist()) - set(matrix.plan.left.tolist()))
    matrix.own[leaf] = 1e-18
    right = np.ones((12, CASES, HARMONICS), dtype=complex)
    assert matrix.solved(right) == pytest.approx(by_all_numbers(matrix, right), rel=1e-9, abs=1e-9)


def test_a_singular_case_is_nan_and_leaves_the_others() -> None:
    """A place without stiffness that nothing holds."""
    matrix = random_system(2, blocks=0)
    leaf = max(set(range(1, 12)) - set(matrix.parent.tolist()))
    matrix.own[leaf, 1, 2], matrix.coupling[leaf, 1, 2] = 0.0, 0.0
    found = matrix.solved(np.ones((12, CASES, HARMONICS), dtype=complex))
    assert np.isnan(found[:, 1]).any() and np.isfinite(found[:, [0, 2]]).all()

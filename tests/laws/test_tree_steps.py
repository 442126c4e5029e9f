"""Steps of inverse iteration along a tree against all numbers of both matrices at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from trunnion.numerics.condensation import Plan
from trunnion.numerics.tree_blocks import TreeBlock
from trunnion.numerics.tree_steps import TreePencil

PLACES, CASES, HARMONICS = 14, 3, 4


def random_pencil(seed: int, nodes: int) -> tuple[TreePencil, list[TreeBlock], list[TreeBlock]]:
    """Numbers of K, C and M that all cases share, or one set each; joined by mass at two places; and entries that join
    harmonics, of the matrix and of its slope."""
    rng = np.random.default_rng(seed)
    parent = np.array([-1, *(int(rng.integers(0, i)) for i in range(1, PLACES))])
    own = tuple(rng.normal(size=(PLACES, nodes)) for _ in range(3))
    coupling = tuple(rng.normal(size=(PLACES, nodes)) for _ in range(3))
    coupling[2][2:] = 0.0
    coupling[1][5] = 0.0
    kept, blocks, slopes = np.zeros(PLACES, dtype=bool), [], []
    far, near = (part.ravel() for part in np.indices((HARMONICS, HARMONICS)))
    for i in rng.choice(np.arange(1, PLACES), size=seed % 4, replace=False).tolist():
        p = int(parent[i])
        kept[[i, p]] = True
        for a, b in ((i, i), (i, p), (p, i))[seed % 2 :]:
            values = rng.normal(size=(2, CASES, len(far))) + 1j * rng.normal(size=(2, CASES, len(far)))
            blocks.append(TreeBlock(a, b, far, near, values[0]))
            slopes.append(TreeBlock(a, b, far, near, values[1]))
    return TreePencil(Plan.of(parent, kept), parent, own, coupling), blocks, slopes


def all_numbers(pencil: TreePencil, factors: tuple[Any, Any, Any], blocks: list[TreeBlock]) -> Any:
    """K f₀ + C f₁ + M f₂ (case, place and harmonic, place and harmonic)."""
    found = np.zeros((CASES, PLACES, HARMONICS, PLACES, HARMONICS), dtype=complex)
    for h in range(HARMONICS):
        for i in range(PLACES):
            p = int(pencil.parent[i])
            for kind, factor in enumerate(factors):
                found[:, i, h, i, h] += pencil.own[kind][i] * factor[:, h]
                if p >= 0:
                    found[:, i, h, p, h] += pencil.coupling[kind][i] * factor[:, h]
                    found[:, p, h, i, h] += pencil.coupling[kind][i] * factor[:, h]
    for block in blocks:
        for pair, (far, near) in enumerate(zip(block.far, block.near, strict=True)):
            found[:, block.row, far, block.column, near] += block.values[:, pair]
    return found.reshape(CASES, PLACES * HARMONICS, PLACES * HARMONICS)


@pytest.mark.parametrize("nodes", [1, CASES])
@pytest.mark.parametrize("seed", range(8))
def test_a_step_is_that_of_all_numbers(seed: int, nodes: int) -> None:
    """With and without entries that join harmonics; some places that are left have none of their own."""
    pencil, blocks, slopes = random_pencil(seed, nodes)
    rng = np.random.default_rng(seed + 100)
    s = rng.normal(size=(CASES, HARMONICS)) + 1j * rng.normal(size=(CASES, HARMONICS))
    x = rng.normal(size=(PLACES, CASES, HARMONICS)) + 0j
    one = np.ones_like(s)
    flat = np.moveaxis(x, 1, 0).reshape(CASES, -1, 1)
    right = all_numbers(pencil, (0 * s, one, 2 * s), slopes) @ flat
    expected = np.linalg.solve(all_numbers(pencil, (one, s, s * s), blocks), right)
    found = np.moveaxis(pencil.stepped(s, x, blocks, slopes), 1, 0).reshape(CASES, -1, 1)
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-8 * np.abs(expected).max())

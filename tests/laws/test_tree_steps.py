"""Steps of inverse iteration along a tree against all numbers of both matrices at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from trunnion.numerics.condensation import Plan
from trunnion.numerics.tree_blocks import TreeBlock
from trunnion.numerics.tree_steps import COMPILED, TreePencil

HARMONICS = 4
SIZES = pytest.mark.parametrize(
    ("places", "cases"),
    [pytest.param(14, 3, id="short"), pytest.param(COMPILED, 3, id="compiled"), pytest.param(45, 19, id="in parts")],
)
"""One that is not compiled, and two that are; of the last, columns go through the tree in several parts."""


def random_pencil(
    seed: int, places: int, cases: int, nodes: int
) -> tuple[TreePencil, list[TreeBlock], list[TreeBlock]]:
    """Numbers of K, C and M that all cases share, or one set each; joined by mass at two places; and entries that join
    harmonics, of the matrix and of its slope."""
    rng = np.random.default_rng(seed)
    parent = np.array([-1, *(int(rng.integers(max(0, i - 4), i)) for i in range(1, places))])
    own = tuple(rng.normal(size=(places, nodes)) for _ in range(3))
    coupling = tuple(rng.normal(size=(places, nodes)) for _ in range(3))
    coupling[2][2:] = 0.0
    coupling[1][5] = 0.0
    kept, blocks, slopes = np.zeros(places, dtype=bool), [], []
    far, near = (part.ravel() for part in np.indices((HARMONICS, HARMONICS)))
    for i in rng.choice(np.arange(1, places), size=seed % 4, replace=False).tolist():
        p = int(parent[i])
        kept[[i, p]] = True
        for a, b in ((i, i), (i, p), (p, i))[seed % 2 :]:
            values = rng.normal(size=(2, cases, len(far))) + 1j * rng.normal(size=(2, cases, len(far)))
            blocks.append(TreeBlock(a, b, far, near, values[0]))
            slopes.append(TreeBlock(a, b, far, near, values[1]))
    return TreePencil(Plan.of(parent, kept), parent, own, coupling), blocks, slopes


def all_numbers(pencil: TreePencil, factors: tuple[Any, Any, Any], blocks: list[TreeBlock]) -> Any:
    """K f₀ + C f₁ + M f₂ (case, place and harmonic, place and harmonic)."""
    places, cases = len(pencil.parent), len(factors[0])
    found = np.zeros((cases, places, HARMONICS, places, HARMONICS), dtype=complex)
    for h in range(HARMONICS):
        for i in range(places):
            p = int(pencil.parent[i])
            for kind, factor in enumerate(factors):
                found[:, i, h, i, h] += pencil.own[kind][i] * factor[:, h]
                if p >= 0:
                    found[:, i, h, p, h] += pencil.coupling[kind][i] * factor[:, h]
                    found[:, p, h, i, h] += pencil.coupling[kind][i] * factor[:, h]
    for block in blocks:
        for pair, (far, near) in enumerate(zip(block.far, block.near, strict=True)):
            found[:, block.row, far, block.column, near] += block.values[:, pair]
    return found.reshape(cases, places * HARMONICS, places * HARMONICS)


@pytest.mark.parametrize("shared", [True, False], ids=["one set of numbers", "one a case"])
@pytest.mark.parametrize("seed", range(8))
@SIZES
def test_a_step_is_that_of_all_numbers(seed: int, places: int, cases: int, shared: bool) -> None:
    """With and without entries that join harmonics; some places that are left have none of their own."""
    pencil, blocks, slopes = random_pencil(seed, places, cases, 1 if shared else cases)
    rng = np.random.default_rng(seed + 100)
    s = rng.normal(size=(cases, HARMONICS)) + 1j * rng.normal(size=(cases, HARMONICS))
    x = rng.normal(size=(places, cases, HARMONICS)) + 0j
    one = np.ones_like(s)
    flat = np.moveaxis(x, 1, 0).reshape(cases, -1, 1)
    right = all_numbers(pencil, (0 * s, one, 2 * s), slopes) @ flat
    expected = np.linalg.solve(all_numbers(pencil, (one, s, s * s), blocks), right)
    found = np.moveaxis(pencil.stepped(s, x, blocks, slopes), 1, 0).reshape(cases, -1, 1)
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("seed", range(4))
@SIZES
def test_a_product_is_that_of_all_numbers(seed: int, places: int, cases: int) -> None:
    """Of the matrix itself, at complex motions."""
    pencil, blocks, _ = random_pencil(seed, places, cases, 1)
    rng = np.random.default_rng(seed + 200)
    s, x = (
        rng.normal(size=size) + 1j * rng.normal(size=size) for size in ((cases, HARMONICS), (places, cases, HARMONICS))
    )
    expected = all_numbers(pencil, (np.ones_like(s), s, s * s), blocks) @ np.moveaxis(x, 1, 0).reshape(cases, -1, 1)
    found = np.moveaxis(pencil.times(s, x, blocks), 1, 0).reshape(cases, -1, 1)
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.abs(expected).max())

"""What is proved of random boxes against radii integrated without the package, at corners, inside and beside the
boundary: nothing is proved that is not so."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.attacked_boxes import check, check_staged, driveline, random_shape, staged_shape
from oracles.own_monodromy import Chains

import trunnion as tn


def totals(seeds: range, boxes: int, size: int, simple: bool) -> None:
    found = np.array([check(seed, boxes, size, simple) for seed in seeds]).sum(axis=0)
    # Neither all nor nothing: boxes stand at the boundary.
    many = boxes * len(seeds)
    assert found[0] > 0.05 * many and found[1] > 0.05 * many, found


def test_boxes_at_the_boundary() -> None:
    totals(range(1, 2), 20, 2, simple=True)


@pytest.mark.slow
@pytest.mark.parametrize("simple", [True, False])
def test_hundreds_of_boxes_at_the_boundary(simple: bool) -> None:
    totals(range(2, 12), 30, 2, simple)


@pytest.mark.parametrize("seed", range(2))
def test_the_judge_agrees_with_the_package(seed: int) -> None:
    """Radii of the oracle are those of ``stability``."""
    rng = np.random.default_rng(seed)
    shape = random_shape(rng, 2, simple=False)
    speed = 10 ** rng.uniform(-0.3, 0.5, 6)
    mine = Chains(shape.at({}, np.full(6, 0.3)), speed).radii()
    line = driveline(shape.at({}, np.full(1, 0.3)), 0)
    for one, own in zip(speed, mine, strict=True):
        found = tn.stability(line, float(one))
        theirs = np.abs(found.multipliers).max() ** (2 * np.pi / found.period)
        assert own == pytest.approx(theirs, rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_thousands_of_small_boxes(seed: int) -> None:
    totals(range(100 + 10 * seed, 110 + 10 * seed), 50, 2, simple=seed % 2 == 0)


@pytest.mark.parametrize("seed", [1, 7])
def test_boxes_of_springs_with_stages_at_the_boundary(seed: int) -> None:
    """Also where a load scatters across the end of a stage."""
    proved, unstable = check_staged(400_000 + seed, 20, 2, 12)
    assert 0 < proved < 20 and unstable


@pytest.mark.slow
def test_hundreds_of_boxes_of_springs_with_stages() -> None:
    found = np.array([check_staged(400_100 + seed, 30, 1 + seed % 3) for seed in range(10)]).sum(axis=0)
    assert found[0] > 15 and found[1] > 15, found


@pytest.mark.parametrize("seed", range(3))
def test_the_judge_takes_stages_as_the_package_does(seed: int) -> None:
    """A load within its stage, and radii of the oracle are those of ``stability``."""
    rng = np.random.default_rng(400_200 + seed)
    shape = staged_shape(rng, 2)
    speed = 10 ** rng.uniform(-0.3, 0.5, 6)
    mine = Chains(shape.at({}, np.full(6, 0.3)), speed).radii()
    line = driveline(shape.at({}, np.full(1, 0.3)), 0)
    assert any(isinstance(one, tn.PiecewiseShaft) for one in line.elements)
    for one, own in zip(speed, mine, strict=True):
        found = tn.stability(line, float(one))
        theirs = np.abs(found.multipliers).max() ** (2 * np.pi / found.period)
        assert own == pytest.approx(theirs, rel=1e-7)

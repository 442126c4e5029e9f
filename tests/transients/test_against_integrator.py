"""Transients against equations written by hand and integrated by scipy."""

from __future__ import annotations

import numpy as np
import pytest

from tests.transients.hand_written import Numbers, integrated

DURATION = 0.35


def compare(seed: int) -> int:
    """One random line; how many times its friction switched."""
    rng = np.random.default_rng(seed)
    p = Numbers.random(rng, rest=seed % 2 == 0)
    run = p.run(DURATION, tolerance=1e-12)
    assert run.outcome.kind == "reached", run.outcome
    times = np.linspace(0, DURATION, 301)
    known = integrated(p, times)
    here = run.at(times)
    stations = run._stations
    found = np.concatenate([here.angle[:, stations], here.speed[:, stations]], axis=1)
    beside = p.run(DURATION, start=1e-12 * rng.standard_normal(6), tolerance=1e-12).at(times)
    other = np.concatenate([beside.angle[:, stations], beside.speed[:, stations]], axis=1)
    size = np.abs(known).max(axis=0)
    grown = np.maximum.accumulate(np.abs(other - found).max(axis=1)) > 1e-7
    compared = ~grown
    assert compared.sum() > 100
    assert np.all(np.abs(found - known)[compared] < 1e-6 * size)
    assert run.energy.error < 1e-8
    return len(p.switches)


def test_ten_random_lines() -> None:
    assert sum(compare(seed) for seed in range(6)) > 4


@pytest.mark.slow
def test_a_hundred_random_lines() -> None:
    assert sum(compare(seed) for seed in range(100, 200)) > 100

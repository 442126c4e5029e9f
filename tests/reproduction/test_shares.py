"""What "more" and "less" mean: shares with sampling errors, and what follows from band to band."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import trunnion as tn
from trunnion.papers.shared.shares import Share, bands, change, in_bands, share, steps
from trunnion.results.chart import StabilityChart


@pytest.fixture(scope="module")
def chart() -> StabilityChart:
    """One tongue of S1, of which other unstable regions are made."""
    line = tn.catalogue("two-shaft-cardan")
    return tn.stability_chart(line, ("speed", 1.4, 1.8, 200), ("HookeJoint 1.angle", 0.0, 0.5, 100), tolerance=1e-8)


def with_region(chart: StabilityChart, inside: np.ndarray) -> StabilityChart:
    return replace(chart, verdict=inside.astype(np.int8))


def test_share_of_a_known_region(chart: StabilityChart) -> None:
    """A slanted band and ragged noise: the error covers the truth, and grows with the raggedness."""
    x, y = np.meshgrid(np.linspace(0, 1, 200), np.linspace(0, 1, 100))
    band = share(with_region(chart, np.abs(x - 0.3 - 0.2 * y) < 0.0617))
    assert abs(band.value - 12.34) < 3 * band.error + 0.05
    noise = np.random.default_rng(1).random(x.shape) < 0.1234
    ragged = share(with_region(chart, noise))
    assert abs(ragged.value - 12.34) < 3 * ragged.error
    assert ragged.error == pytest.approx(100 * np.sqrt(0.1234 * 0.8766 / x.size), rel=0.5)


def test_half_the_pixels_agree_within_the_error(chart: StabilityChart) -> None:
    fine = share(chart.zoom((1.4, 1.8, 800), (0.0, 0.5, 400)))
    here = share(chart)
    assert abs(here.value - fine.value) < 3 * here.error
    assert len(bands(chart, (0.0, 0.2, 0.4, 0.501), along="y")) == 3


def test_changes_count_beyond_their_errors() -> None:
    clear = [Share(1.0, 0.1), Share(2.0, 0.1), Share(3.0, 0.1)]
    assert steps(clear) == [1, 1] and steps(clear[::-1]) == [-1, -1]
    assert change(Share(10.7, 0.2), Share(11.0, 0.2)) == 0


def test_rising_in_wide_bands_and_not_in_narrow_ones(chart: StabilityChart) -> None:
    """Stripes whose pairs grow from left to right while every other one is empty."""
    x = np.linspace(0, 1, 200, endpoint=False)
    part = np.select([x < 0.25, x < 0.5, x < 0.75], [0.1, 0.0, 0.4], 0.0)
    rows = np.arange(100)[:, None] / 100
    stripes = with_region(chart, rows < part)
    ends = (1.4, 1.6, 1.801)
    wide, narrow = in_bands("stripes", stripes, ends, along="x")
    assert (wide.says, narrow.says) == (1, 0)
    steady = with_region(chart, rows < x)
    assert [r.says for r in in_bands("steady", steady, ends, along="x")] == [1, 1]
    assert [r.says for r in in_bands("falling", with_region(chart, rows < 1 - x), ends, along="x")] == [-1, -1]

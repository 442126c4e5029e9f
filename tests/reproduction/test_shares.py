"""What "more" and "less" mean: shares with sampling errors, labels that follow from them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import trunnion as tn
from trunnion.results.chart import StabilityChart
from trunnion.studies.result import ADDED, CONFIRMED, CORRECTED, UNDECIDED, Conclusion
from trunnion.studies.shares import Share, bands, change, judged, share, steps


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


def test_labels_follow_from_errors() -> None:
    clear = [Share(1.0, 0.1), Share(2.0, 0.1), Share(3.0, 0.1)]
    assert steps(clear) == [1, 1] and judged(steps(clear)) == CONFIRMED
    assert judged(steps(clear[::-1])) == CORRECTED
    assert change(Share(10.7, 0.2), Share(11.0, 0.2)) == 0
    assert judged([change(Share(10.7, 0.2), Share(11.0, 0.2))]) == UNDECIDED
    assert judged([1, 1, -1]) == UNDECIDED


def test_no_other_labels() -> None:
    assert Conclusion("A.", ADDED, "1").holds == ADDED
    with pytest.raises(ValueError, match="not decided"):
        Conclusion("A.", "holds for a lucky range", "1")

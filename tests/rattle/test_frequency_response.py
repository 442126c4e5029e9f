"""All methods through one call, and how far they are from the exact motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gears import HALF_GAP, dead_zone, gear_pair
from known_motions import DEAD_ZONE_FOLDS, DUFFING_FOLDS

import trunnion as tn
from trunnion.errors import InputError
from trunnion.motion.orbits.exact_orbit import piecewise_orbit
from trunnion.motion.orbits.frequency_response import compare_responses, frequency_response
from trunnion.motion.orbits.harmonic_balance import harmonic_balance
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator


@pytest.mark.parametrize("mean_force", [0.0, pytest.param(0.05, marks=pytest.mark.slow)])
@pytest.mark.slow
def test_exact_balance_and_sweeps_agree(mean_force: float) -> None:
    """On folds, on both motions at 0.8, on where a sweep of 0.01 rad/s jumps."""
    o = gear_pair(mean_force)
    options = {"sweep up": {"points": 101}, "sweep down": {"points": 101}}
    found = compare_responses(
        o, 0.3, 1.3, methods=("exact", "sweep up", "sweep down", "describing function"), options=options
    )
    exact = found["exact"]
    upper, lower = exact.folds()[:2]
    assert 0.87 < upper < 0.88 and found["sweep up"].folds()[0] == pytest.approx(0.87)
    down = found["sweep down"].folds()[0]
    assert down - 0.01 < lower < down
    balanced = frequency_response(o, 0.6, 1.3, method="harmonic balance", longest_step=0.03)
    assert balanced.folds() == pytest.approx((upper, lower), abs=2e-6)
    for start, _ in exact.detail.at(0.8):
        orbit = piecewise_orbit(o.but(frequency=0.8), start)
        point = harmonic_balance(
            o.as_system(), "frequency", 0.8, 0.801, start=orbit.start, harmonics=100, longest_step=1.0
        )
        assert point.branch.start[0] == pytest.approx(orbit.start, abs=1e-6)
        assert np.abs(point.branch.multipliers[0]) == pytest.approx(np.abs(orbit.multipliers), abs=1e-5)
    assert "harmonic balance" in str(balanced) and "fold at" in str(balanced)
    assert "describing function" in str(found)


def test_harmonic_balance_tends_to_the_exact_orbit() -> None:
    """The kinks make coefficients of x fall like k⁻⁴: the start converges like H⁻³ or better."""
    o, errors = dead_zone(), []
    orbit = piecewise_orbit(o, [0.4, 0.2])
    times = o.period * np.arange(512) / 512
    exact = orbit.motion(512)[1][:, 0]
    for h in (10, 40, 100):
        found = harmonic_balance(
            o.as_system(), "frequency", 0.6, 0.601, start=orbit.start, harmonics=h, longest_step=1.0
        )
        errors.append(float(np.abs(found.motion(0, 512)[:, 0] - exact).max()))
    assert len(times) == 512 and errors[-1] < 1e-6
    assert np.log(errors[0] / errors[-1]) / np.log(10) == pytest.approx(3.0, abs=0.4)


@pytest.mark.slow
def test_dead_zone_folds_by_both() -> None:
    exact = frequency_response(dead_zone(), 0.3, 1.3)
    assert sorted(exact.folds()) == pytest.approx(DEAD_ZONE_FOLDS, abs=6e-6)
    balanced = frequency_response(
        dead_zone(), 0.4, 0.9, method="harmonic balance", harmonics=60, begin=0.9, longest_step=0.03
    )
    assert sorted(balanced.folds()) == pytest.approx(DEAD_ZONE_FOLDS, abs=6e-6)


@pytest.mark.parametrize("method", ["harmonic balance", "shooting"])
def test_duffing_by_both(method: str) -> None:
    found = frequency_response(tn.reference_system("duffing"), 0.8, 1.6, method=method, longest_step=0.05)
    assert found.folds() == pytest.approx([f for f, _ in DUFFING_FOLDS], abs=1e-6)
    assert found.peak[1] > 2.5


def test_perturbation_finds_the_main_peak_and_not_the_small_ones() -> None:
    found = compare_responses(
        gear_pair(), 0.3, 0.95, methods=("exact", "describing function", "multiple scales"),
        options={"multiple scales": {"fit_range": 5 * HALF_GAP}},
    )  # fmt: skip
    exact, simple, scales = (found[m] for m in ("exact", "describing function", "multiple scales"))
    assert abs(simple.peak[1] / exact.peak[1] - 1) < 0.01 < abs(scales.peak[1] / exact.peak[1] - 1)
    low = [r.half_peak_to_peak[r.frequency < 0.4].max() for r in (exact, simple, scales)]
    assert low[0] > 0.19 and max(low[1:]) < 0.11


def test_isolated_branch_from_a_start() -> None:
    """The outer motion of a pair of attractors, begun inside the range and followed both ways."""
    whole = frequency_response(dead_zone(), 0.46, 0.7, begin=0.6, start=[0.4, 0.2])
    assert whole.frequency.min() < 0.6 < whole.frequency.max() and whole.half_peak_to_peak.max() > 0.6


def test_nothing_found_is_said() -> None:
    """A mean force that no spring carries drives the mass away: there is no motion to follow."""
    free = PiecewiseOscillator((0.0,), (1.0, 0.0), 0.01, 2.0, 1.0, 1.0)
    found = frequency_response(free, 0.5, 1.0, start=[5.0, 3.0])
    assert not found.outcome.ok and "no motion at frequency = 0.5 rad/s" in found.outcome.sentence
    assert "no frequency response by exact" in str(found)
    short = frequency_response(gear_pair(), 0.3, 1.3, most_points=5)
    assert not short.outcome.ok and "raise most_points" in short.outcome.sentence and len(short.frequency) == 6


def test_a_branch_that_cannot_go_on_keeps_what_it_has() -> None:
    """Undamped and linear towards its resonance at 1: the motion grows without bound, and the end says where."""
    o = PiecewiseOscillator((), (1.0,), 0.0, 0.0, 0.1)
    found = frequency_response(o, 0.6, 1.5, most_points=200)
    assert not found.outcome.ok and len(found.frequency) > 20
    assert 0.9 < found.frequency[-1] <= 1.0 and f"{found.frequency[-1]:.4g}"[:4] in found.outcome.sentence
    assert found.half_peak_to_peak[-1] == pytest.approx(0.1 / (1 - found.frequency[-1] ** 2), rel=1e-6)


def test_pictures_draw_what_is_there() -> None:
    found = compare_responses(gear_pair(), 0.5, 1.0, methods=("exact", "describing function", "sweep up"))
    axes = found.plot(length="rad")
    labels = [t.get_text() for t in axes.get_legend().get_texts()]
    assert {"exact", "describing function", "sweep up", "fold", "unstable"} <= set(labels)
    assert axes.get_ylabel() == "half peak-to-peak of x [rad]"
    styles = {line.get_linestyle() for line in axes.lines}
    assert {"-", "--"} <= styles and len(axes.texts) == 2
    assert found["exact"].data.attrs["method"] == "exact"


@pytest.mark.parametrize(
    ("system", "change", "words"),
    [
        (gear_pair(), {"method": "exakt"}, "is not a method for this; did you mean"),
        (gear_pair(), {"harmonics": 3}, "does not belong to this method; leave it out: it takes begin, start"),
        (gear_pair(), {"method": "sweep up", "fit_range": 3}, "it takes start, points, least, most"),
        (gear_pair(), {"method": "describing function", "points": 3}, "it takes none"),
        (tn.reference_system("duffing"), {"method": "averaging"}, "is not a method for this"),
        (tn.reference_system("lorenz"), {}, "name the one that is the frequency"),
        (
            gear_pair().but(damping_law="in contact"),
            {"method": "harmonic balance"},
            "is neither a spring nor a constant",
        ),
        (gear_pair(), {"method": "harmonic balance", "harmonics": 0}, "must be 1 or more"),
    ],
)
def test_refusals(system: Any, change: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as caught:
        frequency_response(system, 0.5, 1.0, **change)
    assert words in str(caught.value)

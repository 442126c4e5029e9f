"""Certificates about the periodic motion that a free–free line with joint angles makes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import trunnion as tn

TUG = tn.load(Path(__file__).parents[2] / "examples" / "harbour-tug.toml")


@pytest.mark.slow
def test_what_is_proved_is_the_decay_about_the_motion_itself() -> None:
    speed = 94.0
    found = tn.certify_stability(TUG, {}, (speed, speed * (1 + 1e-9)))
    own = tn.stability(TUG, speed)
    rate = -np.log(own.spectral_radius) * speed / own.period
    assert found.verdict == "proved stable" and found.about_own_motion
    assert 0.9 * rate < found.decay <= rate * (1 + 1e-4)


@pytest.mark.slow
def test_a_range_of_speeds_is_proved() -> None:
    found = tn.certify_stability(TUG, {}, (90.0, 90.3))
    assert found.verdict == "proved stable" and found.undecided_share == 0
    assert "about the line's own periodic motion, proved to exist" in str(found)

"""The gear pair of the rattle paper swept up and down: its jumps, its contacts, its basins."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gears import HALF_GAP, gear_pair

from trunnion.errors import InputError
from trunnion.motion.orbits.basins import basins
from trunnion.motion.orbits.periodic_branch import piecewise_branch
from trunnion.motion.orbits.sweep import rattle_index, sweep
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

FREQUENCIES = np.arange(30, 131) / 100
PEAK = {0.0: 0.6941, 0.05: 0.6932}
"""Half peak-to-peak of the up-sweep at ω = 0.87."""
JUMP_UP = {0.0: (0.65, 0.64), 0.05: (0.76, 0.75)}
AT_08 = {0.0: (0.52172, 0.07652), 0.05: (0.51880, 0.17464)}


@pytest.mark.parametrize("mean_force", [0.0, 0.05])
def test_hysteresis_of_the_paper(mean_force: float) -> None:
    up = sweep(gear_pair(mean_force), FREQUENCIES)
    down = sweep(gear_pair(mean_force), FREQUENCIES[::-1])
    best = int(np.argmax(up.peak_to_peak))
    assert up.frequency[best] == 0.87
    assert up.peak_to_peak[best] / 2 == pytest.approx(PEAK[mean_force], abs=1e-4)
    assert (0.87, 0.88) in up.jumps and JUMP_UP[mean_force] in down.jumps
    at = list(FREQUENCIES).index(0.8)
    both = up.peak_to_peak[at] / 2, down.peak_to_peak[100 - at] / 2
    assert both == pytest.approx(AT_08[mean_force], abs=1.1e-5)
    assert up.contact[at] == "two-sided" and up.impacts[at] == 2
    assert down.contact[100 - at] == ("none" if mean_force == 0 else "one-sided")


def test_the_swept_motions_lie_on_the_exact_branch() -> None:
    up = sweep(gear_pair(), FREQUENCIES[FREQUENCIES > 0.47])
    branch = piecewise_branch(gear_pair(), 0.3, 1.3, longest_step=0.003)
    for i in np.flatnonzero(up.settled)[::6]:
        near = [np.abs(start - up.state[i]).max() for start, _ in branch.at(float(up.frequency[i]))]
        assert min(near) < 1e-3


def test_basins() -> None:
    found = basins(gear_pair(0.0), np.linspace(-1, 1, 15), np.linspace(-1, 1, 15))
    assert sorted(a.peak_to_peak / 2 for a in found.attractors) == pytest.approx(sorted(AT_08[0.0]), abs=1e-5)
    assert found.shares.sum() == pytest.approx(1.0) and found.shares.min() > 0.05
    # The equations with no mean force are mirrored by half a period; near each attractor one is drawn to it.
    for number, orbit in enumerate(found.attractors):
        near = basins(gear_pair(0.0), [orbit.start[0] + 1e-3], [orbit.start[1]])
        assert near.attractors[0].peak_to_peak == pytest.approx(orbit.peak_to_peak)
        assert (found.number == number).any()
    assert "2 attractors" in str(found)


def test_rattle_index_is_zero_without_impacts() -> None:
    index = rattle_index(gear_pair(0.0), FREQUENCIES[::5])
    quiet = index.sel(direction="down", frequency=0.8)
    loud = index.sel(direction="up", frequency=0.8)
    assert float(quiet.impact_energy) == 0 and float(quiet.impacts) == 0
    assert float(loud.impact_energy) > 0.05
    # Two equal impacts at the gap's ends, where the speed follows from energy and impulse: Σv²/2 = (Σ|v|)²/4.
    assert float(loud.impact_energy) == pytest.approx(float(loud.impact_impulse) ** 2 / 4, rel=1e-6)


def test_no_contact_possible() -> None:
    """A force too weak to cross a soft gap: no contact anywhere, and the sweep says so."""
    quiet = PiecewiseOscillator.gap(HALF_GAP, inside=0.25, damping=0.05, force=1e-4)
    up = sweep(quiet, FREQUENCIES[::10])
    assert set(up.contact) == {"none"} and up.jumps == () and not up.impacts.any()
    assert "11 none, 0 one-sided, 0 two-sided" in str(up)


def test_dataset() -> None:
    up = sweep(gear_pair(), [0.8, 0.85])
    data = up.data
    assert data.attrs["direction"] == "up" and data.frequency.attrs["units"] == "rad/s"
    np.testing.assert_allclose(data.peak_to_peak, data.highest - data.lowest)


@pytest.mark.parametrize(
    ("frequencies", "options", "words"),
    [
        ([], {}, "must be positive numbers"),
        ([0.0, 1.0], {}, "must be positive numbers"),
        ([1.0], {"least": 9, "most": 3}, "must be 1 or more, and not less than least"),
    ],
)
def test_refusals(frequencies: Any, options: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        sweep(gear_pair(), frequencies, **options)
    with pytest.raises(InputError, match="grow without bound"):
        sweep(PiecewiseOscillator((), (1.0,), 0.0, 0.0, 1.0), [0.5, 1.0])

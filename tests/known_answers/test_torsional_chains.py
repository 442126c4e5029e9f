"""Natural frequencies of free torsional lines; printed ones stand in ``tests/published``."""

from __future__ import annotations

import numpy as np
import pytest
from published.cases.chains import chain, geared_branch

import trunnion as tn


def test_the_rigid_body_of_a_free_line() -> None:
    modes = tn.natural_frequencies(chain([3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05], [12e3, 12e3, 14e3, 10e3]))
    assert modes.rigid_body and modes.frequency[0] == 0.0
    assert np.ptp(modes.shape[:, 0]) < 1e-6
    assert np.abs(modes.damping_ratio).max() < 1e-15
    assert tn.natural_frequencies(geared_branch()).rigid_body


def test_modes_of_a_geared_pair_by_hand() -> None:
    """k between J₁ and J₂ behind a ratio of 3: J₂ weighs J₂/9 and k weighs itself in front of it."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=2.0),
            tn.Shaft(stiffness=50.0, damping=0.1),
            tn.Disk(inertia=1e-9),
            tn.Ratio(ratio=3.0),
            tn.Disk(inertia=9.0),
        ]
    )
    modes = tn.natural_frequencies(line)
    undamped, ratio = modes.undamped_frequency[1], modes.damping_ratio[1]
    assert undamped == pytest.approx(np.sqrt(50.0 * (1 / 2.0 + 1 / 1.0)), rel=1e-8)
    assert ratio == pytest.approx(0.1 / 50.0 * undamped / 2, rel=1e-8)
    assert modes.frequency[1] == pytest.approx(undamped * np.sqrt(1 - ratio**2), rel=1e-12)


def test_without_damping_every_ratio_is_exactly_zero() -> None:
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=1e4),
        tn.Disk(inertia=1.0),
        tn.Shaft(stiffness=1e4),
        tn.Disk(inertia=1.0),
    ]
    found = tn.natural_frequencies(tn.Driveline(parts))
    assert not found.damping_ratio.any() and "damping ratio 0" in str(found)

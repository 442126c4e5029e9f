"""The linear steady response is the limit of the nonlinear motion: as all that shakes a line shrinks together, their
difference falls with the square, on lines of every structure.

Excitations and errors of teeth fall with the scale and joint angles with its root, so that what they force falls with
the scale; order by order, phases included, at the speed that a free line keeps.
"""

from __future__ import annotations

import numpy as np
import pytest
from oracles.shaken_lines import KINDS, shaken_line

import trunnion as tn

LARGE, SMALL = 2.0**-8, 2.0**-18
ACCURACY = 1e-8
"""Share of the largest order, at the smaller scale some 1e-7 rad, below which a difference is the accuracy of the
nonlinear motion: of line 51 it falls by 2.00 octaves an octave to 2⁻¹⁴ and there stays at 1e-11 N m."""


def exponent_and_share(seed: int) -> tuple[float, float]:
    """Exponent of the difference between two scales, and its share of the largest order at the smaller."""
    speed = float(np.random.default_rng(1000 + seed).uniform(25, 60))
    checks = [tn.linearity_check(shaken_line(seed, scale), speed, tolerance=1e-13) for scale in (LARGE, SMALL)]
    assert all(check.nonlinear.outcome.ok for check in checks)
    large, small = (float(check.difference.max()) for check in checks)
    return float(np.log(large / small) / np.log(LARGE / SMALL)), checks[1].departure


def check_square(seed: int) -> None:
    exponent, share = exponent_and_share(seed)
    assert share < 1e-5
    assert exponent > 1.95 or share < ACCURACY


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_the_difference_falls_with_the_square(seed: int) -> None:
    check_square(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(len(KINDS), 112))
def test_the_difference_falls_with_the_square_on_a_hundred_lines(seed: int) -> None:
    check_square(seed)


@pytest.mark.parametrize("first", [{}, {"excitation": [{"order": 1, "amplitude": 10.0}]}])
@pytest.mark.parametrize("play", [False, True])
def test_disks_that_are_rigidly_joined_keep_their_own_excitations(first: dict[str, object], play: bool) -> None:
    """Two disks at one place are one disk of both inertias, shaken by both; in every set of equations."""
    second = {"excitation": [{"order": 3, "amplitude": 40.0, "phase": 0.4}]}
    both = {"excitation": [*first.get("excitation", []), *second["excitation"]]}  # type: ignore[misc]
    soft = tn.PiecewiseShaft.symmetric([(5e3, 0.01), (2e4, None)], damping=3.0) if play else None
    behind = [soft or tn.Shaft(stiffness=1e4, damping=3.0), tn.Disk(inertia=0.5, load_torque=5.0)]
    front = [tn.ConstantSpeed(), tn.Shaft(stiffness=2e4, damping=5.0)]
    two = tn.Driveline([*front, tn.Disk(inertia=0.1, **first), tn.Disk(inertia=0.2, **second), *behind])
    one = tn.Driveline([*front, tn.Disk(inertia=0.3, **both), *behind])
    found, expected = (tn.order_response(line, [40.0]) for line in (two, one))
    assert list(found.order) == list(expected.order)
    assert found.torque == pytest.approx(expected.torque, rel=1e-12)
    motions = [tn.periodic_response(line, 40.0).torque_peak_to_peak for line in (two, one)]
    assert motions[0] == pytest.approx(motions[1], rel=1e-9)

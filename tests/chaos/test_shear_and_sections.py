"""What a regular motion's shear may pretend, and sections of motions whose states are all angles."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn


def pendulum(t, x, p):  # type: ignore[no-untyped-def]
    return x[1], -np.sin(x[0]) + 0.02 * np.cos(1.7 * t)


def labyrinth(t, x, p):  # type: ignore[no-untyped-def]
    return np.sin(x[1]), np.sin(x[2]), np.sin(x[0])


@pytest.mark.slow
def test_the_interval_of_a_regular_conservative_motion_holds_zero() -> None:
    """x″ + sin x = 0.02 cos 1.7t from (0.5, 0): 2.2e-4 ± 4e-5 by batch means, which is ln T / T and no exponent."""
    system = tn.System.from_function(
        pendulum, ("x", "v"), period=2 * np.pi / 1.7, start=(0.5, 0.0), divergence=0.0, name="pendulum"
    )
    found = tn.certify_chaos(system, 2000, starts=1, sweep=False)
    assert str(found.verdict) == "regular"
    assert np.all(found.spectrum.exponents - found.spectrum.half_width <= 0)
    assert np.all(found.spectrum.exponents + found.spectrum.half_width >= 0)
    assert not found.spectrum.positive and not found.criteria[0].holds


def test_the_interval_of_a_chaotic_motion_is_what_it_was() -> None:
    found = tn.lyapunov_spectrum(tn.reference_system("ueda"), 2000, starts=1)
    assert found.positive and found.half_width[0] < 0.2 * found.largest


@pytest.mark.slow
def test_a_motion_of_angles_alone_has_a_map() -> None:
    """Thomas's labyrinth, undamped: chaotic, its angles wander for ever."""
    system = tn.System.from_function(labyrinth, ("x", "y", "z"), start=(0.1, 0.0, 0.2), divergence=0.0)
    found = tn.certify_chaos(system, duration=4000.0, starts=1, sweep=False)
    assert found.map is not None and found.map.outcome.ok and len(found.map.points) >= 200
    assert str(found.verdict) == "chaotic"

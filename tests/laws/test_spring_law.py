"""The law of springs with stages: continuous, nothing at rest, its slope and energy those of its force."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import trunnion as tn
from trunnion.laws.spring import StageSpring

SPRINGS = (
    StageSpring(np.array([-0.2, 0.1, 0.4]), np.array([3.0, 0.0, 1.0, 2.0])),
    StageSpring(np.array([0.3, 0.7]), np.array([2.0, 5.0, 0.5])),
    StageSpring(np.array([-0.9, -0.4]), np.array([4.0, 1.0, 2.0])),
    StageSpring(np.zeros(0), np.array([7.0])),
)


@pytest.mark.parametrize("spring", SPRINGS)
def test_force_slope_and_energy_belong_together(spring: StageSpring) -> None:
    x = np.linspace(-1.5, 1.5, 41) + 1e-3
    assert spring.force(0.0) == 0 and spring.force(x).shape == x.shape
    h = 1e-7
    np.testing.assert_allclose((spring.force(x + h) - spring.force(x - h)) / (2 * h), spring.slope(x), atol=1e-6)
    for knot, force in zip(spring.knots, spring.at_knots, strict=True):
        np.testing.assert_allclose(spring.force([knot - 1e-12, knot + 1e-12]), force, atol=1e-10)
    for end in (-1.2, 0.05, 1.3):
        work, _ = quad(spring.force, 0.0, end, points=[k for k in spring.knots if 0 < k / end < 1] or None)
        assert spring.energy(np.array([end]))[0] == pytest.approx(work, abs=1e-12)


@pytest.mark.parametrize("spring", SPRINGS)
def test_the_stage_under_a_force_carries_it(spring: StageSpring) -> None:
    for force in (-2.3, -0.4, 0.2, 1.9):
        stage = spring.stage_under(force)
        if spring.slopes[stage] > 0:
            x = (force - spring.offsets[stage]) / spring.slopes[stage]
            assert spring.force(x) == pytest.approx(force, abs=1e-12)


def test_cases_stand_side_by_side() -> None:
    """A law of two cases is two laws."""
    knots, slopes = np.array([[-0.1, 0.2], [-0.3, 0.3]]), np.array([[2.0, 0.0, 3.0], [5.0, 1.0, 5.0]])
    both, forces = StageSpring(knots, slopes), np.array([0.6, -1.4])
    for case in range(2):
        one = StageSpring(knots[case], slopes[case])
        np.testing.assert_allclose(both.offsets[case], one.offsets, atol=1e-15)
        np.testing.assert_allclose(both.force(np.array([0.5, 0.5]))[case], one.force(0.5))
        assert both.stage_under(forces)[case] == one.stage_under(forces[case])


def test_an_oscillator_rests_where_its_spring_carries_the_mean() -> None:
    o = tn.PiecewiseOscillator((-0.2, 0.1, 0.4), (3.0, 0.0, 1.0, 2.0), mean_force=0.15)
    assert o.restoring(o.equilibrium()) == pytest.approx(0.15)
    free = tn.PiecewiseOscillator((0.5,), (0.0, 2.0))
    assert free.restoring(free.equilibrium()) == 0
    with pytest.raises(tn.InputError, match="is carried by no spring"):
        tn.PiecewiseOscillator((0.5,), (0.0, 2.0), mean_force=-1.0).equilibrium()

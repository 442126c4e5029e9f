"""Maps over a period: integrated and exact ones agree, their derivatives are those of differences, orbits close."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.errors import InputError
from trunnion.motion.orbits.exact_map import OscillatorMap
from trunnion.steady.shooting.shooting_problem import Phase, ShootingProblem, close
from trunnion.systems.maps import IntegratedMap, TimedMap

OSCILLATOR = tn.PiecewiseOscillator.gap(1.0, damping=0.1, mean_force=0.1, force=0.05, frequency=0.6)
START = np.array([0.4, 0.2])
VAN_DER_POL_PERIOD = 6.6632868593231302
"""Of x″ − (1 − x²) x′ + x = 0, by high-precision series."""


def integrated(periods: int = 1) -> IntegratedMap:
    system = OSCILLATOR.as_system()
    return IntegratedMap(lambda w: system.but(frequency=w), (0.6,), (1e-4,), periods=periods, tolerance=1e-12)


def van_der_pol() -> tn.System:
    return tn.System.from_function(
        lambda t, x, p: (x[1], (1 - x[0] ** 2) * x[1] - x[0]), ["x", "v"], start=[2.0, 0.0], compiled=False
    )


@pytest.mark.parametrize("periods", [1, 3])
def test_integrated_and_exact_maps_agree(periods: int) -> None:
    """Two ways to one motion, through the gap and out of it again: state, tangents, slope by the frequency, changes."""
    smooth = integrated(periods)(START, by=(0,))
    exact = OscillatorMap.of(OSCILLATOR, periods)(START, by=(0,))
    assert smooth.done and exact.done and smooth.changes == exact.changes > 0
    np.testing.assert_allclose(smooth.state, exact.state, atol=1e-10)
    np.testing.assert_allclose(smooth.tangents, exact.tangents, atol=1e-8)
    np.testing.assert_allclose(smooth.by_values, exact.by_values, rtol=1e-5, atol=1e-6)


def test_both_settle_and_close_on_one_orbit() -> None:
    maps = integrated(), OscillatorMap.of(OSCILLATOR)
    ends = [place.settle(START, 40) for place in maps]
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-6)
    scale = np.array([1.0, 0.6])
    roots = [close(START, lambda guess, place=place: ShootingProblem(place, scale))[1] for place in maps]
    assert all(root.converged for root in roots)
    np.testing.assert_allclose(roots[0].x, roots[1].x, atol=1e-10)


def test_the_time_of_an_autonomous_map_is_a_value_of_it() -> None:
    system = van_der_pol()
    place = TimedMap.over(system, 6.0, tolerance=1e-12)
    found = place(START, by=(0,))
    ahead, behind = (place.at(6.0 + h)(START, tangents=False).state for h in (1e-5, -1e-5))
    np.testing.assert_allclose(found.by_values[:, 0], (ahead - behind) / 2e-5, rtol=1e-6)


@pytest.mark.slow
def test_a_phase_condition_finds_the_period_of_a_limit_cycle() -> None:
    system, scale = van_der_pol(), np.ones(2)
    place = TimedMap.over(system, 6.5, tolerance=1e-12)

    def held(guess: np.ndarray) -> ShootingProblem[TimedMap]:
        return ShootingProblem(place, np.append(scale, 6.5), Phase.held(1, 0.0, scale), 1e-9)

    _, root = close(np.array([2.0, 0.0]), held, (6.5,))
    assert root.converged and abs(root.x[1]) < 1e-9
    assert root.x[2] == pytest.approx(VAN_DER_POL_PERIOD, abs=1e-9)


def test_values_that_are_none_are_no_motion() -> None:
    place = OscillatorMap.of(OSCILLATOR)
    with pytest.raises(InputError, match="must be positive"):
        place.at(-1.0)
    left, slope = ShootingProblem(place, np.ones(3)).equations(np.array([*START, -1.0]))
    assert np.isnan(left).all() and np.isnan(slope).all()
    with pytest.raises(InputError, match="is autonomous and has no forcing period"):
        _ = IntegratedMap.of(van_der_pol()).length

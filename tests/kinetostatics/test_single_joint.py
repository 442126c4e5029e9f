"""One Hooke's joint against its closed forms, and against the numbers engineers know."""

import lines
import numpy as np
import pytest

import trunnion as tn
from trunnion.response.kinetostatics import equivalent_angle
from trunnion.response.kinetostatics.measures import extremes

KNOWN = {  # degrees: lag [deg], largest acceleration over speed squared
    10: (0.4386, 0.030626),
    20: (1.7817, 0.124966),
    30: (4.1172, 0.294571),
    45: (9.8793, 0.787200),
}


@pytest.mark.parametrize("degrees", KNOWN)
def test_ratio_lag_and_acceleration(degrees):
    result = tn.kinetostatics(lines.row([degrees]), speed=2.0)
    lag, acceleration = KNOWN[degrees]
    beta = np.radians(degrees)
    slow, fast = result.speed_ratio
    assert slow == pytest.approx(np.cos(beta), rel=1e-9)
    assert fast == pytest.approx(1 / np.cos(beta), rel=1e-9)
    assert np.degrees(result.homokinetic_deviation) == pytest.approx(lag, abs=5.1e-5)
    assert result.peak_acceleration / 4 == pytest.approx(acceleration, abs=6e-7)
    assert result.irregularity == pytest.approx(np.tan(beta) * np.sin(beta), rel=1e-9)
    assert result.equivalent_angle == pytest.approx(beta, rel=1e-9)


def test_irregularity_at_three_degrees():
    assert tn.kinetostatics(lines.row([3])).irregularity == pytest.approx(0.00274, abs=5e-6)


def test_hundred_rpm_of_twelve_hundred():
    """1200 rpm that swing by 100 rpm in all are one joint of 16.42°."""
    assert np.degrees(equivalent_angle(100 / 1200)) == pytest.approx(16.42, abs=0.005)


def test_lag_does_not_depend_on_where_the_turn_starts():
    lags = [tn.kinetostatics(lines.row([30], offsets=[x])).homokinetic_deviation for x in (0, 17, 45, 80)]
    assert np.ptp(lags) < 1e-9


def test_secondary_couples_are_tan_theta_of_the_torque():
    """S2's (4): M tan θ with tan θ₁ = tan β sin χ and tan θ₂ = sin β cos χ/√(1 − sin²β cos²χ)."""
    beta = np.radians(25)
    result = tn.kinetostatics(lines.row([25], load=80.0))
    chi = result.joint_angle[0]
    first = result.joint_torque_in[0] * np.tan(beta) * np.abs(np.sin(chi))
    second = 80.0 * np.abs(np.sin(beta) * np.cos(chi) / np.sqrt(1 - (np.sin(beta) * np.cos(chi)) ** 2))
    size = np.hypot(result.secondary_couple[:, 0], result.secondary_couple[:, 1])
    assert np.allclose(size, [first, second], rtol=0, atol=1e-12)


def test_couple_is_half_steady_and_half_twice_per_turn():
    """For a small angle −½ M tan β stands still and as much turns at twice the speed, forwards."""
    result = tn.kinetostatics(lines.row([2], load=100.0))
    for fork in result.forks:
        part = result.couple_parts(fork)
        half = 50 * np.tan(np.radians(2))
        assert part.steady[0] == pytest.approx(-half, rel=1e-3)
        assert part.twice == pytest.approx(half, rel=1e-3)
        assert abs(part.steady[1]) < 1e-10
        assert part.once < 1e-10
        assert part.twice_back < 1e-3 * half


def test_two_bearings_carry_the_couple_over_their_distance():
    result = tn.kinetostatics(lines.row([20], load=100.0), supports=[("Shaft 1", -0.5, -0.1), ("Shaft 2", 0.1, 0.3)])
    couple = np.hypot(result.secondary_couple[:, 0], result.secondary_couple[:, 1])
    force = np.hypot(result.supports.force[:, 0], result.supports.force[:, 1])
    assert np.allclose(force[:2], couple[0] / 0.4, rtol=1e-12)
    assert np.allclose(force[2:], couple[1] / 0.2, rtol=1e-12)
    assert np.allclose(result.supports.force[0], -result.supports.force[1])
    assert result.supports.idle == ("HookeJoint 1",)


@pytest.mark.parametrize("degrees", [5, 20, 45, 60])
@pytest.mark.parametrize(("points", "error"), [(180, 2e-8), (720, 1e-12)])
def test_extremes_between_samples(degrees, points, error):
    """Wherever the samples fall, the extremes of a ratio are cos β and 1/cos β."""
    cosine = np.cos(np.radians(degrees))
    start = np.linspace(0, 2 * np.pi / points, 17)[:, None]
    turn = start + 2 * np.pi * np.arange(points) / points
    low, high = extremes(cosine / (1 - (1 - cosine**2) * np.cos(turn) ** 2))
    assert np.abs(low - cosine).max() < error and np.abs(high - 1 / cosine).max() < error


def test_extremes_beside_a_corner_keep_to_the_samples():
    """|sin| has its least value at a corner, which no smooth curve through the samples knows."""
    turn = 0.003 + 2 * np.pi * np.arange(720) / 720
    low, high = extremes(np.abs(np.sin(turn)))
    assert 0 <= low <= np.abs(np.sin(turn)).min() and high == pytest.approx(1, abs=1e-12)


def test_extremes_of_a_curve_that_does_not_close():
    low, high = extremes(np.linspace(0.0, 1.0, 100))
    assert (low, high) == (0.0, 1.0)

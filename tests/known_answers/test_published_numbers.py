"""Published numbers of one joint and of chaotic flows, each with its source and precision."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.systems.reference import rossler, ueda


def test_compound_angle_of_a_drawing() -> None:
    """Spicer (Dana), operating-angle worksheet: 2.15° and 2.50° in the two views make 3.3°, to 0.05°."""
    angle, _ = tn.combined_angle("2.15 deg", "2.50 deg")
    assert np.degrees(angle) == pytest.approx(3.3, abs=0.05)


def one_joint(degrees: float, speed: float) -> tn.Kinetostatics:
    line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=tn.deg(degrees)), tn.Disk(inertia=1.0)])
    return tn.kinetostatics(line, speed=speed)


def test_uniformity_guideline() -> None:
    """Elbe, catalogue of cardan shafts: U ≤ 0.0027, which is one joint of 2.98° (to 0.01°)."""
    assert one_joint(2.98, 1.0).irregularity == pytest.approx(0.0027, abs=2e-5)


def test_speed_fluctuation_at_1200_rpm() -> None:
    """A maker's example: 16.42° at 1200 rpm makes the output run between 1151 and 1251 rpm, 100 rpm apart."""
    speed = one_joint(16.42, tn.rpm(1200)).output_speed / tn.rpm(1)
    assert (speed.min(), speed.max()) == (pytest.approx(1151, abs=0.5), pytest.approx(1251, abs=0.5))


def test_acceleration_behind_a_joint_of_ten_degrees() -> None:
    """SDP/SI, handbook D200, T62 (read at sdp-si.com): 10° at 250 rpm, 0.0306 times ω², 21.0 rad/s², and on its disk of
    0.0233 in lb s² a torque of 0.489 in lb; three figures. The table is Baranyi's, Design News, 1 September 1969."""
    turn = one_joint(10.0, tn.rpm(250))
    assert turn.peak_acceleration / tn.rpm(250) ** 2 == pytest.approx(0.0306, abs=5e-5)
    assert turn.peak_acceleration == pytest.approx(21.0, abs=0.05)
    assert turn.peak_acceleration * 0.0233 == pytest.approx(0.489, abs=5e-4)


def sprott_jerk() -> tn.System:
    """x‴ + A x″ − x′² + x = 0 with A = 2.017 (Sprott, Phys. Lett. A 228, 1997)."""

    def rate(t, x, p):  # type: ignore[no-untyped-def]
        return x[1], x[2], -x[0] + x[1] * x[1] - p.a * x[2]

    return tn.System.from_function(rate, ["x", "y", "z"], parameters={"a": 2.017}, start=[0.02, 0.0, 0.0], name="jerk")


@pytest.mark.slow
def test_exponents_of_sprotts_jerk() -> None:
    """Sprott, Chaos and Time-Series Analysis, p. 437: 0.0551, 0, −2.0721, to the last digit; the sum is −A."""
    found = tn.lyapunov_spectrum(sprott_jerk(), duration=8000.0, starts=1, tolerance=1e-8)
    assert found.exponents == pytest.approx([0.0551, 0.0, -2.0721], abs=4e-3)
    assert found.sum == pytest.approx(-2.017, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("b", "published", "precision"),
    [(0.2, (0.0729, 0.0), (0.004, 0.002)), (1.2, (0.0, -0.1155), (0.001, 0.0005))],
    ids=["chaotic", "periodic"],
)
def test_exponents_of_rossler(b: float, published: tuple[float, ...], precision: tuple[float, ...]) -> None:
    """(0.2, b, 5.7), a public run of ChaosTools over a time of 10 000 (discourse.julialang.org, 116523).

    Of the chaotic motion Sprott's book has 0.0714, 0, −5.3943. The run's third exponents, −5.1450 and −5.1575, are left
    out: their sums miss the mean divergence of these motions, which ours meet.
    """
    found = tn.lyapunov_spectrum(rossler(b=b), duration=10_000.0, start=[6.0, 6.0, 6.0], starts=1)
    assert np.all(np.abs(found.exponents[:2] - published) < precision)
    assert found.sum_error < 1e-6 * abs(found.sum)


@pytest.mark.slow
def test_of_two_published_spectra_of_uedas_oscillator_one_is_excluded() -> None:
    """0.1034, −0.1534 (Sprott's book) and 0.0999, −0.1499 have the same sum; a long run tells them apart."""
    found = tn.lyapunov_spectrum(ueda(), periods=20_000)
    assert found.sum == pytest.approx(-0.05, abs=1e-9)
    assert abs(found.exponents[0] - 0.1034) < 2 * found.half_width[0]
    assert found.exponents[0] - 0.0999 > 1.5 * found.half_width[0]

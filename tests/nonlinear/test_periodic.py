"""Periodic motions: known orbits, agreement with linear theory, with long simulations and with Liouville."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jointed_lines import three_shafts, two_shafts
from known_motions import (
    DEAD_ZONE_INNER,
    DEAD_ZONE_MULTIPLIER,
    DEAD_ZONE_OUTER,
    DEAD_ZONE_PEAK_TO_PEAK,
    DUFFING_LOWER,
    DUFFING_UPPER,
    DUFFING_UPPER_LARGEST,
)

import trunnion as tn
from trunnion.results.verdict import Verdict

SPEED = 60.0


def test_duffings_two_branches() -> None:
    system = tn.reference_system("duffing")
    lower = tn.periodic_response(system, start=[0.0, 0.0])
    upper = tn.periodic_response(system, start=[2.5, 0.0])
    assert abs(lower.harmonics(1)[1, 0]) == pytest.approx(DUFFING_LOWER, abs=6e-8)
    assert abs(upper.harmonics(1)[1, 0]) == pytest.approx(DUFFING_UPPER, abs=6e-8)
    assert upper.peak_to_peak[0] / 2 == pytest.approx(DUFFING_UPPER_LARGEST, abs=6e-8)
    assert lower.verdict is upper.verdict is Verdict.STABLE
    assert "stable periodic motion of duffing" in str(upper)
    between = tn.periodic_response(system, start=[-0.9, 1.3], settle=False)
    if between.outcome.ok:
        assert between.liouville_defect < 1e-9


def test_linear_oscillator_in_closed_form() -> None:
    """Amplitude, phase and multipliers of x″ + 0.1x′ + x = cos 0.9t."""
    orbit = tn.periodic_response(tn.reference_system("linear-oscillator", frequency=0.9))
    exact = 1 / (1 - 0.81 + 0.09j)
    assert orbit.harmonics(1)[1, 0] == pytest.approx(exact, abs=1e-10)
    assert orbit.peak_to_peak[0] == pytest.approx(2 * abs(exact), abs=1e-9)
    root = np.exp((-0.05 + 1j * np.sqrt(1 - 0.05**2)) * orbit.period)
    assert np.abs(orbit.multipliers - root).min() < 1e-10
    assert orbit.error_estimate < 1e-8
    assert np.abs(np.abs(orbit.multipliers) - abs(root)).max() <= orbit.error_estimate


def test_dead_zone_orbits() -> None:
    for start, peak in zip((DEAD_ZONE_OUTER, DEAD_ZONE_INNER), DEAD_ZONE_PEAK_TO_PEAK, strict=True):
        orbit = tn.periodic_response(tn.reference_system("dead-zone-oscillator"), start=np.round(start, 1))
        np.testing.assert_allclose(orbit.start, start, atol=1e-9)
        assert orbit.peak_to_peak[0] == pytest.approx(peak, abs=6e-8)
        assert orbit.liouville_defect < 1e-9
        assert orbit.regime_changes == (0 if start is DEAD_ZONE_OUTER else 2)
    assert np.abs(orbit.multipliers - DEAD_ZONE_MULTIPLIER).min() < 6e-6


@pytest.mark.slow
def test_autonomous_orbit() -> None:
    """Van der Pol at μ = 1: the period of the literature and the trivial multiplier, set aside."""
    system = tn.System.from_function(
        lambda t, x, p: (x[1], p.mu * (1 - x[0] ** 2) * x[1] - x[0]),
        ["x", "v"],
        parameters={"mu": 1.0},
        jacobian=lambda t, x, p: np.array([[0.0, 1.0], [-2 * p.mu * x[0] * x[1] - 1, p.mu * (1 - x[0] ** 2)]]),
    )
    orbit = tn.periodic_response(system, start=[2.0, 0.1], period=6.5)
    assert orbit.period == pytest.approx(6.6632868593231301, abs=1e-9)
    assert np.abs(orbit.multipliers - 1).min() < 1e-9
    assert orbit.spectral_radius == pytest.approx(0.000860, abs=1e-5) and orbit.verdict is Verdict.STABLE
    assert orbit.liouville_defect < 1e-6


def test_subharmonic_motion() -> None:
    """A third-order subharmonic of Duffing's oscillator, found as such and of no shorter period."""
    system = tn.reference_system("duffing", damping=0.01, cubic=1.0, force=5.0, frequency=4.5)
    orbit = tn.periodic_response(system, start=[1.0, 0.0], periods=3)
    assert orbit.outcome.ok
    assert orbit.period == pytest.approx(3 * system.forcing_period)


def response(**line: Any) -> Any:
    return tn.periodic_response(two_shafts(**line), SPEED)


def test_small_angles_give_the_linear_forced_response() -> None:
    """Amplitude ∝ β²; the joint sees its own response, of order β², so the linear one is right to β⁴."""
    angles = np.array([2.0, 4.0, 8.0])
    shares, differences = [], []
    for angle in angles:
        found = response(angle=float(angle))
        assert found.comparison is not None
        shares.append(found.torque_peak_to_peak / angle**2)
        linear = found.comparison.static_twist.response.torque[:-1]
        second = 2 * np.abs(np.fft.rfft(linear, axis=0))[1] / len(linear)
        differences.append(float(np.max(np.abs(found.order_spectrum(2)[1][1] / second - 1))))
    assert np.abs(shares[0] / shares[2] - 1).max() < 0.02
    assert differences[0] < 1e-6
    slope = np.polyfit(np.log(angles), np.log(differences), 1)[0]
    assert slope == pytest.approx(4.0, abs=0.05)


@pytest.mark.parametrize("line", [two_shafts(load=60.0), two_shafts(angle=25.0), three_shafts(load=100.0)])
def test_a_long_simulation_settles_on_it(line: tn.Driveline) -> None:
    """To 1e-9 rad and N m/stiffness, from rest, after its transients."""
    found = tn.periodic_response(line, SPEED)
    assert found.verdict is Verdict.STABLE
    periods = int(np.ceil(26.0 / -(found.growth_rate * found.period)))
    run = tn.simulate(line, speed=SPEED, turns=periods * found.turns, tolerance=1e-12)
    np.testing.assert_allclose(run.final, found.orbit.start, atol=1e-9 * max(1.0, SPEED))
    last = np.linspace(run.end - found.period, run.end, 600)
    assert np.ptp(run.motion_at(last).torque, axis=0) == pytest.approx(found.torque_peak_to_peak, rel=1e-4)


@pytest.mark.parametrize("load", [0.0, 150.0])
def test_monodromy_determinant_is_the_divergence_integral(load: float) -> None:
    for line in (two_shafts(load=load), three_shafts(load=load), two_shafts(angle=30.0, load=load)):
        assert tn.periodic_response(line, 95.0, compare=False).orbit.liouville_defect < 1e-9


def test_multipliers_tend_to_the_linear_ones_as_the_fourth_power_of_the_angle() -> None:
    """Zero load: the true motion's multipliers differ from those about zero twist by O(β⁴)."""
    angles, distance = np.array([4.0, 6.0, 9.0, 13.0]), []
    for angle in angles:
        found = response(angle=float(angle))
        linear = tn.stability(two_shafts(angle=float(angle)), SPEED)
        pairs = np.abs(found.multipliers[:, None] - linear.multipliers[None, :]).min(axis=1)
        distance.append(pairs.max())
    slope = np.polyfit(np.log(angles), np.log(distance), 1)[0]
    assert slope == pytest.approx(4.0, abs=0.2)


def test_under_load_the_static_twist_linearisation_is_not_the_motion() -> None:
    """They differ at the order of load times β², and the comparison says by how much."""
    found = tn.periodic_response(three_shafts(load=400.0), 95.0)
    comparison = found.comparison
    assert comparison is not None
    by_static = abs(comparison.static_twist.growth_rate - found.growth_rate)
    assert by_static > 30 * found.orbit.error_estimate / found.period
    assert f"{comparison.zero_twist.growth_rate:+.6g}" in str(found)
    # Independent: growth of a small disturbance of the motion, integrated for fifty periods.
    kick = 1e-6 * np.real(
        np.linalg.eig(found.orbit.monodromy)[1][:, np.argmax(np.abs(np.linalg.eigvals(found.orbit.monodromy)))]
    )
    system, duration = found.orbit.system, 50 * found.period
    ends = [
        tn.simulate(system, duration, start=found.orbit.start + s * kick, tolerance=1e-13, dense=False).final
        for s in (1.0, -1.0)
    ]
    expected = np.linalg.matrix_power(found.orbit.monodromy, 50) @ kick
    np.testing.assert_allclose((ends[0] - ends[1]) / 2, expected, atol=2e-5 * np.abs(expected).max())


def test_orders_and_means() -> None:
    """Power balance fixes the mean torque; the joint excites even orders only; an order appears where it acts."""
    found = tn.periodic_response(two_shafts(load=60.0, excitation=[{"order": 1, "amplitude": 5.0}]), SPEED)
    assert found.turns == pytest.approx(1.0)
    orders, amplitude = found.order_spectrum(6)
    np.testing.assert_allclose(orders, np.arange(7))
    without = tn.periodic_response(two_shafts(load=60.0), SPEED)
    assert amplitude[1].min() > 1.0 and without.turns == pytest.approx(0.5)
    assert without.torque_mean[1] == pytest.approx(-60.0, abs=1e-9)
    plain_orders, plain = without.order_spectrum(6)
    np.testing.assert_allclose(plain_orders, [0, 2, 4, 6])
    np.testing.assert_allclose(plain[1], amplitude[2], rtol=1e-3)
    # Linear theory has the excitation as well.
    assert found.comparison is not None
    np.testing.assert_allclose(
        found.comparison.linear_torque_peak_to_peak, found.comparison.torque_peak_to_peak, rtol=2e-3
    )
    assert found.data.sizes == {"time": 2048, "shaft": 2, "order": 13, "multiplier_number": 4, "part": 2}
    low, high = without.torque.min(), without.torque.max()
    assert -3000 < low < high < 3000


def test_tripod_line_stands_beside_linear_theory() -> None:
    line = two_shafts().replace("HookeJoint 1", angle="12 deg")
    elements = [
        tn.TripodJoint(angle=tn.deg(12), radius=0.05, length=0.3) if e.kind == "HookeJoint" else e
        for e in line.elements
    ]
    found = tn.periodic_response(tn.Driveline(elements), SPEED)
    assert found.outcome.ok and found.comparison is not None
    linear, true = found.comparison.linear_torque_peak_to_peak, found.comparison.torque_peak_to_peak
    assert linear == pytest.approx(true, rel=1e-5)
    orders, amplitude = found.order_spectrum(7)
    assert amplitude[np.isclose(orders, 3)].min() > 0 and np.isclose(orders, 2).sum() == 0


@pytest.mark.slow
def test_no_periodic_motion_is_an_outcome() -> None:
    """An unstable linear oscillator has one, but a force without stiffness has none."""
    system = tn.System.from_function(
        lambda t, x, p: (x[1], 1.0 + np.cos(t)), ["x", "v"], period=2 * np.pi, compiled=False
    )
    found = tn.periodic_response(system, start=[0.0, 0.0])
    assert not found.outcome.ok and found.verdict is Verdict.FAILED
    assert "did not converge" in found.outcome.sentence and "start closer" in found.outcome.sentence
    assert np.isnan(found.multipliers).all() and "no periodic motion" in str(found)
    blown = tn.System.from_function(
        lambda t, x, p: (x[0] ** 2 + 1.0 + np.cos(t),),
        ["x"],
        period=2 * np.pi,
        jacobian=lambda t, x, p: np.array([[2 * x[0]]]),
    )
    found = tn.periodic_response(blown, start=[0.0])
    assert not found.outcome.ok and "blows up" in found.outcome.sentence


def torque_driven(angle: float, **disk: Any) -> tn.Driveline:
    """50 N m on the first disk against a viscous load on the last; no speed is prescribed."""
    return tn.Driveline(
        [
            tn.Disk(inertia=0.4, load_torque=-50.0, **disk),
            tn.HookeJoint(angle=tn.deg(angle)),
            tn.Shaft(stiffness=1e4, damping=5.0),
            tn.Disk(inertia=0.9, viscous_load=0.5),
        ]
    )


def test_a_line_without_prescribed_speed_finds_its_own() -> None:
    """Straight: torque over viscous load. Bent: the mean speed and state that a long simulation settles to."""
    straight = tn.periodic_response(torque_driven(0.0), 80.0)
    assert straight.speed == pytest.approx(100.0, abs=1e-9) and straight.verdict is Verdict.STABLE
    assert straight.growth_rate == pytest.approx(-0.5 / 1.3, rel=1e-3)
    bent = tn.periodic_response(torque_driven(25.0), 90.0)
    assert bent.outcome.ok and bent.verdict is Verdict.STABLE
    assert np.abs(bent.multipliers - 1).min() < 1e-8 and bent.orbit.liouville_defect < 1e-9
    assert abs(bent.speed - 100.0) > 0.01 and "speed is a result" in str(bent)
    # Seen from its own speed, a long run from rest repeats after half a turn and stays where it is.
    line = torque_driven(25.0)
    run = tn.simulate(line, speed=bent.speed, turns=1200, tolerance=1e-12)
    last = run.at(run.end - bent.period * np.array([0.0, 40.0]))
    np.testing.assert_allclose(last[0], last[1], atol=1e-8)
    assert np.ptp(run.motion_at(np.linspace(run.end - bent.period, run.end, 800)).torque) == pytest.approx(
        bent.torque_peak_to_peak[0], rel=1e-4
    )


def test_undamped_line_is_marginal() -> None:
    """All multipliers on the unit circle, in reciprocal pairs; inertia behind a joint varies with the angle."""
    line = tn.Driveline([*two_shafts(damping=0.0).elements, tn.HookeJoint(angle=0.3), tn.Disk(inertia=0.2)])
    found = tn.periodic_response(line, SPEED)
    assert found.verdict is Verdict.MARGINAL
    assert np.abs(np.abs(found.multipliers) - 1).max() < 1e-8
    assert np.prod(found.multipliers) == pytest.approx(1.0, abs=1e-9)


def test_refusals() -> None:
    line = two_shafts()
    with pytest.raises(tn.InputError, match="speed"):
        tn.periodic_response(line)
    with pytest.raises(tn.InputError, match="guessed"):
        tn.periodic_response(tn.reference_system("lorenz"))
    with pytest.raises(tn.InputError, match="belongs to autonomous"):
        tn.periodic_response(tn.reference_system("duffing"), period=3.0)
    with pytest.raises(tn.InputError, match="belongs to a driveline"):
        tn.periodic_response(tn.reference_system("duffing"), 3.0)
    with pytest.raises(tn.InputError, match="periods"):
        tn.periodic_response(tn.reference_system("duffing"), periods=0)
    with pytest.raises(tn.InputError, match="is free–free and is excited in time"):
        tn.periodic_response(torque_driven(20.0, excitation=[{"frequency": 5.0, "amplitude": 1.0}]), 50.0)
    with pytest.raises(tn.InputError, match="without a common period"):
        tn.periodic_response(two_shafts(excitation=[{"frequency": 1.2345678, "amplitude": 1.0}]), 50.0)
    with pytest.raises(tn.InputError, match="must be 4 finite numbers"):
        tn.periodic_response(line, 50.0, start=[0.0])

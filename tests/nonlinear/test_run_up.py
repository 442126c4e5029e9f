"""Passages through resonance: limits of slow and fast runs, envelopes, orders, safe accelerations."""

from __future__ import annotations

import numpy as np
import pytest
from jointed_lines import two_shafts

import trunnion as tn


@pytest.mark.slow
def test_a_slow_passage_reaches_the_steady_amplitude_and_a_fast_one_does_not() -> None:
    line = two_shafts(damping=8.0)
    slow = tn.run_up(line, 28.0, 46.0, acceleration=0.3)
    quick = tn.run_up(line, 28.0, 46.0, acceleration=30.0, steady=0)
    assert slow.steady is not None
    assert slow.peak_torque == pytest.approx(slow.steady_peak, rel=0.05)
    assert (quick.peak_torque < 0.8 * slow.peak_torque).all()
    # The envelope follows the steady response away from the peak too.
    steady = np.interp(31.0, slow.steady.speed, slow.steady.largest[:, 0])
    assert np.interp(31.0, slow.speed, slow.largest[:, 0]) == pytest.approx(steady, rel=0.05)
    assert "times the largest steady vibration found" in slow.describe("rpm")
    np.testing.assert_allclose(slow.peak_vibration, slow.steady_vibration, rtol=0.05)
    assert slow.data.sizes["shaft"] == 2 and np.isnan(quick.steady_peak).all()


def test_running_down_meets_the_resonance_from_above() -> None:
    line = two_shafts(damping=8.0)
    up, down = (tn.run_up(line, a, b, acceleration=3.0, steady=0) for a, b in ((28.0, 46.0), (46.0, 28.0)))
    assert up.peak_speed[0] > down.peak_speed[0]


@pytest.mark.slow
def test_safe_accelerations_keep_the_limit() -> None:
    line = two_shafts(damping=8.0)
    limit = 700.0
    found = tn.safe_accelerations(line, 28.0, 46.0, limit=limit, accelerations=(1.0, 3000.0), points=9)
    assert 1.0 < found.slowest < found.fastest < 3000.0
    for rate, keeps in (
        (found.slowest, True),
        (found.fastest, True),
        (found.slowest / 1.1, False),
        (found.fastest * 1.2, False),
    ):
        run = tn.run_up(line, 28.0, 46.0, acceleration=rate, steady=0)
        assert (run.peak_torque.max() <= limit * 1.002) == keeps
    assert found.share[found.safe].max() <= 1 and (np.diff(found.acceleration) > 0).all()
    assert f"safe at each of the {len(found.stretch)} accelerations tried" in str(found)
    none = tn.safe_accelerations(line, 28.0, 46.0, limit=5.0, accelerations=(10.0, 100.0), points=3)
    assert np.isnan(none.slowest) and str(none).startswith("none of the 3 accelerations tried from 10 to 100 rad/s²")
    assert "the best that reaches 46 rad/s, 100 rad/s², comes to 77" in str(none)
    # Nothing is said of what was not run.
    wide = tn.safe_accelerations(line, 28.0, 46.0, limit={"Shaft 1": 1e6}, accelerations=(10.0, 100.0), points=2)
    assert (wide.slowest, wide.fastest) == (10.0, pytest.approx(100.0))
    assert "nothing slower was tried; nothing faster was tried; neighbours are up to 10 times apart" in str(wide)


def test_orders_stay_in_place_while_the_speed_changes() -> None:
    """A torque of order 1.5 on one disk shows at 1.5 with its amplitude, whatever the speed."""
    line = two_shafts(angle=0.0, damping=40.0, excitation=[{"order": 1.5, "amplitude": 20.0}])
    run = tn.run_up(line, 150.0, 250.0, acceleration=4.0, steady=0).simulation
    found = tn.order_map(run)
    assert np.all(found.order[1:][found.amplitude[:, 1:, 1].argmax(axis=1)] == 1.5)
    steady = tn.periodic_response(line, 200.0, compare=False)
    orders, amplitude = steady.order_spectrum(3)
    expected = amplitude[np.isclose(orders, 1.5)][0, 1]
    near = np.abs(found.speed - 200.0).argmin()
    assert found.amplitude[near, np.isclose(found.order, 1.5), 1][0] == pytest.approx(expected, rel=0.02)


def test_angles_and_times_are_inverse() -> None:
    profile = tn.SpeedProfile([0.0, 2.0, 3.0], [50.0, 150.0, 100.0])
    run = tn.simulate(two_shafts(), 4.0, speed=profile)
    angles = np.linspace(0, float(profile.angle(4.0)), 500)
    np.testing.assert_allclose(profile.angle(run.input.times_at(angles)), angles, atol=1e-9)
    np.testing.assert_allclose(profile.angle([0.0, 2.0, 3.0, 4.0]), [0.0, 200.0, 325.0, 425.0])
    assert [len(run.pieces), run.input_speed[-1]] == [3, 100.0]


def test_profiles_join_without_a_seam() -> None:
    """A profile of two equal pieces is the constant speed."""
    line = two_shafts(load=40.0)
    whole = tn.simulate(line, 0.7, speed=60.0, tolerance=1e-12)
    cut = tn.simulate(line, 0.7, speed=tn.SpeedProfile([0.0, 0.3, 0.5], [60.0, 60.0, 60.0]), tolerance=1e-12)
    np.testing.assert_allclose(cut.final, whole.final, atol=1e-10)


def test_an_accelerated_rigid_line_carries_its_inertia() -> None:
    """Far below resonance the shaft torque is −J times the acceleration."""
    stiff = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e6, damping=200.0), tn.Disk(inertia=2.0)])
    run = tn.simulate(stiff, 1.0, speed=tn.SpeedProfile([0.0, 1.0], [10.0, 30.0]))
    assert run.torque[-1, 0] == pytest.approx(-40.0, rel=1e-6)
    geared = tn.Driveline(
        [*stiff.elements, tn.Ratio(ratio=2.0), tn.Shaft(stiffness=1e6, damping=60.0), tn.Disk(inertia=4.0)]
    )
    passage = tn.run_up(geared, 10.0, 30.0, acceleration=20.0, steady=0)
    np.testing.assert_allclose(passage.inertia_torque, [2 * 20 + 4 * 20 / 4, 4 * 20 / 2])
    np.testing.assert_allclose(-passage.simulation.torque[-1], passage.inertia_torque, rtol=1e-3)


@pytest.mark.parametrize(("ramp", "low", "high"), [(None, 1.0, 1.04), (0.0, 1.85, 2.0)], ids=["ramped", "at once"])
def test_an_acceleration_that_sets_in_smoothly_does_not_ring(ramp: float | None, low: float, high: float) -> None:
    """Without joints the torque is that of the inertia; set in at once it rises to twice that and rings."""
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=2000.0, damping=0.4), tn.Disk(inertia=2.0)])
    for first, last in ((10.0, 60.0), (60.0, 10.0)):
        run = tn.run_up(line, first, last, acceleration=20.0, ramp=ramp, steady=0)
        assert run.inertia_torque[0] == pytest.approx(40.0)
        assert low < run.peak_torque[0] / 40.0 < high
        assert run.peak_vibration[0] == pytest.approx(run.peak_torque[0] - 40.0, abs=0.03 * 40.0)
        assert run.simulation.input_speed[[0, -1]] == pytest.approx([first, last])
    assert run.ramp == (0.0 if ramp == 0 else pytest.approx(3 * 2 * np.pi / np.sqrt(1000.0)))
    with pytest.raises(tn.InputError, match="does not fit"):
        tn.run_up(line, 10.0, 60.0, acceleration=20.0, ramp=6.0)


def test_the_quasi_static_torque_holds_loads_by_speed_and_inertia() -> None:
    """A stiff geared line with loads by speed, far below its resonance: what vibrates is next to nothing."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e6, damping=2000.0), tn.Disk(inertia=2.0, load_torque=30.0),
            tn.Ratio(ratio=2.0), tn.Shaft(stiffness=1e6, damping=600.0), tn.Disk(inertia=4.0, viscous_load=0.5),
        ]
    )  # fmt: skip
    run = tn.run_up(line, 10.0, 30.0, acceleration=20.0, steady=0)
    np.testing.assert_allclose(run.peak_torque, [30 + 40 + 47.5 / 2, 40 + 0.5 * 15], rtol=1e-4)
    assert np.all(run.peak_vibration < run.inertia_torque / 35)


REFUSED = [
    (lambda line: tn.run_up(line, 0.0, 10.0, acceleration=1.0), "first"),
    (lambda line: tn.run_up(line, 10.0, np.nan, acceleration=1.0), "last"),
    (lambda line: tn.run_up(line, 10.0, 20.0, acceleration=-1.0), "acceleration"),
    (lambda line: tn.run_up(line, 10.0, 10.0, acceleration=1.0), "also the last"),
    (lambda line: tn.run_up(line, 10.0, 5000.0, acceleration=0.01), "turns"),
    (lambda line: tn.run_up(tn.Driveline(line.elements[2:]), 10.0, 20.0, acceleration=1.0), "is free–free"),
    (lambda line: tn.safe_accelerations(line, 1.0, 2.0, limit=0.0, accelerations=(1, 2)), "positive torque"),
    (lambda line: tn.safe_accelerations(line, 1.0, 2.0, limit={"Shaft 9": 1.0}, accelerations=(1, 2)), "shafts are"),
    (lambda line: tn.safe_accelerations(line, 1.0, 2.0, limit=1.0, accelerations=(2, 1)), "rising pair"),
    (lambda line: tn.SpeedProfile([0.0, 1.0], [1.0]), "as many speeds"),
    (lambda line: tn.SpeedProfile([1.0, 2.0], [1.0, 2.0]), "rise from 0"),
    (lambda line: tn.SpeedProfile([0.0, 2.0], [1.0, 0.0]), "positive"),
    (lambda line: tn.order_map(tn.simulate(line, speed=50.0, turns=4)), "two windows"),
    (lambda line: tn.simulate(line, speed=tn.SpeedProfile([0, 1], [1, 2]), turns=4), "constant speed"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[w for _, w in REFUSED])
def test_refusals(call, words) -> None:
    with pytest.raises(tn.InputError, match=words):
        call(two_shafts())

"""Predicted peaks of a comparison in closed form, whatever speeds were tracked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.passing_order import states_on_run

import trunnion as tn

STIFFNESS, INERTIA, TORQUE = 2e4, 0.5, 30.0


def resonator(damping: float, stiffness: float = STIFFNESS, joint: float = 0.0) -> tn.Driveline:
    """A disk behind a shaft, shaken once a turn."""
    hub = tn.Disk(inertia=INERTIA, name="hub", excitation=[{"order": 1, "amplitude": TORQUE}])
    joints = [tn.HookeJoint(angle=joint, name="joint")] if joint else []
    return tn.Driveline([tn.ConstantSpeed(), *joints, tn.Shaft(stiffness=stiffness, damping=damping, name="tube"), hub])


def top(damping: float, stiffness: float = STIFFNESS) -> tuple[float, float]:
    """Speed and height of the peak of A/|k − JΩ² + icΩ|."""
    square = stiffness / INERTIA
    return np.sqrt(square - (damping / INERTIA) ** 2 / 2), TORQUE / (
        damping * np.sqrt(square - (damping / INERTIA) ** 2 / 4)
    )


@pytest.fixture(scope="module")
def data() -> tn.MeasuredOrders:
    """A run-up in 16 windows, 11 rad/s apart near the resonance at 200 rad/s."""
    run = tn.measure(resonator(20.0), (90.0, 290.0), 2.5, {"hub": 36}, gauges=["tube"], pitch_error=0.0)
    return tn.track_orders(run, [1, 2], window=4)


@pytest.fixture(scope="module")
def slow(data: tn.MeasuredOrders) -> tn.MeasuredOrders:
    """The same windows in a run so slow that nothing lags."""
    return replace(data, time=1e6 * data.time)


@pytest.mark.parametrize("damping", [20.0, 2.0, 0.05])
def test_peaks_are_those_of_the_closed_form(slow: tn.MeasuredOrders, damping: float) -> None:
    """At 0.05 N m s/rad the peak is 0.05 rad/s wide, a two-hundredth of what lies between two windows."""
    found = tn.compare_measured(resonator(damping), slow)
    speed, height = top(damping)
    assert np.diff(np.sort(slow.speed)).max() > 5.0
    hub, tube = found.channels.index("hub"), found.channels.index("tube")
    assert abs(found.peak[0, hub] - height) <= found.peak_error[0, hub] + 1e-9 * height
    assert found.peak_error[0, hub] < 2e-4 * height
    assert abs(found.peak_speed[0, hub] - speed) < 0.02 * max(damping / INERTIA, 1e-3 * speed)
    # The torque of the shaft is (k + icΩ) times its twist: larger by its damping, at all but the same speed.
    torque = abs(STIFFNESS + 1j * damping * speed) * height
    assert abs(found.peak[0, tube] / torque - 1) < 1e-3
    assert found.peak[1, hub] == 0.0  # nothing shakes it twice a turn


def test_a_peak_between_the_tracked_speeds_is_said(data: tn.MeasuredOrders, slow: tn.MeasuredOrders) -> None:
    """Read at the windows alone the sharp line seems to agree, or to be smaller."""
    sharp = tn.compare_measured(resonator(0.05), slow)
    said = sharp.sentence(0, sharp.channels.index("hub"))
    assert "between the tracked speeds; at those up to" in said and "3000 mrad" in said
    assert float(np.abs(sharp.predicted[:, 0]).max()) < 0.2 * sharp.peak[0].max()
    same = tn.compare_measured(resonator(20.0), data)
    assert "between" not in same.sentence(0, 0) and "as predicted to" in same.sentence(0, 0)


def test_peaks_of_a_fast_run_are_those_of_the_run(data: tn.MeasuredOrders) -> None:
    """80 rad/s² through a resonance 4 rad/s wide: in closed form, the hub shaken by a torque of order 1."""
    found = tn.compare_measured(resonator(2.0), data)
    rate = (290.0 - 90.0) / 2.5
    speed = np.linspace(data.speed.min(), data.speed.max(), 20001)
    matrix = np.array([[0.0, 1.0], [-STIFFNESS / INERTIA, -2.0 / INERTIA]])
    swing = np.abs(states_on_run(matrix, np.array([0.0, TORQUE / INERTIA]), np.zeros(2), 1.0, speed, rate)[:, 0])
    hub = found.channels.index("hub")
    assert swing.max() < 0.6 * top(2.0)[1] and speed[swing.argmax()] > top(2.0)[0] + 3.0
    assert abs(found.peak[0, hub] - swing.max()) <= found.peak_error[0, hub] + 1e-5 * swing.max()
    assert found.peak_error[0, hub] < 2e-4 * swing.max()
    assert abs(found.peak_speed[0, hub] - speed[swing.argmax()]) < 0.05


@pytest.mark.parametrize("stiffness", [1.7e4, 1.9e4, 2.15e4])
def test_a_shift_is_measured_finer_than_the_windows_stand(data: tn.MeasuredOrders, stiffness: float) -> None:
    found = tn.compare_measured(resonator(20.0, stiffness), data)
    said = found.sentence(0, found.channels.index("hub"))
    true = top(20.0)[0] / top(20.0, stiffness)[0] - 1
    assert ("later" in said) == (true > 0.02) and ("earlier" in said) == (true < -0.02)
    if "its peak comes" in said:
        stated = float(said.partition("its peak comes ")[2].partition(" %")[0])
        assert abs(stated - 100 * abs(true)) < 1.0


def test_a_resonance_without_damping_has_no_peak(data: tn.MeasuredOrders) -> None:
    """What the tracked speeds show is left, and said to be no more than that."""
    found = tn.compare_measured(resonator(0.0), data)
    assert np.all(np.isinf(found.peak_error))
    assert np.allclose(found.peak, np.abs(found.predicted).max(axis=0), rtol=1e-13)
    words = " ".join(map(str, found.findings))
    assert "read at the tracked speeds alone: some peak is infinite, a resonance without damping." in words

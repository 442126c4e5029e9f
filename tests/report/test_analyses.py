"""The analyses behind the report: forced response over speed, the limit angle, bending speeds."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.design.limits.result import LimitKind
from trunnion.errors import ComputationError
from trunnion.modes.bending import tube_critical_speed
from trunnion.response import speed_sweep
from trunnion.results.finding import Gravity

LINE = tn.catalogue("two-shaft-cardan", angle=0.3)


@pytest.mark.parametrize("changes", [{}, {"damping_ratio": 0.05, "inertia_of_disk_2": 3.0}])
def test_sweep_is_the_response_of_stability(changes: dict[str, float]) -> None:
    """Hill's series against direct integration, away from and near a resonance."""
    line = tn.catalogue("two-shaft-cardan", angle=0.3, **changes)
    speeds = [0.2, 0.31, 0.75, 1.3]
    sweep = tn.speed_sweep(line, speeds)
    assert sweep.cut_off.max() < 1e-4
    for i, speed in enumerate(speeds):
        response = tn.stability(line, speed).response
        assert response is not None
        assert sweep.torque_amplitude[i] == pytest.approx(response.torque_amplitude, rel=5e-3)
        assert sweep.torque_mean[i] == pytest.approx(response.torque_mean, abs=1e-4 * sweep.torque_amplitude[i].max())
        assert sweep.joint_rotation[i] == pytest.approx(response.largest_joint_rotation, rel=5e-3)


def test_sweep_speeds_hold_the_peaks() -> None:
    first = tn.natural_frequencies(LINE).undamped_frequency[0]
    speeds = tn.sweep_speeds(LINE, 0.1, 1.5, 11)
    assert np.all(np.diff(speeds) > 0)
    peak, at = tn.speed_sweep(LINE, speeds).peak("Shaft 1")
    assert at == pytest.approx(first / 2, rel=0.01)
    dense = tn.speed_sweep(LINE, at * np.linspace(0.999, 1.001, 401)).torque_amplitude[:, 0].max()
    assert dense * (1 - 1e-6) <= peak <= dense * (1 + 1e-5)
    assert peak > 100 * np.median(tn.speed_sweep(LINE, speeds).torque_amplitude[:, 0])


def test_a_grid_that_knows_no_peaks_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where resonances cannot be looked for: by the speeds, and by the response over the range."""

    def lost(_: object) -> None:
        raise ComputationError("modes did not settle")

    monkeypatch.setattr(speed_sweep, "resonances", lost)
    with pytest.warns(tn.InputRemark, match="even grid of 11 from 0.1 rad/s.*modes did not settle"):
        speeds = tn.sweep_speeds(LINE, 0.1, 1.5, 11)
    assert speeds.tolist() == np.linspace(0.1, 1.5, 11).tolist()
    found = speed_sweep.response_over(LINE, 0.1, 1.5, points=11)
    assert found.speed.tolist() == speeds.tolist()
    assert any("even grid" in one.sentence and one.gravity == Gravity.CAUTION for one in found.findings)


def test_speeds_of_a_line_without_a_response_are_refused() -> None:
    line = tn.Driveline([tn.Disk(inertia=1.0, load_torque=5.0), tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0)])
    with pytest.raises(tn.InputError, match="do not balance"):
        tn.sweep_speeds(line, 20.0, 100.0)


def test_sweeps_and_responses_without_a_steady_state_are_printed_and_drawn() -> None:
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=100.0),
        tn.Disk(inertia=1.0, excitation=[{"order": 1, "amplitude": 1.0}]),
    ]
    for found in (tn.speed_sweep(tn.Driveline(parts), [10.0]), tn.order_response(tn.Driveline(parts), [10.0])):
        assert "Shaft 1: no steady state" in str(found)
        assert np.isnan(found.peak("Shaft 1")).all()
        found.plot()


def test_sweep_refuses_standstill() -> None:
    with pytest.raises(tn.InputError, match="positive"):
        tn.speed_sweep(LINE, [0.0, 1.0])


def test_limit_is_where_the_verdict_turns() -> None:
    speeds = np.array([0.62, 1.12, 1.58, 1.64])
    limit = tn.stable_limit(LINE, "HookeJoint 1.angle", speeds, high=1.0)
    assert list(limit.kind) == [LimitKind.CROSSING] * 4
    for speed, value in zip(limit.speed, limit.limit, strict=True):
        below, above = (
            tn.stability(tn.catalogue("two-shaft-cardan", angle=float(value + d)), float(speed)).verdict
            for d in (-2e-4, 2e-4)
        )
        assert (below.name, above.name) == ("STABLE", "UNSTABLE")
    assert limit.smallest == limit.limit.min() and limit.critical_speed == limit.speed[limit.limit.argmin()]


def test_limit_knows_edges_of_the_published_tongue() -> None:
    """ω₂ subharmonic, γ = 100: at Ω = 1.400251 the tongue begins at β = 0.3."""
    line = tn.catalogue("two-shaft-cardan", inertia_of_disk_2=100.0)
    limit = tn.stable_limit(line, "HookeJoint 1.angle", [1.372337, 1.400251], high=1.0)
    assert limit.limit == pytest.approx([0.5, 0.3], abs=1e-4)


def test_limit_says_when_nothing_was_found() -> None:
    limit = tn.stable_limit(LINE, "HookeJoint 1.angle", [1.3, 1.35], high=0.3)
    assert set(limit.kind) == {LimitKind.BEYOND} and limit.critical_speed is None
    assert np.all(limit.limit == 0.3) and "end of the range" in str(limit)


def test_limit_counts_separate_intervals() -> None:
    limit = tn.stable_limit(LINE, "HookeJoint 1.angle", np.linspace(0.5, 0.8, 61), high=1.4)
    assert limit.intervals.max() >= 2 and "once more" in str(limit)


def test_bending_speed_of_a_beam() -> None:
    """Solid steel bar, 50 mm, 1 m: f = (π/2L²)√(EI/ρA) = 100.6 Hz, I/A = d²/16."""
    omega = tube_critical_speed(0.05, 0.0, 1.0, 206e9, 7850.0)
    assert omega / (2 * np.pi) == pytest.approx(np.pi / 2 * np.sqrt(206e9 * 0.05**2 / 16 / 7850), rel=1e-12)
    assert omega / (2 * np.pi) == pytest.approx(100.6, abs=0.1)


def test_bending_speeds_of_a_line() -> None:
    def line(**tube: float) -> tn.Driveline:
        shaft = tn.Shaft(outer_diameter=0.09, inner_diameter=0.084, length=1.45, shear_modulus=79.3e9, **tube)
        return tn.Driveline([
            tn.ConstantSpeed(), tn.Shaft(stiffness=4e4), tn.Disk(inertia=0.1), tn.Ratio(ratio=2.0), shaft,
            tn.Disk(inertia=1.0),
        ])  # fmt: skip

    (found,) = tn.bending_speeds(line(density=7850.0))
    assert found.assumed_modulus and found.young_modulus == pytest.approx(2.6 * 79.3e9)
    assert found.input_speed == pytest.approx(2 * found.critical_speed)
    assert tn.bending_speeds(line()) == ()

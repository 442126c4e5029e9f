"""Campbell diagrams against closed forms, eigenvalues of the equations, and mode shapes."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

import trunnion as tn
from trunnion.analyses.linear.loaded_modes import matched
from trunnion.cli import app

J1, J2, K, C = 0.2, 0.8, 1e4, 2.0


def fan(quadratic, **rest):
    """A driven line: one spring, one fan; its slope 2cΩ is damping."""
    return tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=K), tn.Disk(inertia=J1, quadratic_load=quadratic, **rest)]
    )


def test_two_masses_by_hand():
    engine = tn.Disk(inertia=J1, excitation=[{"order": 2, "amplitude": 1.0}, {"order": 0.5, "amplitude": 1.0}])
    line = tn.Driveline([engine, tn.Shaft(stiffness=K, damping=C), tn.Disk(inertia=J2)])
    found = tn.campbell_diagram(line, np.linspace(100.0, 600.0, 11))
    zeta = C / (2 * np.sqrt(K * J1 * J2 / (J1 + J2)))
    damped = 250.0 * np.sqrt(1 - zeta**2)
    np.testing.assert_allclose(found.frequency[:, 0], damped, rtol=1e-12)
    assert found.mode.tolist() == [2]
    assert [c.line.order for c in found.crossings] == [2.0, 0.5]
    np.testing.assert_allclose([c.speed for c in found.crossings], [damped / 2, damped / 0.5], rtol=1e-12)
    assert found.crossings[0].amplification == pytest.approx(1 / (2 * zeta), rel=1e-9)
    np.testing.assert_allclose(found.kinetic[:, 0], [0.8, 0.2], rtol=1e-9)  # J φ² with J₁φ₁ = −J₂φ₂
    assert [order.name for _, _, order in found.near(0.95 * damped / 2)] == ["order 2"]
    assert not found.near(0.85 * damped / 2)


def test_modes_move_with_loads():
    """λ = −cΩ/J ± i√(k/J − (cΩ/J)²) for a quadratic load of slope 2cΩ."""
    speed = np.array([50.0, 100.0, 200.0])
    found = tn.campbell_diagram(fan(0.02), speed)
    decay = 0.02 * speed / J1
    np.testing.assert_allclose(found.frequency[:, 0], np.sqrt(K / J1 - decay**2), rtol=1e-10)
    np.testing.assert_allclose(found.damping_ratio[:, 0], decay / np.sqrt(K / J1), rtol=1e-10)


def test_a_mode_that_no_longer_oscillates_is_a_gap():
    found = tn.campbell_diagram(fan(1.0), [10.0, 60.0])
    assert np.isfinite(found.frequency[0, 0]) and np.isnan(found.frequency[1, 0])


def test_modes_keep_their_place_by_shape():
    shapes = np.linalg.qr(np.arange(9.0).reshape(3, 3) + np.eye(3))[0].astype(complex)
    before, after = matched(shapes, shapes[:, [2, 0, 1]] * np.exp(0.3j))
    assert dict(zip(before.tolist(), after.tolist(), strict=True)) == {0: 1, 1: 2, 2: 0}


def test_two_lines_side_by_side_cross_without_being_exchanged():
    """Two fans on branches of one drive: the damped frequency of one falls through that of the other."""
    parts = [
        tn.ConstantSpeed(name="drive"),
        tn.Shaft(stiffness=1.0e4),
        tn.Disk(inertia=0.2, name="steady"),
        tn.Shaft(stiffness=1.02e4, after="drive"),
        tn.Disk(inertia=0.2, name="fan", quadratic_load=0.1),
    ]
    found = tn.campbell_diagram(tn.Driveline(parts), np.linspace(1.0, 300.0, 60))
    place = found.rotations.index("fan")
    fan_mode, steady = (int(found.kinetic[i].argmax()) for i in (place, 1 - place))
    speed = found.speed
    np.testing.assert_allclose(found.frequency[:, steady], np.sqrt(1.0e4 / 0.2), rtol=1e-9)
    expected = np.sqrt(1.02e4 / 0.2 - (0.1 * speed / 0.2) ** 2)
    np.testing.assert_allclose(found.frequency[:, fan_mode], expected, rtol=1e-8)
    assert np.any(expected < np.sqrt(1.0e4 / 0.2)) and np.any(expected > np.sqrt(1.0e4 / 0.2))


def test_joints_excite_at_twice_and_four_times_their_input():
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e4),
            tn.Disk(inertia=0.05),
            tn.Ratio(teeth_in=10, teeth_out=20),
            tn.Disk(inertia=0.05),
            tn.HookeJoint(angle="5 deg", name="joint"),
            tn.Shaft(stiffness=1e4),
            tn.Disk(inertia=0.3, excitation=[{"frequency": "50 Hz", "amplitude": 1.0}]),
        ]
    )
    found = tn.campbell_diagram(line, [10.0, 400.0])
    assert [(one.order, one.causes) for one in found.lines if one.order] == [(1.0, ("joint",)), (2.0, ("joint",))]
    assert [one.name for one in found.lines if not one.order] == ["50 Hz"]


@pytest.mark.parametrize(
    ("speeds", "margin", "said"),
    [
        ([1.0], 0.1, "speeds: must be two or more, ascending"),
        ([2.0, 1.0], 0.1, "speeds: must be two or more, ascending"),
        ([-1.0, 1.0], 0.1, "speeds = -1: must not be negative"),
        ([1.0, 2.0], 1.5, "margin = 1.5: must lie between 0 and 1"),
    ],
)
def test_refusals(speeds, margin, said):
    with pytest.raises(tn.InputError) as error:
        tn.campbell_diagram(fan(0.0), speeds, margin=margin)
    assert str(error.value).startswith(said)
    assert "\n" not in str(error.value)


def test_the_command_writes_a_picture(tmp_path):
    found = CliRunner().invoke(app, ["campbell-diagram", "two-shaft-cardan", "-o", str(tmp_path / "campbell.png")])
    assert found.exit_code == 0, found.output
    assert (tmp_path / "campbell.png").stat().st_size > 10_000
    assert "crossed" in found.stdout

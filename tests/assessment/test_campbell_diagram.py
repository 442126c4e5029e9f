"""Campbell diagrams against closed forms, eigenvalues of the equations, and mode shapes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli import app
from trunnion.modes.loaded_modes import matched
from trunnion.pictures import campbell_diagram as pictures
from trunnion.pictures.picture import Texts

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


def test_a_mode_that_moves_is_crossed_where_it_stands():
    """kΩ = √(K/J − (cΩ/J)²), so Ω² = (K/J)/(k² + (c/J)²); few speeds, and the crossing is exact all the same."""
    shaken = fan(0.1, excitation=[{"order": 1.5, "amplitude": 3.0}])
    (crossing,) = tn.campbell_diagram(shaken, [20.0, 150.0, 260.0]).crossings
    at = np.sqrt(K / J1 / (1.5**2 + (0.1 / J1) ** 2))
    assert crossing.speed == pytest.approx(at, rel=1e-8)
    assert crossing.damping_ratio == pytest.approx(0.1 * at / J1 / np.sqrt(K / J1), rel=1e-7)
    assert crossing.line.torque == 3.0


def test_stages_hold_with_the_load_at_each_speed_and_modes_jump():
    """A coupling of 4 kN m/rad, above 0.05 rad 16 kN m/rad: the fan's 0.02 Ω² passes 200 N m at 100 rad/s, where the
    mode goes from 141.4 to 282.8 rad/s. Order 2 lies in the gap there and meets the stiff stage later."""
    coupling = tn.PiecewiseShaft.symmetric([(4e3, 0.05), (16e3, None)], name="coupling")
    wheel = tn.Disk(inertia=J1, quadratic_load=0.02, excitation=[{"order": 2, "amplitude": 1.0}])
    parts = [tn.ConstantSpeed(), coupling, wheel]
    found = tn.campbell_diagram(tn.Driveline(parts), np.linspace(60.0, 180.0, 25))
    soft, stiff = found.frequency[found.speed < 99, 0], found.frequency[found.speed > 101, 0]
    decay = 0.02 * found.speed / J1
    np.testing.assert_allclose(soft, np.sqrt(4e3 / J1 - decay[found.speed < 99] ** 2), rtol=1e-9)
    np.testing.assert_allclose(stiff, np.sqrt(16e3 / J1 - decay[found.speed > 101] ** 2), rtol=1e-9)
    at = [np.sqrt(k / J1 / (4 + (0.02 / J1) ** 2)) for k in (4e3, 16e3)]  # 2Ω = √(k/J − (cΩ/J)²)
    assert [c.speed for c in found.crossings] == pytest.approx(at, rel=1e-8)
    ((where, mode, line),) = found.jumps
    assert (where, mode, line.order) == (pytest.approx(100.0, rel=1e-6), 1, 2.0)
    assert "Mode 1 jumps over order 2 at 100 rad/s, where a spring changes its stage" in str(found)


def test_orders_that_the_firing_cancels_excite_nothing():
    """Four cylinders fired every 180°: of orders 0.5 to 4 only 2 and 4 are left, four times as large."""
    harmonics = [{"order": k / 2, "amplitude": 10.0} for k in range(1, 9)]
    firing = ["0 deg", "180 deg", "540 deg", "360 deg"]
    engine = tn.Disk(inertia=J1, excitation=harmonics, firing_angles=firing, name="engine")
    parts = [engine, tn.Shaft(stiffness=K, damping=C), tn.Disk(inertia=J2)]
    found = tn.campbell_diagram(tn.Driveline(parts), [50.0, 200.0])
    assert [(one.order, round(one.torque, 9)) for one in found.lines] == [(2.0, 40.0), (4.0, 40.0)]
    misfired = tn.Driveline(parts).replace("engine", misfiring=2)
    assert [one.order for one in tn.campbell_diagram(misfired, [50.0, 200.0]).lines] == [k / 2 for k in range(1, 9)]


def test_torques_of_disks_at_their_largest_and_none_where_a_table_ends():
    square = [{"order": 2, "quadratic_amplitude": 0.01}]
    assert tn.campbell_diagram(fan(0.0, excitation=square), [10.0, 60.0]).lines[0].torque == pytest.approx(36.0)
    table = [{"order": 2, "speeds": [20.0, 50.0], "amplitudes": [1.0, 4.0]}]
    assert tn.campbell_diagram(fan(0.0, excitation=table), [25.0, 50.0]).lines[0].torque == pytest.approx(4.0)
    assert np.isnan(tn.campbell_diagram(fan(0.0, excitation=table), [10.0, 60.0]).lines[0].torque)


def test_a_loss_factor_damps_by_half_of_it():
    """λ = iω√(1 + iη): ζ = η/2 to first order."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=K, loss_factor=0.02),
            tn.Disk(inertia=J1, excitation=[{"order": 2, "amplitude": 1.0}]),
        ]
    )
    (crossing,) = tn.campbell_diagram(line, [50.0, 200.0]).crossings
    assert crossing.amplification == pytest.approx(50.0, rel=1e-3)


def test_a_crossing_at_the_last_speed_counts():
    line = fan(0.0, excitation=[{"order": 2, "amplitude": 1.0}])
    at = float(tn.natural_frequencies(line).frequency[0]) / 2
    found = tn.campbell_diagram(line, [at / 2, at])
    assert [c.speed for c in found.crossings] == pytest.approx([at], rel=1e-12)


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


def test_of_a_ship_the_engine_excites_and_the_operating_speed_is_seen():
    """An engine's throws are said once, as the engine; names of lines lie neither on each other nor on that speed."""
    line = tn.load(Path(__file__).parents[2] / "examples" / "six-cylinder-ship.toml")
    found = tn.campbell_diagram(line, [tn.rpm(300), tn.rpm(780)])
    assert "order 2 (engine) on mode" in str(found) and "engine.throw 1, " not in str(found)
    assert len(next(one for one in found.lines if one.order == 2.0).causes) == 6
    panel = pictures.campbell_diagram(found, unit="rpm", operating=line.operation).panels[0]
    names = [one for one in panel.items if isinstance(one, Texts)]
    places = [(float(one.x[0]), float(one.y[0])) for one in names]
    assert len(places) == len(found.lines)
    wide, high = panel.x.high - panel.x.low, panel.y.high - panel.y.low
    assert all(abs(x - 750.0) > 0.03 * wide for x, _ in places)
    for k, (x, y) in enumerate(places):
        assert all(abs(x - a) > 0.05 * wide or abs(y - b) > 0.025 * high for a, b in places[:k])

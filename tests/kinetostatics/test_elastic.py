"""Elastic shafts: the balance of power, derivatives, S2's example, and inertia near a resonance."""

import lines
import numpy as np
import pytest
import vector_model

import trunnion as tn
from trunnion.results.finding import Gravity


def heavy(speed_share):
    """A line with inertia and its lowest elastic frequency [rad/s]; ``speed_share`` of it is 2Ω."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=2e4),
            tn.Disk(inertia=0.05),
            tn.HookeJoint(angle=tn.deg(6)),
            tn.Shaft(stiffness=1e4),
            tn.Disk(inertia=0.4, load_torque=50.0),
        ]
    )
    lowest = tn.natural_frequencies(line).elastic[0]
    return line, speed_share * lowest / 2


@pytest.mark.parametrize("seed", range(5))
def test_power_balance_rigid(seed):
    line = lines.random_line(6, seed)
    result = tn.kinetostatics(lines.driveline(line), speed=2.0)
    assert result.power_residual < 1e-12
    supplied, used = result.drive_torque * 2.0, line.load * result.output_speed
    assert np.abs(supplied - used).max() < 1e-12 * np.abs(supplied).max()


def loaded(**disk):
    shaft = tn.Shaft(stiffness=1e9)
    joint = tn.HookeJoint(angle=0.3)
    return tn.Driveline([tn.ConstantSpeed(), shaft, joint, tn.Ratio(ratio=-2.0), shaft, tn.Disk(inertia=1, **disk)])


@pytest.mark.parametrize("rigid", [True, False])
@pytest.mark.parametrize(("viscous", "quadratic"), [(0.2, 0.0), (0.0, 0.05), (0.2, 0.05)])
def test_loads_that_grow_with_the_speed(viscous, quadratic, rigid):
    """Power supplied = cω² + q|ω|³ at every angle, behind a ratio that reverses too."""
    line = loaded(viscous_load=viscous, quadratic_load=quadratic)
    result = tn.kinetostatics(line, speed=10.0, rigid=rigid)
    speed = np.abs(result.output_speed)
    assert np.allclose(result.drive_torque * 10, viscous * speed**2 + quadratic * speed**3, rtol=1e-7)
    assert result.power_residual < 1e-12
    assert "no torque" not in str(result)
    assert not result.findings


def staged(**disk):
    """Driven straight, over 100 N m/rad to 0.1 rad and 4000 beyond."""
    shaft = tn.PiecewiseShaft.symmetric([(100.0, 0.1), (4000.0, None)])
    return tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=1.0, **disk)])


@pytest.mark.parametrize(
    ("disk", "output"),
    [
        ({"load_torque": 50.0}, 0.0),
        ({}, 50.0),
        ({"load_torque": 25.0}, 25.0),
        ({"viscous_load": 3.0, "quadratic_load": 0.2}, 0.0),  # at 10 rad/s
    ],
)
def test_stage_of_the_whole_torque(disk, output):
    """10 N m to the breakpoint and 40 beyond, whatever the torque comes from."""
    result = tn.kinetostatics(staged(**disk), speed=10.0, rigid=False, output_torque=output, points=8)
    assert np.allclose(result.twist, -0.11, rtol=0, atol=1e-15)


def _yields(torque):
    """Twist [rad] under a torque [N m]: 1500 N m/rad to 0.04 rad, 6000 to 0.0467 (100 N m), 10 000 beyond."""
    far = 0.04 + 40 / 6000 + 10.0
    return np.sign(torque) * np.interp(abs(torque), [0, 60, 100, 100 + 1e5], [0, 0.04, 0.04 + 40 / 6000, far])


def test_stages_twist_by_twist():
    """Every shaft on the law of its own stages, at every angle: the twists of the rigid bodies in space."""
    line = lines.random_line(3, 12, load=100.0)
    stages = [(1500.0, 0.04), (6000.0, 0.04 + 40 / 6000), (1e4, None)]
    elements = [
        tn.PiecewiseShaft.symmetric(stages, fork_offset=e.fork_offset, name=f"stages {m}") if e.kind == "Shaft" else e
        for m, e in enumerate(lines.driveline(line).elements)
    ]
    result = tn.kinetostatics(tn.Driveline(elements), speed=line.speed, points=72, rigid=False)
    assert result.twist[:3].min() < -0.047 < -0.0465 < result.twist[:3].max()
    for p in range(0, 72, 7):
        _, truth, twists = vector_model.elastic(line, result.input_angle[p], yields=_yields)
        assert np.allclose(result.twist[:3, p], twists, rtol=0, atol=1e-12)
        assert abs(result.drive_torque[p] - truth["drive_torque"]) < 1e-9
    assert result.power_residual < 1e-12
    said = [f.sentence for f in result.findings]
    assert any("changes its stage within the turn, at a twist of -2.674 deg" in s for s in said)


def test_a_torque_that_crosses_the_play_is_said():
    """Inertia torques without load reverse twice a turn."""
    play = tn.PiecewiseShaft(breakpoints=["-1 deg", "1 deg"], stiffnesses=[1e4, 0, 1e4])
    line = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.01), tn.HookeJoint(angle=0.3)]
    free, pressed = (
        tn.kinetostatics(tn.Driveline([*line, play, tn.Disk(inertia=0.1, load_torque=load)]), 10.0,
                         rigid=False, inertia=True)
        for load in (0.0, 20.0)
    )  # fmt: skip
    assert any("crosses its free play" in f.sentence and f.gravity is Gravity.CAUTION for f in free.findings)
    assert not any("play" in f.sentence for f in pressed.findings)


def test_a_torque_beyond_the_stages_is_refused():
    soft = tn.PiecewiseShaft(breakpoints=[-0.1, 0.1], stiffnesses=[0, 100.0, 0])
    with pytest.raises(tn.InputError, match=r"stages: has no stage that carries its load of -20 N m"):
        tn.kinetostatics(
            tn.Driveline([tn.ConstantSpeed(), soft.model_copy(update={"name": "stages"}), tn.Disk(inertia=1.0)]),
            rigid=False,
            output_torque=20.0,
        )


def test_excitation_left_out_is_remarked():
    shaken = tn.kinetostatics(loaded(load_torque=5.0, excitation=[{"order": 2, "amplitude": 3}]))
    assert [f.gravity for f in shaken.findings] == [Gravity.CAUTION]
    assert "Disk 1.excitation is left out" in str(shaken)


@pytest.mark.parametrize("options", [{"rigid": False}, {"inertia": True}, {"friction": True}, {"all": True}])
def test_power_balance_with_springs_inertias_and_friction(options):
    line = lines.random_line(4, 3, stiffness=[4000.0] * 5, inertias=[0.1] * 5)
    chosen = {
        "rigid": "all" not in options and options.get("rigid", True),
        "inertia": "inertia" in options or "all" in options,
        "friction": tn.CrossFriction(0.01, 0.012, 0.04) if {"friction", "all"} & set(options) else None,
    }
    assert tn.kinetostatics(lines.driveline(line), speed=2.0, **chosen).power_residual < 1e-12


def test_friction_costs_power():
    line = lines.driveline(lines.random_line(3, 3))
    result = tn.kinetostatics(line, friction=tn.CrossFriction("1 %", "12 mm", "40 mm"))
    assert 0.98 < result.efficiency < 0.9999
    assert np.all(result.power_loss > 0)
    assert tn.kinetostatics(line).efficiency == 1


def test_speed_and_acceleration_are_derivatives_of_the_angle():
    """The rates of the twist included."""
    line = lines.random_line(3, 11, stiffness=[3000.0, 2000.0, 2500.0, 1e9])
    result = tn.kinetostatics(lines.driveline(line), speed=3.0, points=360, rigid=False)
    order = 1j * np.fft.fftfreq(360, 1 / 360)
    for angle, speed, acceleration in zip(result.angle, result.speed, result.acceleration, strict=True):
        spectrum = np.fft.fft(angle - result.input_angle)
        assert np.allclose(3 + 3 * np.fft.ifft(order * spectrum).real, speed, atol=1e-10)
        assert np.allclose(9 * np.fft.ifft(order**2 * spectrum).real, acceleration, atol=1e-8)


def test_twist_is_torque_over_stiffness():
    line = lines.random_line(3, 11, stiffness=[300.0, 200.0, 250.0, 1e3])
    result = tn.kinetostatics(lines.driveline(line), rigid=False)
    assert np.abs(result.twist).max() > 0.4
    assert np.allclose(result.twist, result.torque / np.array(line.stiffness)[:, None], rtol=0, atol=1e-14)


def test_shafts_too_soft_are_reported():
    line = lines.random_line(3, 11, stiffness=[30.0, 20.0, 25.0, 1e3])
    with pytest.raises(tn.ComputationError, match=r"Shaft 2 yields more than .* make it stiffer") as caught:
        tn.kinetostatics(lines.driveline(line), rigid=False)
    assert "\n" not in str(caught.value)


def test_stiff_limit_is_rigid():
    line = lines.random_line(3, 11, stiffness=[1e12] * 4)
    elastic = tn.kinetostatics(lines.driveline(line), rigid=False)
    rigid = tn.kinetostatics(lines.driveline(line))
    assert np.abs(elastic.output_speed - rigid.output_speed).max() < 1e-9
    assert not np.any(rigid.twist)


def test_example_of_s2():
    """Printed angles: ω_out/ω_in from 0.780 to 1.282; corrected stiffness: 1.574e-5 rad at 150 N m."""
    line = tn.catalogue("bicardan-elastic")
    slow, fast = tn.kinetostatics(line).speed_ratio
    assert (round(slow, 4), round(fast, 4)) == (0.7801, 1.2819)
    shaft = line.elements[line.index("intermediate shaft 1")]
    assert 150 / shaft.stiffness == pytest.approx(1.574e-5, rel=4e-4)
    printed = tn.catalogue("bicardan-elastic", printed_stiffness=True)
    assert 150 / printed.elements[3].stiffness == pytest.approx(1.574e-8, rel=4e-4)
    assert tn.kinetostatics(tn.catalogue("bicardan-elastic", homokinetic=True)).irregularity < 1e-12


def test_constant_twist_of_s2_is_off_by_an_eighth():
    """The paper finds ξ nearly constant; by its own angles it swings by ± 12.6 % of its mean."""
    result = tn.kinetostatics(tn.catalogue("bicardan-elastic"), rigid=False)
    assert result.constant_twist.variation[1] == pytest.approx(0.1257, abs=2e-4)
    assert result.constant_twist.variation[2] < 1e-12  # behind the last joint the torque is the load
    # what that does to the motion is nothing: the twist itself is 1.6e-5 rad
    assert result.constant_twist.speed < 1e-5
    assert result.constant_twist.angle < 3e-6


def test_tube_formula_of_s2_in_its_own_units():
    """c = πG(D⁴ − d⁴)/(32 l) with mm and N/mm² is in N mm/rad: a thousandth of it in N m/rad."""
    tube = tn.Shaft(outer_diameter="90 mm", inner_diameter="84 mm", length="1000 mm", shear_modulus="81 GPa")
    in_millimetres = np.pi * 81000 * (90**4 - 84**4) / (32 * 1000)
    assert tube.torsional_stiffness == pytest.approx(in_millimetres / 1000, rel=1e-14)


def test_quasi_static_inertia_agrees_with_the_linear_response_at_low_speed():
    """Torque amplitudes against the linear forced response, which has the dynamics: apart by (2Ω/ω₁)²."""
    line, speed = heavy(0.1)
    result = tn.kinetostatics(line, speed=speed, rigid=False, inertia=True)
    assert not result.findings
    response = tn.stability(line, speed=speed).response
    amplitude = np.ptp(result.torque, axis=1) / 2
    assert np.allclose(amplitude, response.torque_amplitude, rtol=0.02)


@pytest.mark.parametrize(("share", "gravity"), [(0.3, None), (0.5, Gravity.CAUTION), (1.2, Gravity.DANGER)])
@pytest.mark.parametrize("rigid", [True, False])
def test_warning_near_a_resonance(share, gravity, rigid):
    line, speed = heavy(share)
    found = tn.kinetostatics(line, speed=speed, rigid=rigid, inertia=True).findings
    assert [f.gravity for f in found] == ([] if gravity is None else [gravity])
    if gravity is not None:
        assert "natural frequency" in found[0].sentence
    assert not tn.kinetostatics(line, speed=speed, rigid=rigid).findings

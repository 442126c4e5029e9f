"""Tripod, ideal and double-Cardan joints, alone and in a chain."""

import numpy as np
import pytest
from tripod_model import Tripod

import trunnion as tn
from trunnion.laws import double_cardan, hooke, tripod

PHI = np.arange(72) * 2 * np.pi / 72
CASES = {  # radius, length, degrees: third harmonic
    "9 deg": (0.070, 0.940, 9.0, 3.6529e-5),
    "20 deg": (1.0, 20.0, 20.0, 2.8293e-4),
}


@pytest.fixture(scope="module")
def solved():
    """Rotation behind the far end and spider centres over the turn, by case."""
    found = {}
    for name, (radius, length, degrees, _) in CASES.items():
        model = Tripod(radius, length, np.radians(degrees))
        states = [model.solve(phi) for phi in PHI]
        found[name] = np.array([s[3] for s in states]), np.array([s[0] for s in states])
    return found


@pytest.mark.parametrize("name", CASES)
def test_tripod_law_against_the_rigid_joint_in_space(name, solved):
    radius, length, degrees, published = CASES[name]
    turned, _ = solved[name]
    # the law counts from the outer side of the bend, the model's x axis points to the inner one
    chi = PHI - np.pi
    spectrum = 2 * np.fft.fft(turned - PHI) / 72
    third = 2 * np.mean((turned - PHI) * np.sin(3 * chi))
    assert third == pytest.approx(published, rel=5e-5)
    assert third == pytest.approx(float(tripod.amplitude(np.radians(degrees), radius / length)), rel=1e-4)
    assert np.delete(np.abs(spectrum), [3, 69]).max() < 1e-4 * third
    law = tripod.law(np.radians(degrees), radius / length).at(chi).output - chi
    assert np.abs(turned - PHI - law).max() < 2e-4 * third


@pytest.mark.parametrize("name", CASES)
def test_spider_orbit(name, solved):
    radius, _, degrees, _ = CASES[name]
    _, centres = solved[name]
    # R tan²(β/2), three times a turn in the sense of rotation
    size, chi = radius * np.tan(np.radians(degrees) / 2) ** 2, PHI - np.pi
    predicted = size * np.stack([np.cos(3 * chi), np.sin(3 * chi)])
    # to leading order: off by tan²(β/2) of itself, and by what the shaft's tilt moves it
    assert np.abs(centres[:, :2].T - predicted).max() < 0.05 * size


def test_tripod_couple_is_that_of_an_ideal_joint_on_average():
    bend = np.radians(9)
    model = Tripod(0.070, 0.940, bend)
    moments = np.array([model.moment(phi) for phi in PHI])
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e5),
            tn.TripodJoint(angle=bend, radius=0.070, length=0.940),
            tn.Disk(inertia=1.0, load_torque=1.0),
        ]
    )
    couple = tn.kinetostatics(line).secondary_couple
    assert moments[:, 0].mean() == pytest.approx(np.tan(bend / 2), rel=3e-5)
    assert -couple[0, 0].mean() == pytest.approx(np.tan(bend / 2), rel=1e-8)
    assert np.ptp(moments[:, 0]) / 2 < 0.0031 * np.tan(bend / 2)


@pytest.mark.parametrize("spider", ["input", "output"])
def test_tripod_in_a_chain(spider):
    a = float(tripod.amplitude(np.radians(20), 0.05))
    joint = tn.TripodJoint(angle="20 deg", radius=0.05, length=1.0, spider=spider)
    disk = tn.Disk(inertia=1.0, load_torque=30.0)
    result = tn.kinetostatics(tn.Driveline([tn.ConstantSpeed(), joint, disk]), speed=2.0)
    sign = 1 if spider == "output" else -1
    assert np.allclose(result.output_speed, 2 * (1 + sign * 3 * a * np.cos(3 * result.input_angle)), atol=1e-15)
    assert result.irregularity == pytest.approx(6 * a, rel=1e-6)
    assert result.power_residual < 1e-12


def test_ideal_joint_passes_rotation_and_has_a_steady_couple():
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e5),
            tn.IdealJoint(angle="24 deg"),
            tn.Disk(inertia=1, load_torque=50),
        ]
    )
    result = tn.kinetostatics(line)
    assert np.all(result.output_speed == 1)
    assert np.allclose(result.secondary_couple[:, 0], -50 * np.tan(np.radians(12)))
    assert not np.any(result.secondary_couple[:, 1])
    # the two shafts are in equilibrium: what one feels along u the other feels along its own u
    rotating = np.hypot(result.secondary_couple_rotating[:, 0], result.secondary_couple_rotating[:, 1])
    assert np.allclose(rotating, 50 * np.tan(np.radians(12)))


def test_plane_of_an_ideal_joint_turns_the_planes_behind_it():
    """Two equal Hooke's joints with a bend between them: the fork offset must follow both planes."""

    def line(offset):
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1e5),
                tn.Disk(inertia=1.0),
                tn.HookeJoint(angle=0.3),
                tn.Shaft(stiffness=1e5, fork_offset=offset),
                tn.IdealJoint(angle=0.2, plane=0.5),
                tn.Disk(inertia=1.0),
                tn.HookeJoint(angle=0.3, plane=0.4),
                tn.Shaft(stiffness=1e5),
                tn.Disk(inertia=1.0, load_torque=20.0),
            ]
        )

    assert tn.kinetostatics(line(0.9)).irregularity < 1e-12
    assert tn.kinetostatics(line(0.4)).irregularity > 0.05


def test_kinetostatics_turn_as_the_dynamic_equations_do():
    """Speeds and accelerations of a line with every kind of joint they share, against ``base_motion``."""
    from trunnion.equations.coefficients import assemble
    from trunnion.equations.kinematics import base_motion

    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e9, fork_offset=0.3),
            tn.Disk(inertia=1.0),
            tn.HookeJoint(angle=0.4, plane=0.2),
            tn.Shaft(stiffness=1e9, fork_offset=1.0),
            tn.IdealJoint(angle=0.1, plane=0.7),
            tn.Disk(inertia=1.0),
            tn.HookeJoint(angle=-0.3, plane=0.5),
            tn.DoubleCardanJoint(angle=0.3, plane=0.4),
            tn.Shaft(stiffness=1e9, fork_offset=0.9),
            tn.Disk(inertia=1.0),
            tn.Ratio(teeth_in=3, teeth_out=5),
            tn.HookeJoint(angle=0.5, plane=0.1),
            tn.Shaft(stiffness=1e9),
            tn.Disk(inertia=1.0),
        ]
    )
    result = tn.kinetostatics(line, speed=2.0, turns=5)
    assembly = assemble(line)
    coefficients = assembly.coefficients(assembly.table(1))
    base = base_motion(assembly.topology, coefficients, result.input_angle)
    assert np.allclose(result.output_speed, 2 * base.speed[0, :, -1], atol=1e-13)
    assert np.allclose(result.output_acceleration, 4 * base.acceleration[0, :, -1], atol=1e-13)


@pytest.mark.parametrize("degrees", [10, 30, 60])
def test_centred_double_cardan_is_homokinetic(degrees):
    joint = tn.DoubleCardanJoint(angle=tn.deg(degrees), yoke_length=0.1)
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e5),
            joint,
            tn.Shaft(stiffness=1e5),
            tn.Disk(inertia=1, load_torque=40),
        ]
    )
    result = tn.kinetostatics(line, supports=[("Shaft 1", -0.4, -0.1), ("Shaft 2", 0.1, 0.5)])
    assert result.irregularity < 1e-12
    assert result.joints == ("DoubleCardanJoint 1, first cross", "DoubleCardanJoint 1, second cross")
    assert result.supports.joint_force.shape == (2, 3, 720)


def test_double_cardan_without_centring():
    first, second = double_cardan.halves(0.6, 1.3)
    assert np.sin(first) / 1.0 == pytest.approx(np.sin(second) / 1.3, rel=1e-14)
    chi = np.linspace(0, 7, 40)
    composed = hooke.law(second).at(hooke.law(first).at(chi).output + np.pi / 2).output - np.pi / 2
    law = double_cardan.law(0.6, 1.3)
    assert np.allclose(law.at(chi).output, composed, atol=1e-14)
    line = tn.Driveline([tn.ConstantSpeed(), tn.DoubleCardanJoint(angle=0.6, distance_ratio=1.3), tn.Disk(inertia=1)])
    result = tn.kinetostatics(line)
    q = np.cos(second) / np.cos(first)
    assert result.irregularity == pytest.approx(abs(q - 1 / q), rel=1e-9)


def test_tripod_derivatives():
    chi = np.linspace(0, 7, 40)
    step = 1e-6
    law = tripod.law(0.5, 0.2)
    below, here, above = (law.at(chi + by) for by in (-step, 0.0, step))
    assert np.allclose((above.output - below.output) / (2 * step), here.ratio, atol=1e-8)
    assert np.allclose((above.ratio - below.ratio) / (2 * step), here.slope, atol=1e-8)
    assert tripod.amplitude(0.0, 0.2) == 0


def test_even_joints_are_one_to_the_dynamics():
    def line(joint):
        shaft = tn.Shaft(stiffness=1e5)
        return tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=1), joint, shaft, tn.Disk(inertia=1)])

    ideal = tn.stability(line(tn.IdealJoint(angle=0.3)), 100.0)
    for even in (
        tn.DoubleCardanJoint(angle=0.3),
        tn.RzeppaJoint(angle=0.3),
        tn.TripodJoint(angle=0.0, radius=1, length=2),
    ):
        found = tn.stability(line(even), 100.0)
        assert np.allclose(found.exponents.real, ideal.exponents.real, atol=1e-9)

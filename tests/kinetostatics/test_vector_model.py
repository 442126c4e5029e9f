"""The package against rigid bodies in space: motion to rounding, forces and couples to 1e-10 of the load."""

import lines
import numpy as np
import pytest
import vector_model
from vector_model import Line

import trunnion as tn
from trunnion.response.kinetostatics.chain import chain
from trunnion.response.kinetostatics.frames import member_frames

CASES = {
    "one joint": lines.random_line(1, 0),
    "three joints, accelerating": lines.random_line(3, 1, acceleration=2.0),
    "six joints": lines.random_line(6, 2),
    "floating shaft": lines.random_line(2, 3, bearings={0: (-0.3, -0.1), 2: (0.1, 0.4)}),
    "centre bearing": lines.random_line(3, 4, bearings={0: (-0.3, -0.1), 1: (0.2,), 3: (0.1, 0.4)}),
    "bearings everywhere": lines.random_line(2, 5, bearings={0: (-0.3, -0.1), 1: (0.1, 0.2), 2: (0.1, 0.4)}),
    "output carried by its joint": lines.random_line(1, 7, bearings={0: (-0.3, -0.1), 1: (0.4,)}),
    "inertia": lines.random_line(2, 6, inertias=[1.0, 2.0, 3.0], acceleration=1.0),
    "six joints with inertia": lines.random_line(6, 8, inertias=[1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 0.1]),
    "friction": lines.random_line(2, 9, pin_friction=0.03, bearings={0: (-0.3, -0.1), 2: (0.1, 0.4)}),
    "driven by its load, friction": lines.random_line(2, 10, pin_friction=0.03, load=-80.0),
    "bent the other way": lines.random_line(2, 11, angles=[-0.4, 0.3]),
}


@pytest.mark.parametrize("name", CASES)
def test_motion_torques_couples_and_forces(name):
    line = CASES[name]
    n = len(line.angles)
    result = tn.kinetostatics(lines.driveline(line), points=24, **lines.arguments(line))
    frames = member_frames(chain(result.line))
    assert np.allclose(frames[:, 0], line.axes, atol=1e-14)
    size = abs(line.load)
    for p, phi in enumerate(result.input_angle):
        state = vector_model.motion(line, phi)
        truth = vector_model.forces(line, state)
        assert np.allclose(result.speed[:, p], state.speed, rtol=0, atol=1e-13 * line.speed)
        assert np.allclose(result.acceleration[:, p], state.acceleration, rtol=0, atol=1e-12 * line.speed**2)
        assert abs(result.drive_torque[p] - truth["drive_torque"]) < 1e-10 * size
        passed = vector_model.shaft_torques(line, state, truth)
        assert np.allclose(result.transmitted[:, p], passed, rtol=0, atol=1e-10 * size)
        for j in range(n):
            for side in (0, 1):
                axis, normal = line.axes[j + side], line.normals[j]
                couple = -truth["pin_moment"][j, side]
                couple = couple - (couple @ axis) * axis
                fork = 2 * j + side
                standing = [couple @ np.cross(normal, axis), couple @ normal]
                assert np.allclose(result.secondary_couple[fork, :, p], standing, rtol=0, atol=1e-10 * size)
                arm = (state.a, state.b)[side][j]
                rotating = [couple @ arm, couple @ np.cross(axis, arm)]
                found = result.secondary_couple_rotating[fork, :, p]
                # which of the two opposite arms is called the arm is nobody's business
                error = min(np.abs(found - rotating).max(), np.abs(found + rotating).max())
                assert error < 1e-10 * size
        if line.bearings:
            holders = [m for m in sorted(line.bearings) for _ in line.bearings[m]]
            for b, m in enumerate(holders):
                force = frames[m][1:].T @ result.supports.force[b, :, p]
                assert np.allclose(force, -truth["bearing_force"][b], rtol=0, atol=1e-10 * size / 0.1)
            for j in range(n):
                force = frames[j + 1].T @ result.supports.joint_force[j, :, p]
                assert np.allclose(force, truth["pin_force"][j, 0], rtol=0, atol=1e-10 * size / 0.1)


def test_elastic_twists():
    line = lines.random_line(3, 12, stiffness=[3000.0, 2000.0, 2500.0, 1e12])
    result = tn.kinetostatics(lines.driveline(line), speed=line.speed, points=36, rigid=False)
    assert 0.02 < np.abs(result.twist).max() < 0.2
    for p in range(0, 36, 5):
        state, truth, twists = vector_model.elastic(line, result.input_angle[p])
        assert np.allclose(result.twist[:3, p], twists, rtol=0, atol=1e-12)
        assert abs(result.drive_torque[p] - truth["drive_torque"]) < 1e-9


def test_angles_accumulate():
    """Rotation of each shaft, followed fork by fork through the turn."""
    line = lines.random_line(4, 13)
    result = tn.kinetostatics(lines.driveline(line), points=90)
    turned = np.zeros(4)
    before = vector_model.motion(line, 0.0)
    for p, phi in enumerate(result.input_angle[1:], start=1):
        state = vector_model.motion(line, phi)
        for j in range(4):
            old, new, axis = before.b[j], state.b[j], line.axes[j + 1]
            step = np.arctan2(axis @ np.cross(old, new), old @ new)
            turned[j] += (step + np.pi / 2) % np.pi - np.pi / 2
        before = state
        assert np.allclose(result.angle[1:, p], turned, rtol=0, atol=1e-12)


def test_hundred_times_faster_than_angle_by_angle():
    """The benchmark's claim on a small sample: 10⁴ angles × 6 joints against the vector model's own pace."""
    from time import perf_counter

    line = lines.random_line(6, 2)
    described = lines.driveline(line)
    start = perf_counter()
    for phi in np.linspace(0, 6, 10):
        vector_model.forces(line, vector_model.motion(line, phi))
    per_angle = (perf_counter() - start) / 10
    tn.kinetostatics(described, points=1000)
    start = perf_counter()
    tn.kinetostatics(described, points=10_000)
    assert perf_counter() - start < 10_000 * per_angle / 100


def test_the_vector_model_knows_the_single_joint():
    """The model itself against the textbook: ω₂/ω₁ between cos β and 1/cos β."""
    line = Line(angles=[0.5], planes=[0.0], fork_offsets=[0.0])
    assert abs(vector_model.motion(line, 0.0).speed[1] - 1 / np.cos(0.5)) < 1e-15
    assert abs(vector_model.motion(line, np.pi / 2).speed[1] - np.cos(0.5)) < 1e-15


@pytest.mark.parametrize("name", ["one joint", "three joints, accelerating", "six joints", "bent the other way"])
def test_tilts_of_the_crosses(name):
    """From the pins' directions in space: how far each fork's pins tip out of the plane square to the other shaft."""
    line = CASES[name]
    result = tn.kinetostatics(lines.driveline(line), points=24, **lines.arguments(line))
    states = [vector_model.motion(line, phi) for phi in result.input_angle]
    for j in range(len(line.angles)):
        front = np.arcsin([s.b[j] @ line.axes[j] for s in states])
        behind = np.arcsin([s.a[j] @ line.axes[j + 1] for s in states])
        for found, truth in zip(result.cross_tilt[2 * j : 2 * j + 2], (front, behind), strict=True):
            # which of the two opposite pins is meant is the same for the whole turn
            assert min(np.abs(found - truth).max(), np.abs(found + truth).max()) < 1e-13
        assert np.abs(result.cross_tilt[2 * j]).max() <= abs(line.angles[j]) + 1e-14


def test_tilts_of_the_printed_relations():
    """S2 (4) at its own angles, its α_i1 read as α_i; and no tilt where a joint has no cross."""
    turn = tn.kinetostatics(tn.catalogue("bicardan-elastic"), points=360)
    alpha, phi = np.deg2rad(27.99), turn.input_angle
    tilted = np.sin(alpha) * np.cos(phi) / np.sqrt(1 - np.sin(alpha) ** 2 * np.cos(phi) ** 2)
    assert np.tan(turn.cross_tilt[0]) == pytest.approx(np.tan(alpha) * np.sin(phi), abs=1e-13)
    assert np.tan(turn.cross_tilt[1]) == pytest.approx(tilted, abs=1e-13)
    with_balls = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.RzeppaJoint(angle=0.1)]
    plain = tn.kinetostatics(tn.Driveline([*with_balls, tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0)]))
    assert plain.cross_tilt.shape == (2, 720) and np.isnan(plain.cross_tilt).all()


def test_rate_of_the_tilts_is_the_swing_of_the_cross():
    line = CASES["one joint"]
    result = tn.kinetostatics(lines.driveline(line), points=720, **lines.arguments(line))
    step = result.input_angle[1]
    for tilt, which in zip(result.cross_tilt, (0, 1), strict=True):
        rate = line.speed * (np.roll(tilt, -1) - np.roll(tilt, 1)) / (2 * step)
        swing = [vector_model.motion(line, phi).swing[0][which] for phi in result.input_angle]
        assert np.abs(rate) == pytest.approx(np.abs(swing), abs=1e-4 * line.speed)

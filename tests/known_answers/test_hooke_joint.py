"""Hooke's joint against its textbook numbers (Seherr-Thoss, Schmelz, Aucktor, Universal Joints and
Driveshafts, 2nd ed., section 1.2) and against the geometry of a cross in space."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.kinematics import base_motion
from trunnion.laws import hooke
from trunnion.laws.joint import TransmittedRotation

Array = NDArray[np.float64]
TURN = np.linspace(0.0, 2 * np.pi, 20_001)


def passed(chi: Array, beta: float) -> TransmittedRotation:
    return hooke.law(beta).at(chi)


@pytest.mark.parametrize(
    ("degrees", "lead_degrees", "acceleration"),
    [(10, 0.4386, 0.030626), (20, 1.7817, 0.124966), (30, 4.1172, 0.294571), (45, 9.8793, 0.787200)],
)
def test_lead_and_acceleration(degrees: float, lead_degrees: float, acceleration: float) -> None:
    beta = np.deg2rad(degrees)
    swept = np.rad2deg(np.abs(passed(TURN, beta).output - TURN).max())
    assert swept == pytest.approx(lead_degrees, abs=6e-5)
    assert np.abs(passed(TURN, beta).slope).max() == pytest.approx(acceleration, abs=6e-7)


@pytest.mark.parametrize("degrees", [1, 10, 30, 60, 85])
def test_irregularity_and_mean_square(degrees: float) -> None:
    beta = np.deg2rad(degrees)
    eta = passed(TURN, beta).ratio
    assert np.tan(beta) * np.sin(beta) == pytest.approx(np.ptp(eta), rel=1e-7)
    assert eta.max() == pytest.approx(1 / np.cos(beta), rel=1e-12) and eta[0] == eta.max()
    assert eta.min() == pytest.approx(np.cos(beta), rel=1e-6)
    assert (np.cos(beta) + 1 / np.cos(beta)) / 2 == pytest.approx(np.mean(eta[:-1] ** 2), rel=1e-12)
    assert np.mean(eta[:-1]) == pytest.approx(1.0, rel=1e-12)


def test_industry_guideline() -> None:
    """U ≤ 0.0027, quoted as an equivalent angle of 3°, is 2.98°; 3° gives 0.00274."""
    for degrees, irregularity, within in ((3, 0.00274, 5e-6), (2.98, 0.0027, 1e-5)):
        assert np.ptp(passed(TURN, np.deg2rad(degrees)).ratio) == pytest.approx(irregularity, abs=within)


@pytest.mark.parametrize("beta", [0.05, 0.3, 0.8, 1.3])
def test_derivatives_match_differences(beta: float) -> None:
    chi, h = np.linspace(-4, 4, 401), 1e-5
    above, below, here = (passed(chi + by, beta) for by in (h, -h, 0.0))
    for high, low, exact in zip(above[:-1], below[:-1], here[1:], strict=True):
        differenced = (high - low) / (2 * h)
        assert np.abs(differenced - exact).max() < 1e-7 * max(1.0, np.abs(exact).max())


@pytest.mark.parametrize("beta", [0.2, 1.0])
def test_law_is_tangent_and_half_turn_periodic(beta: float) -> None:
    chi = np.linspace(-3, 3, 501)
    psi = passed(chi, beta).output
    assert np.abs(np.sin(psi) * np.cos(chi) * np.cos(beta) - np.cos(psi) * np.sin(chi)).max() < 1e-15
    assert np.abs(psi - chi).max() < np.pi / 2
    assert np.abs(passed(chi + np.pi, beta).output - psi - np.pi).max() < 5e-15


def test_straight_joint_passes_rotation() -> None:
    assert np.array_equal(passed(TURN, 0.0).output, TURN)
    assert np.all(passed(TURN, 0.0).ratio == 1.0)
    # ψ − χ = tan²(β/2) sin 2χ to leading order.
    small = 1e-4
    assert np.abs(passed(TURN, small).output - TURN - small**2 / 4 * np.sin(2 * TURN)).max() < 1e-15


def test_papers_start_a_quarter_turn_later() -> None:
    """S1 writes η = cos β/(1 − sin²β sin²φ)."""
    beta = 0.7
    printed = np.cos(beta) / (1 - np.sin(beta) ** 2 * np.sin(TURN) ** 2)
    assert np.abs(passed(TURN + np.pi / 2, beta).ratio - printed).max() < 1e-14


def _rotated(vector: Array, axis: Array, angle: float) -> Array:
    along = axis * (axis @ vector)
    return np.cos(angle) * (vector - along) + np.sin(angle) * np.cross(axis, vector) + along


def _angle_about(axis: Array, zero: Array, arm: Array) -> float:
    return float(np.arctan2(np.cross(zero, arm) @ axis, zero @ arm))


@pytest.mark.parametrize(
    ("betas", "fork_offset", "plane", "start"),
    [((0.4, 0.7), 0.5, -1.1, 0.2), ((0.9, 0.3), -2.0, 0.8, 1.0), ((0.5, 0.5), 0.0, 0.0, 0.3)],
)
def test_two_joints_in_space(betas: tuple[float, float], fork_offset: float, plane: float, start: float) -> None:
    """Fork offsets and planes as described, against two crosses in space: arms square to each other, each
    square to its shaft; the second joint plane turned by ``plane`` about the intermediate shaft."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1.0, fork_offset=start),
            tn.Disk(inertia=1.0),
            tn.HookeJoint(angle=betas[0]),
            tn.Shaft(stiffness=1.0, fork_offset=fork_offset),
            tn.Disk(inertia=1.0),
            tn.HookeJoint(angle=betas[1], plane=plane),
            tn.Shaft(stiffness=1.0),
            tn.Disk(inertia=1.0),
        ]
    )
    assembly = assemble(line)
    tau = np.linspace(0, 2 * np.pi, 37)
    motion = base_motion(assembly.topology, assembly.coefficients(assembly.table(1, 1.0)), tau)
    first, second = assembly.topology.joints

    axis_a = np.array([0.0, 0.0, 1.0])
    axis_b = np.array([np.sin(betas[0]), 0.0, np.cos(betas[0])])
    normal_1 = np.cross(axis_a, axis_b) / np.sin(betas[0])
    normal_2 = _rotated(normal_1, axis_b, plane)
    axis_c = _rotated(axis_b, normal_2, betas[1])
    for i, t in enumerate(tau):
        fork_a = _rotated(np.cross(normal_1, axis_a), axis_a, t + start)
        fork_b = np.cross(axis_b, fork_a)
        in_plane_1 = np.cross(normal_1, axis_b)
        assert _apart(_angle_about(axis_b, in_plane_1, fork_b), motion.angle[0, i, first]) < 1e-13
        fork_b2 = _rotated(fork_b, axis_b, fork_offset)
        fork_c = np.cross(axis_c, fork_b2)
        in_plane_2 = np.cross(normal_2, axis_c)
        assert _apart(_angle_about(axis_c, in_plane_2, fork_c), motion.angle[0, i, second]) < 1e-13


def _apart(a: float, b: float) -> float:
    """Distance of two directions of an arm, which has no head: modulo half a turn."""
    return abs((a - b + np.pi / 2) % np.pi - np.pi / 2)

"""A belt against equations written out with the stretch of its two spans."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

R1, R2, SPAN, OIL, J1, J2, J3 = 0.06, 0.15, 4e5, 1.5, 0.03, 0.4, 0.9
SHAFT = 5e3


def belt(**more: object) -> tn.Belt:
    sizes = {"radius_in": R1, "radius_out": R2, "span_stiffness": SPAN, "damping": OIL, "name": "belt"}
    return tn.Belt(**sizes | more)


def line(drive: object, *ends: object) -> tn.Driveline:
    return tn.Driveline([drive, belt(inertia_out=J2), tn.Shaft(stiffness=SHAFT, name="shaft"), *ends])


def test_stiffness_and_ratio() -> None:
    """Of a turn of the driving pulley by φ one span gains r₁φ and the other loses it: T = 2 k r₁² φ."""
    assert belt().torsional_stiffness == pytest.approx(2 * SPAN * R1**2, rel=1e-12)
    assert belt().speed_ratio == pytest.approx(2.5, rel=1e-15) and str(belt().fraction) == "5/2"


def test_frequencies_by_the_energy_of_the_spans() -> None:
    """V = 2 · ½ k (r₁φ₁ − r₂φ₂)², as each span stretches and relaxes by the difference of the rims' paths."""
    found = tn.natural_frequencies(line(tn.Disk(inertia=J1), tn.Disk(inertia=J3)))
    rims = np.array([R1, -R2, 0.0])
    twist = np.array([0.0, -1.0, 1.0])
    stiffness = 2 * SPAN * np.outer(rims, rims) + SHAFT * np.outer(twist, twist)
    # c (φ₁ − i φ₂)² with the dampers at the driving pulley.
    drag = np.array([1.0, -R2 / R1, 0.0])
    damping = OIL * np.outer(drag, drag)
    over = np.diag(1 / np.array([J1, J2, J3]))
    a = np.block([[np.zeros((3, 3)), np.eye(3)], [-over @ stiffness, -over @ damping]])
    values = np.linalg.eigvals(a)
    expected = np.sort_complex(values[values.imag > 1e-3])
    assert np.sort_complex(found.eigenvalue[1:, 0]) == pytest.approx(expected, rel=1e-9)
    assert found.rigid_body and found.names == ("Disk 1", "driven pulley of belt", "Disk 2")


def test_torques_of_a_driven_line() -> None:
    """Amplitudes over speed against a dense solution; the spans' torque is that at the driving pulley."""
    excited = tn.Disk(inertia=J3, excitation=[{"order": 2, "amplitude": 12.0}], load_torque=30.0)
    speeds = np.array([40.0, 90.0, 160.0])
    found = tn.order_response(line(tn.ConstantSpeed(), excited), speeds)
    for row, speed in enumerate(speeds):
        # The disk turns R1/R2 as fast as the input, and its torque twice with each of its own turns.
        w = 2 * speed * R1 / R2
        link = (2 * SPAN * R1**2 + 1j * w * OIL) * (R2 / R1) ** 2
        matrix = np.array([[link + SHAFT - w**2 * J2, -SHAFT], [-SHAFT, SHAFT - w**2 * J3]])
        pulley, disk = np.linalg.solve(matrix, [0.0, 12.0])
        expected = [abs(link * pulley) * R1 / R2, abs(SHAFT * (disk - pulley))]
        assert np.abs(found.torque[row, 0]) == pytest.approx(expected, rel=1e-9)
        assert np.abs(found.mean_torque[row]) == pytest.approx([30.0 * R1 / R2, 30.0], rel=1e-12)


def test_motion_in_time_agrees_with_the_orders() -> None:
    """The nonlinear equations of the same line."""
    excited = tn.Disk(inertia=J3, excitation=[{"order": 2, "amplitude": 12.0}], viscous_load=2.0)
    driven = line(tn.ConstantSpeed(), excited)
    orders, response = tn.order_response(driven, [90.0]), tn.periodic_response(driven, 90.0)
    swing = (response.torque.max(axis=0) - response.torque.min(axis=0)) / 2  # at the points of the period alone
    assert swing == pytest.approx(orders.vibratory_torque[0], rel=1e-3)

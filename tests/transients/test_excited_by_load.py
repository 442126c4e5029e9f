"""Excitations over load and by the square of the speed in transients, against linear responses at one speed."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

SPEED = 40.0


def line(**excitation: object) -> tn.Driveline:
    engine = tn.Disk(name="engine", inertia=1.0, drive_share=1, excitation=[{"order": 2, **excitation}])
    load = tn.Disk(name="load", inertia=3.0, load_torque=60.0)
    return tn.Driveline([engine, tn.Shaft(name="shaft", stiffness=8e3, damping=60.0), load])


@pytest.mark.parametrize(
    "excitation",
    [
        {"quadratic_amplitude": 4e-4},
        {"quadratic_amplitude": 4e-4, "frequency": 3.0},
        {"share": 0.008},
        {"torques": [0.0, 50.0, 100.0], "amplitudes": [0.1, 0.4, 1.2], "phases": [0.0, 0.3, 1.0]},
    ],
    ids=["by the square", "by the square and in time", "a share", "a table"],
)
def test_the_steady_vibration_is_that_of_the_linear_response(excitation: dict[str, object]) -> None:
    made = line(**excitation)  # small, so that the swing of the engine moves nothing
    run = tn.transient(made, 6.0, speed=SPEED)
    times = np.linspace(5.0, 6.0, 4001)
    late = run.torque_at(times)[:, 0]
    order = 2 + (3.0 / SPEED if "frequency" in excitation else 0.0)
    basis = np.stack([np.ones_like(times), np.cos(order * SPEED * times), np.sin(order * SPEED * times)], axis=1)
    found = np.linalg.lstsq(basis, late, rcond=None)[0]
    known = tn.order_response(made, [SPEED])
    assert abs(found[0]) == pytest.approx(60.0, rel=1e-3)
    size = float(np.hypot(*found[1:]))
    assert size == pytest.approx(float(abs(known.torque).max()), rel=1e-3)


def test_a_share_of_what_a_propeller_resists_with() -> None:
    blades = [{"order": 4, "share": 0.01, "phase": 0.2}]
    propeller = tn.Disk(name="propeller", inertia=3.0, quadratic_load=0.05, viscous_load=0.5, excitation=blades)
    drive = tn.Disk(name="engine", inertia=1.0)
    made = tn.Driveline([drive, tn.Shaft(stiffness=8e3, damping=60.0), propeller])
    pull = [tn.AppliedTorque(on="engine", time=[0.0, 1.0], torque=[100.0, 200.0])]
    run = tn.transient(made, 1.0, torque=pull, speed=SPEED)
    moving = run.at(np.linspace(0, 1, 301))
    w, phi = moving.speed[:, 1], moving.angle[:, 1]
    expected = 0.01 * (0.5 * w + 0.05 * w**2) * np.cos(4 * phi + 0.2)
    np.testing.assert_allclose(moving.applied[:, 1], expected, rtol=1e-9, atol=1e-12)


def test_a_table_over_the_speed_is_read_at_each_instant() -> None:
    table = {"speeds": [30.0, 45.0, 60.0], "amplitudes": [2.0, 6.0, 3.0], "phases": [0.0, 0.5, 0.2]}
    shaken = tn.Disk(name="fan", inertia=3.0, excitation=[{"order": 3, "phase": 0.1, **table}])
    made = tn.Driveline([tn.Disk(name="engine", inertia=1.0), tn.Shaft(stiffness=8e3, damping=60.0), shaken])
    pull = [tn.AppliedTorque(on="engine", time=[0.0], torque=[60.0], between="steps")]
    run = tn.transient(made, 1.0, torque=pull, speed=SPEED)
    moving = run.at(np.linspace(0, 1, 301))
    points = np.array(table["amplitudes"]) * np.exp(1j * np.array(table["phases"]))
    at = np.interp(moving.speed[:, 1], table["speeds"], points.real) + 1j * np.interp(
        moving.speed[:, 1], table["speeds"], points.imag
    )
    expected = (at * np.exp(1j * (3 * moving.angle[:, 1] + 0.1))).real
    np.testing.assert_allclose(moving.applied[:, 1], expected, rtol=1e-9, atol=1e-10)
    beyond = tn.transient(made, 3.0, torque=pull, speed=SPEED)
    assert beyond.outcome.kind == "beyond the table" and beyond.speed[-1, 1] == pytest.approx(60.0, rel=1e-3)


def test_an_amplitude_by_load_stays_as_the_share_does() -> None:
    by_load = line(torques=[0.0, 100.0], amplitudes=[10.0, 110.0])  # 70 N m at 60
    same = line(amplitude=70.0)
    asked = {"torque": [tn.AppliedTorque(on="load", time=[0.0, 1.0], torque=[0.0, 80.0])], "speed": SPEED}
    one, other = tn.transient(by_load, 1.0, **asked), tn.transient(same, 1.0, **asked)
    np.testing.assert_allclose(
        one.torque_at(np.linspace(0, 1, 101)), other.torque_at(np.linspace(0, 1, 101)), atol=1e-6
    )


def test_firing_angles_and_masses_of_an_engine() -> None:
    """Two cylinders half a turn apart: order 1 of their masses cancels, order 2 doubles."""
    angles = {"firing_angles": [0.0, np.pi]}
    for order, factor in ((1, 0.0), (2, 2.0)):
        engine = tn.Disk(
            name="engine",
            inertia=1.0,
            drive_share=1,
            excitation=[{"order": order, "quadratic_amplitude": 0.01}],
            **angles,
        )
        load = tn.Disk(name="load", inertia=3.0)
        run = tn.transient(tn.Driveline([engine, tn.Shaft(stiffness=8e3, damping=60.0), load]), 0.5, speed=SPEED)
        times = np.linspace(0, 0.5, 400)
        moving = run.at(times)
        applied = moving.applied[:, 0]
        expected = factor * 0.01 * moving.speed[:, 0] ** 2 * np.cos(order * moving.angle[:, 0])
        np.testing.assert_allclose(applied, expected, atol=1e-9 * 0.01 * SPEED**2 + 1e-9)


def test_what_would_change_is_refused_by_name() -> None:
    by_load = line(torques=[0.0, 100.0], amplitudes=[10.0, 110.0])
    driven = [tn.AppliedTorque(on="engine", formula="60 + t")]
    with pytest.raises(
        tn.InputError, match="engine.excitation 1: goes by the load of its disk, which such a torque gives"
    ):
        tn.transient(by_load, 1.0, torque=driven, speed=SPEED)
    both = line(speeds=[1.0, 500.0], torques=[0.0, 100.0], amplitudes=[10.0, 20.0, 110.0, 120.0])
    with pytest.raises(tn.InputError, match="goes by speed and load, and the load of its disk is given here"):
        tn.transient(both, 1.0, torque=driven, speed=SPEED)
    rubs = [tn.FrictionTorque(on="engine", torque=1.0)]
    with pytest.raises(tn.InputError, match="engine.excitation: has an amplitude that depends on the speed"):
        tn.transient(by_load, 1.0, friction=rubs, speed=SPEED)
    beyond = line(torques=[0.0, 30.0], amplitudes=[10.0, 110.0])
    with pytest.raises(tn.InputError, match="does not cover 60 N"):
        tn.transient(beyond, 1.0, speed=SPEED)

"""Machines act in a transient by their own curves: against equations of two inertias and a joint written out."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

import trunnion as tn

INERTIA, STIFFNESS, DAMPING, ANGLE = (0.5, 2.0), 2e4, 6.0, 0.2
KLOSS = {"breakdown_torque": 300.0, "breakdown_slip": 0.2, "synchronous_speed": 150.0}
POINTS = ((0.0, 0.0), (70.0, 50.0), (160.0, 180.0), (220.0, 300.0))
CURVE = [{"speed": speed, "torque": torque} for speed, torque in POINTS]
Torque = Callable[[float], float]


def line(motor: tn.Motor, load: object) -> tn.Driveline:
    shaft = tn.Shaft(name="shaft", stiffness=STIFFNESS, damping=DAMPING)
    return tn.Driveline([motor, tn.HookeJoint(angle=ANGLE), shaft, load])


def integrated(drive: Torque, resist: Torque, speed: float, times: np.ndarray) -> np.ndarray:
    """Speeds (time, 2) of the two inertias from even rotation on."""
    cosine, square = np.cos(ANGLE), np.sin(ANGLE) ** 2

    def rates(t: float, x: np.ndarray) -> list[float]:
        s, c = np.sin(x[0]), np.cos(x[0])
        behind = x[0] + np.arctan2(s * c * (1 - cosine), cosine * c * c + s * s)
        ratio = cosine / (1 - square * c * c)
        torque = STIFFNESS * (x[1] - behind) + DAMPING * (x[3] - ratio * x[2])
        return [x[2], x[3], (drive(x[2]) + ratio * torque) / INERTIA[0], (-torque - resist(x[3])) / INERTIA[1]]

    first = [0.0, 0.0, speed, speed]
    run = solve_ivp(rates, (0, times[-1]), first, "DOP853", rtol=1e-12, atol=1e-12, t_eval=times, max_step=2e-3)
    return run.y[2:].T


def kloss(speed: float) -> float:
    slip = 1 - speed / KLOSS["synchronous_speed"]
    return 2 * KLOSS["breakdown_torque"] * slip * 0.2 / (slip**2 + 0.2**2)


_through = PchipInterpolator(*np.array(POINTS).T)


def curve(speed: float) -> float:
    return float(_through(max(speed, 0.0)))


def governor(speed: float) -> float:
    return float(np.clip(8.0 * (120.0 - speed), -250.0, 250.0))


MOTORS: dict[str, tuple[dict[str, object], Torque]] = {
    "kloss": (KLOSS, kloss),
    "points": ({"curve": [{"speed": 0, "torque": 260}, {"speed": 250, "torque": 40}]}, lambda w: 260 - 220 * w / 250),
    "controlled": ({"gain": 8.0, "set_speed": 120.0, "torque_limit": 250.0}, governor),
    "controlled without limit": ({"gain": 1.5, "set_speed": 120.0}, lambda w: 1.5 * (120 - w)),
}
LOADS: dict[str, tuple[object, Torque]] = {
    "fan by points": (tn.Fan(name="load", inertia=2.0, curve=CURVE), curve),
    "pump by powers": (tn.Pump(name="load", inertia=2.0, viscous_load=0.7), lambda w: 0.7 * w),
    "propeller": (
        tn.Propeller(name="load", inertia=1.6, entrained_inertia=0.4, quadratic_load=0.006),
        lambda w: 0.006 * w * abs(w),
    ),
    "generator at constant power": (tn.Generator(name="load", inertia=2.0, power=9e3), lambda w: 9e3 / w),
    "generator on its mains": (
        tn.Generator(name="load", inertia=2.0, breakdown_torque=200.0, breakdown_slip=0.3, synchronous_speed=90.0),
        lambda w: -2 * 200.0 * (1 - w / 90) * 0.3 / ((1 - w / 90) ** 2 + 0.09),
    ),
}


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("motor", MOTORS)
def test_every_pair_of_machines_as_written_out(motor: str, load: str) -> None:
    stated, drive = MOTORS[motor]
    driven, resist = LOADS[load]
    run = tn.transient(line(tn.Motor(name="motor", inertia=0.5, **stated), driven), 0.3, speed=60.0, start=np.zeros(4))
    start = integrated(drive, resist, 60.0, np.linspace(0, 0.3, 40))
    times = np.linspace(0, 0.3, 40)
    speed = run.at(times).speed[:, run._stations]
    np.testing.assert_allclose(speed[0], start[0], rtol=1e-12)
    np.testing.assert_allclose(speed, start, rtol=2e-8)
    assert run.outcome.kind == "reached" and run.energy.error < 1e-9


def test_a_start_from_rest_by_the_curves_of_both() -> None:
    run = tn.transient(line(tn.Motor(name="motor", inertia=0.5, **KLOSS), LOADS["fan by points"][0]), 1.5, speed=0.0)
    times = np.linspace(0, 1.5, 30)
    expected = integrated(kloss, curve, 0.0, times)
    np.testing.assert_allclose(run.at(times).speed[:, run._stations], expected, atol=1e-6)


def test_what_resists_at_standstill_is_friction() -> None:
    """A fan whose curve begins at 20 N m stands until the shaft pulls with so much."""
    fan = tn.Fan(name="load", inertia=2.0, curve=[{"speed": 0, "torque": 20}, {"speed": 100, "torque": 20}])
    motor = tn.Motor(name="motor", inertia=0.5, curve=[{"speed": 0, "torque": 30}, {"speed": 100, "torque": 30}])
    straight = tn.Driveline([motor, tn.Shaft(name="shaft", stiffness=STIFFNESS), fan])
    run = tn.transient(straight, 0.2, speed=0.0)
    omega = np.sqrt(STIFFNESS / 0.5)
    lets_go = np.arccos(1 - 20 / 30) / omega  # k φ = 30 (1 − cos ωt)
    assert run.at([0.999 * lets_go]).speed[0, run._stations[1]] == 0.0
    assert run.at([1.05 * lets_go]).speed[0, run._stations[1]] > 0.0
    # From then on 10 N m accelerate the whole, whose momentum is what came in.
    held_by = -run.torque_at(lets_go * (np.arange(2000) + 0.5) / 2000)[:, 0].mean() * lets_go
    came = 30 * 0.2 - 20 * (0.2 - lets_go) - held_by
    assert INERTIA[0] * run.speed[-1, 0] + INERTIA[1] * run.speed[-1, 1] == pytest.approx(came, rel=1e-6)
    weak = straight.replace("motor", curve=[{"speed": 0, "torque": 9}, {"speed": 100, "torque": 9}])
    assert np.abs(tn.transient(weak, 1.0, speed=0.0).speed[:, 1]).max() < 1e-15  # the shaft comes to 18 N m


@pytest.mark.parametrize("stated", [KLOSS, {"gain": 12.0, "torque_limit": 300.0}])
def test_a_motor_that_a_converter_has_set_keeps_its_balance_and_then_its_curve(stated: dict[str, float]) -> None:
    motor = tn.Motor(name="motor", inertia=0.5, drive_share=1.0, **stated)
    straight = tn.Driveline([motor, tn.Shaft(stiffness=STIFFNESS, damping=4.0), LOADS["fan by points"][0]])
    steady = tn.transient(straight, 0.5, speed=100.0)
    np.testing.assert_allclose(steady.speed, 100.0, rtol=1e-9)
    np.testing.assert_allclose(steady.torque[:, 0], -curve(100.0), rtol=1e-8)
    # More load: it settles where the moved curve gives so much.
    more = tn.AppliedTorque(on="load", time=[0, 1], torque=[-40, -40], hold=True)
    slower = tn.transient(straight, 12.0, speed=100.0, torque=[more]).speed[-1].mean()
    needed = curve(slower) + 40.0
    if "gain" in stated:
        assert needed == pytest.approx(curve(100.0) + 12.0 * (100.0 - slower), rel=1e-6)
    else:  # the slips at which Kloss gives both torques differ by the speeds' difference
        slip = [1 - tn_speed(torque) / 150.0 for torque in (needed, curve(100.0))]
        assert 150.0 * (slip[0] - slip[1]) == pytest.approx(100.0 - slower, rel=1e-6)


def tn_speed(torque: float) -> float:
    """Speed below the synchronous one at which Kloss's formula gives it, on its falling branch, by halving."""
    low, high = 150.0 * (1 - 0.2), 150.0
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if kloss(middle) > torque else (low, middle)
    return low


def test_passing_is_driven_by_the_motor_of_the_line() -> None:
    motor = tn.Motor(name="motor", inertia=1.0, curve=[{"speed": 0, "torque": 2.5}, {"speed": 100, "torque": 2.5}])
    shaft = tn.Shaft(stiffness=2e3, damping=1.0)
    bent = tn.Driveline([motor, tn.HookeJoint(angle="15 deg"), shaft, tn.Disk(name="load", inertia=4.0)])
    hung = tn.passing(bent, (15.0, 40.0))
    assert hung.outcome.kind == "captured" and hung.ending.speed == pytest.approx(24.3, abs=0.1)
    assert tn.passing(bent.replace("HookeJoint 1", angle="5 deg"), (15.0, 40.0)).outcome.kind == "passed"
    least = tn.least_drive(bent, (15.0, 40.0), factors=(2.0, 8.0), points=3, accuracy=0.9, phases=1)
    assert least.drive == "motor" and 2.0 < least.least <= 8.0


def test_a_torque_instead_of_a_converters_share() -> None:
    motor = tn.Motor(name="motor", inertia=0.5, drive_share=1.0, **KLOSS)
    pair = tn.Driveline([motor, tn.Shaft(stiffness=1e6, damping=40.0), tn.Disk(inertia=2.0)])
    push = tn.AppliedTorque(on="motor", time=[0, 1], torque=[50, 50])
    assert tn.transient(pair, 1.0, torque=[push], speed=0.0).speed[-1].mean() == pytest.approx(20.0, rel=1e-6)

"""Torques that follow with a first-order lag: against closed forms and equations of a reader's own, in which the torque
is a state too."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import trunnion as tn

MOTOR, LOAD, STIFFNESS, DAMPING = 0.5, 1.5, 2e4, 5.0


def controlled(**more: Any) -> tn.Motor:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return tn.Motor(name="motor", inertia=MOTOR, gain=4.0, set_speed=100.0, corner_frequency=30.0, **more)


def line(motor: tn.Motor | tn.Disk, *between: Any) -> tn.Driveline:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        shaft = tn.Shaft(name="shaft", stiffness=STIFFNESS, damping=DAMPING)
        return tn.Driveline([motor, *between, shaft, tn.Disk(name="load", inertia=LOAD)])


def in_closed_form(times: np.ndarray) -> np.ndarray:
    """Speeds of both and the motor's torque (time, 3) of the controlled motor from balance on, loaded by 50 N m."""
    whole, k, c = np.zeros((6, 6)), STIFFNESS, DAMPING
    whole[0, 2] = whole[1, 3] = 1.0
    whole[2, :5] = [-k / MOTOR, k / MOTOR, -c / MOTOR, c / MOTOR, 1 / MOTOR]
    whole[3, :4] = [k / LOAD, -k / LOAD, c / LOAD, -c / LOAD]
    whole[3, 5] = -50.0 / LOAD
    whole[4, 2], whole[4, 4], whole[4, 5] = -30.0 * 4.0, -30.0, 30.0 * 4.0 * 100.0
    begun = np.array([0.0, 0.0, 100.0, 100.0, 0.0, 1.0])
    return np.array([expm(whole * t) @ begun for t in times])[:, [2, 3, 4]]


BLOW = tn.AppliedTorque(on="load", time=[0.0], torque=[-50.0], between="steps")


def test_a_lagging_controller_in_closed_form() -> None:
    run = tn.transient(line(controlled()), 1.0, torque=[BLOW], speed=100.0, tolerance=1e-11)
    times = np.linspace(0.0, 1.0, 41)
    found, known = run.at(times), in_closed_form(times)
    assert np.abs(found.speed - known[:, :2]).max() < 1e-7 * 100.0
    assert np.abs(found.applied[:, 0] - known[:, 2]).max() < 1e-7 * 50.0
    assert run.energy.error < 1e-10
    at_once = tn.transient(line(controlled().but(corner_frequency=None)), 1.0, torque=[BLOW], speed=100.0)
    assert np.abs(at_once.at(times).speed - known[:, :2]).max() > 0.2  # so that the lag matters


def test_a_run_in_two_parts_keeps_its_torque() -> None:
    first = tn.transient(line(controlled()), 0.3, torque=[BLOW], speed=100.0, tolerance=1e-11)
    both = first.then(0.7)
    assert np.abs(both.at([1.0]).speed - in_closed_form(np.array([1.0]))[:, :2]).max() < 1e-5
    stiffer = first.then(0.1, line=line(controlled()).replace("shaft", damping=6.0))
    at_end = stiffer.at([0.3 + 1e-9]).applied[0, 0]
    assert at_end == pytest.approx(in_closed_form(np.array([0.3]))[0, 2], rel=1e-6)


def test_a_step_is_followed_from_nothing_and_a_table_from_its_first_value() -> None:
    """One inertia, in effect: T = 40 (1 − e^(−νt)), the speed its integral."""
    step = tn.AppliedTorque(on="motor", time=[0.0], torque=[40.0], between="steps", corner_frequency="20 rad/s")
    run = tn.transient(line(tn.Disk(name="motor", inertia=MOTOR)), 0.5, torque=[step], speed=10.0, tolerance=1e-11)
    t = np.linspace(0, 0.5, 11)
    found = run.at(t)
    assert np.allclose(found.applied[:, 0], 40.0 * (1 - np.exp(-20.0 * t)), atol=1e-8)
    mean = found.speed @ [MOTOR, LOAD] / (MOTOR + LOAD)
    assert np.allclose(mean, 10.0 + 40.0 / (MOTOR + LOAD) * (t - (1 - np.exp(-20.0 * t)) / 20.0), atol=1e-8)
    even = tn.AppliedTorque(on="motor", time=[0.0, 9.0], torque=[40.0, 40.0], corner_frequency=20.0)
    assert np.allclose(tn.transient(run.description, 0.2, torque=[even], speed=10.0).at([0.0, 0.1]).applied[:, 0], 40.0)


ANGLE, PLAY = 0.25, 4e-3


def by_hand(until: float, last: float = np.inf) -> Any:
    """Kloss's motor of two pole pairs from rest through a bent joint and a shaft with play: five states."""
    cosine, square = np.cos(ANGLE), np.sin(ANGLE) ** 2
    corner = 0.2 * 150.0 * 2

    def pulled(x: np.ndarray) -> tuple[float, float]:
        s, c = np.sin(x[0]), np.cos(x[0])
        behind = x[0] + np.arctan2(s * c * (1 - cosine), cosine * c * c + s * s)
        ratio = cosine / (1 - square * c * c)
        q = x[1] - behind
        return ratio, STIFFNESS * (q - np.clip(q, -PLAY, PLAY)) + DAMPING * (x[3] - ratio * x[2])

    def rates(t: float, x: np.ndarray) -> list[float]:
        ratio, shaft = pulled(x)
        slip = 1 - x[2] / 150.0
        kloss = 2 * 300.0 * slip * 0.2 / (slip**2 + 0.04)
        return [x[2], x[3], (x[4] + ratio * shaft) / MOTOR, -shaft / LOAD, corner * (kloss - x[4])]

    def there(t: float, x: np.ndarray) -> float:
        return (MOTOR * x[2] + LOAD * x[3]) / (MOTOR + LOAD) - last

    there.terminal = True  # type: ignore[attr-defined]
    return solve_ivp(
        rates, (0, until), np.zeros(5), "DOP853", rtol=1e-12, atol=1e-12, max_step=1e-4, dense_output=True,
        events=there if np.isfinite(last) else None,
    )  # fmt: skip


def with_play() -> tn.Driveline:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motor = tn.Motor(
            name="motor", inertia=MOTOR, breakdown_torque=300.0, breakdown_slip=0.2, synchronous_speed=150.0,
            pole_pairs=2,
        )  # fmt: skip
        play = tn.PiecewiseShaft(
            name="shaft", breakpoints=(-PLAY, PLAY), stiffnesses=(STIFFNESS, 0.0, STIFFNESS), damping=DAMPING
        )
        return tn.Driveline([motor, tn.HookeJoint(angle=ANGLE), play, tn.Disk(name="load", inertia=LOAD)])


def test_a_lagging_motor_starts_from_rest_through_a_joint_and_play() -> None:
    run = tn.transient(with_play(), 0.4, speed=0.0, tolerance=1e-11)
    known, times = by_hand(0.4), np.linspace(0.01, 0.4, 27)
    found = run.at(times)
    stations = run._stations
    assert np.abs(found.speed[:, stations].T - known.sol(times)[2:4]).max() < 1e-5 * 100
    assert np.abs(found.applied[:, stations[0]] - known.sol(times)[4]).max() < 1e-5 * 300
    assert run.energy.error < 1e-9


@pytest.mark.slow
def test_a_passage_with_a_lagging_motor() -> None:
    """Also in the compiled stretches that maps are made of, with a shaft without play."""
    found = tn.passing(with_play(), (0.0, 120.0))
    known = by_hand(2.0, last=120.0)
    assert found.outcome.kind == "passed"
    assert found.ending.time == pytest.approx(known.t_events[0][0], rel=1e-6)
    straight = tn.Shaft(name="shaft", stiffness=STIFFNESS, damping=DAMPING)
    plain = tn.Driveline([straight if e.name == "shaft" else e for e in with_play().elements])
    one = tn.capture_map(
        plain, (0.0, 120.0), ("HookeJoint 1.angle", 0.1, ANGLE, 2), ("factor", 1.0, 2.0, 2), drive="motor", phases=1
    )
    assert (one.share == 0.0).all()
    assert tn.passing(plain, (0.0, 120.0)).ending.time == pytest.approx(found.ending.time, rel=0.05)


def test_a_clutch_that_slips_under_a_lagging_torque() -> None:
    """Both sides by hand: the clutch carries 30 N m until the speeds meet."""
    push = tn.AppliedTorque(on="motor", time=[0.0], torque=[60.0], between="steps", corner_frequency=25.0)
    parts = [
        tn.Disk(name="motor", inertia=1.0), tn.SlipClutch(name="clutch", torque=30.0), tn.Disk(name="hub", inertia=1.0),
        tn.Shaft(name="shaft", stiffness=1e6, damping=100.0), tn.Disk(name="load", inertia=1.0),
    ]  # fmt: skip
    run = tn.transient(tn.Driveline(parts), 0.3, torque=[push], speed=5.0, tolerance=1e-10)
    # It sticks while T 2/3 < 30: until 1 - e^(-25 t) = 0.75, and slips from then on.
    slips = np.log(4.0) / 25.0
    gained = 5.0 + 60.0 / 3 * (slips - (1 - np.exp(-25.0 * slips)) / 25.0)
    later = 0.3 - slips
    pushed = 60.0 * (later - 0.25 * (1 - np.exp(-25.0 * later)) / 25.0)
    motor = gained + pushed - 30.0 * later
    assert run.at([0.3]).speed[0, 0] == pytest.approx(motor, abs=3e-3)

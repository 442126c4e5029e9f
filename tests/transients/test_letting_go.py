"""What stands by dry friction or sticks in a clutch lets go where a torque jumps, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.motion.transients.stepping import Stepper

A, F = tn.AppliedTorque, tn.FrictionTorque


def clutched(one: float, other: float, capacity: float) -> tn.Driveline:
    return tn.Driveline(
        [tn.Disk(name="motor", inertia=one), tn.SlipClutch(name="clutch", torque=capacity),
         tn.Disk(name="load", inertia=other)]
    )  # fmt: skip


def pair(one: float = 1.0, other: float = 1.0) -> tn.Driveline:
    shaft = tn.Shaft(name="shaft", stiffness=1e3, damping=1.0)
    return tn.Driveline([tn.Disk(name="motor", inertia=one), shaft, tn.Disk(name="load", inertia=other)])


def slipped(one: float, other: float, capacity: float, times: list[float], torques: list[float]) -> tuple[float, ...]:
    """Last speeds and heat of two inertias on a clutch under torques in steps, by straight lines of speed."""
    v, w, heat = 0.0, 0.0, 0.0
    for torque, length in zip(torques, np.diff(times), strict=False):
        left = float(length)
        while left > 0:
            slip = v - w
            if slip == 0 and abs(torque) * other / (one + other) <= capacity:
                v = w = v + torque / (one + other) * left
                break
            sense = np.sign(slip or torque)
            a, b = (torque - sense * capacity) / one, sense * capacity / other
            until = -slip / (a - b) if slip * (a - b) < 0 else np.inf
            step = min(left, until)
            heat += capacity * abs(slip + (a - b) * step / 2) * step
            v, w = v + a * step, w + b * step
            if until <= left:
                w = v
            left -= step
    return v, w, heat


def test_jumps_on_clutches_that_stick() -> None:
    rng = np.random.default_rng(7)
    slips = 0
    for _ in range(25):
        one, other, capacity = (float(x) for x in rng.uniform((0.3, 0.3, 5.0), (3.0, 3.0, 30.0)))
        times = [0.0, *np.sort(rng.uniform(0.1, 2.0, 4)).tolist(), 2.5]
        torques = (rng.uniform(-80, 80, 5) * rng.integers(0, 2, 5)).tolist()
        act = A(on="motor", time=times, torque=[*torques, 0.0], between="steps")
        run = tn.transient(clutched(one, other, capacity), 2.5, torque=[act], speed=0.0)
        v, w, heat = slipped(one, other, capacity, times, torques)
        np.testing.assert_allclose([*run.speed[-1], run.energy.losses], [v, w, heat], rtol=1e-8, atol=1e-8)
        assert run.outcome.kind == "reached" and run.peak_torque[0] <= capacity * (1 + 1e-9)
        slips += heat > 0
    assert 10 < slips < 25


def test_jumps_on_disks_that_stand() -> None:
    """Momentum is what the torque beyond friction gives from the jump on, of a disk that is not turned back."""
    rng = np.random.default_rng(3)
    for _ in range(12):
        inertia, friction, at = (float(x) for x in rng.uniform((1.0, 2.0, 0.1), (3.0, 10.0, 0.5)))
        static, way = friction * float(rng.uniform(1.0, 2.0)), float(rng.choice([-1.0, 1.0]))
        below, beyond = way * static * float(rng.choice([0.0, 0.9, 1.0])), way * static * float(rng.uniform(2.0, 4.0))
        act = A(on="motor", time=[0, at], torque=[below, beyond], between="steps")
        brake = F(on="motor", torque=friction, static=static)
        run = tn.transient(pair(inertia, 0.1), 1.0, torque=[act], friction=[brake], speed=0.0)
        momentum = run.speed[-1] @ [inertia, 0.1]
        assert momentum == pytest.approx((beyond - way * friction) * (1 - at), rel=1e-9)
        assert run.energy.error < 1e-9


def test_equal_and_then_more_lets_go() -> None:
    rising = A(on="motor", time=[0, 3], torque=[20.0, 40.0])
    run = tn.transient(clutched(1.0, 1.0, 10.0), 3.0, torque=[rising], speed=0.0)
    np.testing.assert_allclose(run.speed[-1], [60.0, 30.0], rtol=1e-9)
    brake = F(on="motor", torque=5.0, static=20.0)
    stood = tn.transient(pair(), 3.0, torque=[rising], friction=[brake], speed=0.0)
    assert stood.speed[-1].sum() == pytest.approx(90 - 15, rel=1e-7)


def test_what_goes_on_is_judged_anew() -> None:
    strong = [A(on="motor", time=[0], torque=[100.0], between="steps")]
    stuck = tn.transient(clutched(1.0, 1.0, 30.0), 1.0, torque=[strong[0].but(torque=[40.0])], speed=0.0)
    np.testing.assert_allclose(stuck.then(1.0, torque=strong).speed[-1], [90.0, 50.0], rtol=1e-9)
    brake = F(on="motor", torque=5.0, static=30.0)
    stood = tn.transient(pair(), 1.0, torque=[strong[0].but(torque=[20.0])], friction=[brake], speed=0.0)
    assert not stood.speed.any()
    assert stood.then(1.0, torque=strong).speed[-1].sum() == pytest.approx(95.0, rel=1e-9)
    less = stood.then(1.0, friction=[brake.but(static=10.0)])
    assert less.speed[-1].sum() == pytest.approx(15.0, rel=1e-9)


def test_friction_rubs_only_once_it_is_there() -> None:
    ramp = [A(on="motor", time=[0, 3], torque=[0.0, 60.0])]
    free = tn.transient(pair(), 3.0, torque=ramp, speed=0.0).speed[-1]
    for none in (F(on="load", torque=5.0, since=5.0), F(on="motor", torque=0.0)):
        np.testing.assert_allclose(tn.transient(pair(), 3.0, torque=ramp, friction=[none], speed=0.0).speed[-1], free)
    late = tn.transient(pair(), 3.0, torque=ramp, friction=[F(on="load", torque=5.0, since=2.0)], speed=0.0)
    assert late.speed[-1].sum() == pytest.approx(90 - 5, rel=1e-9)


def test_what_sticks_beyond_its_capacity_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stepper, "_lets_go", lambda *_: 0.0)
    step = [A(on="motor", time=[0, 1], torque=[0.0, 40.0], between="steps")]
    run = tn.transient(clutched(1.0, 1.0, 10.0), 2.0, torque=step, speed=0.0)
    assert run.outcome.kind == "friction exceeded" and "clutch sticks under 20 N m" in run.outcome.sentence
    stood = tn.transient(pair(), 2.0, torque=step, friction=[F(on="motor", torque=5.0)], speed=0.0)
    assert stood.outcome.kind == "friction exceeded" and "motor stands under 40 N m" in stood.outcome.sentence


def test_a_run_that_begins_at_the_upper_end_of_a_table_slows_down() -> None:
    slow = [
        A(on="motor", speed=[0.0, 50.0, 100.0], torque=[20.0, 10.0, 0.0]),
        A(on="load", time=[0, 1], torque=[-10, -10]),
    ]
    assert tn.transient(pair(), 0.5, torque=slow, speed=100.0).outcome.kind == "reached"
    with pytest.raises(tn.InputError, match="leaves its table"):
        tn.transient(pair(), 0.5, torque=slow[:1], speed=100.01)


def test_a_negative_start_with_a_drive_share_is_refused() -> None:
    shared = pair().replace("motor", drive_share=1.0).replace("load", viscous_load=2.0)
    with pytest.raises(tn.InputError, match="not backwards"):
        tn.transient(shared, 1.0, speed=-50.0)


def test_a_torque_that_jumps_over_a_level_crosses_it() -> None:
    step = [A(on="motor", time=[0, 1], torque=[0.0, 40.0], between="steps")]
    level = tn.LevelCrossing(of="clutch", torque=-10.0, ends=False)
    run = tn.transient(clutched(1.0, 1.0, 50.0), 2.0, torque=step, speed=0.0, crossing=[level])
    assert [t for t, _ in run.crossings] == [1.0]
    ended = tn.transient(clutched(1.0, 1.0, 50.0), 2.0, torque=step, speed=0.0, crossing=[level.but(ends=True)])
    assert ended.outcome.kind == "crossed" and ended.end == 1.0


def test_rolling_resistance_drives_no_vehicle_backwards() -> None:
    car = tn.Vehicle(name="car", mass=1500.0, wheel_radius=0.3, rolling_resistance=0.012)
    tyre = tn.Tyre(name="tyre", stiffness=1e4, damping=100.0)
    coasting = tn.Driveline([tn.Disk(name="wheel", inertia=2.0), tyre, car])
    slows = 0.012 * 1500 * 9.80665 * 0.3 / (1500 * 0.3**2 + 2.0)
    run = tn.transient(coasting, 60.0, speed=10.0)
    assert run.outcome.kind == "rolls back" and run.end == pytest.approx(10 / slows, rel=1e-2)
    assert tn.transient(coasting, 5.0, speed=0.0).outcome.kind == "rolls back"
    assert tn.transient(coasting, 5.0, speed=10.0).outcome.kind == "reached"

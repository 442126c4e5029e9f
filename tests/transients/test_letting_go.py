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


CAR = {"name": "car", "mass": 1500.0, "wheel_radius": 0.3}
G = 9.80665


def rolled(**car: float) -> tuple[tn.Driveline, float, float, float]:
    """A car behind a shaft, its whole inertia, and what climbs and rolls against it [N m]."""
    made = tn.Vehicle(**CAR, **car)
    grade = car.get("grade", 0.0)
    weight = 1500.0 * G * 0.3 / np.sqrt(1 + grade**2)
    line = tn.Driveline([tn.Disk(name="motor", inertia=0.5), tn.Shaft(stiffness=2e4, damping=40.0), made])
    return line, 1500.0 * 0.09 + 0.5, weight * grade, weight * car.get("rolling_resistance", 0.0)


def test_a_car_rolls_out_and_stands() -> None:
    line, inertia, climbs, rolls = rolled(rolling_resistance=0.012, grade=0.004)
    run = tn.transient(line, 30.0, speed=10.0)
    slows = (climbs + rolls) / inertia
    assert run.outcome.kind == "reached" and abs(run.speed[-1]).max() < 1e-6
    assert run.angle[-1, 1] == pytest.approx(10.0**2 / (2 * slows), rel=1e-5)
    assert run.energy.friction == pytest.approx(rolls * 10.0**2 / (2 * slows), rel=1e-5)
    assert run.energy.error < 1e-8
    assert abs(tn.transient(line, 5.0, speed=0.0).angle).max() < 1e-4  # nothing pushes it backwards


def test_a_car_rolls_back_where_the_hill_is_steeper_than_its_resistance() -> None:
    line, inertia, climbs, rolls = rolled(rolling_resistance=0.012, grade=0.05)
    run = tn.transient(line, 20.0, speed=5.0)
    up = 5.0 * inertia / (climbs + rolls)
    assert run.speed[-1, 1] == pytest.approx(-(climbs - rolls) / inertia * (20.0 - up), rel=1e-6)


@pytest.mark.parametrize("kind", ["car", "fan", "brake"])
def test_a_drive_balances_what_becomes_friction_or_a_curve(kind: str) -> None:
    """It goes on at the speed it has, twisted by what it carries from the start on."""
    fan = tn.Fan(name="fan", inertia=2.0, curve=[{"speed": 0, "torque": 1}, {"speed": 60, "torque": 3}])
    car = tn.Vehicle(**CAR, rolling_resistance=0.012, drag_area=0.6)
    brake = tn.Brake(name="brake", inertia=2.0, torque=20.0, static_torque=25.0)
    drive = tn.Disk(name="drive", inertia=1.0, drive_share=1)
    line = tn.Driveline([drive, tn.Shaft(stiffness=1e4, damping=10.0), {"car": car, "fan": fan, "brake": brake}[kind]])
    run = tn.transient(line, 2.0, speed=40.0)
    np.testing.assert_allclose(run.speed, 40.0, rtol=1e-9)
    carried = {"car": car.load.value(40.0), "fan": fan.load.value(40.0), "brake": 20.0}[kind]
    np.testing.assert_allclose(run.torque, -float(carried), rtol=1e-8)
    given = [A(on="drive", time=[0], torque=[0.0], between="steps")]
    assert tn.transient(line, 0.5, torque=given, speed=40.0).speed[-1, 0] < 40.0  # a torque instead of the share
    passed = tn.passing(line, (40.0, 41.0), torque=[A(on="drive", time=[0], torque=[500.0], between="steps")])
    assert passed.passes


def dragged(
    one: float, other: float, capacity: float, rubs: float, times: list[float], torques: list[float]
) -> tuple[float, float]:
    """Last speeds of a motor, a slip clutch and a load with dry friction under torques in steps, from rest, by straight
    lines of speed from one event to the next."""
    v, w = 0.0, 0.0
    for torque, length in zip(torques, np.diff(times), strict=False):
        left = float(length)
        while left > 1e-13:
            slip = v - w
            together = (torque - np.sign(w or torque) * rubs) / (one + other)
            if w == 0 and abs(torque) <= rubs:
                together = 0.0
            carried = torque if w == 0 and together == 0 else other * together + np.sign(w or torque) * rubs
            if slip == 0 and abs(carried) <= capacity:
                a = b = together
            else:
                push = capacity * np.sign(slip or carried)
                a = (torque - push) / one
                b = (push - np.sign(w or push) * rubs) / other if w or abs(push) > rubs else 0.0
            ends = [left]
            if slip * (a - b) < 0:
                ends.append(-slip / (a - b))
            if w * b < 0:
                ends.append(-w / b)
            step = min(ends)
            v, w = v + a * step, w + b * step
            if len(ends) > 1 and step < left:
                if slip * (a - b) < 0 and step == -slip / (a - b):
                    v = w
                else:
                    w, v = 0.0, (0.0 if slip == 0 and a == b else v)
            left -= step
    return v, w


def test_friction_beside_a_slip_clutch() -> None:
    rng = np.random.default_rng(5)
    stood = slid = 0
    for _ in range(30):
        one, other, capacity, rubs = (float(x) for x in rng.uniform((0.3, 0.3, 5, 2), (3, 3, 30, 25)))
        times = [0.0, *np.sort(rng.uniform(0.1, 2.0, 4)).tolist(), 2.5]
        torques = (rng.uniform(-80, 80, 5) * rng.integers(0, 2, 5)).tolist()
        act = A(on="motor", time=times, torque=[*torques, 0.0], between="steps")
        rub = F(on="load", torque=rubs)
        run = tn.transient(clutched(one, other, capacity), 2.5, torque=[act], friction=[rub], speed=0.0)
        known = dragged(one, other, capacity, rubs, times, torques)
        assert run.outcome.kind == "reached", run.outcome
        np.testing.assert_allclose(run.speed[-1], known, rtol=1e-7, atol=1e-7)
        assert run.energy.error < 1e-8
        stood += known[1] == 0
        slid += known[0] != known[1]
    assert stood > 3 and slid > 3


def test_a_clutch_between_two_that_are_braked() -> None:
    """Brakes keep both ends at rest; once the motor's is gone the clutch carries what the load's bears."""
    brakes = [F(on="motor", torque=50.0), F(on="load", torque=20.0)]
    act = A(on="motor", time=[0.0, 1.0], torque=[0.0, 40.0])
    run = tn.transient(clutched(1.0, 2.0, 30.0), 1.0, torque=[act], friction=brakes, speed=0.0)
    assert run.outcome.kind == "reached" and abs(run.speed).max() == 0
    on = run.then(1.0, torque=[A(on="motor", time=[0.0], torque=[25.0], between="steps")], friction=brakes[1:])
    assert on.speed[-1].tolist() == pytest.approx([5.0 / 3.0, 5.0 / 3.0], rel=1e-8)


@pytest.mark.parametrize("on", ["motor", "load"])
@pytest.mark.parametrize(
    "formula",
    [
        "-2*max(speed, 0) - 5",
        "-5 - 2*min(speed, 0)",
        "-4*max(speed, 0) + 4*min(speed, 0) + 12*sin(3*time)",
        "-3*abs(speed)",
    ],
)
def test_a_formula_that_bends_where_friction_stops(formula: str, on: str) -> None:
    """Both switch at the same moment: against small steps of the equations, friction by hand."""
    run = tn.transient(
        pair(), 3.0, torque=[A(on="motor", formula=formula)], friction=[F(on=on, torque=10.0)], speed=20.0
    )
    assert run.outcome.kind == "reached"
    acts = compile(formula, "formula", "eval")
    names = {"max": max, "min": min, "abs": abs, "sin": np.sin}
    twist, speeds, step = 0.0, [20.0, 20.0], 1e-4
    rubbed = ["motor", "load"].index(on)
    for i in range(30_000):
        shaft = 1e3 * twist + speeds[0] - speeds[1]
        torques = [eval(acts, names | {"speed": speeds[0], "time": i * step}) - shaft, shaft]
        before = list(speeds)
        for k in (0, 1):
            if k != rubbed:
                speeds[k] += step * torques[k]
                continue
            sense = np.sign(speeds[k]) or np.sign(torques[k]) * (abs(torques[k]) > 10.0)
            speeds[k] += step * (torques[k] - 10.0 * sense) if sense else 0.0
            if speeds[k] * sense < 0 and abs(torques[k]) <= 10.0:
                speeds[k] = 0.0
        twist += step * (sum((1, -1)[k] * (before[k] + speeds[k]) / 2 for k in (0, 1)))
    assert run.speed[-1][rubbed] == pytest.approx(speeds[rubbed], abs=1e-9)
    np.testing.assert_allclose(run.speed[-1], speeds, atol=0.02)

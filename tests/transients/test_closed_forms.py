"""Transients whose motion is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import erf

import trunnion as tn

STIFFNESS, MOTOR, MILL = 2e4, 0.5, 2.0
WHOLE, REDUCED = MOTOR + MILL, MOTOR * MILL / (MOTOR + MILL)
OMEGA = float(np.sqrt(STIFFNESS / REDUCED))


def pair(**motor: float) -> tn.Driveline:
    return tn.Driveline(
        [tn.Disk(name="motor", inertia=MOTOR, **motor), tn.Shaft(name="shaft", stiffness=STIFFNESS),
         tn.Disk(name="mill", inertia=MILL)]
    )  # fmt: skip


def test_a_step_on_one_inertia() -> None:
    """Between a prescribed speed and a disk: θ = T (1 − cos ωt)/k from the step on."""
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=STIFFNESS), tn.Disk(name="mill", inertia=MILL)])
    step = tn.AppliedTorque(on="mill", time=[0, 0.01], torque=[0, 80.0], between="steps")
    run = tn.transient(line, 0.2, torque=[step], speed=50.0)
    t = run.time
    since, omega = np.maximum(t - 0.01, 0.0), np.sqrt(STIFFNESS / MILL)
    np.testing.assert_allclose(run.twist[:, 0], 80 / STIFFNESS * (1 - np.cos(omega * since)), atol=1e-11)
    assert run.peak_torque[0] == pytest.approx(160.0, rel=1e-9)
    assert run.energy.error < 1e-10


def test_a_ramp_and_a_jump_from_rest() -> None:
    """Torque ct on the motor of a free pair, back to nothing at once: what it twists, and the speed it leaves."""
    ramp = tn.AppliedTorque(on="motor", time=[0, 0.3, 0.3, 0.5], torque=[0, 60.0, 0.0, 0.0])
    run = tn.transient(pair(), 0.5, torque=[ramp], speed=0.0)
    rising = run.time < 0.3
    t, rate = run.time[rising], 60.0 / 0.3
    twist = -rate * MILL / (WHOLE * STIFFNESS) * (t - np.sin(OMEGA * t) / OMEGA)
    np.testing.assert_allclose(run.twist[rising, 0], twist, atol=1e-12)
    centre = (MOTOR * run.angle[:, 0] + MILL * run.angle[:, 1]) / WHOLE
    np.testing.assert_allclose(centre[rising], rate * t**3 / 6 / WHOLE, atol=1e-11)
    momentum = MOTOR * run.speed[-1, 0] + MILL * run.speed[-1, 1]
    assert momentum == pytest.approx(0.5 * 60.0 * 0.3, rel=1e-11)


def test_a_motor_by_its_formula_reaches_its_speed_when_that_says() -> None:
    """One rigid inertia under Kloss's torque: t = ∫ J dω/T(ω), an integral in closed form; a stiff shaft adds none."""
    torque, slip, synchronous = 100.0, 0.3, 100.0
    motor = tn.AppliedTorque(on="motor", breakdown_torque=torque, breakdown_slip=slip, synchronous_speed=synchronous)
    last = 80.0

    def until(speed: float) -> float:
        s = 1 - speed / synchronous
        return WHOLE * synchronous / (2 * torque) * ((1 - s**2) / (2 * slip) - slip * np.log(s))

    line = pair().replace("shaft", stiffness=1e7, damping=1e3)
    run = tn.transient(line, 5.0, torque=[motor], speed=0.0, crossing=[tn.LevelCrossing(of="mill", speed=last)])
    assert run.outcome.kind == "crossed"
    assert run.end == pytest.approx(until(last), rel=1e-5)


def test_a_brake_stops_and_keeps_a_rigid_line() -> None:
    """Dry friction from 0.1 s on: it turns (Jω/T_c) longer, through ω²J/2T_c, and then stands."""
    brake = tn.FrictionTorque(on="mill", torque=500.0, since=0.1)
    rigid = pair().replace("shaft", stiffness=1e8, damping=1e3)
    run = tn.transient(rigid, 1.0, friction=[brake], speed=40.0)
    stopped = 0.1 + WHOLE * 40.0 / 500.0
    standing = run.time > stopped + 0.05
    np.testing.assert_allclose(run.speed[standing, 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(run.speed[standing, 0], 0.0, atol=1e-4)
    assert run.angle[-1, 1] == pytest.approx(4.0 + WHOLE * 40.0**2 / (2 * 500.0), rel=1e-5)
    assert run.energy.friction + run.energy.losses == pytest.approx(WHOLE * 40.0**2 / 2, rel=1e-9)


def test_a_table_over_speed_that_bends_is_switched_exactly() -> None:
    """T = 50 below 10 rad/s, then falling to nothing at 30: a straight rise, then an exponential."""
    table = tn.AppliedTorque(on="motor", speed=[-10, 10, 30, 40], torque=[50, 50, 0, -25])
    rigid = pair().replace("shaft", stiffness=1e9, damping=1e4)
    run = tn.transient(rigid, 2.0, torque=[table], speed=0.0, tolerance=1e-12)
    first = WHOLE * 10 / 50
    t = run.time
    known = np.where(t < first, 50 * t / WHOLE, 30 - 20 * np.exp(-2.5 / WHOLE * (t - first)))
    behind = t > 0.02  # the stiff shaft has come to rest
    np.testing.assert_allclose(run.speed[behind, 1], known[behind], atol=1e-5)


def test_two_variables_and_shares_of_a_motor() -> None:
    """A table over time and speed is bilinear; a motor's factor multiplies: both at a speed that hardly changes."""
    heavy = pair().replace("motor", inertia=1e6).replace("mill", inertia=1e6)
    table = [[0, 2, 4], [10, 14, 18], [20, 26, 32]]
    grid = tn.AppliedTorque(on="motor", time=[0, 1, 2], speed=[0, 20, 40], table=table)
    run = tn.transient(heavy, 2.0, torque=[grid], speed=10.0)
    t = run.time
    np.testing.assert_allclose(run.applied[:, 0], np.where(t < 1, 1 + 11 * t, 12 + 11 * (t - 1)), atol=1e-3)
    motor = tn.AppliedTorque(
        on="motor", time=[0, 1, 2], factor=[0, 1, 1], breakdown_torque=100, breakdown_slip=0.5, synchronous_speed=20
    )
    run = tn.transient(heavy, 2.0, torque=[motor], speed=10.0)
    np.testing.assert_allclose(run.applied[:, 0], 100 * np.minimum(run.time, 1), atol=1e-2)


def test_a_torque_over_angle_pushes_where_it_says() -> None:
    """A push from π/2 to π of each disk's own angle does ∫T dφ."""
    angle = [0, np.pi / 2, np.pi / 2 + 0.1, np.pi, np.pi + 0.1]
    push = tn.AppliedTorque(on="mill", angle=angle, torque=[0, 0, 40, 40, 0], hold=True)
    run = tn.transient(pair(), 0.5, torque=[push], speed=10.0)
    assert run.energy.applied == pytest.approx(40 * np.pi / 2, rel=1e-9)


def test_then_goes_on_where_the_run_ended() -> None:
    """In two parts as in one; and a shaft that changes keeps angles and speeds."""
    blow = tn.AppliedTorque(on="mill", time=[0, 0.05, 0.08], torque=[0, -300, 0], between="steps")
    joint = tn.Driveline(
        [tn.Disk(name="motor", inertia=MOTOR), tn.HookeJoint(angle=0.3), tn.Shaft(name="shaft", stiffness=STIFFNESS),
         tn.Disk(name="mill", inertia=MILL)]
    )  # fmt: skip
    whole = tn.transient(joint, 0.2, torque=[blow], speed=60.0)
    half = tn.transient(joint, 0.06, torque=[blow], speed=60.0).then(0.14)
    times = np.linspace(0, 0.2, 50)
    for one, other in zip(whole.at(times), half.at(times), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-8)
    softer = half.then(0.1, line=joint.replace("shaft", stiffness=1e3), torque=[])
    before, behind = softer.at(np.array([0.2 - 1e-9, 0.2 + 1e-9]))[2]
    np.testing.assert_allclose(before, behind, atol=1e-6)
    assert softer.energy.error < 1e-8
    with pytest.raises(tn.InputError, match="other disks or springs"):
        half.then(0.1, line=tn.Driveline([e.but(name=f"{n}s") for n, e in joint.parts]), torque=[])


def test_what_never_moves_is_said() -> None:
    weak = tn.AppliedTorque(on="motor", time=[0, 1], torque=[0, 20])
    held = tn.FrictionTorque(on="motor", torque=20.0, static=25.0)
    run = tn.transient(pair(), 1.0, torque=[weak], friction=[held], speed=0.0)
    assert "never moves: static friction on motor holds it" in str(run)
    assert np.abs(run.speed).max() == 0.0


def test_a_load_beyond_the_drive_turns_the_line_back() -> None:
    motor = tn.AppliedTorque(on="motor", speed=[-200, 200], torque=[30, 30])
    load = tn.AppliedTorque(on="mill", time=[0, 1], torque=[-50, -50])
    run = tn.transient(pair(), 1.0, torque=[motor, load], speed=5.0)
    assert "turns backwards" in str(run)


def test_a_drive_with_a_share_is_replaced_by_its_torque() -> None:
    line = pair(drive_share=1.0).replace("mill", load_torque=30.0)
    steady = tn.transient(line, 0.5, speed=20.0)
    np.testing.assert_allclose(steady.speed, 20.0, rtol=1e-9)
    driven = tn.transient(line, 0.5, torque=[tn.AppliedTorque(on="motor", time=[0, 1], torque=[80, 80])], speed=20.0)
    assert driven.speed[-1].mean() == pytest.approx(20 + 50 * 0.5 / WHOLE, rel=1e-2)


def test_levels_are_judged_and_crossings_kept() -> None:
    limited = tn.Driveline(pair().elements, limits=[tn.Limit(of="shaft", max_torque=50.0, margin=0.1)])
    blow = tn.AppliedTorque(on="mill", time=[0, 0.05, 0.08], torque=[0, -300, 0], between="steps")
    watched = tn.LevelCrossing(of="shaft", torque=20.0, direction="rising", ends=False)
    run = tn.transient(limited, 0.2, torque=[blow], crossing=[watched], speed=50.0)
    assert "which it exceeds by" in str(run)
    assert len(run.crossings) > 3
    np.testing.assert_allclose(run.torque_at([t for t, _ in run.crossings])[:, 0], 20.0, rtol=1e-8)


def test_a_clutch_that_lets_go_and_closes_again() -> None:
    """Beyond its torque each side goes its own way; without drive they come together, and energy is rubbed away."""
    line = tn.Driveline(
        [tn.Disk(name="engine", inertia=MOTOR), tn.SlipClutch(name="clutch", torque=100.0),
         tn.Disk(name="middle", inertia=0.1), tn.Shaft(name="shaft", stiffness=1e7, damping=2e2),
         tn.Disk(name="mill", inertia=MILL - 0.1)]
    )  # fmt: skip
    kick = tn.AppliedTorque(on="engine", time=[0, 0.05, 0.15], torque=[0, 300.0, 0.0], between="steps")
    watched = tn.LevelCrossing(of="clutch", slip=-10.0, ends=False)
    run = tn.transient(line, 0.4, torque=[kick], speed=10.0, crossing=[watched])
    slipping = run.at(0.15)
    assert run.whole.speed(0.4)[0] == pytest.approx(10 + 30 / WHOLE, rel=1e-9)
    assert slipping.speed[0, run._stations[0]] == pytest.approx(10 + 200 * 0.1 / MOTOR, rel=1e-3)
    assert slipping.speed[0, run._stations[2]] == pytest.approx(10 + 100 * 0.1 / MILL, rel=1e-3)
    assert [round(t, 3) for t, _ in run.crossings] == [0.079, 0.25]
    np.testing.assert_allclose(run.speed[-1], 10 + 30 / WHOLE, rtol=1e-6)
    assert run.energy.error < 1e-8 and run.energy.losses > 100


def swept(t: np.ndarray, frequency: float, ratio: float, acceleration: float) -> np.ndarray:
    """x of x″ + 2ζω x′ + ω² x = cos(½ α t²) from rest, in closed form by the error function of a complex argument
    (Lewis's resonance passed at uniform acceleration)."""
    root = frequency * (-ratio + 1j * np.sqrt(1 - ratio**2))
    found = np.zeros(len(t), dtype=complex)
    for sign in (1.0, -1.0):
        p = -1j * sign * acceleration / 2
        reach, middle = np.sqrt(p), root / (2 * p)
        apart = erf(reach * (t + middle)) - erf(reach * middle)
        found += np.exp(root * t + root**2 / (4 * p)) * np.sqrt(np.pi) / (2 * reach) * apart / 2
    return np.asarray(found.imag / root.imag)


@pytest.mark.parametrize("acceleration", [40.0, 160.0])
def test_a_resonance_is_passed_as_by_lewis(acceleration: float) -> None:
    """A torque whose frequency rises evenly through the one resonance at 80 rad/s; the envelope's peak comes late."""
    one, other, push, until = 1.0, 2.0, 30.0, 240.0 / acceleration
    reduced = one * other / (one + other)
    stiffness, damping = reduced * 80.0**2, 2 * 0.02 * reduced * 80.0
    shaft = tn.Shaft(name="shaft", stiffness=stiffness, damping=damping)
    line = tn.Driveline([tn.Disk(name="motor", inertia=one), shaft, tn.Disk(inertia=other)])
    torque = tn.AppliedTorque(on="motor", formula=f"{push}*cos({acceleration / 2}*t^2)")
    run = tn.transient(line, until, torque=[torque], speed=20.0, tolerance=1e-11)
    times = np.linspace(0, until, 20_001)
    known = -push / one * swept(times, 80.0, 0.02, acceleration)
    found = run.at(times).twist[:, 0]
    np.testing.assert_allclose(found, known, atol=1e-8 * np.abs(known).max())
    late = times[np.argmax(np.abs(found))]
    assert 80.0 / acceleration < late < 1.5 * 80.0 / acceleration
    steady = push / one / (2 * 0.02 * 80.0**2)
    assert np.abs(found).max() < 0.95 * steady

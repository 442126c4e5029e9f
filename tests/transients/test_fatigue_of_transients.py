"""Transients, passings and scenarios as histories of fatigue: cycles that closed forms count."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

CURVE = tn.SNCurve(of="shaft", torque_amplitude=400.0, cycles=1e6, slope=5)
STIFFNESS, INERTIA = 2e4, 2.0
PERIOD = 2 * np.pi * np.sqrt(INERTIA / STIFFNESS)
HOUR = 3600.0


def line(**rest: object) -> tn.Driveline:
    parts = [tn.ConstantSpeed(), tn.Shaft(name="shaft", stiffness=STIFFNESS), tn.Disk(name="mill", inertia=INERTIA)]
    return tn.Driveline(parts, sn_curves=[CURVE], **rest)


def damage_of(amplitude: float, count: float) -> float:
    return count / (1e6 * (400.0 / amplitude) ** 5)


STEP = tn.AppliedTorque(on="mill", time=[0], torque=[300.0], between="steps")


def test_a_step_swings_so_many_times() -> None:
    """T(1 − cos ωt) over ten periods: ten cycles of the amplitude T, each twice an hour."""
    run = tn.transient(line(), 10 * PERIOD, torque=[STEP], speed=50.0, start=np.zeros(2))
    found = tn.fatigue(line(), [tn.LoadHistory(run, per_hour=2, name="blow")], life="1000 h")
    assert found.damage[0] == pytest.approx(2000 * damage_of(300.0, 10), rel=1e-9)
    often = tn.fatigue(line(), [tn.LoadHistory(run, share=1.0)], life="1 h")
    assert often.damage[0] == pytest.approx(HOUR / (10 * PERIOD) * damage_of(300.0, 10), rel=1e-9)


def test_a_run_that_goes_on_is_one_history() -> None:
    half = tn.transient(line(), 3.3 * PERIOD, torque=[STEP], speed=50.0, start=np.zeros(2))
    found = tn.fatigue(line(), [tn.LoadHistory(half.then(6.7 * PERIOD), per_hour=2)], life="1000 h")
    assert found.damage[0] == pytest.approx(2000 * damage_of(300.0, 10), rel=1e-9)


def test_scenarios_of_the_file_come_so_often() -> None:
    """Only those that say how many an hour has; beside a duty they add up."""
    once = tn.Scenario(name="blow", duration=10 * PERIOD, speed=50.0, torque=[STEP], per_hour=2)
    never = tn.Scenario(name="other", duration=1.0, speed=50.0)
    stated = line(scenarios=[once, never], operation=tn.Operation(speed=50.0, life="1000 h"))
    again = tn.loads(tn.dumps(stated))
    assert again == stated
    found = tn.fatigue(again)
    assert found.histories == ("blow",)
    assert found.damage[0] == pytest.approx(2000 * damage_of(300.0, 10), rel=1e-9)
    assert not any("No passages are stated" in str(one) for one in found.findings)
    assert tn.assess(again).check("fatigue of shaft").value == pytest.approx(found.damage[0], rel=1e-9)


def test_a_start_from_standstill_by_a_motor() -> None:
    """A decaying swing about 80 N m: the start is a cycle, then each trough with the peak behind it."""
    motor = tn.Motor(name="motor", inertia=0.5, curve=[{"speed": 0, "torque": 100}, {"speed": 200, "torque": 100}])
    parts = [motor, tn.Shaft(name="shaft", stiffness=2e4, damping=60.0), tn.Disk(name="mill", inertia=2.0)]
    start = tn.Scenario(name="start", duration=1.0, speed="0 rpm", per_hour=1.0)
    found = tn.fatigue(tn.Driveline(parts, sn_curves=[CURVE], scenarios=[start]), life="1 h")
    omega, zeta = np.sqrt(2e4 / 0.4), 60.0 / 2 / np.sqrt(2e4 * 0.4)
    damped, t = omega * np.sqrt(1 - zeta**2), np.linspace(0, 0.4, 400_001)
    decay = np.exp(-zeta * omega * t)
    twist = 1 - decay * (np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t))
    torque = 80 * (twist + 60.0 / 2e4 * omega**2 / damped * decay * np.sin(damped * t))
    turns = torque[1:-1][np.diff(torque)[1:] * np.diff(torque)[:-1] < 0][:9]
    amplitudes = [turns[0] / 2, *((turns[2::2] - turns[1:-1:2]) / 2)]
    np.testing.assert_allclose(np.unique(np.round(found.spectra[0].amplitude, 7))[::-1][:4], amplitudes[:4], rtol=1e-5)
    assert found.damage[0] == pytest.approx(sum(damage_of(a, 1) for a in amplitudes), rel=1e-4)


def test_a_passing_counts_where_it_passes() -> None:
    disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
    shaft = tn.Shaft(name="shaft", stiffness=2e3, damping=1.0)
    bent = tn.Driveline([disks[0], tn.HookeJoint(angle="15 deg"), shaft, disks[1]], sn_curves=[CURVE])
    weak = tn.AppliedTorque(on="motor", formula="2.5")
    passed = tn.passing(bent.replace("HookeJoint 1", angle="5 deg"), (15.0, 40.0), torque=[weak])
    found = tn.fatigue(bent, [tn.LoadHistory(passed, per_hour=1)], life="1 h")
    run = tn.fatigue(bent, [tn.LoadHistory(passed.run, per_hour=1)], life="1 h")
    assert 0 < found.damage[0] == run.damage[0]
    hung = tn.passing(bent, (15.0, 40.0), torque=[weak])
    with pytest.raises(tn.InputError, match="did not come to its end: .*captured"):
        tn.fatigue(bent, [tn.LoadHistory(hung, per_hour=1)])


def test_a_scenario_that_does_not_end_leaves_no_life() -> None:
    table = tn.AppliedTorque(on="mill", speed=[0, 60], torque=[300.0, 300.0])
    parts = [tn.Disk(name="motor", inertia=0.5), tn.Shaft(name="shaft", stiffness=2e4, damping=9.0)]
    beyond = tn.Scenario(name="beyond", duration=5.0, speed=50.0, torque=[table], per_hour=1)
    whole = tn.Driveline([*parts, tn.Disk(name="mill", inertia=2.0)], sn_curves=[CURVE], scenarios=[beyond])
    found = tn.fatigue(whole, life="1 h")
    assert np.isnan(found.life[0]) and "beyond: stopped at t = " in found.uncounted[0]


def test_a_slip_clutch_is_named_among_what_is_not_judged() -> None:
    clutch, shaft = tn.SlipClutch(name="clutch", torque=100.0), tn.Shaft(name="shaft", stiffness=1e4, damping=2.0)
    parts = [tn.Disk(name="engine", inertia=0.5), clutch, tn.Disk(inertia=0.1), shaft, tn.Disk(inertia=1.9)]
    slipping = tn.Driveline(parts, sn_curves=[CURVE])
    kick = tn.AppliedTorque(on="engine", time=[0, 0.05, 0.15], torque=[0, 300.0, 0.0], between="steps")
    found = tn.fatigue(slipping, [tn.LoadHistory(tn.transient(slipping, 0.4, torque=[kick], speed=10.0), per_hour=1)])
    assert any("not judged: clutch" in str(one) for one in found.findings)

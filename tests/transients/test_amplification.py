"""How far a transient goes beyond its nominal torque, and how its play lands, against equations written by hand."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

STIFFNESS, PLAY, MOTOR, LOAD = 1e4, 0.01, 1.0, 2.0


def test_a_step_on_two_masses_doubles_the_torque() -> None:
    """40 N m on the motor beside 40 N m of load: the shaft is to carry 40 and swings to twice of that."""
    line = tn.Driveline(
        [tn.Disk(name="motor", inertia=MOTOR), tn.Shaft(name="shaft", stiffness=STIFFNESS),
         tn.Disk(name="load", inertia=LOAD, load_torque=40.0)]
    )  # fmt: skip
    step = tn.AppliedTorque(on="motor", time=[0.0], torque=[40.0], between="steps")
    run = tn.transient(line, 2.0, torque=[step], speed=20.0, start=np.zeros(4))
    found = tn.torque_amplification(run, nominal={"shaft": 40.0})
    assert found.factor[0] == pytest.approx(2.0, rel=1e-6) and found.separations[0] == -1


def test_landings_of_play_in_a_transient() -> None:
    """From the middle of the play, apart at 2 rad/s: it lands, is thrown back, and lands on the other side."""
    play = tn.PiecewiseShaft(
        name="play", breakpoints=(-PLAY, PLAY), stiffnesses=(STIFFNESS, 0.0, STIFFNESS), damping=0.0
    )
    line = tn.Driveline([tn.Disk(name="motor", inertia=MOTOR), play, tn.Disk(name="load", inertia=LOAD)])
    begun = np.array([0.0, 0.0, -1.0, 1.0])
    still = tn.AppliedTorque(on="motor", time=[0.0], torque=[0.0], between="steps")
    run = tn.transient(line, 0.2, torque=[still], speed=20.0, start=begun, tolerance=1e-11)
    found = tn.torque_amplification(run, nominal={"play": 10.0})
    # It lands with 2 rad/s of slip: the spring takes J_r v²/2, and gives it back.
    impact = 2.0 * np.sqrt(STIFFNESS * MOTOR * LOAD / (MOTOR + LOAD))
    assert abs(found.impact_torque[0]) == pytest.approx(impact, rel=1e-6)
    half = np.pi / np.sqrt(STIFFNESS * (MOTOR + LOAD) / (MOTOR * LOAD))
    times, t = [], PLAY / 2.0
    while t < 0.2:
        times.append(t)
        t += half + 2 * PLAY / 2.0
    assert found.separations[0] == len(times)

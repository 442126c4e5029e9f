"""Long runs say how far they are, and end with what they have."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

SHAFT = tn.Shaft(name="shaft", stiffness=2e3, damping=1.0)
PAIR = tn.Disk(name="motor", inertia=1.0), tn.HookeJoint(angle="15 deg"), SHAFT, tn.Disk(name="load", inertia=4.0)
FREE = tn.Driveline(PAIR)
HELD = tn.Driveline([tn.ConstantSpeed(), SHAFT, tn.Disk(name="load", inertia=4.0)])
WEAK = tn.AppliedTorque(on="motor", formula="2.5")
ON_LOAD = tn.AppliedTorque(on="load", formula="40*sin(20*t)")


def rises(shares: list[float]) -> bool:
    return len(shares) > 5 and bool(np.all(np.diff(shares) >= 0)) and shares[0] >= 0 and shares[-1] <= 1


@pytest.mark.parametrize(("line", "torque"), [(FREE, WEAK), (HELD, ON_LOAD)])
def test_a_transient_tells_and_stops(line: tn.Driveline, torque: tn.AppliedTorque) -> None:
    shares: list[float] = []
    whole = tn.transient(line, 20.0, torque=[torque], speed=20.0, progress=shares.append)
    assert rises(shares) and shares[-1] > 0.8
    with tn.time_limit() as limit:

        def halfway(share: float) -> None:
            if share > 0.5:
                limit.stop()

        part = tn.transient(line, 20.0, torque=[torque], speed=20.0, progress=halfway)
    assert part.outcome.kind == "out of time" and 9.0 < part.end < 16.0
    times = np.linspace(0, part.end, 50)
    for one, other in zip(part.at(times), whole.at(times), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)
    rest = part.then(20.0 - part.end)
    np.testing.assert_allclose(rest.speed[-1], whole.speed[-1], atol=1e-7)


def test_passing_tells_and_stops() -> None:
    shares: list[float] = []
    tn.passing(FREE.replace("HookeJoint 1", angle="5 deg"), (15.0, 40.0), torque=[WEAK], progress=shares.append)
    assert shares[-1] == 1.0 and all(0 <= one <= 1 for one in shares) and len(shares) > 4
    with tn.time_limit() as limit:
        stopped = tn.passing(FREE, (15.0, 40.0), torque=[WEAK], progress=lambda share: limit.stop())
    assert stopped.outcome.kind == "undecided" and stopped.run.end > 0


def test_fatigue_tells() -> None:
    curve = tn.SNCurve(of="shaft", torque_amplitude=400.0, cycles=1e6, slope=5)
    line = tn.Driveline(HELD.elements, sn_curves=[curve])
    run, shares = tn.transient(line, 1.0, torque=[ON_LOAD], speed=20.0), list[float]()
    tn.fatigue(line, [tn.LoadHistory(run, per_hour=1), tn.LoadHistory(run, per_hour=2)], progress=shares.append)
    assert shares == [0.5, 1.0]
    blow = tn.Scenario(name="blow", duration=1.0, speed=20.0, torque=[ON_LOAD], per_hour=1)
    shares.clear()
    tn.fatigue(tn.Driveline(HELD.elements, sn_curves=[curve], scenarios=[blow]), progress=shares.append)
    assert shares[-1] == 1.0

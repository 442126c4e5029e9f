"""The largest torques of springs without limit, looked for from what the search for limits showed before.

A free line with joint angles is looked over roughly first; the torques that its report draws begin there. The check is
a dense even grid of its own.
"""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.reporting.overview import overview
from trunnion.response.speed_sweep import response_over

LOW, HIGH = 60.0, 210.0


def ship(limits: list[tn.Limit], torques: list[float]) -> tn.Driveline:
    """An engine over its load, an elastic coupling, two joints, a propeller; resonances of several orders in the range,
    those of the last shaft far from those of the coupling."""
    over = {"torques": torques, "amplitudes": [40.0 + 0.05 * torque for torque in torques]}
    shaken = [{"order": k, **over} for k in (0.5, 1.0, 1.5, 3.0)]
    parts = [
        tn.Disk(inertia=1.2, name="engine", drive_share=1.0, excitation=shaken),
        tn.Shaft(stiffness=35e3, loss_factor=0.05, name="coupling"),
        tn.Disk(inertia=0.8, name="flange"),
        tn.HookeJoint(angle=0.1),
        tn.Shaft(stiffness=90e3, loss_factor=0.01, name="tube"),
        tn.Disk(inertia=0.5, name="rear"),
        tn.HookeJoint(angle=0.1),
        tn.Shaft(stiffness=160e3, loss_factor=0.01, name="tail"),
        tn.Disk(inertia=6.0, name="propeller", quadratic_load=0.05, excitation=[{"order": 4, "amplitude": "60 N*m"}]),
    ]
    return tn.Driveline(parts, limits=limits, operation=tn.Operation(speed=150.0, speed_range=[LOW, HIGH]))


@pytest.mark.parametrize(
    ("limited", "torques"),
    [("coupling", [0.0, 4000.0]), ("tail", [0.0, 700.0, 4000.0])],
    ids=["one piece", "two pieces"],
)
def test_no_top_of_another_spring_is_missed(limited: str, torques: list[float]) -> None:
    line = ship([tn.Limit(of=limited, vibratory_torque="20 kN*m")], torques)
    case = overview(line).subject.cases[0]
    around = case.__dict__["around"]
    found = response_over(
        assemble(line), LOW, HIGH, points=41, known=case.response, around=around, motions=case.motions
    )
    assert len(found.speed) < len(around.speed)  # otherwise it is searched as any line
    dense = tn.order_response(line, np.linspace(LOW, HIGH, 601))
    for key in ("peak_torque", "vibratory_torque"):
        ours, true = getattr(found, key).max(axis=0), getattr(dense, key).max(axis=0)
        assert np.all(ours >= (1 - 1e-3) * true) and np.all(ours <= 1.05 * true)

"""Charts of 60 × 60 points about the own motion of three loaded lines, each against 200 points that are shot here."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from oracles.swung_trees import SwungTree

import trunnion as tn
from trunnion.results.verdict import Verdict

POINTS = 200
SHOT = 1e-8
"""What steps of the integration leave of a radius by shooting."""
EXAMPLES = Path(__file__).parents[2] / "examples"
TUBE = {"shear_modulus": "79.3 GPa", "young_modulus": "206 GPa", "density": "7850 kg/m^3"}


class Case(NamedTuple):
    line: tn.Driveline
    speeds: tuple[float, float]
    y: str
    values: tuple[float, float]


def two_joints() -> tn.Driveline:
    joint, shaft = tn.HookeJoint(angle="20 deg"), tn.Shaft(stiffness="10 kN*m/rad", damping="5 N*m*s/rad")
    return tn.Driveline([tn.ConstantSpeed(), *(2 * [joint, shaft, tn.Disk(inertia="0.8 kg*m^2")])])


def branch(name: str, angle: str, tube: tuple[str, str, str], pinion: float, half: float, load: float) -> list:
    """One axle of a four-wheel drive, from its first joint on."""
    outer, inner, length = tube
    lossy = {"loss_factor": 0.02, "loss_factor_frequency": "50 Hz"}
    return [
        tn.HookeJoint(name=f"{name} joint 1", angle=angle, after="transfer case"),
        tn.Shaft(outer_diameter=outer, inner_diameter=inner, length=length, **TUBE, **lossy),
        tn.HookeJoint(name=f"{name} joint 2", angle=angle),
        tn.Disk(inertia=pinion),
        tn.Ratio(teeth_in=10, teeth_out=41),
        tn.Shaft(stiffness=half, damping=20.0),
        tn.Disk(inertia=2.6),
        tn.Shaft(stiffness=30e3, damping=300.0),
        tn.Disk(inertia=135.0, load_torque=load),
    ]


def four_wheels() -> tn.Driveline:
    """A pick-up that climbs: two axles behind a transfer case, all wheels driven, the vehicle split between them, which
    leaves no loop; a soft shaft holds the mean speed of its engine. Typical numbers."""
    return tn.Driveline([
        tn.ConstantSpeed(), tn.Shaft(stiffness=50.0, damping=1.0), tn.Disk(inertia=0.35),
        tn.Shaft(stiffness=6e3, damping=6.0), tn.Disk(inertia=0.02),
        tn.Shaft(stiffness=60e3, damping=3.0), tn.Disk(name="transfer case", inertia=0.03),
        *branch("rear", "5 deg", ("76 mm", "72 mm", "1.4 m"), 0.01, 15e3, 600.0),
        *branch("front", "6 deg", ("63 mm", "59 mm", "0.8 m"), 0.008, 12e3, 400.0),
    ])  # fmt: skip


def tug() -> tn.Driveline:
    """Free–free: an engine, a rubber coupling, teeth, a Cardan shaft of tube and a propeller, as the example has it."""
    return tn.load(EXAMPLES / "harbour-tug.toml")


CASES = {
    "two joints": Case(two_joints(), (30.0, 200.0), "Disk 2.load_torque", (0.0, 1500.0)),
    "four-wheel drive": Case(four_wheels(), (84.0, 471.0), "rear joint 1.angle", (0.0, 0.26)),
    "tug": Case(tug(), (42.0, 105.0), "joint 1.angle", (0.0, 0.26)),
}


def chart_of(name: str) -> tn.StabilityChart:
    case = CASES[name]
    axes = ("speed", *case.speeds, 60), (case.y, *case.values, 60)
    return tn.stability_chart(case.line, *axes, about_steady_state=True)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_points_against_shooting(name: str) -> None:
    case, chart = CASES[name], chart_of(name)
    element, key = case.y.rsplit(".", 1)
    compared = 0
    for row, column in np.random.default_rng(0).integers(0, 60, (POINTS, 2)):
        known = chart.spectral_radius[row, column]
        if not np.isfinite(known):
            continue
        tree = SwungTree(case.line.replace(element, **{key: float(chart.y[row])}), chart.period)
        motion = tree.motion(float(chart.x[column]), finer=2)
        assert motion is not None
        allowed = float(chart.error_estimate[row, column]) + SHOT
        assert abs(known - motion.radius) <= allowed, (row, column, motion.radius)
        if abs(motion.radius - 1) > allowed:
            stated = Verdict(int(chart.verdict[row, column]))
            assert stated is (Verdict.UNSTABLE if motion.radius > 1 else Verdict.STABLE)
        compared += 1
    assert compared >= POINTS // 2

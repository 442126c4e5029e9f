"""Charts of 60 × 60 points about the own motion of three loaded lines, each against 200 points that are shot here.

Of each line a test is 20 of its points; the chart is computed once.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from oracles.shot_trees import ShotTree
from oracles.trees import Tree

import trunnion as tn
from trunnion.results.verdict import Verdict

POINTS, LOT = 200, 20
SHOT = 3e-7
"""What differences leave of a radius by shooting."""
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
    """Two axles behind a transfer case, uphill."""
    return tn.Driveline([
        tn.ConstantSpeed(), tn.Shaft(stiffness=50.0, damping=1.0), tn.Disk(inertia=0.35),
        tn.Shaft(stiffness=6e3, damping=6.0), tn.Disk(inertia=0.02),
        tn.Shaft(stiffness=60e3, damping=3.0), tn.Disk(name="transfer case", inertia=0.03),
        *branch("rear", "5 deg", ("76 mm", "72 mm", "1.4 m"), 0.01, 15e3, 600.0),
        *branch("front", "6 deg", ("63 mm", "59 mm", "0.8 m"), 0.008, 12e3, 400.0),
    ])  # fmt: skip


def tug() -> tn.Driveline:
    """Free–free: an engine, a rubber coupling, a reduction gear, a Cardan shaft and a propeller."""
    tube = {"material": "steel"}
    return tn.Driveline([
        tn.Disk(inertia=45.0, drive_share=1.0), tn.Shaft(stiffness=60e3, damping=212.0), tn.Disk(inertia=3.0),
        tn.GearPair(teeth_in=23, teeth_out=69, module=0.008, mesh_stiffness=2e9, mesh_damping=1e5),
        tn.Disk(inertia=25.0), tn.HookeJoint(name="joint 1", angle="3 deg"),
        tn.Shaft(outer_diameter="220 mm", inner_diameter="200 mm", length="1.8 m", **tube),
        tn.HookeJoint(name="joint 2", angle="3 deg"), tn.Disk(inertia=2.0),
        tn.Shaft(outer_diameter="160 mm", length="5 m", **tube), tn.Disk(inertia=60.0, quadratic_load=20.0),
    ])  # fmt: skip


CASES = {
    "two joints": Case(two_joints(), (30.0, 200.0), "Disk 2.load_torque", (0.0, 1500.0)),
    "four-wheel drive": Case(four_wheels(), (84.0, 471.0), "rear joint 1.angle", (0.0, 0.26)),
    "tug": Case(tug(), (42.0, 105.0), "joint 1.angle", (0.0, 0.26)),
}


@cache
def chart_of(name: str) -> tn.StabilityChart:
    case = CASES[name]
    axes = ("speed", *case.speeds, 60), (case.y, *case.values, 60)
    return tn.stability_chart(case.line, *axes, about_steady_state=True)


def radius(name: str, speed: float, value: float) -> float:
    """Over the chart's period."""
    case = CASES[name]
    element, key = case.y.rsplit(".", 1)
    tree = Tree(case.line.replace(element, **{key: value}), speed)
    return ShotTree(tree, chart_of(name).period).radius()


@pytest.mark.slow
@pytest.mark.study
@pytest.mark.parametrize("lot", range(POINTS // LOT))
@pytest.mark.parametrize("name", CASES)
def test_points_against_shooting(name: str, lot: int) -> None:
    chart, rng = chart_of(name), np.random.default_rng(lot)
    compared = 0
    for row, column in rng.integers(0, 60, (LOT, 2)):
        known = chart.spectral_radius[row, column]
        if not np.isfinite(known):
            continue
        true = radius(name, float(chart.x[column]), float(chart.y[row]))
        allowed = float(chart.error_estimate[row, column]) + SHOT
        assert abs(known - true) <= allowed, (row, column, true)
        if abs(true - 1) > allowed:
            assert Verdict(int(chart.verdict[row, column])) is (Verdict.UNSTABLE if true > 1 else Verdict.STABLE)
        compared += 1
    assert compared >= LOT // 2

"""A free–free line whose excitation moves it across the stages of a spring: its multipliers are others than at rest."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn

SPEED = 940 * 2 * np.pi / 60
SHOT = 1.19575
"""Spectral radius over half a turn by shooting with 3000 steps of Runge and Kutta, equations written out elsewhere."""


def line(amplitude: float, *, staged: bool = True) -> tn.Driveline:
    stages = {"breakpoints": ["-45 deg", "45 deg"], "stiffnesses": ["60 N*m/deg", "15 N*m/deg", "60 N*m/deg"]}
    excited = [{"order": 2, "amplitude": amplitude}] if amplitude else []
    return tn.Driveline(
        [
            tn.Disk(name="motor", inertia=0.1, drive_share=1.0, excitation=excited),
            tn.Shaft(stiffness=1e4, damping=2.0),
            tn.DualMassFlywheel(
                name="flywheel", primary_inertia=0.04, secondary_inertia=0.06, damping=2.0,
                **(stages if staged else {"stiffnesses": ["60 N*m/deg"]}),
            ),
            tn.HookeJoint(angle="12 deg"),
            tn.Shaft(stiffness=6e3),
            tn.Disk(name="wheel", inertia=0.4, load_torque=700.0),
            tn.TunedDamper(ring_inertia=0.05, stiffness=2e3, damping=1.0),
            tn.Belt(radius_in=0.06, radius_out=0.03, span_stiffness=4e5, inertia_out=0.003),
        ]
    )  # fmt: skip


def test_the_motion_with_its_excitation_is_unstable_and_the_verdict_without_says_what_it_left_out() -> None:
    excited = line(20.0)
    assert tn.periodic_response(excited, SPEED).spectral_radius == pytest.approx(SHOT, rel=1e-3)
    found = tn.stability(excited, SPEED)
    assert found.spectral_radius < 1
    assert "motor may move flywheel across its stages" in str(found.findings) and "periodic_response" in str(found)
    judged = tn.assess(excited, (SPEED, 1.01 * SPEED))
    assert any("may move flywheel across its stages" in str(one) for one in judged.findings)


@pytest.mark.parametrize("quiet", [line(0.0), line(20.0, staged=False)], ids=["unexcited", "one stage"])
def test_nothing_is_said_where_nothing_moves_across_a_stage(quiet: tn.Driveline) -> None:
    assert "across its stages" not in str(tn.stability(quiet, SPEED))

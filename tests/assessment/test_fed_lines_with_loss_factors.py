"""Lines that a load feeds and a loss factor at all frequencies damps: whether they grow has no equations in time."""

from __future__ import annotations

import pytest

import trunnion as tn


def line(power: float, **frequency: float) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(name="shaft", stiffness=1e4, loss_factor=0.001, **frequency),
            tn.Generator(name="generator", inertia=1.0, power=power),
        ],
        limits=[tn.Limit(of="shaft", max_torque=1e4)],
    )


def test_such_a_line_is_not_judged_stable() -> None:
    """At its mode, 100 rad/s, the loss factor damps with ηk/ν = 0.1 N m s/rad; the generator feeds with P/Ω²."""
    assert tn.stability(line(2e4, loss_factor_frequency=100.0), 80.0).growth_rate == pytest.approx(
        (2e4 / 80.0**2 - 0.1) / 2, rel=1e-3
    )
    judged = tn.assess(line(2e4), (60.0, 100.0))
    check = judged.check("parametric stability")
    assert check.status.name == "NOT_JUDGED" and "loss_factor_frequency" in check.because
    assert judged.verdict.name != "SATISFIED"

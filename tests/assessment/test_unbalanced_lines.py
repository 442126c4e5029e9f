"""Torques that do not balance leave nothing to judge: refused alike by whatever judges, unless a load case balances."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
import pytest

import trunnion as tn
from trunnion.reporting.overview_assessment import asked

INERTIAS, STIFFNESS, DAMPING, AMPLITUDE = (0.5, 2.0), 1e4, 3.0, 40.0


def line(load: float, case: float | None = None) -> tn.Driveline:
    """An engine of 100 N m that drives a rotor under a ``load`` [N m], or under that of a load ``case``."""
    cases = [] if case is None else [tn.LoadCase(name="full", loads={"rotor": case})]
    engine = tn.Disk(
        name="engine", inertia=INERTIAS[0], load_torque=-100.0, excitation=[{"order": 2, "amplitude": AMPLITUDE}]
    )
    return tn.Driveline(
        [
            engine,
            tn.Shaft(name="shaft", stiffness=STIFFNESS, damping=DAMPING),
            tn.Disk(name="rotor", inertia=INERTIAS[1], load_torque=load),
        ],
        operation=tn.Operation(speed="600 rpm", speed_range=("300 rpm", "900 rpm"), load_cases=cases),
        limits=[tn.Limit(of="shaft", vibratory_torque=500.0)],
    )


@pytest.mark.parametrize("judge", [tn.assess, asked], ids=["assess", "analyze"])
@pytest.mark.parametrize("case", [None, 60.0])
def test_a_line_that_no_case_balances_is_refused(judge: Callable[[tn.Driveline], object], case: float | None) -> None:
    with pytest.raises(tn.InputError, match="the loads add up to 90 N m .* the drives to 100 N m") as refused:
        judge(line(90.0, case))
    assert str(refused.value).startswith("driveline.load_torque: is free–free and its torques do not balance")
    assert "drive_share = 1" in str(refused.value)


def test_one_case_that_balances_is_judged() -> None:
    """Against the two-mass response in closed form, on a grid of the test's own."""
    judged = tn.assess(line(90.0, 100.0))
    check = next(one for one in judged.checks if one.name == "vibratory torque of shaft")
    assert check.load_case == "full"
    first, second = INERTIAS
    at = 2 * np.linspace(10 * pi, 30 * pi, 40_001)
    reduced = first * second / (first + second)
    k = STIFFNESS + 1j * at * DAMPING
    torque = np.abs(k * AMPLITUDE / first / (k / reduced - at**2))
    assert check.value == pytest.approx(torque.max(), rel=1e-6)
    assert asked(line(90.0, 100.0)).subject.cases[1].name == "full"

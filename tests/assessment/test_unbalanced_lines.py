"""Torques that do not balance leave nothing to judge: refused alike by whatever judges, unless a load case balances."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np
import pytest

import trunnion as tn
from trunnion.reporting.overview_assessment import asked, beyond_findings, judged

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


def generating(**load: object) -> tn.Driveline:
    """An engine that drives a generator."""
    return tn.Driveline(
        [
            tn.Disk(name="engine", inertia=2.0, drive_share=1, excitation=[{"order": 2, "amplitude": AMPLITUDE}]),
            tn.Shaft(name="shaft", stiffness=STIFFNESS, damping=DAMPING),
            tn.Generator(name="generator", inertia=1.0, **load),
        ],
        operation=tn.Operation(speed="600 rpm", speed_range=("500 rpm", "900 rpm")),
        limits=[tn.Limit(of="shaft", vibratory_torque=500.0)],
    )


def test_a_generator_at_constant_power_is_told_what_feeds_its_speed() -> None:
    """J dω/dt = T − P/ω: a rise of the speed grows at P/(Jω²), fastest where the line is slowest."""
    found = tn.assess(generating(power=10e3)).check("parametric stability")
    assert found.exceeded and found.value == pytest.approx(10e3 / (3.0 * tn.rpm(500) ** 2), rel=1e-3)
    assert "at constant power generator resists with less torque the faster it turns" in found.because
    assert "state its curve" in found.because


def test_speeds_beside_the_range_are_judged_as_far_as_curves_go() -> None:
    """20 % below the range the curve of the generator has ended; above it has not."""
    curve = [{"speed": tn.rpm(n), "torque": 100.0} for n in (450, 1200)]
    given = judged(asked(generating(curve=curve), speed=None, unit=None))
    said = [one.sentence for one in beyond_findings(given.subject, given.assessment)]
    ended = [one for one in said if "where a curve ends" in one]
    assert ended == [
        "Just below the range (up to 20 %) nothing is judged where a curve ends, that of generator covers 450 rpm to "
        "1200 rpm."
    ]

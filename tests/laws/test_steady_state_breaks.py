"""Own motions of free–free lines with joint angles where they swing far: followed over the speed, their folds, what
grows.

Against the equations of motion integrated in time (``oracles.own_shooting``), without harmonics or linearisation.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.free_shooting import Shooting, growth_of_own, leads_over
from oracles.line_equations import Steady
from oracles.scanned_lines import scanned_line

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.response.orders.response import one_motion_each
from trunnion.response.speed_sweep import response_over
from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed, breaks


def test_a_motion_on_the_flank_of_a_steep_resonance_is_followed_to():
    """At 577 rpm rigid shafts lead nowhere; the input swings by 0.76 rad there."""
    line, speed = scanned_line("free", 90), np.array([577 * np.pi / 30])
    known = SteadyStatesBySpeed(line.driveline).at_all(speed)
    assert known.found.all() and known.resolved.all()
    true = Shooting(Steady(line)).motions(speed)
    assert true.found.all()
    assert known.torque == pytest.approx(true.extra, rel=1e-7)
    assert known.observed().torque.mean(axis=1) == pytest.approx(true.mean_torque, rel=1e-7)


@pytest.mark.parametrize(
    ("seed", "speed"),
    [
        (221, 84.72009896611688),  # Rigid shafts lead nowhere.
        (118, 82.89860214093765),  # Of two real multipliers the one beyond 1 is that of the speed.
        pytest.param(151, 70.32448310607289, marks=pytest.mark.slow),
        pytest.param(244, 65.66433956131459, marks=pytest.mark.slow),
        pytest.param(20, 60.04705819682487, marks=pytest.mark.slow),
    ],
)
def test_stability_judges_the_motion_on_a_steep_resonance(seed, speed):
    line = scanned_line("free", seed)
    found = tn.stability(line.driveline, speed)
    true = Shooting(Steady(line)).motions(np.array([speed]))
    assert true.found.all() and np.abs(true.start).max() > 0.2
    assert found.extra_torque == pytest.approx(true.extra[0], rel=1e-6)
    assert found.growth_rate == pytest.approx(growth_of_own(Steady(line), np.array([speed]))[0], rel=2e-5)


def refused_between(seed: int, speed: float) -> tuple[float, float]:
    """Speeds [rad/s] that ``stability`` names when it refuses."""
    with pytest.raises(tn.ComputationError, match="several periodic motions at") as refused:
        tn.stability(scanned_line("free", seed).driveline, speed)
    high, low = (float(one) for one in re.findall(r"at ([\d.]+) rad/s", str(refused.value))[1:])
    return low, high


def test_stability_names_the_speeds_between_which_a_line_has_several_motions():
    low, high = refused_between(190, 64.0850750594069)
    assert low < 64.0850750594069 < high < 1.01 * low


@pytest.mark.parametrize("beside", [(), (60.0, 70.0)], ids=["alone", "between others"])
def test_responses_are_refused_where_stability_refuses(beside: tuple[float, ...]):
    line, speed = scanned_line("free", 190).driveline, 64.0850750594069
    low, high = refused_between(190, speed)
    with pytest.raises(tn.ComputationError, match="several periodic motions at 64.0851 rad/s") as refused:
        tn.order_response(line, [speed, *beside])
    assert [float(one) for one in re.findall(r"at ([\d.]+) rad/s", str(refused.value))[1:]] == pytest.approx(
        [high, low], rel=1e-5
    )


FOLD = 66.979466, 67.024574
"""Ends [rad/s] of the fold of line 117 that shooting finds by arc length."""


def refused_ends(over: Callable[[], Any]) -> list[float]:
    """Ends [rad/s] of the fold for which something is refused, rising."""
    with pytest.raises(tn.ComputationError, match="several periodic motions at") as refused:
        over()
    return sorted(float(one) for one in re.findall(r"at ([\d.]+) rad/s", str(refused.value))[1:])


@pytest.mark.parametrize("over", [response_over, tn.sweep_speeds])
@pytest.mark.parametrize(
    "ends", [(66.5, 67.5), (66.5, 66.99), pytest.param((50.0, 90.0), marks=pytest.mark.slow)], ids=str
)
def test_a_range_within_which_the_motion_folds_is_refused_with_the_ends_of_the_fold(
    over: Callable[..., Any], ends: tuple[float, float]
) -> None:
    """The speeds for a sweep as the response over the range."""
    line = scanned_line("free", 117).driveline
    assert refused_ends(lambda: over(line, *ends, points=9)) == pytest.approx(FOLD, rel=2e-5)


@pytest.mark.parametrize("speeds", [(66.9, 67.1), (66.5, 66.7, 67.3)], ids=str)
def test_a_fold_between_two_speeds_is_one_of_the_range_and_of_neither_speed(speeds: tuple[float, ...]) -> None:
    line = scanned_line("free", 117).driveline
    assert np.isfinite(tn.order_response(line, speeds).vibratory_torque).all()
    motions, asked = SteadyStatesBySpeed(line), np.array(speeds)
    ends = refused_ends(lambda: one_motion_each(assemble(line), asked, motions, between=True))
    assert ends == pytest.approx(FOLD, rel=2e-5)


def test_beside_a_fold_speeds_and_response_over_a_range_are_found() -> None:
    line = scanned_line("free", 117).driveline
    beside = response_over(line, 67.1, 67.6, points=9)
    assert len(beside.speed) > 9 and np.isfinite(beside.vibratory_torque).all()
    assert tn.sweep_speeds(line, 67.1, 67.6, 9) == pytest.approx(beside.speed)


@pytest.mark.slow
def test_at_the_speeds_that_stability_refuses_motions_from_either_side_do_not_meet():
    low, high = refused_between(190, 64.0850750594069)
    line = scanned_line("free", 190)
    for speed in (0.999 * low, 1.001 * high):
        assert tn.stability(line.driveline, speed).about_steady_state
    steady = Steady(line)
    assert not leads_over(steady, low * 0.999, high * 1.001)
    assert leads_over(steady, high * 1.001, high * 1.01)


@pytest.mark.slow
def test_between_two_folds_motions_from_either_side_do_not_meet():
    line = scanned_line("free", 117)
    steady, solved = Steady(line), SteadyStatesBySpeed(line.driveline)
    (found,) = breaks(solved, np.linspace(line.low, line.high, 33))
    assert (found.low, found.high) == pytest.approx(FOLD, rel=2e-6)
    assert "several" in found.why
    assert not leads_over(steady, found.low * (1 - 1e-5), found.high * (1 + 1e-5))
    assert leads_over(steady, found.low * (1 - 1e-3), found.low * (1 - 1e-5))


@pytest.mark.parametrize(
    ("seed", "speeds"),
    [
        # The swing turns into a pair of real multipliers.
        pytest.param(3, (43.6, 43.7, 43.796, 43.9, 44.1, 44.201, 44.5), marks=pytest.mark.slow),
        # Three real ones, one of the speed.
        (90, (60.0, 60.6, 60.66, 60.67, 61.0, 62.4)),
        # Unstable besides.
        pytest.param(7, (62.0, 90.2, 173.0, 180.5), marks=pytest.mark.slow),
        # Loaded by speed: that of the speed counts.
        pytest.param(9, (58.44, 58.65, 58.66, 60.0), marks=pytest.mark.slow),
    ],
)
def test_growth_about_own_motions_leaves_out_the_speed_wherever_it_is(seed, speeds):
    line, at = scanned_line("free", seed), np.array(speeds)
    found = stability_along(assemble(line.driveline), at)
    true = growth_of_own(Steady(line), at)
    assert np.isfinite(true).all()
    known_to = found.error / found.radius * found.speed / found.period
    assert (np.abs(found.growth_rate - true) <= known_to + 3e-6 + 2e-5 * np.abs(true)).all()


@pytest.mark.slow
def test_ends_of_unstable_ranges_are_located_to_a_hundred_thousandth():
    line = scanned_line("free", 9)
    ranges = tn.assess(line.driveline).check("parametric stability").barred
    assert len(ranges) == 2
    outside, inside = (
        np.array([one * (1 + share) for a, b in ranges for one, share in ((a, -away), (b, away))])
        for away in (1e-5, -1e-5)
    )
    assert (growth_of_own(Steady(line), outside) < 0).all()
    assert (growth_of_own(Steady(line), inside) > 0).all()


def test_checks_cover_all_but_the_speeds_where_the_motion_folds():
    line = scanned_line("free", 117)
    still = replace(line, masses=tuple(replace(mass, shakes=()) for mass in line.masses))
    plain = still.driveline
    generous = tn.Driveline(plain.elements, limits=[tn.Limit(of="s1", max_torque=1e6)], operation=plain.operation)
    judged = tn.assess(generous)
    for name in ("max torque of s1", "parametric stability"):
        check = judged.check(name)
        assert str(check.status) == "not judged"
        assert "not judged: the line's periodic steady state folds back there" in check.because
        (first, second) = check.covered
        assert (first[0], second[1]) == pytest.approx((line.low, line.high))
        assert (first[1], second[0]) == pytest.approx(FOLD, rel=2e-6)
    assert 100 < judged.check("max torque of s1").value < 1e6


@pytest.mark.slow
@pytest.mark.parametrize("seed", [115, 117])
def test_at_a_fold_the_line_is_judged_by_the_motion_that_goes_on_outside(seed):
    """Not by the one that ends there, which is another beside it: growth and values are those of just outside."""
    line = scanned_line("free", seed)
    solved = SteadyStatesBySpeed(line.driveline)
    (found,) = breaks(solved, np.linspace(line.low, line.high, 65))
    solved.broken = (found,)
    for fold, away in ((found.low, -1), (found.high, 1)):
        at = fold * (1 + away * np.array([0.0, 1e-7, 1e-6, 1e-5]))
        growth = stability_along(assemble(line.driveline), np.sort(at), motions=solved).growth_rate
        assert growth == pytest.approx(np.full(4, growth.mean()), rel=0.05)


@pytest.mark.slow
def test_speeds_beyond_a_fold_at_which_the_line_loses_its_speed_are_found():
    """Beyond it the torque falls with the speed: growth by the equations of motion integrated in time."""
    line = scanned_line("free", 115)
    check = tn.assess(line.driveline).check("parametric stability")
    (low, high) = check.barred[0]
    assert (low, high) == pytest.approx((66.6377, 67.7435), rel=1e-5)
    grows = growth_of_own(Steady(line), np.array([low * 1.001, 67.0, high * (1 - 1e-4), high * (1 + 1e-4)]))
    assert (grows[:3] > 0).all() and grows[3] < 0

"""Passing a resonance or captured by it, against equations of a reader's own."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

import trunnion as tn


@njit
def comes_there(one, other, angle, stiffness, damping, torque, first, last, phase, until, step):  # type: ignore[no-untyped-def]
    """When the mean speed of two inertias behind a Hooke's joint first is ``last``, by the classical Runge–Kutta method
    in absolute angles; infinite where that is not before ``until`` [s]."""
    cosine, square = np.cos(angle), np.sin(angle) ** 2
    s, k = np.sin(phase), np.cos(phase)
    ratio = cosine / (1 - square * k * k)
    x = np.array([phase, phase + np.arctan2(s * k * (1 - cosine), cosine * k * k + s * s), first, ratio * first])
    rates, total, y = np.empty(4), np.empty(4), np.empty(4)
    for i in range(int(until / step)):
        total[:] = 0.0
        for stage in range(4):
            for j in range(4):
                y[j] = x[j] + (0.0 if stage == 0 else (step if stage == 3 else step / 2)) * rates[j]
            s, k = np.sin(y[0]), np.cos(y[0])
            ratio = cosine / (1 - square * k * k)
            behind = y[0] + np.arctan2(s * k * (1 - cosine), cosine * k * k + s * s)
            shaft = stiffness * (y[1] - behind) + damping * (y[3] - ratio * y[2])
            rates[0], rates[1] = y[2], y[3]
            rates[2], rates[3] = (torque + ratio * shaft) / one, -shaft / other
            for j in range(4):
                total[j] += rates[j] * (2.0 if 0 < stage < 3 else 1.0)
        for j in range(4):
            x[j] += step / 6 * total[j]
        if (one * x[2] + other * x[3]) / (one + other) >= last:
            return (i + 1) * step
    return np.inf


def line(one: float, other: float, angle: float, stiffness: float, damping: float) -> tn.Driveline:
    shaft = tn.Shaft(stiffness=stiffness, damping=damping)
    return tn.Driveline(
        [tn.Disk(name="motor", inertia=one), tn.HookeJoint(angle=angle), shaft, tn.Disk(name="load", inertia=other)]
    )


def weak(torque: float) -> list[tn.AppliedTorque]:
    return [tn.AppliedTorque(on="motor", time=[0], torque=[torque], between="steps")]


def judged(count: int, seed: int) -> tuple[list[str], int]:
    """Kinds found, and how many cases the two steps of the reader's equations leave open."""
    rng, kinds, open_cases = np.random.default_rng(seed), list[str](), 0
    for _ in range(count):
        one, other = rng.uniform(0.5, 2), rng.uniform(0.5, 5)
        reduced, natural = one * other / (one + other), rng.uniform(30, 80)
        stiffness, damping = reduced * natural**2, 2 * reduced * natural * rng.uniform(0.004, 0.03)
        angle, phase = rng.uniform(0.05, 0.5), rng.uniform(0, np.pi)
        first, last = 0.35 * natural, 0.75 * natural
        rigid = rng.uniform(6, 25)
        torque = (one + other) * (last - first) / rigid
        known = [
            comes_there(one, other, angle, stiffness, damping, torque, first, last, phase, 10 * rigid, step / natural)
            for step in (0.05, 0.025)
        ]
        found = tn.passing(line(one, other, angle, stiffness, damping), (first, last), torque=weak(torque), phase=phase)
        kinds.append(found.outcome.kind)
        assert found.ending.rigid == pytest.approx(rigid, rel=1e-6)
        if np.isfinite(known[0]) != np.isfinite(known[1]):
            open_cases += 1
        elif kinds[-1] != "undecided":
            assert found.passes == np.isfinite(known[1]), (kinds[-1], known, rigid)
            if found.passes and abs(known[0] - known[1]) < 1e-3 * rigid:
                assert found.ending.time == pytest.approx(known[1], abs=1e-2 * rigid)
                if abs(known[1] / rigid - 3) > 0.05:
                    assert (kinds[-1] == "dwelt") == (known[1] > 3 * rigid)
    return kinds, open_cases


def test_a_few_lines() -> None:
    kinds, _ = judged(4, 1)
    assert {"passed", "captured"} <= set(kinds)


@pytest.mark.slow
def test_many_lines_are_judged_right() -> None:
    kinds, open_cases = judged(200, 2)
    assert kinds.count("undecided") <= 0.02 * len(kinds) + open_cases
    assert open_cases <= 6
    assert min(kinds.count("passed"), kinds.count("captured")) > 30


@pytest.mark.study
def test_five_hundred_lines_are_judged_right() -> None:
    """None wrong, and undecided below 2 %."""
    kinds, open_cases = judged(500, 3)
    assert kinds.count("undecided") < 0.02 * len(kinds)
    assert open_cases <= 10
    assert min(kinds.count("passed"), kinds.count("captured")) > 100


def test_fifteen_degrees_hang_at_half_the_natural_frequency_and_five_pass() -> None:
    """A weak motor and a mode at 50 rad/s: the joint shakes twice a turn, so that the line hangs below 25 rad/s."""
    one, other = 1.0, 4.0
    stiffness = 50.0**2 * one * other / (one + other)
    hangs = tn.passing(line(one, other, tn.deg(15), stiffness, 1.0), (15.0, 40.0), torque=weak(2.5))
    assert hangs.outcome.kind == "captured"
    assert hangs.ending.speed == pytest.approx(24.3, abs=0.1)
    assert hangs.ending.strongest is not None and hangs.ending.strongest.order == 2
    assert hangs.ending.strongest.mode_frequency == pytest.approx(50.0, rel=1e-3)
    assert "captured at 24.3 rad/s" in str(hangs) and "order 2 of HookeJoint 1 shakes mode 2" in str(hangs)
    passes = tn.passing(line(one, other, tn.deg(5), stiffness, 1.0), (15.0, 40.0), torque=weak(2.5))
    assert passes.outcome.kind == "passed"


def test_nothing_is_captured_before_the_last_step_of_its_torques() -> None:
    """It hangs at 24.3 rad/s for 60 s, and passes within seconds once its torque rises."""
    later = [tn.AppliedTorque(on="motor", time=[0, 60.0], torque=[2.5, 40.0], between="steps")]
    found = tn.passing(line(1.0, 4.0, tn.deg(15), 2e3, 1.0), (15.0, 40.0), torque=later)
    assert found.outcome.kind == "passed"
    assert found.ending.time == pytest.approx(62.0, abs=0.5)


def test_a_motor_that_is_too_weak_is_told_apart() -> None:
    loaded = line(1.0, 4.0, 0.02, 2e3, 1.0).replace("load", quadratic_load=0.01)
    found = tn.passing(loaded, (5.0, 30.0), torque=weak(4.0))
    assert found.outcome.kind == "short of torque"
    assert found.ending.speed == pytest.approx(20.0, rel=0.02)

"""What periodic motions and simulations say where there is no answer, or another than was asked for."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn


def _van_der_pol() -> tn.System:
    def rate(t, x, p):
        return x[1], -x[0] + (1 - x[0] ** 2) * x[1]

    return tn.System.from_function(rate, ["x", "v"], start=[2.0, 0.0], compiled=False)


def _forced(**options) -> tn.System:
    def rate(t, x, p):
        return x[1], -x[0] - 0.1 * x[1] + np.cos(p.frequency * t)

    given = {"parameters": {"frequency": 1.0}, "start": [0.0, 0.0], "compiled": False, "name": "forced"} | options
    return tn.System.from_function(rate, ["x", "v"], **given)


def test_undamped_at_resonance_no_motion_closes() -> None:
    found = tn.periodic_response(tn.reference_system("linear-oscillator").but(damping=0.0, frequency=1.0))
    assert not found.outcome.ok and found.outcome.kind == "unbounded" and "grows without bound" in str(found)
    beside = tn.periodic_response(tn.reference_system("linear-oscillator").but(damping=0.0, frequency=1.1))
    assert beside.outcome.ok and beside.peak_to_peak[0] / 2 == pytest.approx(1 / (1.1**2 - 1), rel=1e-8)


@pytest.mark.parametrize("periods", [2, 3, 4])
def test_a_motion_of_fewer_periods_than_asked_for(periods: int) -> None:
    found = tn.periodic_response(tn.reference_system("duffing"), periods=periods)
    assert f"it closes {periods} times in this period: the least period is 5.2359878 s" in found.outcome.sentence
    assert "least" not in tn.periodic_response(tn.reference_system("duffing")).outcome.sentence


@pytest.mark.slow
def test_a_multiple_of_an_autonomous_period() -> None:
    long = tn.periodic_response(_van_der_pol(), period=20.0)
    once = tn.periodic_response(_van_der_pol(), period=6.5)
    times = round(long.period / once.period)
    assert times > 1 and f"it closes {times} times" in long.outcome.sentence
    assert "growth rate below" in str(long) and once.growth_rate == pytest.approx(-1.05938, abs=1e-4)
    assert "least" not in once.outcome.sentence


LINE = tn.Driveline(
    [tn.ConstantSpeed(), tn.Shaft(stiffness=100, damping=0.1), tn.Disk(inertia=1), tn.HookeJoint(angle=0.2),
     tn.Shaft(stiffness=100, damping=0.1), tn.Disk(inertia=1)]
)  # fmt: skip
REFUSED = [
    (lambda: _forced(period=5.0), "forced.period = 5: is not a period"),
    (
        lambda: _forced(period=lambda p: 2 * np.pi / p["frequency"]).but(frequency=0),
        "forced.period: divides by zero with frequency = 0",
    ),
    (lambda: _forced(parameters={"frequency": [1, 2]}), "forced.frequency = [1, 2]: must be one number"),
    (lambda: tn.simulate(_forced(), "3"), "duration = '3': must be a positive time"),
    (lambda: tn.simulate(_forced(), True), "duration = True: must be a positive time"),
    (lambda: tn.simulate(_forced(), 1.0, start="ab"), "forced.start = 'ab': must be 2 numbers in the order x, v"),
    (lambda: tn.simulate(_forced(), 1.0, start={"x": 1, "v": 0}), "must be 2 numbers in the order x, v"),
    (lambda: tn.simulate(LINE, "3 s", speed=10.0), "duration = '3 s': must be a positive time"),
    (lambda: tn.simulate(LINE, times=[0.3, 0.1, 0.2], speed=10.0), "times: must be a rising list of times"),
    (lambda: tn.simulate(LINE, times=[-0.1, 0.1], speed=10.0), "times = -0.1: begins before start_time"),
    (lambda: tn.simulate(LINE, 1.0, turns=3, speed=10.0), "turns = 3: is given beside a duration"),
    (lambda: tn.simulate(_forced(), 1.0, speed=10.0), "speed = 10: belongs to a driveline"),
    (lambda: tn.simulate(LINE, periods=3, speed=10.0), "periods = 3: belongs to a System; give a duration, or turns"),
    (lambda: tn.simulate(LINE, 1.0, speed=10.0, longest_step=0.1), "longest_step = 0.1: belongs to a System"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_refused_in_one_line(call, words: str) -> None:
    with pytest.raises(tn.InputError) as caught:
        call()
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_the_period_and_its_double_pass() -> None:
    """A multiple of the least period is a period."""
    assert _forced(period=2 * np.pi).forcing_period == 2 * np.pi
    assert _forced(period=4 * np.pi).forcing_period == 4 * np.pi


def test_a_line_without_springs_does_not_move():
    line = tn.Driveline([tn.Disk(inertia=1.0), tn.Disk(inertia=2.0)])
    for ask in (
        lambda: tn.simulate(line, 1.0, speed=50.0),
        lambda: tn.periodic_response(line, 50.0),
        lambda: tn.linearity_check(line, 50.0),
    ):
        with pytest.raises(tn.InputError, match="driveline: has no spring, so that nothing twists; add a Shaft"):
            ask()

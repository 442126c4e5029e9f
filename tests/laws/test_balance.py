"""Balances of torques over speed against a root finder that knows values alone: a fine grid and halving."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from trunnion.laws.balance import balances, slope_left, torque_left
from trunnion.laws.torque_curve import (
    ClippedLine,
    FlowCurve,
    KlossCurve,
    Opposite,
    PowerCurve,
    PowerLimit,
    TableCurve,
    TorqueCurve,
)

LOW, HIGH = 2.0, 199.0


def random_table(rng: np.random.Generator) -> TableCurve:
    count = int(rng.integers(3, 8))
    speeds = np.sort(rng.uniform(5.0, 195.0, count - 2))
    return TableCurve((0.0, *speeds, 200.0), tuple(rng.uniform(-40.0, 400.0, count)))


def drives(rng: np.random.Generator) -> TorqueCurve:
    kloss = KlossCurve(rng.uniform(200, 900), rng.uniform(0.03, 0.6), rng.uniform(100, 190))
    return (kloss, random_table(rng), ClippedLine(rng.uniform(1, 40), rng.uniform(50, 180), rng.uniform(100, 500)))[
        rng.integers(3)
    ]


def resists(rng: np.random.Generator) -> TorqueCurve:
    powers = PowerCurve(rng.uniform(0, 150), rng.uniform(0, 1), rng.uniform(0, 0.02))
    asynchronous = KlossCurve(rng.uniform(100, 400), rng.uniform(0.05, 0.4), rng.uniform(60, 150))
    return (powers, random_table(rng), PowerLimit(rng.uniform(2e3, 3e4)), Opposite(asynchronous))[rng.integers(4)]


def test_all_balances_of_random_curves() -> None:
    """120 drives with one or two loads behind ratios, crossings on a grid of 4000 closed in on by Brent's method."""
    rng, grid, several, unstable = np.random.default_rng(11), np.linspace(LOW, HIGH, 4000), 0, 0
    for _ in range(120):
        ratios = rng.uniform(0.3, 1.0, 2)
        curves = [(1.0, Opposite(drives(rng))), *((float(r), resists(rng)) for r in ratios[: rng.integers(1, 3)])]
        left = sum(ratio * curve.value(ratio * grid) for ratio, curve in curves)
        at = np.flatnonzero(left[:-1] * left[1:] < 0)
        wanted = [brentq(lambda w, c=curves: torque_left(c, w), grid[i], grid[i + 1], xtol=1e-13) for i in at]
        found = balances(curves, LOW, HIGH)
        # Two crossings within one step of the grid would be missed by the grid alone: the curves are too smooth for it.
        assert len(found) == len(wanted)
        np.testing.assert_allclose([one.speed for one in found], wanted, rtol=1e-9)
        rises = left[at + 1] > left[at]
        assert [one.stable for one in found] == rises.tolist()
        several, unstable = several + (len(found) > 1), unstable + (~rises).sum()
    assert several > 20 and unstable > 20


def test_all_balances_of_several_machines() -> None:
    """Two to five curves without knots, over all speeds a line may have: asynchronous machines that drive and brake,
    constant powers, a fan; slips down to 0.002."""
    rng, several, unstable = np.random.default_rng(4), 0, 0
    grid = np.unique(np.concatenate([np.geomspace(0.01, 1e5, 6000), np.linspace(20.0, 180.0, 16000)]))
    for trial in range(160):
        curves: list[tuple[float, TorqueCurve]] = [(1.0, PowerCurve(rng.uniform(0, 150), 0.0, rng.uniform(5e-4, 0.03)))]
        for kind in ("MM", "MG", "MP", "MPP", "MMM", "MMG", "MMMM", "MMGP")[trial % 8]:
            slip = rng.uniform(0.03, 0.3) if trial % 3 else np.geomspace(0.002, 0.03, 9)[rng.integers(9)]
            kloss = KlossCurve(rng.uniform(200, 800), slip, rng.uniform(60, 160))
            power = PowerLimit(rng.uniform(1e3, 3e4))
            curves.append((1.0, {"M": Opposite(kloss), "G": kloss, "P": power}[kind]))
        left = sum(ratio * curve.value(ratio * grid) for ratio, curve in curves)
        at = np.flatnonzero(left[:-1] * left[1:] < 0)
        wanted = [brentq(lambda w, c=curves: torque_left(c, w), grid[i], grid[i + 1], xtol=1e-13) for i in at]
        found = balances(curves, 0.01, 1e5)
        assert len(found) == len(wanted), trial
        np.testing.assert_allclose([one.speed for one in found], wanted, rtol=1e-9)
        rises = left[at + 1] > left[at]
        assert [one.stable for one in found] == rises.tolist()
        several, unstable = several + (rises.sum() > 1), unstable + (~rises).sum()
    assert several > 20 and unstable > 40


def test_equal_motors_share_a_fan() -> None:
    """As many equal motors as fans: each pair turns as one motor with its fan, whatever their number."""
    motor, fan = Opposite(KlossCurve(500.0, 0.08, 157.0)), PowerCurve(quadratic=0.015)
    wanted = brentq(lambda w: torque_left([(1.0, motor), (1.0, fan)], w), 145.0, 157.0, xtol=1e-13)
    for count in (1, 2, 3, 8):
        (found,) = balances(count * [(1.0, motor), (1.0, fan)], 0.01, 1e5)
        assert found.speed == pytest.approx(wanted, rel=1e-12) and found.stable


def test_a_fan_on_the_mains() -> None:
    """Kloss with a heavy constant load: one balance on the falling branch, one beyond the breakdown slip."""
    motor, load = KlossCurve(500.0, 0.2, 157.0), PowerCurve(300.0)
    found = balances([(1.0, Opposite(motor)), (1.0, load)], 1.0, 200.0)
    # 2 T_b s s_b/(s² + s_b²) = T_L
    root = np.sqrt(500.0**2 - 300.0**2)
    slips = np.array([0.2 * (500 + root) / 300, 0.2 * (500 - root) / 300])
    np.testing.assert_allclose([one.speed for one in found], 157.0 * (1 - slips), rtol=1e-12)
    assert [one.stable for one in found] == [False, True]


def test_steps_of_the_slope_and_ranges() -> None:
    """A balance at a point of a table is one; there is none beyond its ends, and of powers without a root."""
    drive = TableCurve((0.0, 50.0, 100.0), (100.0, 100.0, 0.0))
    found = balances([(1.0, Opposite(drive)), (1.0, PowerCurve(quadratic=100.0 / 2500))], 0.0, 400.0)
    assert [one.speed for one in found] == pytest.approx([50.0], rel=1e-12)
    assert not balances([(2.0, Opposite(drive)), (1.0, PowerCurve(constant=250.0))], 0.0, 400.0)
    assert not balances([(1.0, PowerCurve(3.0)), (1.0, PowerCurve(viscous=1.0))], 1.0, 90.0)
    assert not balances([(1.0, ClippedLine(1.0, 50.0, 20.0)), (1.0, PowerCurve(-20.0))], 1.0, 29.0)


def test_a_flow_that_does_not_follow() -> None:
    """The slope at a balance is that of what swings, not the derivative of the mean torque."""
    curves = [(0.5, FlowCurve(0.04, 3.0)), (1.0, PowerCurve(constant=-40.0))]
    (found,) = balances(curves, 1.0, 300.0)
    assert found.speed == pytest.approx(np.sqrt(40.0 / (0.5 * 0.04 * 0.25)), rel=1e-12)
    assert found.slope == pytest.approx(0.25 * 3.0 * 0.04 * 0.5 * found.speed) == slope_left(curves, found.speed)

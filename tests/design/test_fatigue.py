"""Cycles, damage and life against counting by four points, sums by hand and closed forms."""

from __future__ import annotations

import json
from collections import Counter
from typing import Any

import numpy as np
import pytest
from oracles.four_point_rainflow import four_point
from pages import blocks, run_page
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli import app
from trunnion.design.fatigue.cycles import Cycles, rainflow_cycles
from trunnion.design.fatigue.damage import cycles_to_failure, damage, reversed_amplitude
from trunnion.design.fatigue.result import FatigueLife

HOUR = 3600.0


def curve(**changes: Any) -> tn.SNCurve:
    return tn.SNCurve(**{"of": "shaft", "torque_amplitude": 400.0, "cycles": 1e6, "slope": 5} | changes)


def by_range_and_mean(found: Cycles) -> Counter[tuple[float, float]]:
    counts: Counter[tuple[float, float]] = Counter()
    for amplitude, mean, count in zip(found.amplitude, found.mean, found.count, strict=True):
        counts[round(2 * float(amplitude), 9), round(float(mean), 9)] += float(count)
    return counts


def test_random_histories_against_four_points() -> None:
    draw = np.random.default_rng(3)
    for _ in range(60):
        values = draw.integers(-9, 10, draw.integers(3, 40)).astype(float)
        values[1] += values.max() == values.min()
        assert by_range_and_mean(rainflow_cycles(values, repeats=False)) == four_point(values.tolist())
        first = int(np.abs(values).argmax())
        closed = [*values[first:].tolist(), *values[: first + 1].tolist()]
        assert by_range_and_mean(rainflow_cycles(values, repeats=True)) == four_point(closed)
    assert rainflow_cycles(np.array([0.0, 2.0]), repeats=False).count.tolist() == [0.5]
    assert not len(rainflow_cycles(np.full(5, 3.0), repeats=True).count)


def test_damage_by_hand_below_and_above_the_stated_amplitude() -> None:
    cycles = Cycles(np.array([800.0, 400.0, 200.0]), np.zeros(3), np.array([1.0, 0.5, 2.0]))
    # N = 1e6 (400/S)^5; below 400 with exponent 9, or without damage.
    for miner, life in (("elementary", 1e6 * 2.0**5), ("modified", 1e6 * 2.0**9), ("original", np.inf)):
        expected = [1 / (1e6 / 2.0**5), 0.5 / 1e6, 2 / life]
        np.testing.assert_allclose(damage(curve(miner=miner), cycles), expected, rtol=1e-14)
    assert cycles_to_failure(curve(), np.array([400.0]))[0] == 1e6


def test_means_by_hand() -> None:
    goodman = curve(ultimate_torque=2000.0)
    # 300/(1 − 500/2000) = 400 for either sign of the mean; a mean of 2000 breaks at once.
    found = reversed_amplitude(goodman, np.array([300.0, 300.0, 1.0]), np.array([500.0, -500.0, 2000.0]))
    assert found.tolist() == [400.0, 400.0, np.inf]
    fkm = curve(mean_sensitivity=0.3)
    # R = −1: 100. R = 0: 100 + 0.3 · 100. R = 1/3: 1.3 (100 + 0.1 · 200)/1.1. R = 0.5 and beyond: 1.69 · 100/1.1.
    means = np.array([0.0, 100.0, -200.0, 300.0, 900.0])
    expected = [100.0, 130.0, 1.3 * 120 / 1.1, 169 / 1.1, 169 / 1.1]
    np.testing.assert_allclose(reversed_amplitude(fkm, np.full(5, 100.0), means), expected, rtol=1e-14)
    assert (reversed_amplitude(curve(), np.full(5, 100.0), means) == 100.0).all()


def line(torque: float = 100.0, *, duty: Any = (), passages: Any = (), life: Any = None, **stated: Any) -> tn.Driveline:
    """Two inertias; what shakes the first is of order 2."""
    parts = [
        tn.Disk(inertia=0.2, drive_share=1, excitation=[{"order": 2, "amplitude": torque}], name="engine"),
        tn.Shaft(stiffness=1e4, damping=2.0, name="shaft"),
        tn.Disk(inertia=0.8, load_torque=60.0, name="machine"),
    ]
    operation = tn.Operation(
        duty=duty, passages=passages, life=life, load_cases=[tn.LoadCase(name="full", loads={"machine": 300.0})]
    )
    return tn.Driveline(parts, operation=operation, sn_curves=[curve(**stated)])


def amplitude(torque: float, speed: float) -> float:
    """|T| of the shaft, from J₁ÿ₁ = M − T, J₂ÿ₂ = T, T = (k + icω)(y₁ − y₂) at ω = 2Ω."""
    turning = 2 * speed
    spring = 1e4 + 2j * turning
    twist = torque / 0.2 / (-(turning**2) + spring * (1 / 0.2 + 1 / 0.8))
    return abs(spring * twist)


def test_a_steady_sine_in_closed_form_and_what_scales() -> None:
    duty = [tn.Duty(share=0.25, speed=80.0), tn.Duty(share=0.75, speed=110.0, load_case="full")]
    found = tn.fatigue(line(duty=duty, life="1000 h"))
    # Two cycles a turn; the means of 60 and 300 N m do not count.
    rates = [0.25 * 160 / (2 * np.pi), 0.75 * 220 / (2 * np.pi)]
    expected = [rate / (1e6 * (400 / amplitude(100.0, s)) ** 5) for rate, s in zip(rates, (80.0, 110.0), strict=True)]
    np.testing.assert_allclose(found.damage_rate[0], expected, rtol=1e-8)
    np.testing.assert_allclose(found.damage, sum(expected) * 3.6e6, rtol=1e-8)
    np.testing.assert_allclose(found.life, 1 / sum(expected), rtol=1e-8)
    assert 0 <= found.error_rate[0] < 1e-7 * sum(expected)
    assert any("Means do not count in shaft" in one.sentence for one in found.findings)
    assert found.histories == ("763.944 rpm", "1050.42 rpm, full")
    assert found.leading(0).startswith("1050.42 rpm, full")
    longer = tn.fatigue(line(duty=duty, life="2000 h"))
    np.testing.assert_allclose(longer.damage, 2 * found.damage, rtol=1e-14)
    np.testing.assert_allclose(tn.fatigue(line(200.0, duty=duty)).damage_rate, 2**5 * found.damage_rate, rtol=1e-9)
    # Goodman about each mean, and a curve that another sum is allowed for.
    counted = tn.fatigue(line(duty=duty, ultimate_torque=1500.0, damage_sum=0.3))
    shares = [(1 - 60 / 1500) ** -5, (1 - 300 / 1500) ** -5]
    np.testing.assert_allclose(counted.damage_rate[0], np.multiply(expected, shares), rtol=1e-8)
    np.testing.assert_allclose(counted.life, 0.3 / np.dot(expected, shares), rtol=1e-8)
    np.testing.assert_allclose(counted.peak[0], [60 + amplitude(100.0, 80.0), 300 + amplitude(100.0, 110.0)], rtol=1e-9)


def test_stress_of_a_tube_is_torque_by_its_section() -> None:
    tube = tn.Shaft(outer_diameter=0.05, inner_diameter=0.04, length=1.0, shear_modulus=8e10, damping=2.0, name="shaft")
    stress = tn.SNCurve(of="Shaft *", stress_amplitude="80 MPa", cycles=1e6, slope=4)
    jointed = tn.Driveline([tn.Disk(inertia=0.2), tube, tn.Disk(inertia=0.8)], sn_curves=[stress])
    found = tn.fatigue(jointed, [tn.LoadHistory({"shaft": [0.0, 700.0, -700.0, 0.0]}, per_hour=5.0)])
    size = 16 * 700 * 0.05 / (np.pi * (0.05**4 - 0.04**4))
    np.testing.assert_allclose(found.peak, size, rtol=1e-14)
    np.testing.assert_allclose(found.damage_rate, 5 / HOUR / (1e6 * (80e6 / size) ** 4), rtol=1e-13)
    assert "MPa" in str(found.table()[0]["largest"]) and np.isnan(found.damage[0])


BY_SPEED = {"order": 2, "speeds": [50.0, 120.0, 200.0], "amplitudes": [40.0, 110.0, 160.0]}


@pytest.mark.parametrize("engine", [{"order": 2, "amplitude": 100.0}, BY_SPEED], ids=["constant", "by the speed"])
def test_a_passage_against_a_fine_grid_and_four_points(engine: dict[str, Any]) -> None:
    start = tn.SpeedPassage(name="start", first=60.0, last=180.0, acceleration=60.0, per_hour=4, load_case="full")
    driven = line(passages=[start], ultimate_torque=3000.0).replace("engine", excitation=[engine])
    found = tn.fatigue(driven)
    run = tn.run_up(driven.with_load("full"), 60.0, 180.0, acceleration=60.0, steady=0).simulation
    torque = run.torque_at(np.linspace(0.0, run.end, 100_001))[:, 0]
    first = int(np.abs(torque).argmax())
    counts = four_point([*torque[first:].tolist(), *torque[: first + 1].tolist()])
    by_hand = sum(n / (1e6 * (400 * (1 - abs(m) / 3000) / (r / 2)) ** 5) for (r, m), n in counts.items() if r)
    np.testing.assert_allclose(found.damage_rate[0, 0], 4 / HOUR * by_hand, rtol=1e-5)
    assert found.histories == ("start",) and np.isclose(found.peak[0, 0], np.abs(torque).max(), rtol=1e-5)
    # The same from Python, and with the passage twice as often.
    told = tn.fatigue(line(ultimate_torque=3000.0), [tn.LoadHistory(run, per_hour=8, name="twice")])
    np.testing.assert_allclose(told.damage_rate, 2 * found.damage_rate, rtol=1e-12)
    ran = tn.LoadHistory(run, share=1.0)
    np.testing.assert_allclose(
        tn.fatigue(line(ultimate_torque=3000.0), [ran]).damage_rate, found.damage_rate * HOUR / 4 / run.end, rtol=1e-12
    )


def test_excitations_without_a_common_period() -> None:
    """Amplitudes of two torques that never repeat together: between the larger one alone and both at once."""
    engine = tn.Disk(
        inertia=0.2, drive_share=1,
        excitation=[{"order": 2, "amplitude": 60.0}, {"frequency": 2 * np.pi * 23.7, "amplitude": 60.0}],
    )  # fmt: skip
    shaken = tn.Driveline(
        [engine, tn.Shaft(stiffness=1e4, damping=2.0, name="shaft"), tn.Disk(inertia=0.8)], sn_curves=[curve()]
    )
    response = tn.order_response(shaken, [80.0])
    found = tn.fatigue(shaken, [tn.LoadHistory(response, share=1.0)])
    sizes, turning = np.abs(response.torque[0, :, 0]), np.abs(response.angular_frequency[0])
    most = turning.max() / (2 * np.pi) / (1e6 * (400 / sizes.sum()) ** 5)
    least = turning.min() / (2 * np.pi) / (1e6 * (400 / sizes.max()) ** 5)
    assert least < found.damage_rate[0, 0] < most
    assert 0.97 * sizes.sum() < found.peak[0, 0] <= sizes.sum() * (1 + 1e-9)
    assert 0 < found.error_rate[0] < 0.1 * found.damage_rate[0, 0]


def test_what_cannot_be_counted_leaves_no_life() -> None:
    undamped = tn.Driveline(
        [
            tn.Disk(inertia=1.0, drive_share=1, excitation=[{"order": 1, "amplitude": 5.0}]),
            tn.Shaft(stiffness=5e3, name="shaft"),
            tn.Disk(inertia=1.0),
        ],
        sn_curves=[curve()],
        operation=tn.Operation(duty=[tn.Duty(share=1.0, speed=100.0)], life="10 h"),
    )
    found = tn.fatigue(undamped)
    assert np.isnan(found.life[0]) and found.uncounted == ("954.93 rpm: no steady state exists at 954.93 rpm",)
    check = tn.assess(undamped, (99.0, 101.0)).check("fatigue of shaft")
    assert str(check.status) == "not judged" and "no steady state" in check.because
    heavy = tn.fatigue(line(ultimate_torque=1000.0), [tn.LoadHistory({"shaft": [0.0, 1100.0, 0.0]}, per_hour=1)])
    assert heavy.findings[0].sentence == "shaft reaches what breaks it at once: 1100 N m against 1000 N m."


def test_assess_judges_the_life_that_is_stated() -> None:
    duty = [tn.Duty(share=1.0, speed=110.0)]
    rate = 220 / (2 * np.pi) / (1e6 * (400 / amplitude(100.0, 110.0)) ** 5)
    for life, status in ((0.9 / rate, "satisfied"), (1.1 / rate, "exceeded"), (None, "not judged")):
        check = tn.assess(line(duty=duty, life=life), (150.0, 160.0)).check("fatigue of shaft")
        assert str(check.status) == status
        if life is not None:
            np.testing.assert_allclose([check.value, check.margin], [rate * life, 1 - rate * life], rtol=1e-7)
    assert "no life is stated" in check.because
    without = tn.assess(line(), (150.0, 160.0)).check("fatigue of shaft")
    assert str(without.status) == "not judged" and "operation.duty: is missing" in without.because
    follows = tn.sensitivity(line(duty=duty, life=0.9 / rate), 155.0, ["engine.inertia"], of=["checks"])
    rows = [one.name for one in follows.quantities]
    assert follows.derivative[rows.index("fatigue of shaft"), 0] != 0


def test_pictures_show_the_cycles_and_the_curve() -> None:
    duty = [tn.Duty(share=0.4, speed=80.0), tn.Duty(share=0.6, speed=110.0)]
    found: FatigueLife = tn.fatigue(line(duty=duty, life="1000 h", ultimate_torque=2000.0))
    drawn = {one.get_label(): one.get_xydata() for one in found.plot().lines}
    assert set(drawn) >= {"all cycles", "763.944 rpm", "1050.42 rpm", "S–N curve"}
    np.testing.assert_allclose(drawn["763.944 rpm"][-1, 0], 0.4 * 160 / (2 * np.pi) * 3.6e6, rtol=1e-6)
    np.testing.assert_allclose(drawn["S–N curve"][:, 0], 1e6 * (400 / drawn["S–N curve"][:, 1]) ** 5, rtol=1e-9)
    bars = [patch.get_width() for patch in found.plot_damage().patches]
    np.testing.assert_allclose(np.sort(bars), np.sort(100 * found.damage_rate[0] * 3.6e6), rtol=1e-9)


@pytest.mark.slow
def test_the_page_runs_in_order(tmp_path: Any, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pump.toml").write_text(blocks("fatigue", "toml")[0], encoding="utf-8")
    text, names = run_page("fatigue")
    assert "shaft: Miner's sum 0.0534 of 1 after 20000 h, lasts 374000 h, most by 1500 rpm, full load (57.6 %)" in text
    assert text.splitlines()[2] == "satisfied"
    assert "5.06 times the nominal -200 N m" in text


@pytest.mark.slow
def test_the_report_has_a_section() -> None:
    duty = [tn.Duty(share=1.0, speed=110.0)]
    page = tn.report(line(duty=duty, life="1000 h"), speed=110.0, points=(4, 4)).html
    assert '<section id="fatigue">' in page and "Means do not count in shaft" in page


def test_the_command(tmp_path: Any, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    described = line(duty=[tn.Duty(share=1.0, speed=110.0)], life="1000 h")
    tn.dump(described, "line.toml")
    found = CliRunner().invoke(
        app, ["fatigue", "line.toml", "--life", "500 h", "-o", "life.png", "-o", "life.nc", "--json"]
    )
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    np.testing.assert_allclose(content["damage"], tn.fatigue(described).damage / 2, rtol=1e-12)
    assert content["operating_life"] == 1.8e6 and content["written"] == ["life.png", "life.nc"]
    text = CliRunner().invoke(app, ["fatigue", "line.toml", "-o", "life.csv"]).stdout
    assert text.startswith("fatigue of 1 element over 1 history of load") and (tmp_path / "life.csv").exists()
    refused = CliRunner().invoke(app, ["fatigue", "line.toml", "--life", "0 h"])
    assert refused.exit_code == 2 and "must be positive" in refused.output

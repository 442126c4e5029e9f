"""Probabilities, worst corners and rankings of tolerances, against one-dimensional truths and plain Monte Carlo."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import two_shafts
from long_lines import long_line
from scipy.optimize import brentq

import trunnion as tn

LINE = tn.catalogue("two-shaft-cardan", angle=0.3)


def test_probability_of_one_parameter_is_a_length() -> None:
    """The angle scatters over a tip's edge: stable below it, unstable above; the edge from an integration of its
    own."""
    edge = brentq(lambda b: two_shafts.radius(1.62, b) - 1, 0.1, 0.2, xtol=1e-9)
    study = tn.tolerance_study(LINE, {"HookeJoint 1.angle": ("range", 0.1, 0.2)}, 1.62, samples=2048)
    truth = (edge - 0.1) / 0.1
    assert study.interval[0] <= truth <= study.interval[1]
    assert study.probability == pytest.approx(truth, abs=2e-3)
    assert study.worst.values["HookeJoint 1.angle"] == pytest.approx(0.2, rel=1e-6)
    assert str(study.worst.verdict) == "unstable" and study.ranking[0][1] > 0.9


def test_worst_corner_is_the_worst_of_all_corners() -> None:
    tolerances = {"Shaft 1.stiffness": 0.01, "Disk 1.inertia": 0.02, "HookeJoint 1.angle": 0.05}
    study = tn.tolerance_study(LINE, tolerances, 1.66, samples=256)
    corners = []
    for k in range(8):
        signs = [1 if k >> b & 1 else -1 for b in range(3)]
        line = LINE.replace("Shaft 1", stiffness=1 + 0.01 * signs[0]).replace("Disk 1", inertia=1 + 0.02 * signs[1])
        line = line.replace("HookeJoint 1", angle=0.3 * (1 + 0.05 * signs[2]))
        corners.append(tn.stability(line, 1.66).growth_rate)
    assert study.worst.growth_rate >= max(corners) - 1e-9


STATED = [
    tn.Tolerance("Shaft *", stiffness="2 %"),
    tn.Tolerance("Shaft 2", stiffness=[0.9, 1.2], fork_offset="2 deg"),
    tn.Tolerance("Disk 1", inertia={"deviation": "1 %"}),
    tn.Tolerance("HookeJoint 1", angle={"deviation": "0.4 deg"}),
]


def test_tolerances_of_the_description_are_those_given_by_hand() -> None:
    """Each shaft scatters by itself; what an element states goes before its kind's."""
    line = tn.loads(tn.dumps(tn.Driveline(LINE.elements, damping_ratio=LINE.damping_ratio, tolerances=STATED)))
    given = {
        "Shaft 1.stiffness": 0.02,
        "Shaft 2.stiffness": ("range", 0.9, 1.2),
        "Shaft 2.fork_offset": ("range", -tn.deg(2.0), tn.deg(2.0)),
        "Disk 1.inertia": ("normal", 0.01),
        "HookeJoint 1.angle": ("deviation", tn.deg(0.4)),
    }
    stated = tn.tolerance_study(line, speeds=1.64, samples=256)
    by_hand = tn.tolerance_study(line, {key: given[key] for key in stated.parameters}, 1.64, samples=256)
    assert stated.parameters == tuple(line.tolerances_by_path) and set(given) == set(stated.parameters)
    assert np.allclose(stated.growth_rate, by_hand.growth_rate, rtol=1e-12, atol=1e-15)


def test_tolerances_about_other_numbers_stop_no_axis() -> None:
    """±0.5 about a stiffness of 1 reaches below zero about 0.4; a chart varies the stiffness all the same."""
    wide = tn.Tolerance("Shaft 1", stiffness="0.5 N*m/rad")
    line = tn.Driveline(LINE.elements, damping_ratio=LINE.damping_ratio, tolerances=[wide])
    chart = tn.stability_chart(line, ("Shaft 1.stiffness", 0.4, 2.0, 4), ("speed", 1.0, 2.0, 4))
    assert np.all(np.isfinite(chart.spectral_radius))


def test_interval_of_what_never_happens() -> None:
    study = tn.tolerance_study(LINE, {"Shaft 1.stiffness": 0.01}, 1.0, samples=1024)
    assert study.probability == 1.0 and 0.99 < study.interval[0] < 1.0 and study.interval[1] == 1.0


def test_several_speeds_must_all_be_stable() -> None:
    tolerances = {"HookeJoint 1.angle": ("range", 0.05, 0.4)}
    both = tn.tolerance_study(LINE, tolerances, [1.1, 1.62], samples=1024)
    assert both.probability <= both.stable_share.min() + 1e-12 and both.growth_rate.shape == (2, both.samples)
    assert both.data.stable_share.sizes["speed"] == 2 and "at 2 speeds" in str(both)


def test_the_same_seed_gives_the_same_numbers() -> None:
    a, b, c = (tn.tolerance_study(LINE, {"Shaft 1.stiffness": 0.05}, 1.64, samples=256, seed=s) for s in (1, 1, 2))
    assert np.array_equal(a.growth_rate, b.growth_rate) and not np.array_equal(a.growth_rate, c.growth_rate)


def test_drawn() -> None:
    axes = tn.tolerance_study(LINE, {"Shaft 1.stiffness": 0.05}, 1.64, samples=256).plot()
    assert "probability" in axes.get_title(loc="left")


def test_few_unstable_lines_are_seen_beside_many_stable_ones() -> None:
    tolerances = {"Shaft 1.stiffness": 0.1, "Disk 2.inertia": 0.1, "HookeJoint 1.angle": ("range", 0.25, 0.32)}
    study = tn.tolerance_study(LINE, tolerances, 1.66, samples=1024)
    axes = study.plot()
    assert 0.9 < study.probability < 1.0
    low, high = axes.get_ylim()
    heights = [np.log(bar.get_height() / low) / np.log(high / low) for bar in axes.patches if bar.get_height() > 0]
    assert axes.get_yscale() == "log" and min(heights) > 0.03


@pytest.mark.slow
def test_intervals_overlap_those_of_plain_monte_carlo() -> None:
    """100 seeds: at least 90 intervals overlap that of 4096 independent random lines."""
    tolerances = {"Shaft 1.stiffness": 0.05, "Disk 2.inertia": 0.05, "HookeJoint 1.angle": 0.05}
    rng, count, hits = np.random.default_rng(8), 4096, 0
    from trunnion.equations.coefficients import assemble
    from trunnion.floquet.tolerance.many_lines import ManyLines
    from trunnion.floquet.tolerance.spread import read_tolerances, tables

    assembly = assemble(LINE)
    spreads = read_tolerances(assembly, tolerances)
    lines = ManyLines(assembly, True, 2)
    for seed in range(100):
        study = tn.tolerance_study(LINE, tolerances, 1.64, samples=1024, seed=seed)
        found = lines.judged(tables(assembly, spreads, rng.random((count, 3)), 1.64), 1e-8)
        share = float((found.verdict == 0).mean())
        half = 1.96 * np.sqrt(share * (1 - share) / count)
        hits += study.interval[0] <= share + half and share - half <= study.interval[1]
    assert hits >= 90


def stiff(line: tn.Driveline, stiffness: float) -> tn.Driveline:
    """``line`` with a small disk behind a shaft that is all but rigid."""
    end = [tn.Shaft(stiffness=stiffness, damping=1.0), tn.Disk(inertia=1e-2)]
    return tn.Driveline([*line.elements, *end], damping_ratio=line.damping_ratio)


def test_stiff_lines_at_slow_speeds_have_the_probability_of_rigid_ones() -> None:
    """A last shaft a million times as stiff, whose mode makes a thousand cycles a turn: as if its disk were tied."""
    edge = brentq(lambda b: two_shafts.radius(1.61, b, gamma=1.01) - 1, 0.1, 0.3, xtol=1e-9)
    tolerances = {"HookeJoint 1.angle": ("range", edge - 0.03, edge + 0.07)}
    study = tn.tolerance_study(stiff(LINE, 1e6), tolerances, 1.61, samples=2048)
    assert study.probability == pytest.approx(0.3, abs=2e-3) and study.undecided == 0
    tied = tn.tolerance_study(LINE.replace("Disk 2", inertia=1.01), tolerances, 1.61, samples=2048)
    assert np.allclose(study.growth_rate, tied.growth_rate, atol=2e-6)


def test_every_line_of_a_stiff_driveline_is_decided_at_its_slowest_speed() -> None:
    """At 300 rpm the ordinary integration leaves the truck's radius open by more than its distance from 1."""
    truck = tn.load(Path(__file__).parents[2] / "examples/truck.toml")
    study = tn.tolerance_study(truck, {"front tube.length": 0.05, "joint 2.angle": 0.1}, tn.rpm(300), samples=256)
    assert study.probability == 1.0 and study.undecided == 0
    middle = tn.stability(truck, tn.rpm(300)).growth_rate
    assert np.all(np.abs(study.growth_rate / middle - 1) < 0.01) and study.worst.growth_rate < 0


@pytest.mark.parametrize("damping", [0.02, 0.0])
def test_both_ways_to_judge_many_lines_agree(damping: float) -> None:
    from trunnion.equations.coefficients import assemble
    from trunnion.floquet.tolerance.many_lines import ManyLines

    assembly = assemble(long_line(3, 4, damping * 1e-3))
    table = assembly.table(8, 150.0)
    table[:, 0] *= np.linspace(0.5, 1.5, 8)
    lines = ManyLines.of(assembly, table, True, 1)
    ordinary, stepped = lines.integrated(table, 1e-10), lines.stepped(table)
    assert np.all(np.abs(ordinary.radius - stepped.radius) <= ordinary.error + stepped.error)
    assert np.all(stepped.error < 1e-3) and np.array_equal(ordinary.verdict, stepped.verdict)


BAD = [
    (
        lambda: tn.tolerance_study(stiff(LINE, 1e14), {"Shaft 1.stiffness": 0.1}, 1e-2, samples=256),
        "speeds = 0.01: is too slow",
    ),
    (lambda: tn.tolerance_study(LINE, {}, 1.0), "tolerances = {}: must name one parameter or more"),
    (lambda: tn.tolerance_study(LINE, {"Shaft 1.stiffness": 2}, 1.0), "Shaft 1.stiffness = 2: is not a tolerance"),
    (lambda: tn.tolerance_study(LINE, {"Shaft 1.stiffness": ("range", 2, 1)}, 1.0), "Shaft 1.stiffness = ('range', 2"),
    (lambda: tn.tolerance_study(LINE, {"Shaft 2.fork_offset": 0.1}, 1.0), "Shaft 2.fork_offset: is zero"),
    (lambda: tn.tolerance_study(LINE, {"speed": 0.1}, 1.0), "speed: is not a parameter of the line"),
    (lambda: tn.tolerance_study(LINE, {"Shaft 1.stifness": 0.1}, 1.0), "Shaft 1.stifness: is not a parameter"),
    (
        lambda: tn.tolerance_study(LINE, {"Shaft 1.stiffness": 0.1, "factor of Shaft *.stiffness": 0.1}, 1.0),
        "factor of Shaft *.stiffness: moves Shaft 1.stiffness, as",
    ),
    (
        lambda: tn.tolerance_study(LINE, {"Shaft 1.stiffness": ("range", -1.0, 1.0)}, 1.0),
        "Shaft 1.stiffness: would reach -1, which no line can have",
    ),
    (lambda: tn.tolerance_study(LINE, {"Shaft 1.stiffness": 0.1}, 0.0), "speeds = 0: must be positive"),
    (lambda: tn.tolerance_study(LINE, {"Shaft 1.stiffness": 0.1}, 1.0, samples=10), "samples = 10: must be a whole"),
    (lambda: tn.tolerance_study(LINE, {"Shaft 1.stiffness": 0.1}, 1.0, confidence=2), "confidence = 2: must lie"),
]


@pytest.mark.parametrize(("run", "message"), BAD)
def test_refusals(run, message: str) -> None:
    with pytest.raises(tn.InputError) as caught:
        run()
    assert str(caught.value).startswith(message) and "\n" not in str(caught.value)


DISK = tn.Disk(inertia=0.5, name="disk", excitation=[{"order": 2, "amplitude": 10.0}])
OSCILLATOR = tn.Driveline(
    [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0, name="shaft"), DISK],
    limits=[tn.Limit(of="shaft", vibratory_torque=20.0, max_torque=30.0), tn.Limit(of="disk", max_acceleration=1e4)],
    tolerances=[tn.Tolerance("shaft", stiffness="20 %"), tn.Tolerance("disk", inertia="1 %")],
)


def torque(stiffness: np.ndarray, inertia: np.ndarray, speed: float) -> np.ndarray:
    held = stiffness + 2j * (2 * speed)
    return 10.0 * np.abs(held / (held - inertia * (2 * speed) ** 2))


@pytest.mark.slow
def test_probability_of_checks_is_an_area() -> None:
    """One shaft below its resonance: its vibratory torque in closed form over the two tolerances."""
    speed = 48.0
    study = tn.tolerance_study(OSCILLATOR, speeds=speed, checks=256, samples=256)
    checks = study.checks
    assert checks is not None and checks.lines == 256 and not checks.chosen_by_cost
    k, j = np.meshgrid(np.linspace(8e3, 12e3, 801), np.linspace(0.495, 0.505, 81))
    inside = torque(k, j, speed)
    share = dict(zip(checks.check, zip(checks.probability, checks.interval, strict=True), strict=True))
    for name, allowed in (("vibratory torque of shaft", 20.0), ("max torque of shaft", 30.0)):
        truth = float((inside <= allowed).mean())
        probability, (low, high) = share[name]
        assert 0 < truth <= 1 and low - 5e-3 <= truth <= high + 5e-3 and probability == pytest.approx(truth, abs=0.02)
    assert share["max acceleration of disk"][0] == 1.0
    assert checks.together == pytest.approx(float((inside <= 20.0).mean()), abs=0.02)
    assert checks.worst is not None and checks.worst.check == "vibratory torque of shaft"
    assert checks.worst.values["shaft.stiffness"] == pytest.approx(8e3) and checks.worst.spare < 0
    assert checks.worst.values["disk.inertia"] == pytest.approx(0.505)
    worst = torque(np.array(8e3), np.array(0.505), speed)
    assert checks.worst.spare == pytest.approx(1 - worst / 20.0, rel=1e-6)
    assert checks.ranking[0][0] == "shaft.stiffness"
    assert "every check holds with probability" in str(study) and "checks_together" in study.data.attrs


def test_lines_are_chosen_by_cost_and_the_result_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    from trunnion.design.tolerance import checks as module

    monkeypatch.setattr(module, "SECONDS", 1e-3)
    found = tn.tolerance_study(OSCILLATOR, speeds=48.0, checks=True, samples=256).checks
    assert found is not None and found.chosen_by_cost and found.lines == 64 and "0.001 s allow" in str(found)


def test_a_share_of_a_load_that_load_cases_alone_state_is_one_of_the_heaviest():
    """Taken under that case, and told; without load cases there is nothing to take a share of."""
    parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=3.0), tn.Disk(inertia=0.5, name="roll")]
    cases = [tn.LoadCase(name="rolling", loads={"roll": 60.0}), tn.LoadCase(name="bite", loads={"roll": -110.0})]
    line = tn.Driveline(parts, operation=tn.Operation(speed=100.0, load_cases=cases))
    found = tn.tolerance_study(line, {"roll.load_torque": 0.1}, samples=256)
    assert (found.low[0], found.high[0]) == pytest.approx((-121.0, -99.0))
    assert "load case bite" in str(found.findings[0])
    with pytest.raises(tn.errors.InputError, match=r"roll\.load_torque.*is zero"):
        tn.tolerance_study(tn.Driveline(parts, operation=tn.Operation(speed=100.0)), {"roll.load_torque": 0.1})

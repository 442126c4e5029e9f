"""Patterns in paths mean each element by itself, whichever analysis or command reads them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn

SPEED = tn.rpm(1500)


def line(**more: object) -> tn.Driveline:
    """Two unlike half shafts, one of whose names is that of no kind, and a coupling named like them."""
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(name="half shaft left", stiffness=1e4, damping=1.0),
        tn.Disk(inertia=0.4),
        tn.HookeJoint(name="joint left", angle=0.2),
        tn.Shaft(name="half shaft right", stiffness=3e4, damping=1.0),
        tn.Disk(inertia=0.9),
        tn.Coupling(name="coupling", stiffness=5e4, damping=2.0),
        tn.Disk(inertia=0.1),
    ]
    return tn.Driveline(parts, **more)


def ends(found: tn.ToleranceStudy) -> dict[str, tuple[float, float]]:
    return dict(zip(found.parameters, zip(found.low.tolist(), found.high.tolist(), strict=True), strict=True))


@pytest.mark.parametrize("pattern", ["Shaft *", "half shaft *", "half*"])
def test_a_tolerance_of_a_pattern_is_each_ones_own(pattern: str) -> None:
    found = tn.tolerance_study(line(), {f"{pattern}.stiffness": 0.1}, SPEED, samples=256)
    expected = {"half shaft left.stiffness": (9e3, 1.1e4), "half shaft right.stiffness": (2.7e4, 3.3e4)}
    assert ends(found) == {name: pytest.approx(both) for name, both in expected.items()}
    stated = line(tolerances=[tn.Tolerance(pattern, stiffness="10 %")])
    by_file = tn.tolerance_study(tn.loads(tn.dumps(stated)), speeds=SPEED, samples=256)
    assert ends(by_file) == ends(found) and by_file.worst == found.worst


def test_the_two_shafts_of_the_review() -> None:
    """−0.2840 1/s at 1500 rpm, not the −0.2393 of both shafts with one stiffness."""
    whole = line().elements
    two = tn.Driveline(whole[:6])
    assert tn.tolerance_study(two, {"Shaft *.stiffness": 0.1}, SPEED).worst.growth_rate == pytest.approx(
        -0.2840, abs=5e-5
    )


def test_one_element_goes_before_a_pattern_and_that_before_a_kind() -> None:
    given = {"half shaft left.stiffness": 0.01, "Shaft *.stiffness": 0.3, "* right.stiffness": 0.2}
    found = ends(tn.tolerance_study(line(), given, SPEED, samples=256))
    assert found["half shaft left.stiffness"] == pytest.approx((9.9e3, 1.01e4))
    assert found["half shaft right.stiffness"] == pytest.approx((2.4e4, 3.6e4))
    limits = [
        tn.Limit(of="Shaft *", max_torque=100.0), tn.Limit(of="half shaft *", max_torque=200.0),
        tn.Limit(of="half shaft left", max_torque=300.0),
    ]  # fmt: skip
    held = {one.element: one.value for one in line(limits=limits).limits_by_element}
    assert held == {"half shaft left": 300.0, "half shaft right": 200.0}


def test_designs_and_derivatives_take_each_by_itself() -> None:
    names = ("half shaft left.stiffness", "half shaft right.stiffness")
    found = tn.sensitivity(line(), parameters=["half shaft *.stiffness"], of=["frequencies"])
    assert found.parameters == names
    alone = tn.sensitivity(line(), parameters=names, of=["frequencies"])
    np.testing.assert_array_equal(found.derivative, alone.derivative)
    designs = tn.optimise(
        line(), {"half shaft *.stiffness": (5e3, 5e4)}, "growth rate", (150.0, 160.0), checks=False, designs=20
    )
    assert designs.free == names


UNLIKE = "would make unlike numbers one (half shaft left.stiffness 10000 and half shaft right.stiffness 30000 N m/rad)"
BOX = ("half shaft *.stiffness", 1e4, 2e4)
ABSOLUTE = {
    "chart": lambda one: tn.stability_chart(one, ("speed", 100, 200, 3), (*BOX, 3)),
    "tongues": lambda one: tn.tongues(one, ("speed", 100, 200), BOX, rows=3),
    "limit": lambda one: tn.stable_limit(one, BOX[0], [SPEED], low=1e4, high=2e4),
    "windows": lambda one: tn.stable_windows(one, *BOX, (100.0, 110.0)),
    "branch": lambda one: tn.periodic_branch(one, BOX[0], 1e4, 2e4, speed=SPEED),
}


@pytest.mark.parametrize("name", ABSOLUTE)
def test_an_axis_does_not_make_unlike_elements_alike(name: str) -> None:
    with pytest.raises(tn.InputError) as refused:
        ABSOLUTE[name](line())
    assert UNLIKE in str(refused.value) and 'vary the "factor of half shaft *.stiffness"' in str(refused.value)


def test_an_axis_over_elements_of_one_value_is_that_value() -> None:
    alike = line().replace("half shaft right", stiffness=1e4)
    chart = tn.stability_chart(alike, ("speed", 150, 160, 2), ("half shaft *.stiffness", 1e4, 2e4, 2))
    both = alike.replace_all({name: {"stiffness": 2e4} for name in ("half shaft left", "half shaft right")})
    assert chart.spectral_radius[1, 0] == pytest.approx(tn.stability(both, 150.0).spectral_radius, abs=1e-8)


def test_a_range_of_multiples_is_the_factor_of_each(run, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("two.toml").write_text(tn.dumps(line()), encoding="utf-8")
    axes = ("--x", "speed:150rad/s:160rad/s:2", "--y", "half shaft *.stiffness:0.5x:2x:2")
    shown = run("stability-chart", "two.toml", *axes, "--json")
    assert json.loads(shown.stdout)["y"] == {
        "parameter": "factor of half shaft *.stiffness", "unit": "1", "low": 0.5, "high": 2.0, "points": 2
    }  # fmt: skip


@pytest.mark.parametrize(
    "call",
    [
        ("stable-limit", "-p", "joint left.angle:0deg:4deg", "--speed", "1500rpm:1510rpm:2"),
        ("stable-windows", "-p", "joint left.angle:0deg:4deg", "--speed", "1500rpm:1510rpm"),
        ("tongues", "--x", "speed:1500rpm:1510rpm", "--y", "joint left.angle:0deg:4deg"),
        ("stability-chart", "--x", "speed:1500rpm:1510rpm", "--y", "joint left.angle:0deg:4deg", "--points", "3x3"),
    ],
    ids=lambda call: call[0],
)
def test_every_command_reads_the_same_axis(run, tmp_path, monkeypatch, call: tuple[str, ...]) -> None:
    """PARAMETER:LOW:HIGH, with or without a number of points."""
    monkeypatch.chdir(tmp_path)
    Path("two.toml").write_text(tn.dumps(line()), encoding="utf-8")
    command, *rest = call
    done = run(command, "two.toml", *rest)
    assert done.exit_code == 0, done.stdout + done.stderr
    counted = [f"{word}:3" if word.endswith("4deg") else word for word in rest]
    assert run(command, "two.toml", *counted).exit_code == 0

"""A chart's point is what ``stability`` says there, whatever its axes; and it survives saving."""

from __future__ import annotations

import csv
import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.chains import random_chain
from oracles.package_kernels import chain_radius

import trunnion as tn
from trunnion.papers.two_shaft_cardan.published import (
    DAMPING_OF_SHAFT_2,
    DAMPING_RATIO,
    INERTIA_OF_DISK_2,
    STIFFNESS_OF_SHAFT_2,
    group_parameters,
)
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict


def loaded_line() -> tn.Driveline:
    """Two joints, a tube with density and loss factor, loads."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=3.0e3, damping=1.5, fork_offset=0.4),
            tn.Disk(inertia=0.8, load_torque=5.0),
            tn.HookeJoint(angle=0.4),
            tn.Shaft(
                outer_diameter=0.03,
                inner_diameter=0.02,
                length=0.7,
                shear_modulus=79.3e9,
                density=7850,
                loss_factor=0.02,
                loss_factor_frequency=100.0,
                fork_offset=0.9,
            ),
            tn.Disk(inertia=0.5),
            tn.HookeJoint(angle=0.3, plane=0.5),
            tn.Shaft(stiffness=2.0e3, damping=1.0),
            tn.Disk(inertia=1.2, load_torque=30.0),
        ]
    )


def check_points(chart: StabilityChart, build: Any, seed: int = 0, count: int = 12) -> None:
    """Random points of ``chart`` against ``build(x, y)`` → (line, speed) judged one by one."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        i, j = int(rng.integers(len(chart.y))), int(rng.integers(len(chart.x)))
        line, speed = build(float(chart.x[j]), float(chart.y[i]))
        here = tn.stability(line, speed)
        scale = max(1.0, here.spectral_radius)
        wrong = abs(chart.spectral_radius[i, j] - here.spectral_radius)
        assert wrong < 1e-8 * scale and wrong <= chart.error_estimate[i, j] + here.error_estimate
        if abs(here.spectral_radius - 1) > chart.error_estimate[i, j]:
            assert chart.verdict[i, j] == here.verdict


def test_speed_and_angle() -> None:
    line = tn.catalogue("two-shaft-cardan")
    chart = tn.stability_chart(line, x=("speed", 0.1, 2.0, 33), y=("HookeJoint 1.angle", 0.0, 1.4, 17))
    check_points(chart, lambda x, y: (tn.catalogue("two-shaft-cardan", angle=y), x), count=30)
    assert chart.count(Verdict.UNSTABLE) > 20 and chart.count(Verdict.STABLE) > 200
    assert chart.spectral_radius.shape == (17, 33) and chart.speed is None


def test_angle_and_angle() -> None:
    line = tn.catalogue("three-shaft-cardan")
    chart = tn.stability_chart(
        line, x=("HookeJoint 1.angle", 0.0, 1.2, 19), y=("HookeJoint 2.angle", 0.0, 1.2, 11), speed=1.03
    )
    check_points(chart, lambda x, y: (tn.catalogue("three-shaft-cardan", angle_1=x, angle_2=y), 1.03))
    assert chart.speed == 1.03


def test_stiffness_and_speed() -> None:
    chart = tn.stability_chart(loaded_line(), x=("Shaft 3.stiffness", 1e3, 9e3, 9, "log"), y=("speed", 15.0, 80.0, 9))
    assert chart.x == pytest.approx(np.geomspace(1e3, 9e3, 9))
    check_points(chart, lambda x, y: (loaded_line().replace("Shaft 3", stiffness=x), y))


def test_load_and_angle() -> None:
    chart = tn.stability_chart(
        loaded_line(),
        x=("Disk 3.load_torque", -40.0, 120.0, 9),
        y=("HookeJoint *.angle", 0.0, 0.8, 9),
        speed=51.0,
    )

    def build(x: float, y: float) -> tuple[tn.Driveline, float]:
        line = loaded_line().replace("Disk 3", load_torque=x)
        return line.replace("HookeJoint 1", angle=y).replace("HookeJoint 2", angle=y), 51.0

    check_points(chart, build)
    assert np.ptp(chart.spectral_radius[4]) > 1e-5


@pytest.mark.slow
def test_tube_length_and_inertia() -> None:
    chart = tn.stability_chart(
        loaded_line(), x=("Shaft 2.length", 0.2, 1.5, 7), y=("Disk 2.inertia", 0.1, 2.0, 7), speed=47.0
    )
    check_points(chart, lambda x, y: (loaded_line().replace("Shaft 2", length=x).replace("Disk 2", inertia=y), 47.0))


def test_factor_of_damping_and_fork_offset() -> None:
    line = tn.catalogue("three-shaft-cardan", angle_1=0.5, angle_2=0.5, damping_ratio=0.01)
    chart = tn.stability_chart(
        line,
        x=("factor of Shaft *.damping", 0.01, 10.0, 7, "log"),
        y=("Shaft 2.fork_offset", -np.pi, np.pi, 9),
        speed=1.03,
    )

    def build(x: float, y: float) -> tuple[tn.Driveline, float]:
        return (
            tn.catalogue("three-shaft-cardan", angle_1=0.5, angle_2=0.5, damping_ratio=0.01 * x, fork_offset=y),
            1.03,
        )

    check_points(chart, build)
    # The fork has no head: ν and ν + 180° are one assembly.
    assert chart.spectral_radius[0] == pytest.approx(chart.spectral_radius[-1], abs=1e-9)
    assert chart.spectral_radius[0] == pytest.approx(chart.spectral_radius[4], abs=1e-9)


def test_common_damping_ratio() -> None:
    bare = tn.catalogue("two-shaft-cardan", damping_ratio=0.0)
    line = tn.Driveline(bare.elements, damping_ratio=0.01, damping_ratio_frequency=1.3)
    chart = tn.stability_chart(line, x=("speed", 0.3, 2.0, 9), y=("damping_ratio", 0.001, 0.1, 5, "log"))
    check_points(chart, lambda x, y: (tn.Driveline(bare.elements, damping_ratio=y, damping_ratio_frequency=1.3), x))


GROUPS = {
    DAMPING_RATIO: ("damping_ratio", 0.002, 0.05),
    DAMPING_OF_SHAFT_2: ("damping_of_shaft_2", 0.5, 20.0),
    STIFFNESS_OF_SHAFT_2: ("stiffness_of_shaft_2", 0.3, 3.0),
    INERTIA_OF_DISK_2: ("inertia_of_disk_2", 0.2, 100.0),
}


@pytest.mark.parametrize("scale", [1.0, 250.0])
@pytest.mark.parametrize("pair", list(itertools.permutations(GROUPS, 2)), ids=lambda p: " × ".join(p))
def test_groups_of_the_paper(pair: tuple[str, str], scale: float) -> None:
    """α, μ, γ, ζ on any two axes, in either order and any units; refused where they cannot be combined."""
    fixed = {"angle": 0.5, "stiffness": scale, "inertia": 2.0 * scale, "damping_ratio": 0.01}
    fixed["damping_of_shaft_2"] = 1.5
    line = tn.catalogue("two-shaft-cardan", **fixed)
    speed = 1.6 / np.sqrt(2)
    groups = group_parameters(line)
    x, y = ((groups[name], *GROUPS[name][1:], 4) for name in pair)
    try:
        chart = tn.stability_chart(line, x=x, y=y, speed=speed)
    except tn.InputError:
        assert set(pair) == {DAMPING_RATIO, DAMPING_OF_SHAFT_2}
        return

    def build(x: float, y: float) -> tuple[tn.Driveline, float]:
        return tn.catalogue("two-shaft-cardan", **{**fixed, GROUPS[pair[0]][0]: x, GROUPS[pair[1]][0]: y}), speed

    check_points(chart, build, count=6)


def test_axes_that_move_the_same_number_are_refused() -> None:
    line = tn.catalogue("three-shaft-cardan")
    with pytest.raises(tn.InputError):
        tn.stability_chart(
            line, x=("HookeJoint 1.angle", 0.1, 0.5, 3), y=("HookeJoint *.angle", 0.1, 0.5, 3), speed=1.0
        )


def test_speed_as_a_parameter_of_your_own() -> None:
    """An axis in rpm is a speed axis too: no other speed is asked for."""
    line = tn.catalogue("two-shaft-cardan", stiffness=1e4, inertia=1.0)
    rpm = tn.Parameter("speed in rpm", "rpm", (tn.Term("speed", 2 * np.pi / 60),))
    chart = tn.stability_chart(line, x=(rpm, 300.0, 1500.0, 5), y=("HookeJoint 1.angle", 0.1, 0.9, 4))
    check_points(
        chart,
        lambda x, y: (tn.catalogue("two-shaft-cardan", stiffness=1e4, inertia=1.0, angle=y), tn.rpm(x)),
        count=5,
    )


def test_verdict_codes() -> None:
    """Stable 0, unstable 1, marginal 2 without damping; a stable chart reports no other."""
    line = tn.catalogue("two-shaft-cardan", angle=0.5, inertia_of_disk_2=100.0, damping_ratio=0.0)
    bare = tn.stability_chart(line, x=("speed", 1.0, 1.8, 41), y=("HookeJoint 1.angle", 0.3, 0.5, 3))
    assert set(np.unique(bare.verdict)) == {1, 2}
    damped = tn.stability_chart(
        tn.catalogue("two-shaft-cardan", inertia_of_disk_2=100.0),
        x=("speed", 1.0, 1.8, 41),
        y=("HookeJoint 1.angle", 0.3, 0.5, 3),
    )
    assert set(np.unique(damped.verdict)) == {0, 1}
    assert np.array_equal(damped.verdict == 1, damped.spectral_radius > 1)
    inside = (damped.x > 1.400251) & (damped.x < 1.432358)
    assert np.array_equal(damped.verdict[0] == 1, inside)


def test_steady_twist_is_an_option() -> None:
    options = {"x": ("speed", 40.0, 60.0, 5), "y": ("HookeJoint 1.angle", 0.2, 0.6, 3)}
    twisted = tn.stability_chart(loaded_line(), **options)
    straight = tn.stability_chart(loaded_line(), **options, statically_twisted=False)
    assert np.abs(twisted.spectral_radius - straight.spectral_radius).max() > 1e-5
    here = tn.stability(loaded_line().replace("HookeJoint 1", angle=0.6), 60.0, statically_twisted=False)
    assert straight.spectral_radius[-1, -1] == pytest.approx(here.spectral_radius, abs=1e-8)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_and_progress(threads: int) -> None:
    seen: list[float] = []
    chart = tn.stability_chart(
        tn.catalogue("two-shaft-cardan"),
        x=("speed", 0.2, 2.0, 90),
        y=("HookeJoint 1.angle", 0.0, 1.0, 66),
        threads=threads,
        progress=seen.append,
    )
    alone = tn.stability_chart(
        tn.catalogue("two-shaft-cardan"),
        x=("speed", 0.2, 2.0, 90),
        y=("HookeJoint 1.angle", 0.0, 1.0, 66),
        threads=1,
    )
    assert np.abs(chart.spectral_radius - alone.spectral_radius).max() < 1e-8
    assert seen == sorted(seen) and 0 <= seen[0] and seen[-1] == pytest.approx(1)


def small_chart() -> StabilityChart:
    """A chart with several verdicts and a remark."""
    return tn.stability_chart(
        tn.catalogue("two-shaft-cardan"), x=("speed", 0.0, 2.0, 15), y=("HookeJoint 1.angle", 0.0, 1.2, 7)
    )


def test_speed_axis_that_touches_zero_is_clipped_and_says_so() -> None:
    chart = small_chart()
    assert chart.x[0] > 0 and any("speed axis starts at" in r for r in chart.remarks)
    assert np.all(np.isfinite(chart.spectral_radius))


def test_save_and_reload_is_the_identity(tmp_path: Path) -> None:
    chart = small_chart()
    chart.save(tmp_path / "chart.nc")
    again = tn.load_chart(tmp_path / "chart.nc")
    for name in ("x", "y", "spectral_radius", "error_estimate", "verdict"):
        before, after = getattr(chart, name), getattr(again, name)
        assert np.array_equal(before, after) and before.dtype == after.dtype
    for name in (
        "x_label", "y_label", "x_unit", "y_unit", "speed", "period", "tolerance", "remarks", "line",
    ):  # fmt: skip
        assert getattr(chart, name) == getattr(again, name)
    assert str(chart) == str(again)
    assert [p.name for p in tmp_path.iterdir()] == ["chart.nc"]


def test_reload_keeps_the_fixed_speed(tmp_path: Path) -> None:
    chart = tn.stability_chart(
        tn.catalogue("two-shaft-cardan"),
        x=("Shaft 2.stiffness", 1, 2, 3),
        y=("Disk 2.inertia", 1, 2, 3),
        speed=0.7,
    )
    chart.save(tmp_path / "c.nc")
    assert tn.load_chart(tmp_path / "c.nc").speed == 0.7


def test_csv_holds_every_point(tmp_path: Path) -> None:
    chart = small_chart()
    chart.to_csv(tmp_path / "chart.csv")
    with (tmp_path / "chart.csv").open(newline="", encoding="utf-8") as stream:
        header, *rows = list(csv.reader(stream))
    assert header == [
        "speed [rad/s]", "HookeJoint 1.angle [rad]", "spectral radius", "error estimate", "verdict",
    ]  # fmt: skip
    assert len(rows) == chart.verdict.size
    words = {str(v): int(v) for v in Verdict}
    for row, (i, j) in zip(rows, np.ndindex(chart.verdict.shape), strict=True):
        assert float(row[0]) == chart.x[j] and float(row[1]) == chart.y[i]
        assert float(row[2]) == chart.spectral_radius[i, j] and float(row[3]) == chart.error_estimate[i, j]
        assert words[row[4]] == chart.verdict[i, j]


@pytest.mark.parametrize("shafts", [3, 5, 8])
def test_fine_charts_of_random_chains(shafts: int) -> None:
    """Charts fine enough to be interpolated, against point-by-point integration."""
    chain = random_chain(np.random.default_rng(100 + shafts), shafts=shafts)
    joint = next(n for n in chain.line().names if n.startswith("HookeJoint"))
    low, high = 0.8 * chain.speed, 1.3 * chain.speed
    chart = tn.stability_chart(chain.line(), x=("speed", low, high, 90), y=(f"{joint}.angle", 0.0, 0.8, 70))
    check_points(chart, lambda x, y: (chain.line().replace(joint, angle=y), x), count=25)


@pytest.mark.parametrize("angle", [0.3, 0.9])
def test_no_tongue_is_lost_between_nodes(angle: float) -> None:
    """A row of 3000 speeds through narrow tongues: every verdict as by the kernel alone."""
    line = tn.catalogue("two-shaft-cardan", inertia_of_disk_2=100.0, angle=angle)
    chart = tn.stability_chart(line, x=("speed", 0.1, 1.6, 3000), y=("HookeJoint 1.angle", angle - 0.01, angle, 3))
    radius, error = chain_radius(line, chart.x)
    sure = np.abs(radius - 1) > error + chart.error_estimate[-1]
    assert sure.mean() > 0.99
    assert np.array_equal(chart.verdict[-1, sure] == Verdict.UNSTABLE, radius[sure] > 1)
    assert np.abs(chart.spectral_radius[-1] - radius).max() < 2e-8


@pytest.mark.slow
def test_a_fine_chart_point_by_point() -> None:
    """Every tenth pixel of an S1 chart, down to the locked joint's neighbourhood."""
    line = tn.catalogue("two-shaft-cardan")
    chart = tn.stability_chart(line, x=("speed", 0.02, 2.0, 100), y=("HookeJoint 1.angle", 0.0, 1.5, 100))
    worst = 0.0
    for i, j in itertools.product(range(0, 100, 10), range(3, 100, 10)):
        here = tn.stability(tn.catalogue("two-shaft-cardan", angle=float(chart.y[i])), float(chart.x[j]))
        wrong = abs(chart.spectral_radius[i, j] - here.spectral_radius)
        assert wrong <= chart.error_estimate[i, j] + here.error_estimate
        worst = max(worst, wrong / max(1.0, here.spectral_radius))
    assert worst < 1e-8

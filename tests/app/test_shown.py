"""What is sent to the page, without one."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.app.shown import assessment, chart, turn
from trunnion.driveline.driveline import hooke_joints
from trunnion.driveline.starter import starter

pytest.importorskip("panel")

from trunnion.app.views.stability import end_of_colours


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two-shaft", "three-shaft", "truck"])
def test_the_colours_of_a_chart_tell_its_points_apart(name: str) -> None:
    """Whatever a turn takes away: neither is all of it white nor all of it of the darkest colour."""
    line = tn.loads(starter(name))
    speeds, angles = ("speed", tn.rpm(500), tn.rpm(2500), 6), (f"{hooke_joints(line)[0][0]}.angle", 0.0, 0.3, 4)
    growth = chart(tn.stability_chart(line, speeds, angles))["growth"]
    end = end_of_colours(growth)
    shades = np.unique(np.clip(np.floor(5 * np.abs(growth) / end), 0, 4))
    assert len(shades) >= 2
    assert np.mean(np.abs(growth) <= end) >= 0.9 and np.percentile(np.abs(growth), 90) >= end / 2.5


@pytest.mark.parametrize("size", [1e-6, 3e-4, 0.02, 0.7, 40.0])
def test_the_ends_of_the_colours_are_round_and_follow_the_growth(size: float) -> None:
    growth = np.linspace(-size, size, 101)
    growth[3] = np.nan
    end = end_of_colours(growth)
    assert float(f"{end:.0e}") == pytest.approx(end) and f"{end:.0e}"[0] in "125"
    assert end >= 0.9 * 0.98 * size and (end <= 2.5 * size or end == 1e-4)
    assert end_of_colours(np.full(4, np.nan)) == 1e-4


def turned(line: tn.Driveline) -> dict[str, object]:
    return turn(tn.kinetostatics(line))


def test_accelerations_are_those_of_each_named_output() -> None:
    """Behind a ratio an output turns and accelerates less; with branches each has its own line."""
    line = tn.loads(starter("truck"))
    (one,) = turned(line)["outputs"]  # type: ignore[misc]
    result = tn.kinetostatics(line)
    assert (one["name"], one["ratio"]) == ("", abs(result.mean_ratio))
    assert one["acceleration"] == result.peak_acceleration


def test_rounding_is_not_drawn_and_not_printed() -> None:
    """Straight joints, and two that cancel each other: what is left is zero, not 2.5e-16."""
    for line in (tn.loads(starter("two-shaft")).replace("HookeJoint 1", angle=0.0), tn.loads(starter("three-shaft"))):
        data = turned(line)
        (output,) = data["outputs"]  # type: ignore[misc]
        assert (output["irregularity"], output["acceleration"]) == (0.0, 0.0)
        last = np.asarray(data["deviation"])[-1]
        assert not last.any()


def test_a_sketch_says_which_joints_it_does_not_show() -> None:
    """Behind a ratio, where the line goes on from another train."""
    shaft = {"stiffness": 1e4, "damping": 2.0}
    front = [tn.ConstantSpeed(), tn.Shaft(**shaft), tn.HookeJoint(name="front", angle=0.2), tn.Shaft(**shaft)]
    drive = [tn.Ratio(teeth_in=10, teeth_out=41), tn.Disk(inertia=0.4), tn.Shaft(**shaft)]
    wheel = [tn.HookeJoint(name="hidden", angle=0.3), tn.Shaft(**shaft), tn.Disk(inertia=0.4)]
    for behind, notes in ((wheel, 1), ([], 0)):
        figure = tn.sketch(tn.Driveline([*front, *drive, *behind]))
        said = [" ".join(text.get_text().split()) for text in figure.texts if "not drawn" in text.get_text()]
        assert len(said) == notes and all("hidden" in one and "front" not in one for one in said)
        assert any(text.get_text().startswith("front\n") for text in figure.texts)


def test_what_binds_is_drawn_whatever_it_is() -> None:
    """The motion of a disk in rpm, with its limit and the orders that make it."""
    line = tn.loads(starter("two-shaft"))
    disk = next(e.name for e in reversed(line.elements) if e.kind == "Disk")
    limit = tn.Limit(of=disk, max_speed_fluctuation="0.01 rpm")
    found = tn.assess(tn.Driveline(line.elements, limits=[limit], operation=line.operation))
    course = assessment(found)["course"]
    assert (course["quantity"], course["unit"]) == (f"speed fluctuation of {disk}", "rpm")
    assert course["values"][-1] == pytest.approx(np.full(len(course["speed"]), 0.01))
    assert tn.rpm(course["values"][0].max()) == pytest.approx(found.binding.value)
    assert course["names"][0].startswith("all together") and "order 2" in course["names"]

"""What is sent to the page, without one."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.app.shown import assessment, chart, turn
from trunnion.driveline.driveline import hooke_joints
from trunnion.driveline.starter import starter
from trunnion.pictures.picture import ColouredGrid, Line
from trunnion.pictures.stability_chart import DECAYS, _steps

pytest.importorskip("panel")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two-shaft", "three-shaft", "truck"])
def test_the_colours_of_a_chart_tell_its_points_apart(name: str) -> None:
    """Whatever a turn takes away: its steps are not all of one colour, nor is one of them nearly all of the chart."""
    line = tn.loads(starter(name))
    speeds, angles = ("speed", tn.rpm(500), tn.rpm(2500), 6), (f"{hooke_joints(line)[0][0]}.angle", 0.0, 0.3, 4)
    items = chart(tn.stability_chart(line, speeds, angles), "rpm")["picture"].panel.items
    mesh = next(item for item in items if isinstance(item, ColouredGrid))
    shown = mesh.values[np.isfinite(mesh.values)]
    levels = mesh.colours.levels or np.linspace(mesh.colours.low, mesh.colours.high, 6)
    assert shown.min() >= levels[0] * (1 - 1e-9) and shown.max() <= levels[-1] * (1 + 1e-9)
    shades = np.unique(np.digitize(shown, levels), return_counts=True)[1]
    assert len(shades) >= 2 and shades.max() <= 0.9 * shown.size


@pytest.mark.parametrize("size", [1e-6, 3e-4, 0.02, 0.7, 40.0])
def test_the_steps_of_the_colours_are_round_and_cover_the_decay(size: float) -> None:
    low, high, _, levels = _steps(np.linspace(size / 50, size, 101))
    steps = np.diff(levels)
    assert np.ptp(steps) < 1e-9 * size and 4 <= len(steps) <= DECAYS + 2
    assert float(f"{steps[0]:.2g}") == pytest.approx(steps[0])
    assert low == levels[0] <= size / 50 and high == levels[-1] >= size


def turned(line: tn.Driveline) -> dict[str, object]:
    return turn(tn.kinetostatics(line), "rpm", 0.0)


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
        speeds = data["picture"].panels[0]  # type: ignore[attr-defined]
        every = np.concatenate([one.y for one in speeds.items])
        behind = next(one.y for one in speeds.items if line.names[-2] in one.name)
        low, high = (every.min(), every.max()) if speeds.y.low is None else (speeds.y.low, speeds.y.high)
        assert np.ptp(behind) < 1e-9 * (high - low)


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
    panel = assessment(found)["course"].panel
    assert (panel.title, panel.y.unit) == (f"speed fluctuation of {disk}", "rpm")
    whole, *orders, most = [item for item in panel.items if isinstance(item, Line)]
    assert most.y == pytest.approx(np.full(len(whole.x), 0.01))
    assert tn.rpm(np.max(whole.y)) == pytest.approx(found.binding.value)
    assert whole.name.startswith("all together") and "order 2" in [one.name for one in orders]

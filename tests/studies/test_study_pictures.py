"""Pictures of a study show the numbers that it kept, where they stand, and what is missing or failed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from studies.asked import grid, line, stated

import trunnion as tn
from trunnion.pictures.draw_matplotlib import draw, save
from trunnion.pictures.picture import Band, Bars, Cells, ColouredGrid, Line, Points
from trunnion.pictures.studies import LINES, shares
from trunnion.pictures.studies import study as picture
from trunnion.results.verdict import Verdict
from trunnion.studies.store import Store
from trunnion.studies.task import run_blocks

DEGREES = 180 / np.pi


def item(found, kind):
    """The one item of a kind in a picture of one panel."""
    [one] = [item for item in found.panel.items if isinstance(item, kind)]
    return one


@pytest.fixture(scope="module")
def gridded(tmp_path_factory):
    """Three parameters on a grid."""
    damping = {"path": "Shaft 1.damping", "values": [0.02, 0.001, 0.01]}
    store = tmp_path_factory.mktemp("grid") / "a.zarr"
    return tn.study(stated(store, parameter=[damping, *grid(9, 33)]), line=line(), workers=0)


@pytest.fixture(scope="module")
def sampled(tmp_path_factory):
    """Two parameters sampled, one on a grid."""
    store = tmp_path_factory.mktemp("sampled") / "a.zarr"
    scatter = [{"path": "Shaft 1.stiffness", "low": 0.8, "high": 1.2}, {"path": "Shaft 1.damping", "tolerance": "50 %"}]
    more = {"parameter": [*scatter, grid(9, 33)[1]], "sampling": {"points": 16}}
    return tn.study(stated(store, **more), line=line(), workers=0)


def test_a_chart_has_every_point_in_its_place(gridded) -> None:
    """Speed along, the angle up; the damping where the line states it, 0.01, which stands last in its list."""
    found = picture(gridded, y="HookeJoint 1.angle")
    mesh, values = item(found, ColouredGrid), gridded.grid("growth_rate")
    assert np.array_equal(mesh.values, values[2].reshape(9, 33)) and "Shaft 1 0.01" in found.panel.title
    assert mesh.y == pytest.approx(DEGREES * np.unique(gridded.parameter("HookeJoint 1.angle")))
    assert np.array_equal(mesh.x, np.unique(gridded.parameter("speed"))) and mesh.colours.low == -mesh.colours.high
    other = picture(gridded, x="Shaft 1.damping", y="speed", at={"HookeJoint 1.angle": 1.0})
    rising = item(other, ColouredGrid)
    assert rising.x.tolist() == [0.001, 0.01, 0.02]
    assert np.array_equal(rising.values, values[[1, 2, 0], 8].T)


def test_verdicts_have_their_own_look(gridded) -> None:
    cells = {one.name: one for one in picture(gridded, quantity="verdict").panel.items if isinstance(one, Cells)}
    assert set(cells) == {"stable", "unstable"} and cells["stable"].where.shape == (3, 33), "damping up"
    unstable = picture(gridded, quantity="verdict", y="HookeJoint 1.angle", at={"Shaft 1.damping": 0.0})
    found = next(one for one in unstable.panel.items if isinstance(one, Cells) and one.name == "unstable")
    assert found.role == "unstable"
    assert np.array_equal(found.where, gridded.grid("verdict")[1] == Verdict.UNSTABLE) and found.where.any()


def test_slices_are_rows_of_the_grid(gridded) -> None:
    found = picture(gridded, kind="slices", y="HookeJoint 1.angle")
    lines = [one for one in found.panel.items if isinstance(one, Line)]
    values = gridded.grid("growth_rate")[2]
    assert len(lines) == 6 and np.array_equal(lines[0].y, values[0]) and np.array_equal(lines[-1].y, values[8])
    assert lines[-1].name == "40°" and found.panel.key_title == "angle of HookeJoint 1"


def test_a_band_holds_what_was_sampled(sampled) -> None:
    """NumPy's quantiles of the rows, computed here."""
    found = picture(sampled)
    band, rows = item(found, Band), sampled.grid("growth_rate")
    assert rows.shape == (16, 33)
    assert np.allclose(band.low, np.sort(rows, axis=0)[0] * 0.25 + np.sort(rows, axis=0)[1] * 0.75, rtol=1e-12)
    lines = [one for one in picture(sampled, quantity="verdict").panel.items if isinstance(one, Line)]
    assert np.allclose(lines[0].y, 100 * (rows > 0).mean(axis=0))


def test_a_histogram_counts_every_point(gridded) -> None:
    bars = item(picture(gridded, kind="histogram"), Bars)
    assert bars.size.sum() == gridded.points == 3 * 9 * 33
    edge = bars.at[0] - bars.thick / 2 + 3 * bars.thick
    assert bars.size[:3].sum() == (gridded.quantity("growth_rate") < edge).sum()
    words = item(picture(gridded, kind="histogram", quantity="verdict"), Bars)
    assert sorted(words.size.tolist()) == sorted(np.unique(gridded.quantity("verdict"), return_counts=True)[1].tolist())


def test_parallel_coordinates_go_through_points(gridded) -> None:
    """Every line is a point of the study: its shares lead back to one."""
    found = picture(gridded, kind="parallel")
    lines = [one for one in found.panel.items if isinstance(one, Line) and one.name]
    drawn = np.concatenate([np.reshape(one.y, (-1, 5))[:, :4] for one in lines])
    assert len(drawn) == LINES
    columns = [gridded.parameter(path) for path in gridded.design.paths] + [gridded.quantity("growth_rate")]
    there = np.stack([(c - c.min()) / (c.max() - c.min()) for c in columns], axis=1)
    assert np.abs(drawn[:, None] - there[None]).max(axis=2).min(axis=1).max() < 1e-12
    assert drawn[:, 3].max() == 1.0 and drawn[:, 3].min() == 0.0, "the ends are among them"


def test_what_is_missing_and_what_failed(tmp_path: Path) -> None:
    """A store that grows, with a point that no line can have."""
    parameters = [{"path": "Disk 2.inertia", "values": [-1.0, 1.0, 2.0]}, grid(5, 4)[1]]
    store = tmp_path / "a.zarr"
    asked = stated(store, ["damping_ratio.max"], analysis="natural_frequencies", parameter=[parameters[0]])
    asked["parameter"].append({"path": "Shaft 1.stiffness", "low": 1.0, "high": 2.0, "points": 4})
    tn.study({**asked, "block": 2}, line=line(), workers=0, within=1e-9)
    opened = Store.open(store)
    run_blocks(str(store), opened.identity, 0, (0, 1, 2, 3))
    found = picture(tn.read_study(store), x="Shaft 1.stiffness")
    cells = {one.name: one.where.astype(int).tolist() for one in found.panel.items if isinstance(one, Cells)}
    assert cells["failed"] == [[1, 1, 1, 1], [0, 0, 0, 0], [0, 0, 0, 0]]
    assert cells["not computed yet"] == [[0, 0, 0, 0], [0, 0, 0, 0], [1, 1, 1, 1]]
    mesh = item(found, ColouredGrid)
    assert np.isfinite(mesh.values).tolist() == [[False] * 4, [True] * 4, [False] * 4]


def test_words_along_one_parameter(gridded) -> None:
    found = picture(gridded, kind="slices", quantity="verdict", y="HookeJoint 1.angle")
    points = [one for one in found.panel.items if isinstance(one, Points)]
    assert found.panel.y.names == ("stable", "unstable") and np.round(points[-1].y).max() <= 1


def test_shares_with_their_intervals() -> None:
    from trunnion.studies.sensitivities import SobolIndices

    one = SobolIndices(
        ("a.b", "c.d"), np.array([0.2, 0.7]), np.array([0.3, 0.8]), np.array([[0.1, 0.3], [0.6, 0.8]]),
        np.array([[0.2, 0.4], [0.7, 0.9]]), "growth_rate", 64, 0.95, 1.0,
    )  # fmt: skip
    found = shares(one)
    alone, left = (one for one in found.panel.items if isinstance(one, Bars))
    assert found.panel.y.names == ("c.d", "a.b")
    assert alone.size == pytest.approx([70, 20]) and left.size == pytest.approx([80, 30])
    ends = [tuple(one.x) for one in found.panel.items if isinstance(one, Line)]
    assert np.allclose(ends, [(60, 80), (10, 30), (70, 90), (20, 40)])


def test_pictures_are_drawn(gridded, tmp_path) -> None:
    for kind in ("chart", "slices", "histogram", "parallel"):
        axes = gridded.plot(kind=kind)
        save(axes.figure.figure, tmp_path / f"{kind}.png")
        assert (tmp_path / f"{kind}.png").stat().st_size > 5000


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"kind": "charts"}, "kind = 'charts': is not a picture of a study; did you mean \"chart\"?"),
        ({"quantity": "growth"}, "is not a quantity of the study"),
        ({"x": "speeds"}, "x = 'speeds': is not a parameter with a grid of this study; did you mean \"speed\"?"),
        ({"x": "speed", "y": "speed"}, "stands on both axes"),
        ({"at": {"sped": 1.0}}, "is not a parameter that stands still here"),
        ({"kind": "histogram", "x": "speed"}, "belongs to chart and slices, not to histogram"),
    ],
)
def test_refusals(gridded, options, message) -> None:
    with pytest.raises(tn.InputError, match=r".*") as told:
        draw(picture(gridded, **options))
    assert message in str(told.value)


@pytest.mark.parametrize("unit", ["Hz", "rad/s"])
def test_a_frequency_has_one_unit_in_print_and_picture(tmp_path: Path, unit: str) -> None:
    disks = [tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.8)]
    line = tn.Driveline(
        [tn.ConstantSpeed(), *disks], operation=tn.Operation(speed="1500 rpm") if unit == "Hz" else None
    )
    path = {"path": "Disk 1.inertia", "low": 0.5, "high": 1.0, "points": 5}
    asked = {"line": "", "analysis": "natural_frequencies", "quantities": "frequency[0]", "parameter": [path]}
    found = tn.study({**asked, "store": str(tmp_path / "a.zarr")}, line=line, workers=0)
    factor = 1 / (2 * np.pi) if unit == "Hz" else 1.0
    assert f"frequency[0]: {100 * factor:.4g} {unit} to" in str(found)
    assert found.plot().get_ylabel() == f"frequency[0] [{unit}]"

"""What a description holds, Matplotlib draws for files and Bokeh for the browser: the same numbers, names and ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("bokeh")

import trunnion as tn
from trunnion.pictures.draw_bokeh import Drawn, palette
from trunnion.pictures.draw_matplotlib import draw
from trunnion.pictures.looks import FAMILIES, LOOKS, PALETTES, WHITE, curve, look
from trunnion.pictures.modes import mode_shapes
from trunnion.pictures.picture import (
    Arrows,
    Axis,
    Band,
    Bars,
    ColouredGrid,
    Colours,
    Key,
    Level,
    Line,
    Panel,
    Picture,
    Points,
    Shapes,
    Spans,
    Texts,
    columns,
    points_at,
    rows,
    runs,
    single,
)
from trunnion.pictures.stability_chart import stability_chart
from trunnion.results.verdict import Verdict

X = np.linspace(1.0, 9.0, 9)
Y = np.array([3.0, 1.0, 4.0, np.nan, 5.0, 9.0, 2.0, 6.0, 5.0])
BOX = np.array([(2.0, 1.0), (4.0, 1.0), (4.0, 3.0)])


def drawn(panel: Panel) -> dict[str, dict[str, list[Any]]]:
    """Rows of every kind that Bokeh draws."""
    return {kind: dict(source.data) for kind, source in Drawn(panel).sources.items()}


def panel(*items: Any, x: Axis | None = None, y: Axis | None = None, **more: Any) -> Panel:
    return Panel(x or Axis("speed", "rpm"), y or Axis("torque", "N m"), items, **more)


def axes_of(one: Panel) -> Any:
    return draw(Picture((one,)))


def test_lines_and_marks_stand_where_they_are_told() -> None:
    one = panel(Line(X, Y, "curve 0", "a line"), Points(X[::2], Y[::2], "fold", "fold"))
    sources, axes = drawn(one), axes_of(one)
    np.testing.assert_array_equal(sources["lines"]["xs"][0], X)
    np.testing.assert_array_equal(sources["lines"]["ys"][0], Y)
    np.testing.assert_array_equal(axes.lines[0].get_xydata(), np.column_stack([X, Y]))
    np.testing.assert_array_equal(axes.lines[1].get_xydata(), np.column_stack([X[::2], Y[::2]]))
    assert list(zip(sources["marks"]["x"], sources["marks"]["y"], strict=True)) == list(
        zip(X[::2], Y[::2], strict=True)
    )
    assert axes.get_xlabel() == "speed [rpm]" and axes.get_ylabel() == "torque [N m]"
    made = Drawn(one).figure
    assert (made.xaxis[0].axis_label, made.yaxis[0].axis_label) == ("speed [rpm]", "torque [N m]")


def test_areas_strips_levels_and_bars() -> None:
    items = (
        Band(X, 0 * X, X, "margin", "band"), Shapes([BOX], "tongue", "region"),
        Spans([(2.0, 3.0)], "indication", "hatched"),
        Level(7.0, "zero", "level"), Bars([1.0, 2.0], [4.0, -5.0], 0.5, "bar 0", "bars"),
        Arrows(np.array([(1.0, 2.0)]), np.array([(3.0, 4.0)]), "jump", "jump"), Texts([2.0], [5.0], ["words"]),
    )  # fmt: skip
    sources = drawn(panel(*items))
    areas = sources["areas"]
    assert max(areas["ys"][0]) == 9.0 and min(areas["ys"][0]) == 0.0
    np.testing.assert_array_equal(np.column_stack([areas["xs"][1], areas["ys"][1]]), BOX)
    assert (sources["upright strips"]["low"], sources["upright strips"]["high"]) == ([2.0], [3.0])
    assert sources["upright strips"]["hatch"] == ["right_diagonal_line"]
    assert sources["level lines"]["at"] == [7.0]
    assert (sources["bars"]["bottom"], sources["bars"]["top"]) == ([0.0, -5.0], [4.0, 0.0])
    assert (sources["bars"]["left"], sources["bars"]["right"]) == ([0.75, 1.75], [1.25, 2.25])
    assert [sources["arrows"][key] for key in ("x0", "y0", "x1", "y1")] == [[1.0], [2.0], [3.0], [4.0]]
    assert [text for text in sources["words"]["text"] if text] == ["words"]
    axes = axes_of(panel(*items))
    heights = [bar.get_height() for bar in axes.patches if bar.get_width() == 0.5]
    assert heights == [4.0, -5.0] and "words" in [text.get_text() for text in axes.texts]


def test_both_legends_name_everything_once_in_order() -> None:
    one = panel(Line(X, Y, "curve 0", "first"), Key("stable", "an area", "area"), Line(X, X, "curve 1", "first"),
                Line(X, Y, "curve 2"), Points(X, Y, "fold", "second"))  # fmt: skip
    legend = Drawn(one).legend
    names = [text.get_text() for text in axes_of(one).get_legend().get_texts()]
    assert names == [item.label["value"] for item in legend.items] == ["first", "an area", "second"]
    assert not Drawn(replace(one, key="")).legend.items and axes_of(replace(one, key="")).get_legend() is None


@pytest.mark.parametrize("scale", ["linear", "log", "symlog"])
def test_ends_of_axes_are_alike(scale: str) -> None:
    """Stated ones, and those that follow from what is shown."""
    one = panel(Line(X, np.nan_to_num(Y, nan=2.0), "line"), x=Axis("a", "", 0.5, 20.0, scale, (1.0, 10.0)), y=Axis("b"))
    axes, made = axes_of(one), Drawn(one).figure
    low, high = made.x_range.start, made.x_range.end
    assert (low, high) == pytest.approx(tuple(one.x.scaled([0.5, 20.0])) if scale == "symlog" else (0.5, 20.0))
    assert axes.get_xlim() == (0.5, 20.0)
    assert (made.y_range.start, made.y_range.end) == pytest.approx(axes.get_ylim())


def test_even_up_to_a_hundred_and_logarithmic_beyond_is_spaced_as_in_files() -> None:
    values = np.array([-1e4, -300.0, -100.0, -20.0, 0.0, 50.0, 100.0, 2e3])
    axis = Axis("margin", "", -2e4, 3e3, "symlog", (-100.0, 0.0, 100.0))
    axes = axes_of(panel(Line(values, 0 * values, "line"), x=axis))
    pixels = axes.transData.transform(np.column_stack([values, 0 * values]))[:, 0]
    spaced = np.asarray(drawn(panel(Line(values, 0 * values, "line"), x=axis))["lines"]["xs"][0])
    share = (spaced - axis.scaled(-2e4)) / (axis.scaled(3e3) - axis.scaled(-2e4))
    frame = axes.get_window_extent()
    np.testing.assert_allclose(share, (pixels - frame.x0) / frame.width, atol=2e-3)


def test_names_in_rows_stand_at_their_rows_from_the_top() -> None:
    one = panel(Bars(range(3), [1.0, 2.0, 3.0], 0.6, "bar", lie=True), y=rows(["a", "b", "c"]))
    axes, made = axes_of(one), Drawn(one).figure
    assert [text.get_text() for text in axes.get_yticklabels()] == ["a", "b", "c"]
    assert made.yaxis[0].major_label_overrides == {0.0: "a", 1.0: "b", 2.0: "c"}
    assert made.y_range.start == axes.get_ylim()[0] > made.y_range.end == axes.get_ylim()[1]


def test_colours_of_a_mesh_are_those_of_the_file() -> None:
    values = np.add.outer(np.arange(4.0), np.arange(5.0)) - 2
    colours = Colours("exponent", "signed", -2.0, 5.0, "zero")
    one = panel(ColouredGrid(np.arange(5.0), np.arange(4.0), values, colours))
    image = drawn(one)["mesh"]
    np.testing.assert_array_equal(image["image"][0], values.astype(np.float32))
    assert (image["x"], image["y"], image["dw"], image["dh"]) == ([-0.5], [-0.5], [5.0], [4.0])
    shades = palette(colours)
    zero = shades[round(len(shades) * 2 / 7)]
    ends = [[int(one[k : k + 2], 16) for k in (1, 3, 5)] for one in (shades[0], PALETTES["signed"][0])]
    np.testing.assert_allclose(*ends, atol=4)
    assert all(int(zero[k : k + 2], 16) > 235 for k in (1, 3, 5)), "white in the middle, which is 0"
    (mesh,) = axes_of(one).collections
    np.testing.assert_array_equal(np.ma.filled(mesh.get_array(), np.nan).ravel(), values.ravel())


def test_points_that_are_not_evenly_apart_keep_their_places() -> None:
    x = np.array([1.0, 2.0, 4.0, 8.0])
    one = panel(ColouredGrid(x, np.arange(2.0), np.array([x, x]), Colours("", "amplitude", 1.0, 8.0)))
    image = drawn(one)["mesh"]
    across = image["x"][0] + (np.arange(image["image"][0].shape[1]) + 0.5) * image["dw"][0] / image["image"][0].shape[1]
    nearest = x[np.abs(across[:, None] - x).argmin(axis=1)]
    assert np.mean(image["image"][0][0] == nearest) > 0.99


def test_what_could_not_be_computed_is_hatched_and_never_looks_stable() -> None:
    line = tn.catalogue("two-shaft-cardan")
    chart = tn.stability_chart(line, ("speed", 1.3, 1.6, 6), ("HookeJoint 1.angle", 0.0, 0.5, 5))
    verdict = chart.verdict.copy()
    verdict[1, 2:4], verdict[3, 0] = Verdict.FAILED, Verdict.UNDECIDED
    one = stability_chart(replace(chart, verdict=verdict)).panel
    bars = drawn(one)["bars"]
    assert len(bars["left"]) == 2 and all(pattern.strip() for pattern in bars["hatch"])
    assert set(bars["says"]) == {"not computed", "undecided (boundary)"}
    failed = bars["says"].index("not computed")
    step = (1.6 - 1.3) / 5
    assert (bars["left"][failed], bars["right"][failed]) == pytest.approx((1.3 + 1.5 * step, 1.3 + 3.5 * step))


def test_a_figure_takes_other_panels_of_its_kind_and_leaves_what_is_alike() -> None:
    made = Drawn(panel(Line(X, Y, "line", "name"), Level(2.0, "zero")))
    before = made.sources["level lines"].data
    made.show(panel(Line(X, X, "line", "other"), Level(2.0, "zero")), 300)
    assert made.sources["level lines"].data is before
    np.testing.assert_array_equal(made.sources["lines"].data["ys"][0], X)
    assert made.names == ["other"]
    entry = made.legend.items[0]
    made.show(panel(Level(1.0, "zero", "a level"), Line(X, X, "line", "a line"), key=""), 300)
    assert made.names == [] and not made.legend.visible
    made.show(panel(Points(X, X, "start", "a mark"), Line(X, X, "line", "a line")), 300)
    assert made.names == ["a mark", "a line"] and made.legend.items[0] is entry  # no model comes or goes needlessly
    assert entry.renderers == [made.key_glyphs["mark"]]
    logarithmic = panel(x=Axis(scale="log"))
    assert Drawn.kind_of(logarithmic, 320) != Drawn.kind_of(panel(), 320) == made.kind


def test_rows_of_legends_and_texts_never_become_fewer() -> None:
    """The page may draw a legend, and measures texts, by the number of rows that there were before a change."""
    made, before = Drawn(panel()), {"keys": 0, "words": 0}
    for count in (0, 40, 1, 0):
        shown = [
            item for k in range(count) for item in (Line(X, Y, "line", f"name {k}"), Texts([1.0], [2.0], [f"{k}"]))
        ]
        made.show(panel(*shown), 300)
        assert [item.index for item in made.legend.items if item.visible] == list(range(count))
        for kind in before:
            now = len(made.sources[kind].data["x"])
            assert now >= max(before[kind], count)
            before[kind] = now
        assert [text for text in made.sources["words"].data["text"] if text] == [f"{k}" for k in range(count)]


def test_a_low_picture_has_no_buttons() -> None:
    """And one that becomes higher is another figure: a page cannot put buttons beside one that had none."""
    low, high = (Drawn(panel(Line(X, Y, "line")), height) for height in (150, 320))
    assert (low.figure.toolbar_location, high.figure.toolbar_location) == (None, "right")
    assert low.kind != high.kind
    assert Drawn.kind_of(panel(), 300) == high.kind


def test_a_zoom_stays_while_the_ends_are_the_same() -> None:
    one = panel(Line(X, Y, "line"), x=Axis("a", "", 0.0, 10.0))
    made = Drawn(one)
    made.figure.x_range.update(start=2.0, end=3.0)
    made.show(one.with_items(Level(2.5, "cursor", on="x")), 300)
    assert (made.figure.x_range.start, made.figure.x_range.end) == (2.0, 3.0)
    made.show(replace(one, x=Axis("a", "", 0.0, 20.0)), 300)
    assert (made.figure.x_range.start, made.figure.x_range.end) == (0.0, 20.0)


def test_stretches_reach_to_the_middle_between_points() -> None:
    found = runs(np.array([1.0, 2.0, 3.0, 5.0]), np.array([True, False, True, True]))
    np.testing.assert_array_equal(found, [(0.5, 1.5), (2.5, 6.0)])


def test_columns_of_a_legend_fit_as_it_is_filled() -> None:
    """Four names of which two are long stand in two columns, not in three."""
    names = ["stable", "unstable", "largest stable value at 25 speeds", "ends of what is stable at every speed"]
    assert columns(names, 83.0, 8.6) == 2
    assert columns(names, 200.0, 8.6) == 4 and columns(names, 10.0, 8.6) == 1


def test_every_look_can_be_drawn_by_both() -> None:
    roles = [*LOOKS, *(f"{family} {k}" for family in FAMILIES for k in range(3))]
    for items in (
        [Line(X, Y, role) for role in roles],
        [Points(X, Y, role) for role in roles if look(role).marker],
        [Spans([(1.0, 2.0)], role) for role in roles],
    ):
        made, axes = drawn(panel(*items)), axes_of(panel(*items))
        assert sum(len(source[next(iter(source))]) for kind, source in made.items() if kind != "keys") >= len(items)
        assert len(axes.lines) + len(axes.patches) >= len(items)
    assert WHITE == look("stable").inside


def test_panels_of_a_picture_are_drawn_in_order() -> None:
    modes = tn.natural_frequencies(tn.catalogue("two-shaft-cardan"))
    picture = mode_shapes(modes)
    axes = draw(picture).figure.axes
    for k, (one, shown) in enumerate(zip(picture.panels, axes, strict=True)):
        shape = next(item for item in one.items if isinstance(item, Line) and item.role == "shape")
        np.testing.assert_array_equal(shape.x, modes.shape[:, k])
        assert any(np.array_equal(line.get_xdata(), shape.x) for line in shown.lines)
        assert any(np.array_equal(xs, shape.x) for xs in drawn(one)["lines"]["xs"])


def test_a_picture_into_axes_of_ones_own() -> None:
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    shown = draw(single(Axis("a"), Axis("b"), [points_at([(1.0, 2.0)], "point")]), axes)
    assert shown is axes and axes.lines[0].get_xydata().tolist() == [[1.0, 2.0]]


def test_a_legend_shows_lines_with_marks_as_they_are_drawn() -> None:
    """Without colour a mark alone is one of many."""
    marked = [role for k in range(40) if look(role := curve(k)).marker and not look(role).every]
    assert len(marked) > 3
    axes = draw(single(Axis("speed"), Axis("torque"), [Line(X, Y, role, role) for role in marked[:4]]))
    curves = {line.get_label(): line for line in axes.get_lines()}
    legend = axes.get_legend()
    assert legend is not None
    for handle, text in zip(legend.get_lines(), legend.get_texts(), strict=True):
        own = curves[text.get_text()]
        assert handle.get_linestyle() == own.get_linestyle() and handle.get_marker() == own.get_marker()


def test_curves_of_one_point_are_told_apart_by_shapes_in_the_legend_too() -> None:
    roles = ["sum", *(curve(k) for k in range(5)), "limit 0"]
    items = [Line([3.0], [float(k + 1)], role, role) for k, role in enumerate(roles)]
    one = panel(*items)
    rows_of = drawn(one)
    shapes = list(rows_of["marks"]["marker"])
    assert len(set(shapes)) == len(roles) and shapes[-1] == "dash" and not len(rows_of["lines"]["xs"])
    assert list(rows_of["keys"]["marker"])[: len(roles)] == shapes
    assert all(kind == "lone mark" for _, _, kind in Drawn(one).entries)
    axes = draw(Picture((one,)))
    points = {line.get_label(): line.get_marker() for line in axes.get_lines()}
    legend = axes.get_legend()
    assert legend is not None and len(set(points.values())) == len(roles)
    for handle, text in zip(legend.get_lines(), legend.get_texts(), strict=True):
        assert handle.get_marker() == points[text.get_text()] and handle.get_linestyle() == "None"

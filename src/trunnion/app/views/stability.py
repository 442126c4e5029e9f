"""Stability over two parameters; a click shows the multipliers there, the growing mode, and the motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import panel as pn
from bokeh.events import RangesUpdate, Tap
from bokeh.models import BoxAnnotation, ColorBar, ColumnDataSource, CustomJSTickFormatter, HoverTool, LinearColorMapper

from trunnion.app import figures
from trunnion.app.axis import Axis
from trunnion.app.calls import LINE, Call
from trunnion.app.curves import Curves
from trunnion.app.point import Point
from trunnion.app.variants import kind_of, parameters, shown_unit, with_number
from trunnion.app.views.base import (
    MOST_POINTS,
    Side,
    Step,
    View,
    bounded,
    count,
    number,
    optional,
    select,
    speed_range,
    tell_default,
    unit_of,
)
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import SPEED, pack
from trunnion.driveline.quantities import DEGREE
from trunnion.errors import InputError
from trunnion.reporting.ranges import angle_range

COARSE = (16, 12)
TURNS = 30
"""Of the motion after a disturbance."""
DISTURBANCE = 1e-3
"""Its largest rotation at the start [rad], in the mode that grows fastest."""
REST = 0.3
"""Seconds that the line must stay before its regions are searched for."""
MOST_NAMED = 6
"""Regions of instability that the page lists, those that grow fastest."""
UNDISTURBED, DISTURBED = "undisturbed", "motion"
GROWTH = 0.05
"""Growth per turn at the ends of the colours."""
_STABLE = ("#5b9bc8", "#86b5d6", "#b0cfe4", "#d8e8f2", "#f4f8fb")
_UNSTABLE = ("#f6c49a", "#e8935a", "#d55e00", "#9c4300", "#5c2700")


class StabilityView(View):
    """The chart and one point of it."""

    name = "stability"
    title = "Stability"
    about = (
        "Where a small disturbance grows, over any two parameters. Click a point, or type it, for its multipliers, the "
        "growing mode and what becomes of a small disturbance. Zooming in shows more points of the same chart."
    )
    defaults = {
        "x": SPEED, "x_low": None, "x_high": None, "y": "", "y_low": None, "y_high": None, "across": 60, "up": 60,
        "at_x": 0.0, "at_y": 0.0, "look": False,
    }  # fmt: skip

    def make_controls(self) -> Any:
        """Axes, ends (by themselves where empty), points, the point looked at."""
        fields = {key: self.bind(key, optional(label, width=125)) for key, label in _ENDS.items()}
        self.at = {key: self.bind(key, number(label, 0.0, width=150)) for key, label in _AT.items()}
        for widget in self.at.values():
            widget.param.watch(lambda event: self.settings.update(look=True) if not self._quiet else None, "value")
        across = self.bind("across", count("Points across", 60, 2, MOST_POINTS))
        up = self.bind("up", count("Points up", 60, 2, MOST_POINTS))
        x, y = (select(f"Along {k}", options=[], width=200) for k in "xy")
        for key, widget in (("x", x), ("y", y)):
            widget.param.watch(lambda event, key=key: self._other_axis(key, event.new), "value")
            self.bind(key, widget)
        rows = [
            pn.FlexBox(x, fields["x_low"], fields["x_high"], across),
            pn.FlexBox(y, fields["y_low"], fields["y_high"], up),
            pn.FlexBox(*self.at.values()),
        ]
        return pn.Column(*rows, sizing_mode="stretch_width", margin=0)

    def _other_axis(self, key: str, path: str | None) -> None:
        """Ends and point belong to the old axes."""
        if not self._quiet and path:
            self.settings.update({key: path, "look": False, f"{key}_low": None, f"{key}_high": None})
            self.adapt(self.session.document.line)

    def adapt(self, line: Driveline) -> None:
        """Parameters of the line."""
        paths = [SPEED, *parameters(line)]
        if self.settings["y"] not in paths:
            self.settings["y"] = next((p for p in paths if p.endswith(".angle")), paths[1] if len(paths) > 1 else "")
        self.choose("x", paths)
        self.choose("y", paths[1:])
        for key, end in (("x", "at_x"), ("y", "at_y")):
            axis = self.axis(line, key)
            self.at[end].label = f"Look at {axis.label}"
            low, high = self._own_ends(line, axis)
            for side, value in (("low", low), ("high", high)):
                widget = self.widgets[f"{key}_{side}"]
                widget.label = f"{_ENDS[f'{key}_{side}']} [{axis.unit}]"
                tell_default(widget, value / axis.size)
            if not self.settings["look"]:
                self.settings[end] = float(f"{_now(line, axis) / axis.size:.6g}")
        self.fill()

    def axis(self, line: Driveline, key: str) -> Axis:
        """The axis with the ends as typed, or by themselves about the value of the line."""
        path = str(self.settings[key])
        if path == SPEED:
            unit, factor = unit_of(line)
            size = 1 / factor
        elif path.endswith(".angle"):
            unit, size = "deg", DEGREE
        else:
            unit, size = shown_unit(kind_of(line, path), pack(line).value(path))
        axis = Axis(path, 0.0, 0.0, unit, size)
        low, high = self._own_ends(line, axis)
        first, last = self.typed(f"{key}_low"), self.typed(f"{key}_high")
        return replace(axis, low=low if first is None else first * size, high=high if last is None else last * size)

    def _own_ends(self, line: Driveline, axis: Axis) -> tuple[float, float]:
        """Ends of an axis where none are typed, in SI."""
        if axis.path == SPEED:
            return speed_range(line)
        if axis.path.endswith(".angle"):
            return angle_range(line)
        now = pack(line).value(axis.path)
        first, last = (now / 4, now * 4) if now else (0.0, axis.size)
        return min(first, last), max(first, last)

    def axes(self, line: Driveline) -> tuple[Axis, Axis]:
        """Both."""
        if self.settings["x"] == self.settings["y"]:
            remedy = "choose another along y"
            raise InputError("stands on both axes", key=str(self.settings["x"]), remedy=remedy)
        x, y = self.axis(line, "x"), self.axis(line, "y")
        for axis in (x, y):
            if not axis.low < axis.high:
                problem = f"runs from {axis.low / axis.size:g} to {axis.high / axis.size:g} {axis.unit}"
                remedy = "type two ends that rise, or leave the fields empty"
                raise InputError(problem, key=axis.path, remedy=remedy)
        return x, y

    def point(self, line: Driveline) -> tuple[float, float]:
        """The point looked at, in SI: as set, or the operating point."""
        x, y = self.axes(line)
        if self.settings["look"]:
            return self.value("at_x") * x.size, self.value("at_y") * y.size
        return tuple(_now(line, axis) for axis in (x, y))  # type: ignore[return-value]

    def steps(self, line: Driveline) -> list[Step]:
        """A coarse chart, the point, the full chart, the motion, the names of what opens, the regions themselves.

        The regions are searched for beside the chart, since they may be narrower than its points lie apart."""
        x, y = self.axes(line)
        fixed = {} if SPEED in (x.path, y.path) else {"speed": _speed(line)}
        across, up = (bounded(self.settings[key], 2) for key in ("across", "up"))
        steps = []
        if across > COARSE[0] and up > COARSE[1]:
            coarse = Call("tn.stability_chart", (LINE, x.request(COARSE[0]), y.request(COARSE[1])), fixed)
            steps.append(Step("coarse", coarse, "chart", picture="", files=(), soft=True, preview_of="chart"))
        chart = Call("tn.stability_chart", (LINE, x.request(across), y.request(up)), fixed)
        unit = {"unit": unit_of(line)[0]}
        full = Step("chart", chart, "chart", drawing=unit, title="stability chart", soft=True, lasting=True)
        names = Step("names", Call("tn.resonance_speeds", (LINE,)), "resonances", picture="", files=("csv",),
                     title="resonance speeds", lasting=True)  # fmt: skip
        point, *motions = self._at(line, x, y)
        ranges = (axis.request(0)[:3] for axis in (x, y))
        regions = Step("tongues", Call("tn.tongues", (LINE, *ranges), fixed), "tongues", drawing=unit, files=("nc",),
                       title="regions of instability", soft=True, lasting=True, rest=REST)  # fmt: skip
        return [*steps, point, full, *motions, *([names] if x.path == SPEED else []), regions]

    def _at(self, line: Driveline, x: Axis, y: Axis) -> tuple[Step, ...]:
        """Multipliers at the point looked at, and the motion there without a disturbance and with one."""
        at = dict(zip((x.path, y.path), self.point(line), strict=True))
        speed = at.pop(SPEED, None) or _speed(line)
        there = line
        for path, value in at.items():
            there = with_number(there, path, value)
        multipliers = Call("tn.stability", (LINE,), {"speed": speed})
        run, brief = ({"turns": turns, "speed": speed} for turns in (float(TURNS), 1.0))
        begin = Call("at", (0.0,), of=Call("tn.simulate", (LINE,), brief))
        start = Call("np.add", (begin, Call("disturbance", (DISTURBANCE,), of=multipliers)))
        shown = {"speed": speed}
        return (
            Step(
                "point", multipliers, "point", picture="", files=("nc",), title="multipliers at the point", line=there
            ),
            Step(
                UNDISTURBED, Call("tn.simulate", (LINE,), run), "motion", shown,
                title="motion from untwisted shafts", files=("nc",), line=there, soft=True,
            ),
            Step(
                DISTURBED, Call("tn.simulate", (LINE,), {**run, "start": start}), "motion", shown,
                title="the same with a small disturbance", files=("nc",), line=there, soft=True,
            ),
        )  # fmt: skip

    def side(self) -> Any:
        """Chart, multipliers, mode, motion."""
        return _Side(self)

    def clicked(self, x: float, y: float) -> None:
        """A point was chosen in the chart, in the units shown."""
        self.settings.update(at_x=float(f"{x:.6g}"), at_y=float(f"{y:.6g}"), look=True)
        self.fill()
        self.session.setting_chosen()


_ABOUT_MOTION = (
    f"<p style='font-size:13px;margin:0'>The motion with a disturbance of {DISTURBANCE:g} rad in the mode that grows "
    "fastest, less the motion without it: the forced vibration, which both have, is taken away.</p>"
)
_ENDS = {"x_low": "x from", "x_high": "x to", "y_low": "y from", "y_high": "y to"}
_AT = {"at_x": "Look at x", "at_y": "Look at y"}


def _speed(line: Driveline) -> float:
    if line.operation and line.operation.speed:
        return line.operation.speed
    low, high = speed_range(line)
    return (low + high) / 2


def _now(line: Driveline, axis: Axis) -> float:
    value = _speed(line) if axis.path == SPEED else pack(line).value(axis.path)
    return min(max(value, axis.low), axis.high)


class _Side(Side):
    def __init__(self, view: StabilityView) -> None:
        self.view = view
        self.figure = figures.plot("", "", height=430, title="stability chart", x_range=(0, 1), y_range=(0, 1))
        self.figure.grid.visible = False
        self.image = ColumnDataSource(data={"image": [], "x": [], "y": [], "dw": [], "dh": []})
        palette = [*_STABLE, *_UNSTABLE]
        mapper = LinearColorMapper(palette=palette, low=-GROWTH, high=GROWTH, nan_color="#9a9a9a")
        drawn = self.figure.image("image", "x", "y", "dw", "dh", source=self.image, color_mapper=mapper)
        bar = ColorBar(color_mapper=mapper, title="growth per turn [%]", width=14, padding=4)
        bar.formatter = CustomJSTickFormatter(code="return (100 * tick).toFixed(0)")
        self.figure.add_layout(bar, "right")
        self.figure.add_tools(HoverTool(renderers=[drawn], tooltips=[("growth per turn", "@image{0.000 %}")]))
        self.box = BoxAnnotation(line_color=figures.BLUE, line_width=2, fill_alpha=0.0)
        self.figure.add_layout(self.box)
        self.names = ColumnDataSource(data={"x0": [], "y0": [], "x1": [], "y1": [], "name": []})
        lines = self.figure.segment("x0", "y0", "x1", "y1", source=self.names, color=figures.INK, line_dash="dotted")
        figures.hover(self.figure, [lines], [("", "@name")], line_policy="interp")
        self.outlines = ColumnDataSource(data={"xs": [], "ys": [], "name": []})
        edges = self.figure.multi_line("xs", "ys", source=self.outlines, color=figures.INK, line_width=2)
        figures.hover(self.figure, [edges], [("region of instability", "@name")], line_policy="interp")
        self.here = ColumnDataSource(data={"x": [], "y": []})
        self.figure.scatter("x", "y", source=self.here, marker="x", size=14, line_width=3, color=figures.INK)
        self.figure.on_event(Tap, lambda event: view.clicked(float(event.x), float(event.y)))
        self.figure.on_event(RangesUpdate, self._zoomed)
        self.point = Point()
        self.motion = Curves("turns of the input", "change of the twist [deg]", height=290)
        self.undisturbed: Any = None
        self.said = pn.pane.HTML("", sizing_mode="stretch_width")
        self.regions = pn.pane.HTML("", sizing_mode="stretch_width")
        self.about = pn.pane.HTML(_ABOUT_MOTION, sizing_mode="stretch_width")
        self.extent: tuple[Axis, Axis] | None = None
        self.whole: Any = None
        self.ends: list[tuple[float, float]] = []
        self.count = 0
        self.picture = pn.pane.Bokeh(self.figure, sizing_mode="stretch_width")
        # Before its axes are known a chart would show false ones, and take a click on them for a point.
        self.picture.visible = self.figure.visible = False
        self.panel = pn.Column(
            self.picture,
            self.regions,
            self.said,
            self.point.panel,
            self.motion.panel,
            self.about,
            sizing_mode="stretch_width",
            margin=0,
        )

    def narrow(self, narrow: bool) -> None:
        """Beside its colours half of the page holds three numbers."""
        super().narrow(narrow)
        self.figure.xaxis[0].ticker.desired_num_ticks = 3 if narrow else 6

    def show(self, name: str, data: Any) -> None:
        """What a step gave."""
        if name in ("coarse", "chart"):
            self._chart(name, data)
        elif name == "point":
            self.point.set(data, unit_of(self.view.line_of(self)))
        elif name == "tongues":
            self._regions(data)
        elif name == UNDISTURBED:
            self.undisturbed = data
        elif name == DISTURBED:
            self._disturbed(data)
        else:
            self._named(data)

    def refused(self, name: str, sentence: str) -> None:
        """A line that has no chart may have multipliers and a motion at each point."""
        if name in (UNDISTURBED, DISTURBED):
            self.undisturbed = None
            self.motion.set([], title=f"no motion: {sentence}")
            return
        if name == "tongues":
            self._say_regions(f"Regions narrower than the points lie apart could not be searched for: {sentence}")
            return
        self.whole, self.ends = None, []
        self.picture.visible = self.figure.visible = False
        self.said.object = f"<div style='font-size:13px' class='refusal'>no chart: {figures.text(sentence)}</div>"

    def _chart(self, name: str, data: Any) -> None:
        line = self.view.line_of(self)
        x, y = self.view.axes(line)
        self.picture.visible = self.figure.visible = True
        fresh = data is not self.whole  # else only the point has moved, and the picture may be zoomed
        if fresh:
            self._image(data, x, y)
            figures.put(self.outlines, {"xs": [], "ys": [], "name": []})
            self._say_regions("Regions narrower than the points lie apart are being searched for …")
        if self.extent != (x, y):
            self.extent, self.ends = (x, y), []
            self.figure.x_range.update(start=x.low / x.size, end=x.high / x.size)
            self.figure.y_range.update(start=y.low / y.size, end=y.high / y.size)
            self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = x.label, y.label
        at = self.view.point(line)
        figures.put(self.here, {"x": [at[0] / x.size], "y": [at[1] / y.size]})
        self._operating(line, x, y)
        if not fresh:
            return
        self.whole = data if name == "chart" else None
        if name == "chart":
            self.chart_call = next(s for s in self.view.steps(line) if s.name == "chart")
            if self.ends:
                self.view.session.beside(self._refine(self.ends))
        text = "coarse, the full chart follows" if name == "coarse" else data["text"].replace("\n", "<br>")
        self.count += 1
        self.said.object = f"<div style='font-size:13px' data-chart='{name}' data-count='{self.count}'>{text}</div>"

    def _disturbed(self, data: Any) -> None:
        """What a disturbance becomes: the motion with it less the one without, which holds the forced vibration."""
        if self.undisturbed is None:
            return
        pairs = zip(data["names"], data["twist"], self.undisturbed["twist"], strict=True)
        curves = [(n, data["turns"], np.rad2deg(with_it - without)) for n, with_it, without in pairs]
        self.motion.set(curves, title=f"after a disturbance of {DISTURBANCE:g} rad")

    def _regions(self, data: Any) -> None:
        """Outlines over the chart, however narrow."""
        x, y = self.view.axes(self.view.line_of(self))
        rows = [(name, xs / x.size, ys / y.size) for name, xs, ys in data["regions"]]
        figures.put(
            self.outlines, {"xs": [r[1] for r in rows], "ys": [r[2] for r in rows], "name": [r[0] for r in rows]}
        )
        parts = [
            f"{name} from {ys.min():.4g} {y.unit} on, at {xs[ys.argmin()]:.5g} {x.unit}"
            for name, xs, ys in rows[:MOST_NAMED]
        ]
        parts += [f"and {len(rows) - MOST_NAMED} more"] if len(rows) > MOST_NAMED else []
        count = {0: "No region", 1: "One region"}.get(len(rows), f"{len(rows)} regions")
        self._say_regions(f"{count} of instability found{': ' if rows else ''}{'; '.join(parts)}.\n{data['search']}")

    def _say_regions(self, text: str) -> None:
        self.regions.object = f"<div style='font-size:13px;white-space:pre-line'>{figures.text(text)}</div>"

    def _image(self, data: Any, x: Axis, y: Axis) -> None:
        step_x, step_y = (float(data[k][1] - data[k][0]) for k in ("x", "y"))
        figures.put(
            self.image,
            {
                "image": [data["growth"].astype(np.float32)],
                "x": [(data["x"][0] - step_x / 2) / x.size],
                "y": [(data["y"][0] - step_y / 2) / y.size],
                "dw": [(data["x"][-1] - data["x"][0] + step_x) / x.size],
                "dh": [(data["y"][-1] - data["y"][0] + step_y) / y.size],
            },
        )

    def _operating(self, line: Driveline, x: Axis, y: Axis) -> None:
        ends: dict[str, float | None] = {"left": None, "right": None, "bottom": None, "top": None}
        operation = line.operation
        for axis, low, high in ((x, "left", "right"), (y, "bottom", "top")):
            span = operation and {SPEED: operation.speed_range}.get(axis.path)
            if operation and axis.path.endswith(".angle"):
                span = operation.angle_range
            if span:
                ends[low], ends[high] = span[0] / axis.size, span[1] / axis.size
        self.box.update(**ends, visible=any(v is not None for v in ends.values()))

    def _named(self, data: Any) -> None:
        x, y = self.view.axes(self.view.line_of(self))
        inside = [(s, n) for s, n in zip(data["speed"], data["name"], strict=True) if x.low <= s <= x.high]
        figures.put(
            self.names,
            {
                "x0": [s / x.size for s, _ in inside],
                "x1": [s / x.size for s, _ in inside],
                "y0": [y.low / y.size] * len(inside),
                "y1": [y.high / y.size] * len(inside),
                "name": [n for _, n in inside],
            },
        )

    def _zoomed(self, event: Any) -> None:
        """More points of the same chart where the picture shows a part of it."""
        if self.extent is None or self.whole is None:
            return
        ends = []
        for axis, low, high in ((self.extent[0], event.x0, event.x1), (self.extent[1], event.y0, event.y1)):
            a, b = max(low * axis.size, axis.low), min(high * axis.size, axis.high)
            if not a < b:
                return
            ends.append((a, b))
        if ends == [(axis.low, axis.high) for axis in self.extent]:
            self.ends = []
            self._image(self.whole, *self.extent)
            return
        self.ends = ends
        self.view.session.beside(self._refine(ends))

    async def _refine(self, ends: list[tuple[float, float]]) -> None:
        across, up = (bounded(self.view.settings[key], 2) for key in ("across", "up"))
        zoom = ((*ends[0], across), (*ends[1], up))
        whole, extent = self.whole, self.extent
        data = await self.view.session.ask(self.chart_call.call, "chart", self.variant, zoom=zoom)

        def draw() -> None:
            if extent is not None and self.whole is whole:
                self._image(data, *extent)

        self.view.session.locked(draw)

"""Stability over two parameters; a click shows the multipliers there, the growing mode, and the motion."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import panel as pn
from bokeh.events import RangesUpdate, Tap
from bokeh.models import BoxAnnotation, ColorBar, LinearColorMapper

from trunnion.app.parts import figures
from trunnion.app.parts.axis import Axis
from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.curves import Curve, Curves
from trunnion.app.parts.pieces import column, lines, pane, small
from trunnion.app.parts.point import Point
from trunnion.app.parts.variants import parameters, shown_unit, with_number
from trunnion.app.views.base import (
    MOST_POINTS,
    Setting,
    Side,
    Step,
    View,
    at_speed,
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
PERCENT = 100.0
LEAST_GROWTH, USUAL = 1e-4, 90
"""Growth per turn at the ends of the colours at least, and the share [%] of a chart's points that lie between them."""
_STABLE = ("#5b9bc8", "#86b5d6", "#b0cfe4", "#d8e8f2", "#f4f8fb")
_UNSTABLE = ("#f6c49a", "#e8935a", "#d55e00", "#9c4300", "#5c2700")


_ABOUT_MOTION = (
    f"The motion with a disturbance of {DISTURBANCE:g} rad in the mode that grows fastest, less the motion without it: "
    "the forced vibration, which both have, is taken away."
)
_ENDS = {"x_low": "x from", "x_high": "x to", "y_low": "y from", "y_high": "y to"}
_AT = {"at_x": "Look at x", "at_y": "Look at y"}


def _now(line: Driveline, axis: Axis) -> float:
    value = at_speed(line, None) if axis.path == SPEED else pack(line).value(axis.path)
    return min(max(value, axis.low), axis.high)


def end_of_colours(growth: Any) -> float:
    """Growth per turn, round, at the dark end of the colours: most points of the chart are not darker. Zero is in the
    middle, so that what grows is never of a colour of what dies out."""
    sizes = np.abs(growth[np.isfinite(growth)])
    most = max(LEAST_GROWTH, float(np.percentile(sizes, USUAL)) if sizes.size else 0.0)
    ten = 10.0 ** np.floor(np.log10(most))
    return float(next(ten * step for step in (1, 2, 5, 10) if ten * step >= most * (1 - 1e-9)))


class _Side(Side["StabilityView"]):
    """Chart, multipliers, mode, motion."""

    def make(self) -> None:
        """Panes and figures, made once."""
        self.figure = figures.plot("", "", height=430, title="stability chart", x_range=(0, 1), y_range=(0, 1))
        self.figure.grid.visible = False
        self.image = figures.source(image=[], x=[], y=[], dw=[], dh=[])
        self.colours = LinearColorMapper(palette=[*_STABLE, *_UNSTABLE], low=-1, high=1, nan_color="#9a9a9a")
        drawn = self.figure.image("image", "x", "y", "dw", "dh", source=self.image, color_mapper=self.colours)
        bar = ColorBar(color_mapper=self.colours, title="growth per turn [%]", width=14, padding=4)
        self.figure.add_layout(bar, "right")
        figures.hover(self.figure, [drawn], [("growth per turn", "@image{0.000} %")])
        self.box = BoxAnnotation(line_color=figures.BLUE, line_width=2, fill_alpha=0.0)
        self.figure.add_layout(self.box)
        self.names = figures.source(x0=[], y0=[], x1=[], y1=[], name=[])
        lines = self.figure.segment("x0", "y0", "x1", "y1", source=self.names, color=figures.INK, line_dash="dotted")
        figures.hover(self.figure, [lines], [("", "@name")], line_policy="interp")
        self.outlines = figures.source(xs=[], ys=[], name=[])
        edges = self.figure.multi_line("xs", "ys", source=self.outlines, color=figures.INK, line_width=2)
        figures.hover(self.figure, [edges], [("region of instability", "@name")], line_policy="interp")
        self.here = figures.source(x=[], y=[])
        self.figure.scatter("x", "y", source=self.here, marker="x", size=14, line_width=3, color=figures.INK)
        self.figure.on_event(Tap, lambda event: self.view.clicked(float(event.x), float(event.y)))
        self.figure.on_event(RangesUpdate, self._zoomed)
        self.point = Point()
        self.motion = Curves("turns of the input", "change of the twist [deg]", height=290)
        self.undisturbed: Any = None
        self.said, self.regions = pane(), pane()
        self.extent: tuple[Axis, Axis] | None = None
        self.whole: Any = None
        self.ends: list[tuple[float, float]] = []
        self.count = 0
        self.picture = pn.pane.Bokeh(self.figure, sizing_mode="stretch_width")
        # Before its axes are known a chart would show false ones, and take a click on them for a point.
        self.picture.visible = self.figure.visible = False
        about = pane(small(_ABOUT_MOTION))
        self.panel = column(self.picture, self.regions, self.said, self.point.panel, self.motion.panel, about)
        self.parts = {
            ("chart", "resonances"): [self.picture], ("chart",): [self.said], ("tongues",): [self.regions],
            ("point",): [self.point.panel], ("motion",): [self.motion.panel],
        }  # fmt: skip

    def narrow(self, narrow: bool) -> None:
        """Beside its colours half of the page holds three numbers."""
        super().narrow(narrow)
        self.figure.xaxis[0].ticker.desired_num_ticks = 3 if narrow else 6

    def show_point(self, step: Step, data: Any) -> None:
        """Multipliers and mode at the point looked at."""
        self.point.set(data, unit_of(self.line))

    def show_motion(self, step: Step, data: Any) -> None:
        """What a disturbance becomes: the motion with it less the one without, which holds the forced vibration."""
        if step.name == UNDISTURBED:
            self.undisturbed = data
        elif self.undisturbed is not None:
            pairs = zip(data["names"], data["twist"], self.undisturbed["twist"], strict=True)
            curves = [Curve(n, data["turns"], np.rad2deg(with_it - without)) for n, with_it, without in pairs]
            self.motion.set(curves, title=f"after a disturbance of {DISTURBANCE:g} rad")

    def refused(self, step: Step, sentence: str) -> None:
        """A line that has no chart may have multipliers and a motion at each point."""
        if step.name in (UNDISTURBED, DISTURBED):
            self.undisturbed = None
            self.motion.set([], title=f"no motion: {sentence}")
            return
        if step.name == "tongues":
            self._say_regions(f"Regions narrower than the points lie apart could not be searched for: {sentence}")
            return
        self.whole, self.ends = None, []
        self.picture.visible = self.figure.visible = False
        self.said.object = small(f"no chart: {sentence}", class_="refusal")

    def show_chart(self, step: Step, data: Any) -> None:
        """The chart, coarse or full, with the point and the operating range."""
        x, y = self.view.axes(self.line)
        self.picture.visible = self.figure.visible = True
        fresh = data is not self.whole  # else only the point has moved, and the picture may be zoomed
        if fresh:
            end = PERCENT * end_of_colours(data["growth"])
            self.colours.update(low=-end, high=end)
            self._image(data, x, y)
            if not ("tongues" in self.shown and self.is_current("tongues")):
                figures.put_rows(self.outlines, [])
                self._say_regions("Regions narrower than the points lie apart are being searched for …")
        if self.extent != (x, y):
            self.extent, self.ends = (x, y), []
            self.figure.x_range.update(start=x.ends[0], end=x.ends[1])
            self.figure.y_range.update(start=y.ends[0], end=y.ends[1])
            self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = x.label, y.label
        at = self.view.point(self.line)
        figures.put_rows(self.here, [(at[0] / x.size, at[1] / y.size)])
        self._operating(x, y)
        if not fresh:
            return
        full = step.name == "chart"
        self.whole = data if full else None
        if full:
            self.chart_call = step.call
            if self.ends:
                self.view.session.beside(self._refine(self.ends))
        self.count += 1
        text = data["text"] if full else "coarse, the full chart follows"
        self.said.object = small(lines(text), data_chart=step.name, data_count=self.count)

    def show_tongues(self, step: Step, data: Any) -> None:
        """Outlines over the chart, however narrow."""
        x, y = self.view.axes(self.line)
        rows = [(xs / x.size, ys / y.size, name) for name, xs, ys in data["regions"]]
        figures.put_rows(self.outlines, rows)
        parts = [
            f"{name} from {ys.min():.4g} {y.unit} on, at {xs[ys.argmin()]:.5g} {x.unit}"
            for xs, ys, name in rows[:MOST_NAMED]
        ]
        parts += [f"and {len(rows) - MOST_NAMED} more"] if len(rows) > MOST_NAMED else []
        count = {0: "No region", 1: "One region"}.get(len(rows), f"{len(rows)} regions")
        self._say_regions(f"{count} of instability found{': ' if rows else ''}{'; '.join(parts)}.\n{data['search']}")

    def _say_regions(self, text: str) -> None:
        self.regions.object = small(lines(text))

    def _image(self, data: Any, x: Axis, y: Axis) -> None:
        (left, width), (bottom, height) = x.pixels(data["x"]), y.pixels(data["y"])
        image = {"image": [(PERCENT * data["growth"]).astype(np.float32)], "x": [left], "y": [bottom]}
        figures.put(self.image, image | {"dw": [width], "dh": [height]})

    def _operating(self, x: Axis, y: Axis) -> None:
        """A box of the speeds and angles that the line is meant for."""
        ends: dict[str, float | None] = {"left": None, "right": None, "bottom": None, "top": None}
        operation = self.line.operation
        for axis, low, high in ((x, "left", "right"), (y, "bottom", "top")):
            if operation is None:
                break
            angles = operation.angle_range if axis.path.endswith(".angle") else None
            if span := operation.speed_range if axis.path == SPEED else angles:
                ends[low], ends[high] = span[0] / axis.size, span[1] / axis.size
        self.box.update(**ends, visible=any(v is not None for v in ends.values()))

    def forget(self, kind: str) -> None:
        """The lines at named speeds, where no axis is the speed any more."""
        if kind == "resonances":
            figures.put_rows(self.names, [])

    def show_resonances(self, step: Step, data: Any) -> None:
        """Lines at the named speeds across the chart."""
        x, y = self.view.axes(self.line)
        low, high = y.ends
        inside = [(s / x.size, n) for s, n in zip(data["speed"], data["name"], strict=True) if x.low <= s <= x.high]
        figures.put_rows(self.names, [(speed, low, speed, high, name) for speed, name in inside])

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
        if not self.is_current("chart"):
            return  # another chart is on its way, and will be refined
        self.view.session.beside(self._refine(ends))

    async def _refine(self, ends: list[tuple[float, float]]) -> None:
        across, up = (bounded(self.view.settings[key], 2) for key in ("across", "up"))
        zoom = ((*ends[0], across), (*ends[1], up))
        whole, extent = self.whole, self.extent
        data = await self.view.session.ask(self.chart_call, "chart", self.variant, {"zoom": zoom})

        def draw() -> None:
            if extent is not None and self.whole is whole:
                self._image(data, *extent)

        self.view.session.locked(draw)


class StabilityView(View):
    """The chart and one point of it."""

    name = "stability"
    about = (
        "Where a small disturbance grows, over any two parameters. Click a point, or type it, for its multipliers, the "
        "growing mode and what becomes of a small disturbance. Zooming in shows more points of the same chart."
    )
    side = _Side
    defaults = {
        "x": SPEED, "x_low": None, "x_high": None, "y": "", "y_low": None, "y_high": None, "across": 60, "up": 60,
        "at_x": 0.0, "at_y": 0.0, "look": False,
    }  # fmt: skip

    fields = {
        **{key: partial(optional, label, width=125) for key, label in _ENDS.items()},
        **{key: partial(number, label, 0.0, width=150) for key, label in _AT.items()},
        **{key: partial(select, f"Along {key}", options=[], width=200) for key in "xy"},
        "across": lambda: count("Points across", 60, 2, MOST_POINTS),
        "up": lambda: count("Points up", 60, 2, MOST_POINTS),
    }

    def arrange(self) -> Any:
        """Axes, ends (by themselves where empty), points, the point looked at."""
        x, y = self.row("x", "x_low", "x_high", "across"), self.row("y", "y_low", "y_high", "up")
        return column(x, y, self.row(*_AT))

    def chosen(self, key: str, value: Setting) -> None:
        """Ends and point belong to an axis; a point that is typed is looked at."""
        if key in ("x", "y"):
            self.settings.update({key: value, "look": False, f"{key}_low": None, f"{key}_high": None})
            self.adapt(self.session.document.line)
        elif key in _AT:
            self.settings["look"] = True
        super().chosen(key, value)

    def adapt(self, line: Driveline) -> None:
        """Parameters of the line."""
        paths = [SPEED, *parameters(line)]
        if self.settings["y"] not in paths:
            self.settings["y"] = next((p for p in paths if p.endswith(".angle")), paths[1] if len(paths) > 1 else "")
        self.choose("x", paths)
        self.choose("y", paths[1:])
        for key, end in (("x", "at_x"), ("y", "at_y")):
            axis = self.axis(line, key)
            self.widgets[end].label = f"Look at {axis.label}"
            for own, value in zip((f"{key}_low", f"{key}_high"), self.own_axis(line, key).ends, strict=True):
                self.widgets[own].label = f"{_ENDS[own]} [{axis.unit}]"
                tell_default(self.widgets[own], value)
            if not self.settings["look"]:
                self.settings[end] = float(f"{_now(line, axis) / axis.size:.6g}")
        self.fill()

    def own_axis(self, line: Driveline, key: str) -> Axis:
        """The axis with ends by themselves, about the value of the line."""
        path = str(self.settings[key])
        if path == SPEED:
            unit, factor = unit_of(line)
            return Axis(path, *speed_range(line), unit, 1 / factor)
        if path.endswith(".angle"):
            return Axis(path, *angle_range(line), "deg", DEGREE)
        (unit, size), now = shown_unit(line, path), pack(line).value(path)
        low, high = sorted((now / 4, now * 4)) if now else (0.0, size)
        return Axis(path, low, high, unit, size)

    def axis(self, line: Driveline, key: str) -> Axis:
        """The axis with the ends as typed, or by themselves."""
        return self.own_axis(line, key).typed(self.typed(f"{key}_low"), self.typed(f"{key}_high"))

    def axes(self, line: Driveline) -> tuple[Axis, Axis]:
        """Both."""
        if self.settings["x"] == self.settings["y"]:
            remedy = "choose another along y"
            raise InputError("stands on both axes", key=str(self.settings["x"]), remedy=remedy)
        x, y = self.axis(line, "x"), self.axis(line, "y")
        for axis in (x, y):
            axis.require_rising(f" {axis.unit}")
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
        fixed = {} if SPEED in (x.path, y.path) else {"speed": at_speed(line, None)}
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
        speed = at.pop(SPEED, None) or at_speed(line, None)
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

    def clicked(self, x: float, y: float) -> None:
        """A point was chosen in the chart, in the units shown."""
        self.settings.update(at_x=float(f"{x:.6g}"), at_y=float(f"{y:.6g}"), look=True)
        self.fill()
        self.session.setting_chosen()

"""Stability over two parameters; a click shows the multipliers there, the growing mode, and the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from bokeh.events import RangesUpdate, Tap

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.parameter_range import ParameterRange
from trunnion.app.parts.point import Point
from trunnion.app.parts.variants import parameters, shown_unit, with_number
from trunnion.app.parts.widgets import column, lines, pane, small
from trunnion.app.views.base import (
    MOST_POINTS,
    Setting,
    VariantPane,
    View,
    ViewStep,
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
from trunnion.pictures.looks import curve
from trunnion.pictures.picture import Axis, Cells, ColouredGrid, Item, Line, Panel, Picture, points_at, single
from trunnion.reporting.ranges import angle_range

COARSE = (16, 12)
TURNS = 30
"""Of the motion after a disturbance."""
DISTURBANCE = 1e-3
"""Its largest rotation at the start [rad], in the mode that grows fastest."""
REST = 0.3
"""Seconds that the line must stay before its regions are searched for."""
HEIGHT = 5.4
"""Of the chart [inches]."""
MOST_NAMED = 6
"""Regions of instability that the page lists, those that grow fastest."""
UNDISTURBED, DISTURBED = "undisturbed", "motion"
_ABOUT_MOTION = (
    f"The motion with a disturbance of {DISTURBANCE:g} rad in the mode that grows fastest, less the motion without it: "
    "the forced vibration, which both have, is taken away."
)
_ENDS = {"x_low": "x from", "x_high": "x to", "y_low": "y from", "y_high": "y to"}
_AT = {"at_x": "Look at x", "at_y": "Look at y"}


def _now(line: Driveline, axis: ParameterRange) -> float:
    value = at_speed(line, None) if axis.path == SPEED else pack(line).value(axis.path)
    return min(max(value, axis.low), axis.high)


class _StabilityPane(VariantPane["StabilityView"]):
    """Chart, multipliers, mode, motion."""

    def make(self) -> None:
        """Panes and places of the pictures, made once."""
        self.picture = Canvas({Tap: self._tapped, RangesUpdate: self._zoomed})
        self.point, self.motion = Point(), Canvas()
        self.undisturbed: Any = None
        self.said, self.regions, self.no_motion = pane(), pane(), pane()
        self.extent: tuple[ParameterRange, ParameterRange] | None = None
        self.chart: Panel | None = None
        self.zoomed: Panel | None = None
        self.edges: Sequence[Item] = ()
        self.whole: Any = None
        self.ends: list[tuple[float, float]] = []
        self.count = 0
        moved, about = [self.motion.panel, self.no_motion], pane(small(_ABOUT_MOTION))
        self.panel = column(self.picture.panel, self.regions, self.said, self.point.panel, *moved, about)
        self.parts = {
            ("chart",): [self.picture.panel, self.said], ("tongues",): [self.regions], ("point",): [self.point.panel],
            ("motion",): moved,
        }  # fmt: skip

    def narrow(self, narrow: bool) -> None:
        """The point's pictures too."""
        super().narrow(narrow)
        self.point.circle.narrow(narrow)
        self.point.mode.narrow(narrow)

    def show_nothing(self, step: ViewStep, data: None) -> None:
        """Names of resonances, which stand in the chart and are here to be saved."""

    def show_point(self, step: ViewStep, data: Any) -> None:
        """Multipliers and mode at the point looked at."""
        self.point.set(data, unit_of(self.line))

    def show_motion(self, step: ViewStep, data: Any) -> None:
        """What a disturbance becomes: the motion with it less the one without, which holds the forced vibration."""
        if step.name == UNDISTURBED:
            self.undisturbed = data
        elif self.undisturbed is not None:
            self.no_motion.object = ""
            pairs = zip(data["names"], data["twist"], self.undisturbed["twist"], strict=True)
            lines = [
                Line(data["turns"], np.rad2deg(with_it - without), curve(k), name)
                for k, (name, with_it, without) in enumerate(pairs)
            ]
            title = f"after a disturbance of {DISTURBANCE:g} rad"
            across, up = Axis("turns of the input"), Axis("change of the twist", "°")
            self.motion.show(single(across, up, lines, height=3.6, title=title))

    def refused(self, step: ViewStep, sentence: str) -> None:
        """A line that has no chart may have multipliers and a motion at each point."""
        if step.name in (UNDISTURBED, DISTURBED):
            self.undisturbed = None
            self.motion.clear()
            self.no_motion.object = small(f"no motion: {sentence}")
            return
        if step.name == "tongues":
            self._say_regions(f"Regions narrower than the points lie apart could not be searched for: {sentence}")
            return
        self.whole, self.chart, self.ends = None, None, []
        self.picture.clear()
        self.said.object = small(f"no chart: {sentence}", class_="refusal")

    def show_chart(self, step: ViewStep, data: Any) -> None:
        """The chart, coarse or full, with the point and the operating range."""
        axes = self.view.axes(self.line)
        fresh = data is not self.whole  # else only the point has moved, and the picture may be zoomed
        if fresh:
            self.chart, self.zoomed = data["picture"].panel, None
            if not ("tongues" in self.shown and self.is_current("tongues")):
                self.edges = ()
                self._say_regions("Regions narrower than the points lie apart are being searched for …")
        if self.extent != axes:
            self.extent, self.ends = axes, []
        self._draw()
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

    def show_tongues(self, step: ViewStep, data: Any) -> None:
        """Outlines over the chart, however narrow."""
        x, y = self.view.axes(self.line)
        self.edges = data["edges"]
        self._draw()
        begins = data["begins"]
        parts = [
            f"{name} from {up / y.size:.4g} {y.unit} on, at {across / x.size:.5g} {x.unit}"
            for name, across, up in begins[:MOST_NAMED]
        ]
        parts += [f"and {len(begins) - MOST_NAMED} more"] if len(begins) > MOST_NAMED else []
        count = {0: "No region", 1: "One region"}.get(len(begins), f"{len(begins)} regions")
        self._say_regions(f"{count} of instability found{': ' if begins else ''}{'; '.join(parts)}.\n{data['search']}")

    def _say_regions(self, text: str) -> None:
        self.regions.object = small(lines(text))

    def _draw(self) -> None:
        """The chart, or in its place the points of a part of it, the edges of regions, and the point looked at."""
        if self.chart is None or self.extent is None:
            return
        items = list(self.chart.items)
        if self.zoomed is not None:
            items = [*filter(_is_mesh, self.zoomed.items), *(item for item in items if not _is_mesh(item))]
        at = [value * factor for value, factor in zip(self.view.point(self.line), self._factors(), strict=True)]
        panel = replace(self.chart, items=(*items, *self.edges, points_at(at, "here")))
        self.picture.show(Picture((panel,), height=HEIGHT))

    def _factors(self) -> tuple[float, float]:
        """From SI to the units along the chart."""
        assert self.chart is not None and self.extent is not None
        shown = ((axis.high or 0.0) - (axis.low or 0.0) for axis in (self.chart.x, self.chart.y))
        return tuple(one / (axis.high - axis.low) for one, axis in zip(shown, self.extent, strict=True))  # type: ignore[return-value]

    def _tapped(self, event: Any) -> None:
        """Look at a point of the chart."""
        at = zip((event.x, event.y), self._factors(), self.view.axes(self.line), strict=True)
        x, y = (float(value) / factor / axis.size for value, factor, axis in at)
        self.view.clicked(x, y)

    def _zoomed(self, event: Any) -> None:
        """More points of the same chart where the picture shows a part of it."""
        if self.extent is None or self.whole is None:
            return
        ends = []
        for axis, factor, low, high in zip(
            self.extent, self._factors(), (event.x0, event.y0), (event.x1, event.y1), strict=True
        ):
            a, b = max(low / factor, axis.low), min(high / factor, axis.high)
            if not a < b:
                return
            ends.append((a, b))
        if np.allclose(ends, [(axis.low, axis.high) for axis in self.extent], rtol=1e-9, atol=0.0):
            self.ends, self.zoomed = [], None
            self._draw()
            return
        self.ends = ends
        if not self.is_current("chart"):
            return  # another chart is on its way, and will be refined
        self.view.session.beside(self._refine(ends))

    async def _refine(self, ends: list[tuple[float, float]]) -> None:
        across, up = (bounded(self.view.settings[key], 2) for key in ("across", "up"))
        options = {"unit": unit_of(self.line)[0], "zoom": ((*ends[0], across), (*ends[1], up))}
        whole = self.whole
        data = await self.view.session.ask(self.chart_call, "chart", self.variant, options)

        def draw() -> None:
            if self.whole is whole:
                self.zoomed = data["picture"].panel
                self._draw()

        self.view.session.locked(draw)


def _is_mesh(item: Item) -> bool:
    """Whether an item is coloured point by point."""
    return isinstance(item, ColouredGrid | Cells)


class StabilityView(View):
    """The chart and one point of it."""

    name = "stability"
    about = (
        "Where a small disturbance grows, over any two parameters. Click a point, or type it, for its multipliers, the "
        "growing mode and what becomes of a small disturbance. Zooming in shows more points of the same chart."
    )
    side = _StabilityPane
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
            for own, value in zip((f"{key}_low", f"{key}_high"), self.parameter_axis(line, key).ends, strict=True):
                self.widgets[own].label = f"{_ENDS[own]} [{axis.unit}]"
                tell_default(self.widgets[own], value)
            if not self.settings["look"]:
                self.settings[end] = float(f"{_now(line, axis) / axis.size:.6g}")
        self.fill()

    def parameter_axis(self, line: Driveline, key: str) -> ParameterRange:
        """The axis with ends by themselves, about the value of the line."""
        path = str(self.settings[key])
        if path == SPEED:
            unit, factor = unit_of(line)
            return ParameterRange(path, *speed_range(line), unit, 1 / factor)
        if path.endswith(".angle"):
            return ParameterRange(path, *angle_range(line), "deg", DEGREE)
        (unit, size), now = shown_unit(line, path), pack(line).value(path)
        low, high = sorted((now / 4, now * 4)) if now else (0.0, size)
        return ParameterRange(path, low, high, unit, size)

    def axis(self, line: Driveline, key: str) -> ParameterRange:
        """The axis with the ends as typed, or by themselves."""
        return self.parameter_axis(line, key).typed(self.typed(f"{key}_low"), self.typed(f"{key}_high"))

    def axes(self, line: Driveline) -> tuple[ParameterRange, ParameterRange]:
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

    def steps(self, line: Driveline) -> list[ViewStep]:
        """A coarse chart, the point, the full chart, the motion, the names of what opens, the regions themselves.

        The regions are searched for beside the chart, since they may be narrower than its points lie apart."""
        x, y = self.axes(line)
        fixed = {} if SPEED in (x.path, y.path) else {"speed": at_speed(line, None)}
        across, up = (bounded(self.settings[key], 2) for key in ("across", "up"))
        steps, unit = [], {"unit": unit_of(line)[0]}
        if across > COARSE[0] and up > COARSE[1]:
            coarse = Call("tn.stability_chart", (LINE, x.request(COARSE[0]), y.request(COARSE[1])), fixed)
            steps.append(ViewStep("coarse", coarse, "chart", unit, picture="", files=(), soft=True, preview_of="chart"))
        chart = Call("tn.stability_chart", (LINE, x.request(across), y.request(up)), fixed)
        full = ViewStep("chart", chart, "chart", unit, drawing=unit, title="stability chart", soft=True, lasting=True)
        names = ViewStep("names", Call("tn.resonance_speeds", (LINE,)), "nothing", picture="", files=("csv",),
                     title="resonance speeds", lasting=True)  # fmt: skip
        point, *motions = self._at(line, x, y)
        ranges = (axis.request(0)[:3] for axis in (x, y))
        pixel = {"pixel": (x.high - x.low) / (across - 1)}
        regions = ViewStep("tongues", Call("tn.tongues", (LINE, *ranges), fixed), "tongues", unit | pixel, drawing=unit,
                       files=("nc",), title="regions of instability", soft=True, lasting=True, rest=REST)  # fmt: skip
        return [*steps, point, full, *motions, *([names] if x.path == SPEED else []), regions]

    def _at(self, line: Driveline, x: ParameterRange, y: ParameterRange) -> tuple[ViewStep, ...]:
        """Multipliers at the point looked at, and the motion there without a disturbance and with one."""
        at = dict(zip((x.path, y.path), self.point(line), strict=True))
        speed = at.pop(SPEED, None) or at_speed(line, None)
        there = line
        for path, value in at.items():
            there = with_number(there, path, value)
        multipliers = Call("tn.stability", (LINE,), {"speed": speed})
        # By time: a free line makes its turns a little sooner or later once it is disturbed, and both are subtracted.
        run, brief = ({"duration": 2 * np.pi * turns / speed, "speed": speed} for turns in (float(TURNS), 1.0))
        begin = Call("at", (0.0,), of=Call("tn.simulate", (LINE,), brief))
        start = Call("np.add", (begin, Call("disturbance", (DISTURBANCE,), of=multipliers)))
        shown = {"speed": speed}
        return (
            ViewStep(
                "point", multipliers, "point", picture="", files=("nc",), title="multipliers at the point", line=there
            ),
            ViewStep(
                UNDISTURBED, Call("tn.simulate", (LINE,), run), "motion", shown,
                title="motion from untwisted shafts", files=("nc",), line=there, soft=True,
            ),
            ViewStep(
                DISTURBED, Call("tn.simulate", (LINE,), {**run, "start": start}), "motion", shown,
                title="the same with a small disturbance", files=("nc",), line=there, soft=True,
            ),
        )  # fmt: skip

    def clicked(self, x: float, y: float) -> None:
        """A point was chosen in the chart, in the units shown."""
        self.settings.update(at_x=float(f"{x:.6g}"), at_y=float(f"{y:.6g}"), look=True)
        self.fill()
        self.session.setting_chosen()

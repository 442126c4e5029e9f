"""Sliders on the numbers of the line, and a kept variant to compare with."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import panel as pn

from trunnion.app.parts.widgets import Html, HtmlPane, ProgrammaticChange, column, joined, markup
from trunnion.driveline.changes import changes
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import loads
from trunnion.driveline.parameters import SPEED, pack
from trunnion.driveline.quantities import KINDS, RATIO, eye_unit
from trunnion.errors import InputError

STEPS = 200
LONG_LABEL = ".bk-slider-title { white-space: normal; overflow-wrap: anywhere; }"
"""The path of a parameter is as long as the name of its element."""
MOST_ROWS = 30
"""Differences that are listed."""


def parameters(line: Driveline) -> list[str]:
    """Paths of all numbers of the line that a slider can move."""
    return [label for label in pack(line).labels if label != SPEED]


def shown_unit(line: Driveline, path: str) -> tuple[str, float]:
    """The unit that a parameter is shown in, and its size in SI."""
    packed = pack(line)
    unit = packed.resolve(path).unit
    kind = next((k for k in KINDS if k.unit == unit), RATIO)
    return eye_unit(packed.value(path), kind)


def with_number(line: Driveline, path: str, value: float) -> Driveline:
    """The line with one number changed."""
    packed = pack(line)
    values = packed.values.copy()
    columns = packed.resolve(path)
    values[columns.index] = columns.offset + columns.slope * value
    return packed.line_at(values)


class Sliders:
    """A parameter to move, its bounds, the slider, and the same as a number.

    moved: takes line and parameter; set_: hears that another parameter, or other bounds, were chosen.
    """

    def __init__(
        self, line: Driveline, moved: Callable[[Driveline, str], None], set_: Callable[[], None] = lambda: None
    ) -> None:
        self.line, self.moved, self.set = line, moved, set_
        self.size = 1.0
        self.asked: dict[str, str] = {}
        self.programmatic = ProgrammaticChange()
        self.which = pn.widgets.Select(label="Parameter to move", options=[], sizing_mode="stretch_width")
        self.slider = pn.widgets.FloatSlider(
            label="Value", start=0, end=1, step=0.01, sizing_mode="stretch_width", stylesheets=[LONG_LABEL]
        )
        self.value = pn.widgets.FloatInput(label="Value as a number", width=105)
        self.low = pn.widgets.FloatInput(label="Slider from", width=72)
        self.high = pn.widgets.FloatInput(label="to", width=72)
        self.message = HtmlPane("", css_classes=["refusal"])
        self.which.param.watch(lambda event: self._chosen(), "value")
        for number in (self.slider, self.value):
            number.param.watch(lambda event: self._moved(event.new), "value")
        for end in (self.low, self.high):
            end.param.watch(lambda event: self._bounds(), "value")
        row = pn.Row(self.value, self.low, self.high, margin=0)
        self.panel = column(self.which, self.slider, row, self.message)

    def adapt(self, line: Driveline) -> None:
        """Follow a line that was changed elsewhere."""
        self.line = line
        paths = parameters(line)
        if self.which.options != paths:
            with self.programmatic:
                kept = self.asked.get("move", self.which.value)
                self.which.options = paths
                self.which.value = kept if kept in paths else _usual(paths)
        self._chosen(keep=True)
        if ends := self._asked_ends():
            self.low.value, self.high.value = ends
        self.asked = {}

    def read(self, query: Mapping[str, str]) -> None:
        """Take the number and the ends of the slider from an address, once there is a line."""
        self.asked = {key: query[key] for key in ("move", "move.from", "move.to") if key in query}

    def _asked_ends(self) -> tuple[float, float] | None:
        """Those of the address, where they are two numbers that rise and the line has the number that they are of."""
        try:
            low, high = float(self.asked["move.from"]), float(self.asked["move.to"])
        except (KeyError, ValueError):
            return None
        fits = self.asked.get("move", self.which.value) == self.which.value
        return (low, high) if fits and math.isfinite(low) and math.isfinite(high) and low < high else None

    def query(self) -> dict[str, str]:
        """Number and ends that differ from those of a fresh page, for the address."""
        path = self.which.value
        if path is None:
            return {}
        unit, size = shown_unit(self.line, path)
        ends = self.low.value, self.high.value
        made = {} if path == _usual(self.which.options) else {"move": path}
        usual = _ends(pack(self.line).value(path) / size, unit)
        return made if ends == usual or None in ends else {**made, "move.from": repr(ends[0]), "move.to": repr(ends[1])}

    def _chosen(self, keep: bool = False) -> None:
        path = self.which.value
        if self.programmatic or path is None:
            return
        unit, self.size = shown_unit(self.line, path)
        shown = pack(self.line).value(path) / self.size
        with self.programmatic:
            same = keep and self.slider.label.startswith(path) and self.slider.start <= shown <= self.slider.end
            if not same:
                low, high = _ends(shown, unit)
                self.low.value, self.high.value = low, high
                self.slider.param.update(start=low, end=high, step=(high - low) / STEPS)
            self.slider.label = f"{path} [{unit}]"
            self.value.label = f"Value [{unit}]"
            rounded = float(f"{shown:.10g}")
            self.slider.value, self.value.value = min(max(rounded, self.slider.start), self.slider.end), rounded
            self.message.object = ""
        if not keep:
            self.set()

    def _bounds(self) -> None:
        low, high = self.low.value, self.high.value
        if self.programmatic or None in (low, high) or not low < high:
            return
        with self.programmatic:
            value = min(max(self.slider.value, low), high)
            self.slider.param.update(start=low, end=high, step=(high - low) / STEPS, value=value)
        self.set()

    def _moved(self, value: float | None) -> None:
        path = self.which.value
        if self.programmatic or value is None or path is None or not math.isfinite(value):
            return
        try:
            line = with_number(self.line, path, value * self.size)
        except InputError as error:
            self.message.object = str(error)
            return
        with self.programmatic:
            self.message.object = ""
            self.value.value = value
            if self.slider.start <= value <= self.slider.end:
                self.slider.value = value
        self.moved(line, path)


def _usual(paths: Sequence[str]) -> str | None:
    """The number that a fresh page moves."""
    return next((p for p in paths if p.endswith(".angle")), paths[0] if paths else None)


def _ends(value: float, unit: str) -> tuple[float, float]:
    if unit == "deg":
        return (0.0, 45.0) if 0 <= value <= 45 else (-90.0, 90.0)
    if value == 0:
        return 0.0, 1.0
    low, high = sorted((value / 4, value * 4))
    return float(f"{low:.3g}"), float(f"{high:.3g}")


def difference(name: str, kept: str, line: Driveline) -> Html:
    """What changed since a variant was kept, as HTML."""
    rows = changes(loads(kept), line)
    if not rows:
        return markup("<p>{} is like the line now: change a value.</p>", name)
    row = "<tr><td>{}</td><td>{}</td><td>{}</td></tr>"
    cells = joined(markup(row, one.place, one.before, one.after) for one in rows[:MOST_ROWS])
    more = markup("<p>and {} more</p>", len(rows) - MOST_ROWS) if len(rows) > MOST_ROWS else ""
    head = markup("<tr><th>what changed</th><th>{}</th><th>now</th></tr>", name)
    return markup("<table class='plain'>{}{}</table>{}", head, cells, more)

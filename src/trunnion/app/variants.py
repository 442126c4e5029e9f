"""Sliders on the numbers of the line, and a kept variant to compare with."""

from __future__ import annotations

import html
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import panel as pn

from trunnion.driveline.changes import changes
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import loads
from trunnion.driveline.parameters import SPEED, pack
from trunnion.driveline.quantities import KINDS, RATIO, Kind
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.app.session import Session

STEPS = 200


def parameters(line: Driveline) -> list[str]:
    """Paths of all numbers of the line that a slider can move."""
    return [label for label in pack(line).labels if label != SPEED]


def kind_of(line: Driveline, path: str) -> Kind:
    """The physical kind of a parameter."""
    unit = pack(line).resolve(path).unit
    return next((k for k in KINDS if k.unit == unit), RATIO)


def shown_unit(kind: Kind, value: float) -> tuple[str, float]:
    """The unit a value of that kind is shown in, and its size in SI."""
    for symbol, size, smallest in kind.shown:
        if abs(value) >= smallest:
            return symbol, size
    return kind.unit, 1.0


def with_number(line: Driveline, path: str, value: float) -> Driveline:
    """The line with one number changed."""
    packed = pack(line)
    values = packed.values.copy()
    columns = packed.resolve(path)
    values[columns.index] = columns.offset + columns.slope * value
    return packed.line_at(values)


class Sliders:
    """A parameter to move, its bounds, the slider, and the same as a number."""

    def __init__(self, session: Session, changed: Callable[[Driveline], None]) -> None:
        self.session, self.changed = session, changed
        self.size = 1.0
        self._quiet = False
        self.which = pn.widgets.Select(label="Parameter to move", options=[], sizing_mode="stretch_width")
        self.slider = pn.widgets.FloatSlider(label="Value", start=0, end=1, step=0.01, sizing_mode="stretch_width")
        self.value = pn.widgets.FloatInput(label="Value as a number", width=105)
        self.low = pn.widgets.FloatInput(label="Slider from", width=72)
        self.high = pn.widgets.FloatInput(label="to", width=72)
        self.message = pn.pane.HTML("", css_classes=["refusal"])
        self.which.param.watch(lambda event: self._chosen(), "value")
        self.slider.param.watch(lambda event: self._moved(event.new), "value")
        self.value.param.watch(lambda event: self._moved(event.new), "value")
        for end in (self.low, self.high):
            end.param.watch(lambda event: self._bounds(), "value")
        row = pn.Row(self.value, self.low, self.high, margin=0)
        self.panel = pn.Column(self.which, self.slider, row, self.message, sizing_mode="stretch_width", margin=0)

    def adapt(self, line: Driveline) -> None:
        """Follow a line that was changed elsewhere."""
        paths = parameters(line)
        self._quiet = True
        try:
            if self.which.options != paths:
                kept = self.which.value
                self.which.options = paths
                joint = next((p for p in paths if p.endswith(".angle")), paths[0] if paths else None)
                self.which.value = kept if kept in paths else joint
        finally:
            self._quiet = False
        self._chosen(keep=True)

    def _chosen(self, keep: bool = False) -> None:
        line, path = self.session.document.line, self.which.value
        if self._quiet or path is None:
            return
        now, kind = pack(line).value(path), kind_of(line, path)
        unit, self.size = shown_unit(kind, now)
        shown = now / self.size
        self._quiet = True
        try:
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
        finally:
            self._quiet = False

    def _bounds(self) -> None:
        if self._quiet or None in (self.low.value, self.high.value) or not self.low.value < self.high.value:
            return
        self._quiet = True
        try:
            low, high = self.low.value, self.high.value
            value = min(max(self.slider.value, low), high)
            self.slider.param.update(start=low, end=high, step=(high - low) / STEPS, value=value)
        finally:
            self._quiet = False

    def _moved(self, value: float | None) -> None:
        if self._quiet or value is None or self.which.value is None or not math.isfinite(value):
            return
        try:
            line = with_number(self.session.document.line, self.which.value, value * self.size)
        except InputError as error:
            self.message.object = html.escape(str(error))
            return
        self._quiet = True
        try:
            self.message.object = ""
            self.value.value = value
            if self.slider.start <= value <= self.slider.end:
                self.slider.value = value
        finally:
            self._quiet = False
        self.changed(line)


def _ends(value: float, unit: str) -> tuple[float, float]:
    if unit == "deg":
        return (0.0, 45.0) if 0 <= value <= 45 else (-90.0, 90.0)
    if value == 0:
        return 0.0, 1.0
    low, high = sorted((value / 4, value * 4))
    return float(f"{low:.3g}"), float(f"{high:.3g}")


def difference(kept: str | None, line: Driveline) -> str:
    """What changed since a variant was kept, as HTML."""
    if kept is None:
        return ""
    rows = changes(loads(kept), line)
    if not rows:
        return "<p>The two variants are alike so far: change a value.</p>"
    cells = "".join(
        f"<tr><td>{html.escape(one.place)}</td><td>{html.escape(one.before)}</td><td>{html.escape(one.after)}</td></tr>"
        for one in rows[:30]
    )
    more = f"<p>and {len(rows) - 30} more</p>" if len(rows) > 30 else ""
    return f"<table class='plain'><tr><th>what changed</th><th>kept</th><th>now</th></tr>{cells}</table>{more}"


def buttons(keep: Callable[[Any], None], drop: Callable[[Any], None], swap: Callable[[Any], None]) -> tuple[Any, ...]:
    """Keep this variant, compare no more, swap the two."""
    one = pn.widgets.Button(label="Keep this variant to compare", width=230)
    two = pn.widgets.Button(label="Compare no more", width=140, disabled=True)
    three = pn.widgets.Button(label="Swap", width=70, disabled=True)
    for button, action in ((one, keep), (two, drop), (three, swap)):
        button.on_click(action)
    return one, two, three

"""What every view has: settings that its address keeps, controls, jobs, and a picture for each variant."""

from __future__ import annotations

import html
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import panel as pn

from trunnion.app.calls import Call
from trunnion.app.curves import Curves
from trunnion.app.jobs import Job
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps
from trunnion.driveline.operating_speed import speed_unit
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from trunnion.app.session import Session

Setting = str | float | int | bool | None
"""Of a view; one whose default is None is a number that is found by itself where none is typed."""
NAMES = {
    "png": "PNG", "svg": "SVG", "csv": "CSV", "nc": "netCDF", "html": "HTML", "py": "Python", "toml": "TOML",
}  # fmt: skip
MOST_POINTS = 400
"""Points along an axis that the browser may ask for."""


@dataclass(frozen=True)
class Step:
    """One computation of a view: its name, the call, what is shown of it, and what may be downloaded.

    files: endings of its data; picture: method that draws it ("" for none); drawing: its arguments; columns: variables
    that a CSV holds, for results of many axes; line: a changed line that the step is about; soft: a refusal
    leaves the other steps standing and is shown in its place; lasting: its answer is kept, and shown again at once
    while the job is the same; preview_of: a step that shows the same better, and is waited for where it was quick;
    rest: seconds without a further change before it begins, so that a slider under way does not wait for its end.
    """

    name: str
    call: Call
    show: str
    options: Mapping[str, Any] = field(default_factory=dict)
    picture: str = "plot"
    drawing: Mapping[str, Any] = field(default_factory=dict)
    files: tuple[str, ...] = ("csv", "nc")
    columns: tuple[str, ...] = ()
    title: str = ""
    line: Driveline | None = None
    soft: bool = False
    lasting: bool = False
    preview_of: str = ""
    rest: float = 0.0

    def job(self, toml: str) -> Job:
        """The computation for a line, or for the changed one that the step has of its own."""
        return Job(self.toml(toml), self.call, self.show, self.options)

    def toml(self, toml: str) -> str:
        """The file of the line that is computed."""
        return toml if self.line is None else dumps(self.line)


class Side(ABC):
    """The picture of one variant; ``variant`` is "now" or "kept", set by the view."""

    panel: Any
    variant = "now"

    def narrow(self, narrow: bool) -> None:
        """Take half of the page, or all of it again."""
        for held in vars(self).values():
            if isinstance(held, Curves):
                held.narrow(narrow)

    @abstractmethod
    def show(self, name: str, data: Any) -> None:
        """Show what the step ``name`` gave."""

    def refused(self, name: str, sentence: str) -> None:  # noqa: B027 - views without soft steps leave it
        """Say why the step ``name`` gave nothing; asked for of soft steps only."""


class View(ABC):
    """One view of a session. A subclass says its settings, controls, steps and side."""

    name = ""
    title = ""
    about = ""
    defaults: Mapping[str, Setting] = {}

    def __init__(self, session: Session) -> None:
        self.session = session
        self.settings: dict[str, Setting] = dict(self.defaults)
        self.widgets: dict[str, Any] = {}
        self.sides: dict[str, Side] = {}
        self._quiet = False
        self.downloads = pn.pane.HTML("", sizing_mode="stretch_width")
        self.controls = self.make_controls()

    # -- what a subclass writes -----------------------------------------------------------------------------------

    def make_controls(self) -> Any:
        """Widgets, made once."""
        return pn.FlexBox()

    def adapt(self, line: Driveline) -> None:  # noqa: B027 - views whose choices stay leave it
        """Choices that depend on the line."""

    @abstractmethod
    def steps(self, line: Driveline) -> list[Step]:
        """What is computed, in order."""

    @abstractmethod
    def side(self) -> Side:
        """A picture."""

    # -- what they share ------------------------------------------------------------------------------------------

    def of(self, variant: str) -> Side:
        """The picture of a variant, made when it is first needed."""
        if variant not in self.sides:
            self.sides[variant] = self.side()
            self.sides[variant].variant = variant
        return self.sides[variant]

    def line_of(self, side: Side) -> Driveline:
        """The line that a picture is of."""
        return self.session.line(side.variant)

    def read(self, query: Mapping[str, str]) -> None:
        """Take settings from an address; what does not fit is left at its default."""
        for key, default in self.defaults.items():
            if key in query:
                try:
                    self.settings[key] = _as(query[key], default)
                except ValueError:
                    continue
        self.fill()

    def query(self) -> dict[str, str]:
        """Settings that differ from their defaults, for the address."""
        return {k: str(v) for k, v in self.settings.items() if v != self.defaults[k]}

    def typed(self, key: str) -> float | None:
        """The number of a setting; None where it is to be found by itself."""
        value = self.settings[key]
        return None if value is None else float(value)

    def value(self, key: str) -> float:
        """The number of a setting that always has one."""
        return float(self.settings[key] or 0.0)

    def fill(self) -> None:
        """Show the settings in the controls."""
        self._quiet = True
        try:
            for key, widget in self.widgets.items():
                value = self.settings[key]
                if widget.value != value:
                    choices = getattr(widget, "options", None)
                    if choices is not None and value not in (
                        choices.values() if isinstance(choices, dict) else choices
                    ):
                        continue
                    widget.value = value
        finally:
            self._quiet = False

    def put(self, key: str, value: Setting) -> None:
        """Change a setting as if it had been typed."""
        self.settings[key] = value
        self.fill()
        self.session.setting_chosen()

    def bind(self, key: str, widget: Any) -> Any:
        """Tie a widget to a setting."""
        self.widgets[key] = widget

        def changed(event: Any) -> None:
            if self._quiet or (event.new is None and self.defaults[key] is not None):
                return
            self.settings[key] = event.new
            self.session.setting_chosen()

        widget.param.watch(changed, "value")
        return widget

    def choose(self, key: str, choices: list[str] | dict[str, str]) -> None:
        """Give a widget its choices; a setting that is none of them becomes the first."""
        values = list(choices.values()) if isinstance(choices, dict) else choices
        self._quiet = True
        try:
            if self.settings[key] not in values and values:
                self.settings[key] = values[0]
            self.widgets[key].options = choices
            if values:
                self.widgets[key].value = self.settings[key]
            self.widgets[key].disabled = not values
        finally:
            self._quiet = False


def links(token: str, view: View, files: list[tuple[Step, tuple[str, ...]]]) -> str:
    """Links to everything of a view that may be downloaded."""
    rows = []
    for step, endings in files:
        parts = " ".join(_link(token, view.name, step.name, ending, NAMES[ending]) for ending in endings)
        rows.append(f"<li>{html.escape(step.title or step.name)}: {parts}</li>")
    rows.append(f"<li>Python that computes what is shown: {_link(token, view.name, 'view', 'py', 'Python')}</li>")
    whole = [_link(token, view.name, "driveline", ending, NAMES[ending]) for ending in ("toml", "html")]
    rows.append(f"<li>the driveline: {whole[0]}, its report: {whole[1]}</li>")
    return f"<h2 style='font-size:16px;margin:14px 0 0'>Save</h2><ul class='files'>{''.join(rows)}</ul>"


def _link(token: str, view: str, name: str, ending: str, text: str) -> str:
    return f"<a href='download/{token}/{view}/{name}.{ending}' download>{text}</a>"


def _as(text: str, default: Setting) -> Setting:
    if isinstance(default, bool):
        return text == "True"
    if isinstance(default, int):
        return int(text)
    if default is None or isinstance(default, float):
        value = float(text)
        if not math.isfinite(value):
            raise ValueError
        return value
    return text[:200]


def bounded(value: Setting, least: int, most: int = MOST_POINTS) -> int:
    """A number of points within bounds, whatever an address says."""
    return min(max(int(value or 0), least), most)


def select(label: str, **more: Any) -> Any:
    """A drop-down list with its label."""
    return pn.widgets.Select(label=label, width=more.pop("width", 220), **more)


def number(label: str, value: float | None, **more: Any) -> Any:
    """A field for a number, with its label."""
    return pn.widgets.FloatInput(label=label, value=value, width=more.pop("width", 130), **more)


def optional(label: str, **more: Any) -> Any:
    """A field for a number that is found by itself while the field is empty; ``tell_default`` says what it is then."""
    return number(label, None, **more)


def tell_default(widget: Any, value: float, word: str = "auto") -> None:
    """Say in an empty field which number stands for it."""
    widget.placeholder = f"{word}: {value:.4g}"


def count(label: str, value: int, start: int, end: int) -> Any:
    """A field for a whole number within bounds."""
    return pn.widgets.IntInput(label=label, value=value, start=start, end=end, width=100)


def unit_of(line: Driveline) -> tuple[str, float]:
    """Unit of speeds, and how many of it a rad/s is."""
    unit = speed_unit(line)
    return unit, speed_factor(unit)


def speed_range(line: Driveline) -> tuple[float, float]:
    """Lowest and highest speed [rad/s] that the line's pictures cover."""
    from trunnion.reporting.ranges import speed_range as of_line

    low, high = of_line(line)
    return max(low, high / 1000), high


def at_speed(line: Driveline, typed: float | None) -> float:
    """The speed [rad/s] typed in the line's unit; None stands for the operating speed, or the middle of the range."""
    if typed:
        return typed / unit_of(line)[1]
    if line.operation and line.operation.speed:
        return line.operation.speed
    low, high = speed_range(line)
    return (low + high) / 2


def label_speed(widget: Any, line: Driveline) -> None:
    """The unit of a field for a speed, and the speed that stands for an empty one."""
    unit, factor = unit_of(line)
    widget.label = f"Speed [{unit}]"
    operating = line.operation is not None and line.operation.speed is not None
    tell_default(widget, at_speed(line, None) * factor, "operating" if operating else "auto")

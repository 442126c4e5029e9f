"""What every view has: settings that its address keeps, controls, jobs, and a picture for each variant."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

import panel as pn

from trunnion.app.parts.calls import Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.document import Document
from trunnion.app.parts.jobs import Job
from trunnion.app.parts.widgets import Html, ProgrammaticChange, faint, joined, markup, pane, wrapped
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps
from trunnion.driveline.operating_speed import known_speed, speed_unit
from trunnion.errors import InputError
from trunnion.pictures.overlaid import largest
from trunnion.pictures.picture import Picture
from trunnion.reporting import ranges
from trunnion.results.speeds import speed_factor

Setting = str | float | int | bool | None
"""Of a view; one whose default is None is a number that is found by itself where none is typed."""
NAMES = {
    "png": "PNG", "svg": "SVG", "csv": "CSV", "nc": "netCDF", "html": "HTML", "py": "Python", "toml": "TOML",
    "gif": "GIF", "json": "JSON",
}  # fmt: skip
PICTURES = ("png", "svg")
ANEW = "it is being computed anew"
"""What becomes of a result that is shown though the line or the settings have changed."""
MOST_POINTS = 400
"""Points along an axis that the browser may ask for."""


@dataclass(frozen=True)
class ViewStep:
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

    @property
    def endings(self) -> tuple[str, ...]:
        """Of the files that may be downloaded: pictures, then data."""
        return (PICTURES if self.picture else ()) + self.files

    def file(self, toml: str, ending: str) -> Job:
        """The computation of a download."""
        options = {"ending": ending, "method": self.picture, "options": dict(self.drawing), "columns": self.columns}
        return Job(self.toml(toml), self.call, "file", options)


class Host(Protocol):
    """What a view asks of the page it stands on."""

    document: Document

    def line(self, side: str) -> Driveline:
        """The line of a variant, "now" or a kept one by its key."""

    def edit(self, change: Callable[[Document], Any]) -> None:
        """Change the line, and everything that follows from it."""

    def show_view(self, name: str) -> None:
        """Look at another view."""

    def state_limits(self) -> None:
        """Give every spring without a limit one to fill in, and go there."""

    def setting_chosen(self) -> None:
        """Hear that a setting of the visible view is another."""

    def ask(
        self, call: Call, show: str, side: str, options: Mapping[str, Any] | None = None, *, says: bool = False
    ) -> Coroutine[Any, Any, Any]:
        """One further computation for the line of a variant; nothing follows where the line changes meanwhile.

        says: its progress is shown, and Cancel ends it."""

    def beside(self, work: Coroutine[Any, Any, None]) -> None:
        """Begin what a click asks for, beside the computation of the view."""

    def locked(self, action: Callable[[], Any]) -> None:
        """Change the page from such work."""

    def is_looked_at(self, view: View) -> bool:
        """Whether a view is the one that the page shows."""


V = TypeVar("V", bound="View")


class VariantPane(ABC, Generic[V]):
    """The picture of one variant, "now" or a kept one: a method ``show_KIND`` for what each kind of step gives."""

    panel: Any
    parts: Mapping[tuple[str, ...], Sequence[Any]]
    """Panels by the kinds of steps (``ViewStep.show``) that draw in them."""

    def __init__(self, view: V, variant: str) -> None:
        self.view, self.variant = view, variant
        self.what = ""
        self.shown: dict[str, Job] = {}
        self.wanted: Mapping[str, Sequence[Job]] = {}
        self.doubt = ""
        self.stamp = pane(height=0, margin=0, styles={"position": "sticky", "top": "4px", "z-index": "9"})
        self.make()

    @abstractmethod
    def make(self) -> None:
        """Make ``panel`` and ``parts``, and what in them changes."""

    # -- whose result it is ---------------------------------------------------------------------------------------

    def expect(self, wanted: Sequence[tuple[ViewStep, Job]], doubt: str) -> None:
        """From now on ``wanted`` is asked for: what is shown of other jobs, or all of it in ``doubt``, is stamped."""
        jobs: dict[str, list[Job]] = {}
        for step, job in wanted:
            jobs.setdefault(step.show, []).append(job)
        for kind in [kind for kind in self.shown if kind not in jobs]:
            del self.shown[kind]
        self.wanted, self.doubt = jobs, doubt
        self.tell(ANEW)

    def disown(self, doubt: str) -> None:
        """What is shown is of nothing that stands on the page."""
        self.doubt = doubt
        self.tell(ANEW)

    def take(self, step: ViewStep, job: Job, data: Any) -> None:
        """Show what a job gave."""
        self.show(step, data)
        self.shown[step.show] = job
        self.tell(ANEW)

    def refuse(self, step: ViewStep, job: Job, sentence: str) -> None:
        """Show that a job gave nothing, and why."""
        self.refused(step, sentence)
        self.shown[step.show] = job
        self.tell(ANEW)

    def is_current(self, kind: str) -> bool:
        """Whether what a kind of step shows belongs to the line and settings as they are."""
        return not self.doubt and (kind not in self.shown or self.shown[kind] in self.wanted.get(kind, ()))

    def is_up_to_date(self, canvas: Canvas) -> bool:
        """Whether a picture belongs to the line and settings as they are."""
        kinds = [kind for kinds, panels in self.parts.items() if canvas.panel in panels for kind in kinds]
        return not self.doubt and all(map(self.is_current, kinds))

    def tell(self, fate: str) -> None:
        """Stamp what is shown of another line or other settings, with what becomes of it."""
        stale = False
        for kinds, panels in self.parts.items():
            is_old = not all(map(self.is_current, kinds))
            for panel in panels:
                faint(panel, is_old)
            stale |= is_old and any(kind in self.shown for kind in kinds)
        words = self.doubt or f"What is faint belongs to an earlier line or other settings: {fate}."
        self.stamp.object = markup("<div class='stamp' role='status'>{}</div>", words) if stale else ""

    @property
    def line(self) -> Driveline:
        """The line that the picture is of."""
        return self.view.session.line(self.variant)

    @property
    def canvases(self) -> dict[str, Canvas]:
        """The places of its pictures, by their names."""
        return {name: held for name, held in vars(self).items() if isinstance(held, Canvas)}

    def narrow(self, narrow: bool) -> None:
        """Take half of the page, or all of it again."""
        for held in self.canvases.values():
            held.narrow(narrow)

    def begin(self, what: str) -> None:
        """Forget what belongs to another question."""
        if what != self.what:
            self.what = what
            self.shown = {}
            self.clear()
            self.tell(ANEW)

    def clear(self) -> None:
        """Show nothing."""

    def show(self, step: ViewStep, data: Any) -> None:
        """Show what a step gave: by the method of the name of what made ``data`` in ``trunnion.app.shown``."""
        getattr(self, f"show_{step.show}")(step, data)

    def refused(self, step: ViewStep, sentence: str) -> None:
        """Say why a step gave nothing; asked for of soft steps only."""


class View(ABC):
    """One view of a session. A subclass says its settings, controls, steps and side."""

    name = ""
    about = ""
    defaults: Mapping[str, Setting] = {}
    fields: Mapping[str, Callable[[], Any]] = {}
    """What makes the control of a setting."""
    asks: Mapping[str, Sequence[str]] = {}
    """Of a view with several questions: the controls that each choice of the setting "what" has."""
    asked_by: Sequence[str] = ()
    """Settings that say which question it is."""
    side: type[VariantPane[Any]]

    def __init__(self, session: Host) -> None:
        self.session = session
        self.settings: dict[str, Setting] = dict(self.defaults)
        self.widgets: dict[str, Any] = {}
        self.sides: dict[str, VariantPane[Any]] = {}
        self.programmatic = ProgrammaticChange()
        self.downloads = pane()
        self.upon = pane()
        self.names: Mapping[str, str] = {}
        for key, make in self.fields.items():
            self._bind(key, make())
        self.controls = self.arrange()

    # -- what a subclass writes -----------------------------------------------------------------------------------

    def arrange(self) -> Any:
        """The controls and what stands beside them, made once."""
        return self.row(*self.widgets)

    def adapt(self, line: Driveline) -> None:  # noqa: B027 - views whose choices stay leave it
        """Choices that depend on the line."""

    @abstractmethod
    def steps(self, line: Driveline) -> list[ViewStep]:
        """What is computed, in order."""

    def close(self) -> None:  # noqa: B027 - most views keep nothing
        """The page is gone: let go what was kept for it."""

    # -- what they share ------------------------------------------------------------------------------------------

    def of(self, variant: str) -> VariantPane[Any]:
        """The picture of a variant, made when it is first needed."""
        if variant not in self.sides:
            side = self.sides[variant] = self.side(self, variant)
            side.begin(str(self.settings.get("what", "")))
        return self.sides[variant]

    def take(self, side: str, step: ViewStep, job: Job, data: Any) -> None:
        """Show what a job gave for a variant, on the axes of another one too where they are shared."""
        self.of(side).take(step, job, data)
        self.show_upon()

    def refuse(self, side: str, step: ViewStep, job: Job, sentence: str) -> None:
        """Show that a job gave nothing for a variant, and why."""
        self.of(side).refuse(step, job, sentence)
        self.show_upon()

    def lay_upon(self, names: Mapping[str, str]) -> bool:
        """Show what variants have on the axes of the present line's pictures, or nothing of them; whether it can."""
        self.names = names
        self.show_upon()
        return bool(self.of("now").canvases)

    def show_upon(self) -> None:
        """The same anew, once a picture has changed, with how the largest values differ."""
        own, rows = self.of("now"), list[Html]()
        sides = {name: self.of(key) for key, name in self.names.items() if key != own.variant}
        for place, canvas in own.canvases.items():
            others = ((name, side, side.canvases.get(place)) for name, side in sides.items())
            known = [(name, of.own[0]) for name, side, of in others if of and of.own and side.is_up_to_date(of)]
            canvas.lay_upon(known)
            if canvas.own is not None and own.is_up_to_date(canvas):
                rows += [row for name, one in known for row in _largest(canvas.own[0], name, one)]
        head = markup("<tr><th>largest of</th><th>variant</th><th>there</th><th>now</th><th>change</th></tr>")
        self.upon.object = markup("<table class='plain'>{}{}</table>", head, joined(rows)) if rows else ""

    def show_question(self) -> None:
        """Show the controls of the question, and in the pictures nothing of another one."""
        what = self.widgets["what"].value
        for key, widget in self.widgets.items():
            widget.visible = key == "what" or key in self.asks[what]
        for side in self.sides.values():
            side.begin(what)

    def load(self) -> dict[str, Setting]:
        """The load case of the setting "load" as an argument of calls, none for its default."""
        case = self.settings["load"]
        return {} if case == self.defaults["load"] else {"load_case": case}

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
        with self.programmatic:
            for key, widget in self.widgets.items():
                value, choices = self.settings[key], getattr(widget, "options", None)
                known = choices.values() if isinstance(choices, dict) else choices
                if widget.value != value and (known is None or value in known):
                    widget.value = value

    def put(self, key: str, value: Setting) -> None:
        """Change a setting as if it had been typed."""
        self.settings[key] = value
        self.fill()
        self.session.setting_chosen()

    def chosen(self, key: str, value: Setting) -> None:
        """Take a setting that the user changed."""
        self.settings[key] = value
        if key in self.asked_by:
            self.show_question()
        self.session.setting_chosen()

    def _bind(self, key: str, widget: Any) -> None:
        def changed(event: Any) -> None:
            if not (self.programmatic or (event.new is None and self.defaults[key] is not None)):
                self.chosen(key, event.new)

        self.widgets[key] = widget
        widget.param.watch(changed, "value")

    def row(self, *keys: str) -> Any:
        """The controls of settings beside each other, as far as there is place."""
        return wrapped(*(self.widgets[key] for key in keys))

    def choose(self, key: str, choices: list[str]) -> None:
        """Give a widget its choices; a setting that is none of them becomes the first."""
        widget = self.widgets[key]
        with self.programmatic:
            if choices and self.settings[key] not in choices:
                self.settings[key] = choices[0]
            widget.options = choices
            if choices:
                widget.value = self.settings[key]
            widget.disabled = not choices


def links(token: str, view: View, line: Driveline) -> Html:
    """Links to everything of a view that may be downloaded."""
    rows = {}
    for step in view.steps(line):
        if step.endings:
            parts = joined(_link(token, view.name, step.name, ending, NAMES[ending]) for ending in step.endings)
            rows[step.title or step.name] = parts
    rows["Python that computes what is shown"] = _link(token, view.name, "view", "py", "Python")
    whole = [_link(token, view.name, "driveline", ending, NAMES[ending]) for ending in ("toml", "html")]
    rows["the driveline"] = markup("{}, its report: {}", *whole)
    found = joined(markup("<li>{}: {}</li>", title, parts) for title, parts in rows.items())
    return markup("<h2 style='font-size:16px;margin:14px 0 0'>Save</h2><ul class='files'>{}</ul>", found)


def _largest(own: Picture, name: str, other: Picture) -> Iterator[Html]:
    """How the largest values of the curves differ that two pictures name, as rows of a table."""
    for one in largest(own, other):
        change = f"{one.share:+.1%}" if math.isfinite(one.share) else ""
        values = (
            f"{value:.4g} {one.unit} at {at:.4g} {one.at_unit}"
            for value, at in ((one.other, one.other_at), (one.now, one.at))
        )
        yield markup(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>", one.curve, name, *values, change
        )


def _link(token: str, view: str, name: str, ending: str, text: str) -> Html:
    return markup("<a href='download/{}/{}/{}.{}' download>{}</a> ", token, view, name, ending, text)


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


def slider(label: str, start: float, end: float, step: float) -> Any:
    """A slider that begins at zero, with its label."""
    return pn.widgets.FloatSlider(label=label, start=start, end=end, step=step, value=0, width=260)


def unit_of(line: Driveline) -> tuple[str, float]:
    """Unit of speeds, and how many of it a rad/s is."""
    unit = speed_unit(line)
    return unit, speed_factor(unit)


def speed_range(line: Driveline) -> tuple[float, float]:
    """Lowest and highest speed [rad/s] that the line's pictures cover."""
    low, high = ranges.speed_range(line)
    return max(low, high / 1000), high


def springs_of(line: Driveline) -> list[str]:
    """Names of the shafts and meshes that twist."""
    from trunnion.equations.coefficients import assemble  # no first page needs them
    from trunnion.steady.orders.forced_response import shaft_names

    return list(shaft_names(assemble(line)))


def load_cases(line: Driveline) -> list[str]:
    """Names of the line's load cases."""
    return [case.name for case in line.operation.load_cases] if line.operation else []


def at_speed(line: Driveline, typed: float | None) -> float:
    """The speed [rad/s] typed in the line's unit; None stands for the operating speed, or the middle of the range."""
    if typed:
        return typed / unit_of(line)[1]
    with suppress(InputError):  # a motor and loads that settle nowhere are refused by what is asked of them
        if known := known_speed(line):
            return known
    low, high = speed_range(line)
    return (low + high) / 2


def label_speed(widget: Any, line: Driveline) -> None:
    """The unit of a field for a speed, and the speed that stands for an empty one."""
    unit, factor = unit_of(line)
    widget.label = f"Speed [{unit}]"
    operating = line.operation is not None and line.operation.speed is not None
    tell_default(widget, at_speed(line, None) * factor, "operating" if operating else "auto")

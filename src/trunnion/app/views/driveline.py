"""The driveline itself: its elements in an editable table, a sketch, files in and out."""

from __future__ import annotations

from typing import Any

import panel as pn

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.document import LARGEST_FILE, Document
from trunnion.app.parts.editing import change_of
from trunnion.app.parts.editor import Editor
from trunnion.app.parts.line_picture import LinePicture
from trunnion.app.parts.upload import Upload
from trunnion.app.parts.widgets import column, pane, picture, pre, wrapped
from trunnion.app.views.base import Setting, VariantPane, View, ViewStep, select
from trunnion.driveline.dampers import Damper
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps
from trunnion.driveline.starter import STARTERS, starter

EMPTY = "empty"
"""To begin with nothing."""


class _DrivelinePane(VariantPane["DrivelineView"]):
    """The table with sketch and modes, or of a kept variant these alone."""

    def make(self) -> None:
        """Panes and figures, made once."""
        self.sketch, self.modes, view = pane(), pane(), self.view
        if self.variant == "now":
            self.panel = column(view.touched, view.editor, self.modes)
            self.parts = {("touchable",): [view.picture], ("text",): [self.modes]}
        else:
            self.panel = column(self.sketch, self.modes)
            self.parts = {("touchable",): [self.sketch], ("text",): [self.modes]}

    def show_touchable(self, step: ViewStep, data: Any) -> None:
        """The line as a picture, of the present one with its parts to take."""
        if self.variant == "now":
            keys = self.view.session.document.element_keys
            if len(keys) == len(data["spots"]):
                self.view.picture.show(data["svg"], data["spots"], keys)
        else:
            self.sketch.object = picture(
                data["svg"], "sketch of the driveline, elements numbered as in the table", 1000
            )

    def show_text(self, step: ViewStep, text: str) -> None:
        """Its modes."""
        self.modes.object = pre(text)


class DrivelineView(View):
    """Edit the line."""

    name = "driveline"
    about = (
        "Elements from the drive to the load. Click a part to change it, drag it to a + to move it; Delete takes it "
        "away, Alt with an arrow moves it. A quantity is a number with its unit; an empty field is left out."
    )
    side = _DrivelinePane
    defaults = {"part": ""}
    fields = {"part": lambda: select("Part to change", options=[], width=200)}

    def arrange(self) -> Any:
        """Where a line comes from, undo, and the whole file as text."""
        self.editor = Editor(self._edited, sizing_mode="stretch_width")
        self.picture = LinePicture(self._edited, styles={"flex": "3 1 320px", "min-width": "0"})
        self.beside = Editor(self._edited, alone=True, visible=False, styles={"flex": "1 1 260px", "min-width": "0"})
        self.touched = wrapped(self.picture, self.beside, styles={"gap": "12px"})
        self.begin = pn.widgets.Select(
            label="Begin with",
            options=_beginnings(),
            sizing_mode="stretch_width",
            min_width=200,
            styles={"max-width": "min(400px, calc(100% - 20px))"},
        )
        load = pn.widgets.Button(label="Begin", width=70, align="end")
        load.on_click(lambda event: self.session.edit(self._begin))
        upload = Upload(
            lambda text: self.session.edit(lambda document: document.replace_text(text)),
            LARGEST_FILE,
            label="Open a TOML file",
        )
        self.undo = pn.widgets.Button(label="Undo", width=70, align="end")
        self.redo = pn.widgets.Button(label="Redo", width=70, align="end")
        self.undo.on_click(lambda event: self.session.edit(Document.undo))
        self.redo.on_click(lambda event: self.session.edit(Document.redo))
        made = (self.begin, load, upload, self.undo, self.redo, self.widgets["part"])
        return wrapped(*made, styles={"gap": "4px", "align-items": "end"})

    def _begin(self, document: Document) -> None:
        name = self.begin.value
        if name == EMPTY:
            document.begin_empty()
        elif name.startswith("starter "):
            document.replace_text(starter(name.removeprefix("starter ")))
        else:
            from trunnion.papers.entries import catalogue

            document.replace_text(dumps(catalogue(name)))

    def chosen(self, key: str, value: Setting) -> None:
        """A part is picked; nothing is computed for that."""
        self._pick(str(value))

    def _pick(self, name: str) -> None:
        """Show the fields of a part beside the picture; none where the line has none of that name."""
        groups = self.session.document.about(name)
        self.settings["part"] = name if groups else ""
        self.fill()
        self.beside.show(groups)
        self.beside.visible = bool(groups)
        self.picture.picked = str(self.settings["part"])

    def _edited(self, data: dict[str, Any]) -> None:
        if data.get("do") == "pick":
            self._pick(str(data.get("name", "")))
            return
        self.session.edit(change_of(data))
        self.adapt(self.session.document.line)

    def adapt(self, line: Driveline) -> None:
        """Fields and undo as they stand."""
        document = self.session.document
        self.editor.show(document.groups())
        self.choose("part", ["", *line.as_stated.names])
        self._pick(str(self.settings["part"]))
        self.undo.disabled, self.redo.disabled = not document.can_step(-1), not document.can_step(1)

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The sketch, where the natural frequencies are, and what each damper would be best with for the first."""
        return [
            ViewStep("sketch", LINE, "touchable", picture="", files=()),
            ViewStep("modes", Call("tn.natural_frequencies", (LINE,)), "text", title="mode shapes"),
            *(
                ViewStep(
                    f"best {name}",
                    Call("tn.damper_optimum", (LINE, name)),
                    "text",
                    picture="",
                    soft=True,
                    title=f"best for mode 1: {name}",
                )
                for name, element in line.parts
                if isinstance(element, Damper)
            ),
        ]


def _beginnings() -> dict[str, str]:
    from trunnion.papers.entries import entries

    names = {f"{name}: {about}": f"starter {name}" for name, about in STARTERS.items()}
    lines = [e for e in entries() if e.describes_line]
    return (
        names | {"an empty line: add its elements one by one": EMPTY} | {f"{e.name}: {e.title}": e.name for e in lines}
    )

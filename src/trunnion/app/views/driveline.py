"""The driveline itself: its elements in an editable table, a sketch, files in and out."""

from __future__ import annotations

from typing import Any

import panel as pn

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.document import LARGEST_FILE, Document
from trunnion.app.parts.editor import Editor
from trunnion.app.parts.upload import Upload
from trunnion.app.parts.widgets import column, pane, picture, pre, wrapped
from trunnion.app.views.base import VariantPane, View, ViewStep
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
        self.sketch, self.modes = pane(), pane()
        table = [self.view.editor] if self.variant == "now" else []
        self.panel = column(self.sketch, *table, self.modes)
        self.parts = {("sketch",): [self.sketch], ("text",): [self.modes]}

    def show_sketch(self, step: ViewStep, svg: str) -> None:
        """The line as a picture."""
        self.sketch.object = picture(svg, "sketch of the driveline, elements numbered as in the table", 1000)

    def show_text(self, step: ViewStep, text: str) -> None:
        """Its modes."""
        self.modes.object = pre(text)


class DrivelineView(View):
    """Edit the line."""

    name = "driveline"
    about = "Elements from the drive to the load. A quantity is a number with its unit; an empty field is left out."
    side = _DrivelinePane

    def arrange(self) -> Any:
        """Where a line comes from, undo, and the whole file as text."""
        self.editor = Editor(self._edited, sizing_mode="stretch_width")
        self.begin = pn.widgets.Select(label="Begin with", options=_beginnings(), width=400)
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
        return wrapped(self.begin, load, upload, self.undo, self.redo, styles={"gap": "4px", "align-items": "end"})

    def _begin(self, document: Document) -> None:
        name = self.begin.value
        if name == EMPTY:
            document.begin_empty()
        elif name.startswith("starter "):
            document.replace_text(starter(name.removeprefix("starter ")))
        else:
            from trunnion.papers.entries import catalogue

            document.replace_text(dumps(catalogue(name)))

    def _edited(self, data: dict[str, Any]) -> None:
        def change(document: Document) -> None:
            found = document.place(tuple(data.get("path", ())), data.get("key", 0))
            if found is None:
                return  # taken away since: by the click before, say
            match data:
                case {"do": "set", "text": str(text)} if found:
                    document.set_text(found, text)
                case {"do": "add", "kind": str(kind), "place": int(place)}:
                    document.add_element(place, kind)
                case {"do": "remove"} if found:
                    document.remove(found)
                case {"do": "move", "by": int(by)} if found:
                    document.move(int(found[1]), by)
                case {"do": "limit"}:
                    document.add_limit("Shaft *")
                case {"do": "load_case"}:
                    document.add_load_case()
                case {"do": "schedule"}:
                    document.add_schedule()
                case {"do": "switch_off"}:
                    document.switch_off()

        self.session.edit(change)
        self.adapt(self.session.document.line)

    def adapt(self, line: Driveline) -> None:
        """Fields and undo as they stand."""
        document = self.session.document
        self.editor.show(document.groups())
        self.undo.disabled, self.redo.disabled = not document.can_step(-1), not document.can_step(1)

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The sketch, where the natural frequencies are, and what each damper would be best with for the first."""
        return [
            ViewStep("sketch", LINE, "sketch", picture="", files=()),
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

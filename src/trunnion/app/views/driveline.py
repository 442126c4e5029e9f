"""The driveline itself: its elements in an editable table, a sketch, files in and out."""

from __future__ import annotations

import base64
import html
from typing import TYPE_CHECKING, Any

import panel as pn

from trunnion.app.calls import LINE, THE_LINE, Call
from trunnion.app.document import LARGEST_FILE, Document
from trunnion.app.editor import Editor
from trunnion.app.upload import Upload
from trunnion.app.views.base import Side, Step, View
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps
from trunnion.driveline.starter import STARTERS, starter

if TYPE_CHECKING:
    from trunnion.app.session import Session


class DrivelineView(View):
    """Edit the line."""

    name = "driveline"
    title = "Driveline"
    about = "Elements from the drive to the load. A quantity is a number with its unit; an empty field is left out."

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.editor = Editor(self._edited, sizing_mode="stretch_width")

    def make_controls(self) -> Any:
        """Where a line comes from, undo, and the whole file as text."""
        self.begin = pn.widgets.Select(label="Begin with", options=_beginnings(), width=400)
        load = pn.widgets.Button(label="Begin", width=70, align="end")
        load.on_click(lambda event: self.session.edit(self._begin))
        self.upload = Upload(self._uploaded, LARGEST_FILE, label="Open a TOML file")
        self.undo = pn.widgets.Button(label="Undo", width=70, align="end")
        self.redo = pn.widgets.Button(label="Redo", width=70, align="end")
        self.undo.on_click(lambda event: self.session.edit(Document.undo))
        self.redo.on_click(lambda event: self.session.edit(Document.redo))
        return pn.FlexBox(self.begin, load, self.upload, self.undo, self.redo, gap="4px", align_items="end")

    def _begin(self, document: Document) -> None:
        name = self.begin.value
        if name.startswith("starter "):
            document.replace_text(starter(name.removeprefix("starter ")))
        else:
            from trunnion.studies.entries import catalogue

            document.replace_text(dumps(catalogue(name)))

    def _uploaded(self, text: str) -> None:
        self.session.edit(lambda document: document.replace_text(text))

    def _edited(self, data: dict[str, Any]) -> None:
        def change(document: Document) -> None:
            match data:
                case {"do": "set", "path": list(path), "text": str(text)}:
                    document.set_text(tuple(path), text)
                case {"do": "add", "kind": str(kind), "place": int(place)}:
                    document.add_element(place, kind)
                case {"do": "remove", "path": list(path)}:
                    document.remove(tuple(path))
                case {"do": "move", "place": int(place), "by": int(by)}:
                    document.move(place, by)
                case {"do": "limit"}:
                    document.add_limit("Shaft *")
                case {"do": "load_case"}:
                    document.add_load_case()

        self.session.edit(change)
        self.show_document()

    def adapt(self, line: Driveline) -> None:
        """Show the document."""
        self.show_document()

    def show_document(self) -> None:
        """Fields and undo as they stand."""
        document = self.session.document
        self.editor.show(document.groups())
        self.undo.disabled, self.redo.disabled = not document.can_undo, not document.can_redo

    def steps(self, line: Driveline) -> list[Step]:
        """The sketch, and where the natural frequencies are."""
        return [
            Step("sketch", THE_LINE, "sketch", picture="", files=()),
            Step("modes", Call("tn.natural_frequencies", (LINE,)), "text", title="mode shapes"),
        ]

    def side(self) -> Any:
        """The table, or of a kept variant its sketch."""
        return _Side(self.editor if not self.sides else None)


class _Side(Side):
    def __init__(self, editor: Editor | None) -> None:
        self.sketch = pn.pane.HTML("", sizing_mode="stretch_width")
        self.modes = pn.pane.HTML("", sizing_mode="stretch_width")
        self.panel = pn.Column(
            self.sketch, *([editor] if editor else []), self.modes, sizing_mode="stretch_width", margin=0
        )

    def show(self, name: str, data: Any) -> None:
        """The sketch as a picture, modes as text."""
        if name == "sketch":
            picture = base64.b64encode(data.encode()).decode()
            self.sketch.object = (
                f"<img alt='sketch of the driveline, elements numbered as in the table' "
                f"src='data:image/svg+xml;base64,{picture}' style='width:100%;max-width:1000px'>"
            )
        else:
            self.modes.object = f"<pre>{html.escape(data)}</pre>"


def _beginnings() -> dict[str, str]:
    from trunnion.studies.entries import entries

    names = {f"{name}: {about}": f"starter {name}" for name, about in STARTERS.items()}
    lines = [e for e in entries() if e.describes_line]
    return names | {f"{e.name}: {e.title}": e.name for e in lines}

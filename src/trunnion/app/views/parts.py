"""The parts of the line: what each is made of, its maker's sheet beside what was typed of it, ratings against loads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import panel as pn

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.document import Document
from trunnion.app.parts.widgets import Html, column, heading, joined, markup, pane, small, wrapped
from trunnion.app.views.base import VariantPane, View, ViewStep, load_cases, select
from trunnion.driveline.component_files import Component, components, user_folder
from trunnion.driveline.driveline import Driveline
from trunnion.errors import InputError

ALL = "as stated and every load case"
NONE = "none"


class _PartsPane(VariantPane["PartsView"]):
    """Parts, sheets, and what loads take of ratings."""

    def make(self) -> None:
        """Places of the tables and of the picture, made once."""
        self.list, self.sheets, self.loads, self.said = (pane() for _ in range(4))
        self.shares = Canvas()
        self.panel = column(
            heading("Ratings and limits against loads"), self.said, self.shares.panel, self.loads,
            heading("Parts"), self.list, heading("Sheets"), self.sheets,
        )  # fmt: skip
        self.parts = {("parts",): [self.list, self.sheets], ("loads",): [self.said, self.shares.panel, self.loads]}

    def show_parts(self, step: ViewStep, data: Any) -> None:
        """What every part is made of, and the sheets of those that have one."""
        self.list.object = wide_table(("no.", "part", "kind", "numbers"), data["rows"])
        found = joined(_sheet(one) for one in data["sheets"])
        self.sheets.object = found or small("No part of this line is made of a maker's sheet of the catalogue.")

    def show_loads(self, step: ViewStep, data: Any) -> None:
        """How much of what each part bears its loads take."""
        self.said.object = small(data["sentence"])
        if data["picture"] is None:
            self.shares.clear()
        else:
            self.shares.show(data["picture"])
        none = "No part states a rating or a limit that could be judged: type what it bears in Driveline."
        head = ("part", "check", "status", "margin", f"speed [{data['unit']}]", "because")
        self.loads.object = wide_table(head, data["rows"]) if data["rows"] else small(none)

    def refused(self, step: ViewStep, sentence: str) -> None:
        """Why nothing is judged."""
        self.shares.clear()
        self.loads.object, self.said.object = "", small(sentence)


def wide_table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> Html:
    """Cells under their heads, on a narrow page below each other."""
    return markup("<div class='held'>{}</div>", table(head, rows, "plain checks"))


def table(head: Sequence[str], rows: Iterable[Sequence[object]], look: str = "plain") -> Html:
    """Cells under their heads."""
    heads = joined(markup("<th>{}</th>", one) for one in head)
    body = joined(markup("<tr>{}</tr>", joined(markup("<td>{}</td>", one) for one in row)) for row in rows)
    return markup("<table class='{}'><tr>{}</tr>{}</table>", look, heads, body)


def _sheet(one: Any) -> Html:
    """What a sheet prints, and what stands of it in the line."""
    printed = table(("the sheet prints", "value"), one["printed"].items())
    made = table(("number", "typed of it", "in the line", ""), one["made"])
    note = markup("<div>{}</div>", one["note"]) if one["note"] else ""
    return markup(
        "<section aria-label='{0}'><h3 style='font-size:15px;margin:8px 0 0'>{0}</h3><div>{1}</div>{2}"
        "{3}</section>",
        one["title"], one["source"], note, _beside(printed, made),
    )  # fmt: skip


def _beside(*tables: Html) -> Html:
    """Tables beside each other, as far as there is place."""
    cells = joined(markup("<div style='flex:1 1 280px;min-width:0'>{}</div>", one) for one in tables)
    return markup("<div style='display:flex;flex-wrap:wrap;gap:4px 32px'>{}</div>", cells)


def _catalogue() -> tuple[Component, ...]:
    """Sheets that are typed in; none where a user's file of them is damaged."""
    try:
        return components()
    except InputError:
        return ()


class PartsView(View):
    """What the line is made of."""

    name = "parts"
    about = (
        "How much of its ratings and limits each part has left; what every part is made of; what its maker's sheet "
        "prints beside what was typed of it and what the line has now."
    )
    side = _PartsPane
    defaults = {"load": ALL, "part": "", "component": NONE}
    fields = {
        "load": lambda: select("Load", options=[ALL], width=260),
        "part": lambda: select("Part", options=[], width=200),
        "component": lambda: select("Component of the catalogue", options=[NONE], width=260),
    }

    def arrange(self) -> Any:
        """The load, and a component to make a part of, with its sheet."""
        self.take_it = pn.widgets.Button(label="Make the part of it", width=170, align="end", disabled=True)
        self.take_it.on_click(lambda event: self._take_component())
        self.chosen_sheet = pane()
        rows = wrapped(self.widgets["load"]), wrapped(self.widgets["part"], self.widgets["component"], self.take_it)
        return column(*rows, self.chosen_sheet)

    def adapt(self, line: Driveline) -> None:
        """Load cases, parts, and components as they are now."""
        self.choose("load", [ALL, *load_cases(line)])
        self.choose("part", list(line.as_stated.names))
        self.known = {f"{one.sheet.component}@{one.sheet.version}": one for one in _catalogue()}
        self.choose("component", [NONE, *self.known])
        self._show_component()

    def chosen(self, key: str, value: Any) -> None:
        """Neither part nor component changes what is computed."""
        if key == "load":
            super().chosen(key, value)
            return
        self.settings[key] = value
        self._show_component()

    def _show_component(self) -> None:
        """The sheet of the component that is chosen, before anything is made of it."""
        one = self.known.get(str(self.settings["component"]))
        self.take_it.disabled = one is None or not self.settings["part"]
        if one is None:
            where = "Sheets lie in {}, or in a folder components beside a line; trunnion components lists them."
            self.chosen_sheet.object = small(markup(where, user_folder())) if not self.known else ""
            return
        typed = [(key.replace("_", " "), value) for key, value in one.sheet.numbers.items()]
        said = markup("<div>{}, kept {}: {}</div>", one.kind, one.place, one.sheet.words)
        printed = table(("the sheet prints", "value"), one.sheet.printed.items())
        self.chosen_sheet.object = markup("{}{}", said, _beside(printed, table(("number", "typed of it"), typed)))

    def _take_component(self) -> None:
        """Make the part of the component: its numbers and its sheet in place of what was typed."""
        component, part = str(self.settings["component"]), str(self.settings["part"])
        names = self.session.document.line.as_stated.names
        if component not in self.known or part not in names:
            return
        key = self.session.document.element_keys[names.index(part)]

        def change(document: Document) -> None:
            if (found := document.place(("element", 0), key)) is not None:
                document.make_of(int(found[1]), component)

        self.session.edit(change)

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The list, then the assessment."""
        keywords = self.load()
        return [
            ViewStep("parts", LINE, "parts", picture="", files=()),
            ViewStep(
                "assessment", Call("tn.assess", (LINE,), keywords), "loads", picture="", files=("csv", "nc"),
                title="checks", lasting=True, soft=True,
            ),
        ]  # fmt: skip

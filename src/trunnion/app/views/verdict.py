"""Is the line fit for its speeds: every check with its margin, what binds, what would help."""

from __future__ import annotations

from typing import Any

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.widgets import Html, column, items, joined, markup, pane
from trunnion.app.views.base import VariantPane, View, ViewStep, load_cases, select, speed_range, unit_of
from trunnion.app.views.remedy_buttons import RemedyButtons
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.limits import WITHOUT_LIMIT
from trunnion.pictures.picture import Picture

ALL = "as stated and every load case"


class _VerdictPane(VariantPane["VerdictView"]):
    """Sentence, margins, table."""

    def make(self) -> None:
        """Panes and places of the pictures, made once."""
        self.sentence, self.table = pane(), pane()
        self.margins, self.torque = Canvas(), Canvas()
        self.help = RemedyButtons(self.view.session)
        self.panel = column(self.sentence, self.margins.panel, self.help.panel, self.torque.panel, self.table)
        judged = [self.sentence, self.margins.panel, self.help.list, self.table]
        self.parts = {("assessment",): judged, ("assessment", "torque"): [self.torque.panel]}
        self.course: Picture | None = None

    def show_assessment(self, step: ViewStep, data: Any) -> None:
        """The verdict, its margins and checks, and what binds over speed."""
        self.course = data["course"]
        if self.course is not None:
            self.torque.show(self.course)
        kind = data["verdict"].replace(" ", "-")
        self.sentence.object = markup("<p class='verdict {0}' data-verdict='{0}'>{1}</p>", kind, data["sentence"])
        if data["margins"].panel.y.names:
            self.margins.show(data["margins"])
        else:
            self.margins.clear()
        self.table.object = _table(data)
        self.help.clear(data["verdict"] != "satisfied" and self.variant == "now", self.view.load())

    def show_torque(self, step: ViewStep, picture: Picture) -> None:
        """The torque of the shaft that is loaded most, where nothing binds that has a value over speed."""
        if self.course is not None:
            return
        case, panel = self.view.settings["load"], picture.panel
        if load_cases(self.line):
            which = "the line as stated without its load cases" if case == ALL else str(case)
            picture = picture.with_panel(title=f"{panel.title}, {which}")
        self.torque.show(picture)


def _table(data: Any) -> Html:
    unit = data["unit"]
    head = joined(markup("<th>{}</th>", h) for h in ("check", "status", "margin", "speed", "because", "rule"))
    body = []
    for row, rule in zip(data["rows"], data["rules"], strict=True):
        if row["check"] == WITHOUT_LIMIT:
            row = row | {"because": row["because"].partition(";")[0] + "; press State limits and type what they bear"}
        cells = (
            f"{v} {unit}" if v and key.startswith("speed") else str(v) for key, v in (row | {"rule": rule}).items()
        )
        body.append(markup("<tr>{}</tr>", joined(markup("<td>{}</td>", cell) for cell in cells)))
    said = [data["rests_on"], *(f"Switched off: {one}" for one in data["switched_off"]), *data["findings"]]
    table = "<div class='held'><table class='plain checks'><tr>{}</tr>{}</table></div>{}"
    return markup(table, head, joined(body), items(said))


class VerdictView(View):
    """The assessment."""

    name = "verdict"
    about = "Every limit of the line and every rule that applies, over its speeds; the check that binds comes first."
    side = _VerdictPane
    defaults = {"load": ALL}
    fields = {"load": lambda: select("Load", options=[ALL], width=260)}

    def adapt(self, line: Driveline) -> None:
        """Load cases of the line."""
        self.choose("load", [ALL, *load_cases(line)])

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The assessment, then the torques that its limits stand against."""
        keywords = self.load()
        low, high = speed_range(line)
        speeds = Call("tn.sweep_speeds", (LINE, low, high))
        return [
            ViewStep(
                "assessment",
                Call("tn.assess", (LINE,), keywords),
                "assessment",
                picture="",
                files=("csv", "nc"),
                title="checks",
            ),
            ViewStep(
                "torque",
                Call("tn.order_response", (LINE, speeds), keywords),
                "torque",
                {"unit": unit_of(line)[0]},
                files=("nc",),
                title="torque over speed",
            ),
        ]

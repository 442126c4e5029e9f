"""Is the line fit for its speeds: every check with its margin, what binds, what would help."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
from bokeh.models import Span

from trunnion.app.parts import figures
from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.curves import Curve, Curves
from trunnion.app.parts.pieces import Html, column, items, joined, markup, pane
from trunnion.app.views.base import Side, Step, View, load_cases, select, speed_range, unit_of
from trunnion.app.views.helping import Help
from trunnion.design.assessment.own_limits import WITHOUT_LIMIT
from trunnion.driveline.driveline import Driveline

ALL = "as stated and every load case"
MOST = 14
"""Bars of checks that are judged, and lines of those that are not."""
FAR = 2.0
"""Margin at which a bar ends, either way."""
PLACE = 0.04
"""Share of the bars' range that a letter behind the longest bar takes, in the narrowest picture."""
COLOURS = {
    "exceeded": figures.ORANGE,
    "satisfied": figures.BLUE,
    "beyond guideline": figures.FAINT,
    "within guideline": figures.FAINT,
}
"""By the words of a status that has a margin; faint what does not decide."""
UNJUDGED = ("not judged", "guideline not judged")


class _Side(Side["VerdictView"]):
    """Sentence, margins, table."""

    def make(self) -> None:
        """Panes and figures, made once."""
        self.sentence, self.table = pane(), pane()
        self.margins = figures.plot("margin to the limit [%]", "", height=120, y_range=[], x_range=(0, 100), tools="")
        self.bars = figures.source(check=[], margin=[], colour=[], hatch=[], said=[], words=[], end=[])
        bar = self.margins.hbar(
            y="check", right="margin", height=0.6, color="colour", hatch_pattern="hatch", source=self.bars
        )
        self.margins.text(
            x="end", y="check", text="words", source=self.bars, x_offset=6, text_baseline="middle",
            text_font_size="12px", text_color=figures.INK,
        )  # fmt: skip
        self.margins.add_layout(Span(location=0, dimension="height", line_color=figures.INK))
        figures.hover(self.margins, [bar], [("check", "@check"), ("margin", "@margin{0.0} %"), ("", "@said")])
        self.torque = Curves("input speed", "torque [N·m]", height=320, title="torque over speed")
        self.help = Help(self.view.session)
        margins = pn.pane.Bokeh(self.margins, sizing_mode="stretch_width")
        self.panel = column(self.sentence, margins, self.help.panel, self.torque.panel, self.table)
        judged = [self.sentence, margins, self.help.list, self.table]
        self.parts = {("assessment",): judged, ("assessment", "torque_limits"): [self.torque.panel]}
        self.binding = ""
        self.course: Any = {}

    def show_assessment(self, step: Step, data: Any) -> None:
        """The verdict, its margins and checks, and what binds over speed."""
        self.binding = data["element"]
        self.limit = (data["limit"], data["quantity"])
        self.course = data["course"] if data["quantity"] != "N*m" else {}
        if self.course:
            self._binding_course(self.course)
        kind = data["verdict"].replace(" ", "-")
        self.sentence.object = markup("<p class='verdict {0}' data-verdict='{0}'>{1}</p>", kind, data["sentence"])
        judged = [(r, m) for r, m in zip(data["rows"], data["margin"], strict=True)
                  if np.isfinite(m) and r["status"] in COLOURS]  # fmt: skip
        rows = judged[:MOST] + [(r, 0.0) for r in data["rows"] if r["status"] in UNJUDGED][:MOST]
        names = [f"{i + 1}. {r['check']}" for i, (r, _) in enumerate(rows)]
        bad = [r["status"] in ("exceeded", "beyond guideline") for r, _ in rows]
        self.margins.y_range.factors = names[::-1]
        self.margins.height = 70 + 26 * len(rows)
        self.margins.visible = bool(rows)
        figures.put(
            self.bars,
            {
                "check": names,
                "margin": [100 * max(-FAR, min(FAR, m)) for _, m in rows],
                "colour": [COLOURS.get(r["status"], figures.FAINT) for r, _ in rows],
                "hatch": ["right_diagonal_line" if b else " " for b in bad],
                "said": [r["because"] for r, _ in rows],
                "words": [_words(r["status"], m) for r, m in rows],
                "end": [max(0.0, 100 * min(FAR, m)) for _, m in rows],
            },
        )
        margins = [m for _, m in rows]
        low, high = 100 * max(-FAR, min([0.0, *margins])), 100 * min(FAR, max([0.2, *margins]))
        longest = max((len(w) for w in self.bars.data["words"]), default=0)
        place = PLACE * longest * (high - low)  # for the words behind the longest bar
        self.margins.x_range.update(start=low, end=high + place)
        self.table.object = _table(data)
        self.help.clear(data["verdict"] != "satisfied" and self.variant == "now", self.view.load())

    def _binding_course(self, data: Any) -> None:
        """What binds over speed, with its limits, where that is not a torque."""
        unit, factor = unit_of(self.line)
        x = data["speed"] * factor
        free, quantity = len(data["names"]) - data["limits"], data["quantity"]
        looks = [(figures.COLOURS[k % len(figures.COLOURS)], "dashed" if k else "solid") for k in range(free)]
        looks += [(figures.INK, ("dotted", "dotdash")[k % 2]) for k in range(data["limits"])]
        self.torque.set(
            [Curve(name, x, y, *look) for name, y, look in zip(data["names"], data["values"], looks, strict=True)],
            x=f"input speed [{unit}]",
            y=f"{quantity.rpartition(' of ')[0]} [{data['unit']}]",
            title=f"{quantity} over speed, with its limit",
        )

    def show_torque_limits(self, step: Step, data: Any) -> None:
        """The torque of what binds, or of all shafts, where no other quantity does."""
        if self.course:
            return
        unit, factor = unit_of(self.line)
        springs = data["springs"]
        shown = [springs.index(self.binding)] if self.binding in springs else list(range(len(springs)))
        x = data["speed"] * factor
        curves = [
            Curve(f"{springs[i]}: {word}", x, data[key][:, i], figures.COLOURS[k % len(figures.COLOURS)], dash)
            for word, key, dash in (("vibratory", "vibratory", "solid"), ("largest", "peak", "dashed"))
            for k, i in enumerate(shown)
        ]
        limit, quantity = self.limit
        if len(shown) == 1 and quantity == "N*m" and np.isfinite(limit):
            curves.append(Curve("limit", x, np.full(len(x), limit), figures.ORANGE, "dotted"))
        whose = springs[shown[0]] if len(shown) == 1 else "all shafts"
        case = self.view.settings["load"]
        if load_cases(self.line):
            whose += ", the line as stated without its load cases" if case == ALL else f", {case}"
        self.torque.set(curves, x=f"input speed [{unit}]", y="torque [N·m]", title=f"torque of {whose}")


def _words(status: str, margin: float) -> str:
    """What stands at the end of a bar."""
    far = f"> {100 * FAR:g} %" if margin > FAR else ""
    return {"satisfied": far, "within guideline": f"{far} (guideline)".strip()}.get(status, status)


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
    side = _Side
    defaults = {"load": ALL}
    fields = {"load": lambda: select("Load", options=[ALL], width=260)}

    def adapt(self, line: Driveline) -> None:
        """Load cases of the line."""
        self.choose("load", [ALL, *load_cases(line)])

    def steps(self, line: Driveline) -> list[Step]:
        """The assessment, then the torques that its limits stand against."""
        keywords = self.load()
        low, high = speed_range(line)
        speeds = Call("tn.sweep_speeds", (LINE, low, high))
        return [
            Step(
                "assessment",
                Call("tn.assess", (LINE,), keywords),
                "assessment",
                picture="",
                files=("csv", "nc"),
                title="checks",
            ),
            Step(
                "torque",
                Call("tn.order_response", (LINE, speeds), keywords),
                "torque_limits",
                picture="plot",
                files=("nc",),
                title="torque over speed",
            ),
        ]

"""Is the line fit for its speeds: every check with its margin, what binds, what would help."""

from __future__ import annotations

import html
from typing import Any

import numpy as np
import panel as pn
from bokeh.models import Span

from trunnion.analyses.assessment.own_limits import WITHOUT_LIMIT
from trunnion.app import figures
from trunnion.app.calls import LINE, Call
from trunnion.app.curves import Curves
from trunnion.app.helping import Help
from trunnion.app.views.base import Side, Step, View, select, speed_range, unit_of
from trunnion.driveline.driveline import Driveline

ALL = "as stated and every load case"
MOST = 14
"""Bars of checks that are judged, and lines of those that are not."""
FAR = 2.0
"""Margin at which a bar ends, either way."""
PLACE = 0.04
"""Share of the bars' range that a letter behind the longest bar takes, in the narrowest picture."""
COLOURS = {"exceeded": figures.ORANGE, "satisfied": figures.BLUE}


class VerdictView(View):
    """The assessment."""

    name = "verdict"
    title = "Verdict"
    about = "Every limit of the line and every rule that applies, over its speeds; the check that binds comes first."
    defaults = {"load": ALL}

    def make_controls(self) -> Any:
        """The load."""
        return pn.FlexBox(self.bind("load", select("Load", options=[ALL], width=260)))

    def adapt(self, line: Driveline) -> None:
        """Load cases of the line."""
        self.choose("load", [ALL, *load_cases(line)])

    def steps(self, line: Driveline) -> list[Step]:
        """The assessment, then the torques that its limits stand against."""
        keywords = self.keywords()
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

    def keywords(self) -> dict[str, Any]:
        """The load as an argument of the calls."""
        case = self.settings["load"]
        return {} if case == ALL else {"load_case": case}

    def side(self) -> Any:
        """Sentence, margins, table."""
        return _Side(self)


def load_cases(line: Driveline) -> list[str]:
    """Names of the line's load cases."""
    return [case.name for case in line.operation.load_cases] if line.operation else []


class _Side(Side):
    def __init__(self, view: VerdictView) -> None:
        self.view, session = view, view.session
        self.sentence = pn.pane.HTML("", sizing_mode="stretch_width")
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
        self.table = pn.pane.HTML("", sizing_mode="stretch_width")
        self.help = Help(session)
        self.panel = pn.Column(
            self.sentence,
            pn.pane.Bokeh(self.margins, sizing_mode="stretch_width"),
            self.help.panel,
            self.torque.panel,
            self.table,
            sizing_mode="stretch_width",
            margin=0,
        )
        self.binding = ""
        self.course: Any = {}

    def show(self, name: str, data: Any) -> None:
        """The verdict, or the torque of what binds."""
        if name == "assessment":
            self._verdict(data)
        elif not self.course:
            self._torque(data)

    def _verdict(self, data: Any) -> None:
        self.binding = data["element"]
        self.limit = (data["limit"], data["quantity"])
        self.course = data["course"] if data["quantity"] != "N*m" else {}
        if self.course:
            self._binding_course(self.course)
        kind = html.escape(data["verdict"].replace(" ", "-"))
        self.sentence.object = f"<p class='verdict {kind}' data-verdict='{kind}'>{html.escape(data['sentence'])}</p>"
        judged = [(r, m) for r, m in zip(data["rows"], data["margin"], strict=True)
                  if np.isfinite(m) and r["status"] in COLOURS]  # fmt: skip
        rows = judged[:MOST] + [(r, 0.0) for r in data["rows"] if r["status"] == "not judged"][:MOST]
        names = [f"{i + 1}. {r['check']}" for i, (r, _) in enumerate(rows)]
        bad = [r["status"] == "exceeded" for r, _ in rows]
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
        self.help.clear(data["verdict"] != "satisfied" and self.variant == "now", self.view.keywords())

    def _binding_course(self, data: Any) -> None:
        """What binds over speed, with its limits, where that is not a torque."""
        unit, factor = unit_of(self.view.line_of(self))
        x = data["speed"] * factor
        curves = [(name, x, values) for name, values in zip(data["names"], data["values"], strict=True)]
        free = len(curves) - data["limits"]
        quantity = data["quantity"]
        self.torque.set(
            curves,
            colours=[figures.COLOURS[k % len(figures.COLOURS)] for k in range(free)] + [figures.INK] * data["limits"],
            dashes=["solid"] + ["dashed"] * (free - 1) + ["dotted", "dotdash"][: data["limits"]],
            x=f"input speed [{unit}]",
            y=f"{quantity.rpartition(' of ')[0]} [{data['unit']}]",
            title=f"{quantity} over speed, with its limit",
        )

    def _torque(self, data: Any) -> None:
        unit, factor = unit_of(self.view.line_of(self))
        springs = data["springs"]
        shown = [springs.index(self.binding)] if self.binding in springs else list(range(len(springs)))
        x = data["speed"] * factor
        curves = [(f"{springs[i]}: vibratory", x, data["vibratory"][:, i]) for i in shown]
        curves += [(f"{springs[i]}: largest", x, data["peak"][:, i]) for i in shown]
        colours = [figures.COLOURS[k % len(figures.COLOURS)] for k in range(len(shown))] * 2
        dashes = ["solid"] * len(shown) + ["dashed"] * len(shown)
        limit, quantity = self.limit
        if len(shown) == 1 and quantity == "N*m" and np.isfinite(limit):
            curves.append(("limit", x, np.full(len(x), limit)))
            colours, dashes = [*colours, figures.ORANGE], [*dashes, "dotted"]
        whose = springs[shown[0]] if len(shown) == 1 else "all shafts"
        title = f"torque of {whose}"
        self.torque.set(
            curves, colours=colours, dashes=dashes, x=f"input speed [{unit}]", y="torque [N·m]", title=title
        )


def _words(status: str, margin: float) -> str:
    """What stands at the end of a bar."""
    if status == "not judged":
        return status
    return "exceeded" if status == "exceeded" else f"> {100 * FAR:g} %" if margin > FAR else ""


def _table(data: Any) -> str:
    unit = data["unit"]
    head = "".join(f"<th>{h}</th>" for h in ("check", "status", "margin", "speed", "because", "rule"))
    body = ""
    for row, rule in zip(data["rows"], data["rules"], strict=True):
        if row["check"] == WITHOUT_LIMIT:
            row = row | {"because": row["because"].partition(";")[0] + "; press State limits and type what they bear"}
        cells = (
            f"{v} {unit}" if v and key.startswith("speed") else str(v) for key, v in (row | {"rule": rule}).items()
        )
        body += "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"
    said = "".join(f"<li>{html.escape(f)}</li>" for f in data["findings"])
    return f"<div class='held'><table class='plain checks'><tr>{head}</tr>{body}</table></div><ul>{said}</ul>"

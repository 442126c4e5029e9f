"""The line on one screen: verdict and what binds, the worst shaft, Campbell diagram, critical speeds, stability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import panel as pn

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.jobs import Job
from trunnion.app.parts.widgets import Html, HtmlPane, column, items, joined, markup, pane, picture, small
from trunnion.app.views.base import VariantPane, View, ViewStep, at_speed, speed_range, unit_of
from trunnion.driveline.driveline import Driveline
from trunnion.pictures.picture import Picture
from trunnion.reporting.ranges import diagram_range

CAMPBELL_POINTS = 61
LOW = 2.0
"""Height of a picture on a tile [inches]."""
REST = 0.4
"""Seconds without a further change before the line is judged: sliders under way do not wait for that."""
MOST_CHECKS, MOST_SPEEDS = 4, 6
GRID = """
:host { display: grid !important; grid-template-columns: repeat(12, minmax(0, 1fr)); gap: 8px; }
.tile { grid-column: span 12; align-self: stretch !important; width: auto !important; height: auto !important; }
@media (min-width: 700px) { .of-stability { grid-column: span 7; } .of-speeds { grid-column: span 5; } }
@media (min-width: 1200px) {
  .of-verdict { grid-column: span 5; } .of-stability { grid-column: span 4; } .of-speeds { grid-column: span 3; }
  .of-orders, .of-campbell { grid-column: span 6; }
}
"""
TILE = """
:host { border: 1px solid var(--line); border-radius: 6px; padding: 0 8px 4px; background: var(--raised);
  overflow: hidden; }
"""
TITLE = """
.bk-btn { background: none !important; border: 0 !important; box-shadow: none !important;
  color: var(--accent) !important;
  font-size: 15px; font-weight: 600; padding: 4px 2px !important; text-align: left; }
.bk-btn:hover { text-decoration: underline; } .bk-btn:focus-visible { outline: 3px solid var(--focus); }
"""
UNCHECKED = "not yet checked"


class _DashboardPane(VariantPane["DashboardView"]):
    """Tiles; each opens the view that shows more."""

    def make(self) -> None:
        """Panes and places of the pictures, made once."""
        self.sketch, self.verdict, self.growth, self.near, self.crossings = (pane(margin=(0, 5)) for _ in range(5))
        self.torque, self.campbell = Canvas(), Canvas()
        self.worst = pane(margin=(0, 5))
        self.so_far: Html | str = ""
        tiles = {
            "verdict": ("Verdict", [self.verdict]),
            "stability": ("Stability", [self.growth, self.near]),
            "speeds": ("Critical speeds", [self.crossings]),
            "orders": ("The shaft loaded most", [self.worst, self.torque.panel]),
            "campbell": ("Campbell diagram", [self.campbell.panel]),
        }
        opened = {"speeds": "orders", "campbell": "orders"}
        line = self._tile("The line", "live", [self.sketch], "line")
        made = [self._tile(title, opened.get(key, key), inside, key) for key, (title, inside) in tiles.items()]
        self.panel = column(line, *made, stylesheets=[GRID])
        self.parts = {
            ("sketch",): [self.sketch],
            ("assessment",): [self.verdict],
            ("growth",): [self.growth],
            ("near",): [self.near],
            ("worst",): [self.worst, self.torque.panel],
            ("crossings",): [self.campbell.panel, self.crossings],
        }

    def _tile(self, title: str, view: str, inside: Sequence[Any], place: str) -> Any:
        button = pn.widgets.Button(label=f"{title} ›", button_type="default", stylesheets=[TITLE], margin=0)
        button.on_click(lambda event: self.view.session.show_view(view))
        return column(button, *inside, stylesheets=[TILE], css_classes=["tile", f"of-{place}"])

    def expect(self, wanted: Sequence[tuple[ViewStep, Job]], doubt: str) -> None:
        """Where the verdict is of another line, say so at once: it is not yet checked."""
        super().expect(wanted, doubt)
        if "assessment" in self.shown and self.is_current("assessment"):
            return
        self.shown.pop("assessment", None)
        self._unchecked()

    def _unchecked(self) -> None:
        said = markup("<p class='verdict' data-verdict='{0}'>{0}</p>", UNCHECKED)
        self.verdict.object = markup("{}{}", said, self.so_far) if self.so_far else said

    def show_sketch(self, step: ViewStep, svg: str) -> None:
        """The line as a picture."""
        about = "sketch of the driveline, elements numbered as in the table"
        self.sketch.object = markup("<div class='sketch'>{}</div>", picture(svg, about, 1000))

    def show_growth(self, step: ViewStep, data: Any) -> None:
        """Growth at the operating speed."""
        sign = "grows" if data["growth"] > 0 else "decays"
        said = f"{data['verdict']} at {data['speed']}: a disturbance {sign} by {abs(data['growth']):.4g} 1/s"
        self.growth.object = markup("<p class='figure' data-value='growth'>{}</p>", said)

    def show_near(self, step: ViewStep, data: Any) -> None:
        """How far the next speeds are at which a region of instability can begin."""
        self.near.object = items(data)

    def show_worst(self, step: ViewStep, data: Any) -> None:
        """The shaft loaded most, of the speeds looked at."""
        self.torque.show(low(data["picture"]))
        self.worst.object = small(markup("{}. The thick line: all orders together; red: its limits.", data["said"]))
        self.so_far = small(f"so far: {data['said']}")
        if "assessment" not in self.shown:
            self._unchecked()

    def show_crossings(self, step: ViewStep, data: Any) -> None:
        """Modes and what excites them, and where the two meet."""
        self.campbell.show(low(data["picture"]))
        rows = joined(markup("<tr><td>{}</td><td>{}</td><td>{}</td></tr>", *row) for row in data["rows"][:MOST_SPEEDS])
        head = markup("<tr><th>{}</th><th>mode</th><th>of</th></tr>", data["unit"])
        none = small("Nothing that excites the line meets a mode in its range.")
        self.crossings.object = markup("<table class='plain'>{}{}</table>", head, rows) if data["rows"] else none

    def show_assessment(self, step: ViewStep, data: Any) -> None:
        """The verdict, and the checks with the least margin."""
        kind = data["verdict"].replace(" ", "-")
        said = markup("<p class='verdict {0}' data-verdict='{0}'>{1}</p>", kind, data["sentence"])
        rows = [row for row in data["rows"] if str(row["margin"]).strip()][:MOST_CHECKS]
        cells = joined(
            markup(
                "<tr class='{2}'><td>{0}</td><td>{1}</td></tr>",
                row["check"],
                row["margin"],
                str(row["status"]).partition(",")[0],
            )
            for row in rows
        )
        self.verdict.object = markup("{}<table class='plain'>{}</table>", said, cells)

    def refused(self, step: ViewStep, sentence: str) -> None:
        """Why a tile is empty."""
        if step.show == "worst":
            self.torque.clear()
        if step.show == "crossings":
            self.campbell.clear()
        place = {
            "sketch": self.sketch, "growth": self.growth, "near": self.near, "worst": self.worst,
            "crossings": self.crossings, "assessment": self.verdict,
        }[step.show]  # fmt: skip
        place.object = small(sentence)


def low(whole: Picture) -> Picture:
    """The first panel alone, as high as a tile."""
    panel = replace(whole.panel, title="", key="")
    return replace(whole, panels=(panel,), columns=1, height=LOW, heights=(), shared=False)


class DashboardView(View):
    """All of it at a glance."""

    name = "dashboard"
    about = ""
    side = _DashboardPane

    def arrange(self) -> Any:
        """Nothing to set."""
        return HtmlPane("", height=0, margin=0)

    def steps(self, line: Driveline) -> list[ViewStep]:
        """What is quick first; the verdict, which takes longest, last."""
        low_end, high = speed_range(line)
        unit, _ = unit_of(line)
        speed = at_speed(line, None)
        speeds = Call("tn.sweep_speeds", (LINE, low_end, high))
        over = Call("np.linspace", (*diagram_range(low_end, high), CAMPBELL_POINTS))
        campbell = Call("tn.campbell_diagram", (LINE, over))
        shown = {"unit": unit}
        bare: dict[str, Any] = {"picture": "", "files": (), "soft": True}
        return [
            ViewStep("growth", Call("tn.stability", (LINE, speed)), "growth", shown, **bare),
            ViewStep("sketch", LINE, "sketch", **bare),
            ViewStep("torque", Call("tn.order_response", (LINE, speeds)), "worst", shown, lasting=True, **bare),
            ViewStep("campbell", campbell, "crossings", shown, lasting=True, **bare),
            ViewStep(
                "near", Call("tn.resonance_speeds", (LINE,)), "near", {**shown, "speed": speed}, lasting=True, **bare
            ),
            ViewStep(
                "assessment", Call("tn.assess", (LINE,)), "assessment", picture="", files=("csv", "nc"), title="checks",
                lasting=True, rest=REST, soft=True,
            ),
        ]  # fmt: skip

"""How far a parameter may go, what the binding checks follow most, which assembly errors matter most."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn

from trunnion.app import figures
from trunnion.app.calls import LINE, Call
from trunnion.app.curves import Curves
from trunnion.app.variants import kind_of, parameters, shown_unit
from trunnion.app.views.base import MOST_POINTS, Side, Step, View, bounded, count, number, select, speed_range, unit_of
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import pack
from trunnion.driveline.quantities import DEGREE

STABLE, RANKED, ASSEMBLY = "stable limit of a parameter", "what the checks follow most", "errors of assembly"


class LimitsView(View):
    """Stable limits, sensitivities, tolerances."""

    name = "limits"
    title = "Limits"
    about = (
        "The largest value of a parameter, from low to high, up to which the line is stable, speed by speed, and where "
        "limits of the description are reached before; the "
        "numbers that move the binding check most, ranked; which angle, off by a little, costs most uniformity."
    )
    defaults = {"what": STABLE, "parameter": "", "low": 0.0, "high": 0.0, "speeds": 31, "error": 1.0}

    def make_controls(self) -> Any:
        """What is asked, of which parameter, over which range."""
        self.ends = {key: self.bind(key, number(key, 0.0, width=120)) for key in ("low", "high")}
        return pn.FlexBox(
            self.bind("what", select("Limit", options=[STABLE, RANKED, ASSEMBLY], width=230)),
            self.bind("parameter", select("Parameter", options=[])),
            *self.ends.values(),
            self.bind("speeds", count("Speeds", 31, 2, MOST_POINTS)),
            self.bind("error", number("Error of assembly [deg]", 1.0, start=0.01, width=170)),
        )

    def adapt(self, line: Driveline) -> None:
        """Parameters of the line."""
        paths = parameters(line)
        if self.settings["parameter"] not in paths:
            self.settings["parameter"] = next((p for p in paths if p.endswith(".angle")), paths[0])
        self.choose("parameter", paths)
        unit, _ = self.unit(line)
        self.ends["low"].name = f"from [{unit}]"
        self.ends["high"].name = f"to [{unit}], 0: by itself"

    def unit(self, line: Driveline) -> tuple[str, float]:
        """The unit of the parameter, and its size in SI."""
        path = str(self.settings["parameter"])
        return shown_unit(kind_of(line, path), pack(line).value(path))

    def steps(self, line: Driveline) -> list[Step]:
        """The one that is asked for."""
        what = self.settings["what"]
        if what == RANKED:
            call = Call("tn.remedies", (LINE,), {"most": 1})
            return [Step("ranked", call, "ranked", picture="", files=("csv", "nc"), columns=("sensitivity",))]
        if what == ASSEMBLY:
            call = Call("tn.assembly_sensitivity", (LINE, float(self.settings["error"]) * DEGREE))
            return [Step("assembly", call, "assembly", picture="", files=())]
        path, (_, size) = str(self.settings["parameter"]), self.unit(line)
        low, high = float(self.settings["low"]) * size, float(self.settings["high"]) * size
        if not low < high:
            now = pack(line).value(path)
            high = 45 * DEGREE if path.endswith(".angle") else 4 * now if now > 0 else low + size
        speeds = Call("np.linspace", (*speed_range(line), bounded(self.settings["speeds"], 2)))
        call = Call("tn.stable_limit", (LINE, path, speeds), {"low": low, "high": high})
        columns = ("limit", "kind", "intervals", "usable", "binding", "reached")
        return [Step("limit", call, "limit", drawing={"unit": unit_of(line)[0]}, title="stable limit", columns=columns)]

    def side(self) -> Any:
        """A picture and a text."""
        return _Side(self)


class _Side(Side):
    def __init__(self, view: LimitsView) -> None:
        self.view = view
        self.curves = Curves("input speed", "limit")
        self.bars = figures.plot("", "", height=200, y_range=[], tools="")
        self.rows = figures.source(name=[], value=[])
        bar = self.bars.hbar(y="name", right="value", height=0.6, color=figures.BLUE, source=self.rows)
        figures.hover(self.bars, [bar], [("", "@name"), ("", "@value")])
        self.text = pn.pane.HTML("", sizing_mode="stretch_width")
        self.bars.visible = False
        self.bar_panel = pn.pane.Bokeh(self.bars, sizing_mode="stretch_width", visible=False)
        self.panel = pn.Column(self.curves.panel, self.bar_panel, self.text, sizing_mode="stretch_width", margin=0)

    def show(self, name: str, data: Any) -> None:
        """What was asked for."""
        for shown, panel, figure in (
            (name == "limit", self.curves.panel, self.curves.figure),
            (name != "limit", self.bar_panel, self.bars),
        ):
            panel.visible = figure.visible = shown
        self.text.object = f"<pre style='white-space:pre-wrap;font-size:13px'>{figures.text(data['text'])}</pre>"
        if name != "limit":
            order = np.argsort(-np.abs(np.asarray(data["value"])))[:16]
            names = [data["name"][i] for i in order]
            self.bars.y_range.factors = names[::-1]
            self.bars.height = 80 + 24 * len(names)
            self.bars.xaxis.axis_label = data["label"]
            self.rows.data = {"name": names, "value": [float(data["value"][i]) for i in order]}
            return
        line = self.view.line_of(self)
        (unit, size), (speed, factor) = self.view.unit(line), unit_of(line)
        path = str(self.view.settings["parameter"])
        x = data["speed"] * factor
        curves = [("stable below", x, data["limit"] / size)]
        curves += [(f"{name} reached", x, reached / size) for name, reached in data["others"]]
        curves.append(("the line now", x, np.full(len(x), pack(line).value(path) / size)))
        self.curves.set(
            curves,
            dashes=["solid"] * (len(curves) - 1) + ["dashed"],
            x=f"input speed [{speed}]",
            y=f"{path} [{unit}]",
            title=f"largest stable {path}",
        )

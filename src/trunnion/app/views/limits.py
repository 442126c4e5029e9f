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

STABLE, WINDOWS, TOLERANCES = "stable limit of a parameter", "stable windows of a parameter", "tolerances"
RANKED, ASSEMBLY = "what the checks follow most", "errors of assembly"
SCATTER = (".stiffness", ".inertia", ".damping", ".angle")
"""What scatters in a study of tolerances, where it is not zero."""
SAMPLES = 4096
"""Lines of such a study: the probability to within 1.5 % in the middle, and better at its ends."""


class LimitsView(View):
    """Stable limits, sensitivities, tolerances."""

    name = "limits"
    title = "Limits"
    about = (
        "The largest value of a parameter, from low to high, up to which the line is stable, speed by speed, and where "
        "limits of the description are reached before; all windows of it that keep every speed stable, with the "
        "regions between them; how probable stability is within tolerances of all stiffness, inertia, damping and "
        "angles; the numbers that move the binding check most, ranked; which angle, off by a little, costs most "
        "uniformity."
    )
    defaults = {
        "what": STABLE, "parameter": "", "low": 0.0, "high": 0.0, "speeds": 31, "error": 1.0, "tolerance": 5.0,
    }  # fmt: skip

    def make_controls(self) -> Any:
        """What is asked, of which parameter, over which range."""
        self.ends = {key: self.bind(key, number(key, 0.0, width=120)) for key in ("low", "high")}
        return pn.FlexBox(
            self.bind("what", select("Limit", options=[STABLE, WINDOWS, TOLERANCES, RANKED, ASSEMBLY], width=230)),
            self.bind("parameter", select("Parameter", options=[])),
            *self.ends.values(),
            self.bind("speeds", count("Speeds", 31, 2, MOST_POINTS)),
            self.bind("error", number("Error of assembly [deg]", 1.0, start=0.01, width=170)),
            self.bind("tolerance", number("Tolerance [±%]", 5.0, start=0.01, width=130)),
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
        if what == TOLERANCES:
            return [self._tolerances(line)]
        path, (_, size) = str(self.settings["parameter"]), self.unit(line)
        low, high = float(self.settings["low"]) * size, float(self.settings["high"]) * size
        if not low < high:
            now = pack(line).value(path)
            high = 45 * DEGREE if path.endswith(".angle") else 4 * now if now > 0 else low + size
        if what == WINDOWS:
            call = Call("tn.stable_windows", (LINE, path, low, high, speed_range(line)))
            drawing = {"unit": unit_of(line)[0]}
            return [Step("windows", call, "windows", drawing=drawing, title="stable windows")]
        speeds = Call("np.linspace", (*speed_range(line), bounded(self.settings["speeds"], 2)))
        call = Call("tn.stable_limit", (LINE, path, speeds), {"low": low, "high": high})
        columns = ("limit", "kind", "intervals", "usable", "binding", "reached")
        return [Step("limit", call, "limit", drawing={"unit": unit_of(line)[0]}, title="stable limit", columns=columns)]

    def _tolerances(self, line: Driveline) -> Step:
        """Uniform tolerances of everything that is not zero."""
        packed, share = pack(line), min(max(float(self.settings["tolerance"]), 0.01), 90.0) / 100
        scatter = {p: share for p in parameters(line) if p.endswith(SCATTER) and packed.value(p)}
        low, high = speed_range(line)
        speed = line.operation.speed if line.operation and line.operation.speed else (low + high) / 2
        call = Call("tn.tolerance_study", (LINE, scatter, float(speed)), {"samples": SAMPLES})
        return Step("tolerances", call, "tolerances", title="tolerances")

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
        drawn = name in ("limit", "windows")
        for shown, panel, figure in (
            (drawn, self.curves.panel, self.curves.figure),
            (not drawn, self.bar_panel, self.bars),
        ):
            panel.visible = figure.visible = shown
        self.text.object = f"<pre style='white-space:pre-wrap;font-size:13px'>{figures.text(data['text'])}</pre>"
        if not drawn:
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
        if name == "windows":
            self._windows(data, path, unit, size, speed, factor)
            return
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

    def _windows(self, data: Any, path: str, unit: str, size: float, speed: str, factor: float) -> None:
        """Outlines of the unstable regions, and the ends of the windows across."""
        span = np.array(data["speeds"]) * factor
        curves = [(name, x * factor, y / size) for name, x, y in data["regions"]]
        ends = [("end of a window", span, np.full(2, value / size)) for value in data["ends"]]
        now = ("the line now", span, np.full(2, pack(self.view.line_of(self)).value(path) / size))
        self.curves.set(
            [*curves, *ends, now],
            dashes=["solid"] * len(curves) + ["dotted"] * len(ends) + ["dashed"],
            colours=[figures.ORANGE] * len(curves) + [figures.INK] * len(ends) + [figures.BLUE],
            x=f"input speed [{speed}]",
            y=f"{path} [{unit}]",
            title=f"regions of instability and stable windows of {path}",
        )

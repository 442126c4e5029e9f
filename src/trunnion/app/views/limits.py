"""How far a parameter may go, what the binding checks follow most, which assembly errors matter most."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn

from trunnion.app.parts import figures
from trunnion.app.parts.axis import Axis
from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.curves import Curve, Curves
from trunnion.app.parts.pieces import column, pane, pre, wrapped
from trunnion.app.parts.variants import parameters, shown_unit, with_number
from trunnion.app.views.base import (
    MOST_POINTS,
    Setting,
    Side,
    Step,
    View,
    at_speed,
    bounded,
    count,
    number,
    optional,
    select,
    speed_range,
    springs_of,
    tell_default,
    unit_of,
)
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import pack
from trunnion.driveline.quantities import DEGREE

STABLE, WINDOWS, TOLERANCES = "stable limit of a parameter", "stable windows of a parameter", "tolerances"
RANKED, ASSEMBLY = "what the checks follow most", "errors of assembly"
BEST = "best value of a parameter"
ASKS = {
    STABLE: ("parameter", "low", "high", "speeds"),
    WINDOWS: ("parameter", "low", "high"),
    TOLERANCES: ("tolerance",),
    RANKED: (),
    ASSEMBLY: ("error",),
    BEST: ("parameter", "low", "high", "aim"),
}
"""Which controls a question has."""
SAYS = {
    STABLE: "The largest value up to which the line is stable at every speed, at some of them one by one, and where "
    "limits come first.",
    WINDOWS: "All ranges of the parameter that keep every speed stable, and the unstable regions between them.",
    TOLERANCES: "How probable stability at the operating speed is while stiffness, inertia, damping, angles scatter.",
    RANKED: "The numbers that move the check that binds most, ranked.",
    ASSEMBLY: "Which angle, off by a little, costs most uniformity.",
    BEST: "The value, within bounds, that is best in an aim while limits and ratings hold.",
}
"""What a question asks."""
AIMS = ("least spare margin", "irregularity", "growth rate")
DESIGNS = 40
"""Lines computed in the search for one best value."""
MOST_BARS = 16
SCATTER = (".stiffness", ".inertia", ".damping", ".angle")
"""What scatters in a study of tolerances, where it is not zero."""
AT_SPEEDS, AT_END = "largest stable at single speeds", "stable up to the end searched"
OTHERS = (figures.GREEN, figures.PINK, figures.SKY, figures.YELLOW)
"""Colours of the limits beside stability."""
SAMPLES = 4096
"""Lines of such a study: the probability to within 1.5 % in the middle, and better at its ends."""


class _Side(Side["LimitsView"]):
    """A picture and a text."""

    def make(self) -> None:
        """Panes and figures, made once."""
        self.curves = Curves("input speed", "limit")
        self.curves.mark(AT_SPEEDS, "circle", figures.INK)
        self.curves.mark(AT_END, "triangle", figures.FAINT)
        self.bars = figures.plot("", "", height=200, y_range=[], tools="")
        self.rows = figures.source(name=[], value=[])
        bar = self.bars.hbar(y="name", right="value", height=0.6, color=figures.BLUE, source=self.rows)
        figures.hover(self.bars, [bar], [("", "@name"), ("", "@value")])
        self.text = pane()
        self.bars.visible = False
        self.bar_panel = pn.pane.Bokeh(self.bars, sizing_mode="stretch_width", visible=False)
        self.panel = column(self.curves.panel, self.bar_panel, self.text)
        kinds = ("best", "tolerances", "ranked", "assembly", "limit", "windows")
        self.parts = {kinds: [self.curves.panel, self.bar_panel, self.text]}

    def clear(self) -> None:
        """Show neither picture."""
        self.curves.panel.visible = self.bar_panel.visible = False
        self.text.object = ""

    def show_best(self, step: Step, data: Any) -> None:
        """The best value in words, and for the button."""
        self.text.object = pre(data["text"])
        if self.variant == "now":
            self.view.found(step.options["path"], data["value"])

    def _bars(self, step: Step, data: Any) -> None:
        """What matters most, the largest on top."""
        self._picture(data, drawn=False)
        order = np.argsort(-np.abs(np.asarray(data["value"])))[:MOST_BARS]
        rows = [(data["name"][i], float(data["value"][i])) for i in order]
        self.bars.y_range.factors = [name for name, _ in reversed(rows)]
        self.bars.height = 80 + 24 * len(rows)
        self.bars.xaxis.axis_label = data["label"]
        figures.put_rows(self.rows, rows)

    show_tolerances = show_ranked = show_assembly = _bars

    def show_limit(self, step: Step, data: Any) -> None:
        """How far the parameter may go."""
        self._over_speed(data, "largest stable")

    def show_windows(self, step: Step, data: Any) -> None:
        """Where it may be."""
        self._over_speed(data, "regions of instability and stable windows of")

    def _picture(self, data: Any, drawn: bool) -> None:
        """The words, and the curves or else the bars."""
        self.text.object = pre(data["text"])
        self.curves.panel.visible = self.curves.figure.visible = drawn
        self.bar_panel.visible = self.bars.visible = not drawn

    def _over_speed(self, data: Any, title: str) -> None:
        """The unstable regions, the ends of what is stable at every speed, and the limits at single speeds.

        The limits at single speeds are marks: a line through them would claim what lies between."""
        self._picture(data, drawn=True)
        axis, (speed_unit, factor) = self.view.axis(self.line), unit_of(self.line)
        path, size = axis.path, axis.size
        span = np.array(data["speeds"]) * factor

        def level(name: str, value: float, colour: str, dash: str) -> Curve:
            return Curve(name, span, np.full(2, value / size), colour, dash)

        curves = [Curve(name, x * factor, y / size, figures.ORANGE, "solid") for name, x, y in data["regions"]]
        self.curves.fill([(one.x, one.y) for one in curves])
        curves += [level("end of stable at every speed", value, figures.INK, "dotted") for value in data["ends"]]
        for k, (name, values) in enumerate(data.get("others", ())):
            colour, dash = OTHERS[k % len(OTHERS)], figures.DASHES[k // len(OTHERS) % 4]
            curves.append(Curve(f"{name} reached", data["speed"] * factor, values / size, colour, dash))
        curves.append(level("the line now", pack(self.line).value(path), figures.BLUE, "dashed"))
        self.curves.set(curves, x=f"input speed [{speed_unit}]", y=axis.label, title=f"{title} {path}")
        speed, limit = (np.asarray(data.get(key, ())) for key in ("speed", "limit"))
        at_end = limit >= data.get("high", np.inf)
        for name, which in ((AT_SPEEDS, ~at_end), (AT_END, at_end)):
            self.curves.put_marks(name, speed[which] * factor, limit[which] / size)


class LimitsView(View):
    """Stable limits, sensitivities, tolerances."""

    name = "limits"
    about = "How far a number may go, how sure that is, and which numbers matter most."
    side = _Side
    asks, asked_by = ASKS, ("what",)
    defaults = {
        "what": STABLE, "parameter": "", "low": None, "high": None, "speeds": 31, "error": 1.0, "tolerance": 5.0,
        "aim": AIMS[0],
    }  # fmt: skip

    fields = {
        "what": lambda: select("Limit", options=list(ASKS), width=230),
        "parameter": lambda: select("Parameter", options=[]),
        "low": lambda: optional("low"),
        "high": lambda: optional("high"),
        "speeds": lambda: count("Speeds", 31, 2, MOST_POINTS),
        "error": lambda: number("Error of assembly [deg]", 1.0, start=0.01, width=170),
        "tolerance": lambda: number("Tolerance [±%]", 5.0, start=0.01),
        "aim": lambda: select("Best in", options=list(AIMS), width=260),
    }

    def arrange(self) -> Any:
        """What is asked, of which parameter, over which range."""
        self.use = pn.widgets.Button(label="Use the best value", width=160, align="end", disabled=True)
        self.use.on_click(lambda event: self._use())
        self.says = pane(margin=(0, 5))
        return column(wrapped(*self.widgets.values(), self.use), self.says)

    def adapt(self, line: Driveline) -> None:
        """Parameters of the line."""
        paths = parameters(line)
        if self.settings["parameter"] not in paths:
            self.settings["parameter"] = next((p for p in paths if p.endswith(".angle")), paths[0])
        self.choose("parameter", paths)
        axis = self.axis(line)
        for key, word, value in zip(("low", "high"), ("from", "to"), axis.ends, strict=True):
            self.widgets[key].label = f"{word} [{axis.unit}]"
            tell_default(self.widgets[key], value)
        torques = [f"{kind} torque of {n}" for n in springs_of(line) for kind in ("vibratory", "peak")]
        self.choose("aim", [*AIMS, *torques])
        self.best: tuple[str, float] | None = None
        self.show_question()

    def show_question(self) -> None:
        """And what it asks, and the button that belongs to one of them."""
        super().show_question()
        what = self.widgets["what"].value
        self.use.visible, self.use.disabled = what == BEST, True
        self.says.object = SAYS[what]

    def chosen(self, key: str, value: Setting) -> None:
        """A best value that was found for other settings is not this question's."""
        self.best, self.use.disabled = None, True
        super().chosen(key, value)

    def found(self, path: str, value: float) -> None:
        """The best value of a parameter in SI units, which the button takes over."""
        self.best, self.use.disabled = (path, value), False

    def _use(self) -> None:
        if self.best is not None:
            line = with_number(self.session.document.line, *self.best)
            self.session.edit(lambda document: document.set_numbers(line))

    def axis(self, line: Driveline) -> Axis:
        """The parameter with ends by themselves."""
        path = str(self.settings["parameter"])
        (unit, size), now = shown_unit(line, path), pack(line).value(path)
        if path.endswith(".angle"):
            return Axis(path, 0.0, 45 * DEGREE, unit, size)
        if unit == "deg":
            return Axis(path, -90 * DEGREE, 90 * DEGREE, unit, size)
        return Axis(path, 0.0, 4 * now if now > 0 else size, unit, size)

    def steps(self, line: Driveline) -> list[Step]:
        """The one that is asked for."""
        what = self.settings["what"]
        if what == RANKED:
            call = Call("tn.remedies", (LINE,), {"most": 1})
            return [Step("ranked", call, "ranked", picture="", files=("csv", "nc"), columns=("sensitivity",))]
        if what == ASSEMBLY:
            call = Call("tn.assembly_sensitivity", (LINE, self.value("error") * DEGREE))
            return [Step("assembly", call, "assembly", picture="", files=())]
        if what == TOLERANCES:
            return [self._tolerances(line)]
        axis = self.axis(line).typed(self.typed("low"), self.typed("high"))
        axis.require_rising()
        path, low, high = axis.path, axis.low, axis.high
        if what == BEST:
            free = {path: (low, high)}
            call = Call("tn.optimise", (LINE, free, str(self.settings["aim"])), {"designs": DESIGNS})
            return [Step("best", call, "best", {"path": path}, picture="", files=("csv", "nc"),
                         columns=("low", "high", "before", "value"), title="best value")]  # fmt: skip
        if what == WINDOWS:
            call = Call("tn.stable_windows", (LINE, path, low, high, speed_range(line)))
            drawing = {"unit": unit_of(line)[0]}
            return [Step("windows", call, "windows", drawing=drawing, title="stable windows")]
        speeds = Call("np.linspace", (*speed_range(line), bounded(self.settings["speeds"], 2)))
        call = Call("tn.stable_limit", (LINE, path, speeds), {"low": low, "high": high, "margin": 0.0})
        columns = ("limit", "kind", "intervals", "usable", "binding", "reached")
        return [Step("limit", call, "limit", drawing={"unit": unit_of(line)[0]}, title="stable limit", columns=columns)]

    def _tolerances(self, line: Driveline) -> Step:
        """Uniform tolerances of everything that is not zero."""
        packed, share = pack(line), min(max(self.value("tolerance"), 0.01), 90.0) / 100
        scatter = {p: share for p in parameters(line) if p.endswith(SCATTER) and packed.value(p)}
        call = Call("tn.tolerance_study", (LINE, scatter, at_speed(line, None)), {"samples": SAMPLES})
        return Step("tolerances", call, "tolerances", title="tolerances")

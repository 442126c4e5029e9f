"""How far a parameter may go, what the binding checks follow most, which assembly errors matter most."""

from __future__ import annotations

from typing import Any

import panel as pn

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.parameter_range import ParameterRange
from trunnion.app.parts.variants import parameters, shown_unit, with_number
from trunnion.app.parts.widgets import column, pane, pre, wrapped
from trunnion.app.views.base import (
    MOST_POINTS,
    Setting,
    VariantPane,
    View,
    ViewStep,
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
SCATTER = (".stiffness", ".inertia", ".damping", ".angle")
"""What scatters in a study of tolerances, where it is not zero."""
SAMPLES = 4096
"""Lines of such a study: the probability to within 1.5 % in the middle, and better at its ends."""


class _LimitsPane(VariantPane["LimitsView"]):
    """A picture and a text."""

    def make(self) -> None:
        """Place of the picture, and the words below it."""
        self.picture, self.text = Canvas(), pane()
        self.panel = column(self.picture.panel, self.text)
        kinds = ("best", "tolerances", "ranked", "assembly", "limit", "windows")
        self.parts = {kinds: [self.picture.panel, self.text]}

    def clear(self) -> None:
        """Show nothing."""
        self.picture.clear()
        self.text.object = ""

    def show_best(self, step: ViewStep, data: Any) -> None:
        """The best value in words, and for the button."""
        self.text.object = pre(data["text"])
        if self.variant == "now":
            self.view.found(step.options["path"], data["value"])

    def _show(self, step: ViewStep, data: Any) -> None:
        self.text.object = pre(data["text"])
        if data["picture"] is None:
            self.picture.clear()
        else:
            self.picture.show(data["picture"])

    show_limit = show_windows = show_tolerances = show_ranked = show_assembly = _show


class LimitsView(View):
    """Stable limits, sensitivities, tolerances."""

    name = "limits"
    about = "How far a number may go, how sure that is, and which numbers matter most."
    side = _LimitsPane
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

    def axis(self, line: Driveline) -> ParameterRange:
        """The parameter with ends by themselves."""
        path = str(self.settings["parameter"])
        (unit, size), now = shown_unit(line, path), pack(line).value(path)
        if path.endswith(".angle"):
            return ParameterRange(path, 0.0, 45 * DEGREE, unit, size)
        if unit == "deg":
            return ParameterRange(path, -90 * DEGREE, 90 * DEGREE, unit, size)
        return ParameterRange(path, 0.0, 4 * now if now > 0 else size, unit, size)

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The one that is asked for."""
        what = self.settings["what"]
        if what == RANKED:
            call = Call("tn.remedies", (LINE,), {"most": 1})
            return [ViewStep("ranked", call, "ranked", picture="", files=("csv", "nc"), columns=("sensitivity",))]
        if what == ASSEMBLY:
            call = Call("tn.assembly_sensitivity", (LINE, self.value("error") * DEGREE))
            return [ViewStep("assembly", call, "assembly", picture="", files=())]
        if what == TOLERANCES:
            return [self._tolerances(line)]
        axis = self.axis(line).typed(self.typed("low"), self.typed("high"))
        axis.require_rising()
        path, low, high, unit = axis.path, axis.low, axis.high, {"unit": unit_of(line)[0]}
        now = {"now": pack(line).value(path)}
        if what == BEST:
            free = {path: (low, high)}
            call = Call("tn.optimise", (LINE, free, str(self.settings["aim"])), {"designs": DESIGNS})
            return [ViewStep("best", call, "best", {"path": path}, picture="", files=("csv", "nc"),
                         columns=("low", "high", "before", "value"), title="best value")]  # fmt: skip
        if what == WINDOWS:
            call = Call("tn.stable_windows", (LINE, path, low, high, speed_range(line)))
            return [ViewStep("windows", call, "windows", unit | now, drawing=unit, title="stable windows")]
        speeds = Call("np.linspace", (*speed_range(line), bounded(self.settings["speeds"], 2)))
        call = Call("tn.stable_limit", (LINE, path, speeds), {"low": low, "high": high, "margin": 0.0})
        columns = ("limit", "kind", "intervals", "usable", "binding", "reached")
        return [ViewStep("limit", call, "limit", unit | now, drawing=unit, title="stable limit", columns=columns)]

    def _tolerances(self, line: Driveline) -> ViewStep:
        """Uniform tolerances of everything that is not zero."""
        packed, share = pack(line), min(max(self.value("tolerance"), 0.01), 90.0) / 100
        scatter = {p: share for p in parameters(line) if p.endswith(SCATTER) and packed.value(p)}
        call = Call("tn.tolerance_study", (LINE, scatter, at_speed(line, None)), {"samples": SAMPLES})
        return ViewStep("tolerances", call, "tolerances", title="tolerances")

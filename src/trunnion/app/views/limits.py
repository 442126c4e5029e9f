"""How far a parameter may go, what the binding checks follow most, which assembly errors matter most."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn

from trunnion.analyses.linear.forced_response import shaft_names
from trunnion.app import figures
from trunnion.app.calls import LINE, Call
from trunnion.app.curves import Curves
from trunnion.app.variants import kind_of, parameters, shown_unit, with_number
from trunnion.app.views.base import (
    MOST_POINTS,
    Side,
    Step,
    View,
    bounded,
    count,
    number,
    optional,
    select,
    speed_range,
    tell_default,
    unit_of,
)
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import pack
from trunnion.driveline.quantities import DEGREE
from trunnion.equations.coefficients import assemble
from trunnion.errors import InputError

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
AT_SPEEDS, AT_END = "largest stable at single speeds", "stable up to the end searched"
OTHERS = (figures.GREEN, figures.PINK, figures.SKY, figures.YELLOW)
"""Colours of the limits beside stability."""
SAMPLES = 4096
"""Lines of such a study: the probability to within 1.5 % in the middle, and better at its ends."""


class LimitsView(View):
    """Stable limits, sensitivities, tolerances."""

    name = "limits"
    title = "Limits"
    about = "How far a number may go, how sure that is, and which numbers matter most."
    defaults = {
        "what": STABLE, "parameter": "", "low": None, "high": None, "speeds": 31, "error": 1.0, "tolerance": 5.0,
        "aim": AIMS[0],
    }  # fmt: skip

    def make_controls(self) -> Any:
        """What is asked, of which parameter, over which range."""
        what = self.bind("what", select("Limit", options=list(ASKS), width=230))
        what.param.watch(lambda event: self._ask(), "value")
        self.bind("parameter", select("Parameter", options=[]))
        for key in ("low", "high"):
            self.bind(key, optional(key, width=130))
        self.bind("speeds", count("Speeds", 31, 2, MOST_POINTS))
        self.bind("error", number("Error of assembly [deg]", 1.0, start=0.01, width=170))
        self.bind("tolerance", number("Tolerance [±%]", 5.0, start=0.01, width=130))
        self.bind("aim", select("Best in", options=list(AIMS), width=260))
        self.use = pn.widgets.Button(label="Use the best value", width=160, align="end", disabled=True)
        self.use.on_click(lambda event: self._use())
        self.says = pn.pane.HTML("", sizing_mode="stretch_width", margin=(0, 5))
        row = pn.FlexBox(*self.widgets.values(), self.use)
        return pn.Column(row, self.says, sizing_mode="stretch_width", margin=0)

    def adapt(self, line: Driveline) -> None:
        """Parameters of the line."""
        paths = parameters(line)
        if self.settings["parameter"] not in paths:
            self.settings["parameter"] = next((p for p in paths if p.endswith(".angle")), paths[0])
        self.choose("parameter", paths)
        unit, size = self.unit(line)
        for key, word, value in zip(("low", "high"), ("from", "to"), self._own_ends(line), strict=True):
            self.widgets[key].label = f"{word} [{unit}]"
            tell_default(self.widgets[key], value / size)
        torques = [f"{kind} torque of {n}" for n in shaft_names(assemble(line)) for kind in ("vibratory", "peak")]
        self.choose("aim", [*AIMS, *torques])
        self.best: float | None = None
        self._ask()

    def _ask(self) -> None:
        """Show the controls of the question, and nothing of another one."""
        what = str(self.widgets["what"].value)
        for key, widget in self.widgets.items():
            widget.visible = key == "what" or key in ASKS[what]
        self.use.visible, self.use.disabled = what == BEST, True
        self.says.object = SAYS[what]
        for side in self.sides.values():
            assert isinstance(side, _Side)
            side.begin(what)

    def found(self, value: float) -> None:
        """The best value of the parameter in SI units, which the button takes over."""
        self.best, self.use.disabled = value, False

    def _use(self) -> None:
        if self.best is not None:
            line = with_number(self.session.document.line, str(self.settings["parameter"]), self.best)
            self.session.edit(lambda document: document.set_numbers(line))

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
            call = Call("tn.assembly_sensitivity", (LINE, self.value("error") * DEGREE))
            return [Step("assembly", call, "assembly", picture="", files=())]
        if what == TOLERANCES:
            return [self._tolerances(line)]
        path, (low, high) = str(self.settings["parameter"]), self.range(line)
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

    def range(self, line: Driveline) -> tuple[float, float]:
        """Ends of the parameter in SI units: as typed, or by themselves.

        Raises
        ------
        InputError : they do not rise.
        """
        (_, size), (low, high) = self.unit(line), self._own_ends(line)
        first, last = self.typed("low"), self.typed("high")
        low, high = low if first is None else first * size, high if last is None else last * size
        if not low < high:
            problem, remedy = (
                f"runs from {low / size:g} to {high / size:g}",
                "type two ends that rise, or leave the fields empty",
            )
            raise InputError(problem, key=str(self.settings["parameter"]), remedy=remedy)
        return low, high

    def _own_ends(self, line: Driveline) -> tuple[float, float]:
        path, (unit, size) = str(self.settings["parameter"]), self.unit(line)
        now = pack(line).value(path)
        if path.endswith(".angle"):
            return 0.0, 45 * DEGREE
        if unit == "deg":
            return -90 * DEGREE, 90 * DEGREE
        return 0.0, 4 * now if now > 0 else size

    def _tolerances(self, line: Driveline) -> Step:
        """Uniform tolerances of everything that is not zero."""
        packed, share = pack(line), min(max(self.value("tolerance"), 0.01), 90.0) / 100
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
        self.curves.mark(AT_SPEEDS, "circle", figures.INK)
        self.curves.mark(AT_END, "triangle", figures.FAINT)
        self.bars = figures.plot("", "", height=200, y_range=[], tools="")
        self.rows = figures.source(name=[], value=[])
        bar = self.bars.hbar(y="name", right="value", height=0.6, color=figures.BLUE, source=self.rows)
        figures.hover(self.bars, [bar], [("", "@name"), ("", "@value")])
        self.text = pn.pane.HTML("", sizing_mode="stretch_width")
        self.bars.visible = False
        self.bar_panel = pn.pane.Bokeh(self.bars, sizing_mode="stretch_width", visible=False)
        self.panel = pn.Column(self.curves.panel, self.bar_panel, self.text, sizing_mode="stretch_width", margin=0)
        self.what = ""
        self.begin(str(view.settings["what"]))

    def begin(self, what: str) -> None:
        """Forget what belongs to another question."""
        if what != self.what:
            self.what = what
            self.curves.panel.visible = self.bar_panel.visible = False
            self.text.object = ""

    def show(self, name: str, data: Any) -> None:
        """What was asked for."""
        self.text.object = f"<pre>{figures.text(data['text'])}</pre>"
        if name == "best":
            if self.variant == "now":
                self.view.found(data["value"])
            return
        drawn = name in ("limit", "windows")
        for shown, panel, figure in (
            (drawn, self.curves.panel, self.curves.figure),
            (not drawn, self.bar_panel, self.bars),
        ):
            panel.visible = figure.visible = shown
        if not drawn:
            order = np.argsort(-np.abs(np.asarray(data["value"])))[:16]
            names = [data["name"][i] for i in order]
            self.bars.y_range.factors = names[::-1]
            self.bars.height = 80 + 24 * len(names)
            self.bars.xaxis.axis_label = data["label"]
            figures.put(self.rows, {"name": names, "value": [float(data["value"][i]) for i in order]})
            return
        line = self.view.line_of(self)
        (unit, size), (speed, factor) = self.view.unit(line), unit_of(line)
        path = str(self.view.settings["parameter"])
        now = pack(line).value(path) / size
        self._over_speed(data, now, size, factor)
        title = "regions of instability and stable windows of" if name == "windows" else "largest stable"
        figure = self.curves.figure
        self.curves.title(f"{title} {path}")
        figure.xaxis.axis_label, figure.yaxis.axis_label = f"input speed [{speed}]", f"{path} [{unit}]"

    def _over_speed(self, data: Any, now: float, size: float, factor: float) -> None:
        """The unstable regions, the ends of what is stable at every speed, and the limits at single speeds.

        The limits at single speeds are marks: a line through them would claim what lies between."""
        span = np.array(data["speeds"]) * factor
        curves = [(name, x * factor, y / size) for name, x, y in data["regions"]]
        ends = [("end of stable at every speed", span, np.full(2, value / size)) for value in data["ends"]]
        others = [(f"{name} reached", data["speed"] * factor, v / size) for name, v in data.get("others", ())]
        looks = [(figures.ORANGE, "solid")] * len(curves) + [(figures.INK, "dotted")] * len(ends)
        looks += [(OTHERS[k % len(OTHERS)], figures.DASHES[k // len(OTHERS) % 4]) for k in range(len(others))]
        looks.append((figures.BLUE, "dashed"))
        self.curves.set(
            [*curves, *ends, *others, ("the line now", span, np.full(2, now))],
            colours=[colour for colour, _ in looks],
            dashes=[dash for _, dash in looks],
        )
        self.curves.fill([(x, y) for _, x, y in curves])
        speed, limit = (np.asarray(data.get(key, ())) for key in ("speed", "limit"))
        at_end = limit >= data.get("high", np.inf)
        for name, which in ((AT_SPEEDS, ~at_end), (AT_END, at_end)):
            self.curves.put_marks(name, speed[which] * factor, limit[which] / size)

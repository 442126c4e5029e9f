"""True motion: periodic response beside linear theory, run-up, transients, rattle, Poincaré map, exponents, chaos."""

from __future__ import annotations

from typing import Any

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.widgets import column, joined, pane, pre
from trunnion.app.views.base import (
    VariantPane,
    View,
    ViewStep,
    at_speed,
    bounded,
    count,
    label_speed,
    number,
    optional,
    select,
    speed_range,
    springs_of,
    unit_of,
)
from trunnion.driveline.driveline import Driveline
from trunnion.pictures.picture import Axis, single

PERIODIC, RUN_UP, TRANSIENT, RATTLE = "periodic response", "run-up", "transient", "rattle over speed"
PASSING, FATIGUE = "passed or captured", "fatigue"
POINCARE, EXPONENTS, CHAOS = "Poincaré map", "Lyapunov exponents", "is it chaos?"
MOTIONS = {
    PERIODIC: "periodic",
    RUN_UP: "run-up",
    TRANSIENT: "transient",
    PASSING: "passing",
    FATIGUE: "fatigue",
    RATTLE: "rattle",
    POINCARE: "section",
    EXPONENTS: "exponents",
    CHAOS: "chaos",
}
ASKS = {
    "periodic": ("speed",),
    "run-up": ("rate", "spring"),
    "transient": ("scenario",),
    "passing": ("scenario",),
    "fatigue": (),
    "rattle": ("spring", "points"),
    "section": ("of", "speed", "returns"),
    "exponents": ("of", "speed"),
    "chaos": ("of", "speed"),
}
"""Which controls a motion has."""
OF_LINE = "line"
SYSTEMS: dict[str, Call] = {
    "double-tripod": Call("system", ("input",), of=Call("tn.catalogue", ("double-tripod",))),
    "double-tripod-output": Call("system", ("output",), of=Call("tn.catalogue", ("double-tripod",))),
    "gear-rattle": Call("as_system", of=Call("tn.catalogue", ("gear-rattle",))),
}
"""Published equations that are not a driveline, for the motions that take any system."""
SUBJECTS = {
    "this driveline": OF_LINE,
    "double tripod, input element (catalogue)": "double-tripod",
    "double tripod, output element (catalogue)": "double-tripod-output",
    "gear pair with backlash (catalogue)": "gear-rattle",
}
SECTIONS = {"double-tripod-output": Call("tn.Event", ("rate", 0.0), {"direction": -1})}
"""Where the map of equations without a period of forcing is taken: where the rotation turns back."""
METHODS = ("exact", "shooting", "harmonic balance")
"""By which a response is followed over speed."""
SWEEPS = {"up": "sweep up", "down": "sweep down"}


class _MotionPane(VariantPane["MotionView"]):
    """The picture of the result, and its text."""

    def make(self) -> None:
        """Places of picture and words, made once."""
        self.picture, self.text = Canvas(), pane()
        self.panel = column(self.picture.panel, self.text)
        self.parts = {("plotted", "run_up", "swept", "followed"): [self.picture.panel, self.text]}
        self.found: dict[str, Any] = {}

    def clear(self) -> None:
        """No picture, no words."""
        self.found = {}
        self.picture.clear()
        self.text.object = ""

    def show_plotted(self, step: ViewStep, data: Any) -> None:
        """The picture of the result, and how it prints."""
        self.picture.show(data["picture"])
        self.text.object = pre(data["text"])

    show_run_up = show_plotted

    def refused(self, step: ViewStep, sentence: str) -> None:
        """Why a soft step gave nothing."""
        if step.name == "run_up":
            self.text.object += pre(f"no steady motions beside it: {sentence}")
        else:
            self._rattle(step, {"items": [], "text": sentence})

    def _rattle(self, step: ViewStep, data: Any) -> None:
        """All methods on one picture; what each said below."""
        asked = {one.name: one.title for one in self.view.steps(self.line)}
        if step.name == next(iter(asked)):
            self.found = {}
        self.found[step.name] = data
        done = [name for name in asked if name in self.found]
        across, up = Axis("input speed", unit_of(self.line)[0]), Axis("half peak-to-peak torque", "N m", 0.0)
        title = f"vibration of {self.view.settings['spring']} by every method"
        self.picture.show(single(across, up, [i for name in done for i in self.found[name]["items"]], title=title))
        self.text.object = joined(pre(f"{asked[name]}\n{self.found[name]['text']}") for name in done)

    show_swept = show_followed = _rattle


class MotionView(View):
    """One motion at a time; some take long, and can be cancelled."""

    name = "motion"
    about = (
        "Motions of the line with everything that linear theory leaves out. Long computations can be cancelled; what "
        "is found by then stays."
    )
    side = _MotionPane
    asks, asked_by = ASKS, ("what", "of")
    defaults = {
        "what": "periodic",
        "of": OF_LINE,
        "speed": None,
        "rate": 100.0,
        "points": 40,
        "spring": "",
        "scenario": "",
        "returns": 400,
    }

    fields = {
        "what": lambda: select("Motion", options=MOTIONS),
        "of": lambda: select("Motion of", options=SUBJECTS, width=290),
        "speed": lambda: optional("Speed", start=0.0, width=170),
        "rate": lambda: number("Acceleration [rad/s²]", 100.0, start=0.01, width=170),
        "spring": lambda: select("Torque of", options=[]),
        "scenario": lambda: select("Scenario of the file", options=[]),
        "points": lambda: count("Points of a sweep", 40, 2, 400),
        "returns": lambda: count("Points of the map", 400, 10, 20_000),
    }

    def adapt(self, line: Driveline) -> None:
        """The unit of speeds, the shafts."""
        label_speed(self.widgets["speed"], line)
        self.choose("spring", springs_of(line))
        self.choose("scenario", [one.name for one in line.scenarios])
        self.show_question()

    def show_question(self) -> None:
        """And no speed for equations that have none."""
        super().show_question()
        of = self.widgets["of"]
        self.widgets["speed"].visible &= not of.visible or of.value == OF_LINE

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The motion that is asked for."""
        speed = at_speed(line, self.typed("speed"))
        subject, at = self._subject(speed)
        match self.settings["what"]:
            case "run-up":
                return self._run_up(line)
            case "transient":
                shown = {"unit": unit_of(line)[0]}
                call = Call("tn.transient", (LINE, str(self.settings["scenario"])))
                return [ViewStep("transient", call, "plotted", shown, drawing=shown, title=TRANSIENT)]
            case "passing":
                shown = {"unit": unit_of(line)[0]}
                acting = {"scenario": str(self.settings["scenario"]) or None}
                call = Call("tn.passing", (LINE, speed_range(line)), acting)
                return [ViewStep("passing", call, "plotted", shown, drawing=shown, title=PASSING)]
            case "fatigue":
                return [ViewStep("fatigue", Call("tn.fatigue", (LINE,)), "plotted", title=FATIGUE)]
            case "rattle":
                return self._rattle(line)
            case "section":
                returns = bounded(self.settings["returns"], 10, 20_000)
                of = str(self.settings["of"])
                section = {"section": SECTIONS[of]} if of in SECTIONS else {}
                call = Call("tn.poincare_map", (subject, returns), {**at, **section})
                return [ViewStep("map", call, "plotted", title=POINCARE)]
            case "exponents":
                call = Call("tn.lyapunov_spectrum", (subject,), at)
                return [ViewStep("exponents", call, "plotted", title=EXPONENTS)]
            case "chaos":
                call = Call("tn.certify_chaos", (subject,), {**at, "sweep": False})
                return [ViewStep("certificate", call, "plotted", title="verdict on chaos", files=("nc",))]
        unit = {"unit": unit_of(line)[0]}
        call = Call("tn.periodic_response", (LINE, speed))
        return [ViewStep("periodic", call, "plotted", unit, drawing=unit, title=PERIODIC)]

    def _subject(self, speed: float) -> tuple[Any, dict[str, float]]:
        """What moves, and the speed for it: equations have a frequency of their own."""
        system = SYSTEMS.get(str(self.settings["of"]))
        return (LINE, {"speed": speed}) if system is None else (system, {})

    def _run_up(self, line: Driveline) -> list[ViewStep]:
        """The run-up alone at first, since the steady motions beside it may take long."""
        ends, rate = speed_range(line), {"acceleration": self.value("rate")}
        alone = Call("tn.run_up", (LINE, *ends), {**rate, "steady": 0})
        whole = Call("tn.run_up", (LINE, *ends), rate)
        shown = {"unit": unit_of(line)[0], "shaft": str(self.settings["spring"])}
        return [
            ViewStep("alone", alone, "run_up", shown, picture="", files=()),
            ViewStep("run_up", whole, "run_up", shown, drawing=shown, title=RUN_UP, soft=True),
        ]

    def _rattle(self, line: Driveline) -> list[ViewStep]:
        """Sweeps up and down, and the response followed by every method that there is for the line."""
        (low, high), spring = speed_range(line), str(self.settings["spring"])
        points = bounded(self.settings["points"], 2)
        ends = {"up": (low, high), "down": (high, low)}
        steps = [
            ViewStep(f"sweep_{way}", Call("tn.sweep", (LINE, Call("np.linspace", (*ends[way], points)))), "swept",
                 {"spring": spring, "name": name, "unit": unit_of(line)[0]}, title=name, soft=True)
            for way, name in SWEEPS.items()
        ]  # fmt: skip
        from trunnion.motion.orbits.frequency_response import methods_of  # no first page needs it

        known = [m for m in METHODS if m in methods_of(line)]
        return steps + [
            ViewStep(method.replace(" ", "_"),
                 Call("tn.frequency_response", (LINE, low, high), {"method": method, "curve": spring}), "followed",
                 {"name": method, "unit": unit_of(line)[0]}, title=f"response: {method}", soft=True)
            for method in known
        ]  # fmt: skip

"""The true motion: periodic response beside linear theory, run-up, rattle, Poincaré map, exponents, chaos."""

from __future__ import annotations

from typing import Any

import numpy as np

from trunnion.app.parts import figures
from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.curves import Curve, Curves
from trunnion.app.parts.pieces import column, pane, picture, pre
from trunnion.app.views.base import (
    Side,
    Step,
    View,
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
from trunnion.motion.orbits.frequency_response import methods_of

PERIODIC, RUN_UP, RATTLE = "periodic response", "run-up", "rattle over speed"
POINCARE, EXPONENTS, CHAOS = "Poincaré map", "Lyapunov exponents", "is it chaos?"
MOTIONS = {PERIODIC: "periodic", RUN_UP: "run-up", RATTLE: "rattle", POINCARE: "section", EXPONENTS: "exponents",
           CHAOS: "chaos"}  # fmt: skip
ASKS = {
    "periodic": ("speed",),
    "run-up": ("rate",),
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
"""Published equations that are no driveline, for the motions that take any system."""
SUBJECTS = {
    "this driveline": OF_LINE,
    "double tripod, input element (catalogue)": "double-tripod",
    "double tripod, output element (catalogue)": "double-tripod-output",
    "gear pair with backlash (catalogue)": "gear-rattle",
}
SECTIONS = {"double-tripod-output": Call("tn.Event", ("rate", 0.0), {"direction": -1})}
"""Where the map of equations without a period of forcing is taken: where the rotation turns back."""
PICTURES = ("map", "exponents", "certificate")
"""Steps that show the picture that their result draws of itself."""
METHODS = {"exact": figures.INK, "shooting": figures.GREEN, "harmonic balance": figures.SKY}
"""Of a response followed over speed, with the colour of each."""
SWEEPS = {"up": ("sweep up", "triangle", figures.BLUE), "down": ("sweep down", "inverted_triangle", figures.ORANGE)}

LINEAR, DOTS, SMALL = "linear theory", 16, 5
"""Drawn as so many small points upon every curve."""


class _Side(Side["MotionView"]):
    """Curves, or the picture of the result, and its text."""

    def make(self) -> None:
        """Panes and figures, made once."""
        self.curves = Curves("time [ms]", "torque [N·m]", height=380)
        for title, shape, colour in SWEEPS.values():
            self.curves.mark(title, shape, colour)
        self.curves.mark(LINEAR, "circle", figures.INK, SMALL)
        self.picture, self.text = pane(), pane()
        self.panel = column(self.curves.panel, self.picture, self.text)
        kinds = ("plotted", "periodic", "waves", "run_up", "swept", "followed")
        self.parts = {kinds: [self.curves.panel, self.picture, self.text]}
        self.found: dict[str, Any] = {}

    def clear(self) -> None:
        """No curves, no marks, no picture."""
        self.found = {}
        self.curves.set([])
        self.curves.panel.visible = False
        self.picture.object = self.text.object = ""
        for title in self.curves.marks:
            self.curves.put_marks(title, [], [])

    def show_plotted(self, step: Step, data: Any) -> None:
        """The picture that the result draws of itself."""
        self.curves.panel.visible = False
        self.picture.object = picture(data["svg"], step.name, 820)
        self.text.object = pre(data["text"])

    def show_periodic(self, step: Step, data: Any) -> None:
        """The true motion over a period."""
        self.curves.panel.visible = True
        self.text.object = pre(data["text"])
        curves = [Curve(n, 1e3 * data["time"], v) for n, v in zip(data["names"], data["torque"], strict=True)]
        self.curves.set(curves, x="time [ms]", y="torque [N·m]", title="torque over one period")
        self.curves.put_marks(LINEAR, [], [])

    def show_waves(self, step: Step, data: Any) -> None:
        """The motion by linear theory, as marks beside it."""
        every = slice(None, None, max(len(data["time"]) // DOTS, 1))
        time, torque = 1e3 * data["time"][every], [values[every] for values in data["torque"]]
        self.curves.put_marks(LINEAR, np.tile(time, len(torque)), np.concatenate([[], *torque]))

    def show_run_up(self, step: Step, data: Any) -> None:
        """The largest torque turn by turn, and of the steady motions where they are known."""
        self.curves.panel.visible = True
        unit, factor = unit_of(self.line)
        curves = []
        for k, (name, largest) in enumerate(zip(data["names"], data["largest"], strict=True)):
            curves.append(Curve(name, data["speed"] * factor, largest, figures.look(k)["line_color"], "solid"))
        if len(data["steady_speed"]):
            speed = data["steady_speed"] * factor
            for one, steady in zip(tuple(curves), data["steady"], strict=True):
                curves.append(Curve(f"{one.name}, steady", speed, steady, one.colour, "dashed"))
        title = "largest torque in each turn of the run-up"
        if data["ending"] != "reached":
            title += f" ({data['ending']})"
        self.curves.set(curves, x=f"input speed [{unit}]", y="torque [N·m]", title=title)
        self.text.object = pre(data["text"])

    def refused(self, step: Step, sentence: str) -> None:
        """Why a soft step gave nothing."""
        if step.name == "linear":
            self.text.object += pre(f"no linear theory beside it: {sentence}")
        elif step.name == "run_up":
            self.text.object += pre(f"no steady motions beside it: {sentence}")
        else:
            self._rattle(step, {"text": sentence})

    def _rattle(self, step: Step, data: Any) -> None:
        """All methods on one picture; what each said below."""
        self.curves.panel.visible = True
        asked = {one.name: one.title for one in self.view.steps(self.line)}
        if step.name == next(iter(asked)):
            self.found = {}
        self.found[step.name] = data
        unit, factor = unit_of(self.line)
        for way, (title, _, _) in SWEEPS.items():
            swept = self.found.get(f"sweep_{way}", {})
            self.curves.put_marks(title, np.asarray(swept.get("speed", ())) * factor, swept.get("half", ()))
        curves = []
        for method, colour in METHODS.items():
            followed = self.found.get(method.replace(" ", "_"), {})
            for name, stable, dash in ((method, True, "solid"), (f"{method}, unstable", False, "dashed")):
                if len(part := _part(followed, stable)):
                    curves.append(Curve(name, followed["speed"] * factor, part, colour, dash))
        title = f"vibration of {self.view.settings['spring']} by every method"
        self.curves.set(curves, x=f"input speed [{unit}]", y="half peak-to-peak torque [N·m]", title=title)
        said = (f"{asked[name]}\n{self.found[name]['text']}" for name in asked if name in self.found)
        self.text.object = "".join(map(pre, said))

    show_swept = show_followed = _rattle


def _part(followed: Any, stable: bool) -> Any:
    """The curve where it is stable, or where not with the points next to that; NaN elsewhere."""
    if not followed or "half" not in followed:
        return ()
    there = np.asarray(followed["stable"], dtype=bool) == stable
    if not there.any():
        return ()
    if not stable:
        there = there | np.roll(there, 1) | np.roll(there, -1)
    return np.where(there, followed["half"], np.nan)


class MotionView(View):
    """One motion at a time; some take long, and can be cancelled."""

    name = "motion"
    about = (
        "Motions of the line with everything that linear theory leaves out. Long computations can be cancelled; what "
        "is found by then stays."
    )
    side = _Side
    asks, asked_by = ASKS, ("what", "of")
    defaults = {
        "what": "periodic",
        "of": OF_LINE,
        "speed": None,
        "rate": 100.0,
        "points": 40,
        "spring": "",
        "returns": 400,
    }

    fields = {
        "what": lambda: select("Motion", options=MOTIONS),
        "of": lambda: select("Motion of", options=SUBJECTS, width=290),
        "speed": lambda: optional("Speed", start=0.0, width=170),
        "rate": lambda: number("Acceleration [rad/s²]", 100.0, start=0.01, width=170),
        "spring": lambda: select("Torque of", options=[]),
        "points": lambda: count("Points of a sweep", 40, 2, 400),
        "returns": lambda: count("Points of the map", 400, 10, 20_000),
    }

    def adapt(self, line: Driveline) -> None:
        """The unit of speeds, the shafts."""
        label_speed(self.widgets["speed"], line)
        self.choose("spring", springs_of(line))
        self.show_question()

    def show_question(self) -> None:
        """And no speed for equations that have none."""
        super().show_question()
        of = self.widgets["of"]
        self.widgets["speed"].visible &= not of.visible or of.value == OF_LINE

    def steps(self, line: Driveline) -> list[Step]:
        """The motion that is asked for."""
        speed = at_speed(line, self.typed("speed"))
        subject, at = self._subject(speed)
        match self.settings["what"]:
            case "run-up":
                return self._run_up(line)
            case "rattle":
                return self._rattle(line)
            case "section":
                returns = bounded(self.settings["returns"], 10, 20_000)
                of = str(self.settings["of"])
                section = {"section": SECTIONS[of]} if of in SECTIONS else {}
                call = Call("tn.poincare_map", (subject, returns), {**at, **section})
                return [Step("map", call, "plotted", title=POINCARE)]
            case "exponents":
                call = Call("tn.lyapunov_spectrum", (subject,), at)
                return [Step("exponents", call, "plotted", title=EXPONENTS)]
            case "chaos":
                call = Call("tn.certify_chaos", (subject,), {**at, "sweep": False})
                return [Step("certificate", call, "plotted", title="verdict on chaos", files=("nc",))]
        linear = Call("tn.order_response", (LINE, (speed,)))
        return [
            Step("periodic", Call("tn.periodic_response", (LINE, speed)), "periodic", title=PERIODIC),
            Step("linear", linear, "waves", picture="", files=("nc",), title="linear theory", soft=True),
        ]

    def _subject(self, speed: float) -> tuple[Any, dict[str, float]]:
        """What moves, and the speed for it: equations have a frequency of their own."""
        system = SYSTEMS.get(str(self.settings["of"]))
        return (LINE, {"speed": speed}) if system is None else (system, {})

    def _run_up(self, line: Driveline) -> list[Step]:
        """The run-up alone at first, since the steady motions beside it may take long."""
        ends, rate = speed_range(line), {"acceleration": self.value("rate")}
        alone = Call("tn.run_up", (LINE, *ends), {**rate, "steady": 0})
        whole = Call("tn.run_up", (LINE, *ends), rate)
        unit = {"unit": unit_of(line)[0]}
        return [
            Step("alone", alone, "run_up", picture="", files=()),
            Step("run_up", whole, "run_up", drawing=unit, title=RUN_UP, soft=True),
        ]

    def _rattle(self, line: Driveline) -> list[Step]:
        """Sweeps up and down, and the response followed by every method that there is for the line."""
        (low, high), spring = speed_range(line), str(self.settings["spring"])
        points = bounded(self.settings["points"], 2)
        ends = {"up": (low, high), "down": (high, low)}
        steps = [
            Step(f"sweep_{way}", Call("tn.sweep", (LINE, Call("np.linspace", (*ends[way], points)))), "swept",
                 {"spring": spring}, title=title, soft=True)
            for way, (title, _, _) in SWEEPS.items()
        ]  # fmt: skip
        known = [m for m in METHODS if m in methods_of(line)]
        return steps + [
            Step(method.replace(" ", "_"),
                 Call("tn.frequency_response", (LINE, low, high), {"method": method, "curve": spring}), "followed",
                 {"unit": unit_of(line)[0]},
                 title=f"response: {method}", soft=True)
            for method in known
        ]  # fmt: skip

"""The true motion: periodic response beside linear theory, run-up, rattle, Poincaré map, exponents, chaos."""

from __future__ import annotations

import base64
import html
from typing import Any

import numpy as np
import panel as pn

from trunnion.app import figures
from trunnion.app.calls import LINE, Call
from trunnion.app.curves import Curves
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
    unit_of,
)
from trunnion.driveline.driveline import Driveline

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


class MotionView(View):
    """One motion at a time; some take long, and can be cancelled."""

    name = "motion"
    title = "Motion"
    about = (
        "Motions of the line with everything that linear theory leaves out. Long computations can be cancelled; what "
        "is found by then stays."
    )
    defaults = {
        "what": "periodic",
        "of": OF_LINE,
        "speed": None,
        "rate": 100.0,
        "points": 40,
        "spring": "",
        "returns": 400,
    }

    def make_controls(self) -> Any:
        """Which motion, at which speed."""
        what = self.bind("what", select("Motion", options=MOTIONS))
        what.param.watch(lambda event: self._ask(), "value")
        self.bind("of", select("Motion of", options=SUBJECTS, width=290)).param.watch(
            lambda event: self._ask(), "value"
        )
        self.speed = self.bind("speed", optional("Speed", start=0.0, width=170))
        self.bind("rate", number("Acceleration [rad/s²]", 100.0, start=0.01, width=170))
        self.bind("spring", select("Torque of", options=[]))
        self.bind("points", count("Points of a sweep", 40, 2, 400))
        self.bind("returns", count("Points of the map", 400, 10, 20_000))
        return pn.FlexBox(*self.widgets.values())

    def adapt(self, line: Driveline) -> None:
        """The unit of speeds, the shafts."""
        from trunnion.analyses.linear.forced_response import shaft_names
        from trunnion.equations.coefficients import assemble

        label_speed(self.speed, line)
        self.choose("spring", list(shaft_names(assemble(line))))
        self._ask()

    def _ask(self) -> None:
        """Show the controls of the motion, and nothing of another one."""
        what = str(self.widgets["what"].value)
        for key, widget in self.widgets.items():
            widget.visible = key == "what" or key in ASKS[what]
        self.speed.visible &= "of" not in ASKS[what] or self.widgets["of"].value == OF_LINE
        for side in self.sides.values():
            assert isinstance(side, _Side)
            side.begin(what)

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
        from trunnion.analyses.orbits.frequency_response import methods_of

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

    def side(self) -> Any:
        """Curves, or the picture of the result, and its text."""
        return _Side(self)


class _Side(Side):
    def __init__(self, view: MotionView) -> None:
        self.view = view
        self.curves = Curves("time [ms]", "torque [N·m]", height=380)
        for title, shape, colour in SWEEPS.values():
            self.curves.mark(title, shape, colour)
        self.curves.mark(LINEAR, "circle", figures.INK, SMALL)
        self.picture = pn.pane.HTML("", sizing_mode="stretch_width")
        self.text = pn.pane.HTML("", sizing_mode="stretch_width")
        self.panel = pn.Column(self.curves.panel, self.picture, self.text, sizing_mode="stretch_width", margin=0)
        self.what = ""
        self.found: dict[str, Any] = {}
        self.begin(str(view.settings["what"]))

    def begin(self, what: str) -> None:
        """Forget what belongs to another motion."""
        if what == self.what:
            return
        self.what = what
        self.found = {}
        self.curves.set([])
        self.curves.panel.visible = False
        self.picture.object = self.text.object = ""
        for title in self.curves.marks:
            self.curves.put_marks(title, [], [])

    def show(self, name: str, data: Any) -> None:
        """What a step gave."""
        self.curves.panel.visible = name not in PICTURES
        if name in ("periodic", "linear"):
            self._periodic(name, data)
        elif name in ("alone", "run_up"):
            self._run_up(data)
        elif name not in PICTURES:
            self._rattle(name, data)
        else:
            image = base64.b64encode(data["svg"].encode()).decode()
            self.picture.object = (
                f"<img alt='{html.escape(name)}' style='width:100%;max-width:820px' "
                f"src='data:image/svg+xml;base64,{image}'>"
            )
            self.text.object = _text(data["text"])

    def refused(self, name: str, sentence: str) -> None:
        """Why a soft step gave nothing."""
        if name == "linear":
            self.text.object += _text(f"no linear theory beside it: {sentence}")
        elif name == "run_up":
            self.text.object += _text(f"no steady motions beside it: {sentence}")
        else:
            self._rattle(name, {"text": sentence})

    def _periodic(self, name: str, data: Any) -> None:
        if name == "periodic":
            self.found = {}
            self.text.object = _text(data["text"])
        self.found[name] = [(n, 1e3 * np.asarray(data["time"]), v) for n, v in _torques(data)]
        motion, linear = (self.found.get(key, []) for key in ("periodic", "linear"))
        self.curves.set(motion, x="time [ms]", y="torque [N·m]", title="torque over one period")
        every = slice(None, None, max(len(data["time"]) // DOTS, 1))
        self.curves.put_marks(LINEAR, *_together([(x[every], y[every]) for _, x, y in linear]))

    def _run_up(self, data: Any) -> None:
        unit, factor = unit_of(self.view.line_of(self))
        x = data["speed"] * factor
        curves = [(n, x, v) for n, v in zip(data["names"], data["largest"], strict=True)]
        steady = [
            (f"{n}, steady", data["steady_speed"] * factor, v)
            for n, v in zip(data["names"], data["steady"], strict=True)
            if len(data["steady_speed"])
        ]
        looks = [figures.look(k)["line_color"] for k in range(len(curves))]
        self.curves.set(
            [*curves, *steady],
            colours=[*looks, *looks],
            dashes=["solid"] * len(curves) + ["dashed"] * len(steady),
            x=f"input speed [{unit}]",
            y="torque [N·m]",
            title="largest torque in each turn of the run-up",
        )
        self.text.object = _text(data["text"])

    def _rattle(self, name: str, data: Any) -> None:
        """All methods on one picture; what each said below."""
        asked = {step.name: step.title for step in self.view.steps(self.view.line_of(self))}
        if name == next(iter(asked)):
            self.found = {}
        self.found[name] = data
        unit, factor = unit_of(self.view.line_of(self))
        for way, (title, _, _) in SWEEPS.items():
            swept = self.found.get(f"sweep_{way}", {})
            self.curves.put_marks(title, np.asarray(swept.get("speed", ())) * factor, swept.get("half", ()))
        curves, colours, dashes = [], [], []
        for method, colour in METHODS.items():
            followed = self.found.get(method.replace(" ", "_"), {})
            for stable, dash in ((True, "solid"), (False, "dashed")):
                if len(part := _part(followed, stable)):
                    curves.append((method if stable else f"{method}, unstable", followed["speed"] * factor, part))
                    colours.append(colour)
                    dashes.append(dash)
        self.curves.set(
            curves,
            colours=colours,
            dashes=dashes,
            x=f"input speed [{unit}]",
            y="half peak-to-peak torque [N·m]",
            title=f"vibration of {self.view.settings['spring']} by every method",
        )
        titles = {step.name: step.title for step in self.view.steps(self.view.line_of(self))}
        self.text.object = "".join(
            _text(f"{titles[key]}\n{self.found[key]['text']}") for key in asked if key in self.found
        )


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


def _together(curves: list[tuple[Any, Any]]) -> tuple[Any, Any]:
    """The points of all curves, abscissae and ordinates."""
    x, y = (np.concatenate([[], *(curve[axis] for curve in curves)]) for axis in (0, 1))
    return x, y


def _torques(data: Any) -> list[Any]:
    return list(zip(data["names"], data["torque"], strict=True))


def _text(text: str) -> str:
    return f"<pre>{figures.text(text)}</pre>"

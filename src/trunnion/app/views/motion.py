"""The true motion: periodic response beside linear theory, run-up, rattle, Poincaré map, exponents, chaos."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import panel as pn

from trunnion.app import figures
from trunnion.app.calls import LINE, Call
from trunnion.app.curves import Curves
from trunnion.app.views.base import Side, Step, View, at_speed, bounded, count, number, select, speed_range, unit_of
from trunnion.driveline.driveline import Driveline

PERIODIC, RUN_UP, RATTLE = "periodic response", "run-up", "rattle over speed"
POINCARE, EXPONENTS, CHAOS = "Poincaré map", "Lyapunov exponents", "is it chaos?"


class MotionView(View):
    """One motion at a time; some take long, and can be cancelled."""

    name = "motion"
    title = "Motion"
    about = (
        "Motions of the line with everything that linear theory leaves out. Long computations show their progress and "
        "can be cancelled."
    )
    defaults = {"what": PERIODIC, "speed": 0.0, "rate": 100.0, "points": 40}

    def make_controls(self) -> Any:
        """Which motion, at which speed."""
        kinds = [PERIODIC, RUN_UP, RATTLE, POINCARE, EXPONENTS, CHAOS]
        self.speed = self.bind("speed", number("Speed", 0.0, start=0.0, width=170))
        return pn.FlexBox(
            self.bind("what", select("Motion", options=kinds)),
            self.speed,
            self.bind("rate", number("Acceleration of the run-up [rad/s²]", 100.0, start=0.01, width=240)),
            self.bind("points", count("Points of a sweep", 40, 2, 400)),
        )

    def adapt(self, line: Driveline) -> None:
        """The unit of speeds."""
        self.speed.name = f"Speed [{unit_of(line)[0]}], 0: operating"

    def steps(self, line: Driveline) -> list[Step]:
        """The motion that is asked for."""
        speed = at_speed(line, float(self.settings["speed"]))
        low, high = speed_range(line)
        unit = {"unit": unit_of(line)[0]}
        match self.settings["what"]:
            case "run-up":
                rate = {"acceleration": float(self.settings["rate"])}
                call = Call("tn.run_up", (LINE, low, high), rate)
                return [Step("run_up", call, "run_up", drawing=unit, title=RUN_UP)]
            case "rattle over speed":
                points = bounded(self.settings["points"], 2)
                ways = (("up", low, high), ("down", high, low))
                calls = {way: Call("tn.sweep", (LINE, Call("np.linspace", (a, b, points)))) for way, a, b in ways}
                sweeps = [Step(f"sweep_{w}", c, "plotted", title=f"sweep {w}", soft=True) for w, c in calls.items()]
                curve = Call("tn.frequency_response", (LINE, low, high))
                return [*sweeps, Step("response", curve, "plotted", title="followed branch", soft=True)]
            case "Poincaré map":
                call = Call("tn.poincare_map", (LINE, 400), {"speed": speed})
                return [Step("map", call, "plotted", title=POINCARE)]
            case "Lyapunov exponents":
                call = Call("tn.lyapunov_spectrum", (LINE,), {"speed": speed})
                return [Step("exponents", call, "plotted", title=EXPONENTS)]
            case "is it chaos?":
                call = Call("tn.certify_chaos", (LINE,), {"speed": speed, "sweep": False})
                return [Step("certificate", call, "plotted", title="verdict on chaos", files=("nc",))]
        linear = Call("tn.order_response", (LINE, (speed,)))
        return [
            Step("periodic", Call("tn.periodic_response", (LINE, speed)), "periodic", title=PERIODIC),
            Step("linear", linear, "waves", picture="", files=("nc",), title="linear theory", soft=True),
        ]

    def side(self) -> Any:
        """Curves, or the picture of the result, and its text."""
        return _Side(self)


class _Side(Side):
    def __init__(self, view: MotionView) -> None:
        self.view = view
        self.curves = Curves("time [ms]", "torque [N·m]", height=380)
        self.pictures = pn.Column(sizing_mode="stretch_width", margin=0)
        self.text = pn.pane.HTML("", sizing_mode="stretch_width")
        self.panel = pn.Column(self.curves.panel, self.text, self.pictures, sizing_mode="stretch_width", margin=0)
        self.drawn: dict[str, Any] = {}
        self.motion: list[Any] = []

    def show(self, name: str, data: Any) -> None:
        """What a step gave."""
        if name == "linear":
            self._periodic([(f"{n}, linear theory", t, v) for n, t, v in _curves(data)])
            return
        self.curves.panel.visible = name in ("periodic", "run_up")
        if self.curves.panel.visible:
            self.pictures.objects = []
            self.text.object = _text(data["text"])
        if name == "periodic":
            self.motion = _curves(data)
            self._periodic([])
        elif name == "run_up":
            self._run_up(data)
        else:
            self.text.object = ""
            self._picture(name, data["svg"], data["text"])

    def refused(self, name: str, sentence: str) -> None:
        """Why a soft step gave nothing."""
        if name == "linear":
            self.text.object += _text(f"no linear theory beside it: {sentence}")
            return
        self.curves.panel.visible = False
        self._picture(name, "", sentence)

    def _periodic(self, linear: list[Any]) -> None:
        looks = [figures.look(k)["line_color"] for k in range(len(self.motion))]
        self.curves.set(
            [*self.motion, *linear],
            colours=[*looks, *looks],
            dashes=["solid"] * len(self.motion) + ["dashed"] * len(linear),
            x="time [ms]",
            title="torque over one period: true motion (solid), linear theory (dashed)",
        )

    def _run_up(self, data: Any) -> None:
        unit, factor = unit_of(self.view.line_of(self))
        x = data["speed"] * factor
        curves = [(n, x, v) for n, v in zip(data["names"], data["largest"], strict=True)]
        steady = [
            (f"{n}, steady", data["steady_speed"] * factor, v)
            for n, v in zip(data["names"], data["steady"], strict=True)
        ]
        looks = [figures.look(k)["line_color"] for k in range(len(curves))]
        self.curves.set(
            [*curves, *steady],
            colours=[*looks, *looks],
            dashes=["solid"] * len(curves) + ["dashed"] * len(steady),
            x=f"input speed [{unit}]",
            title="largest torque in each turn of the run-up (solid), steady motion (dashed)",
        )

    def _picture(self, name: str, svg: str, text: str) -> None:
        asked = {step.name for step in self.view.steps(self.view.line_of(self))}
        self.drawn = {key: value for key, value in self.drawn.items() if key in asked}
        image = base64.b64encode(svg.encode()).decode()
        picture = f"<img alt='{name}' style='width:100%;max-width:820px' src='data:image/svg+xml;base64,{image}'>"
        self.drawn[name] = pn.pane.HTML((picture if svg else "") + _text(text), sizing_mode="stretch_width")
        self.pictures.objects = list(self.drawn.values())


def _curves(data: Any) -> list[Any]:
    return [(n, 1e3 * np.asarray(data["time"]), v) for n, v in zip(data["names"], data["torque"], strict=True)]


def _text(text: str) -> str:
    return f"<pre style='white-space:pre-wrap;font-size:13px'>{figures.text(text)}</pre>"

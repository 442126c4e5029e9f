"""Torque by order over speed, the Campbell diagram, modes in motion, the wave form at one speed."""

from __future__ import annotations

from typing import Any

import panel as pn
from bokeh.events import Tap

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.mode_animation import Mover
from trunnion.app.parts.widgets import column, items, pane
from trunnion.app.views.base import (
    VariantPane,
    View,
    ViewStep,
    at_speed,
    label_speed,
    load_cases,
    optional,
    select,
    speed_range,
    springs_of,
    unit_of,
)
from trunnion.driveline.driveline import Driveline
from trunnion.pictures.picture import Level, Picture
from trunnion.reporting.ranges import diagram_range

AS_STATED = "as stated"
CAMPBELL_POINTS = 81


class _OrdersPane(VariantPane["OrdersView"]):
    """Four pictures."""

    def make(self) -> None:
        """Places of the pictures, and the button that moves a mode."""
        tapped = {Tap: lambda event: self.view.clicked(float(event.x))}
        self.orders, self.wave, self.campbell = Canvas(tapped), Canvas(), Canvas(tapped)
        self.mode = Canvas(name=f"mode-{id(self)}")
        self.said = pane()
        modes = column(self.mode.panel, Mover(picture=self.mode.name))
        self.panel = column(self.orders.panel, self.wave.panel, self.campbell.panel, modes, self.said)
        self.parts = {
            ("torque",): [self.orders.panel], ("wave",): [self.wave.panel], ("campbell",): [self.campbell.panel],
            ("modes",): [modes], ("findings",): [self.said],
        }  # fmt: skip

    def _cursor(self) -> Level:
        """A line at the speed looked at."""
        return Level(at_speed(self.line, self.view.typed("speed")) * unit_of(self.line)[1], "cursor", on="x")

    def show_torque(self, step: ViewStep, picture: Picture) -> None:
        """Torque of the shaft by order, in sum, and its limits."""
        self.orders.show(picture, self._cursor())

    def show_wave(self, step: ViewStep, picture: Picture) -> None:
        """Torque of the shaft over a period."""
        self.wave.show(picture)

    def show_campbell(self, step: ViewStep, data: Any) -> None:
        """Modes, what excites them, and where the two meet."""
        self.campbell.show(data["picture"], self._cursor())

    def show_modes(self, step: ViewStep, picture: Picture) -> None:
        """The mode that is asked for."""
        self.mode.show(picture)

    def show_findings(self, step: ViewStep, data: Any) -> None:
        """What is to be known of the orders, and where the line is unstable."""
        self.orders.show(data["picture"], self._cursor())
        self.said.object = items(data["said"])


class OrdersView(View):
    """What every order does to every shaft."""

    name = "orders"
    about = (
        "Vibratory torque by order over the speed, what excites which mode, how modes move, and the torque over time. "
        "Click a speed in a picture, or type it."
    )
    side = _OrdersPane
    defaults = {"spring": "", "load": AS_STATED, "speed": None, "mode": 1}

    fields = {
        "spring": lambda: select("Shaft", options=[]),
        "load": lambda: select("Load", options=[AS_STATED]),
        "speed": lambda: optional("Speed", start=0.0, width=150),
        "mode": lambda: pn.widgets.IntInput(label="Mode", value=1, start=1, end=99, width=90),
    }

    def adapt(self, line: Driveline) -> None:
        """Shafts and loads of the line, the unit of its speeds."""
        self.choose("spring", springs_of(line))
        self.choose("load", [AS_STATED, *load_cases(line)])
        label_speed(self.widgets["speed"], line)

    def steps(self, line: Driveline) -> list[ViewStep]:
        """Orders, wave form, Campbell diagram, modes, what is to be known of the orders."""
        case = self.load()
        low, high = speed_range(line)
        unit, _ = unit_of(line)
        speed = at_speed(line, self.typed("speed"))
        spring = str(self.settings["spring"])
        speeds = Call("tn.sweep_speeds", (LINE, low, high))
        shown = {"spring": spring, "unit": unit}
        orders = Call("tn.order_response", (LINE, speeds), case)
        wave = Call("tn.order_response", (LINE, (speed,)), case)
        over = Call("np.linspace", (*diagram_range(low, high), CAMPBELL_POINTS))
        campbell = Call("tn.campbell_diagram", (LINE, over), case)
        return [
            ViewStep(
                "orders",
                orders,
                "torque",
                shown,
                drawing=shown,
                columns=("torque", "mean_torque", "peak_torque", "vibratory_torque"),
                title="torque by order",
                lasting=True,
            ),
            ViewStep("wave", wave, "wave", shown, picture="", files=("nc",), title="orders at the speed"),
            ViewStep(
                "campbell",
                campbell,
                "campbell",
                {"unit": unit},
                drawing={"unit": unit},
                columns=("frequency", "damping_ratio"),
                title="Campbell diagram",
                lasting=True,
            ),
            ViewStep(
                "modes",
                Call("tn.natural_frequencies", (LINE,)),
                "modes",
                {"number": int(self.value("mode"))},
                title="mode shapes",
                lasting=True,
            ),
            # Last, since it judges the stability at every speed.
            ViewStep("said", orders, "findings", shown, picture="", files=(), lasting=True),
        ]

    def clicked(self, speed: float) -> None:
        """A speed was chosen in a picture, in the unit of the line."""
        if speed > 0:
            self.put("speed", float(f"{speed:.6g}"))

"""Torque by order over speed, the Campbell diagram, modes in motion, the wave form at one speed."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
from bokeh.models import LegendItem

from trunnion.app.parts import figures
from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.curves import Curve, Curves
from trunnion.app.parts.mover import Mover
from trunnion.app.parts.pieces import column, items, pane
from trunnion.app.views.base import (
    Side,
    Step,
    View,
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

AS_STATED = "as stated"
CAMPBELL_POINTS = 81
_LIMITS = {"max_torque": "largest torque", "vibratory_torque": "vibratory torque"}


class Mode:
    """A mode shape that can be set moving, in the browser alone."""

    def __init__(self) -> None:
        self.figure = figures.shape(260)
        self.source = figures.source(x=[], y=[], shape=[])
        self.figure.line("x", "y", source=self.source, line_width=2, color=figures.BLUE)
        self.figure.scatter("x", "y", source=self.source, size=11, color=figures.BLUE)
        self.figure.y_range.update(start=-1.15, end=1.15)
        self.source.name = f"mode-{self.source.id}"
        self.panel = column(pn.pane.Bokeh(self.figure, sizing_mode="stretch_width"), Mover(source=self.source.name))

    def set(self, data: Any, mode: int) -> None:
        """Show a mode by its number from 1."""
        k = min(max(mode, 1), len(data["frequency"])) - 1
        shape = data["shape"][:, k]
        names = [str(n) for n in data["names"]]
        figures.name_inertias(self.figure, names)
        figures.put(self.source, {"x": names, "y": shape, "shape": shape})
        self.figure.title.text = (
            f"mode {k + 1} of {len(data['frequency'])}: {data['frequency'][k] / (2 * np.pi):.5g} Hz,\n"
            f"damping ratio {data['damping'][k]:.3g}"
        )


class _Side(Side["OrdersView"]):
    """Four pictures."""

    def make(self) -> None:
        """Panes and figures, made once."""
        self.orders = Curves("input speed", "torque [N·m]", tap=self.view.clicked)
        self.wave = Curves("time [ms]", "torque [N·m]", height=290)
        self.campbell = Curves("input speed", "frequency [Hz]", height=380, tap=self.view.clicked)
        self.crossings = figures.source(x=[], y=[], name=[])
        marks = self.campbell.figure.scatter("x", "y", size=8, color=figures.INK, source=self.crossings)
        figures.hover(self.campbell.figure, [marks], [("", "@name")])
        self.campbell.legend.items = [*self.campbell.legend.items, LegendItem(label="crossing", renderers=[marks])]
        self.mode = Mode()
        self.said = pane()
        self.panel = column(self.orders.panel, self.wave.panel, self.campbell.panel, self.mode.panel, self.said)
        self.parts = {
            ("orders",): [self.orders.panel], ("wave",): [self.wave.panel], ("campbell",): [self.campbell.panel],
            ("modes",): [self.mode.panel], ("findings",): [self.said],
        }  # fmt: skip

    def _speeds(self) -> tuple[str, float, float]:
        """Unit of speeds, how many of it a rad/s is, and the speed looked at in it."""
        unit, factor = unit_of(self.line)
        return unit, factor, at_speed(self.line, self.view.typed("speed")) * factor

    def show_orders(self, step: Step, data: Any) -> None:
        """Torque of the shaft by order, in sum, and its limits."""
        unit, factor, cursor = self._speeds()
        x = data["speed"] * factor
        curves = [
            Curve("vibratory torque, all orders", x, data["vibratory"], figures.INK, "solid"),
            Curve("largest torque", x, data["peak"], figures.FAINT, "dashed"),
        ]
        for k, (name, size) in enumerate(zip(data["names"], data["sizes"], strict=True)):
            curves.append(Curve(name, x, size, *figures.look(k).values()))
        for limit in self.line.limits_by_element:
            if limit.element == data["spring"] and limit.key in _LIMITS:
                value = np.full(len(x), float(limit.value))
                curves.append(Curve(f"limit of the {_LIMITS[limit.key]}", x, value, figures.ORANGE, "dotted"))
        title = f"torque of {data['spring']} by order" + ("; sums are bounds" if data["bound"] else "")
        self.orders.set(curves, x=f"input speed [{unit}]", title=title, cursor=cursor)

    def show_wave(self, step: Step, data: Any) -> None:
        """Torque of the shaft over a period."""
        unit, _, cursor = self._speeds()
        title = f"torque of {data['spring']} over one period at {cursor:.6g} {unit}"
        self.wave.set([Curve(data["spring"], 1e3 * data["time"], data["torque"])], title=title)

    def show_campbell(self, step: Step, data: Any) -> None:
        """Modes, what excites them, and where the two meet."""
        unit, factor, cursor = self._speeds()
        x = data["speed"] * factor
        hertz = data["frequency"] / (2 * np.pi)
        curves = [
            Curve(f"mode {n}", x, hertz[:, k], figures.BLUE, figures.DASHES[k % 4]) for k, n in enumerate(data["mode"])
        ]
        curves += [
            Curve(name, x, values / (2 * np.pi), figures.FAINT, figures.DASHES[k % 4])
            for k, (name, values) in enumerate(data["lines"])
        ]
        self.campbell.set(curves, x=f"input speed [{unit}]", title="Campbell diagram", cursor=cursor)
        crossings = {"x": data["crossing_speed"] * factor, "y": data["crossing_frequency"] / (2 * np.pi)}
        figures.put(self.crossings, crossings | {"name": data["crossing"]})

    def show_modes(self, step: Step, data: Any) -> None:
        """The mode that is asked for."""
        self.mode.set(data, int(self.view.value("mode")))

    def show_findings(self, step: Step, data: Any) -> None:
        """What is to be known of the orders."""
        self.said.object = items(data)


class OrdersView(View):
    """What every order does to every shaft."""

    name = "orders"
    about = (
        "Vibratory torque by order over the speed, what excites which mode, how modes move, and the torque over time. "
        "Click a speed in a picture, or type it."
    )
    side = _Side
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

    def steps(self, line: Driveline) -> list[Step]:
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
        campbell = Call("tn.campbell_diagram", (LINE, Call("np.linspace", (low, high, CAMPBELL_POINTS))), case)
        return [
            Step(
                "orders",
                orders,
                "orders",
                {"spring": spring},
                drawing=shown,
                columns=("torque", "mean_torque", "peak_torque", "vibratory_torque"),
                title="torque by order",
                lasting=True,
            ),
            Step("wave", wave, "wave", {"spring": spring}, picture="", files=("nc",), title="orders at the speed"),
            Step(
                "campbell",
                campbell,
                "campbell",
                drawing={"unit": unit},
                columns=("frequency", "damping_ratio"),
                title="Campbell diagram",
                lasting=True,
            ),
            Step("modes", Call("tn.natural_frequencies", (LINE,)), "modes", title="mode shapes", lasting=True),
            # Last, since it judges the stability at every speed.
            Step("said", orders, "findings", picture="", files=(), lasting=True),
        ]

    def clicked(self, speed: float) -> None:
        """A speed was chosen in a picture, in the unit of the line."""
        if speed > 0:
            self.put("speed", float(f"{speed:.6g}"))

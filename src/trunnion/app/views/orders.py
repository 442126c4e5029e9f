"""Torque by order over speed, the Campbell diagram, modes in motion, the wave form at one speed."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource, LegendItem, Span

from trunnion.app import figures
from trunnion.app.calls import LINE, Call
from trunnion.app.curves import Curves
from trunnion.app.views.base import Side, Step, View, at_speed, label_speed, optional, select, speed_range, unit_of
from trunnion.app.views.verdict import load_cases
from trunnion.driveline.driveline import Driveline

AS_STATED = "as stated"
CAMPBELL_POINTS = 81
_LIMITS = {"max_torque": "largest torque", "vibratory_torque": "vibratory torque"}


class OrdersView(View):
    """What every order does to every shaft."""

    name = "orders"
    title = "Orders"
    about = (
        "Vibratory torque by order over the speed, what excites which mode, how modes move, and the torque over time. "
        "Click a speed in a picture, or type it."
    )
    defaults = {"spring": "", "load": AS_STATED, "speed": None, "mode": 1}

    def make_controls(self) -> Any:
        """Shaft, load, speed, mode."""
        self.speed = self.bind("speed", optional("Speed", start=0.0, width=150))
        return pn.FlexBox(
            self.bind("spring", select("Shaft", options=[])),
            self.bind("load", select("Load", options=[AS_STATED])),
            self.speed,
            self.bind("mode", pn.widgets.IntInput(label="Mode", value=1, start=1, end=99, width=90)),
        )

    def adapt(self, line: Driveline) -> None:
        """Shafts and loads of the line, the unit of its speeds."""
        from trunnion.analyses.linear.forced_response import shaft_names
        from trunnion.equations.coefficients import assemble

        self.choose("spring", list(shaft_names(assemble(line))))
        self.choose("load", [AS_STATED, *load_cases(line)])
        label_speed(self.speed, line)

    def steps(self, line: Driveline) -> list[Step]:
        """Orders, wave form, Campbell diagram, modes, what is to be known of the orders."""
        case = {} if self.settings["load"] == AS_STATED else {"load_case": self.settings["load"]}
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

    def side(self) -> Any:
        """Four pictures."""
        return _Side(self)

    def clicked(self, speed: float) -> None:
        """A speed was chosen in a picture, in the unit of the line."""
        if speed > 0:
            self.put("speed", float(f"{speed:.6g}"))


class _Side(Side):
    def __init__(self, view: OrdersView) -> None:
        self.view = view
        self.orders = Curves("input speed", "torque [N·m]", tap=view.clicked)
        self.wave = Curves("time [ms]", "torque [N·m]", height=290)
        self.campbell = Curves("input speed", "frequency [Hz]", height=380, tap=view.clicked)
        self.crossings = ColumnDataSource(data={"x": [], "y": [], "name": []})
        marks = self.campbell.figure.scatter("x", "y", size=8, color=figures.INK, source=self.crossings)
        figures.hover(self.campbell.figure, [marks], [("", "@name")])
        self.campbell.legend.items = [*self.campbell.legend.items, LegendItem(label="crossing", renderers=[marks])]
        self.mode = Mode()
        self.said = pn.pane.HTML("", sizing_mode="stretch_width")
        self.panel = pn.Column(
            self.orders.panel,
            self.wave.panel,
            self.campbell.panel,
            self.mode.panel,
            self.said,
            sizing_mode="stretch_width",
            margin=0,
        )

    def show(self, name: str, data: Any) -> None:
        """What a step gave."""
        line = self.view.line_of(self)
        unit, factor = unit_of(line)
        cursor = at_speed(line, self.view.typed("speed")) * factor
        if name == "orders":
            self._orders(data, unit, factor, cursor)
        elif name == "wave":
            title = f"torque of {data['spring']} over one period at {cursor:.6g} {unit}"
            self.wave.set([(data["spring"], 1e3 * data["time"], data["torque"])], title=title)
        elif name == "campbell":
            self._campbell(data, unit, factor, cursor)
        elif name == "modes":
            self.mode.set(data, int(self.view.value("mode")))
        else:
            self.said.object = "<ul>" + "".join(f"<li>{figures.text(f)}</li>" for f in data) + "</ul>"

    def _orders(self, data: Any, unit: str, factor: float, cursor: float) -> None:
        x = data["speed"] * factor
        curves = [("vibratory torque, all orders", x, data["vibratory"]), ("largest torque", x, data["peak"])]
        curves += [(name, x, size) for name, size in zip(data["names"], data["sizes"], strict=True)]
        colours, dashes = [figures.INK, figures.FAINT], ["solid", "dashed"]
        looks = [figures.look(k) for k in range(len(data["names"]))]
        colours += [look["line_color"] for look in looks]
        dashes += [look["line_dash"] for look in looks]
        for limit in self.view.line_of(self).limits_by_element:
            if limit.element == data["spring"] and limit.key in _LIMITS:
                curves.append((f"limit of the {_LIMITS[limit.key]}", x, np.full(len(x), float(limit.value))))
                colours.append(figures.ORANGE)
                dashes.append("dotted")
        title = f"torque of {data['spring']} by order" + ("; sums are bounds" if data["bound"] else "")
        self.orders.set(curves, colours=colours, dashes=dashes, x=f"input speed [{unit}]", title=title, cursor=cursor)

    def _campbell(self, data: Any, unit: str, factor: float, cursor: float) -> None:
        x = data["speed"] * factor
        hertz = data["frequency"] / (2 * np.pi)
        modes = [(f"mode {n}", x, hertz[:, k]) for k, n in enumerate(data["mode"])]
        lines = [(name, x, values / (2 * np.pi)) for name, values in data["lines"]]
        colours = [figures.BLUE] * len(modes) + [figures.FAINT] * len(lines)
        dashes = [figures.DASHES[k % 4] for k in range(len(modes))] + [figures.DASHES[k % 4] for k in range(len(lines))]
        self.campbell.set(
            [*modes, *lines],
            colours=colours,
            dashes=dashes,
            x=f"input speed [{unit}]",
            title="Campbell diagram",
            cursor=cursor,
        )
        figures.put(
            self.crossings,
            {
                "x": data["crossing_speed"] * factor,
                "y": data["crossing_frequency"] / (2 * np.pi),
                "name": data["crossing"],
            },
        )


class Mode:
    """A mode shape that can be set moving, in the browser alone."""

    def __init__(self) -> None:
        self.figure = figures.plot("", "rotation, largest 1", height=260, x_range=[], tools="")
        self.figure.xaxis.major_label_orientation = 0.6
        self.source = ColumnDataSource(data={"x": [], "y": [], "shape": []})
        self.figure.line("x", "y", source=self.source, line_width=2, color=figures.BLUE)
        self.figure.scatter("x", "y", source=self.source, size=11, color=figures.BLUE)
        self.figure.add_layout(Span(location=0, dimension="width", line_color=figures.FAINT))
        self.figure.y_range.start, self.figure.y_range.end = -1.15, 1.15
        move = pn.widgets.Toggle(label="Move the mode", width=140)
        move.jscallback(
            args={"source": self.source},
            value="""
            const move = () => {
              if (!cb_obj.active) { set(1); return }
              set(Math.cos(performance.now() / 300)); requestAnimationFrame(move)
            }
            const set = (c) => {
              source.data = {...source.data, y: Array.from(source.data.shape, v => v * c)}
            }
            move()
            """,
        )
        self.panel = pn.Column(
            pn.pane.Bokeh(self.figure, sizing_mode="stretch_width"), move, sizing_mode="stretch_width", margin=0
        )

    def set(self, data: Any, mode: int) -> None:
        """Show a mode by its number from 1."""
        k = min(max(mode, 1), len(data["frequency"])) - 1
        shape = data["shape"][:, k]
        names = [str(n) for n in data["names"]]
        if list(self.figure.x_range.factors) != names:
            self.figure.x_range.factors = names
        figures.put(self.source, {"x": names, "y": shape, "shape": shape})
        self.figure.title.text = (
            f"mode {k + 1} of {len(data['frequency'])}: {data['frequency'][k] / (2 * np.pi):.5g} Hz,\n"
            f"damping ratio {data['damping'][k]:.3g}"
        )

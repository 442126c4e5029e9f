"""One turn of the joints: uniformity, couples, phasing with the forks drawn, compound angles."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import panel as pn

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.document import Document
from trunnion.app.parts.widgets import Html, HtmlPane, column, items, joined, lines, markup, pane, picture, small
from trunnion.app.views.base import (
    Setting,
    VariantPane,
    View,
    ViewStep,
    at_speed,
    label_speed,
    number,
    optional,
    select,
    slider,
    unit_of,
)
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.layout import combined_angle
from trunnion.driveline.shafts import Shaft
from trunnion.pictures.picture import Level

DEGREES = 180 / math.pi
HEIGHT = 3.8
"""Of a panel of curves over a turn [inches]."""


class _JointsPane(VariantPane["JointsView"]):
    """Curves over a turn and the forks."""

    def make(self) -> None:
        """Panes and places of the pictures, made once."""
        self.text, self.phasing, self.space = pane(), pane(), pane()
        self.curves, self.forks = Canvas(), Canvas()
        self.panel = column(self.text, self.phasing, self.forks.panel, self.space, self.curves.panel)
        turned = [self.text, self.forks.panel, self.curves.panel]
        self.parts = {("turn",): turned, ("phasing",): [self.phasing], ("drawn",): [self.space]}

    def show_phasing(self, step: ViewStep, data: Any) -> None:
        """The fork offsets that are best."""
        self.phasing.object = small(markup("<b>best fork offsets</b>: {}", lines(data["text"])))

    def show_drawn(self, step: ViewStep, svg: str) -> None:
        """The forks in space."""
        self.space.object = picture(svg, "joints and forks in space", 760)

    def refused(self, step: ViewStep, sentence: str) -> None:
        """A line without joints has no phasing."""
        where = self.phasing if step.name == "phasing" else self.space
        where.object = small(sentence)

    def show_turn(self, step: ViewStep, data: Any) -> None:
        """Curves, the largest of each, and the forks where the input is turned to."""
        panels = [replace(panel, key="below") for panel in data["picture"].panels]
        curves = replace(data["picture"], panels=panels, columns=1, height=HEIGHT * len(panels))
        self.curves.show(curves, Level(self.view.value("turn"), "cursor", on="x"))
        self.forks.show(data["forks"])
        self.text.object = joined([*map(_uniformity, data["outputs"]), items(data["findings"])])


def _uniformity(output: Any) -> Html:
    """How evenly the end of a branch turns; ``name`` is empty where there is one end."""
    of = f" of {output['name']}" if output["name"] else ""
    rows = {
        "irregularity": (f"irregularity of the output{of}", f"{output['irregularity']:.6g}"),
        "equivalent": ("as one joint of", f"{output['equivalent'] * DEGREES:.4g}°"),
        "ratio": ("turns of the output to one of the input", f"{output['ratio']:.6g}"),
        "acceleration": (f"largest acceleration of the output{of}", f"{output['acceleration']:.5g} rad/s²"),
    }
    row = "<tr><th>{1}</th><td data-value='{0}'>{2}</td></tr>"
    return markup("<table class='plain'>{}</table>", joined(markup(row, key, *said) for key, said in rows.items()))


class JointsView(View):
    """Kinetostatics, phasing, compound angles."""

    name = "joints"
    about = (
        "Motion, torques and couples over one turn of the input with rigid shafts; the forks as seen along the line, "
        "turned by sliders; the angle of a joint from its angles in side and top view."
    )
    side = _JointsPane
    defaults = {"speed": None, "torque": 100.0, "turn": 0.0, "shaft": "", "joint": "", "side": 0.0, "top": 0.0}

    fields = {
        "speed": lambda: optional("Speed", start=0.0, width=150),
        "torque": lambda: number("Torque at the output [N m]", 100.0, width=190),
        "turn": lambda: slider("Input turned by [deg]", 0, 360, 5),
        "shaft": lambda: select("Fork offset of", options=[]),
        "side": lambda: number("Angle in side view [deg]", 0.0, width=170),
        "top": lambda: number("Angle in top view [deg]", 0.0, width=170),
        "joint": lambda: select("Joint", options=[], width=180),
    }

    def arrange(self) -> Any:
        """Speed and torque; fork offset; compound angle."""
        self.offset = slider("Fork offset [deg]", -90, 90, 1)
        self.offset.param.watch(self._turned, "value")
        best = pn.widgets.Button(label="Best fork offsets", width=150, align="end")
        best.on_click(lambda event: self.session.beside(self._phase()))
        use = pn.widgets.Button(label="Use this angle", width=130, align="end")
        use.on_click(lambda event: self.session.edit(self._use))
        self.compound = HtmlPane("", margin=(18, 8))
        forks, angles = self.row("shaft"), self.row("side", "top", "joint")
        forks.extend([self.offset, best])
        angles.extend([use, self.compound])
        return column(self.row("speed", "torque", "turn"), forks, angles)

    def adapt(self, line: Driveline) -> None:
        """Joints of the line, and shafts with a fork at their front."""
        label_speed(self.widgets["speed"], line)
        shafts = [n for n, e in zip(line.names, line.elements, strict=True) if isinstance(e, Shaft)]
        self.choose("shaft", shafts)
        self.choose("joint", [name for name, _ in hooke_joints(line)])
        self._show_offset()

    def chosen(self, key: str, value: Setting) -> None:
        """Of another shaft the slider shows the offset."""
        super().chosen(key, value)
        if key == "shaft":
            self._show_offset()

    def _show_offset(self) -> None:
        line, name = self.session.document.line, self.settings["shaft"]
        if name not in line.names:
            return
        offset = float(getattr(line.elements[line.index(str(name))], "fork_offset", 0.0) or 0.0) * DEGREES
        with self.programmatic:
            self.offset.value = min(max(offset, -90.0), 90.0)

    def _turned(self, event: Any) -> None:
        if self.programmatic:
            return
        name = str(self.settings["shaft"])
        line = self.session.document.line.replace(name, fork_offset=f"{event.new:g} deg")
        self.session.edit(lambda document: document.set_numbers(line, f"fork of {name}"))

    async def _phase(self) -> None:
        found = await self.session.ask(Call("tn.phase_forks", (LINE,)), "phasing", "now")

        def change(document: Document) -> None:
            changes = {name: {"fork_offset": value} for name, value in found["offsets"].items()}
            document.set_numbers(document.line.replace_all(changes))

        self.session.locked(lambda: self.session.edit(change))

    def compound_angle(self) -> tuple[float, float]:
        """Bend and plane [rad] of the angles in side and top view."""
        return combined_angle(self.value("side") / DEGREES, self.value("top") / DEGREES)

    def _use(self, document: Document) -> None:
        document.set_numbers(document.line.replace(str(self.settings["joint"]), angle=self.compound_angle()[0]))

    def steps(self, line: Driveline) -> list[ViewStep]:
        """A turn, the best phasing, the forks in space."""
        angle, plane = self.compound_angle()
        self.compound.object = f"compound angle {angle * DEGREES:.5g}°, plane {plane * DEGREES:.5g}° from the vertical"
        speed = at_speed(line, self.typed("speed"))
        turn = Call("tn.kinetostatics", (LINE, speed), {"output_torque": self.value("torque")})
        drawing = {"unit": unit_of(line)[0]}
        space = Call("tn.sketch", (LINE,), {"input_angle": self.value("turn") / DEGREES})
        return [
            ViewStep("turn", turn, "turn", {**drawing, "at": self.value("turn")}, drawing=drawing, title="one turn"),
            ViewStep("phasing", Call("tn.phase_forks", (LINE,)), "phasing", picture="", files=(), soft=True),
            ViewStep("space", space, "drawn", picture="", files=(), title="forks in space", soft=True),
        ]

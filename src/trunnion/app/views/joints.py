"""One turn of the joints: uniformity, couples, phasing with the forks drawn, compound angles."""

from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource

from trunnion.app import figures
from trunnion.app.calls import LINE, Call
from trunnion.app.curves import Curves
from trunnion.app.document import Document
from trunnion.app.views.base import Side, Step, View, at_speed, label_speed, number, optional, select, unit_of
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.shafts import Shaft

DEGREES = 180 / math.pi
SPACING = 2.6
"""Distance of the drawn joints; a fork's arm is 1 long."""


class JointsView(View):
    """Kinetostatics, phasing, compound angles."""

    name = "joints"
    title = "Joints"
    about = (
        "Motion, torques and couples over one turn of the input with rigid shafts; the forks as seen along the line, "
        "turned by sliders; the angle of a joint from its angles in side and top view."
    )
    defaults = {"speed": None, "torque": 100.0, "turn": 0.0, "shaft": "", "joint": "", "side": 0.0, "top": 0.0}

    def make_controls(self) -> Any:
        """Speed and torque; fork offset; compound angle."""
        self.speed = self.bind("speed", optional("Speed", start=0.0, width=150))
        torque = self.bind("torque", number("Torque at the output [N·m]", 100.0, width=190))
        turn = pn.widgets.FloatSlider(label="Input turned by [deg]", start=0, end=360, step=5, value=0, width=260)
        self.bind("turn", turn)
        self.shaft = self.bind("shaft", select("Fork offset of", options=[]))
        self.shaft.param.watch(lambda event: self._show_offset(), "value")
        self.offset = pn.widgets.FloatSlider(label="Fork offset [deg]", start=-90, end=90, step=1, value=0, width=260)
        self.offset.param.watch(self._turned, "value")
        self.best = pn.widgets.Button(label="Best fork offsets", width=150, align="end")
        self.best.on_click(lambda event: self.session.beside(self._phase()))
        side = self.bind("side", number("Angle in side view [deg]", 0.0, width=170))
        top = self.bind("top", number("Angle in top view [deg]", 0.0, width=170))
        joint = self.bind("joint", select("Joint", options=[], width=180))
        self.compound = pn.pane.HTML("", margin=(18, 8))
        use = pn.widgets.Button(label="Use this angle", width=130, align="end")
        use.on_click(lambda event: self.session.edit(self._use))
        return pn.Column(
            pn.FlexBox(self.speed, torque, turn),
            pn.FlexBox(self.shaft, self.offset, self.best),
            pn.FlexBox(side, top, joint, use, self.compound),
            sizing_mode="stretch_width",
            margin=0,
        )

    def adapt(self, line: Driveline) -> None:
        """Joints of the line, and shafts with a fork at their front."""
        label_speed(self.speed, line)
        shafts = [n for n, e in zip(line.names, line.elements, strict=True) if isinstance(e, Shaft)]
        self.choose("shaft", shafts)
        self.choose("joint", [name for name, _ in hooke_joints(line)])
        self._show_offset()

    def _show_offset(self) -> None:
        line, name = self.session.document.line, self.settings["shaft"]
        if name not in line.names:
            return
        offset = float(getattr(line.elements[line.index(str(name))], "fork_offset", 0.0) or 0.0) * DEGREES
        self._quiet = True
        self.offset.value = min(max(offset, -90.0), 90.0)
        self._quiet = False

    def _turned(self, event: Any) -> None:
        if self._quiet:
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
        from trunnion.driveline.layout import combined_angle

        return combined_angle(self.value("side") / DEGREES, self.value("top") / DEGREES)

    def _use(self, document: Document) -> None:
        document.set_numbers(document.line.replace(str(self.settings["joint"]), angle=self.compound_angle()[0]))

    def steps(self, line: Driveline) -> list[Step]:
        """A turn, the best phasing, the forks in space."""
        angle, plane = self.compound_angle()
        self.compound.object = f"compound angle {angle * DEGREES:.5g}°, plane {plane * DEGREES:.5g}° from the vertical"
        speed = at_speed(line, self.typed("speed"))
        turn = Call("tn.kinetostatics", (LINE, speed), {"output_torque": self.value("torque")})
        drawing = {"unit": unit_of(line)[0]}
        space = Call("tn.sketch", (LINE,), {"input_angle": self.value("turn") / DEGREES})
        return [
            Step("turn", turn, "turn", drawing=drawing, title="one turn", files=("csv", "nc"), columns=_COLUMNS),
            Step("phasing", Call("tn.phase_forks", (LINE,)), "phasing", picture="", files=(), soft=True),
            Step("space", space, "drawn", picture="", files=(), title="forks in space", soft=True),
        ]

    def side(self) -> Any:
        """Curves over a turn and the forks."""
        return _Side(self)


_COLUMNS = ("speed", "acceleration", "torque")


class _Side(Side):
    def __init__(self, view: JointsView) -> None:
        self.view = view
        self.speed = Curves("input angle [deg]", "speed less its mean [%]", height=270)
        self.torque = Curves("input angle [deg]", "transmitted torque [N·m]", height=270)
        self.couple = Curves("input angle [deg]", "secondary couple [N·m]", height=270)
        self.text = pn.pane.HTML("", sizing_mode="stretch_width")
        self.phasing = pn.pane.HTML("", sizing_mode="stretch_width")
        self.space = pn.pane.HTML("", sizing_mode="stretch_width")
        self.forks = figures.plot("", "", height=210, title="forks seen along the line", match_aspect=True, tools="")
        self.forks.axis.visible = False
        self.forks.grid.visible = False
        self.arms = ColumnDataSource(data={"xs": [], "ys": [], "colour": [], "dash": []})
        self.labels = ColumnDataSource(data={"x": [], "y": [], "text": []})
        self.rings = ColumnDataSource(data={"x": [], "y": []})
        self.forks.circle("x", "y", radius=1.0, source=self.rings, fill_alpha=0, line_color=figures.FAINT)
        self.forks.multi_line("xs", "ys", line_color="colour", line_dash="dash", line_width=5, source=self.arms)
        self.forks.text("x", "y", "text", source=self.labels, text_align="center", text_font_size="13px")
        self.panel = pn.Column(
            self.text,
            self.phasing,
            pn.pane.Bokeh(self.forks, sizing_mode="stretch_width"),
            self.space,
            self.speed.panel,
            self.torque.panel,
            self.couple.panel,
            sizing_mode="stretch_width",
            margin=0,
        )

    def show(self, name: str, data: Any) -> None:
        """What a step gave."""
        if name == "turn":
            self._turn(data)
        elif name == "phasing":
            said = data["text"].replace("\n", "<br>")
            self.phasing.object = f"<div style='font-size:13px'><b>best fork offsets</b>: {said}</div>"
        else:
            picture = base64.b64encode(data.encode()).decode()
            self.space.object = (
                "<img alt='joints and forks in space' style='width:100%;max-width:760px' "
                f"src='data:image/svg+xml;base64,{picture}'>"
            )

    def refused(self, name: str, sentence: str) -> None:
        """A line without joints has no phasing."""
        pane = self.phasing if name == "phasing" else self.space
        pane.object = f"<div style='font-size:13px'>{figures.text(sentence)}</div>"

    def _turn(self, data: Any) -> None:
        x = data["input_angle"] * DEGREES
        cursor = self.view.value("turn")
        speed = [(n, x, 100 * v) for n, v in zip(data["shafts"], data["deviation"], strict=True)]
        self.speed.set(speed, cursor=cursor, title="speed of the shafts over one turn")
        torque = [(n, x, v) for n, v in zip(data["shafts"], data["torque"], strict=True)]
        self.torque.set(torque, cursor=cursor, title="torque of the shafts over one turn")
        couple = [(n, x, v) for n, v in zip(data["forks"], data["couple"], strict=True)]
        self.couple.set(couple, cursor=cursor, title="couple that bends each fork's shaft")
        lines = "".join(f"<li>{figures.text(s)}</li>" for s in data["findings"])
        self.text.object = (
            f"<table class='plain'><tr><th>irregularity of the output</th><td data-value='irregularity'>"
            f"{data['irregularity']:.6g}</td></tr>"
            f"<tr><th>as one joint of</th><td>{data['equivalent'] * DEGREES:.4g}°</td></tr>"
            f"<tr><th>largest acceleration</th><td>{data['acceleration']:.5g} rad/s²</td></tr></table><ul>{lines}</ul>"
        )
        self._forks(data, cursor)

    def _forks(self, data: Any, cursor: float) -> None:
        at = int(np.abs(data["input_angle"] * DEGREES - cursor).argmin())
        xs, ys, colours, dashes, labels = [], [], [], [], []
        for k, name in enumerate(data["joints"]):
            centre = SPACING * k
            for quarter, colour, dash in ((0.0, figures.BLUE, "solid"), (np.pi / 2, figures.ORANGE, "dashed")):
                angle = data["joint_angle"][k, at] + quarter
                # an arm in the joint plane (angle 0) stands upright
                dx, dy = math.sin(angle), math.cos(angle)
                xs.append([centre - dx, centre + dx])
                ys.append([-dy, dy])
                colours.append(colour)
                dashes.append(dash)
            labels.append((centre, -1.45, name))
        figures.put(self.arms, {"xs": xs, "ys": ys, "colour": colours, "dash": dashes})
        figures.put(self.rings, {"x": [SPACING * k for k in range(len(labels))], "y": [0.0] * len(labels)})
        figures.put(self.labels, {k: [row[i] for row in labels] for i, k in enumerate(("x", "y", "text"))})
        self.forks.title.text = f"forks at input angle {cursor:g}°\njoint plane upright, output dashed"

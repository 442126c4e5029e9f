"""The line in motion, in space: turning, a mode, the response, a disturbance that grows, a run-up, a scenario."""

from __future__ import annotations

from typing import Any

from trunnion.animation.player.component import Player
from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.editing import change_of
from trunnion.app.parts.editor import Editor
from trunnion.app.parts.form import FieldGroup
from trunnion.app.parts.widgets import column, pane, small, wrapped
from trunnion.app.views.base import (
    Setting,
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
)
from trunnion.driveline.driveline import Driveline

MOTIONS = {
    "turning, shafts rigid": "turning",
    "a mode": "mode",
    "response to what excites it": "response",
    "true periodic motion": "motion",
    "the disturbance that grows fastest": "disturbance",
    "run-up": "run-up",
    "scenario of the file": "transient",
    "passed or captured": "passing",
}
ASKS = {
    "turning": ("speed",),
    "mode": ("mode",),
    "response": ("speed",),
    "motion": ("speed",),
    "disturbance": ("speed",),
    "run-up": ("rate",),
    "transient": ("scenario",),
    "passing": ("scenario",),
}
"""Which controls a motion has."""


class _LivePane(VariantPane["LiveView"]):
    """The player, or why there is nothing to play."""

    def make(self) -> None:
        """Both, made once."""
        # One WebGL context a page: the kept variant is drawn without.
        now = self.variant == "now"
        self.player = Player(sizing_mode="stretch_width", flat=not now)
        self.text = pane()
        self.player.param.watch(lambda event: self.view.pick(event.new), "picked")
        self.player.styles = {"flex": "3 1 320px", "min-width": "0"}
        self.editor = Editor(
            self.view.edited, alone=True, visible=False, styles={"flex": "1 1 250px", "min-width": "0"}
        )
        beside = wrapped(self.player, *([self.editor] if now else []), styles={"gap": "12px"})
        self.panel = column(beside, self.text)
        self.parts = {("scene",): [self.player, self.text]}

    def edit(self, name: str) -> None:
        """The fields of an element beside the picture; none where there is none of that name."""
        groups = self.view.group_of(name)
        self.editor.show(groups)
        self.editor.visible = bool(groups)
        if self.player.picked != name:
            self.player.picked = name

    def clear(self) -> None:
        """Nothing to play."""
        self.player.scene, self.text.object = "", ""

    def show_scene(self, step: ViewStep, data: str) -> None:
        """Play a motion."""
        self.player.scene, self.text.object = data, ""

    def refused(self, step: ViewStep, sentence: str) -> None:
        """Why it cannot be shown."""
        self.player.scene, self.text.object = "", small(sentence)


class LiveView(View):
    """One motion at a time."""

    name = "live"
    about = (
        "The line in space, as it turns, swings and twists: drag to turn it, the wheel and + − to come closer, the "
        "space bar to hold it; click a part to change it. Twist is exaggerated as it says; bends and planes are true."
    )
    side = _LivePane
    asks, asked_by = ASKS, ("what",)
    defaults = {"what": "turning", "speed": None, "mode": 1, "rate": None, "scenario": "", "part": ""}

    fields = {
        "what": lambda: select("Motion", options=MOTIONS, width=260),
        "speed": lambda: optional("Speed", start=0.0, width=170),
        "mode": lambda: count("Mode", 1, 1, 500),
        "rate": lambda: number("Acceleration [rad/s²]", None, start=0.01, width=170),
        "scenario": lambda: select("Scenario of the file", options=[]),
        "part": lambda: select("Part to change", options=[]),
    }

    def adapt(self, line: Driveline) -> None:
        """The unit of speeds, the scenarios."""
        label_speed(self.widgets["speed"], line)
        self.widgets["rate"].placeholder = "ten seconds for the range"
        self.choose("scenario", [one.name for one in line.scenarios])
        self.choose("part", ["", *line.as_stated.names])
        self.show_question()
        self.widgets["part"].visible = True
        self._change(str(self.settings["part"]))

    def show_question(self) -> None:
        """And always which part is changed."""
        super().show_question()
        self.widgets["part"].visible = True

    def chosen(self, key: str, value: Setting) -> None:
        """A part is changed beside the picture."""
        super().chosen(key, value)
        if key == "part":
            self._change(str(value))

    def _change(self, name: str) -> None:
        """Show the fields of an element beside the picture."""
        side = self.of("now")
        assert isinstance(side, _LivePane)
        side.edit(name)

    def pick(self, name: str) -> None:
        """A body was clicked: what it belongs to in the file is the part to change."""
        line = self.session.document.line.as_stated
        known = name in line.names or any(name.startswith(f"{one}.") for one in line.names)
        part = line.names[line.index(name)] if known else ""
        if part != self.settings["part"]:
            self.put("part", part)
            self._change(part)

    def group_of(self, name: str) -> tuple[FieldGroup, ...]:
        """The fields of an element of the file."""
        return self.session.document.about(name)

    def edited(self, data: dict[str, Any]) -> None:
        """What is done in the fields beside the picture."""
        self.session.edit(change_of(data))
        self._change(str(self.settings["part"]))

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The motion that is asked for."""
        what = str(self.settings["what"])
        more: dict[str, Any] = {}
        match what:
            case "mode":
                more = {"mode": bounded(self.settings["mode"], 1, 500)}
            case "run-up":
                more = {"speeds": speed_range(line)}
                if (rate := self.typed("rate")) is not None:
                    more["acceleration"] = rate
            case "passing":
                more = {"speeds": speed_range(line), "scenario": str(self.settings["scenario"]) or None}
            case "transient":
                more = {"scenario": str(self.settings["scenario"])}
            case _:
                more = {"speed": at_speed(line, self.typed("speed"))}
        call = Call("tn.animate", (LINE, what), more)
        return [
            ViewStep(
                "animation",
                call,
                "scene",
                picture="",
                files=("html", "gif", "json"),
                title=what,
                soft=True,
                lasting=True,
            )
        ]

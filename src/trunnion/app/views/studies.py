"""Studies that ``trunnion study`` keeps where the application was started, also while they grow."""

from __future__ import annotations

import asyncio
from functools import partial
from time import monotonic
from typing import Any

from trunnion.app.parts.calls import Call
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.stores import grown, stores_here
from trunnion.app.parts.widgets import column, markup, pane, pre
from trunnion.app.views.base import VariantPane, View, ViewStep, select
from trunnion.driveline.driveline import Driveline
from trunnion.results.durations import time_text

FIRST, USUAL = "the first", "as the points ask"
AUTO = "auto"
NONE = "none here"
KINDS = {USUAL: "", "chart": "chart", "slices": "slices", "histogram": "histogram", "parallel coordinates": "parallel",
         "boundary": "boundary"}  # fmt: skip
EVERY = 1.0
"""Seconds between looks at whether a store has grown."""


class _StudiesPane(VariantPane["StudiesView"]):
    """How far a study is, its picture, and what it says."""

    def make(self) -> None:
        """Places of the picture and of the words above and below it."""
        self.state, self.picture, self.text = pane(), Canvas(), pane()
        self.panel = column(self.state, self.picture.panel, self.text)
        self.parts = {("study",): [self.state, self.picture.panel, self.text]}
        self.begun: tuple[float, int] | None = None

    def begin(self, what: str) -> None:
        """Another store is another course."""
        if what != self.what:
            self.begun = None
        super().begin(what)

    def clear(self) -> None:
        """Show nothing."""
        self.picture.clear()
        self.state.object = self.text.object = ""

    def show_study(self, step: ViewStep, data: Any) -> None:
        """Points that are there, and the picture of them."""
        self.state.object = self._state(data)
        self.text.object = pre(data["text"])
        if data["picture"] is None:
            self.picture.clear()
        else:
            self.picture.show(data["picture"])
        if self.variant == "now":
            self.view.found(data)

    def refused(self, step: ViewStep, sentence: str) -> None:
        """Say why nothing is shown."""
        self.picture.clear()
        self.text.object = sentence

    def _state(self, data: Any) -> Any:
        there, points = data["done"] + data["failed"], data["points"]
        said = f"{there} of {points} points"
        if data["failed"]:
            said += f", {data['failed']} of them failed"
        if there < points:
            now = monotonic()
            if self.begun is None:
                self.begun = now, there
            seconds, more = now - self.begun[0], there - self.begun[1]
            if more > 0 and seconds > 0:
                said += f", {more / seconds:.3g} a second, {time_text((points - there) * seconds / more)} left"
        bar = "<progress aria-label='points that are computed' max='{}' value='{}' style='width:240px'></progress> "
        words = markup("<span data-study='{}'>{}</span>", "whole" if there == points else "growing", said)
        return markup("<div>{}{}</div>", markup(bar, max(points, 1), there), words)


class StudiesView(View):
    """What studies have found so far."""

    name = "studies"
    about = (
        "Studies whose stores are in the folder where the application was started, or two folders below; they are "
        "begun by trunnion study FILE.toml. The picture follows a store that grows."
    )
    side = _StudiesPane
    defaults = {"store": NONE, "kind": USUAL, "quantity": FIRST, "x": AUTO, "y": AUTO}

    fields = {
        "store": lambda: select("Store", options=[NONE], width=260),
        "kind": lambda: select("Picture", options=list(KINDS)),
        "quantity": lambda: select("Quantity", options=[FIRST]),
        "x": lambda: select("Along", options=[AUTO]),
        "y": lambda: select("Up", options=[AUTO]),
    }
    asked_by = ("store",)

    def arrange(self) -> Any:
        """The controls; nobody looks at a store yet."""
        self.watching: asyncio.Task[None] | None = None
        self.seen = ""
        return super().arrange()

    def show_question(self) -> None:
        """Another store has quantities and parameters of its own."""
        self.seen = ""
        for key in ("quantity", "x", "y"):
            self.settings[key] = self.defaults[key]
        for side in self.sides.values():
            side.begin(str(self.settings["store"]))

    def adapt(self, line: Driveline) -> None:
        """Stores that are there now; from then on look whether the chosen one grows."""
        self.choose("store", stores_here() or [NONE])
        self.session.beside(self._watch())

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The store as it is."""
        store = str(self.settings["store"])
        if store == NONE or store not in self.widgets["store"].options:
            return []
        return [self._step(store)]

    def _step(self, store: str) -> ViewStep:
        shown = {
            "kind": KINDS[str(self.settings["kind"])],
            "quantity": self._or_nothing("quantity"), "x": self._or_nothing("x"), "y": self._or_nothing("y"),
        }  # fmt: skip
        read = Call("tn.read_study", (store,))
        return ViewStep("study", read, "study", shown, drawing=shown, title="the study", soft=True)

    def _or_nothing(self, key: str) -> str:
        value = str(self.settings[key])
        return "" if value == self.defaults[key] else value

    def found(self, data: Any) -> None:
        """Quantities and parameters that may be chosen."""
        for key, names in (("quantity", data["quantities"]), ("x", data["grids"]), ("y", data["grids"])):
            self.choose(key, [str(self.defaults[key]), *names])

    async def _watch(self) -> None:
        """Ask for what is new in the store, as long as the view is looked at; one watch at a time."""
        if self.watching is not None and not self.watching.done():
            return
        self.watching = asyncio.current_task()
        while self.session.is_looked_at(self):
            await asyncio.sleep(EVERY)
            store, settings = str(self.settings["store"]), dict(self.settings)
            if store == NONE or (now := grown(store)) == self.seen:
                continue
            step = self._step(store)
            data = await self.session.ask(step.call, step.show, "now", step.options)
            self.seen = now
            if self.settings == settings:
                self.session.locked(partial(self.of("now").show, step, data))

"""A measured file over what the line predicts: dropped here, its orders on the line's own pictures."""

from __future__ import annotations

import tomllib
from functools import partial
from typing import Any

import panel as pn

from trunnion.app.parts.calls import LINE, Call, SentFile
from trunnion.app.parts.canvas import Canvas
from trunnion.app.parts.drop import Drop
from trunnion.app.parts.received import ReceivedFile
from trunnion.app.parts.widgets import column, items, markup, pane, wrapped
from trunnion.app.views.base import Setting, VariantPane, View, ViewStep, bounded, count, select, springs_of
from trunnion.driveline.driveline import Driveline
from trunnion.errors import InputError, TrunnionError
from trunnion.measured.signals.channel_file import KINDS, description_of

FIRST, MOVES, NOWHERE, UNUSED = "the first with pulses", "the first that moves", "nowhere", "not used"
MOST_COLUMNS = 24
"""Columns of a file that have fields; more need a description."""
LONGEST_LABEL = 60
MOST_TURNS = 1000
NO_FILE = "No measured file yet: nothing is computed."
NO_REFERENCE = "No reference run: orders that errors of the teeth could hide are named below the pictures."


class _MeasuredPane(VariantPane["MeasuredView"]):
    """Orders, Campbell diagram and run-up with what was measured on them, and sentences on what differs."""

    def make(self) -> None:
        """Places of the pictures and sentences."""
        self.said, self.findings = pane(), pane()
        self.orders, self.campbell, self.run_up, self.without = Canvas(), Canvas(), Canvas(), pane()
        pictures = [self.orders.panel, self.said, self.campbell.panel, self.run_up.panel, self.without, self.findings]
        self.panel = column(*pictures)
        self.parts = {
            ("measured",): [self.orders.panel, self.said, self.findings],
            ("measured_campbell",): [self.campbell.panel],
            ("measured_run_up",): [self.run_up.panel, self.without],
        }

    def clear(self) -> None:
        """Show nothing of another file."""
        for canvas in self.canvases.values():
            canvas.clear()
        self.said.object = self.findings.object = self.without.object = ""

    def show_measured(self, step: ViewStep, data: Any) -> None:
        """Orders of one channel over the line's, and of every channel what differs."""
        self.orders.show(data["picture"])
        self.said.object = markup("<div data-measured='deviations'>{}</div>", items(data["said"]))
        self.findings.object = items(data["findings"]) if data["findings"] else ""
        if self.variant == "now":
            self.view.found(data)

    def show_measured_campbell(self, step: ViewStep, picture: Any) -> None:
        """Measured orders on the Campbell diagram."""
        self.campbell.show(picture)

    def show_measured_run_up(self, step: ViewStep, picture: Any) -> None:
        """Largest measured torques on the run-up of the line."""
        self.run_up.show(picture)
        self.without.object = ""

    def refused(self, step: ViewStep, sentence: str) -> None:
        """Say why one of them is not there."""
        sentence = self.view.named(sentence)
        if step.name == "over":
            self.clear()
            self.said.object = markup("<p class='refusal' data-measured='refused'>{}</p>", sentence)
        elif step.name == "campbell":
            self.campbell.clear()
        else:
            self.run_up.clear()
            self.without.object = "" if sentence in str(self.said.object) else f"Run-up: {sentence}."


class MeasuredView(View):
    """What the bench recorded, over what the line predicts."""

    name = "measured"
    about = (
        "Drop what a bench recorded: its orders are laid over the response, the Campbell diagram and the run-up of the "
        "line, with a sentence for each order on what differs. A run with the joints straight and without load, "
        "dropped first and taken as the reference, tells the errors of the teeth, which are taken off. Files stay on "
        "this machine until another one comes, Forget is pressed, or the page is closed; then they are deleted."
    )
    side = _MeasuredPane
    defaults = {"orders": "", "reference": FIRST, "channel": MOVES, "turns": 8}
    fields = {
        "orders": lambda: pn.widgets.TextInput(label="Orders", placeholder="auto: those that stand out", width=210),
        "reference": lambda: select("Rotation from", options=[FIRST]),
        "channel": lambda: select("Channel", options=[MOVES]),
        "turns": lambda: count("Turns of a window", 8, 1, MOST_TURNS),
    }

    def arrange(self) -> Any:
        """Where files are dropped, fields for what their columns are, and how orders are taken."""
        self.file: ReceivedFile | None = None
        self.description: dict[str, Any] | None = None
        self.columns: list[str] = []
        self.torques: list[str] = []
        self.drop = Drop(self._received, self._described, sizing_mode="stretch_width", margin=(5, 10))
        self.forget = pn.widgets.Button(label="Forget the file", width=130, visible=False)
        self.forget.on_click(lambda event: self._forget())
        self.state = pane(NO_FILE)
        self.table = column()
        self.still: tuple[ReceivedFile, dict[str, Any]] | None = None
        self.keep_still = pn.widgets.Button(label="Take it as the reference run", width=200, visible=False)
        self.keep_still.on_click(lambda event: self._take_as_reference())
        self.forget_still = pn.widgets.Button(label="Forget the reference run", width=180, visible=False)
        self.forget_still.on_click(lambda event: self._forget_reference())
        self.still_state = pane(NO_REFERENCE)
        chosen = self.row("orders", "reference", "channel", "turns")
        files = (wrapped(self.state, self.forget, self.keep_still), wrapped(self.still_state, self.forget_still))
        return column(self.drop, *files, self.table, chosen)

    # -- files ----------------------------------------------------------------------------------------------------

    def _received(self, file: ReceivedFile, stated: tuple[str, str] | None) -> None:
        """A file is there, whole; it takes the place of the one before."""
        self._forget(again=False)
        self.file, self.forget.visible = file, True
        self._state()
        try:
            if stated is not None:
                self._described(*stated)
                return
        except InputError as error:
            self.drop.say(str(error), alarm=True)
        else:
            if self.still is not None:
                self._take(self.still[1], f"its columns as in {self.still[0].name}; else drop its .channels.toml")
                return
        self.session.setting_chosen()
        self.session.beside(self._ask_columns(file))

    def _described(self, name: str, text: str) -> None:
        """A description of channels came, with a file or for the one that is there.

        Raises
        ------
        InputError : it cannot be read, or there is no file for it.
        """
        if self.file is None:
            raise InputError("describes no file", key="channels", value=name, remedy="drop the measured file with it")
        try:
            content = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise InputError(f"is not TOML ({error})", key="channels", value=name) from None
        description_of(content, name)
        self._take(content, f"described by {name}")

    def _take(self, content: dict[str, Any], how: str) -> None:
        self.description = content
        self.table.objects = []
        self._state(how)
        self.session.setting_chosen()

    def _forget(self, *, again: bool = True) -> None:
        """Delete the file, and show nothing of it."""
        if self.file is not None:
            self.file.close()
        self.file, self.description, self.table.objects = None, None, []
        self.forget.visible = False
        for side in self.sides.values():
            side.shown = {}
            side.clear()
        self._state()
        if again:
            self.session.setting_chosen()

    def _take_as_reference(self) -> None:
        """The file that is there tells the errors of the teeth; the next one is the run."""
        if self.file is None or self.description is None:
            return
        if self.still is not None:
            self.still[0].close()
        self.still, self.file = (self.file, self.description), None
        self.forget_still.visible = True
        self._forget()

    def _forget_reference(self) -> None:
        """Delete the reference run, and take nothing off any more."""
        if self.still is not None:
            self.still[0].close()
        self.still, self.forget_still.visible = None, False
        self.still_state.object = self._reference_words()
        self.session.setting_chosen()

    def close(self) -> None:
        """The page is gone: so are the files."""
        self.drop.close()
        for file in (self.file, None if self.still is None else self.still[0]):
            if file is not None:
                file.close()

    def _state(self, how: str = "its columns are to be named below") -> None:
        self.keep_still.visible = self.file is not None and self.description is not None
        self.state.object = NO_FILE if self.file is None else f"{self.file.name}, {self.file.size} bytes, {how}"
        self.still_state.object = self._reference_words()

    def _reference_words(self) -> str:
        """Which reference run is taken off, and what comes next."""
        if self.still is None:
            return NO_REFERENCE
        what = "What repeats with the teeth in it is taken for their error and taken off."
        after = "" if self.file is not None else " Drop the run."
        return f"Reference run: {self.still[0].name}, {self.still[0].size} bytes. {what}{after}"

    def named(self, sentence: str) -> str:
        """A sentence with the names of files as the user knows them."""
        for file in (self.file, None if self.still is None else self.still[0]):
            if file is not None:
                sentence = sentence.replace(str(file.path), file.name)
        return sentence if self.file is None else sentence.replace(self.file.path.name, self.file.name)

    # -- columns without a description ----------------------------------------------------------------------------

    async def _ask_columns(self, file: ReceivedFile) -> None:
        try:
            found = await self.session.ask(LINE, "columns", "now", {"path": str(file.path)})
        except TrunnionError as error:
            words = self.named(str(error))
            self.session.locked(partial(self._say_unread, file, words))
            return
        self.session.locked(partial(self._offer, file, found))

    def _say_unread(self, file: ReceivedFile, words: str) -> None:
        if file is self.file:
            self._forget()
            self.drop.say(words, alarm=True)

    def _offer(self, file: ReceivedFile, found: Any) -> None:
        """Fields for the columns of a file."""
        if file is not self.file or self.description is not None:
            return
        self.columns = found["columns"][:MOST_COLUMNS]
        line = self.session.document.line
        places = [NOWHERE, *places_of(line)]
        self.cells: list[dict[str, Any]] = []
        rows = []
        for name in self.columns:
            short = name[:LONGEST_LABEL]
            at = name if name in places else NOWHERE
            cells = {
                "kind": select(f"{short} is", options=[UNUSED, *KINDS], width=150),
                "at": pn.widgets.Select(label=f"{short} at", options=places, value=at, width=150),
                "pulses": pn.widgets.IntInput(label=f"{short}: pulses per turn", value=60, start=1, width=140),
                "unit": pn.widgets.TextInput(label=f"{short}: unit", placeholder="N*m, say", width=120),
                "scale": pn.widgets.FloatInput(label=f"{short}: times", value=1.0, width=110),
            }
            self.cells.append(cells)
            rows.append(wrapped(*cells.values()))
        self.rate = pn.widgets.TextInput(
            label="Rate of the samples", value=f"{found['rate']:.12g} Hz" if found["rate"] else "", width=150,
            placeholder="200 kHz, say",
        )  # fmt: skip
        self.time = select("Column with times", options=["none", *self.columns], width=150)
        read = pn.widgets.Button(label="Read these channels", width=170, align="end")
        read.on_click(lambda event: self._read_fields())
        more = len(found["columns"]) - len(self.columns)
        said = [pane(f"{more} more columns have no fields: describe them in a .channels.toml.")] if more else []
        self.table.objects = [*rows, *said, wrapped(self.rate, self.time, read)]

    def _read_fields(self) -> None:
        """Take what the fields say."""
        try:
            content = self.stated()
            description_of(content, self.file.name if self.file else "channels")
        except InputError as error:
            self.drop.say(str(error), alarm=True)
            return
        self.drop.say("")
        how = f"{len(content['channel'])} of its columns as named in the fields"
        table = self.table.objects
        self._take(content, how)
        self.table.objects = table

    def stated(self) -> dict[str, Any]:
        """What the fields say, as a description of channels."""
        channels = []
        for k, (name, cells) in enumerate(zip(self.columns, self.cells, strict=True), start=1):
            kind, at = cells["kind"].value, cells["at"].value
            if kind == UNUSED:
                continue
            one: dict[str, Any] = {"column": k, "name": name[:LONGEST_LABEL], "kind": kind}
            one |= {} if at == NOWHERE else {"at": at}
            if kind in ("pulses", "edges"):
                one["pulses_per_turn"] = int(cells["pulses"].value or 0)
            else:
                one |= {"unit": unit} if (unit := str(cells["unit"].value or "").strip()) else {}
                one |= {"scale": float(cells["scale"].value or 0.0)} if cells["scale"].value != 1.0 else {}
            channels.append(one)
        top: dict[str, Any] = {"rate": self.rate.value.strip()} if (self.rate.value or "").strip() else {}
        if self.time.value != "none":
            top["time"] = self.columns.index(self.time.value) + 1
        return {**top, "channel": channels}

    # -- computations ---------------------------------------------------------------------------------------------

    def found(self, data: Any) -> None:
        """Channels that may be chosen."""
        self.choose("channel", [MOVES, *data["channels"]])
        self.choose("reference", [FIRST, *data["references"]])
        self.torques = data["torques"]

    def orders(self) -> tuple[float, ...] | None:
        """The orders that are asked for.

        Raises
        ------
        InputError : what is typed is no list of numbers.
        """
        text = str(self.settings["orders"]).strip()
        try:
            return tuple(float(one) for one in text.split(",")) if text else None
        except ValueError:
            raise InputError("is not a list of orders", key="orders", value=text, remedy='write "0.5,1,2"') from None

    def steps(self, line: Driveline) -> list[ViewStep]:
        """The comparison on three pictures, once there is a file and what its columns are."""
        if self.file is None or self.description is None:
            return []
        read = Call("tn.read_measurement", (SentFile(self.file.name, str(self.file.path)), self.description))
        more: dict[str, Any] = {"line": LINE, "window": bounded(self.settings["turns"], 1, MOST_TURNS)}
        if self.settings["reference"] != FIRST:
            more["reference"] = self.settings["reference"]
        if self.still is not None:
            still, columns = self.still
            run = Call("tn.read_measurement", (SentFile(still.name, str(still.path)), columns))
            more["calibration"] = Call("tn.pitch_errors", (run,))
        tracked = Call("tn.track_orders", (read, self.orders()), more)
        over = Call("tn.compare_measured", (LINE, tracked))
        channel = str(self.settings["channel"])
        shown: dict[str, Setting] = {} if channel == MOVES else {"channel": channel}
        torque = shown if channel in self.torques else {}
        return [
            self._step("over", over, shown, "plot", "measured and predicted orders"),
            self._step("campbell", over, shown, "plot_campbell", "measured orders on the Campbell diagram"),
            self._step("run-up", over, torque, "plot_run_up", "measured torque on the run-up"),
        ]

    def _step(self, name: str, call: Call, shown: dict[str, Setting], picture: str, title: str) -> ViewStep:
        kind = picture.replace("plot", "measured")
        files = ("nc",) if name == "over" else ()
        return ViewStep(
            name, call, kind, shown, picture=picture, drawing=shown, files=files, title=title, soft=True, lasting=True
        )


def places_of(line: Driveline) -> list[str]:
    """Where a channel may be: disks, the driven end, springs."""
    from trunnion.equations.coefficients import assemble  # no first page needs them
    from trunnion.measured.tracking.places import even_places

    assembly = assemble(line)
    disks = [name for _, name in assembly.topology.points]
    return list(dict.fromkeys([*even_places(assembly), *disks, *springs_of(line)]))

"""One page in one browser: its line, what it looks at, and the computations under way for it."""

from __future__ import annotations

import asyncio
import secrets
import traceback
from collections.abc import Callable, Mapping
from functools import partial
from itertools import count, zip_longest
from typing import Any

import panel as pn
from panel.io.document import unlocked
from panel.io.state import set_curdoc

from trunnion.app import address
from trunnion.app.page import Page
from trunnion.app.parts.calls import LINE, Call, script
from trunnion.app.parts.document import Document
from trunnion.app.parts.jobs import Job, WorkerMessage
from trunnion.app.parts.variant_strip import MOST_KEPT, MOST_SHOWN, UPON, KeptVariant, VariantStrip, free_name
from trunnion.app.parts.variants import Sliders, difference
from trunnion.app.parts.widgets import Html, joined, markup, pane
from trunnion.app.pool import SUPERSEDED, Pool
from trunnion.app.views import VIEWS
from trunnion.app.views.base import View, ViewStep, links
from trunnion.app.warming import WARMING
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import loads
from trunnion.errors import InputError, TrunnionError

PAUSE = 0.05
"""Seconds without a further change before a computation takes the place of one under way."""
QUICK = 0.15
"""Seconds that a computation takes at most for which nothing is shown in advance."""
UNSAID = 0.25
"""Seconds that a computation takes without a word: a bar that comes and goes at once only makes the page jump."""
REST = 0.5
"""Seconds after a change of the page when what may have stayed behind is sent."""
NOW = "now"
LONGEST_NAME = 40
"""Letters of the name of a variant."""
JUDGED_AFTER = 0.6
"""Seconds without a further change before the strip of variants has a line judged."""
EDITOR = "driveline"
"""The view of an address that names none but says something else; a fresh page begins with the first."""
KINDS: dict[str, type[View]] = {kind.name: kind for kind in VIEWS}


class Session:
    """Everything of one page. ``changed`` functions are called in the event loop, with the document locked."""

    def __init__(self, toml: str, pool: Pool, sessions: dict[str, Session]) -> None:
        self.pool = pool
        self.token = secrets.token_urlsafe(24)
        self.document = Document(toml)
        self.variants: list[KeptVariant] = []
        self.fresh = count(1)
        self.is_upon = False
        self.said_from = 0.0
        self.task: asyncio.Task[None] | None = None
        self.rest: asyncio.TimerHandle | None = None
        self.resting = False
        self.side_tasks: set[asyncio.Task[None]] = set()
        self.known: dict[tuple[str, str, str], tuple[Job, WorkerMessage]] = {}
        self.took: dict[tuple[str, str], float] = {}
        self.query = _query()
        self.unread = False
        failure = self._read_lines()
        name = self.query.get("view", "")
        first = name if name in KINDS else EDITOR if self.query else VIEWS[0].name
        titles = {kind.name.capitalize(): kind.name for kind in VIEWS}
        self.page = Page(titles, first, self.show_view, self.cancel)
        self.sliders = Sliders(
            self.document.line,
            lambda line, path: self.edit(lambda document: document.set_numbers(line, path)),
            lambda: self.guarded(self._write_address),
        )
        self.sliders.read(self.query)
        self.strip = VariantStrip(self)
        self.verdict: tuple[str, Html | str] = ("", "")
        self.views: dict[str, View] = {}
        self.view = self.view_of(first)
        self.difference = pane()
        self.page.fill(self.sliders.panel, self.strip.panel, self.difference)
        self.template = self.page.template
        self.doc = pn.state.curdoc
        self.location = pn.state.location
        sessions[self.token] = self
        pn.state.on_session_destroyed(lambda context: self._destroyed(sessions))
        pn.state.onload(lambda: self.guarded(self._line_changed))
        self.page.message(failure)

    def view_of(self, name: str) -> View:
        """A view, made when it is first needed, with the settings that the address gave. KeyError: no such view."""
        if name not in self.views:
            view = self.views[name] = KINDS[name](self)
            start = f"{name}."
            view.read({k.removeprefix(start): v for k, v in self.query.items() if k.startswith(start)})
        return self.views[name]

    def _read_lines(self) -> str:
        """Take over the lines of the address; what is wrong with them."""
        try:
            if "line" in self.query:
                self.document = Document(address.unpack(self.query["line"]))
        except InputError as error:
            self.unread = True
            return f"The address holds no driveline that can be read: {error}"
        try:
            for key in address.kept_keys(self.query):
                name = self.query.get(f"{key}.name", "")
                self._add_variant(Document(address.unpack(self.query[key])), name, f"{key}.hidden" not in self.query)
        except InputError as error:
            return f"The address holds no kept variant that can be read: {error}"
        return ""

    def _destroyed(self, sessions: dict[str, Session]) -> None:
        sessions.pop(self.token, None)
        if self.rest:
            self.rest.cancel()
        self._drop_tasks()
        for view in self.views.values():
            view.close()

    # -- what the user does ---------------------------------------------------------------------------------------

    def guarded(self, action: Callable[[], Any]) -> None:
        """Change the page, all of it in one message; a refusal or a failure is said on it."""
        try:
            with unlocked():
                action()
        except TrunnionError as error:
            self.page.message(str(error))
        except Exception as error:
            traceback.print_exc()
            self.page.message(f"unexpected {type(error).__name__}: {error}. The page goes on; undo the last change.")
            for side in self.view.sides.values():
                side.disown("After an unexpected failure: what is shown may be of an earlier line or other settings.")
        finally:
            self._send_rest_soon()

    def _send_rest_soon(self) -> None:
        """Panel 1.9 leaves a message unsent that comes while it writes a large one, until the next: as "computing …"
        for good behind the picture of the forks. That next one is made here, when the page rests."""
        if self.rest:
            self.rest.cancel()
        self.rest = asyncio.get_event_loop().call_later(REST, self._send_rest)

    def _send_rest(self) -> None:
        def work() -> None:
            with set_curdoc(self.doc), unlocked():
                self.page.send_rest()

        self._next(work)

    def edit(self, change: Callable[[Document], Any]) -> None:
        """Change the line, and everything that follows from it."""

        def work() -> None:
            self.page.message("")
            change(self.document)
            self.unread = False
            self._line_changed()

        self.guarded(work)

    # -- variants -------------------------------------------------------------------------------------------------

    def keep(self, name: str) -> None:
        """Keep the present line under a name."""

        def work() -> None:
            if len(self.variants) >= MOST_KEPT:
                remedy = "drop one first"
                raise InputError(f"are kept already, {MOST_KEPT} at most", element="variants", remedy=remedy)
            self._add_variant(self.document, name, True)
            self._line_changed()

        self.guarded(work)

    def _is_room(self) -> bool:
        return sum(one.is_shown for one in self.variants) < MOST_SHOWN

    def _add_variant(self, document: Document, name: str, is_shown: bool) -> None:
        taken = {one.name for one in self.variants}
        name = name[:LONGEST_NAME]
        named = free_name(self.variants) if not name or name in taken else name
        key = f"kept {next(self.fresh)}"
        shown = is_shown and self._is_room()
        self.variants.append(KeptVariant(key, named, document.toml, document.file().text, shown))

    def _variant(self, key: str) -> KeptVariant:
        return next(one for one in self.variants if one.key == key)

    def show_variant(self, key: str, is_shown: bool) -> None:
        """Show a variant beside the present line, or no more."""
        self._variant(key).is_shown = is_shown and (self._is_room() or self._variant(key).is_shown)
        if is_shown and not self._variant(key).is_shown:
            self.page.message(f"{MOST_SHOWN} variants are shown at most: hide one first.")
        self.guarded(self._line_changed)

    def compare_all_no_more(self) -> None:
        """Show none of the kept variants."""
        for one in self.variants:
            one.is_shown = False
        self.guarded(self._line_changed)

    def drop(self, key: str) -> None:
        """Keep a variant no more."""
        self.variants = [one for one in self.variants if one.key != key]
        self.known = {of: answer for of, answer in self.known.items() if of[1] != key}
        for view in self.views.values():
            view.sides.pop(key, None)
        self.guarded(self._line_changed)

    def swap(self, key: str) -> None:
        """Make a variant the present line, and keep that in its place; undo takes the line back."""
        one = self._variant(key)
        other, one.toml, one.file = one.file, self.document.toml, self.document.file().text
        one.verdict = ""
        self.edit(lambda document: document.replace_text(other))

    def arrange_variants(self, how: str) -> None:
        """Beside each other, or on the same axes."""
        self.is_upon = how == UPON
        self.guarded(self._look)

    def _judge_variants(self) -> None:
        """Have what the strip says of the present line, and of every variant, be the verdict on that very line."""
        asked = {one.toml for one in self.variants if not one.verdict}
        if self.variants and self.verdict[0] != self.document.toml:
            asked.add(self.document.toml)
        for toml in asked:
            self._say_verdict(toml, markup("<span data-variant='not yet checked'>not yet checked</span>"))
            self.beside(self._verdict_of(toml))

    async def _verdict_of(self, toml: str) -> None:
        try:
            await asyncio.sleep(JUDGED_AFTER)
            if toml not in (self.document.toml, *(one.toml for one in self.variants)):
                return  # a slider under way
            found = (await self.pool.run(Job(toml, Call("tn.assess", (LINE,)), "verdict_in_short"), self)).value
        except TrunnionError as error:
            found = {"verdict": "not judged", "said": str(error)}
        except asyncio.CancelledError:
            self._ask_again(toml)
            raise
        said = markup("<span data-variant='{0}'>{1}</span>", found["verdict"], found["said"])
        self.locked(partial(self._say_verdict, toml, said))

    def _ask_again(self, toml: str) -> None:
        """A search that was cancelled has no verdict; the next change of the page begins it anew."""
        for one in self.variants:
            if one.toml == toml:
                one.verdict = ""
        if self.verdict[0] == toml:
            self.verdict = ("", "")

    def _say_verdict(self, toml: str, said: Html) -> None:
        for one in self.variants:
            if one.toml == toml:
                one.verdict = said
        if toml == self.document.toml:
            self.verdict = (toml, said)
        self.strip.show(self.variants, self.verdict[1] if self.verdict[0] == self.document.toml else "")

    def show_view(self, name: str) -> None:
        """Look at another view."""
        self.view = self.view_of(name)
        self.page.message("")
        self.guarded(self._view_changed)

    def state_limits(self) -> None:
        """Give every spring without one a limit to fill in, by kind, and go where it stands."""
        from trunnion.design.assessment.stated_limits import unlimited  # no first page needs them
        from trunnion.equations.coefficients import assemble

        line = self.document.line
        kinds = {type(line.elements[line.index(name)]).__name__: None for name in unlimited(assemble(line))}

        def change(document: Document) -> None:
            for kind in kinds:
                document.add_limit(f"{kind} *")

        self.view = self.view_of("driveline")
        self.edit(change)
        whose = " and ".join(f"every {kind}" for kind in kinds)
        self.page.message(f"500 N m stands for {whose} at the end of the table: type what yours may bear.")

    def _line_changed(self) -> None:
        self.sliders.adapt(self.document.line)
        shown = [one for one in self.variants if one.is_shown]
        self.difference.object = joined(difference(one.name, one.toml, self.document.line) for one in shown)
        self.strip.show(self.variants, self.verdict[1] if self.verdict[0] == self.document.toml else "")
        self._judge_variants()
        self._view_changed()

    def _view_changed(self) -> None:
        self.view.adapt(self.document.line)
        self._look()

    def setting_chosen(self) -> None:
        """The user changed a setting of the visible view."""
        self.page.message("")
        self.guarded(self._look)

    def _look(self) -> None:
        """Compute what the visible view shows; whatever was under way for it is dropped."""
        names = {one.key: one.name for one in self.variants if one.is_shown} | {NOW: "now"}
        sides = list(names)
        self.page.show(self.view, names, self.is_upon)
        self._write_address()
        under_way = self.task is not None and not self.task.done() and not self.resting
        if self.task:
            self.task.cancel(SUPERSEDED)
        try:
            self._expect(sides)
            self.view.show_upon()
            self.view.downloads.object = self._links()
        except TrunnionError as error:
            self.task, self.view.downloads.object = None, ""
            for side in sides:
                self.view.of(side).disown(f"Not of the settings above, which are refused: {error}")
            self.page.failed(str(error))
            return
        self.task = self._begun(self._compute(sides, PAUSE if under_way else 0.0))

    def _write_address(self) -> None:
        """What a bookmark restores; an address that cannot be read stays, to be copied again."""
        if not self.unread:
            of = self.view.name, self.view.query(), self.sliders.query()
            kept = [(one.name, one.file, one.is_shown) for one in self.variants]
            self.location.search = address.address(*of, self.document.file().text, kept)

    def _expect(self, sides: list[str]) -> None:
        """Have the pictures know which line and settings they are to be of."""
        wanted = {side: [(s, s.job(self._toml(side))) for s in self.view.steps(self.line(side))] for side in sides}
        for side in sides:
            self.view.of(side).expect(wanted[side], self._doubt(side))

    def _doubt(self, side: str) -> str:
        """Why the pictures of a side are not of what stands in the table or in the address."""
        if side == NOW and self.unread:
            return "Of the line that a new page begins with: the address holds none that can be read."
        if side == NOW and self.document.problems:
            return "Of the line as it was last accepted: what is typed in the table of Driveline is refused."
        return ""

    def _links(self) -> Html:
        doubt = self._doubt(NOW)
        found = links(self.token, self.view, self.document.line)
        return markup("{}<p class='refusal'>{}</p>", found, doubt) if doubt else found

    def _tell(self, fate: str) -> None:
        """Say what became of pictures that are not of the present line or settings."""
        for side in self.view.sides.values():
            side.tell(fate)

    # -- computations ---------------------------------------------------------------------------------------------

    def beside(self, work: Any) -> None:
        """Begin a small computation beside that of the view, for a click say."""
        task = self._begun(work)
        self.side_tasks.add(task)
        task.add_done_callback(self.side_tasks.discard)

    def _begun(self, work: Any) -> asyncio.Task[None]:
        task = asyncio.get_event_loop().create_task(self._watched(work))
        task.add_done_callback(lambda ended: work.close())  # of a task that was superseded before its first step
        return task

    def cancel(self) -> None:
        """End what is under way."""
        self._drop_tasks()
        self.page.idle("cancelled")
        self._tell("the computation was cancelled")

    def _drop_tasks(self) -> None:
        for task in (self.task, *self.side_tasks):
            if task:
                task.cancel()

    async def _watched(self, work: Any) -> None:
        try:
            await work
        except Exception as error:
            if not isinstance(error, TrunnionError):
                traceback.print_exception(error)
            self.locked(partial(self._failed, str(error) or type(error).__name__))

    def _failed(self, sentence: str) -> None:
        """A computation was refused or failed: what was to be replaced by its result stays faint."""
        self.page.failed(sentence)
        self._tell("it could not be computed anew")

    async def _compute(self, sides: list[str], pause: float) -> None:
        await asyncio.sleep(pause)
        loop = asyncio.get_running_loop()
        self.said_from = loop.time() + UNSAID
        saying = loop.call_at(self.said_from, self._progress, 0, 1, 0.0)
        try:
            await self._steps(sides)
        finally:
            saying.cancel()

    async def _steps(self, sides: list[str]) -> None:
        view = self.view
        lines = {side: self._toml(side) for side in sides}
        remarks: list[str] = []
        steps = {side: self._unknown(view, side, lines[side], remarks) for side in sides}
        turns = zip_longest(*(steps[side] for side in reversed(sides)))
        order = [(side, step) for turn in turns for side, step in zip(reversed(sides), turn, strict=True) if step]
        for done, (side, step) in enumerate(order):
            begin, job = asyncio.get_running_loop().time(), step.job(lines[side])
            try:
                await self._rest(step.rest)
                answer = await self.pool.run(job, self, partial(self._progress, done, len(order)))
            except TrunnionError as error:
                if not step.soft:
                    raise
                self.locked(partial(view.refuse, side, step, job, str(error)))
            else:
                remarks += answer.remarks
                if step.lasting:
                    self.known[view.name, side, step.name] = job, answer
                self.locked(partial(view.take, side, step, job, answer.value))
            self.took[view.name, step.name] = asyncio.get_running_loop().time() - begin
        self.locked(partial(self.page.idle, "", tuple(dict.fromkeys(remarks))))
        self.pool.warm(WARMING, self)

    async def _rest(self, seconds: float) -> None:
        """Let a further change come before a step that takes long is begun."""
        if seconds:
            self.resting = True
            try:
                await asyncio.sleep(seconds)
            finally:
                self.resting = False

    def _unknown(self, view: View, side: str, toml: str, remarks: list[str]) -> list[ViewStep]:
        """The steps of a side that are to be computed; what is known is shown at once, its remarks are added."""
        left: list[ViewStep] = []
        known: list[tuple[ViewStep, Job, Any]] = []
        for step in view.steps(self.line(side)):
            job, answer = self.known.get((view.name, side, step.name), (None, None))
            if answer is None or job != step.job(toml):
                left.append(step)
            else:
                known.append((step, job, answer.value))
                remarks += answer.remarks

        def show_known() -> None:
            for known_step, of, value in known:
                view.take(side, known_step, of, value)

        if known:
            self.locked(show_known)
        names = {step.name for step in left}
        slow = {s.preview_of for s in left if s.preview_of in names and self._is_slow(view, s.preview_of)}
        quick = {s.preview_of for s in left if s.preview_of} - slow  # shown without a preview, and before all else
        wanted = [s for s in left if not s.preview_of or s.preview_of in slow]
        return sorted(wanted, key=lambda s: s.name not in quick)

    def _is_slow(self, view: View, name: str) -> bool:
        """Whether a step took long when it was last computed, or never was."""
        return self.took.get((view.name, name), QUICK) >= QUICK

    async def ask(
        self, call: Call, show: str, side: str, options: Mapping[str, Any] | None = None, *, says: bool = False
    ) -> Any:
        """What one further computation for a side gives; ``options`` of what makes plain data of it.

        Where the line has changed meanwhile nobody wants it any more: the work that asked ends. says: show progress.
        """
        toml = self._toml(side)

        def tell(share: float) -> None:
            if says and self._is_at_rest():
                self.locked(partial(self.page.busy, share))

        value = (await self.pool.run(Job(toml, call, show, options or {}), self, tell)).value
        if says and self._is_at_rest():
            self.locked(self.page.idle)
        if self._toml(side) != toml:
            raise asyncio.CancelledError
        return value

    def _is_at_rest(self) -> bool:
        """Whether nothing is computed for the view."""
        return self.task is None or self.task.done()

    def is_looked_at(self, view: View) -> bool:
        """Whether a view is the one that the page shows, and the page is open."""
        gone = self.doc.session_context is None or self.doc.session_context.destroyed
        return self.view is view and not gone

    def line(self, side: str) -> Driveline:
        """The present line, or a kept one."""
        return self.document.line if side == NOW else loads(self._toml(side))

    def _toml(self, side: str) -> str:
        kept = next((one.toml for one in self.variants if one.key == side), None)
        return self.document.toml if kept is None else kept

    def _progress(self, done: int, total: int, share: float) -> None:
        if asyncio.get_running_loop().time() >= self.said_from:
            self.locked(partial(self._busy, (done + share) / total))

    def _busy(self, share: float) -> None:
        """Progress of what is wanted still."""
        if self.task and not self.task.done() and not self.task.cancelling():
            self.page.busy(share)

    def locked(self, action: Callable[[], Any]) -> None:
        """Change the page from a task: in turn, with the document locked."""

        def work() -> None:
            with set_curdoc(self.doc):
                self.guarded(action)

        self._next(work)

    def _next(self, work: Callable[[], None]) -> None:
        if self.doc.session_context is not None and not self.doc.session_context.destroyed:
            self.doc.add_next_tick_callback(work)

    # -- files ----------------------------------------------------------------------------------------------------

    async def file(self, view_name: str, name: str, ending: str) -> bytes:
        """The content of a download. KeyError where there is none of that name."""
        view, line, toml = self.view_of(view_name), self.document.line, self.document.toml
        if (name, ending) == ("driveline", "toml"):
            return self.document.file().text.encode()
        if (name, ending) == ("driveline", "html"):
            return await self._bytes(Job(toml, Call("tn.report", (LINE,)), "report"))
        steps = {step.name: step for step in view.steps(line)}
        if (name, ending) == ("view", "py"):
            calls = {step.name: (step.call, step.toml(toml)) for step in steps.values()}
            soft = {step.name for step in steps.values() if step.soft}
            return script(toml, calls, f"{view_name.capitalize()} of {line.name or 'a driveline'}", soft).encode()
        if ending not in steps[name].endings:
            raise KeyError(ending)
        return await self._bytes(steps[name].file(toml, ending))

    async def _bytes(self, job: Job) -> bytes:
        body: bytes = (await self.pool.run(job, self)).value
        return body


def _query() -> dict[str, str]:
    return {key: values[0].decode("utf-8", "replace") for key, values in pn.state.session_args.items() if values}

"""What a page shows is of the line and the settings that stand on it, or faint with a stamp that says what it is."""

from __future__ import annotations

import asyncio
import gc
import warnings
from collections.abc import Awaitable, Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from io import BytesIO
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("panel")

import panel as pn
from bokeh.document import Document as BokehDocument

import trunnion as tn
from trunnion.app import session as module
from trunnion.app.address import pack
from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.jobs import Job, WorkerMessage
from trunnion.app.parts.widgets import FAINT, HtmlPane
from trunnion.app.session import NOW, Session
from trunnion.app.worker import WorkerLoop
from trunnion.driveline.starter import starter
from trunnion.errors import ComputationError
from trunnion.pictures.picture import EdgeNames

WORKER = WorkerLoop(BytesIO(), BytesIO(), 1)


class Held:
    """Stands for the pool of workers: computes at once, or holds every answer back until the test says so."""

    def __init__(self) -> None:
        self.held = asyncio.Event()
        self.held.set()
        self.failure = ""

    async def run(self, job: Job, owner: object, tell: Callable[[float], None] = lambda share: None) -> WorkerMessage:
        """As ``Pool.run``."""
        tell(0.0)
        await self.held.wait()
        if self.failure:
            raise ComputationError(self.failure)
        return WorkerMessage(0, "done", WORKER.compute(job, lambda share: None))

    def warm(self, jobs: tuple[Job, ...], owner: object = None) -> None:
        """Nothing beside what is tested."""


@contextmanager
def session(pool: Held, query: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> Iterator[Session]:
    """A session as a browser would open it, whose page is looked at as objects."""
    monkeypatch.setattr(module, "_query", lambda: query)
    monkeypatch.setattr(Session, "_next", lambda self, work: work())
    monkeypatch.setattr(Session, "_send_rest_soon", lambda self: None)
    monkeypatch.setattr(pn.state, "onload", lambda action: None)
    monkeypatch.setattr(pn.state, "on_session_destroyed", lambda action: None)
    made = Session(starter("two-shaft"), pool, {})  # type: ignore[arg-type]
    made.doc, made.location = BokehDocument(), SimpleNamespace(search="")
    made.guarded(made._line_changed)
    yield made


def on_session(work: Callable[[Session, Held], Awaitable[None]], monkeypatch: pytest.MonkeyPatch, **query: str) -> None:
    """Do ``work`` with a session on the verdict, once it shows what it has."""

    async def whole() -> None:
        pool = Held()
        with session(pool, {"view": "verdict", **query}, monkeypatch) as made:
            await settled(made)
            await asyncio.wait_for(work(made, pool), 240)
            made._drop_tasks()

    with ThreadPoolExecutor(1) as thread:  # the browser's driver has a loop of its own in this one
        thread.submit(asyncio.run, whole()).result()


async def settled(made: Session) -> None:
    if made.task:
        await asyncio.wait([made.task])
    await asyncio.sleep(0)


def verdict(made: Session) -> Any:
    """The picture of the present line in the view of the verdict."""
    return made.view_of("verdict").of(NOW)


def faintly(panel: Any) -> bool:
    return all(panel.styles.get(key) == value for key, value in FAINT.items())


def is_stamped(made: Session) -> bool:
    """Whether the verdict is faint and stamped; never one without the other."""
    side = verdict(made)
    stamped = bool(side.stamp.object)
    assert {faintly(panel) for panels in side.parts.values() for panel in panels} <= {stamped}
    return stamped


def turn(made: Session, angle: str) -> None:
    made.edit(lambda document: document.set_text(("element", 3, "angle"), angle))


def test_while_computing_and_after_it(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        assert not is_stamped(made)
        pool.held.clear()
        turn(made, "2.25 deg")
        assert is_stamped(made) and "computed anew" in verdict(made).stamp.object
        pool.held.set()
        await settled(made)
        assert not is_stamped(made)
        line = tn.loads(starter("two-shaft")).replace("HookeJoint 1", angle="2.25 deg")
        assert tn.assess(line).sentence.split(";")[0] in verdict(made).sentence.object

    on_session(work, monkeypatch)


def test_after_cancel_and_a_change_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        turn(made, "3 deg")
        await settled(made)
        pool.held.clear()
        turn(made, "2.25 deg")
        await asyncio.sleep(0.1)
        made.cancel()
        await settled(made)
        assert is_stamped(made) and "cancelled" in verdict(made).stamp.object
        made.edit(lambda document: document.undo())
        assert not is_stamped(made), "it is of this very line again, while it is computed once more"

    on_session(work, monkeypatch)


@pytest.mark.parametrize("text", ["200 deg", "12 parsec", ""])
def test_after_a_refused_edit_until_it_is_taken_back(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    async def work(made: Session, pool: Held) -> None:
        turn(made, text)
        for _ in range(2):
            assert is_stamped(made) and "last accepted" in verdict(made).stamp.object
            assert "last accepted" in made.view.downloads.object
            await settled(made)  # computed again, but not of what stands in the table
        made.show_view("driveline")
        await settled(made)
        view = made.view_of("driveline")
        side = view.of(NOW)
        assert side.stamp.object and faintly(view.picture) and faintly(side.modes)
        made.edit(lambda document: document.undo())
        await settled(made)
        made.show_view("verdict")
        await settled(made)
        assert not is_stamped(made) and "last accepted" not in made.view.downloads.object

    on_session(work, monkeypatch)


def test_after_a_worker_that_was_killed(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        pool.failure = "the computing process ended; try fewer points"
        turn(made, "2.25 deg")
        await settled(made)
        assert is_stamped(made) and "could not be computed" in verdict(made).stamp.object
        assert "process ended" in made.page.said.object
        pool.failure = ""
        turn(made, "2.5 deg")
        await settled(made)
        assert not is_stamped(made)

    on_session(work, monkeypatch)


def test_beside_an_address_that_cannot_be_read_until_a_line_is_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        assert "no driveline" in made.page.said.object
        assert is_stamped(made) and "new page begins with" in verdict(made).stamp.object
        assert made.location.search == "", "the address stays as it was, to be copied again"
        made.edit(lambda document: document.replace_text(starter("truck")))
        await settled(made)
        assert not is_stamped(made) and "line=" in made.location.search

    on_session(work, monkeypatch, line="eJw")


def test_a_kept_variant_that_cannot_be_read_says_nothing_of_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        assert "kept variant" in made.page.said.object
        assert not is_stamped(made)

    on_session(work, monkeypatch, line=pack(starter("two-shaft")), kept="eJw")


def test_settings_that_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The chart shown is of settings that rose; those typed now do not."""

    async def work(made: Session, pool: Held) -> None:
        side = made.view_of("limits").of(NOW)
        assert not side.stamp.object and side.text.object
        made.view.chosen("low", 60.0)
        await settled(made)
        assert "Not of the settings" in side.stamp.object and faintly(side.text)
        made.view.chosen("low", 0.0)
        made.view.chosen("error", 2.0)
        await settled(made)
        assert not side.stamp.object and not faintly(side.text)

    query = {"limits.what": "best value of a parameter", "limits.high": "20", "limits.aim": "irregularity"}
    on_session(work, monkeypatch, view="limits", **query)


@pytest.mark.slow
def test_each_part_is_of_its_own_job_and_what_is_not_asked_for_is_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    """A point that moves leaves the chart as it is; a chart over other axes is another."""

    async def work(made: Session, pool: Held) -> None:
        side = made.view_of("stability").of(NOW)
        assert named(side) and not side.stamp.object
        said = side.regions.object
        pool.held.clear()
        made.view.clicked(700.0, 15.0)
        assert faintly(side.point.panel) and faintly(side.motion.panel) and side.stamp.object
        assert not faintly(side.picture.panel) and not faintly(side.regions)
        pool.held.set()
        await settled(made)
        assert not side.stamp.object
        made.view.chosen("across", 7)
        await settled(made)
        assert side.regions.object == said and not side.stamp.object, "the same regions, over more points"
        pool.held.clear()
        made.view.chosen("x", "Shaft 1.stiffness")
        assert faintly(side.picture.panel)
        pool.held.set()
        await settled(made)
        assert not named(side) and not faintly(side.picture.panel)

    on_session(work, monkeypatch, view="stability", **{"stability.across": "6", "stability.up": "5"})


def named(side: Any) -> list[str]:
    """Resonances that are named along the chart."""
    return [text for item in side.chart.items if isinstance(item, EdgeNames) for text in item.texts]


def test_what_is_asked_for_beside_the_view_is_dropped_when_the_line_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fork offsets of an older line are not put into a newer one."""

    async def work(made: Session, pool: Held) -> None:
        pool.held.clear()
        task = asyncio.ensure_future(made.ask(Call("tn.natural_frequencies", (LINE,)), "text", NOW))
        await asyncio.sleep(0.05)
        turn(made, "3 deg")
        pool.held.set()
        with pytest.raises(asyncio.CancelledError):
            await task

    on_session(work, monkeypatch)


def test_a_best_value_is_used_for_the_parameter_it_was_found_for(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        view: Any = made.view
        assert view.best is not None and view.best[0] == "HookeJoint 1.angle" and not view.use.disabled
        pool.held.clear()
        view.chosen("parameter", "Shaft 1.stiffness")
        assert view.best is None and view.use.disabled

    query = {"limits.what": "best value of a parameter", "limits.high": "20", "limits.aim": "irregularity"}
    on_session(work, monkeypatch, view="limits", **query)


def test_what_is_superseded_before_it_begins_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two settings changed in one turn of the loop: the first computation never runs, and leaves nothing open."""

    async def work(made: Session, pool: Held) -> None:
        made.setting_chosen()
        made.setting_chosen()
        await asyncio.sleep(0.05)
        gc.collect()

    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        on_session(work, monkeypatch)
    assert not [str(one.message) for one in found if "never awaited" in str(one.message)]


def said(made: Session) -> str:
    """What stands below "What would help?"."""
    return "\n".join(str(one.object) for row in verdict(made).help.list.objects for one in row.select(HtmlPane))


def test_what_would_help_says_how_far_it_is_and_is_cancelled(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        help_ = verdict(made).help
        pool.held.clear()
        made.beside(help_._search())
        await asyncio.sleep(0.05)
        assert "Looking for" in said(made) and help_.search.disabled
        assert made.page.bar.visible and not made.page.cancel_button.disabled and "busy" in made.page.state.object
        made.cancel()
        await asyncio.sleep(0.05)
        assert "ended before" in said(made) and not help_.search.disabled
        assert not made.page.bar.visible and "busy" not in made.page.state.object
        pool.held.set()
        pool.failure = "the computing process ended"
        made.beside(help_._search())
        await asyncio.sleep(0.05)
        assert "no answer" in said(made) and "process ended" in made.page.said.object and not help_.search.disabled
        assert not is_stamped(made), "the verdict is still this line's"

    on_session(work, monkeypatch)


def test_what_helps_one_line_is_not_tried_on_another(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(made: Session, pool: Held) -> None:
        help_ = verdict(made).help
        help_.question = help_._asked_now()
        remedy = {"sentence": "a smaller angle", "variable": "HookeJoint 1.angle", "after": 0.02}
        help_._show([remedy])
        pool.held.clear()
        turn(made, "11 deg")
        line = made.document.line
        help_._try(remedy)
        assert made.document.line is line and faintly(help_.list)
        pool.held.set()
        await settled(made)
        assert not help_.list.objects
        help_.question = help_._asked_now()
        help_._try(remedy)
        assert made.document.line.elements[3].angle == 0.02

    on_session(work, monkeypatch)

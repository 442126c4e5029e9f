"""The view of studies: which stores it offers, that it shows what they hold, and follows one that grows."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from served import Look, start_server

import trunnion as tn
from trunnion.app import shown
from trunnion.app.parts.jobs import Job
from trunnion.app.parts.stores import grown, stores_here
from trunnion.app.views.studies import NONE, StudiesView
from trunnion.app.worker import WorkerLoop
from trunnion.driveline.starter import starter
from trunnion.studies.store import Store
from trunnion.studies.task import run_blocks

pytest.importorskip("zarr")


def asked(store: Path, name: str = "two-shaft-cardan") -> dict[str, Any]:
    """A study of 40 points in 5 blocks."""
    angle = {"path": "HookeJoint 1.angle", "low": "2 deg", "high": "40 deg", "points": 5}
    speed = {"path": "speed", "low": 0.4, "high": 2.0, "points": 8}
    study = {"line": name, "analysis": "stability", "quantities": ["growth_rate", "verdict"], "store": str(store)}
    return {**study, "parameter": [angle, speed], "block": 8}


def begun(path: Path, blocks: int) -> Store:
    """The store of that study with some of its blocks."""
    from trunnion.studies.study import _plan

    plan = _plan(asked(path), None, False)
    store = Store.create(path, plan.question, plan.design, plan.block, "a test")
    grow(store, tuple(range(blocks)))
    return store


def grow(store: Store, blocks: tuple[int, ...]) -> None:
    run_blocks(str(store.path), store.identity, 0, blocks)


def test_stores_that_are_offered(tmp_path: Path) -> None:
    """Down to two folders below, as they are written from there; no other folder, and nothing within a store."""
    for place in ("a.zarr", "runs/b.zarr", "runs/old/c.zarr", "runs/old/more/d.zarr", ".hidden/e.zarr", "a.zarr/f"):
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / "study.json").write_text("{}")
    (tmp_path / "other").mkdir()
    assert stores_here(tmp_path) == ["a.zarr", "runs/b.zarr", "runs/old/c.zarr"]
    assert stores_here(tmp_path / "nowhere") == []


def test_what_is_shown_of_a_store_that_grows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker reads it anew every time; the picture comes with the first points, and what may be chosen with it."""
    monkeypatch.chdir(tmp_path)
    store = begun(tmp_path / "s.zarr", 0)
    document = SimpleNamespace(line=tn.loads(starter("two-shaft")))
    watched: list[Any] = []
    session = SimpleNamespace(document=document, line=lambda side: document.line, beside=watched.append)
    view = StudiesView(session)  # type: ignore[arg-type]
    view.adapt(document.line)
    assert view.settings["store"] == "s.zarr" and len(watched) == 1
    watched[0].close()
    [step] = view.steps(document.line)
    loop = WorkerLoop(None, None, 1)  # type: ignore[arg-type]

    def look() -> Any:
        job = step.job(starter("two-shaft"))
        assert isinstance(job, Job)
        return loop.compute(job, lambda share: None)

    nothing, seen = look(), grown("s.zarr")
    assert nothing["picture"] is None and (nothing["points"], nothing["done"]) == (40, 0)
    grow(store, (0, 3))
    assert grown("s.zarr") != seen
    some = look()
    assert some["done"] == 16 and some["picture"] is not None
    assert some["quantities"] == ["growth_rate", "verdict"] and some["grids"] == ["HookeJoint 1.angle", "speed"]
    view.of("now").show(step, some)
    assert "16 of 40 points" in view.of("now").state.object and "data-study='growing'" in view.of("now").state.object
    assert view.widgets["x"].options == ["auto", "HookeJoint 1.angle", "speed"]
    tn.study(asked(tmp_path / "s.zarr"), workers=0)
    whole = look()
    view.of("now").show(step, whole)
    assert "40 of 40 points" in view.of("now").state.object and "data-study='whole'" in view.of("now").state.object
    view.settings |= {"kind": "chart", "quantity": "verdict", "y": "speed"}
    [step] = view.steps(document.line)
    assert dict(step.drawing) == {"kind": "chart", "quantity": "verdict", "x": "", "y": "speed"}
    named = shown.study(tn.read_study("s.zarr"), **step.options)["picture"].panel
    assert named.y.words == "input speed"


def test_nothing_is_offered_where_there_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An address that names another path opens nothing."""
    (tmp_path / "secret").mkdir()
    begun(tmp_path / "secret" / "s.zarr", 1)
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    document = SimpleNamespace(line=tn.loads(starter("two-shaft")))
    session = SimpleNamespace(document=document, line=lambda side: document.line, beside=lambda work: work.close())
    view = StudiesView(session)  # type: ignore[arg-type]
    view.read({"store": "../secret/s.zarr"})
    view.adapt(document.line)
    assert view.settings["store"] == NONE and view.steps(document.line) == []
    view.settings["store"] = "../secret/s.zarr"
    assert view.steps(document.line) == []


@pytest.mark.slow
def test_the_page_follows_a_store_that_grows(tmp_path: Path, browser: Any) -> None:
    store = begun(tmp_path / "s.zarr", 2)
    server = start_server(folder=tmp_path)
    try:
        page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
        page.set_default_timeout(180_000)
        look = Look(page, server)
        page.on("pageerror", lambda error: look.errors.append(str(error)))
        look.at("?view=studies")
        page.locator("[data-study=growing]", has_text="16 of 40 points").wait_for()
        grow(store, (2,))
        page.locator("[data-study=growing]", has_text="24 of 40 points").wait_for()
        tn.study(asked(tmp_path / "s.zarr"), workers=0)
        page.locator("[data-study=whole]", has_text="40 of 40 points").wait_for()
        page.get_by_label("Picture", exact=True).select_option("slices")
        look.settled_anew()
        assert page.get_by_label("Quantity", exact=True).locator("option").all_inner_texts() == [
            "the first", "growth_rate", "verdict",
        ]  # fmt: skip
        page.screenshot(path=str(tmp_path / "studies.png"), full_page=True)
        assert look.errors == []
    finally:
        server.stop()

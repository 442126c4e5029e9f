"""Workers of Dask: the same data as without, innocents that are not condemned, points that kill, other versions."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import dask
import distributed
import numpy as np
import pytest
from studies.asked import BATCH, CALLS, data_of, grid, line, stated

import trunnion as tn
from trunnion.numerics.versions import computed_by
from trunnion.studies import runner
from trunnion.studies.runner import workers_here
from trunnion.studies.store import Store
from trunnion.studies.task import DIED


@pytest.fixture(scope="module")
def client():
    """Two workers that are threads of this process, which start at once."""
    with distributed.Client(
        processes=False, n_workers=2, threads_per_worker=1, dashboard_address=None, set_as_default=False
    ) as one:
        yield one


def test_same_data_as_without(tmp_path, client) -> None:
    parameters = [{"path": "Shaft 1.stiffness", "low": 0.8, "high": 1.2}, *grid(3, 3)]
    more = {"block": 7, "parameter": parameters, "sampling": {"points": 8}}
    here, there = tmp_path / "a.zarr", tmp_path / "b.zarr"
    tn.study(stated(here, **more), line=line(), workers=0)
    seen: list[float] = []
    found = tn.study(stated(there, **more), line=line(), client=client, progress=lambda state: seen.append(state.share))
    assert found.outcome.ok and seen[-1] == 1.0 and seen == sorted(seen)
    assert data_of(here) == data_of(there)


@pytest.mark.slow
def test_within_its_time(tmp_path, client) -> None:
    """It ends with what it has, and goes on from there."""
    asked = stated(tmp_path / "a.zarr", CALLS, block=2, parameter=grid(20, 400))
    found = tn.study(asked, line=line(), client=client, within=1.0)
    assert 0 < found.missing < found.points and "time limit of 1 s" in str(found.outcome)
    again = tn.study(asked, line=line(), client=client, within=0.5)
    assert again.done >= found.done


def test_a_full_disk_of_a_worker(tmp_path, client, monkeypatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    asked = stated(tmp_path / "a.zarr", block=8)
    Store.create(tmp_path / "a.zarr", *prepared(asked))
    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        with pytest.raises(tn.ComputationError, match="No space left on device"):
            tn.study(asked, line=line(), client=client)
    assert tn.study(asked, line=line(), client=client).outcome.ok


def prepared(asked: dict[str, Any]) -> tuple[Any, ...]:
    from trunnion.studies.study import _plan

    plan = _plan(asked, line(), False)
    return plan.question, plan.design, plan.block, "a test"


def test_a_worker_of_another_version(tmp_path, client, monkeypatch) -> None:
    ours = computed_by()
    monkeypatch.setattr(client, "run", lambda function, *rest: {"tcp://far:1": {**ours, "numpy": "1.0"}})
    with pytest.raises(tn.InputError, match=r"worker of other versions \(tcp://far:1: numpy 1\.0, here"):
        tn.study(stated(tmp_path / "a.zarr"), line=line(), client=client)


def test_a_store_that_workers_do_not_see(tmp_path, client, monkeypatch) -> None:
    monkeypatch.setattr(runner, "where_it_runs", lambda path: (False, 1))
    with pytest.raises(tn.InputError, match="is not where the workers write; give a folder that all of them share"):
        tn.study(stated(tmp_path / "a.zarr"), line=line(), client=client)


def test_a_scheduler_that_is_not_there(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("trunnion.studies.runner.CALLED", "1s")
    with pytest.raises(tn.InputError, match=r'scheduler = .*: answers nothing; write "tcp://host:8786"'):
        tn.study(stated(tmp_path / "a.zarr"), line=line(), scheduler="tcp://127.0.0.1:9")


DEADLY = """
import os
from trunnion.studies.points import StudyQuestion
if StudyQuestion.result.__name__ == "result":  # a preload may be loaded twice
    def deadly(self, paths, value, old=StudyQuestion.result):
        if abs(value[1] - {speed!r}) < 1e-9:
            {action}
        return old(self, paths, value)
    StudyQuestion.result = deadly
"""
MORTAL = """
import os
from trunnion.studies.points import StudyQuestion
if StudyQuestion.evaluated.__name__ == "evaluated":
    def mortal(self, paths, values, old=StudyQuestion.evaluated):
        with open({log!r}, "ab") as log:
            if log.tell() < {deaths}:
                log.write(b"x")
                log.flush()
                os._exit(1)
        return old(self, paths, values)
    StudyQuestion.evaluated = mortal
"""


def preloaded(folder: Path, program: str) -> Any:
    """Every worker runs this first."""
    path = folder / "preload.py"
    path.write_text(program)
    return dask.config.set({"distributed.worker.preload": [str(path)]})


# Memory has to be written to, or the system only promises it.
@pytest.mark.slow
@pytest.mark.parametrize("action", ["os._exit(1)", "hold = b'x' * (3 << 29); import time; time.sleep(60)"])
def test_points_that_kill_are_found_and_marked(action, tmp_path) -> None:
    """Their processes die, of memory say; their neighbours are computed, and nobody else is blamed."""
    speeds = np.linspace(0.4, 2.0, 8)
    asked = stated(tmp_path / "a.zarr", CALLS, block=8, parameter=grid(2, 8))
    with preloaded(tmp_path, DEADLY.format(speed=0.4 + (2.0 - 0.4) * (3 / 7), action=action)):
        found = tn.study(asked, line=line(), workers=2, memory="1 GiB")
    assert found.outcome.ok and found.failed == 2 and set(found.failures.values()) == {DIED}
    assert sorted(found.failures) == [3, 11]
    np.testing.assert_allclose(found.parameter("speed")[list(found.failures)], speeds[3])
    whole = tn.study({**asked, "store": str(tmp_path / "b.zarr")}, line=line(), workers=0)
    done = found.status == 1
    assert np.array_equal(found.quantity("growth_rate")[done], whole.quantity("growth_rate")[done])


@pytest.mark.slow
def test_innocents_are_not_condemned(tmp_path, monkeypatch) -> None:
    """The first six blocks that are begun end their process, whatever they hold: Dask gives two of them up."""
    asked = stated(tmp_path / "a.zarr", BATCH, block=512, parameter=grid(64, 64))
    alone: list[int] = []
    old = runner.StudyRun._alone

    def noted(self: Any, part: Any, block: int) -> None:
        alone.append(block)
        old(self, part, block)

    monkeypatch.setattr(runner.StudyRun, "_alone", noted)
    with preloaded(tmp_path, MORTAL.format(log=str(tmp_path / "deaths"), deaths=6)):
        found = tn.study(asked, line=line(), workers=2)
    assert (tmp_path / "deaths").stat().st_size == 6 and alone
    assert found.outcome.ok and found.failed == 0
    whole = tn.study({**asked, "store": str(tmp_path / "b.zarr")}, line=line(), workers=0)
    assert data_of(tmp_path / "a.zarr") == data_of(tmp_path / "b.zarr") and whole.failed == 0


@pytest.mark.slow
def test_begun_on_one_scheduler_and_resumed_on_another(tmp_path) -> None:
    asked = stated(tmp_path / "a.zarr", CALLS, block=16, parameter=grid(10, 200))

    class Enough(Exception):
        pass

    def enough(state: Any) -> None:
        if state.done >= 500:
            raise Enough

    with workers_here(1, dashboard=None) as one, pytest.raises(Enough):
        tn.study(asked, line=line(), client=one, progress=enough)
    assert 500 <= Store.open(Path(asked["store"])).counts().done < 2000
    with workers_here(2, dashboard=None) as other:
        found = tn.study(asked, line=line(), scheduler=other.scheduler.address)
    assert found.outcome.ok
    tn.study({**asked, "store": str(tmp_path / "b.zarr")}, line=line(), workers=0)
    assert data_of(tmp_path / "a.zarr") == data_of(tmp_path / "b.zarr")


@pytest.mark.slow
def test_processes_that_do_not_start_are_not_waited_for(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(runner, "STARTED", 0.2)
    with pytest.raises(tn.ComputationError, match="1 processes of this machine do not start within 0 s; ask for fewer"):
        tn.study(stated(tmp_path / "a.zarr"), line=line(), workers=1)


@pytest.mark.slow
def test_nobody_else_reaches_what_runs_here() -> None:
    with workers_here(1) as local:
        addresses = [local.scheduler.address, local.dashboard_link, *local.scheduler_info()["workers"]]
    assert all("127.0.0.1" in one for one in addresses), addresses

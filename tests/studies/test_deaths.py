"""Which points are to blame where processes die: a client whose workers die when it is said, and no process at all."""

from __future__ import annotations

import random
from typing import Any

import distributed
import numpy as np
import pytest
from studies.asked import BATCH, CALLS, data_of, grid, line, stated

import trunnion as tn
from trunnion.studies import runner
from trunnion.studies import study as study_module
from trunnion.studies.points import StudyQuestion
from trunnion.studies.task import DIED

SPEEDS = np.linspace(0.4, 2.0, 8)


class Death(BaseException):
    """Of the process that computes."""


class Future:
    """What came of a call at once."""

    def __init__(self, number: int, outcome: Any, status: str) -> None:
        self.key, self.outcome, self.status = number, outcome, status

    def result(self, timeout: float | None = None) -> Any:
        if self.status == "error":
            raise self.outcome
        return self.outcome

    def exception(self) -> Any:
        return self.outcome

    def add_done_callback(self, call: Any) -> None:
        call(self)


class DyingClient:
    """Runs a task twice at most, as Dask with one death allowed; some die by chance whatever they compute."""

    status, dashboard_link = "running", ""

    def __init__(self, chance: float = 0.0) -> None:
        self.chance, self.random, self.number, self.deaths = chance, random.Random(1), 0, 0

    def submit(self, function: Any, *args: Any, pure: bool) -> Future:
        self.number += 1
        for _ in range(2):
            try:
                if self.random.random() < self.chance:
                    raise Death
                return Future(self.number, function(*args), "finished")
            except Death:
                self.deaths += 1
            except Exception as error:
                return Future(self.number, error, "error")
        return Future(self.number, distributed.scheduler.KilledWorker("run", None, 1), "error")


@pytest.fixture(autouse=True)
def no_workers_to_ask(monkeypatch) -> None:
    monkeypatch.setattr(study_module, "require_workers", lambda *_: 2)
    monkeypatch.setattr(study_module, "memory_of", lambda *_: 0)


def deadly(monkeypatch: pytest.MonkeyPatch, *speeds: float) -> None:
    """Computing at one of these speeds ends the process, in a batch as by itself."""
    old = StudyQuestion.evaluated

    def evaluated(self: StudyQuestion, paths: Any, values: Any) -> Any:
        if np.isin(np.round(values[:, 1], 6), np.round(speeds, 6)).any():
            raise Death
        return old(self, paths, values)

    monkeypatch.setattr(StudyQuestion, "evaluated", evaluated)


@pytest.mark.parametrize(
    ("quantities", "chance"),
    [(CALLS, 0.0), (BATCH, 0.2), *(pytest.param(*one, marks=pytest.mark.slow) for one in ((BATCH, 0.0), (CALLS, 0.2)))],
)
def test_points_that_kill_are_marked_and_no_others(quantities, chance, tmp_path, monkeypatch) -> None:
    whole = tn.study(stated(tmp_path / "b.zarr", quantities, parameter=grid(3), block=8), line=line(), workers=0)
    deadly(monkeypatch, SPEEDS[3], SPEEDS[4])
    client = DyingClient(chance)
    asked = stated(tmp_path / "a.zarr", quantities, parameter=grid(3), block=8)
    found = tn.study(asked, line=line(), client=client)
    assert sorted(found.failures) == [3, 4, 11, 12, 19, 20] and set(found.failures.values()) == {DIED}
    done = found.status == 1
    assert found.outcome.ok and done.sum() == 18 and client.deaths >= 12
    np.testing.assert_allclose(found.quantity("growth_rate")[done], whole.quantity("growth_rate")[done], atol=1e-8)
    assert not list((tmp_path / "a.zarr").rglob("alone*"))


@pytest.mark.slow
def test_random_deaths_change_nothing(tmp_path) -> None:
    """Blocks of a batch stay together, though two of five attempts end with the death of the worker."""
    client = DyingClient(0.4)
    asked = stated(tmp_path / "a.zarr", parameter=grid(8, 16), block=2)
    found = tn.study(asked, line=line(), client=client)
    assert found.outcome.ok and found.failed == 0 and client.deaths > 4
    tn.study({**asked, "store": str(tmp_path / "b.zarr")}, line=line(), workers=0)
    assert data_of(tmp_path / "a.zarr") == data_of(tmp_path / "b.zarr")


def test_workers_that_do_not_come_back_are_not_waited_for(tmp_path, monkeypatch) -> None:
    class Gone(DyingClient):
        def submit(self, function: Any, *args: Any, pure: bool) -> Future:
            future = super().submit(function, *args, pure=pure)
            future.add_done_callback = lambda call: None  # type: ignore[method-assign]
            return future

        def nthreads(self) -> dict[str, int]:
            return {}

        def cancel(self, *_: Any, **__: Any) -> None:
            """Nobody hears it."""

    monkeypatch.setattr(runner, "GONE", 1.0)
    with pytest.raises(tn.ComputationError, match="no workers are left for 1 s; what is done is kept"):
        tn.study(stated(tmp_path / "a.zarr", block=8), line=line(), client=Gone())

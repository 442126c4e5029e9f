"""Worker processes: answers, refusals, ends, and that none is lost."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from trunnion.app.parts.calls import LINE, Call
from trunnion.app.parts.jobs import Job
from trunnion.app.pool import SUPERSEDED, Pool
from trunnion.driveline.starter import starter
from trunnion.errors import ComputationError, InputError

MODES = Job(starter("two-shaft"), Call("tn.natural_frequencies", (LINE,)), "text")
LONG = Job(starter("two-shaft"), Call("tn.simulate", (LINE,), {"turns": 1e6, "dense": False}), "nothing")
WRONG = Job(starter("two-shaft"), Call("tn.stability", (LINE,), {"speed": -1.0}), "nothing")


def on_pool(work: Callable[[Pool], Awaitable[None]], most: int = 2) -> None:
    """Do ``work`` with a pool, and end its workers."""

    async def whole() -> None:
        pool = Pool(asyncio.get_running_loop(), 1, most)
        try:
            await asyncio.wait_for(work(pool), 240)
        finally:
            pool.close()

    with ThreadPoolExecutor(1) as thread:  # the browser's driver has a loop of its own in this one
        thread.submit(asyncio.run, whole()).result()


def test_answers_come_back_and_refusals_are_raised() -> None:
    async def work(pool: Pool) -> None:
        assert "2 natural frequencies" in (await pool.run(MODES, self_)).value
        with pytest.raises(InputError):
            await pool.run(WRONG, self_)
        assert len(pool.idle) == 1
        assert not pool.busy

    self_ = object()
    on_pool(work)


@pytest.mark.parametrize("message", [(), pytest.param((SUPERSEDED,), marks=pytest.mark.slow)])
def test_a_cancelled_job_ends_and_the_next_one_is_answered(message: tuple[str, ...]) -> None:
    async def work(pool: Pool) -> None:
        owner = object()
        await pool.run(MODES, owner)
        for _ in range(2):
            task = asyncio.ensure_future(pool.run(LONG, owner))
            await asyncio.sleep(0.2)
            task.cancel(*message)
            with pytest.raises(asyncio.CancelledError):
                await task
            assert (await pool.run(MODES, owner)).kind == "done"
        while pool.busy:
            await asyncio.sleep(0.05)

    on_pool(work)


def test_a_cancelled_job_that_does_not_listen_ends_with_its_process() -> None:
    """And frees the one who cancelled: the next job is another process's."""

    async def work(pool: Pool) -> None:
        owner = object()
        await pool.run(MODES, owner)
        begun = asyncio.Event()
        task = asyncio.ensure_future(pool.run(LONG, owner, lambda share: begun.set()))
        await begun.wait()  # one that has not begun hears at once that nobody wants it
        (worker,) = pool.busy
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        while pool.busy:
            await asyncio.sleep(0.01)
        assert worker.process.wait(60) != 0
        assert worker not in pool.idle
        assert (await pool.run(MODES, owner)).kind == "done"
        assert all(w.alive for w in pool.idle)

    on_pool(work)


def test_who_waits_for_a_worker_gets_one() -> None:
    async def work(pool: Pool) -> None:
        answers = await asyncio.gather(*(pool.run(MODES, object()) for _ in range(6)))
        assert {a.kind for a in answers} == {"done"}
        assert len(pool.idle) == 1

    on_pool(work, most=1)


def test_a_worker_that_dies_is_said_and_replaced() -> None:
    async def work(pool: Pool) -> None:
        owner = object()
        await pool.run(MODES, owner)
        task = asyncio.ensure_future(pool.run(LONG, owner))
        await asyncio.sleep(0.2)
        next(iter(pool.busy)).process.kill()
        with pytest.raises(ComputationError, match="ended"):
            await task
        assert (await pool.run(MODES, owner)).kind == "done"

    on_pool(work)


@pytest.mark.slow
def test_two_threads_take_no_more_of_the_processor_than_one() -> None:
    """Where a function has none of its own: linear algebra of small matrices is not spread over them."""
    text = starter("truck").replace('# application = "road"', 'application = "road"')
    job = Job(text, Call("tn.remedies", (LINE,), {"most": 1}), "remedies")
    taken: list[float] = []

    async def whole(threads: int) -> None:
        pool = Pool(asyncio.get_running_loop(), threads, 1)
        try:
            await pool.run(Job(text, Call("tn.assess", (LINE,)), "nothing"), None)
            (worker,) = pool.idle
            before = processor_time(worker.process.pid)
            await asyncio.wait_for(pool.run(job, None), 400)
            taken.append(processor_time(worker.process.pid) - before)
        finally:
            pool.close()

    for threads in (1, 2):
        with ThreadPoolExecutor(1) as thread:
            thread.submit(asyncio.run, whole(threads)).result()
    assert taken[1] < 1.5 * taken[0]


def processor_time(pid: int) -> float:
    """Seconds that a process has computed."""
    try:
        numbers = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        pytest.skip("the system does not say what a process takes")
    return (int(numbers[11]) + int(numbers[12])) / os.sysconf("SC_CLK_TCK")

"""Worker processes and who gets them: each job a process of its own while it runs, one more kept warm.

A job that is not wanted any more is asked to leave, and its process ended where it does not leave in time.
"""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import IO

from trunnion.app.parts.jobs import CUT_OFF, Job, Request, WorkerMessage, receive, send
from trunnion.errors import ComputationError, InputError

SINGLE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Linear algebra of a worker, whose matrices are small: further threads of it would only wait for each other, and take
the processor from those that compute. How many threads a function has of its own is said to the function."""
GRACE = 0.25
"""Seconds that a job has to leave by itself once it is cancelled."""
PATIENCE = 3.0
"""The same for a job that a newer one supersedes, which another worker computes meanwhile."""
SUPERSEDED = "superseded"
"""What a task is cancelled with where nobody waits for its end."""


class WorkerProcess:
    """One process. Answers arrive in the event loop."""

    def __init__(self, loop: asyncio.AbstractEventLoop, threads: int) -> None:
        environment = {**os.environ, **SINGLE, "MPLBACKEND": "Agg"}
        command = [sys.executable, "-m", "trunnion.app.worker", str(threads)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
        assert self.process.stdin and self.process.stdout
        self.inward: IO[bytes] = self.process.stdin
        self.loop = loop
        self.number = 0
        self.answered: asyncio.Future[WorkerMessage] | None = None
        self.report_progress: Callable[[float], None] = _nobody
        self.used_by: object = None
        self.ended = False
        threading.Thread(target=self._listen, args=(self.process.stdout,), daemon=True).start()

    @property
    def alive(self) -> bool:
        return not self.ended and self.process.poll() is None

    def begin(self, job: Job, report_progress: Callable[[float], None]) -> asyncio.Future[WorkerMessage]:
        """Start a job; the future holds its last answer."""
        self.number += 1
        self.report_progress = report_progress
        self.answered = self.loop.create_future()
        try:
            send(self.inward, Request(self.number, job))
        except OSError:
            self._ended()
        return self.answered

    def ask_to_stop(self) -> None:
        with suppress(OSError):
            send(self.inward, Request(self.number))

    def end(self) -> None:
        """End the process, whatever it does."""
        self.ended = True
        self.process.kill()
        with suppress(OSError):
            self.inward.close()

    def _listen(self, outward: IO[bytes]) -> None:
        with suppress(RuntimeError):  # the loop has closed
            try:
                while True:
                    self.loop.call_soon_threadsafe(self._heard, receive(outward))
            except (*CUT_OFF, ValueError):
                self.process.wait()
                self.loop.call_soon_threadsafe(self._ended)

    def _heard(self, answer: WorkerMessage) -> None:
        if answer.number != self.number:
            return
        if answer.kind == "progress":
            self.report_progress(answer.value)
        elif self.answered and not self.answered.done():
            self.answered.set_result(answer)

    def _ended(self) -> None:
        if self.answered and not self.answered.done():
            self.answered.set_result(
                WorkerMessage(self.number, "failed", "the computing process ended; try fewer points")
            )


def _nobody(share: float) -> None:
    """Nobody wants to know the progress."""


class Pool:
    """As many workers as the machine bears, lent to whoever computes; the last user gets his again if it is free."""

    def __init__(self, loop: asyncio.AbstractEventLoop, threads: int, most: int | None = None) -> None:
        self.loop, self.threads = loop, threads
        self.most = most or max(3, min(6, os.cpu_count() or 1))
        self.idle: list[WorkerProcess] = []
        self.busy: set[WorkerProcess] = set()
        self.waiting: list[asyncio.Future[None]] = []
        self.warming: asyncio.Task[None] | None = None
        self.closed = False

    def start(self) -> None:
        """Begin with one worker; a spare one comes when the first page is there, see ``warm``."""
        self.idle = [WorkerProcess(self.loop, self.threads)]

    def warm(self, jobs: tuple[Job, ...], owner: object = None) -> None:
        """Load, or the first time compile, what ``jobs`` need, in the worker of ``owner``; once in a server's life.

        Later than the first page, which else would share the machine with it.
        """
        if self.warming is None and not self.closed:
            self.warming = self.loop.create_task(self._warm(jobs, owner or self))

    async def _warm(self, jobs: tuple[Job, ...], owner: object) -> None:
        for job in jobs:
            with suppress(InputError, ComputationError):
                await self.run(job, owner)
        if len(self.idle) < 2 and not self.closed:
            self.idle.insert(0, WorkerProcess(self.loop, self.threads))

    async def run(self, job: Job, owner: object, report_progress: Callable[[float], None] = _nobody) -> WorkerMessage:
        """The answer to a job. Cancelling the caller ends the job, soon where it is not SUPERSEDED.

        Raises
        ------
        InputError, ComputationError : as the function raised them.
        """
        worker = await self._borrow(owner)
        answered = worker.begin(job, report_progress)
        try:
            answer = await asyncio.shield(answered)
        except asyncio.CancelledError as cancelled:
            # Nobody waits for what follows: the worker comes back, or its successor does.
            grace = PATIENCE if SUPERSEDED in cancelled.args else GRACE
            task = self.loop.create_task(self._dismiss(worker, grace))
            _LAST_TASKS.add(task)
            task.add_done_callback(_LAST_TASKS.discard)
            raise
        self._give_back(worker)
        if answer.kind == "refused":
            raise InputError(answer.value)
        if answer.kind != "done":
            raise ComputationError(str(answer.value))
        return answer

    async def _borrow(self, owner: object) -> WorkerProcess:
        while True:
            self.idle = [w for w in self.idle if w.alive]
            if self.idle:
                own = [w for w in self.idle if w.used_by is owner]
                worker = (own or self.idle)[-1]
                self.idle.remove(worker)
                break
            if len(self.busy) < self.most:
                worker = WorkerProcess(self.loop, self.threads)
                break
            freed = self.loop.create_future()
            self.waiting.append(freed)
            await freed
        worker.used_by = owner
        self.busy.add(worker)
        return worker

    def _give_back(self, worker: WorkerProcess) -> None:
        """Without waiting for anything, so that no cancellation can lose a worker."""
        self.busy.discard(worker)
        if worker.alive:
            self.idle.append(worker)
        waiting, self.waiting = self.waiting, []
        for freed in waiting:
            if not freed.done():
                freed.set_result(None)

    async def _dismiss(self, worker: WorkerProcess, grace: float) -> None:
        worker.ask_to_stop()
        assert worker.answered is not None
        await asyncio.wait([worker.answered], timeout=grace)
        if not worker.answered.done():
            worker.end()
            if not self.closed and len(self.idle) < 2:
                self.idle.append(WorkerProcess(self.loop, self.threads))
        self._give_back(worker)

    def close(self) -> None:
        """End all of them."""
        self.closed = True
        for worker in (*self.idle, *self.busy):
            worker.end()


_LAST_TASKS: set[asyncio.Task[None]] = set()
"""Tasks that nobody waits for; the loop itself keeps no strong reference."""

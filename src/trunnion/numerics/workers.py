"""Independent pieces of work on the workers of a Dask client, in place of threads of this process.

A piece is what one thread would do here, so that where it is done changes no bit of it. Nothing of Dask is imported:
who has a client has Dask.
"""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from threading import Thread
from typing import Any, TypeVar

from trunnion.errors import ComputationError, InputError, TrunnionError
from trunnion.numerics.versions import computed_by, differing
from trunnion.waiting import time_is_up

Task = TypeVar("Task")
Found = TypeVar("Found")
AHEAD = 3
"""Pieces a worker that are sent."""
PIECES = 4
"""Pieces a worker that a whole is cut into."""
PATIENCE = 0.5
"""Seconds between looks at whether to stop."""
ANSWER = 120.0
"""Seconds that workers have to say who they are."""


@dataclass(frozen=True)
class Workers:
    """The workers of a client; ``count`` of their threads."""

    client: Any
    count: int

    def each(self, work: Callable[[Task], Found], tasks: Iterable[Task]) -> Iterator[tuple[int, Found]]:
        """Number and result of every task, as they come; ends early where the time is up.

        Raises
        ------
        ComputationError : a worker died, or the scheduler has gone; else whatever a task raises.
        """
        arrived: queue.Queue[Any] = queue.Queue()
        flight: dict[str, tuple[Any, int]] = {}
        waiting = enumerate(tasks)
        more = True
        try:
            while True:
                while more and len(flight) < AHEAD * self.count and not time_is_up():
                    task = next(waiting, None)
                    if task is None:
                        more = False
                        break
                    future = self._sent(work, task[1])
                    flight[future.key] = future, task[0]
                    future.add_done_callback(arrived.put)
                if not flight:
                    return
                try:
                    future = arrived.get(timeout=PATIENCE)
                except queue.Empty:
                    if time_is_up():
                        return
                    if self.client.status not in ("running", "newly-created"):
                        raise ComputationError("the scheduler has gone: connect to one again") from None
                    continue
                _, number = flight.pop(future.key)
                yield number, _result(future)
                if time_is_up():
                    return
        finally:
            for future, _ in flight.values():
                future.release()

    def all(self, work: Callable[[Task], Found], tasks: Iterable[Task]) -> list[Found]:
        """Results of all tasks in their order; fewer of the first ones where the time was up."""
        found = dict(self.each(work, tasks))
        return [found[k] for k in range(next((k for k in range(len(found)) if k not in found), len(found)))]

    def parts(self, size: int, least: int = 1) -> list[range]:
        """``size`` numbers in stretches for all workers, of ``least`` numbers or more."""
        each = max(least, -(-size // (PIECES * self.count)))
        return [range(first, min(first + each, size)) for first in range(0, size, each)]

    def _sent(self, work: Callable[[Task], Found], task: Task) -> Any:
        try:
            return self.client.submit(work, task, pure=False)
        except TrunnionError:
            raise
        except Exception as error:
            why = f"cannot be sent to workers ({type(error).__name__}: {error})"
            raise ComputationError(f"the work {why}: leave out client") from None


def _result(future: Any) -> Any:
    try:
        return future.result()
    except TrunnionError:
        raise
    except Exception as error:
        if type(error).__name__ in ("KilledWorker", "CancelledError", "FutureCancelledError"):
            raise ComputationError(
                f"workers died or were lost ({type(error).__name__}): give them more memory, or leave out client"
            ) from None
        raise


def workers_of_client(client: Any) -> Workers | None:
    """Of a client, None without one.

    Raises
    ------
    InputError : it is none; it has no workers, or one of other versions.
    """
    if client is None:
        return None
    if not all(callable(getattr(client, name, None)) for name in ("submit", "run", "nthreads")):
        raise InputError("is not a client of Dask", key="client", value=type(client).__name__,
                         remedy="give a distributed.Client")  # fmt: skip
    try:
        threads = _answered(client.nthreads)
        versions = _answered(client.run, computed_by) if threads else {}
    except ModuleNotFoundError as error:
        raise InputError(f"has a worker without {error.name}", key="client",
                         remedy="install this version of Trunnion there") from None  # fmt: skip
    except (OSError, TimeoutError) as error:
        raise InputError(f"does not answer ({type(error).__name__})", key="client",
                         remedy="connect to a scheduler that runs") from None  # fmt: skip
    if not threads:
        raise InputError("has no workers", key="client", remedy="start some first: dask worker ADDRESS")
    for worker, theirs in versions.items():
        if differ := differing(theirs):
            raise InputError(f"has a worker of other versions ({worker}: {differ})", key="client",
                             remedy="install the same versions there")  # fmt: skip
    return Workers(client, sum(threads.values()))


def _answered(question: Callable[..., Any], *arguments: Any) -> Any:
    """What the scheduler answers to a call that itself has no time limit."""
    reply: Future[Any] = Future()

    def ask() -> None:
        try:
            reply.set_result(question(*arguments))
        except BaseException as error:
            reply.set_exception(error)

    Thread(target=ask, daemon=True, name="asks Dask").start()
    return reply.result(ANSWER)


_WORKERS: ContextVar[Workers | None] = ContextVar("_WORKERS", default=None)


@contextmanager
def shared_with(workers: Workers | None) -> Iterator[None]:
    """What is integrated inside is shared with ``workers``, where it is much."""
    token = _WORKERS.set(workers)
    try:
        yield
    finally:
        _WORKERS.reset(token)


def sharing() -> Workers | None:
    """Those with whom to share here, see ``shared_with``."""
    return _WORKERS.get()

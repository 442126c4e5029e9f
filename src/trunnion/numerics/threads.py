"""Independent pieces of work on several threads; the kernels release the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from contextvars import copy_context
from functools import cache
from typing import TypeVar

from threadpoolctl import ThreadpoolController

from trunnion.waiting import keep_time, time_limit

Task = TypeVar("Task")
Result = TypeVar("Result")


def on_threads(work: Callable[[Task], Result], tasks: Iterable[Task], threads: int) -> list[Result]:
    """``work`` of every task, in order. On an error or Ctrl-C what has not begun is dropped.

    Raises
    ------
    OutOfTime : the time limit around it is over before the last task begins.
    """

    def timely(task: Task) -> Result:
        keep_time()
        return work(task)

    if threads <= 1:
        return [timely(task) for task in tasks]
    pool = ThreadPoolExecutor(threads)
    try:
        # A context each, as none can be entered twice at a time: the limit holds on every thread.
        waiting = [pool.submit(copy_context().run, timely, task) for task in tasks]
        return [one.result() for one in waiting]
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def beside(work: Callable[[], Result]) -> Iterator[Callable[[], Result]]:
    """``work`` on a thread of its own, under the same time limit, while what is inside goes on: a function that waits
    for its result. An error or Ctrl-C inside stops it."""
    pool = ThreadPoolExecutor(1)
    with time_limit() as its_own:
        waiting = pool.submit(copy_context().run, work)
    try:
        yield waiting.result
    except BaseException:
        its_own.stop()
        raise
    finally:
        pool.shutdown(wait=True)


def on_one_thread() -> AbstractContextManager[object]:
    """For matrices of a few hundred rows: a library's threads would spend their time waiting for each other."""
    return _libraries().limit(limits=1, user_api="blas")


@cache
def _libraries() -> ThreadpoolController:
    """What NumPy has loaded; looking for it takes as long as a small balance."""
    return ThreadpoolController()

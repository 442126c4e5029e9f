"""Independent pieces of work on several threads; the kernels release the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from typing import TypeVar

from trunnion.waiting import keep_time

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

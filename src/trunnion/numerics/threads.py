"""Independent pieces of work on several threads; the kernels release the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")


def on_threads(work: Callable[[Task], Result], tasks: Iterable[Task], threads: int) -> list[Result]:
    """``work`` of every task, in order. On an error or Ctrl-C what has not begun is dropped."""
    if threads <= 1:
        return [work(task) for task in tasks]
    pool = ThreadPoolExecutor(threads)
    try:
        return list(pool.map(work, tasks))
    finally:
        pool.shutdown(wait=True, cancel_futures=True)

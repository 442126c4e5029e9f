"""A limit on the processor time of one input, where the system can set one."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

LIMIT = 20.0
"""Seconds of this process, whatever else the machine does."""


class TooLong(Exception):
    """The input takes more than ``LIMIT``."""


@contextmanager
def hurried() -> Iterator[None]:
    """Raise ``TooLong`` when the limit is past and the code is back in Python."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def stop(*_: object) -> None:
        raise TooLong

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LIMIT)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)

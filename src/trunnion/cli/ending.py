"""Which signal asks a command to end, and that all of them do what Ctrl-C does."""

from __future__ import annotations

import signal
from contextlib import suppress
from typing import Any

ENDINGS = ("SIGTERM", "SIGHUP")
"""Signals that end a command as Ctrl-C does; Windows has no second one."""


class EndedBy:
    """The signal that ended this process, Ctrl-C until another one comes."""

    number = int(signal.SIGINT)
    asked = False
    """Whether any has come."""
    raised = False
    """Whether a ``KeyboardInterrupt`` answered it. Callbacks and finalisers swallow it when it falls into them."""

    @classmethod
    def hear(cls) -> None:
        """From now on the first signal that asks this process to end does what Ctrl-C does, so that it cleans up."""
        cls.number, cls.asked, cls.raised = int(signal.SIGINT), False, False
        with suppress(ValueError):  # not in the main thread
            if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # in the background it is ignored
                signal.signal(signal.SIGINT, cls.on_ctrl_c)
        for name in ENDINGS:
            number = getattr(signal, name, None)
            with suppress(ValueError, OSError):  # not in the main thread
                if number is not None and signal.getsignal(number) == signal.SIG_DFL:  # nohup has it ignored
                    signal.signal(number, cls._stop)

    @classmethod
    def ignore(cls) -> None:
        """From now on nothing is left to clean up, and the exit code stands."""
        if cls.number == signal.SIGINT:
            cls.number = 0
        with suppress(ValueError):  # not in the main thread
            if signal.getsignal(signal.SIGINT) is cls.on_ctrl_c:
                signal.signal(signal.SIGINT, signal.default_int_handler)

    @staticmethod
    def on_ctrl_c(*_: object) -> None:
        """As Python answers it, and noted."""
        EndedBy.asked = EndedBy.raised = True
        raise KeyboardInterrupt

    @classmethod
    def _stop(cls, number: int, frame: Any) -> None:
        cls.asked = True
        if cls.number == signal.SIGINT:
            cls.number = number
            on_ctrl_c = signal.getsignal(signal.SIGINT)  # which may ask what is computed for what it has
            if callable(on_ctrl_c):
                on_ctrl_c(number, frame)
            else:  # a command in the background
                cls.on_ctrl_c()

    @classmethod
    def code(cls) -> int:
        """The exit code, as shells have it."""
        return 128 + (cls.number or signal.SIGINT)

"""How a command ends that cannot finish: a line a complaint on stderr, the exit code of its kind, JSON where asked for.

Exit codes: 1 for a failed computation, 2 for bad input, 128 and the signal's number for Ctrl-C (130), SIGTERM (143) and
a terminal that is closed (129).
"""

from __future__ import annotations

import errno
import os
import signal
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, cast

import typer

from trunnion.cli import output
from trunnion.cli.crash import crash_line
from trunnion.errors import ComputationError, InputError, TrunnionError, short
from trunnion.results.plain import plain

# Usage errors have no public name in typer; this base has been that of its BadParameter in every version.
_UsageError = cast("type[Exception]", typer.BadParameter.__mro__[1])
ENDINGS = ("SIGTERM", "SIGHUP")
"""Signals that end a command as Ctrl-C does; Windows has no second one."""


class Interrupted(Exception):
    """Ctrl-C, under a name that typer does not answer itself."""


class EndedBy:
    """The signal that ended this process, Ctrl-C until another one comes."""

    number = int(signal.SIGINT)

    @classmethod
    def hear(cls) -> None:
        """From now on the first signal that asks this process to end does what Ctrl-C does, so that it cleans up."""
        cls.number = int(signal.SIGINT)
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

    @classmethod
    def _stop(cls, number: int, frame: Any) -> None:
        if cls.number == signal.SIGINT:
            cls.number = number
            on_ctrl_c = signal.getsignal(signal.SIGINT)  # which may ask what is computed for what it has
            if callable(on_ctrl_c):
                on_ctrl_c(number, frame)
            else:  # a command in the background
                raise KeyboardInterrupt

    @classmethod
    def code(cls) -> int:
        """The exit code, as shells have it."""
        return 128 + (cls.number or signal.SIGINT)


@dataclass(frozen=True)
class Failure:
    """What is said of a failure: its kind, the exit code, and each complaint, of what is known by element, key, value,
    problem and remedy."""

    kind: str
    code: int
    problems: Sequence[InputError]

    @classmethod
    def of(cls, kind: str, code: int, message: str) -> Failure:
        """With one complaint that is a sentence."""
        return cls(kind, code, (InputError(message),))

    def content(self) -> dict[str, Any]:
        """For JSON."""
        return {"error": self.kind, "exit_code": self.code, "problems": [_in_parts(one) for one in self.problems]}


def _in_parts(one: InputError) -> dict[str, Any]:
    value = plain(one.value)
    known = value is None or isinstance(value, str | int | float)
    return {
        "element": one.element,
        "key": one.key,
        "value": (short(value, 200) if isinstance(value, str) else value) if known else short(repr(value), 200),
        "problem": " ".join(one.problem.split()),
        "remedy": one.remedy,
        "message": one.sentence(),
    }


def answer(error: Exception, arguments: list[str]) -> int:
    """Exit code of a failure, said on stderr and, of a command with ``--json``, as an object on stdout."""
    if isinstance(error, BrokenPipeError):  # who reads us has gone, as "head" does
        _discard_stdout()
        return 1
    failure = _failure(error, arguments)
    lines = str(error).splitlines() if isinstance(error, InputError) else [one.problem for one in failure.problems]
    for line in lines:
        print(f"error: {' '.join(line.split())}", file=sys.stderr)
    if "--json" in arguments and not isinstance(error, output.FailedAnswer):  # whose JSON is there and says it
        try:
            output.write_json(next((one for one in arguments if not one.startswith("-")), ""), failure.content())
            sys.stdout.flush()
        except OSError:
            _discard_stdout()
    return failure.code


def _failure(error: Exception, arguments: list[str]) -> Failure:
    match error:
        case Interrupted():
            return Failure.of("interrupted", EndedBy.code(), f"interrupted; {str(error) or 'nothing was written'}")
        case InputError():
            return Failure("input", error.exit_code, error.problems)
        case TrunnionError():
            kind = "computation" if isinstance(error, ComputationError) else "failure"
            return Failure.of(kind, error.exit_code, str(error))
        case _UsageError():
            return Failure.of("usage", 2, _message(error))
        case MemoryError():
            return Failure.of("computation", 1, "not enough memory; ask for fewer points")
        case OSError(errno=errno.ENAMETOOLONG):
            said = f"{short(str(error.filename))}: is too long for the name of a file; choose a shorter one"
            return Failure.of("input", 2, said)
        case OSError():
            if error.filename is None:
                _discard_stdout()
            where = f"{error.filename}: " if error.filename else ""
            return Failure.of("system", 1, f"{where}{error.strerror or error}")
    return Failure.of("defect", 1, crash_line(error, arguments))


def _discard_stdout() -> None:
    """What is still buffered cannot be written and must not fail again when Python leaves."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _message(error: Any) -> str:
    text: str = error.format_message()
    text = short(text, 300)
    return text if "--help" in text else f"{text.rstrip('.')}; try --help"

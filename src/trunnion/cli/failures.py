"""How a command ends that cannot finish: a line a complaint on stderr, the exit code of its kind, JSON where asked for.

Exit codes: 1 for a failed computation, 2 for bad input, 128 and the signal's number for Ctrl-C (130), SIGTERM (143) and
a terminal that is closed (129).
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, cast

import typer

from trunnion.cli import output
from trunnion.cli.crash import crash_line
from trunnion.cli.ending import EndedBy
from trunnion.errors import ComputationError, InputError, TrunnionError, short
from trunnion.results.plain import plain

# Usage errors have no public name in typer; this base has been that of its BadParameter in every version.
_UsageError = cast("type[Exception]", typer.BadParameter.__mro__[1])


class Interrupted(Exception):
    """Ctrl-C, under a name that typer does not answer itself."""


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
            return _interrupted(str(error))
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
    if EndedBy.asked:  # imports and classes that it fell into name it otherwise
        return _interrupted()
    return Failure.of("defect", 1, crash_line(error, arguments))


def _interrupted(kept: str = "") -> Failure:
    return Failure.of("interrupted", EndedBy.code(), f"interrupted; {kept or 'nothing was written'}")


def _discard_stdout() -> None:
    """What is still buffered cannot be written and must not fail again when Python leaves."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _message(error: Any) -> str:
    text: str = error.format_message()
    text = short(text, 300)
    return text if "--help" in text else f"{text.rstrip('.')}; try --help"

"""What goes between the server and its workers: jobs, their answers, and how both are written and read."""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import IO, Any

from trunnion.app.parts.calls import Call

CUT_OFF = (EOFError, OSError, pickle.UnpicklingError)
"""What reading raises where the other side has gone, be it in the middle of a message."""


@dataclass(frozen=True)
class Job:
    """A call for one line, and what of its result is wanted.

    ``show`` names a function of ``trunnion.app.shown`` that makes plain data of the result; ``options`` are its
    further arguments.
    """

    toml: str
    call: Call
    show: str
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Request:
    """To a worker: begin ``job``, whose answers carry ``number``; without one leave that job at its next report."""

    number: int
    job: Job | None = None


@dataclass(frozen=True)
class WorkerMessage:
    """From a worker: "progress" (a share), "done" (data), "refused", "failed" or "stopped" (a sentence)."""

    number: int
    kind: str
    value: Any = None
    remarks: tuple[str, ...] = ()


def send(stream: IO[bytes], message: Request | WorkerMessage) -> None:
    """Write one message, whole or not at all where it cannot be pickled."""
    stream.write(pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL))
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """The next message; raises what is ``CUT_OFF`` where there is none."""
    return pickle.load(stream)

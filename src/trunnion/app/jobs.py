"""What goes between the server and its workers: jobs, their answers, and the frames that carry both."""

from __future__ import annotations

import pickle
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import IO, Any

from trunnion.app.calls import Call

_HEAD = struct.Struct(">Q")


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
class Start:
    """To a worker: begin ``job``, whose answers carry ``number``."""

    number: int
    job: Job


@dataclass(frozen=True)
class Stop:
    """To a worker: leave job ``number`` at its next report of progress."""

    number: int


@dataclass(frozen=True)
class Answer:
    """From a worker: "ready", "progress" (a share), "done" (data), "refused", "failed" or "stopped" (a sentence)."""

    number: int
    kind: str
    value: Any = None
    remarks: tuple[str, ...] = ()


def write_frame(stream: IO[bytes], message: object) -> None:
    """One message, its length before it."""
    body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(_HEAD.pack(len(body)) + body)
    stream.flush()


def read_frame(stream: IO[bytes]) -> Any:
    """The next message; EOFError where the other side has gone."""
    (length,) = _HEAD.unpack(_exactly(stream, _HEAD.size))
    return pickle.loads(_exactly(stream, length))


def _exactly(stream: IO[bytes], count: int) -> bytes:
    parts = []
    while count:
        part = stream.read(count)
        if not part:
            raise EOFError
        parts.append(part)
        count -= len(part)
    return b"".join(parts)

"""Machine code in files that know whether they are whole, and of what they are.

A file is one line with the SHA-256 of all that follows, one line of JSON that names function, versions and processor,
and the pickled code. Whatever cannot be read, does not fit its checksum or does not unpickle is not code: it is deleted
where that is possible, and compiled anew. Nothing of a damaged file is run.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from trunnion.errors import TrunnionError
from trunnion.numerics.sources import VERSIONS
from trunnion.writing import written_whole

ENDING = ".nbc"
_LABEL = b"trunnion kernel 1 "
_HEAD = len(_LABEL) + 64 + 1
"""Bytes of the first line."""


@dataclass(frozen=True)
class Code:
    """What a file holds: of which function, ``versions`` and ``processor``, and the pickled ``content``."""

    function: str
    versions: str
    processor: str
    content: bytes


def packed(function: str, processor: str, content: bytes) -> bytes:
    """The bytes of a file."""
    head = json.dumps({"function": function, "versions": VERSIONS, "processor": processor}).encode()
    body = head + b"\n" + content
    return _LABEL + hashlib.sha256(body).hexdigest().encode() + b"\n" + body


def unpacked(raw: bytes) -> Code | None:
    """What the bytes of a file hold; None where they are not as they were written."""
    body = raw[_HEAD:]
    if raw[:_HEAD] != _LABEL + hashlib.sha256(body).hexdigest().encode() + b"\n":
        return None
    head, _, content = body.partition(b"\n")
    return Code(**json.loads(head), content=content)


def read(path: Path) -> bytes | None:
    """The pickled code of a file, or None; a file that is there and cannot be used is deleted."""
    try:
        code = unpacked(_content(path))
    except FileNotFoundError:
        return None
    except OSError:  # nobody's to read, or a failing disk
        code = None
    if code is None:
        remove(path)
        return None
    return code.content


def _content(path: Path) -> bytes:
    """What a file holds; nothing of a folder, of a pipe, which would wait for ever, and of a link to nowhere."""
    if path.is_file():
        return path.read_bytes()
    path.lstat()
    return b""


def write(path: Path, function: str, processor: str, content: bytes) -> None:
    """Write a file whole.

    Raises
    ------
    OSError : it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with written_whole(path) as temporary:
            temporary.write_bytes(packed(function, processor, content))
    except TrunnionError as error:
        reason = error.__context__
        raise (reason if isinstance(reason, OSError) else OSError(str(error))) from None


def remove(path: Path) -> None:
    """Delete what stands in the place of a file, if that is possible."""
    with suppress(OSError):
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()


@dataclass(frozen=True)
class CachedFile:
    """One file of machine code in a cache: its size [bytes], and what it holds, None where it is damaged."""

    path: Path
    size: int
    code: Code | None


def found_below(folder: Path) -> Iterator[CachedFile]:
    """Every file of machine code below ``folder``, whole or not; nothing is changed."""
    for path in sorted(folder.rglob(f"*{ENDING}")):
        raw = b""
        with suppress(OSError):
            raw = _content(path)
        yield CachedFile(path, len(raw), unpacked(raw))

"""Writing results so that nothing is ever half-written."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from trunnion.errors import InputError


@contextmanager
def written_whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path beside ``path`` to write to; renamed to it on success, removed on failure.

    Raises
    ------
    InputError : the folder does not exist or cannot be written, or ``path`` is a folder.
    """
    target = Path(path)
    if target.is_dir():
        raise InputError("is a folder", key="output", value=str(target), remedy="give a file name")
    if not target.parent.is_dir():
        remedy = f"create the folder {target.parent}"
        raise InputError(
            "cannot be written, its folder does not exist", key="output", value=str(target), remedy=remedy
        )
    try:
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.stem}-", suffix=target.suffix)
    except OSError as error:
        raise InputError(
            f"cannot be written: {error.strerror}",
            key="output",
            value=str(target),
            remedy="choose another folder",
        ) from None
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        os.replace(temporary, target)
    finally:
        temporary.unlink(missing_ok=True)

"""Writing results so that nothing is ever half-written."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

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
        raise InputError("cannot be written, its folder does not exist", key="output", value=str(target), remedy=remedy)
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


@contextmanager
def folder_written_whole(folder: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary folder to write several files to; they move into ``folder`` together on success.

    On failure, also on Ctrl-C, nothing is left: neither ``folder`` if it was not there nor any of the files.

    Raises
    ------
    InputError : ``folder`` cannot be made.
    """
    target = Path(folder)
    nearest = next(parent for parent in target.absolute().parents if parent.is_dir())
    try:
        temporary = Path(tempfile.mkdtemp(dir=nearest, prefix=f".{target.name}-"))
    except OSError as error:
        _cannot_be_made(target, error)
    try:
        yield temporary
        try:
            target.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            _cannot_be_made(target, error)
        for written in sorted(temporary.iterdir()):
            os.replace(written, target / written.name)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _cannot_be_made(folder: Path, error: OSError) -> NoReturn:
    raise InputError(
        f"cannot be made: {error.strerror}", key="output", value=str(folder), remedy="choose another folder"
    ) from None

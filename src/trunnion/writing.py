"""Writing files so that none is ever half-written, and what a killed run left is swept by the next.

Everything is written under a temporary name in the folder it belongs to, which says by which process, and renamed
when it is whole.
"""

from __future__ import annotations

import os
import platform
import secrets
import shutil
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NoReturn

from trunnion.errors import ComputationError, InputError

PREFIX = ".trunnion-"
STALE = 86_400.0
"""Seconds after which a temporary file is nobody's, where its process cannot be asked for."""


@contextmanager
def written_whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path beside ``path`` to write to; renamed to it on success, removed on failure.

    A link keeps pointing at what it points at.

    Raises
    ------
    InputError : the folder does not exist or cannot be written, or ``path`` is a folder.
    ComputationError : the disk is full or fails; what was there before is as it was.
    """
    target = Path(path)
    if target.is_dir():
        _refuse_output(target, "is a folder", "give a file name")
    target = Path(os.path.realpath(target))
    if not target.parent.is_dir():
        _refuse_output(Path(path), "cannot be written, its folder does not exist", f"create the folder {target.parent}")
    sweep(target.parent)
    temporary = target.parent / f"{_own_prefix()}{target.suffix}"
    try:
        temporary.touch(exist_ok=False)
    except OSError as error:
        _refuse_output(Path(path), f"cannot be written ({error.strerror})")
    try:
        with _disk_errors_about(Path(path), temporary):
            yield temporary
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
    ComputationError : the disk is full or fails; what was there before is as it was.
    """
    target = Path(folder)
    nearest = next(parent for parent in target.absolute().parents if parent.is_dir())
    sweep(nearest)
    temporary = nearest / _own_prefix()
    try:
        temporary.mkdir(mode=0o700)
    except OSError as error:
        _refuse_output(target, f"cannot be made: {error.strerror}")
    try:
        with _disk_errors_about(target, temporary):
            yield temporary
        try:
            target.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            _refuse_output(target, f"cannot be made: {error.strerror}")
        with _disk_errors_about(target, temporary):
            for written in sorted(temporary.iterdir()):
                os.replace(written, target / written.name)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def sweep(folder: Path) -> None:
    """Remove what runs that were killed left in ``folder``; what others are writing stays."""
    with suppress(OSError):
        for left in folder.glob(f"{PREFIX}*"):
            with suppress(OSError, ValueError):
                if _is_abandoned(left):
                    shutil.rmtree(left) if left.is_dir() else left.unlink()


def _own_prefix() -> str:
    """Host, process and a random part: what tells an abandoned file from one that is being written."""
    return f"{PREFIX}{_host()}-{os.getpid()}-{secrets.token_hex(4)}"


def _host() -> str:
    return f"{zlib.crc32(platform.node().encode()):08x}"


def _is_abandoned(left: Path) -> bool:
    host, process, _ = left.name.removeprefix(PREFIX).split("-", 2)
    if time.time() - left.stat().st_mtime > STALE:
        return True
    # On Windows asking whether a process lives would end it; there, only age counts.
    return os.name == "posix" and host == _host() and not _lives(int(process))


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:  # somebody else's
        return True
    return True


@contextmanager
def _disk_errors_about(target: Path, temporary: Path) -> Iterator[None]:
    """Say a disk's failure about the file that was asked for, not about its temporary name."""
    try:
        yield
    except OSError as error:
        about = str(error.filename or temporary)
        if not (error.strerror and about.startswith(str(temporary))):
            raise
        if isinstance(error, PermissionError):
            _refuse_output(target, f"cannot be written ({error.strerror})")
        raise ComputationError(f"{target}: cannot be written ({error.strerror}); nothing was changed there") from None


def _refuse_output(path: Path, problem: str, remedy: str = "choose another folder") -> NoReturn:
    raise InputError(problem, key="output", value=str(path), remedy=remedy) from None

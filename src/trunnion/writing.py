"""Writing files so that none is ever half-written, and what a killed run left is swept by the next.

Everything is written under a temporary name in the folder it belongs to, which says by which process, and renamed
when it is whole.
"""

from __future__ import annotations

import errno
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
NEW, COMPLETE = "new", "complete"
"""In a temporary folder: the files written, and the sign that they are all whole and on their way."""
STALE = 86_400.0
"""Seconds after which a temporary file is nobody's, where its process cannot be asked for."""
_BEING_WRITTEN: set[str] = set()
"""The temporary names that this process writes to now."""


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
    with _temporary(target.parent, target.suffix) as temporary:
        try:
            temporary.touch(exist_ok=False)
        except OSError as error:
            _refuse_output(Path(path), f"cannot be written ({error.strerror})")
        with _disk_errors_about(Path(path), temporary):
            yield temporary
            _to_disk(temporary)
            os.replace(temporary, target)


def write_durably(path: Path, content: bytes) -> None:
    """Write a file that is on the disk, its name too, once this returns: no loss of power takes it back.

    Raises
    ------
    InputError, ComputationError : as of ``written_whole``; nothing is left behind.
    """
    with (
        _temporary(path.parent, path.suffix) as temporary,
        _disk_errors_about(path, temporary),
        _named(temporary),
    ):
        temporary.write_bytes(content)
        _to_disk(temporary)
        os.replace(temporary, path)
        folder_to_disk(path.parent)


@contextmanager
def folder_made_durably(path: Path) -> Iterator[Path]:
    """A temporary folder to fill; renamed to ``path`` once all in it is on the disk, unless one is there by then.

    Raises
    ------
    InputError, ComputationError : as of ``written_whole``.
    """
    sweep(path.parent)
    with _temporary(path.parent) as temporary, _disk_errors_about(path, temporary), _named(temporary):
        temporary.mkdir()
        yield temporary
        for one in temporary.rglob("*"):
            folder_to_disk(one) if one.is_dir() else _to_disk(one)
        folder_to_disk(temporary)
        try:
            os.rename(temporary, path)
        except OSError:
            if not path.is_dir():  # else somebody else made it meanwhile
                raise
        folder_to_disk(path.parent)


@contextmanager
def _named(temporary: Path) -> Iterator[None]:
    """A disk's failure without a name, as of a write that finds no room, gets that of the file."""
    try:
        yield
    except OSError as error:
        if error.filename is None and error.errno is not None:
            raise OSError(error.errno, error.strerror, str(temporary)) from None
        raise


def folder_to_disk(folder: Path) -> None:
    """Wait until the names in a folder are on the disk."""
    if os.name != "posix":  # elsewhere folders cannot be waited for
        return
    opened = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(opened)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(opened)


@contextmanager
def scratch_folder(within: Path) -> Iterator[Path]:
    """A temporary folder below ``within``, removed afterwards."""
    with _temporary(within) as temporary:
        temporary.mkdir()
        yield temporary


def move_durably(made: Path, path: Path) -> None:
    """Move a file to its place, in the same file system, once it is on the disk, and wait for its name there."""
    _to_disk(made)
    os.replace(made, path)
    folder_to_disk(path.parent)


@contextmanager
def folder_written_whole(folder: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary folder to write several files to; they move into ``folder`` together on success.

    A new folder appears at once with all its files. In one that is there, the files are replaced one after the other
    once all of them are whole: a run that is killed within these moments leaves some old and some new, and the next
    run that writes there replaces the rest. On failure, also on Ctrl-C, nothing has changed.

    Raises
    ------
    InputError : ``folder`` cannot be made.
    ComputationError : the disk is full or fails; what was there before is as it was.
    """
    target = Path(folder)
    nearest = next(path for path in (target.absolute(), *target.absolute().parents) if path.is_dir())
    sweep(nearest)
    sweep(target.absolute().parent)  # where a run that was to make the folder may have been killed
    with _temporary(nearest) as temporary:
        made = temporary / NEW
        try:
            made.mkdir(parents=True)
        except OSError as error:
            _refuse_output(target, f"cannot be made: {error.strerror}")
        with _disk_errors_about(target, temporary):
            yield made
            for path in made.rglob("*"):
                _to_disk(path)
        if target.is_dir():
            with _disk_errors_about(target, temporary):
                _replace_all(temporary, target)
        else:
            try:
                target.parent.mkdir(parents=True, exist_ok=True)
                made.rename(target)
            except OSError as error:
                _refuse_output(target, f"cannot be made: {error.strerror}")


def _to_disk(path: Path) -> None:
    """Wait until a file is on the disk, so that no loss of power leaves its new name with nothing behind it."""
    if path.is_dir():
        return
    with path.open("r+b") as stream:
        try:
            os.fsync(stream.fileno())
        except OSError as error:
            if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # a disk that knows no such wait
                raise


def _replace_all(temporary: Path, target: Path) -> None:
    """Move all that is new into ``target``, or put back what was there."""
    old = temporary / "old"
    old.mkdir()
    names = sorted(path.name for path in (temporary / NEW).iterdir())
    for name in names:
        if (target / name).exists():
            _keep(target / name, old / name)
    with _undone_on_failure(old, target, names):
        if temporary.parent == target.absolute():  # else the target came up meanwhile, and the next run looks elsewhere
            (temporary / COMPLETE).touch()
        for name in names:
            os.replace(temporary / NEW / name, target / name)


def _keep(path: Path, kept: Path) -> None:
    """A second name for a file, or a copy where the disk knows no second names."""
    try:
        os.link(path, kept)
    except OSError:
        shutil.copy2(path, kept)


@contextmanager
def _undone_on_failure(old: Path, target: Path, names: list[str]) -> Iterator[None]:
    try:
        yield
    except BaseException:
        (old.parent / COMPLETE).unlink(missing_ok=True)
        for name in names:
            if (old / name).exists():
                os.replace(old / name, target / name)
            elif not (old.parent / NEW / name).exists():
                (target / name).unlink()
        raise


def sweep(folder: Path) -> None:
    """Remove what runs that were killed left in ``folder``; what others are writing stays.

    Files that were whole and on their way into ``folder`` arrive, unless something newer is there.
    """
    with suppress(OSError):
        for left in sorted(folder.glob(f"{PREFIX}*"), key=lambda path: path.stat().st_mtime_ns):
            with suppress(OSError, ValueError):
                if _is_abandoned(left):
                    _finish(left)
                    shutil.rmtree(left) if left.is_dir() else left.unlink()


def _finish(left: Path) -> None:
    if (left / COMPLETE).exists():
        for written in (left / NEW).iterdir():
            there = left.parent / written.name
            if not there.exists() or there.stat().st_mtime_ns <= written.stat().st_mtime_ns:
                os.replace(written, there)


@contextmanager
def _temporary(folder: Path, suffix: str = "") -> Iterator[Path]:
    """A name in ``folder`` for one file or folder, removed afterwards unless it was renamed.

    Host, process and a random part tell an abandoned one from one that is being written. A thread that outlives the
    failure of what it works for may write there once more: what then comes up is swept by the next, since the name
    is written to no longer.
    """
    path = folder / f"{PREFIX}{_host()}-{os.getpid()}-{secrets.token_hex(4)}{suffix}"
    _BEING_WRITTEN.add(path.name)
    try:
        yield path
    finally:
        _BEING_WRITTEN.discard(path.name)
        with suppress(OSError):
            shutil.rmtree(path, ignore_errors=True) if path.is_dir() else path.unlink(missing_ok=True)


def _host() -> str:
    return f"{zlib.crc32(platform.node().encode()):08x}"


def _is_abandoned(left: Path) -> bool:
    host, process, _ = left.name.removeprefix(PREFIX).split("-", 2)
    if host == _host() and int(process) == os.getpid():
        return left.name not in _BEING_WRITTEN
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

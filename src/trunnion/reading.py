"""Reading files that somebody else may have written: regular ones only, so much and no more, nothing of them quoted.

What a description names is trusted less than what a user names: it has to lie below the description's folder, links
followed, unless the user allows more.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from trunnion.errors import InputError

# A pipe that nobody writes to would be waited for; Windows has neither.
_FLAGS = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0)


def regular_bytes(path: str | os.PathLike[str], most: int, *, what: str) -> bytes:
    """The content of a regular file, of which at most ``most`` bytes and one are read; ``what`` it is to be.

    Raises
    ------
    InputError : it is a folder, a device or a pipe, or larger.
    OSError, ValueError : it cannot be opened, or its name is none.
    """
    remedy = f"name {what}"
    if not stat.S_ISREG(os.stat(path).st_mode):  # before it is opened, which some devices answer to
        raise InputError("is not a regular file", key=str(path), remedy=remedy)
    with open(os.open(path, os.O_RDONLY | _FLAGS), "rb") as stream:
        if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            raise InputError("is not a regular file", key=str(path), remedy=remedy)
        content = stream.read(most + 1)
    if len(content) > most:
        raise InputError(f"has more than {most} bytes", key=str(path), remedy=remedy)
    return content


def below(folder: Path, named: str, remedy: str) -> Path:
    """The file that a description in ``folder`` names, where that lies below it, its links followed.

    Raises
    ------
    InputError : it lies elsewhere.
    """
    home = os.path.abspath(folder)
    there = os.path.abspath(os.path.join(home, named))
    # First by the words alone: on Windows even to look at a name may call another machine.
    if not (_within(home, there) and _within(os.path.realpath(home), os.path.realpath(there))):
        raise InputError("lies outside the folder of the file that names it", key=named, remedy=remedy)
    return Path(there)


def _within(folder: str, path: str) -> bool:
    try:
        return os.path.commonpath([folder, path]) == os.path.commonpath([folder])
    except ValueError:  # on another drive
        return False

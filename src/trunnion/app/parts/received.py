"""A file that the browser sends in pieces, kept in a folder of its own until nobody needs it any more.

A message of the browser is small, a recording is not: it comes chunk by chunk, each answered before the next. On disk
it never has the name that the browser gave it; of that only the ending counts, which has to be one that signals have.
"""

from __future__ import annotations

import tempfile
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import BinaryIO, NoReturn

from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.measured.signals.sources import OPENED

CHUNK = 1_000_000
"""Bytes of a chunk, a quarter of what a message may have."""
MOST_BYTES = 2_000_000_000
LONGEST_NAME = 200
"""Letters of a name of a file."""
REMEDY = "choose the file again"


def plain_name(name: object) -> str:
    """The last part of a name of a file, as text that stands in a line.

    Raises
    ------
    InputError : it is none.
    """
    last = PureWindowsPath(PurePosixPath(name).name).name if isinstance(name, str) else ""
    if not last or len(last) > LONGEST_NAME or not last.isprintable():
        raise InputError(
            "has no name that can be shown", element="measured file",
            remedy=f"rename it: at most {LONGEST_NAME} letters, all of them printable",
        )  # fmt: skip
    return last


class ReceivedFile:
    """A file that is under way from the browser, and then there: ``path`` on disk, ``name`` as the user knows it.

    Raises
    ------
    InputError : a name or ending that signals do not have; a size beyond ``most`` bytes.
    """

    def __init__(self, name: object, size: object, most: int = MOST_BYTES) -> None:
        self.name = plain_name(name)
        ending = PurePosixPath(self.name).suffix.lower()
        if ending not in OPENED:
            known = nearest(ending, tuple(OPENED))
            raise InputError("is not a file of signals", key="measured file", value=self.name, remedy=known)
        if not isinstance(size, int) or isinstance(size, bool) or not 0 < size <= most:
            what = "is empty" if size == 0 else f"has more than the {most / 1e6:.0f} MB that are taken"
            raise InputError(
                what, key="measured file", value=self.name, remedy="record it again, or use trunnion compare-measured"
            )
        self.size, self.taken = size, 0
        self._folder = tempfile.TemporaryDirectory(prefix="trunnion-", ignore_cleanup_errors=True)
        self.path = Path(self._folder.name, f"signals{ending}")
        self._stream: BinaryIO | None = None
        try:
            self._stream = self.path.open("wb")
        except OSError:
            self.close()
            raise

    @property
    def is_whole(self) -> bool:
        """Whether all of it is there."""
        return self.taken == self.size

    def take(self, place: object, chunk: object) -> None:
        """Write the next chunk, which begins at ``place``; nothing is kept of a file that fails.

        Raises
        ------
        InputError : a chunk that does not follow the one before, or is more than was said; a disk that is full.
        """
        if self._stream is None or place != self.taken or not isinstance(chunk, bytes | bytearray):
            self._refuse("did not arrive in order", REMEDY)
        if not 0 < len(chunk) <= CHUNK or self.taken + len(chunk) > self.size:
            self._refuse("is not as long as the browser said", REMEDY)
        try:
            self._stream.write(chunk)
            self.taken += len(chunk)
            if self.is_whole:
                self._stream.close()
                self._stream = None
        except OSError as error:
            self._refuse(f"cannot be kept ({error.strerror})", "make room on the disk of this machine")

    def _refuse(self, what: str, remedy: str) -> NoReturn:
        self.close()
        raise InputError(what, key="measured file", value=self.name, remedy=remedy)

    def close(self) -> None:
        """Delete it."""
        if self._stream is not None:
            self._stream.close()
            self._stream = None
        self._folder.cleanup()

"""One process at a time compiles a function; the others wait and load what it has kept.

The lock is the operating system's on a file beside the machine code, so that it ends with the process that holds it,
however that ends. Where there are no such locks, or nobody lets go in time, everybody compiles for itself: the files of
the cache are replaced whole, so that costs time and nothing else.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import IO

try:
    import fcntl
except ImportError:  # not on Windows
    fcntl = None  # type: ignore[assignment]

HELD: set[CompileLock] = set()
"""All locks that this process holds."""
PATIENCE = 180.0
"""Seconds to wait for another process, beyond which it is taken for stopped."""
POLL = 0.05


class CompileLock:
    """The lock on the file ``path``, None where nothing is kept; it is taken again without waiting by the process that
    holds it."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self._held: IO[bytes] | None = None

    @property
    def held(self) -> bool:
        """Whether this process holds it."""
        return self._held is not None

    def take(self) -> None:
        """Wait for the lock, or go on without it."""
        if fcntl is None or self.path is None or self._held is not None:
            return
        try:
            file = self.path.open("ab")
        except OSError:
            return
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                time.sleep(POLL)
            except OSError:
                break
            else:
                self._held = file
                HELD.add(self)
                return
        file.close()

    def release(self) -> None:
        """Let the next one in."""
        if self._held is not None:
            self._held.close()
            self._held = None
            HELD.discard(self)


def release_all() -> None:
    """Let the next ones in, whatever this process was about to compile."""
    for lock in tuple(HELD):
        lock.release()

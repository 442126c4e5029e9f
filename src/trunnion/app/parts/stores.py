"""Stores of studies where the application was started, and whether they have grown."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

DEPTH = 3
"""How far below the folder where the application was started stores may be: in a folder of a folder there."""
MOST = 200
"""Stores that are offered."""
MOST_FOLDERS = 5000
"""Folders that are looked into."""


def stores_here(folder: Path | None = None) -> list[str]:
    """Paths of stores below a folder, by default the working one, as they are written from there."""
    start = folder or Path()
    found = []
    for number, (path, names) in enumerate(_folders(start, DEPTH)):
        if "study.json" in names:
            found.append(path.relative_to(start).as_posix())
        if number >= MOST_FOLDERS or len(found) >= MOST:
            break
    return sorted(found)


def _folders(folder: Path, depth: int) -> Iterator[tuple[Path, set[str]]]:
    """Folders with the names in them; stores are not looked into, nor what is hidden."""
    with suppress(OSError):
        entries = list(os.scandir(folder))
        names = {entry.name for entry in entries}
        yield folder, names
        if depth < 1 or "study.json" in names:
            return
        for entry in sorted(entries, key=lambda one: one.name):
            if entry.is_dir(follow_symlinks=False) and not entry.name.startswith("."):
                yield from _folders(Path(entry.path), depth - 1)


def grown(store: str) -> str:
    """A word that is another one once a store has more: the newest names in it, without reading them."""
    said = []
    for number in range(1 << 16):
        part = Path(store) / f"part-{number}"
        try:
            said.append((number, len(os.listdir(part / "shards")), len(os.listdir(part / "blocks"))))
        except OSError:
            break
    return str(said)

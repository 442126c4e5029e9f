"""What may be written where; everything that can be refused is refused before the computation."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NoReturn

from trunnion.errors import InputError
from trunnion.pictures.formats import FORMATS

DATA_FORMATS = ("nc", "csv")
REPORTS = (".html", ".htm")
OTHER_FILES = (".pdf", ".png", ".svg", ".json", ".txt", ".md", ".docx", ".xlsx", *(f".{e}" for e in DATA_FORMATS))
"""Endings by which somebody means a file, not a folder."""


def check_report(path: Path) -> None:
    """Refuse where a report cannot be written: to a file, NAME.html, or into a folder."""
    if path.suffix.lower() in REPORTS:
        check_file(path, "report.html")
        return
    if path.suffix.lower() in OTHER_FILES and not path.is_dir():
        _refuse(path, "is not a format of a report", f"write {path.with_suffix('.html')}, or name a folder")
    check_folder(path)


def check_report_file(path: Path, key: str) -> None:
    """Refuse what is no file for a report, NAME.html, or cannot be written; the option is called ``key``."""
    if path.suffix.lower() not in REPORTS:
        _refuse(path, "does not end in .html", f"write {path.with_suffix('.html')}", key)
    check_file(path, "report.html", key)


def check_line_file(path: Path, key: str) -> None:
    """The same of a file for a line, NAME.toml."""
    if path.suffix.lower() != ".toml":
        _refuse(path, "does not end in .toml", f"write {path.with_suffix('.toml')}", key)
    check_file(path, "line.toml", key)


def check_not_read(paths: Sequence[Path], texts: Iterable[object], key: str = "--output") -> None:
    """Refuse to write over a file that a command reads: one that its argument or an option, ``texts``, names, or a
    table or sheet that a driveline file among these names."""
    there = [path for path in paths if path.exists()]
    read = [Path(text) for text in texts if isinstance(text, str) and text and os.path.isfile(text)] if there else []
    for path in there:
        if any(path.samefile(one) for one in read):
            _refuse(path, "is a file that this command reads", "write to another file", key)
        for one in read:
            if any(path.samefile(named) for named in _named_in(one, {one.resolve()})):
                _refuse(path, f"is a file that {one.name} reads", "write to another file", key)


def _named_in(file: Path, seen: set[Path]) -> Iterator[Path]:
    """Files that the texts of a TOML file name, from its folder, and those that these name."""
    if file.suffix.lower() != ".toml":
        return
    try:
        texts = list(_texts_of(tomllib.loads(file.read_text(encoding="utf-8-sig"))))
    except (OSError, ValueError):
        return  # reading it says what is wrong
    for named in (file.parent / text for text in texts):
        if os.path.isfile(named) and named.resolve() not in seen:
            seen.add(named.resolve())
            yield named
            yield from _named_in(named, seen)


def _texts_of(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for one in value.values() if isinstance(value, dict) else value:
            yield from _texts_of(one)


def check_folder(folder: Path) -> None:
    """Refuse a folder that cannot be made or written to; makes nothing yet."""
    there = folder
    while not there.exists() and there != there.parent:
        there = there.parent
    if not there.is_dir():
        _refuse(folder, "is a file, not a folder" if there == folder else f"cannot be made, {there} is a file")
    if not os.access(there, os.W_OK):
        _refuse(folder, "cannot be written to")


def check_outputs(paths: Sequence[Path]) -> None:
    """Refuse endings that say no format, folders in the place of files, and places that cannot be written."""
    for path in paths:
        if not path.is_dir() and path.suffix.removeprefix(".").lower() not in (*FORMATS, *DATA_FORMATS):
            known = ", ".join(f".{ending}" for ending in (*FORMATS, *DATA_FORMATS))
            _refuse(path, "has no ending that names a format", f"end it in one of {known}")
        check_file(path, "chart.png")


def check_file(path: Path, example: str, key: str = "--output") -> None:
    """Refuse a folder in the place of a file, such as ``example``, and a place that cannot be written."""
    if path.is_dir():
        _refuse(path, "is a folder", f"name a file in it, such as {path / example}", key)
    if not path.parent.is_dir():
        _refuse(path, "lies in no folder", f"create the folder {path.parent}", key)
    if not os.access(path.parent, os.W_OK):
        _refuse(path, "cannot be written", key=key)


def _refuse(path: Path, problem: str, remedy: str = "choose another folder", key: str = "--output") -> NoReturn:
    raise InputError(problem, key=key, value=str(path), remedy=remedy) from None

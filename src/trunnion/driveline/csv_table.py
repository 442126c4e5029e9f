"""Numbers of a spreadsheet: a first line that names columns, each with its unit, and rows of plain numbers below it.

Columns stand apart by commas, semicolons or tabs. What a message says of a table is its place, never its content: a
description may name a file that is none.
"""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from trunnion.driveline.quantities import ANGLE, PRESSURE, RATIO, SPEED, QuantityKind, parse, with_article
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.reading import regular_bytes

LARGEST_TABLE = 1_000_000
"""Bytes; a table of 20 orders at 50 speeds has 30 000."""
_HEAD = re.compile(r"([A-Za-z_]+)(?:\s*[\[(]\s*([^\])]*?)\s*[\])])?")


@dataclass(frozen=True)
class TableKind:
    """What a kind of table has.

    Attributes
    ----------
    what : it is, in messages: "the table of orders".
    columns : every column it may have and what it holds.
    needed : those that it must have.
    first_line : an example of how it begins.
    """

    what: str
    columns: Mapping[str, QuantityKind]
    needed: tuple[str, ...]
    first_line: str


UNKNOWN_FILE = "names a file that is not known here"


def refuse_name(value: object, key: str, reader: str) -> None:
    """Refuse the name of a table where nothing says which folder it lies in; ``reader`` is what reads one in Python.

    Raises
    ------
    InputError : ``value``, of an element's ``key``, is such a name.
    """
    if isinstance(value, str) and value.lower().endswith(".csv"):
        remedy = f"use tn.load for a file beside the description, or {key}=tn.{reader}(path)"
        raise InputError(UNKNOWN_FILE, value=value, remedy=remedy)


def read_numbers(path: str | os.PathLike[str], kind: TableKind) -> list[tuple[str, dict[str, float]]]:
    """The numbers of every row in SI units by column, each with its place for messages.

    Raises
    ------
    InputError : the file cannot be read; a column that is unknown, missing or without unit; a cell without number; no
        rows.
    """
    place = Path(path)
    rows = _rows(place, kind)
    columns = _columns(place.name, rows[0], kind)
    found = []
    for number, row in enumerate(rows[1:], start=2):
        where = f"{place.name}: row {number}"
        found.append((where, _values(where, row, columns, kind)))
    return found


def _rows(path: Path, kind: TableKind) -> list[list[str]]:
    try:
        text = regular_bytes(path, LARGEST_TABLE, what=kind.what).decode("utf-8-sig")
    except InputError:
        raise
    except FileNotFoundError:
        there = sorted(p.name for p in path.parent.glob("*.csv")) if path.parent.is_dir() else []
        remedy = nearest(path.name, there) if there else "put it beside the driveline's file"
        raise InputError("file not found", key=str(path), remedy=remedy) from None
    except (OSError, ValueError):
        raise InputError("cannot be read as text in UTF-8", key=str(path), remedy="save it as CSV") from None
    head = text.partition("\n")[0]
    mark = next((m for m in (";", "\t") if m in head), ",")
    reader = csv.reader(text.splitlines(), delimiter=mark)
    try:
        rows = [[cell.strip() for cell in row] for row in reader]
    except csv.Error:
        problem = f"has a cell of more than {csv.field_size_limit()} characters, or one that is not text"
        where = f"{path.name}: row {reader.line_num}"
        raise InputError(problem, element=where, remedy="write numbers, and close what is quoted") from None
    rows = [row for row in rows if any(row) and not row[0].startswith("#")]
    if not rows:
        raise InputError("is empty", key=path.name, remedy=f"write {kind.first_line} in its first line")
    return rows


def _columns(source: str, head: Sequence[str], kind: TableKind) -> dict[str, tuple[int, str]]:
    """Place and unit of every column."""
    found: dict[str, tuple[int, str]] = {}
    for i, cell in enumerate(head):
        match = _HEAD.fullmatch(cell.strip())
        name = match.group(1).lower() if match else ""
        if name not in kind.columns:
            remedy = f"write one of {', '.join(kind.columns)}, and its unit"
            raise InputError("is not a column of such a table", element=source, key=f"column {i + 1}", remedy=remedy)
        unit = (match.group(2) if match else None) or ""
        remedy = f'write "{name} [{_usual(kind.columns[name])}]" in the first line'
        if not unit and kind.columns[name] is not RATIO:
            raise InputError("has no unit", element=source, key=name, remedy=remedy)
        if unit and not _is_unit(unit, kind.columns[name]):
            problem = f"has no unit of {with_article(kind.columns[name].name)}"
            raise InputError(problem, element=source, key=name, remedy=remedy)
        if name in found:
            raise InputError("stands twice", element=source, key=name, remedy="leave one of the columns out")
        found[name] = i, unit
    for name in kind.needed:
        if name not in found:
            remedy = f"write {kind.first_line} in the first line"
            raise InputError("is missing among the columns", element=source, key=name, remedy=remedy)
    return found


def _is_unit(unit: str, kind: QuantityKind) -> bool:
    try:
        parse(f"1 {unit}", kind)
    except InputError:
        return False
    return True


def _usual(kind: QuantityKind) -> str:
    return {SPEED: "rpm", ANGLE: "deg", PRESSURE: "bar"}.get(kind, kind.unit)


def _values(where: str, row: Sequence[str], columns: dict[str, tuple[int, str]], kind: TableKind) -> dict[str, float]:
    values: dict[str, float] = {}
    for name, (i, unit) in columns.items():
        cell = row[i] if i < len(row) else ""
        if not cell:
            raise InputError("is missing", element=where, key=name, remedy="write a number in every column")
        try:
            number = float(cell)
            values[name] = parse(f"{number!r} {unit}" if unit else number, kind.columns[name])
        except ValueError:  # an InputError among them, which would quote it
            raise InputError("is not a number", element=where, key=name, remedy="write 2 or 2.5, say") from None
    return values

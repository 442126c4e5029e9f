"""Tables of harmonic torques from a spreadsheet: one row an order, or an order at a speed or at a mean torque.

::

    order,speed [rpm],amplitude [N*m],phase [deg]
    2,600,180,-90
    2,1800,240,-84
    4,600,35,10

The first line names the columns, each with its unit: order, amplitude, and where there are any phase, and speed (of
the disk) or torque (the mean one that it drives with). Columns stand apart by commas, semicolons or tabs. What a
message says of a table is its place, never its content: a description may name a file that is none.
"""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from trunnion.driveline.excitation import Excitation
from trunnion.driveline.quantities import ANGLE, RATIO, SPEED, TORQUE, QuantityKind, parse
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.reading import regular_bytes

COLUMNS: dict[str, QuantityKind] = {
    "order": RATIO,
    "speed": SPEED,
    "torque": TORQUE,
    "amplitude": TORQUE,
    "phase": ANGLE,
}
LARGEST_TABLE = 1_000_000
"""Bytes; a table of 20 orders at 50 speeds has 30 000."""
_HEAD = re.compile(r"([A-Za-z_]+)(?:\s*[\[(]\s*([^\])]*?)\s*[\])])?")


def read_excitation(path: str | os.PathLike[str]) -> tuple[Excitation, ...]:
    """Harmonic torques of a CSV file, one for each order.

    Parameters
    ----------
    path : of the file; its columns are those of the module's first lines.

    Raises
    ------
    InputError : the file cannot be read; a column that is unknown, missing or without unit; a number that is none; an
        order with two rows for one speed.

    Examples
    --------
    >>> import trunnion as tn
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "orders.csv")
    ...     _ = table.write_text("order,amplitude [N*m],phase [deg]\\n2,60,0\\n4,25,90")
    ...     print([(one.order, one.amplitude) for one in tn.read_excitation(table)])
    [(2.0, 60.0), (4.0, 25.0)]
    """
    place = Path(path)
    rows = _rows(place)
    columns = _columns(place.name, rows[0])
    by_order: dict[float, list[dict[str, float]]] = {}
    for number, row in enumerate(rows[1:], start=2):
        values = _values(f"{place.name}: row {number}", row, columns)
        by_order.setdefault(values["order"], []).append(values)
    over = next((key for key in ("speed", "torque") if key in columns), None)
    if not by_order:
        raise InputError("has no rows below its first line", key=place.name, remedy="write one row an order")
    return tuple(_harmonic(place.name, order, found, over) for order, found in sorted(by_order.items()))


def _rows(path: Path) -> list[list[str]]:
    try:
        text = regular_bytes(path, LARGEST_TABLE, what="the table of orders").decode("utf-8-sig")
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
        problem = f"has a cell of more than {csv.field_size_limit()} characters, or one that is no text"
        where = f"{path.name}: row {reader.line_num}"
        raise InputError(problem, element=where, remedy="write numbers, and close what is quoted") from None
    rows = [row for row in rows if any(row) and not row[0].startswith("#")]
    if not rows:
        raise InputError("is empty", key=path.name, remedy="write order,amplitude [N*m] in its first line")
    return rows


def _columns(source: str, head: Sequence[str]) -> dict[str, tuple[int, str]]:
    """Place and unit of every column."""
    found: dict[str, tuple[int, str]] = {}
    for i, cell in enumerate(head):
        match = _HEAD.fullmatch(cell.strip())
        name = match.group(1).lower() if match else ""
        if name not in COLUMNS:
            remedy = f"write one of {', '.join(COLUMNS)}, and its unit"
            raise InputError("is not a column of such a table", element=source, key=f"column {i + 1}", remedy=remedy)
        unit = (match.group(2) if match else None) or ""
        remedy = f'write "{name} [{_usual(COLUMNS[name])}]" in the first line'
        if not unit and COLUMNS[name] is not RATIO:
            raise InputError("has no unit", element=source, key=name, remedy=remedy)
        if unit and not _is_unit(unit, COLUMNS[name]):
            raise InputError(f"has no unit of a {COLUMNS[name].name}", element=source, key=name, remedy=remedy)
        if name in found:
            raise InputError("stands twice", element=source, key=name, remedy="leave one of the columns out")
        found[name] = i, unit
    for name in ("order", "amplitude"):
        if name not in found:
            remedy = "write order,amplitude [N*m] in the first line"
            raise InputError("is missing among the columns", element=source, key=name, remedy=remedy)
    if "speed" in found and "torque" in found:
        remedy = "a table goes over one of the two; leave the other out"
        raise InputError("stands beside speed", element=source, key="torque", remedy=remedy)
    return found


def _is_unit(unit: str, kind: QuantityKind) -> bool:
    try:
        parse(f"1 {unit}", kind)
    except InputError:
        return False
    return True


def _usual(kind: QuantityKind) -> str:
    return {SPEED: "rpm", ANGLE: "deg"}.get(kind, kind.unit)


def _values(where: str, row: Sequence[str], columns: dict[str, tuple[int, str]]) -> dict[str, float]:
    values: dict[str, float] = {}
    for name, (i, unit) in columns.items():
        cell = row[i] if i < len(row) else ""
        if not cell:
            raise InputError("is missing", element=where, key=name, remedy="write a number in every column")
        try:
            number = float(cell)
            values[name] = parse(f"{number!r} {unit}" if unit else number, COLUMNS[name])
        except ValueError:  # an InputError among them, which would quote it
            raise InputError("is not a number", element=where, key=name, remedy="write 2 or 2.5, say") from None
    return values


def _harmonic(source: str, order: float, rows: list[dict[str, float]], over: str | None) -> Excitation:
    where: dict[str, Any] = {"element": source, "key": f"order {order:g}"}
    if over is None:
        if len(rows) > 1:
            remedy = "add a column speed [rpm], or leave all rows but one out"
            raise InputError("stands in several rows", **where, remedy=remedy)
        return Excitation(order=order, amplitude=rows[0]["amplitude"], phase=rows[0].get("phase", 0.0))
    rows = sorted(rows, key=lambda row: row[over])
    points = tuple(row[over] for row in rows)
    if len(set(points)) < len(points):
        raise InputError(f"has two rows for one {over}", **where, remedy="leave one of them out")
    if len(points) < 2:
        raise InputError(f"has one {over} only", **where, remedy="give two at least: the ends of the range")
    table: dict[str, Any] = {f"{over}s": points, "amplitudes": tuple(row["amplitude"] for row in rows)}
    if "phase" in rows[0]:
        table["phases"] = tuple(row["phase"] for row in rows)
    try:
        return Excitation(order=order, **table)
    except InputError as error:
        raise error.each(lambda one: one.but(**where, value=None)) from None

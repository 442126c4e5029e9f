"""Tables of harmonic torques from a spreadsheet: one row an order, or an order at a speed, at a mean torque or at both.

::

    order,speed [rpm],amplitude [N*m],phase [deg]
    2,600,180,-90
    2,1800,240,-84
    4,600,35,10

The first line names the columns, each with its unit: order, amplitude, and where there are any phase, and speed (of
the disk) or torque (the mean one that it drives with), or both: then every speed has a row at every torque, and between
them A e^{i phase} is bilinear. Columns stand apart by commas, semicolons or tabs.
"""

from __future__ import annotations

import os
from itertools import product
from pathlib import Path
from typing import Any

from trunnion.driveline.csv_table import TableKind, read_numbers
from trunnion.driveline.excitation import Excitation
from trunnion.driveline.quantities import ANGLE, RATIO, SPEED, TORQUE, QuantityKind, shown
from trunnion.errors import InputError

COLUMNS: dict[str, QuantityKind] = {
    "order": RATIO,
    "speed": SPEED,
    "torque": TORQUE,
    "amplitude": TORQUE,
    "phase": ANGLE,
}
UNITS = {"speed": "rpm", "torque": None}
"""What points are told in."""
ORDERS = TableKind("the table of orders", COLUMNS, ("order", "amplitude"), "order,amplitude [N*m]")


def read_excitation(path: str | os.PathLike[str]) -> tuple[Excitation, ...]:
    """Harmonic torques of a CSV file, one for each order.

    Parameters
    ----------
    path : of the file; its columns are those of the module's first lines.

    Raises
    ------
    InputError : the file cannot be read; a column that is unknown, missing or without unit; a cell without number; an
        order with two rows for one speed, or without one for a speed and torque.

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
    source, rows = Path(path).name, read_numbers(path, ORDERS)
    by_order: dict[float, list[dict[str, float]]] = {}
    for _, values in rows:
        by_order.setdefault(values["order"], []).append(values)
    columns = rows[0][1] if rows else {}
    over = tuple(key for key in ("speed", "torque") if key in columns)
    if not by_order:
        raise InputError("has no rows below its first line", key=source, remedy="write one row an order")
    return tuple(_harmonic(source, order, found, over) for order, found in sorted(by_order.items()))


def _harmonic(source: str, order: float, rows: list[dict[str, float]], over: tuple[str, ...]) -> Excitation:
    where: dict[str, Any] = {"element": source, "key": f"order {order:g}"}
    if not over:
        if len(rows) > 1:
            remedy = "add a column speed [rpm], or leave all rows but one out"
            raise InputError("stands in several rows", **where, remedy=remedy)
        return Excitation(order=order, amplitude=rows[0]["amplitude"], phase=rows[0].get("phase", 0.0))
    rows = sorted(rows, key=lambda row: [row[key] for key in reversed(over)])
    axes = {key: sorted({row[key] for row in rows}) for key in over}
    places = [tuple(row[key] for key in over) for row in rows]
    if len(set(places)) < len(places):
        raise InputError(f"has two rows for one {' and '.join(over)}", **where, remedy="leave one of them out")
    for key, points in axes.items():
        if len(points) < 2:
            raise InputError(f"has one {key} only", **where, remedy="give two at least: the ends of the range")
    if missing := next((one for one in product(*axes.values()) if one not in set(places)), None):
        at = " and ".join(shown(one, COLUMNS[key], UNITS[key]) for key, one in zip(over, missing, strict=True))
        raise InputError(f"has no row at {at}", **where, remedy="give every speed a row at every torque")
    table: dict[str, Any] = {f"{key}s": tuple(points) for key, points in axes.items()}
    table["amplitudes"] = tuple(row["amplitude"] for row in rows)
    if "phase" in rows[0]:
        table["phases"] = tuple(row["phase"] for row in rows)
    try:
        return Excitation(order=order, **table)
    except InputError as error:
        raise error.each(lambda one: one.but(**where, value=None)) from None

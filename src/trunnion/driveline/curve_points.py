"""A torque over speed by its points: listed, or from a spreadsheet beside the description.

::

    speed [rpm],torque [N*m]
    0,410
    900,395
    1380,520
    1500,0
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import BeforeValidator, Field

from trunnion.driveline.csv_table import TableKind, read_numbers, refuse_name
from trunnion.driveline.quantities import SPEED, TORQUE, Speed, TableList, Torque, shown
from trunnion.driveline.record import Record, listed
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.laws.torque_curve import TableCurve

COLUMNS = TableKind(
    "the table of torque over speed",
    {"speed": SPEED, "torque": TORQUE},
    ("speed", "torque"),
    "speed [rpm],torque [N*m]",
)
POINTS = 'curve = [{ speed = "0 rpm", torque = "90 N*m" }, { speed = "1500 rpm", torque = "0 N*m" }]'


class TorquePoint(Record):
    """A point of a torque over speed.

    Parameters
    ----------
    speed : of the shaft that it acts on [rad/s].
    torque : there [N m].

    >>> TorquePoint(speed="0 rpm", torque="0.4 kN*m").torque
    400.0
    """

    what: ClassVar[str] = "curve"
    example: ClassVar[str] = 'speed = "1500 rpm" and torque = "90 N*m"'

    speed: Speed = Field(description="of its shaft")
    torque: Torque = Field(description="at that speed")


_READ = listed(TorquePoint, "point", f"write {POINTS}, or the name of a CSV file")


def _points(value: object) -> tuple[TorquePoint, ...]:
    refuse_name(value, "curve", "read_curve")
    made = _READ(value)
    if len(made) < 2:
        raise InputError("must have two points at least", value=len(made), remedy=f"write {POINTS}")
    for before, after in zip(made, made[1:], strict=False):
        if not after.speed > before.speed:
            speeds = " after ".join(shown(one.speed, SPEED, "rpm") for one in (after, before))
            raise InputError(f"does not rise in speed: {speeds}", remedy="sort the points by speed; each speed once")
    if made[0].speed < 0:
        remedy = "begin at 0 or above; speeds count in the sense that the shaft turns"
        raise InputError("must not be negative", value=made[0].speed, remedy=remedy)
    return made


Curve = Annotated[TableList[TorquePoint], BeforeValidator(_points)]


def read_curve(path: str | os.PathLike[str]) -> tuple[TorquePoint, ...]:
    """Points of a CSV file with the columns speed and torque, each with its unit.

    Parameters
    ----------
    path : of the file.

    Raises
    ------
    InputError : the file cannot be read; a column that is unknown, missing or without unit; a cell without number;
        speeds that do not rise.

    Examples
    --------
    >>> import trunnion as tn
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "motor.csv")
    ...     _ = table.write_text("speed [rad/s],torque [kN*m]\\n0,0.4\\n157,0")
    ...     print([(one.speed, one.torque) for one in tn.read_curve(table)])
    [(0.0, 400.0), (157.0, 0.0)]
    """
    source, rows = Path(path).name, read_numbers(path, COLUMNS)
    if not rows:
        remedy = f"write rows below {COLUMNS.first_line}"
        raise InputError("has no rows below its first line", key=source, remedy=remedy)
    try:
        return _points([TorquePoint(**row) for _, row in rows])
    except InputError as error:
        raise error.each(lambda one: one.but(element=source, key="speed", value=None)) from None


def table_curve(points: tuple[TorquePoint, ...]) -> TableCurve:
    """The curve through the points, see ``trunnion.laws.torque_curve``."""
    from trunnion.laws.torque_curve import TableCurve

    return TableCurve(tuple(one.speed for one in points), tuple(one.torque for one in points))

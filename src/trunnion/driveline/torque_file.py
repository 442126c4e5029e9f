"""Torques over time, speed or angle from a spreadsheet: one row a point, two columns, each with its unit.

::

    time [s],torque [N*m]
    0,0
    0.5,120
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from trunnion.driveline.csv_table import TableKind, read_numbers
from trunnion.driveline.quantities import ANGLE, SPEED, TIME, TORQUE
from trunnion.errors import InputError

COLUMNS = TableKind(
    "the table of torques",
    {"time": TIME, "speed": SPEED, "angle": ANGLE, "torque": TORQUE},
    (),
    "time [s],torque [N*m]",
)


def read_torque(path: str | os.PathLike[str]) -> dict[str, tuple[float, ...]]:
    """Points and torques [SI] of a CSV file, as ``AppliedTorque`` takes them.

    Parameters
    ----------
    path : of the file.

    Raises
    ------
    InputError : the file cannot be read; a column that is unknown, missing or without unit; a cell without number.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import trunnion as tn
    >>> place = pathlib.Path(tempfile.mkdtemp()) / "start.csv"
    >>> _ = place.write_text("time [ms],torque [kN*m]\\n0,0\\n500,0.12\\n", encoding="utf-8")
    >>> tn.AppliedTorque(on="motor", **tn.read_torque(place)).torque
    (0.0, 120.0)
    """
    source, rows = Path(path).name, read_numbers(path, COLUMNS)
    if not rows:
        raise InputError("has no rows below its first line", key=source, remedy="write one row a point")
    points = [values for _, values in rows]
    over = [key for key in points[0] if key != "torque"]
    if "torque" not in points[0] or len(over) != 1:
        problem = "goes over one of time, speed and angle, and has torques beside it"
        raise InputError(problem, key=source, remedy=f"write {COLUMNS.first_line} in its first line")
    return {key: tuple(point[key] for point in points) for key in (over[0], "torque")}


def with_torque_files(scenario: dict[str, Any], place_of: Callable[[str], Path]) -> dict[str, Any]:
    """A scenario's table with the points of every torque that names a ``file`` put in its place.

    Raises
    ------
    InputError : the file cannot be read, or its points stand beside it.
    """
    torques = scenario.get("torque")
    if not isinstance(torques, list):
        return scenario
    return {**scenario, "torque": [_with_points(one, place_of) if isinstance(one, dict) else one for one in torques]}


def _with_points(torque: dict[str, Any], place_of: Callable[[str], Path]) -> dict[str, Any]:
    named = torque.get("file")
    if not isinstance(named, str):
        return torque
    found = read_torque(place_of(named))
    beside = [key for key in COLUMNS.columns if key in torque]
    if beside:
        raise InputError("conflicts with file", element="torque", key=beside[0], remedy="leave one of the two out")
    return {**{key: value for key, value in torque.items() if key != "file"}, **found}

"""Pressure in a cylinder over the angle of its crank, and files that it stands in."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Annotated, ClassVar, Self

from pydantic import BeforeValidator, model_validator

from trunnion.driveline.csv_table import TableKind, read_numbers, refuse_name
from trunnion.driveline.quantities import (
    ANGLE,
    PRESSURE,
    RATIO,
    Angle,
    Dimensionless,
    Maybe,
    Pressure,
    Several,
    optional,
    shown,
)
from trunnion.driveline.record import Record, as_tuple, listed
from trunnion.errors import InputError

FEWEST_POINTS = 24
"""Of a curve: coarser ones miss its peak."""
_LISTS = as_tuple("quantities", 'write angles = ["0 deg", "2 deg", ...], pressures = ["85 bar", "84 bar", ...]')
PRESSURES = TableKind(
    "the pressure curve",
    {"load": RATIO, "angle": ANGLE, "pressure": PRESSURE},
    ("angle", "pressure"),
    "angle [deg],pressure [bar]",
)


class PressureCurve(Record):
    """Absolute pressure in one cylinder over a cycle, at one load; linear between its points.

    Parameters
    ----------
    angles : of the crank [rad], rising over one cycle, 0 at the top dead centre at which it fires.
    pressures : there [Pa]; the last is the first again, or the curve ends one step before that.
    load : by which messages call it, 0.75 say; the torque that belongs to it follows from the curve.

    >>> angles = [f"{30 * i} deg" for i in range(25)]
    >>> curve = PressureCurve(angles=angles, pressures=["90 bar", *["3 bar"] * 23, "90 bar"])
    >>> round(max(curve.pressures))
    9000000
    """

    what: ClassVar[str] = "pressure"
    example: ClassVar[str] = 'angles = ["0 deg", ...] and pressures = ["85 bar", ...]'

    load: Maybe[Dimensionless] = optional(default=None, description="by which messages call the curve, 0.75 say")
    angles: Annotated[Several[Angle], BeforeValidator(_LISTS)] = optional(
        default=(), description="of the crank, rising over a cycle; 0 is the top dead centre at which it fires"
    )
    pressures: Annotated[Several[Pressure], BeforeValidator(_LISTS)] = optional(
        default=(), description="absolute, at these angles"
    )

    @model_validator(mode="after")
    def _curve(self) -> Self:
        count = len(self.angles)
        if count < FEWEST_POINTS:
            remedy = "give one every 2 deg, say, over the whole cycle"
            raise InputError(
                f"has {count} points, and a curve needs {FEWEST_POINTS} at least", key="angles", remedy=remedy
            )
        if len(self.pressures) != count:
            problem = f"must be {count} quantities, one for each of angles, and are {len(self.pressures)}"
            raise InputError(problem, key="pressures", remedy="give one at every angle")
        if (wrong := next(((a, b) for a, b in pairwise(self.angles) if b <= a), None)) is not None:
            before, behind = (shown(angle, ANGLE, "deg") for angle in wrong)
            raise InputError(f"must rise: {behind} after {before}", key="angles", remedy="sort them; each once")
        if min(self.pressures) <= 0:
            remedy = "pressures are absolute: add that of the air, 1.013 bar, to those above it"
            raise InputError("must be positive", key="pressures", value=min(self.pressures), remedy=remedy)
        return self


def curves(key: str) -> Callable[[object], tuple[PressureCurve, ...]]:
    """Reads the pressure curves that ``key`` states, one or more."""
    read = listed(PressureCurve, "pressure curve", key=key, none=False)

    def one_or_more(value: object) -> tuple[PressureCurve, ...]:
        refuse_name(value, key, "read_pressure")
        return read([value] if isinstance(value, PressureCurve) else value)

    return one_or_more


def read_pressure(path: str | os.PathLike[str]) -> tuple[PressureCurve, ...]:
    """Pressure curves of a CSV file, one for each load.

    ::

        load,angle [deg],pressure [bar]
        0.5,-360,2.1
        0.5,-358,2.1

    Without a column ``load`` all rows are one curve; rows of a curve may come in any order.

    Parameters
    ----------
    path : of the file.

    Raises
    ------
    InputError : the file cannot be read; a column that is unknown, missing or without unit; a cell without number; too
        few rows of a load; an angle twice.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> import trunnion as tn
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "pressure.csv")
    ...     rows = ["angle [deg],pressure [bar]", *(f"{30 * i},{90 if i == 12 else 3}" for i in range(24))]
    ...     _ = path.write_text("\\n".join(rows))
    ...     (curve,) = tn.read_pressure(path)
    >>> len(curve.angles), max(curve.pressures)
    (24, 9000000.0)
    """
    by_load: dict[float | None, list[tuple[float, float]]] = {}
    for _, row in read_numbers(path, PRESSURES):
        by_load.setdefault(row.get("load"), []).append((row["angle"], row["pressure"]))
    source = Path(path).name
    if not by_load:
        raise InputError("has no rows below its first line", key=source, remedy="write one row an angle")
    found = []
    for load, points in by_load.items():
        points.sort()
        label = source if load is None else f"{source}: load {load:g}"
        try:
            angles, pressures = zip(*points, strict=True)
            found.append(PressureCurve(load=load, angles=angles, pressures=pressures))
        except InputError as error:
            raise error.each(partial(_about, label)) from None
    return tuple(found)


def _about(label: str, error: InputError) -> InputError:
    return error.but(element=label, value=None)

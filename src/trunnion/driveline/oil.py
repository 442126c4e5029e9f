"""Silicone oil of a viscous damper by its complex stiffness: listed, or from a spreadsheet beside the description.

::

    frequency [Hz],stiffness [N*m/rad],loss_stiffness [N*m/rad],temperature [degC]
    20,900,4300,60
    50,2600,9100,60
    200,15000,26000,60
"""

from __future__ import annotations

import os
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Self

from pydantic import BeforeValidator, Field, model_validator

from trunnion.driveline.csv_table import TableKind, read_numbers, refuse_name
from trunnion.driveline.quantities import (
    FREQUENCY,
    RATIO,
    STIFFNESS,
    TEMPERATURE,
    Dimensionless,
    Frequency,
    Maybe,
    Stiffness,
    TableList,
    Temperature,
    optional,
    shown,
)
from trunnion.driveline.record import Record, listed
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.laws.oil import OilStiffness

COLUMNS = TableKind(
    "the table of the oil of a damper",
    {
        "frequency": FREQUENCY, "stiffness": STIFFNESS, "loss_stiffness": STIFFNESS, "loss_factor": RATIO,
        "temperature": TEMPERATURE,
    },
    ("frequency", "stiffness"),
    "frequency [Hz],stiffness [N*m/rad],loss_stiffness [N*m/rad]",
)  # fmt: skip
POINTS = (
    'oil = [{ frequency = "20 Hz", stiffness = "900 N*m/rad", loss_stiffness = "4300 N*m/rad" }, '
    '{ frequency = "200 Hz", stiffness = "15 kN*m/rad", loss_stiffness = "26 kN*m/rad" }]'
)


class OilPoint(Record):
    """Complex stiffness of the oil in a damper at one frequency and temperature.

    Parameters
    ----------
    frequency : [rad/s].
    stiffness : K′, the part in phase with the twist [N m/rad].
    loss_stiffness : K″, the part ahead of it by a quarter of a cycle [N m/rad]; or else
    loss_factor : tan δ = K″/K′.
    temperature : of the oil [K]; without it all points are of one.

    >>> OilPoint(frequency="50 Hz", stiffness="2.6 kN*m/rad", loss_factor=3.5).loss
    9100.0
    """

    what: ClassVar[str] = "oil"
    example: ClassVar[str] = 'frequency = "50 Hz", stiffness = "2.6 kN*m/rad" and loss_stiffness = "9.1 kN*m/rad"'

    frequency: Frequency = Field(description="of the twist")
    stiffness: Stiffness = Field(description="K', in phase with the twist")
    loss_stiffness: Maybe[Stiffness] = optional(default=None, description="K'', a quarter of a cycle ahead of it")
    loss_factor: Maybe[Dimensionless] = optional(default=None, description="K''/K' instead")
    temperature: Maybe[Temperature] = optional(default=None, description="of the oil")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if (self.loss_stiffness is None) == (self.loss_factor is None):
            problem = "is missing" if self.loss_factor is None else "conflicts with loss_factor"
            remedy = 'write loss_stiffness = "9.1 kN*m/rad", or loss_factor = 3.5'
            raise InputError(problem, key="loss_stiffness", remedy=remedy)
        for key in ("frequency", "stiffness", "loss_stiffness", "loss_factor"):
            value = getattr(self, key)
            if value is not None and not value > 0:
                raise InputError("must be positive", key=key, value=value, remedy=f"write {self.example}")
        return self

    @property
    def loss(self) -> float:
        """K″ [N m/rad]."""
        return float((self.loss_stiffness or 0.0) if self.loss_factor is None else self.loss_factor * self.stiffness)


_READ = listed(OilPoint, "point", f"write {POINTS}, or the name of a CSV file", none=False)


def _points(value: object) -> tuple[OilPoint, ...]:
    refuse_name(value, "oil", "read_oil")
    made = _READ(value)
    if len({one.temperature is None for one in made}) > 1:
        raise InputError("has points with and without a temperature", remedy="write it at all of them, or at none")
    for points in by_temperature(made).values():
        where = "" if points[0].temperature is None else f" at {shown(points[0].temperature, TEMPERATURE)}"
        if len(points) < 2:
            raise InputError(f"must have two points at least{where}", value=len(points), remedy=f"write {POINTS}")
        for before, after in pairwise(points):
            if not after.frequency > before.frequency:
                pair = " after ".join(shown(one.frequency, FREQUENCY) for one in (after, before))
                remedy = "sort the points of each temperature by frequency; each once"
                raise InputError(f"does not rise in frequency{where}: {pair}", remedy=remedy)
    return made


UNSTATED = -1.0
"""Stands for the temperature of points that state none."""
Oil = Annotated[TableList[OilPoint], BeforeValidator(_points)]


def by_temperature(points: tuple[OilPoint, ...]) -> dict[float, list[OilPoint]]:
    """The points of each temperature, rising; ``UNSTATED`` of those without."""
    found: dict[float, list[OilPoint]] = {}
    for one in points:
        found.setdefault(UNSTATED if one.temperature is None else one.temperature, []).append(one)
    return dict(sorted(found.items()))


def oil_stiffness(points: tuple[OilPoint, ...]) -> OilStiffness:
    """The law through the points."""
    from trunnion.laws.oil import Isotherm, OilStiffness

    return OilStiffness(
        tuple(
            Isotherm(
                temperature, tuple(one.frequency for one in own), tuple(one.stiffness for one in own),
                tuple(one.loss for one in own),
            )
            for temperature, own in by_temperature(points).items()
        )
    )  # fmt: skip


def read_oil(path: str | os.PathLike[str]) -> tuple[OilPoint, ...]:
    """Points of a CSV file with the columns frequency, stiffness, loss_stiffness or loss_factor, and temperature.

    Parameters
    ----------
    path : of the file; each column but loss_factor has its unit in the first line.

    Raises
    ------
    InputError : the file cannot be read; a column that is unknown, missing or without unit; a cell without number;
        frequencies that do not rise.

    Examples
    --------
    >>> import trunnion as tn
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "silicone.csv")
    ...     _ = table.write_text("frequency [rad/s],stiffness [N*m/rad],loss_factor\\n100,500,4\\n1000,9000,2")
    ...     print([(one.frequency, one.loss) for one in tn.read_oil(table)])
    [(100.0, 2000.0), (1000.0, 18000.0)]
    """
    source, rows = Path(path).name, read_numbers(path, COLUMNS)
    if not rows:
        raise InputError(
            "has no rows below its first line", key=source, remedy=f"write rows below {COLUMNS.first_line}"
        )
    try:
        return _points([OilPoint(**row) for _, row in rows])
    except InputError as error:
        raise error.each(lambda one: one.but(element=source, key="frequency", value=None)) from None

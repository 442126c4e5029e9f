"""Hydrodynamic torque converters: their curves, listed or from a spreadsheet beside the description.

::

    speed_ratio,torque_ratio,capacity [N*m*s^2/rad^2]
    0,2.1,0.0042
    0.5,1.55,0.0041
    0.85,1,0.0030
    1,1,0
"""

from __future__ import annotations

import os
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from trunnion.driveline.csv_table import TableKind, read_numbers, refuse_name
from trunnion.driveline.elements import not_negative, positive
from trunnion.driveline.parts import Dragged, Geared, Heavy, Numbers, Part
from trunnion.driveline.quantities import (
    QUADRATIC,
    RATIO,
    TORQUE,
    Dimensionless,
    Inertia,
    Maybe,
    Power,
    QuadraticLoad,
    Speed,
    TableList,
    Torque,
    optional,
)
from trunnion.driveline.record import Record, Switch, listed
from trunnion.driveline.shafts import Elastic
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.laws.converter import ConverterCurves, ConverterRun

COLUMNS = TableKind(
    "the table of a torque converter",
    {"speed_ratio": RATIO, "torque_ratio": RATIO, "capacity": QUADRATIC, "pump_torque": TORQUE},
    ("speed_ratio", "torque_ratio"),
    "speed_ratio,torque_ratio,capacity [N*m*s^2/rad^2]",
)
POINTS = (
    "curves = [{ speed_ratio = 0, torque_ratio = 2.1, capacity = 0.0042 }, "
    "{ speed_ratio = 0.85, torque_ratio = 1, capacity = 0.003 }, { speed_ratio = 1, torque_ratio = 1, capacity = 0 }]"
)
FINEST = 1_000_000
"""Largest denominator of the ratio of speeds that equations have."""
GAIN = 1e-6
"""By which the efficiency may exceed 1 in rounding."""


class ConverterPoint(Record):
    """A point of the curves of a torque converter.

    Parameters
    ----------
    speed_ratio : ν, speed of the turbine over that of the pump.
    torque_ratio : μ, torque of the turbine over that of the pump.
    capacity : K, torque of the pump over the square of its speed [N m s²/rad²]; or else
    pump_torque : its torque [N m] at the ``reference_speed`` of the converter, as sheets print it.

    >>> ConverterPoint(speed_ratio=0.5, torque_ratio=1.55, capacity=0.0041).torque_ratio
    1.55
    """

    what: ClassVar[str] = "curves"
    example: ClassVar[str] = "speed_ratio = 0.5, torque_ratio = 1.55 and capacity = 0.0041"

    speed_ratio: Dimensionless = Field(description="turbine over pump")
    torque_ratio: Dimensionless = Field(description="turbine over pump")
    capacity: Maybe[QuadraticLoad] = optional(default=None, description="torque of the pump over its speed squared")
    pump_torque: Maybe[Torque] = optional(default=None, description="instead: at the converter's reference_speed")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if (self.capacity is None) == (self.pump_torque is None):
            problem = "is missing" if self.capacity is None else "conflicts with pump_torque"
            raise InputError(problem, key="capacity", remedy='write capacity = 0.0041, or pump_torque = "180 N*m"')
        if not self.torque_ratio > 0:
            raise InputError("must be positive", key="torque_ratio", value=self.torque_ratio, remedy="1 at coupling")
        return self


_READ = listed(ConverterPoint, "point", f"write {POINTS}, or the name of a CSV file")


def _points(value: object) -> tuple[ConverterPoint, ...]:
    refuse_name(value, "curves", "read_converter")
    made = _READ(value)
    if len(made) < 3:
        raise InputError("must have three points at least", value=len(made), remedy=f"write {POINTS}")
    for before, after in pairwise(made):
        if not after.speed_ratio > before.speed_ratio:
            ratios = f"{after.speed_ratio:g} after {before.speed_ratio:g}"
            remedy = "sort the points by speed_ratio; each once"
            raise InputError(f"does not rise in speed_ratio: {ratios}", remedy=remedy)
    if made[0].speed_ratio < 0:
        remedy = "begin at 0, where the turbine stands"
        raise InputError("must not be negative", value=made[0].speed_ratio, remedy=remedy)
    return made


ConverterTable = Annotated[TableList[ConverterPoint], BeforeValidator(_points)]


def read_converter(path: str | os.PathLike[str]) -> tuple[ConverterPoint, ...]:
    """Points of the curves of a torque converter from a CSV file.

    Parameters
    ----------
    path : of the file, with the columns speed_ratio, torque_ratio and either capacity or pump_torque with its unit.

    Raises
    ------
    InputError : the file cannot be read; a column that is unknown, missing or without unit; a number that is none;
        speed ratios that do not rise.

    Examples
    --------
    >>> import trunnion as tn
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder, "converter.csv")
    ...     _ = table.write_text("speed_ratio,torque_ratio,pump_torque [N*m]\\n0,2,180\\n0.85,1,140\\n1,1,0")
    ...     print([one.pump_torque for one in tn.read_converter(table)])
    [180.0, 140.0, 0.0]
    """
    source, rows = Path(path).name, read_numbers(path, COLUMNS)
    if not rows:
        remedy = f"write rows below {COLUMNS.first_line}"
        raise InputError("has no rows below its first line", key=source, remedy=remedy)
    try:
        return _points([ConverterPoint(**row) for _, row in rows])
    except InputError as error:
        raise error.each(lambda one: one.but(element=source, value=None)) from None


class TorqueConverter(Elastic):
    """A hydrodynamic converter between an engine and its gearbox: pump, turbine, and a stator that holds the rest.

    Its turbine turns as fast as the torques let it, at every speed of the pump otherwise (see
    ``trunnion.laws.converter``): linear analyses find that balance and take the slopes of both torques there, motions
    in time follow the curves. No spring joins the two sides.

    Parameters
    ----------
    curves : points of torque ratio and capacity over the speed ratio, three or more, rising from 0 or above; in a file
        also the name of a CSV table beside it, see ``read_converter``. Between them both follow a monotone cubic. Below
        the first point the converter is as there; beyond the last it is not known. Points above 1, where the turbine
        drives the pump, have a negative capacity.
    reference_speed : of the pump [rad/s], where points state a pump_torque.
    locked : its lock-up clutch is closed: a rigid link.
    inertia_in, inertia_out : of pump and shell, and of the turbine [kg m²]; left out where disks beside it have them.
    heat_rating : heat of its oil borne continuously [W], which checks compare with.

    >>> converter = TorqueConverter(curves=[
    ...     {"speed_ratio": 0.0, "torque_ratio": 2.0, "capacity": 4e-3},
    ...     {"speed_ratio": 0.85, "torque_ratio": 1.0, "capacity": 3e-3},
    ...     {"speed_ratio": 1.0, "torque_ratio": 1.0, "capacity": 0.0},
    ... ])
    >>> run = converter.at(0.85, 200.0)
    >>> print(f"{run.pump_torque:.0f} N m in, {run.turbine_torque:.0f} N m out, {run.heat:.0f} W of heat")
    120 N m in, 120 N m out, 3600 W of heat
    """

    example: ClassVar[str] = POINTS
    ratings: ClassVar[tuple[str, ...]] = ("heat_rating",)
    idle: ClassVar[tuple[str, ...]] = ratings

    _run: ConverterRun | None = PrivateAttr(default=None)

    curves: ConverterTable = Field(description="torque ratio and capacity over the speed ratio")
    reference_speed: Maybe[Speed] = optional(default=None, description="of the pump, at which points state its torque")
    locked: Switch = Field(default=False, description="its lock-up clutch is closed")
    inertia_in: Inertia = optional(default=0.0, description="of pump and shell")
    inertia_out: Inertia = optional(default=0.0, description="of the turbine")
    heat_rating: Maybe[Power] = optional(default=None, description="rating, heat of its oil borne continuously")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        positive(self, "reference_speed", "heat_rating")
        not_negative(self, "inertia_in", "inertia_out")
        by_torque = any(one.pump_torque is not None for one in self.curves)
        if by_torque and self.reference_speed is None:
            remedy = 'write reference_speed = "2000 rpm", say'
            raise InputError("is needed with pump_torque", key="reference_speed", remedy=remedy)
        if self.reference_speed is not None and not by_torque:
            raise InputError(
                "conflicts with capacity, which holds at any speed", key="reference_speed", remedy="leave it out"
            )
        for point, capacity in zip(self.curves, self.capacities, strict=True):
            ratio, gain = point.speed_ratio, point.speed_ratio * point.torque_ratio
            if ratio < 1 and not capacity > 0:
                remedy = "only at a speed ratio of 1 and above nothing or less is left"
                raise InputError(f"must be positive at a speed ratio of {ratio:g}", key="curves", remedy=remedy)
            if ratio > 1 and capacity > 0:
                remedy = "write it negative: the turbine drives the pump there"
                raise InputError(f"is positive at a speed ratio of {ratio:g}", key="curves", remedy=remedy)
            if (gain > 1 + GAIN and capacity > 0) or (gain < 1 - GAIN and capacity < 0):
                raise InputError(
                    f"gives more power than it takes at a speed ratio of {ratio:g}: torque_ratio is "
                    f"{point.torque_ratio:g}", key="curves", remedy=f"write {1 / ratio:.4g} or less, above 1 or more",
                )  # fmt: skip
        return self

    @property
    def capacities(self) -> tuple[float, ...]:
        """K [N m s²/rad²] at the points, whichever way they state it."""
        over = 1.0 if self.reference_speed is None else self.reference_speed**2
        return tuple(
            float(one.capacity if one.capacity is not None else (one.pump_torque or 0.0) / over) for one in self.curves
        )

    @cached_property
    def law(self) -> ConverterCurves:
        """Its curves, see ``trunnion.laws.converter``."""
        from trunnion.laws.converter import ConverterCurves

        ratios = tuple(one.speed_ratio for one in self.curves)
        return ConverterCurves(ratios, tuple(one.torque_ratio for one in self.curves), self.capacities)

    def at(self, speed_ratio: float, pump_speed: float) -> ConverterRun:
        """Torques of pump and turbine [N m], heat [W] and slopes at a speed ratio and a speed of the pump [rad/s].

        Raises
        ------
        InputError : a speed ratio beyond its points.
        """
        low, high = self.curves[0].speed_ratio, self.curves[-1].speed_ratio
        if not low <= speed_ratio <= high:
            raise InputError(
                f"lies beyond its points, {low:g} to {high:g}", element=self.name or self.kind, key="speed_ratio",
                value=speed_ratio, remedy="add points to curves",
            )  # fmt: skip
        return self.law.at(float(speed_ratio), float(pump_speed))

    @property
    def run(self) -> ConverterRun | None:
        """How it runs where equations have it; None of what is described."""
        return self._run

    @property
    def ratio(self) -> Fraction:
        """Mean speed of the turbine over the pump's as equations have it; 1 of what is described."""
        return Fraction(1) if self._run is None else Fraction(self._run.ratio).limit_denominator(FINEST)

    def running(self, run: ConverterRun) -> Self:
        """The same as it runs, its ratio of speeds one of two whole numbers."""
        made = type(self)(**self.stated)
        ratio = Fraction(run.ratio).limit_denominator(FINEST)
        made._run = self.law.at(float(ratio), run.pump_speed) if run.pump_speed else run
        return made

    def parts(self) -> tuple[Part, ...]:
        """Pump, a shaft as fast as the turbine on average, and behind it the turbine, which nothing holds; one shaft
        where it is locked."""
        pump = (Heavy(0, of="pump of"),) if self.inertia_in else ()
        between = (Geared(Fraction(1)),) if self.locked else (Geared(1 / self.ratio), Dragged(1, converts=True))
        turbine = (Heavy(len(between), of="turbine of"),) if self.inertia_out else ()
        return (*pump, *between, *turbine)

    def inertias(self, number: Numbers) -> tuple[Any, ...]:
        """Of pump and turbine, where stated."""
        return tuple(number(key) for key in ("inertia_in", "inertia_out") if getattr(self, key))

    def links(self, number: Numbers) -> tuple[tuple[Any, Any], ...]:
        """The part of its slopes that acts on both sides alike; none where it is locked."""
        return () if self.locked else ((0.0, 0.0 if self._run is None else self._run.link),)

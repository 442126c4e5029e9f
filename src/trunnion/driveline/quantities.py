"""Quantities: an SI number, or a string with a unit ("12 deg", "1500 rpm", "11.1 kN*m/rad").

The number is read by a strict pattern first, so that "1,5 mm" or "nan" never reaches the unit parser; the
unit is read by pint with the small table in ``units.txt``, in which the angle is a base dimension. pint takes longer
to load than most files to read: it is imported at the first unit that is not one of the ``USUAL``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from functools import cache, partial
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Generic, Optional, Self, TypeAlias, TypeVar, overload

from pydantic import Field
from pydantic_core import core_schema

from trunnion.errors import InputError, short

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Number = TypeVar("Number", float, "NDArray[np.float64]")

NUMBER_PATTERN = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_NUMBER = re.compile(NUMBER_PATTERN)
# Powers of one digit and no other numbers: pint would happily work out m^9^9^9^9.
# One letter at a step, and no possessive quantifiers: Python before 3.11.4 reads some of them wrongly.
_UNIT = re.compile(r"(?:1(?=\s*/)|[A-Za-zµμ]|(?<=[A-Za-zµμ])(?:\^|\*\*)[+-]?[0-9]|\*(?!\*)|[/()\s])+")
_SPELLINGS = {"·": "*", "⋅": "*", "×": "*", ".": "*", "²": "^2", "³": "^3", "°": "deg", "%": "percent"}


@dataclass(frozen=True)
class QuantityKind:
    """A physical kind of quantity.

    Attributes
    ----------
    name : what it is called in messages.
    unit : its SI unit, in which every number without unit is taken.
    example : a string a user could write.
    shown : units it is printed in, as (unit, its size in SI, smallest SI magnitude it suits), largest first.
    """

    name: str
    unit: str
    example: str
    shown: tuple[tuple[str, float, float], ...] = ()


LONGEST_TEXT = 200
"""Characters of a number with its unit."""
SMALLEST, LARGEST = 1e-30, 1e30
"""Magnitudes in SI between which a number can be meant; products of a few of them stay within floating point."""
DEGREE = math.pi / 180
RPM = 2 * math.pi / 60
HERTZ = 2 * math.pi

ANGLE = QuantityKind("angle", "rad", "12 deg", (("deg", DEGREE, 0.0),))
SPEED = QuantityKind("speed", "rad/s", "1500 rpm", (("rpm", RPM, 0.0),))
FREQUENCY = QuantityKind("frequency", "rad/s", "50 Hz", (("Hz", HERTZ, 0.0),))
STIFFNESS = QuantityKind(
    "stiffness",
    "N*m/rad",
    "12 kN*m/rad",
    (("MN*m/rad", 1e6, 1e6), ("kN*m/rad", 1e3, 1e3), ("N*m/rad", 1.0, 0.0)),
)
DAMPING = QuantityKind("damping", "N*m*s/rad", "3 N*m*s/rad")
QUADRATIC = QuantityKind("quadratic load", "N*m*s^2/rad^2", "0.02 N*m*s^2/rad^2")
MESH_STIFFNESS = QuantityKind("mesh stiffness", "N/m", "2e8 N/m", (("MN/m", 1e6, 1e6), ("N/m", 1.0, 0.0)))
MESH_DAMPING = QuantityKind("mesh damping", "N*s/m", "500 N*s/m")
IMPACT_DAMPING = QuantityKind("impact damping", "N*s/m^2", "2e7 N*s/m^2")
INERTIA = QuantityKind("inertia", "kg*m^2", "0.4 kg*m^2")
TORQUE = QuantityKind("torque", "N*m", "250 N*m", (("kN*m", 1e3, 1e4), ("N*m", 1.0, 0.0)))
LENGTH = QuantityKind("length", "m", "76 mm", (("m", 1.0, 1.0), ("mm", 1e-3, 0.0)))
PRESSURE = QuantityKind("pressure", "Pa", "79.3 GPa", (("GPa", 1e9, 1e9), ("MPa", 1e6, 0.0)))
DENSITY = QuantityKind("density", "kg/m^3", "7850 kg/m^3")
MASS = QuantityKind("mass", "kg", "1800 kg", (("t", 1e3, 1e4), ("kg", 1.0, 0.0)))
AREA = QuantityKind("area", "m^2", "0.65 m^2")
FORCE = QuantityKind("force", "N", "60 kN", (("kN", 1e3, 1e4), ("N", 1.0, 0.0)))
VELOCITY = QuantityKind("velocity", "m/s", "80 km/h", (("km/h", 1 / 3.6, 0.0),))
POWER = QuantityKind("power", "W", "300 W", (("kW", 1e3, 1e3), ("W", 1.0, 0.0)))
ACCELERATION = QuantityKind("angular acceleration", "rad/s^2", "300 rad/s^2")
TIME = QuantityKind("time", "s", "0.3 s", (("h", 3600.0, 3600.0), ("s", 1.0, 0.0)))
TEMPERATURE = QuantityKind("temperature", "K", "60 degC")
THERMAL_RESISTANCE = QuantityKind("thermal resistance", "K/W", "0.15 K/W")
RATIO = QuantityKind("ratio", "1", "0.02")
QUANTITY_KINDS = (
    *(ANGLE, SPEED, FREQUENCY, STIFFNESS, DAMPING, QUADRATIC, MESH_STIFFNESS, MESH_DAMPING, IMPACT_DAMPING),
    *(INERTIA, TORQUE, LENGTH, PRESSURE, DENSITY, MASS, AREA, FORCE),
    *(VELOCITY, POWER, ACCELERATION, TIME, TEMPERATURE, THERMAL_RESISTANCE, RATIO),
)
FREEZING = 273.15
"""0 °C in kelvin; the only unit whose zero is not that of the SI unit."""
CELSIUS = "degC"
KINDS = (
    ANGLE,
    SPEED,
    FREQUENCY,
    STIFFNESS,
    DAMPING,
    QUADRATIC,
    MESH_STIFFNESS,
    MESH_DAMPING,
    IMPACT_DAMPING,
    INERTIA,
    TORQUE,
    LENGTH,
    PRESSURE,
    DENSITY,
    MASS,
    AREA,
    FORCE,
    VELOCITY,
    POWER,
    ACCELERATION,
    TIME,
    TEMPERATURE,
    THERMAL_RESISTANCE,
    RATIO,
)


def kind_of(unit: str) -> QuantityKind | None:
    """The first of ``KINDS`` with this SI unit ("rad/s": a speed); None where there is none."""
    return next((kind for kind in KINDS if kind.unit == unit), None)


USUAL: dict[str, dict[str, float]] = {
    "rad": {"rad": 1.0, "deg": DEGREE},
    "rad/s": {"rad/s": 1.0, "rpm": RPM, "Hz": HERTZ},
    "rad/s^2": {"rad/s^2": 1.0},
    "N*m/rad": {"N*m/rad": 1.0, "kN*m/rad": 1e3, "MN*m/rad": 1e6, "N*m/deg": 1 / DEGREE},
    "N*m*s/rad": {"N*m*s/rad": 1.0, "kN*m*s/rad": 1e3},
    "N*m*s^2/rad^2": {"N*m*s^2/rad^2": 1.0},
    "N/m": {"N/m": 1.0},
    "N*s/m": {"N*s/m": 1.0},
    "N*s/m^2": {"N*s/m^2": 1.0},
    "kg*m^2": {"kg*m^2": 1.0, "t*m^2": 1e3},
    "N*m": {"N*m": 1.0, "kN*m": 1e3, "MN*m": 1e6},
    "m": {"m": 1.0, "mm": 1e-3},
    "Pa": {"Pa": 1.0, "bar": 1e5, "MPa": 1e6, "GPa": 1e9},
    "kg/m^3": {"kg/m^3": 1.0},
    "kg": {"kg": 1.0, "t": 1e3},
    "m^2": {"m^2": 1.0},
    "N": {"N": 1.0, "kN": 1e3},
    "m/s": {"m/s": 1.0, "km/h": 1000 / 3600},
    "W": {"W": 1.0, "kW": 1e3},
    "s": {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "1": {"percent": 0.01},
    "K": {"K": 1.0},
    "K/W": {"K/W": 1.0},
}
"""Units that most files are written in: by SI unit of their kind, their size in it, as pint gives it."""

OFTEN_NOTHING = (ANGLE, DAMPING, QUADRATIC, MESH_DAMPING, IMPACT_DAMPING, TORQUE)
"""Kinds that computations leave as good as zero, and that nothing is divided by."""


_NAMED_TYPES = {type(None): "nothing (None)", bool: "true or false"}


def parse(value: object, kind: QuantityKind) -> float:
    """Return `value` as a finite float in the SI unit of `kind`.

    Parameters
    ----------
    value : a number in SI units, or a string "number unit". Decimal shifts are exact: "76 mm" is 0.076.
    kind : what it must be, for example ``ANGLE``.

    Raises
    ------
    InputError : not a number, not finite, unknown unit, or another dimension than asked for.
    """
    if isinstance(value, str):
        return _finite(_parse_text(value, kind), value, kind)
    # bool is an int in Python, and numpy's numbers are Reals without being floats
    if isinstance(value, bool) or not isinstance(value, Real):
        given = _NAMED_TYPES.get(type(value), f"a {type(value).__name__}")
        problem = f"must be a number or a string with a unit, not {given}"
        raise InputError(problem, value=value, remedy=_advice(kind))
    try:
        number = float(value)
    except OverflowError:  # an integer of more than 308 digits
        number = math.inf
    return _finite(number, value, kind)


def _parse_text(text: str, kind: QuantityKind) -> float:
    if len(text) > LONGEST_TEXT:
        raise InputError(f"has {len(text)} characters", value=text, remedy=_advice(kind))
    written = text.strip()
    match = _NUMBER.match(written)
    if match is None:
        if re.match(r"[+-]?(nan|inf)", written, re.IGNORECASE):
            raise InputError("must be finite", value=text, remedy=_advice(kind))
        raise InputError("does not start with a number", value=text, remedy=_advice(kind))
    number, unit = match.group(), written[match.end() :].strip()
    if re.match(r",[0-9]", unit):
        raise InputError("has a decimal comma", value=text, remedy="write a decimal point")
    if not unit:
        if kind is RATIO:
            return float(number)
        raise InputError("has no unit", value=text, remedy=f"{_advice(kind)}, or {short(number)} without quotes for SI")
    for spelling, plain in _SPELLINGS.items():
        unit = unit.replace(spelling, plain)
    unit = re.sub(r"(?<=[a-z])(?=-?[0-9])", "^", unit)  # kg m2, min-1
    if kind is TEMPERATURE and unit == CELSIUS:
        return float(Decimal(number) + Decimal(str(FREEZING)))
    try:
        return _scaled(number, _factor(unit, kind))
    except InputError as error:
        raise error.but(value=text) from None


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(str(Path(__file__).with_name("units.txt")))


@cache
def _factor(unit: str, kind: QuantityKind) -> float:
    """Size of `unit` in the SI unit of `kind`; raises InputError (uncached) when there is none."""
    usual = USUAL.get(kind.unit, {}).get(unit)
    return size_by_pint(unit, kind) if usual is None else usual


def size_by_pint(unit: str, kind: QuantityKind) -> float:
    """The same for any unit that ``units.txt`` defines."""
    registry = _registry()
    needed = registry.parse_units("" if kind is RATIO else kind.unit)
    try:
        if len(unit) > 60 or not _UNIT.fullmatch(unit):
            raise ValueError(unit)
        given = registry.parse_units(unit)
        dimensions = dict(given.dimensionality)
    except Exception as error:  # pint raises many classes, some of them not its own
        known = "known are rad deg rev rpm Hz N Nm Pa bar g kg t m in ft lb lbf psi s min h, with prefixes"
        raise InputError(f"unknown unit {short(unit)!r}", remedy=f"{_advice(kind)}; {known}") from error
    wanted = dict(needed.dimensionality)
    if dimensions == wanted:
        return float(registry.convert(1.0, given, needed))
    if kind is RATIO:
        raise InputError("must have no unit", remedy=_advice(kind))
    problem = f"{unit} is not the unit of {with_article(kind.name)} ({kind.unit})"
    remedy = _advice(kind)
    # torque for stiffness, 1/s for a speed: the commonest slip, and only the angle tells
    if dimensions.pop("[angle]", 0) != wanted.pop("[angle]", 0) and dimensions == wanted:
        remedy = f'the angle makes the difference: write {kind.unit}, for example "{kind.example}"'
    raise InputError(problem, remedy=remedy)


def _scaled(number: str, factor: float) -> float:
    """`number` times `factor`, in decimal arithmetic where the factor is a short decimal (mm, kN, inch).

    4.35 * 100 is 434.99999999999994 in binary arithmetic; "4.35" times "100" is 435. Factors with π are long.
    """
    decimal = Decimal(f"{factor:.15g}").normalize()
    if len(decimal.as_tuple().digits) <= 12:
        with suppress(ArithmeticError):  # exponents past a decimal's range: as the float, 0 or infinite
            return float(Decimal(number) * decimal)
    return float(number) * factor


def _finite(number: float, value: object, kind: QuantityKind) -> float:
    if not math.isfinite(number):
        raise InputError("must be finite", value=value, remedy=_advice(kind))
    tiny = 0 < abs(number) < SMALLEST and kind not in OFTEN_NOTHING
    if tiny or abs(number) > LARGEST:
        size = f"smaller than {SMALLEST:g}" if tiny else f"larger than {LARGEST:g}"
        problem = f"is {size} {'' if kind is RATIO else signs(kind.unit)}".rstrip()
        raise InputError(problem, value=value, remedy=f"check the exponent, {_advice(kind)}")
    return number


def _advice(kind: QuantityKind) -> str:
    if kind is RATIO:
        return f"write a plain number such as {kind.example}"
    return f'write {with_article(kind.name)} such as "{kind.example}"'


def with_article(noun: str) -> str:
    """ "a torque", "an angle"."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


def written(value: float, kind: QuantityKind, unit: str | None = None) -> float | str:
    """How a file states `value`: with an engineering unit where that reads back exactly, else the SI number.

    `unit` prefers one of the units of `kind` over the usual choice.
    """
    if kind is TEMPERATURE:
        text = f"{value - FREEZING:.10g} {CELSIUS}"
        return text if _is_number(text) and parse(text, kind) == value else value
    symbol, size = eye_unit(value, kind, unit)
    if size != 1.0:
        for digits in (12, 15):
            text = f"{value / size:.{digits}g}"
            if _NUMBER.fullmatch(text) and _scaled(text, size) == value:
                return f"{text} {symbol}"
    return value


def _is_number(text: str) -> bool:
    """Whether a text begins with a number as files write them."""
    return _NUMBER.fullmatch(text.partition(" ")[0]) is not None


def shown(value: float, kind: QuantityKind, unit: str | None = None, digits: int = 6) -> str:
    """`value` for the eye, in an engineering unit: "12 deg", "11.1 kN m/rad"; it reads back as in a file."""
    if kind is TEMPERATURE:
        return f"{_plain(value - FREEZING, digits)} °C"
    symbol, size = eye_unit(value, kind, unit)
    return _plain(value / size, digits) + ("" if kind is RATIO else f" {signs(symbol)}")


def signs(unit: str) -> str:
    """A unit, or a number with its unit, as text prints it: "N m", "kg m²"; files write "N*m" and "kg*m^2"."""
    return unit.replace("*", " ").replace("^2", "²").replace("^3", "³")


def against(value: float, limit: float, kind: QuantityKind, digits: int = 4) -> str:
    """``value`` beside its limit in one unit: "8.12 kN m against 12 kN m"."""
    return " against ".join(in_one_unit(value, limit, kind, digits))


def in_one_unit(value: float, limit: float, kind: QuantityKind, digits: int = 4) -> tuple[str, str]:
    """``value`` and its limit, each with the unit of the smaller."""
    if kind is TEMPERATURE:
        return shown(value, kind, digits=digits), shown(limit, kind, digits=digits)
    small = min(abs(value), abs(limit))
    symbol, size = eye_unit(small if small > SAME_UNIT * abs(limit) else limit, kind)
    left, right = (_plain(x / size, digits) + ("" if kind is RATIO else f" {signs(symbol)}") for x in (value, limit))
    return left, right


def _plain(value: float, digits: int) -> str:
    """``value`` to so many figures, 10000 and not 1e+04."""
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:.10g}" if 1 <= abs(rounded) < 1e7 else f"{rounded:.{digits}g}"


SAME_UNIT = 1e-3
"""Share of a limit from which a value is shown in the unit that suits it, and the limit with it."""


def eye_unit(value: float, kind: QuantityKind, unit: str | None = None) -> tuple[str, float]:
    """The unit that suits ``value``, or ``unit``, and its size in SI."""
    for symbol, size, smallest in (*kind.shown, *(SPEED.shown + FREQUENCY.shown if unit else ())):
        if symbol == unit or (unit is None and abs(value) >= smallest):
            return symbol, size
    return kind.unit, 1.0


@dataclass(frozen=True)
class Quantity:
    """Marks a pydantic field as a quantity: validated by :func:`parse`, with its unit in the JSON Schema."""

    kind: QuantityKind

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(partial(parse, kind=self.kind))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return json_schema_of(self.kind)


def json_schema_of(kind: QuantityKind) -> dict[str, Any]:
    """A number in SI units or a string with a unit, as a JSON Schema that carries the SI unit."""
    text = {"type": "string", "pattern": rf"^\s*{NUMBER_PATTERN}\s*\S", "examples": [kind.example]}
    if kind is RATIO:
        text = {"type": "string", "pattern": rf"^\s*{NUMBER_PATTERN}\s*%?\s*$", "examples": ["2 %"]}
    return {"anyOf": [{"type": "number"}, text], "unit": kind.unit}


def optional(*, default: object, **about: Any) -> Any:
    """A pydantic field with a default, for what reads as another type than it is written in (``Stated``)."""
    return Field(default=default, **about)


if TYPE_CHECKING:
    Read = TypeVar("Read")
    Written = TypeVar("Written")

    class Stated(Generic[Read, Written]):
        """A field to a type checker: what it gives when it is read, and all that may be written."""

        @overload
        def __get__(self, owner: None, kind: object) -> Self: ...
        @overload
        def __get__(self, owner: object, kind: object) -> Read: ...
        def __get__(self, owner: object | None, kind: object) -> Self | Read: ...
        def __set__(self, owner: object, value: Written) -> None: ...

    Angle: TypeAlias = Stated[float, float | str]
    Speed: TypeAlias = Stated[float, float | str]
    Frequency: TypeAlias = Stated[float, float | str]
    Stiffness: TypeAlias = Stated[float, float | str]
    Damping: TypeAlias = Stated[float, float | str]
    QuadraticLoad: TypeAlias = Stated[float, float | str]
    MeshStiffness: TypeAlias = Stated[float, float | str]
    MeshDamping: TypeAlias = Stated[float, float | str]
    ImpactDamping: TypeAlias = Stated[float, float | str]
    Inertia: TypeAlias = Stated[float, float | str]
    Torque: TypeAlias = Stated[float, float | str]
    Length: TypeAlias = Stated[float, float | str]
    Pressure: TypeAlias = Stated[float, float | str]
    Density: TypeAlias = Stated[float, float | str]
    Mass: TypeAlias = Stated[float, float | str]
    Area: TypeAlias = Stated[float, float | str]
    Force: TypeAlias = Stated[float, float | str]
    Velocity: TypeAlias = Stated[float, float | str]
    Power: TypeAlias = Stated[float, float | str]
    Acceleration: TypeAlias = Stated[float, float | str]
    Time: TypeAlias = Stated[float, float | str]
    Temperature: TypeAlias = Stated[float, float | str]
    ThermalResistance: TypeAlias = Stated[float, float | str]
    Dimensionless: TypeAlias = Stated[float, float | str]

    Of = TypeVar("Of")

    class Maybe(Stated[float | None, float | str | None], Generic[Of]):
        """A quantity or None."""

    class Several(Stated[tuple[float, ...], Iterable[float | str]], Generic[Of]):
        """Quantities in a row."""

    class OneOrSeveral(Stated[tuple[float, ...], float | str | Iterable[float | str]], Generic[Of]):
        """Quantities in a row, or one for all."""

    class MaybeRange(Stated[tuple[float, float] | None, Sequence[float | str] | None], Generic[Of]):
        """The lower and the upper end, or None."""

    class TableList(Stated[tuple[Of, ...], Iterable[Of | Mapping[str, Any]]], Generic[Of]):
        """What is stated in a list of tables, each made or as in a file."""

else:
    Angle = Annotated[float, Quantity(ANGLE)]
    Speed = Annotated[float, Quantity(SPEED)]
    Frequency = Annotated[float, Quantity(FREQUENCY)]
    Stiffness = Annotated[float, Quantity(STIFFNESS)]
    Damping = Annotated[float, Quantity(DAMPING)]
    QuadraticLoad = Annotated[float, Quantity(QUADRATIC)]
    MeshStiffness = Annotated[float, Quantity(MESH_STIFFNESS)]
    MeshDamping = Annotated[float, Quantity(MESH_DAMPING)]
    ImpactDamping = Annotated[float, Quantity(IMPACT_DAMPING)]
    Inertia = Annotated[float, Quantity(INERTIA)]
    Torque = Annotated[float, Quantity(TORQUE)]
    Length = Annotated[float, Quantity(LENGTH)]
    Pressure = Annotated[float, Quantity(PRESSURE)]
    Density = Annotated[float, Quantity(DENSITY)]
    Mass = Annotated[float, Quantity(MASS)]
    Area = Annotated[float, Quantity(AREA)]
    Force = Annotated[float, Quantity(FORCE)]
    Velocity = Annotated[float, Quantity(VELOCITY)]
    Power = Annotated[float, Quantity(POWER)]
    Acceleration = Annotated[float, Quantity(ACCELERATION)]
    Time = Annotated[float, Quantity(TIME)]
    Temperature = Annotated[float, Quantity(TEMPERATURE)]
    ThermalResistance = Annotated[float, Quantity(THERMAL_RESISTANCE)]
    Dimensionless = Annotated[float, Quantity(RATIO)]

    class _Row:
        """Written as the class that type checkers see in its place; to pydantic a tuple."""

        def __class_getitem__(cls, member: Any) -> Any:
            return tuple[member, ...]

    Maybe = MaybeRange = Optional
    Several = OneOrSeveral = TableList = _Row


def deg(angle: Number) -> Number:
    """Degrees to radians; numbers or arrays.

    Parameters
    ----------
    angle : [°], a number or an array.

    Examples
    --------
    >>> import trunnion as tn
    >>> round(tn.deg(180.0), 5)
    3.14159
    """
    return angle * DEGREE


def rpm(speed: Number) -> Number:
    """Revolutions per minute to rad/s; numbers or arrays.

    Parameters
    ----------
    speed : [1/min], a number or an array.

    Examples
    --------
    >>> import trunnion as tn
    >>> round(tn.rpm(1500.0), 3)
    157.08
    """
    return speed * RPM


def hz(frequency: Number) -> Number:
    """Revolutions or cycles per second to rad/s; numbers or arrays.

    Parameters
    ----------
    frequency : [Hz], a number or an array.

    Examples
    --------
    >>> import trunnion as tn
    >>> round(tn.hz(50.0), 3)
    314.159
    """
    return frequency * HERTZ

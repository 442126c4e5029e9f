"""A driveline as one array of numbers, and parameters as places in it.

``pack(line)`` lists every number of the description as a column ("Shaft 1.stiffness", "HookeJoint 1.angle",
…; column 0 is the input speed). A *parameter* is a label, a unit and an affine map from one value into
those columns, so charts, limits and sensitivities vary an array and nothing is validated again per point.

Paths
    "speed"                       the input speed [rad/s]
    "HookeJoint 1.angle"          one number of one element, by its name or its default name
    "Disk 1.excitation 2 amplitude"   of its second harmonic torque (also frequency, phase)
    "GearPair 1.transmission_error 1 amplitude", "PiecewiseShaft 1.stiffness 2"   likewise
    "HookeJoint *.angle"          the same number of every element of a kind
    "half shaft *.stiffness"      of every element whose name fits
    "factor of Shaft *.damping"   multiplies what each of them has (1 leaves it as it is)

Tolerances, designs and derivatives take each number of a pattern by itself (``each``). Along an axis one value goes
into all of them. Joints are then all bent by one angle; other numbers must be alike, or be scaled by a factor:
``resolve_axis`` refuses what would make unlike ones alike.
"""

from __future__ import annotations

import difflib
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Places
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import Element
from trunnion.driveline.packed_numbers import SPEED as SPEED
from trunnion.driveline.packed_numbers import UNITS as UNITS
from trunnion.driveline.patterns import names
from trunnion.driveline.quantities import signs
from trunnion.errors import InputError, InputRemark

RATIOS = ("ratio", "teeth_in", "teeth_out", "teeth_sun", "teeth_ring", "radius_in", "radius_out")
"""Numbers of gears that say by how much shafts differ in speed."""


@dataclass(frozen=True)
class Term:
    """``column(path) = offset + slope × value``.

    Parameters
    ----------
    path : of the number (see the module's grammar).
    slope : units of the number for one of the value.
    offset : of the number, in its SI unit, at value 0.

    >>> Term("Shaft 2.stiffness", slope=2.0)
    Term(path='Shaft 2.stiffness', slope=2.0, offset=0.0)
    """

    path: str
    slope: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Parameter:
    """A quantity to vary: its label and unit, and what a value of it puts into a packed line.

    Either ``path`` (see the module's grammar) or ``terms`` for a group that moves several numbers at once,
    e.g. a paper's nondimensional ratio.

    Parameters
    ----------
    label : what results and axes call it.
    unit : of a value of it.
    terms : the numbers that it moves, one ``Term`` each.

    >>> joints = (Term("HookeJoint 1.angle"), Term("HookeJoint 2.angle", offset=0.1))
    >>> Parameter("bend angle", "rad", joints).label
    'bend angle'
    """

    label: str
    unit: str
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Columns:
    """A parameter resolved against one packed line: ``values[:, index] = offset + slope × value``."""

    label: str
    unit: str
    index: Places
    slope: Array
    offset: Array

    def put(self, table: Array, value: ArrayLike) -> None:
        """Write ``value`` (one per row of ``table``, or a scalar) into the columns of this parameter."""
        spread = np.asarray(value, dtype=float)[..., None]
        table[..., self.index] = self.offset + self.slope * spread


@dataclass(frozen=True)
class PackedLine:
    """The numbers of a line: ``values[column]`` in SI, with ``labels`` and ``units`` by column."""

    line: Driveline
    values: Array
    place: dict[tuple[int, str], int] = field(repr=False)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Path of every column."""
        names = self.line.names
        return tuple(f"{names[i]}.{key}" if i >= 0 else key for i, key in self.place)

    @cached_property
    def units(self) -> tuple[str, ...]:
        """Unit of every column."""
        return tuple(_unit(key) for _, key in self.place)

    def column(self, element: int, key: str) -> int:
        """Column of an element's number; −1 where the description does not give it."""
        return self.place.get((element, key), -1)

    def table(self, rows: int) -> Array:
        """``rows`` copies of the line's numbers, to be varied; shape (rows, columns)."""
        return np.tile(self.values, (rows, 1))

    def resolve(self, parameter: str | Parameter) -> Columns:
        """Find the columns a path or a ``Parameter`` moves.

        Raises
        ------
        InputError : no such element or key (the nearest is suggested), or a number the line does not give.
        """
        if isinstance(parameter, str):
            return self._resolve_path(parameter)
        index, slope, offset = [], [], []
        for term in parameter.terms:
            for column in self._find(term.path):
                index.append(column)
                slope.append(term.slope)
                offset.append(term.offset)
        return Columns(
            parameter.label, parameter.unit, np.array(index, dtype=np.intp), np.array(slope), np.array(offset)
        )

    def resolve_axis(self, parameter: str | Parameter) -> Columns:
        """The same of a parameter whose one value is to go into all of its columns.

        Raises
        ------
        InputError : as ``resolve``; a pattern over numbers that differ, joint angles aside.
        """
        columns = self.resolve(parameter)
        numbers = self.values[columns.index]
        path = parameter if isinstance(parameter, str) else ""
        if "*" not in path or path.startswith("factor of ") or path.endswith(".angle") or np.ptp(numbers) == 0:
            return columns
        first, last = columns.index[numbers.argmin()], columns.index[numbers.argmax()]
        differ = " and ".join(f"{self.labels[c]} {self.values[c]:.6g}" for c in (first, last))
        remedy = f'vary the "factor of {path}", from 0.5 to 2, say, or one of them'
        raise InputError(f"would make unlike numbers one ({differ} {signs(columns.unit)})", key=path, remedy=remedy)

    def each(self, path: str) -> tuple[str, ...]:
        """The numbers of a path one by one; a path that has no pattern, or is a factor, as it is."""
        if "*" not in path or path.startswith("factor of "):
            return (path,)
        return tuple(self.labels[c] for c in self._find(path))

    def value(self, parameter: str | Parameter) -> float:
        """The value the line has now (NaN for a speed that was not given)."""
        columns = self.resolve(parameter)
        first = columns.index[0]
        return float((self.values[first] - columns.offset[0]) / columns.slope[0])

    def line_at(self, values: Array) -> Driveline:
        """The line with the numbers of ``values`` (columns,), checked as one written by hand; the speed is left out.

        Raises
        ------
        InputError : a number that its element or the line refuses.
        """
        changed: dict[int, dict[str, float]] = {}
        for (element, key), column in self.place.items():
            if key != SPEED and values[column] != self.values[column]:
                changed.setdefault(element, {})[key] = float(values[column])
        own, line = changed.pop(-1, {}), self.line
        fields = {line.names[i]: _fields(line.elements[i], numbers) for i, numbers in changed.items()}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InputRemark)  # odd values are allowed along an axis
            try:
                return line.replace_all(fields, **own)
            except InputError:
                # Tolerances about other numbers may reach where no line can be; the numbers themselves speak again.
                return line.replace_all(fields, tolerances=(), **own)

    def line_if_possible(self, values: Array) -> Driveline | None:
        """The same; None where its element or the line refuses a number."""
        try:
            return self.line_at(values)
        except InputError:
            return None

    def _resolve_path(self, path: str) -> Columns:
        factor = path.startswith("factor of ")
        found = np.array(self._find(path.removeprefix("factor of ")), dtype=np.intp)
        if factor and 0 in found:
            raise InputError(
                "belongs to the analysis, so a line has no speed to multiply", key=path, remedy=f'vary "{SPEED}" itself'
            )
        if not factor:
            return Columns(path, self.units[found[0]], found, np.ones(len(found)), np.zeros(len(found)))
        slope = self.values[found]
        if not np.any(slope):
            raise InputError(
                "multiplies numbers that are all zero, so it changes nothing",
                key=path,
                remedy="give them a value, or vary them directly",
            )
        return Columns(path, "1", found, slope, np.zeros(len(found)))

    def _find(self, path: str) -> list[int]:
        if path == SPEED:
            return [0]
        owner, dot, key = path.rpartition(".")
        if not dot:
            if path in ("damping_ratio", "damping_ratio_frequency"):
                owner, key = "driveline", path
            else:
                raise self._unknown(path)
        line = self.line
        if owner == "driveline":
            members = [-1]
        else:
            members = [i for i, n in enumerate(line.names) if n == owner]
            members = members or [i for i, n in enumerate(line.default_names) if n == owner]
            parts = enumerate(zip(line.names, line.elements, strict=True))
            members = members or [i for i, (name, e) in parts if names(owner, name, e.kind)]
        columns = [c for i in members if (c := self.column(i, key)) >= 0]
        if not columns:
            raise self._unknown(path)
        return columns

    def _unknown(self, path: str) -> InputError:
        schedules = self.line.operation.schedules if self.line.operation else ()
        if path.removeprefix("schedule ") in [one.name for one in schedules]:
            name = path.removeprefix("schedule ")
            return InputError(
                "is a schedule, which moves several numbers along straight pieces, not a parameter", key=path,
                remedy=f'ask line.at_schedule("{name}", value) at each of its points, or envelope(line) for all',
            )  # fmt: skip
        owner, _, key = path.rpartition(".")
        if key in RATIOS and any(owner == name and hasattr(one, key) for name, one in self.line.parts):
            return InputError(
                "sets the period of the line's equations and does not vary within one study", key=path,
                remedy=f'line.replace("{owner}", {key}=...) makes a line of each of its values',
            )  # fmt: skip
        known = list(self.labels)
        kinds = [element.kind for element in self.line.elements]
        known += dict.fromkeys(f"{kinds[i]} *.{key}" for i, key in self.place if i >= 0)
        near = difflib.get_close_matches(path, known, n=1, cutoff=0.4)
        what = f'did you mean "{near[0]}"?' if near else f"parameters are: {', '.join(self.labels)}"
        return InputError("is not a parameter of this driveline", key=path, remedy=what)


def pack(line: Driveline, speed: float = float("nan")) -> PackedLine:
    """List every number of ``line`` as a column; column 0 is ``speed`` [rad/s].

    Parameters
    ----------
    line : whose numbers are listed.
    speed : input speed [rad/s]; NaN, none, by default.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=2.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> packed = tn.pack(line, 30.0)
    >>> packed.labels[:3], packed.values[:3], packed.value("Disk 1.inertia")
    (('speed', 'HookeJoint 1.angle', 'HookeJoint 1.plane'), array([30. ,  0.1,  0. ]), 0.8)
    """
    values, places = [speed], [(-1, SPEED)]
    for i, element in enumerate(line.elements):
        numbers = _numbers(element)
        places += [(i, key) for key, _ in numbers]
        values += [number for _, number in numbers]
    for key in ("damping_ratio", "damping_ratio_frequency"):
        number = getattr(line, key)
        if number is not None:
            places.append((-1, key))
            values.append(float(number))
    return PackedLine(line, np.array(values), {place: column for column, place in enumerate(places)})


_HARMONICS = {
    "excitation": {
        "amplitude": "N*m",
        "frequency": "rad/s",
        "phase": "rad",
        "quadratic_amplitude": "N*m*s^2/rad^2",
        "share": "1",
    },
    "transmission_error": {"amplitude": "m", "phase": "rad"},
    "stiffness_variation": {"share": "1", "phase": "rad"},
    "ripple": {"amplitude": "rad", "phase": "rad"},
    "friction": {"torque": "N*m", "stiffness": "N*m/rad"},
}
"""Numbers of each harmonic of a list, and their units."""
_LISTS = {"breakpoints": ("breakpoint", "rad"), "stiffnesses": ("stiffness", "N*m/rad")}
"""Lists of numbers: what one of them is called, and its unit."""


_NUMBERS = (float, int)


def unit_of(path: str) -> str:
    """SI unit of the number that a path names; "1" of a factor."""
    return "1" if path.startswith("factor of ") else _unit(path.rpartition(".")[2])


def _unit(key: str) -> str:
    """Unit of "stiffness", "excitation 2 amplitude", "breakpoint 1"."""
    if key in UNITS:
        return UNITS[key]
    owner, _, rest = key.partition(" ")
    if owner in _HARMONICS:
        return _HARMONICS[owner][rest.partition(" ")[2]]
    return next(unit for name, unit in _LISTS.values() if name == owner)


def _numbers(element: Element) -> list[tuple[str, float]]:
    """Every number of an element by its key."""
    (plain, harmonics, lists), read = _reading(type(element))
    idle = element.idle
    found = [
        (key, float(number))
        for key, number in zip(plain, read(element), strict=False)
        if number is not None and key not in idle and isinstance(number, _NUMBERS) and not isinstance(number, bool)
    ]
    for name in harmonics:
        for i, harmonic in enumerate(getattr(element, name), start=1):
            for key in _HARMONICS[name]:
                if (number := _number(harmonic, key)) is not None:
                    found.append((f"{name} {i} {key}", float(number)))
    for name in lists:
        found += [(f"{_LISTS[name][0]} {i}", float(n)) for i, n in enumerate(getattr(element, name), start=1)]
    return found


@cache
def _reading(kind: type[Element]) -> tuple[tuple[tuple[str, ...], ...], Callable[[Element], tuple[Any, ...]]]:
    """Of single numbers, lists of harmonics and lists of numbers, those that a kind of element has; what reads all
    single ones in one call (pydantic is slow to miss an attribute)."""

    def has(key: str) -> bool:
        return key in kind.model_fields or hasattr(kind, key)

    keys = tuple(tuple(filter(has, every)) for every in (UNITS, _HARMONICS, _LISTS))
    # And the kind twice, so that it is a tuple where there is one number or none.
    return keys, attrgetter(*keys[0], "kind", "kind")


def _number(harmonic: Any, key: str) -> float | None:
    """One number of a harmonic; the amplitude of a table is its largest."""
    table = key == "amplitude" and getattr(harmonic, "amplitudes", None)
    number: float | None = harmonic.largest if table else getattr(harmonic, key)
    return number


def _fields(element: Element, numbers: dict[str, float]) -> dict[str, Any]:
    """The fields of an element that hold ``numbers`` by their keys, those in lists in their places."""
    fields: dict[str, Any] = {}
    for key, number in numbers.items():
        owner, _, rest = key.partition(" ")
        if not rest:
            fields[key] = number
            continue
        place, _, part = rest.partition(" ")
        name = owner if owner in _HARMONICS else next(n for n, (single, _) in _LISTS.items() if single == owner)
        every = fields.setdefault(name, list(getattr(element, name)))
        old = every[int(place) - 1]
        every[int(place) - 1] = _with(old, part, number) if part else number
    return fields


def _with(harmonic: Any, part: str, number: float) -> dict[str, Any]:
    """What a harmonic states with one number changed; a table keeps its shape."""
    stated = dict(harmonic) if isinstance(harmonic, dict) else harmonic.stated
    amplitudes = stated.get("amplitudes", ())
    if part != "amplitude" or not amplitudes:
        return {**stated, part: number}
    largest = max(abs(a) for a in amplitudes)
    return {**stated, "amplitudes": tuple(a * number / largest for a in amplitudes)}

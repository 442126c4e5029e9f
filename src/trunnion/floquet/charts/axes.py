"""Axes of a chart: a parameter, its range and its points, checked against the line before anything runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.parameters import Columns, Parameter
from trunnion.driveline.quantities import kind_of, parse, signs
from trunnion.equations.aligned import aligned_matrices, frequencies
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.systems.family import PeriodicLinearFamily

AxisRequest = Sequence[object]

MOST_CYCLES = 500
"""Cycles of the highest mode per turn of the input beyond which a speed counts as zero."""
STEEPEST_ANGLE = np.deg2rad(89.0)


@dataclass(frozen=True)
class ChartAxis:
    """``values`` (points,) of a parameter with its label, unit and place among the packed columns."""

    values: Array
    columns: Columns
    scale: str
    parameter: str | Parameter
    is_joint_angle: bool = False

    @property
    def is_speed(self) -> bool:
        """Whether this axis is the input speed, by whatever name."""
        return bool(np.any(self.columns.index == 0))

    @property
    def one_sided(self) -> bool:
        """Whether no two values differ in sign."""
        return bool(self.values[0] >= 0 or self.values[-1] <= 0)

    @property
    def label(self) -> str:
        """Path or label of the parameter."""
        return self.columns.label

    @property
    def unit(self) -> str:
        """Unit of the values."""
        return self.columns.unit


def axis(assembly: Assembly, request: AxisRequest, key: str) -> tuple[ChartAxis, str | None]:
    """Turn ``(parameter, low, high, points[, "log"])`` into an Axis; also what was clipped, as a sentence.

    Raises
    ------
    InputError : unknown parameter, reversed or empty range, too few points, values no line can have.
    """
    parameter = _parameter(request, key)
    columns = assembly.packed.resolve_axis(parameter)
    low, high, points, scale = _range(request, columns.label, columns.unit)
    low, high, said = _clip(assembly, columns, low, high)
    values = _points(columns.label, low, high, points, scale)
    _check_columns(assembly, columns, values)
    return ChartAxis(values, columns, scale, parameter, _is_joint_angle(assembly, columns)), said


def _is_joint_angle(assembly: Assembly, columns: Columns) -> bool:
    """Whether the values are themselves the bend angles of one or more joints."""
    topo, names = assembly.topology, assembly.line.names
    joints = {f"{names[topo.stations[j].element]}.angle" for j in topo.joints}
    plain = bool(np.all(columns.slope == 1) and np.all(columns.offset == 0))
    return plain and all(assembly.packed.labels[c] in joints for c in columns.index)


def user_axis(family: PeriodicLinearFamily, request: AxisRequest, key: str) -> ChartAxis:
    """The same for a parameter of a family of one's own."""
    name = _parameter(request, key)
    if name not in family.parameters:
        known = ", ".join(family.parameters)
        raise InputError("is not a parameter of this family", key=str(name), remedy=f"parameters are: {known}")
    unit = family.units.get(str(name), "1")
    low, high, points, scale = _range(request, str(name), unit)
    none = np.zeros(0)
    columns = Columns(str(name), unit, np.zeros(0, dtype=np.intp), none, none)
    return ChartAxis(_points(str(name), low, high, points, scale), columns, scale, name)


SHARES = np.mod(np.sqrt(5) / 2 * np.arange(7), 1.0)
"""Places along an axis that share no period: equal steps would miss what repeats, as fork angles do."""


def moves_nothing(
    stability: Callable[[Array, Array], Array],
    x: ChartAxis,
    y: ChartAxis,
    of_x: bool,
    differ: Callable[[Array, Array], bool] = lambda x, y: False,
) -> bool:
    """Whether an axis does not change the stability at all, compared at several places and values of the other.

    stability : (x, y) → quantities (points, …) that decide it, known to some 1e-12.
    differ : (x, y) of two points → whether a cheap look already tells them apart.
    """
    own, other = (x.values, y.values) if of_x else (y.values, x.values)
    if len(own) == 1:
        return False
    ends, middle = own[[0, -1]], np.full(2, other.min() + 0.41 * np.ptp(other))
    if differ(ends, middle) if of_x else differ(middle, ends):
        return False
    samples = own.min() + SHARES * np.ptp(own)
    for share in (0.41, 0.13, 0.87):
        fixed = np.full(len(SHARES), other.min() + share * np.ptp(other))
        found = stability(samples, fixed) if of_x else stability(fixed, samples)
        if not np.all(np.abs(found - found[0]) <= 1e-10 * np.maximum(1, np.abs(found[0]))):
            return False
    return True


def _parameter(request: AxisRequest, key: str) -> str | Parameter:
    example = 'write x=("speed", 10, 200, 400)'
    if isinstance(request, str) or not isinstance(request, Sequence) or len(request) not in (4, 5):
        raise InputError("must be (parameter, low, high, points)", key=key, value=request, remedy=example)
    if not isinstance(request[0], str | Parameter):
        raise InputError("must name a parameter", key=key, value=request[0], remedy=example)
    return request[0]


def _range(request: AxisRequest, label: str, unit: str) -> tuple[float, float, int, str]:
    low, high = _number(request[1], label, unit, "low"), _number(request[2], label, unit, "high")
    points, scale = request[3], request[4] if len(request) == 5 else "linear"
    if isinstance(points, bool) or not isinstance(points, int | np.integer) or points < 1:
        raise InputError("must be a whole number of points, 1 or more", element=label, key="points", value=points)
    if (points > 1 and not low < high) or low > high:
        raise InputError(f"runs from {low:g} to {high:g}", element=label, key="range", remedy="give low < high")
    if scale not in ("linear", "log"):
        raise InputError("is not a scale", element=label, key="scale", value=scale, remedy='"linear" or "log"')
    return low, high, int(points), str(scale)


def _points(label: str, low: float, high: float, points: int, scale: str) -> Array:
    if scale == "linear":
        return np.linspace(low, high, points)
    if low <= 0:
        raise InputError("cannot start at or below zero", element=label, key="log axis", value=low)
    return np.geomspace(low, high, points)


def _number(value: object, label: str, unit: str, key: str) -> float:
    """A number in SI units, from a text with its unit too where the unit is that of a quantity."""
    kind = kind_of(unit)
    if isinstance(value, str) and kind is not None:
        try:
            return parse(value, kind)
        except InputError as error:
            raise error.but(element=label, key=key) from None
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not np.isfinite(value):
        raise InputError(
            "must be a finite number in SI units",
            element=label,
            key=key,
            value=value,
            remedy="tn.rpm(300), tn.deg(5)",
        )
    return float(value)


def lowest_speed(assembly: Assembly) -> float:
    """Speed [rad/s] below which a turn spans more than ``MOST_CYCLES`` cycles of the highest mode."""
    topo = assembly.topology
    matrices = aligned_matrices(topo, assembly.coefficients(assembly.table(1), damped=False))
    return float(frequencies(matrices, still=topo.still)[0, -1]) / MOST_CYCLES


def _clip(assembly: Assembly, columns: Columns, low: float, high: float) -> tuple[float, float, str | None]:
    if 0 in columns.index:
        return _clip_speed(assembly, columns, low, high)
    if not (columns.unit == "rad" and columns.label.endswith(".angle")):
        return low, high, None
    if max(abs(low), abs(high)) > np.pi:
        worst = high if abs(high) > abs(low) else low
        remedy = f'numbers are radians: write "{worst:g} deg" or tn.deg({worst:g})'
        raise InputError("lies beyond half a turn", element=columns.label, key="range", value=worst, remedy=remedy)
    if low >= STEEPEST_ANGLE or high <= -STEEPEST_ANGLE:
        raise InputError("must reach below 89°", element=columns.label, key="range", value=low)
    clipped = float(np.clip(low, -STEEPEST_ANGLE, None)), float(np.clip(high, None, STEEPEST_ANGLE))
    said = [
        f"{verb} at {np.rad2deg(end):g}° instead of {np.rad2deg(asked):g}°"
        for verb, asked, end in (("starts", low, clipped[0]), ("ends", high, clipped[1]))
        if asked != end
    ]
    return *clipped, f"the {columns.label} axis {' and '.join(said)}: at 90° the joint locks" if said else None


def _clip_speed(assembly: Assembly, columns: Columns, low: float, high: float) -> tuple[float, float, str | None]:
    """Start the axis where the highest mode makes no more than ``MOST_CYCLES`` cycles a turn."""
    place = int(np.flatnonzero(columns.index == 0)[0])
    slope, offset = float(columns.slope[place]), float(columns.offset[place])
    if slope <= 0 or offset != 0:
        raise InputError("must be proportional to the speed to be an axis", key=columns.label)
    if high <= 0:
        raise InputError("must reach above zero", element=columns.label, key="range", value=high)
    least = lowest_speed(assembly) / slope
    why = f"a turn there spans more than {MOST_CYCLES} cycles of the highest mode"
    turning = least * slope * 60 / (2 * np.pi)
    unit = signs(columns.unit)
    if high <= least:
        raise InputError(
            f"lies wholly below {least:.4g} {unit} ({turning:.4g} rpm): {why}, the line follows statically",
            element=columns.label,
            key="range",
            value=high,
            remedy="stability() at single speeds still answers there",
        )
    if low < 0:
        raise InputError("cannot be negative", element=columns.label, key="range", value=low, remedy="start above zero")
    if low < least:
        asked = f"{low:.5g} {unit} ({low * slope * 60 / (2 * np.pi):.4g} rpm)"
        said = f"the {columns.label} axis starts at {least:.4g} {unit} ({turning:.4g} rpm) instead of {asked}"
        return least, high, f"{said}: {why}"
    return low, high, None


def _check_columns(assembly: Assembly, columns: Columns, values: Array) -> None:
    """Refuse values that no line can have: both ends must make a line that could be written by hand.

    What elements ask of their numbers holds between two values wherever it holds at both.
    """
    ends = values[[0, -1]]
    table = assembly.packed.table(2)
    columns.put(table, ends)
    for c in columns.index:
        key = assembly.packed.labels[c].rpartition(".")[2]
        if key == "angle" and (steepest := np.abs(table[:, c])).max() >= np.pi / 2:
            raise InputError(
                f"would bend {assembly.packed.labels[c].rpartition('.')[0]} by {np.rad2deg(steepest.max()):g}°; "
                "it must stay below 90°",
                element=columns.label, key="range", value=float(ends[steepest.argmax()]),
            )  # fmt: skip
    _refuse_impossible(assembly, table, columns.label, [("low", ends[0].item()), ("high", ends[1].item())])


def check_corners(assembly: Assembly, x: ChartAxis, y: ChartAxis) -> None:
    """Refuse two axes whose values are possible one by one and not together, as a bore wider than its tube.

    Raises
    ------
    InputError : names both values and what the element says to them.
    """
    owner = [element for element, _ in assembly.packed.place]
    if not {owner[c] for c in x.columns.index} & {owner[c] for c in y.columns.index}:
        return  # each axis was tried by itself, and no element has numbers of both
    table = assembly.packed.table(4)
    across, up = x.values[[0, 0, -1, -1]], y.values[[0, -1, 0, -1]]
    x.columns.put(table, across)
    y.columns.put(table, up)
    corners = zip(across.tolist(), up.tolist(), strict=True)
    _refuse_impossible(assembly, table, f"{x.label} and {y.label}", [("range", corner) for corner in corners])


def _refuse_impossible(assembly: Assembly, table: Array, label: str, ends: Sequence[tuple[str, object]]) -> None:
    """Refuse rows of packed numbers that make no line; ``ends``: the key and value of the axes at each."""
    for row, (key, value) in zip(table, ends, strict=True):
        try:
            assembly.packed.line_at(row)
        except InputError as error:
            said = error.problems[0]
            place = ".".join(part for part in (said.element, said.key) if part)
            number = f" {said.value:g}" if isinstance(said.value, float) else ""
            raise InputError(
                f"would make {place}{number}, which {said.problem}",
                element=label, key=key, value=value, remedy="let the axis end where the line is still possible",
            ) from None  # fmt: skip

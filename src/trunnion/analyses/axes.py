"""Axes of a chart: a parameter, its range and its points, checked against the line before anything runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.driveline.parameters import SPEED, Columns, Parameter
from trunnion.equations.aligned import aligned_matrices, frequencies
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError

Array = NDArray[np.float64]
AxisRequest = Sequence[object]

MOST_CYCLES = 500
"""Cycles of the highest mode per turn of the input beyond which a speed counts as zero."""
STEEPEST_ANGLE = np.deg2rad(89.0)
POSITIVE = {
    "stiffness", "inertia", "outer_diameter", "length", "thickness", "shear_modulus",
    "damping_ratio_frequency", "loss_factor_frequency", "speed",
}  # fmt: skip


@dataclass(frozen=True)
class Axis:
    """``values`` (points,) of a parameter with its label, unit and place among the packed columns."""

    values: Array
    columns: Columns
    scale: str

    @property
    def label(self) -> str:
        """Path or label of the parameter."""
        return self.columns.label

    @property
    def unit(self) -> str:
        """Unit of the values."""
        return self.columns.unit


def axis(assembly: Assembly, request: AxisRequest, key: str) -> tuple[Axis, str | None]:
    """Turn ``(parameter, low, high, points[, "log"])`` into an Axis; also what was clipped, as a sentence.

    Raises
    ------
    InputError : unknown parameter, reversed or empty range, too few points, values no line can have.
    """
    example = 'write x=("speed", 10, 200, 400)'
    if isinstance(request, str) or not isinstance(request, Sequence) or len(request) not in (4, 5):
        raise InputError("must be (parameter, low, high, points)", key=key, value=request, remedy=example)
    parameter, low, high, points = request[0], request[1], request[2], request[3]
    scale = request[4] if len(request) == 5 else "linear"
    if not isinstance(parameter, str | Parameter):
        raise InputError("must name a parameter", key=key, value=parameter, remedy=example)
    columns = assembly.packed.resolve(parameter)
    low, high = _number(low, columns.label, "low"), _number(high, columns.label, "high")
    if isinstance(points, bool) or not isinstance(points, int | np.integer) or points < 1:
        raise InputError("must be a whole number of points, 1 or more", element=columns.label, key="points", value=points)
    if points > 1 and not low < high or points == 1 and low > high:
        raise InputError(
            f"runs from {low:g} to {high:g}", element=columns.label, key="range", remedy="give low < high"
        )
    if scale not in ("linear", "log"):
        raise InputError("is not a scale", element=columns.label, key="scale", value=scale, remedy='"linear" or "log"')
    low, high, said = _clip(assembly, columns, low, high)
    if scale == "log" and low <= 0:
        raise InputError("cannot start at or below zero", element=columns.label, key="log axis", value=low)
    values = np.geomspace(low, high, points) if scale == "log" else np.linspace(low, high, points)
    _check_columns(assembly, columns, values)
    return Axis(values, columns, str(scale)), said


def _number(value: object, label: str, key: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not np.isfinite(value):
        raise InputError(
            "must be a finite number in SI units", element=label, key=key, value=value, remedy="tn.rpm(300), tn.deg(5)"
        )
    return float(value)


def lowest_speed(assembly: Assembly) -> float:
    """Speed [rad/s] below which a turn spans more than ``MOST_CYCLES`` cycles of the highest mode."""
    topo = assembly.topology
    matrices = aligned_matrices(topo, assembly.coefficients(assembly.table(1)))
    return float(frequencies(matrices, free=topo.free)[0, -1]) / MOST_CYCLES


def _clip(assembly: Assembly, columns: Columns, low: float, high: float) -> tuple[float, float, str | None]:
    if columns.label == SPEED:
        if high <= 0:
            raise InputError("must reach above zero", element=SPEED, key="range", value=high)
        least = lowest_speed(assembly)
        if low < least and high > least:
            why = f"a turn there spans more than {MOST_CYCLES} cycles of the highest mode"
            return least, high, f"the speed axis starts at {least:.4g} rad/s instead of {low:g}: {why}"
    if columns.unit == "rad" and columns.label.endswith(".angle") and high > STEEPEST_ANGLE:
        if low >= STEEPEST_ANGLE:
            raise InputError("must start below 89°", element=columns.label, key="range", value=low)
        said = f"the axis {columns.label} ends at 89° instead of {np.rad2deg(high):g}°: at 90° the joint locks"
        return low, STEEPEST_ANGLE, said
    return low, high, None


def _check_columns(assembly: Assembly, columns: Columns, values: Array) -> None:
    """Refuse values that no line can have, by the columns they would fill."""
    table = assembly.packed.table(len(values))
    columns.put(table, values)
    for c in columns.index:
        key = assembly.packed.labels[c].rpartition(".")[2]
        worst = float(table[:, c].min())
        if key in POSITIVE and worst <= 0:
            raise InputError(
                f"would make {assembly.packed.labels[c]} {worst:g}; it must be positive",
                element=columns.label,
                key="low",
                value=float(values[0]),
                remedy="raise the lower end of the axis",
            )
        if key == "angle" and np.abs(table[:, c]).max() >= np.pi / 2:
            raise InputError("must stay below 90°", element=columns.label, key="range", value=float(values[-1]))
        if key == "inner_diameter":
            outer = table[:, assembly.packed.labels.index(assembly.packed.labels[c].replace("inner", "outer"))]
            if np.any(table[:, c] >= outer) or worst < 0:
                raise InputError("must stay between 0 and the outer diameter", element=columns.label, key="range")

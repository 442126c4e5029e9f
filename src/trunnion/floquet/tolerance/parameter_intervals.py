"""Numbers of a line between bounds: what optimisation may choose, what tolerances let scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.parameters import Columns
from trunnion.driveline.patterns import closeness
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError

Value = TypeVar("Value")


@dataclass(frozen=True)
class ParameterInterval:
    """One parameter of a line between ``low`` and ``high``, and the value that it has now, SI units."""

    label: str
    unit: str
    columns: Columns
    nominal: float
    low: float
    high: float


def columns_of(assembly: Assembly, path: str) -> Columns:
    """The columns of a parameter.

    Raises
    ------
    InputError : no parameter of the line, or its speed.
    """
    columns = assembly.packed.resolve(path)
    if 0 in columns.index:
        raise InputError("is not a parameter of the line but its speed", key=path, remedy="give speeds instead")
    return columns


def each_named(assembly: Assembly, given: Mapping[str, Value]) -> dict[str, Value]:
    """What is given by path, by every number's own path; what is said of one element overrides a pattern."""
    found: dict[str, Value] = {}
    for path in sorted(given, key=lambda path: closeness(path.rpartition(".")[0])):
        for one in assembly.packed.each(path):
            found[one] = given[path]
    order = [one for path in given for one in assembly.packed.each(path)]
    return {one: found[one] for one in dict.fromkeys(order)}


def table_at(
    assembly: Assembly, parameters: Sequence[ParameterInterval], values: Array, speed: float = np.nan
) -> Array:
    """Numbers of lines (lines, columns) at values (lines, parameters)."""
    table = assembly.table(len(values), speed)
    for k, one in enumerate(parameters):
        one.columns.put(table, values[:, k])
    return np.asarray(table)


def require_possible(assembly: Assembly, parameters: Sequence[ParameterInterval], once: str, within: str) -> None:
    """Refuse parameters that no line can have, or that move one number together.

    Parameters
    ----------
    once, within : what to do about a number that is moved twice, and about ends that are impossible.

    Raises
    ------
    InputError : names the parameter.
    """
    taken: dict[int, str] = {}
    for one in parameters:
        for column in one.columns.index.tolist():
            if column in taken:
                problem = f"moves {assembly.packed.labels[column]}, as {taken[column]} does"
                raise InputError(problem, key=one.label, remedy=once)
            taken[column] = one.label
    for one in parameters:
        for end in (one.low, one.high):
            try:
                assembly.packed.line_at(table_at(assembly, [one], np.array([[end]]))[0])
            except InputError as error:
                problem = f"would reach {end:.6g}, which no line can have ({error.problems[0].problem})"
                raise InputError(problem, key=one.label, remedy=within) from None

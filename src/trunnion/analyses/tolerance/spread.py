"""Tolerances: which parameters of a line scatter, how far, and with what distribution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from trunnion.driveline.parameters import Columns
from trunnion.driveline.tolerances import FARTHEST
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError

Array = NDArray[np.float64]
Tolerances = Mapping[str, object]
"""Path → what it scatters by; see ``read_tolerances``."""
EXAMPLE = '{"Shaft 1.stiffness": 0.1} for ±10 %, ("range", low, high), ("normal", 0.03) or ("deviation", size)'


@dataclass(frozen=True)
class Spread:
    """One parameter between ``low`` and ``high`` (SI units), uniformly, or normally about their middle with
    ``deviation``."""

    label: str
    unit: str
    columns: Columns
    nominal: float
    low: float
    high: float
    deviation: float | None = None

    def values(self, share: Array) -> Array:
        """Quantiles: shares from 0 to 1 → values. Normal ones are cut at three standard deviations."""
        if self.deviation is None:
            return np.asarray(self.low + share * (self.high - self.low))
        return np.asarray(np.clip(self.nominal + self.deviation * ndtri(share), self.low, self.high))


def read_tolerances(assembly: Assembly, tolerances: Tolerances | None) -> tuple[Spread, ...]:
    """Spreads of a mapping of paths to a share (0.1: ±10 %, uniform), ("range", low, high) in SI units, ("normal",
    share), or ("deviation", size in SI units); those that the line states where none are given.

    Raises
    ------
    InputError : nothing scatters; unknown parameters; values no line can have; a number moved twice.
    """
    if tolerances is None:
        tolerances = assembly.line.tolerances_by_path
        if not tolerances:
            remedy = 'write [[tolerance]] with of = "Shaft 1" and stiffness = "5 %", or give tolerances'
            raise InputError("are not stated", element="driveline", key="tolerances", remedy=remedy)
    if not isinstance(tolerances, Mapping) or not tolerances:
        raise InputError("must name one parameter or more", key="tolerances", value=tolerances, remedy=EXAMPLE)
    spreads = tuple(_spread(assembly, path, given) for path, given in tolerances.items())
    taken: dict[int, str] = {}
    for one in spreads:
        for column in one.columns.index.tolist():
            if column in taken:
                raise InputError(
                    f"moves {assembly.packed.labels[column]}, as {taken[column]} does", key=one.label,
                    remedy="let each number scatter once",
                )  # fmt: skip
            taken[column] = one.label
    _require_lines(assembly, spreads)
    return spreads


def _spread(assembly: Assembly, path: str, given: object) -> Spread:
    columns = assembly.packed.resolve(path)
    if 0 in columns.index:
        raise InputError("is no parameter of the line but its speed", key=path, remedy="give speeds instead")
    nominal = assembly.packed.value(path)
    kind, numbers = _read(path, given)
    if kind == "range":
        low, high = numbers
        return Spread(columns.label, columns.unit, columns, nominal, low, high)
    if kind == "deviation":
        ends = nominal - FARTHEST * numbers[0], nominal + FARTHEST * numbers[0]
        return Spread(columns.label, columns.unit, columns, nominal, *ends, numbers[0])
    if nominal == 0:
        raise InputError("is zero, so no share of it is a tolerance", key=path, remedy='("range", low, high)')
    reach = abs(nominal) * numbers[0]
    if kind == "normal":
        ends = nominal - FARTHEST * reach, nominal + FARTHEST * reach
        return Spread(columns.label, columns.unit, columns, nominal, *ends, reach)
    return Spread(columns.label, columns.unit, columns, nominal, nominal - reach, nominal + reach)


def _read(path: str, given: object) -> tuple[str, tuple[float, ...]]:
    plain = isinstance(given, int | float) and not isinstance(given, bool)
    parts = ("share", given) if plain else given
    if isinstance(parts, Sequence) and not isinstance(parts, str) and len(parts) >= 2:
        kind, numbers = parts[0], parts[1:]
        if all(isinstance(n, int | float) and np.isfinite(n) for n in numbers):
            if kind in ("share", "normal") and len(numbers) == 1 and 0 < numbers[0] < 1:
                return str(kind), (float(numbers[0]),)
            if kind == "deviation" and len(numbers) == 1 and numbers[0] > 0:
                return "deviation", (float(numbers[0]),)
            if kind == "range" and len(numbers) == 2 and numbers[0] < numbers[1]:
                return "range", (float(numbers[0]), float(numbers[1]))
    raise InputError("is no tolerance", key=path, value=given, remedy=EXAMPLE)


def _require_lines(assembly: Assembly, spreads: tuple[Spread, ...]) -> None:
    """Refuse ends that no line can have."""
    for one in spreads:
        for value in (one.low, one.high):
            row = assembly.table(1)
            one.columns.put(row, value)
            try:
                assembly.packed.line_at(row[0])
            except InputError as error:
                problem = f"would reach {value:.6g}, which no line can have ({error.problems[0].problem})"
                raise InputError(problem, key=one.label, remedy="narrow the tolerance") from None


def tables(assembly: Assembly, spreads: tuple[Spread, ...], shares: Array, speed: float) -> Array:
    """The numbers of lines (lines, columns) at shares (lines, parameters) of their tolerances."""
    table = assembly.table(len(shares), speed)
    for k, one in enumerate(spreads):
        one.columns.put(table, one.values(shares[:, k]))
    return np.asarray(table)

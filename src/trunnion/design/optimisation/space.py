"""The numbers of a line that may be chosen, each between its bounds."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, log

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.quantities import TEMPERATURE, kind_of, parse
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.floquet.tolerance.parameter_intervals import (
    ParameterInterval,
    columns_of,
    each_named,
    require_possible,
    table_at,
)

_ZERO = re.compile(r"[+-]?(0+\.?0*|\.0+)(e[+-]?\d+)?", re.IGNORECASE)
WIDE = 10.0
"""Ratio of the bounds from which a positive number is searched by its logarithm."""


@dataclass(frozen=True)
class FreeVariable(ParameterInterval):
    """One number to choose."""

    @property
    def logarithmic(self) -> bool:
        """Whether it is searched by its logarithm."""
        return self.low > 0 and self.high > WIDE * self.low

    def at(self, share: float) -> float:
        """The value at a share of the way from the low bound to the high one."""
        share = min(max(share, 0.0), 1.0)
        if self.logarithmic:
            return float(self.low * (self.high / self.low) ** share)
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """The inverse of ``at``, within the bounds."""
        value = min(max(value, self.low), self.high)
        if self.logarithmic:
            return log(value / self.low) / log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


class Space:
    """All designs within the bounds, as shares (free,) between 0 and 1."""

    def __init__(self, assembly: Assembly, free: Mapping[str, Sequence[object]]) -> None:
        if not isinstance(free, Mapping) or not free:
            label = next(
                (one for one in assembly.packed.labels if one.endswith(".stiffness")), assembly.packed.labels[0]
            )
            raise InputError("must name one parameter or more", key="free", remedy=_example(assembly, label))
        if any(not isinstance(path, str) or not path.strip() for path in free):
            known = ", ".join(assembly.packed.labels)
            raise InputError("has an empty name of a parameter", key="free", remedy=f"parameters are: {known}")
        self.assembly = assembly
        self.free = tuple(_free(assembly, path, ends) for path, ends in each_named(assembly, free).items())
        require_possible(assembly, self.free, once="let each number be free once", within="move the bound")

    @property
    def start(self) -> Array:
        """Shares of the line as it is, as near as the bounds allow."""
        return np.array([one.share(one.nominal) for one in self.free])

    def values(self, shares: Array) -> Array:
        """Values (free,) in SI units."""
        return np.array([one.at(float(share)) for one, share in zip(self.free, shares, strict=True)])

    def line(self, shares: Array) -> Driveline | None:
        """The line there; None where its elements refuse it."""
        return self.assembly.packed.line_if_possible(table_at(self.assembly, self.free, self.values(shares)[None])[0])


def _free(assembly: Assembly, path: str, ends: Sequence[object]) -> FreeVariable:
    columns = columns_of(assembly, path)
    if isinstance(ends, str) or not isinstance(ends, Sequence) or len(ends) != 2:
        raise InputError("must be a low and a high bound", key=path, value=ends, remedy=_example(assembly, path))
    low, high = (_bound(assembly, path, end, columns.unit) for end in ends)
    if not low < high:
        raise InputError("must be rising bounds", key=path, value=tuple(ends), remedy=_example(assembly, path))
    return FreeVariable(path, columns.unit, columns, assembly.packed.value(path), low, high)


def _example(assembly: Assembly, path: str) -> str:
    """Bounds about the value that a parameter has, as they may be written."""
    value = float(assembly.packed.value(path))
    ends = sorted((0.8 * value, 1.25 * value)) if value else (0.0, 0.1)
    return f'write free={{"{path}": ({ends[0]:.4g}, {ends[1]:.4g})}}, say'


def _bound(assembly: Assembly, path: str, end: object, unit: str) -> float:
    if isinstance(end, str) and (kind := kind_of(unit)):
        if kind is not TEMPERATURE and _ZERO.fullmatch(end.strip()):
            return 0.0  # in any unit
        try:
            return parse(end, kind)
        except InputError as error:
            raise error.but(key=path, value=end) from None
    if isinstance(end, bool) or not isinstance(end, int | float | np.number) or not isfinite(end):
        remedy = _example(assembly, path)
        raise InputError("must be finite numbers or texts with a unit", key=path, value=end, remedy=remedy)
    return float(end)

"""Tolerances: which parameters of a line scatter, how far, and with what distribution."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from trunnion.arrays import Array
from trunnion.driveline.parameters import unit_of
from trunnion.driveline.tolerances import Scatter
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.floquet.tolerance.parameter_intervals import (
    ParameterInterval,
    columns_of,
    each_named,
    require_possible,
    table_at,
)
from trunnion.results.units import in_words

Tolerances = Mapping[str, object]
"""Path → what it scatters by; see ``read_tolerances``."""
LEAST = 1e-12
"""Shares closer to 0 or 1 would be infinite quantiles of a normal distribution, before it is cut."""
ZERO = "is zero, so no share of it is a tolerance"
EXAMPLE = '{"Shaft 1.stiffness": 0.1} for ±10 %, ("range", low, high), ("normal", 0.03) or ("deviation", size)'


@dataclass(frozen=True)
class Spread(ParameterInterval):
    """One parameter that scatters, uniformly, or normally about its middle with ``deviation``."""

    deviation: float | None = None

    def values(self, share: Array) -> Array:
        """Quantiles: shares from 0 to 1 → values. Normal ones are cut at three standard deviations."""
        return normal_or_even(share, self.nominal, self.low, self.high, self.deviation)


def normal_or_even(share: Array, nominal: float, low: float, high: float, deviation: float | None) -> Array:
    """Quantiles of a number that scatters evenly between its ends, or normally with ``deviation`` and cut there."""
    if deviation is None:
        return np.asarray(low + share * (high - low))
    return np.asarray(np.clip(nominal + deviation * ndtri(share), low, high))


def read_tolerances(assembly: Assembly, tolerances: Tolerances | None) -> tuple[Spread, ...]:
    """Spreads of a mapping of paths, of patterns each number by itself, to a share (0.1: ±10 %, uniform), ("range",
    low, high) in SI units, ("normal", share), or ("deviation", size in SI units); those that the line states where none
    are given.

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
    spreads = tuple(_spread(assembly, path, given) for path, given in each_named(assembly, tolerances).items())
    require_possible(assembly, spreads, once="let each number scatter once", within="narrow the tolerance")
    return spreads


def _spread(assembly: Assembly, path: str, given: object) -> Spread:
    columns = columns_of(assembly, path)
    nominal, scatter = assembly.packed.value(path), _read(path, given)
    if nominal == 0 and scatter.form in ("share", "normal"):
        raise InputError(ZERO, key=path, remedy='("range", low, high)')
    return Spread(columns.label, columns.unit, columns, nominal, *scatter.ends(nominal), scatter.deviation(nominal))


def _read(path: str, given: object) -> Scatter:
    plain = isinstance(given, int | float) and not isinstance(given, bool)
    parts = ("share", given) if plain else given
    if isinstance(parts, Sequence) and not isinstance(parts, str) and len(parts) >= 2:
        form, numbers = parts[0], parts[1:]
        if all(isinstance(n, int | float) and np.isfinite(n) for n in numbers):
            rises = len(numbers) == 2 and numbers[0] < numbers[1]
            inside = len(numbers) == 1 and 0 < numbers[0] < (np.inf if form == "deviation" else 1)
            if form == "range" and rises or form in ("share", "normal", "deviation") and inside:
                return Scatter(path, form, tuple(map(float, numbers)))
    raise InputError("is not a tolerance", key=path, value=given, remedy=EXAMPLE)


def tables(assembly: Assembly, spreads: tuple[Spread, ...], shares: Array, speed: float) -> Array:
    """The numbers of lines (lines, columns) at shares (lines, parameters) of their tolerances."""
    inside = np.clip(shares, LEAST, 1 - LEAST)
    return table_at(
        assembly, spreads, np.stack([s.values(x) for s, x in zip(spreads, inside.T, strict=True)], 1), speed
    )


def values_in_words(values: Mapping[str, float]) -> str:
    """Numbers of one line by parameter, in engineers' units: "Shaft 1.stiffness = 11 kN*m/rad"."""
    return ", ".join(f"{path} = {in_words(value, unit_of(path), 5)}" for path, value in values.items())


def numbers_at(spreads: tuple[Spread, ...], shares: Array) -> dict[str, float]:
    """By parameter the numbers of one line at shares (parameters,) of its tolerances."""
    inside = np.clip(shares, LEAST, 1 - LEAST)
    return {one.label: float(one.values(share)) for one, share in zip(spreads, inside, strict=True)}

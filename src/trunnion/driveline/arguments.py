"""Reads what a caller passes to an analysis: a value of another kind is refused in one line, not by Python."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from numbers import Real
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.quantities import SPEED, QuantityKind, parse
from trunnion.errors import InputError

SpeedEnds: TypeAlias = tuple[float | str, float | str]
"""Lowest and highest speed, numbers [rad/s] or texts with a unit."""


def one_number(value: object, key: str, remedy: str = "") -> float:
    """One number.

    Raises
    ------
    InputError : it is none.
    """
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise InputError("must be a number", key=key, value=_said(value), remedy=remedy)
    return float(value)


def quantity(value: object, kind: QuantityKind, key: str) -> float:
    """A quantity [SI] of a kind, from a number or a text with its unit.

    Raises
    ------
    InputError : it is none, or of another dimension.
    """
    try:
        return parse(value, kind)
    except InputError as error:
        raise error.but(key=key) from None


def whole_number(value: object, key: str, least: int) -> int:
    """A whole number, ``least`` or more.

    Raises
    ------
    InputError : it is none, or less.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise InputError(f"must be a whole number, {least} or more", key=key, value=value)
    return int(value)


def speeds_of(values: ArrayLike, remedy: str = "", key: str = "speeds") -> Array:
    """One speed or several [rad/s], numbers or texts with a unit ("1500 rpm"), as an array (speeds,).

    Raises
    ------
    InputError : there is something else among them, or none.
    """
    if isinstance(values, str):
        values = [values]
    if isinstance(values, list | tuple) and any(isinstance(one, str) for one in values):
        values = [quantity(one, SPEED, key) for one in values]
    return numbers(values, key, remedy)


def one_speed(value: object, key: str, remedy: str = "tn.rpm(500), say") -> float:
    """One speed [rad/s], a number or a text with its unit.

    Raises
    ------
    InputError : it is none.
    """
    return quantity(value, SPEED, key) if isinstance(value, str) else one_number(value, key, remedy)


def running_range(speeds: Any) -> tuple[float, float]:
    """Lowest and highest speed of a range [rad/s]; both may be the same, the lowest 0.

    Raises
    ------
    InputError : they are not two, or fall.
    """
    return _ends(speeds, "must be a lowest and a highest speed", lambda low, high: 0 <= low <= high > 0)


def rising_range(speeds: Any) -> tuple[float, float]:
    """The same of a range of some width that begins above 0."""
    return _ends(speeds, "must be two rising positive speeds", lambda low, high: 0 < low < high)


def _ends(speeds: Any, problem: str, fit: Callable[[float, float], bool]) -> tuple[float, float]:
    remedy = '(tn.rpm(300), tn.rpm(2400)) or ("300 rpm", "2400 rpm"), say'
    ends = speeds_of(speeds, remedy).tolist()
    if len(ends) != 2 or not np.all(np.isfinite(ends)) or not fit(*ends):
        raise InputError(problem, key="speeds", value=_said(speeds), remedy=remedy)
    return ends[0], ends[1]


def numbers(values: ArrayLike, key: str, remedy: str = "") -> Array:
    """One number or several, as an array (numbers,) of floats.

    Raises
    ------
    InputError : there is something else among them, or none.
    """
    try:
        found = np.atleast_1d(np.asarray(values))
    except ValueError:  # lists of unlike lengths
        found = np.zeros((0, 0))
    if found.ndim != 1 or not len(found) or not np.issubdtype(found.dtype, np.number) or np.iscomplexobj(found):
        raise InputError("must be a number or several", key=key, value=_said(values), remedy=remedy)
    return found.astype(float)


def several(values: object, key: str, remedy: str = "") -> tuple[Any, ...]:
    """A text or a list as a tuple, a text as its only member.

    Raises
    ------
    InputError : it is neither.
    """
    if isinstance(values, str):
        return (values,)
    if not isinstance(values, Iterable):
        raise InputError("must be a name or a list of them", key=key, value=_said(values), remedy=remedy)
    return tuple(values)


def _said(value: object) -> object:
    """None is shown as a value, too."""
    return "None" if value is None else value

"""Reads what a caller passes to an analysis: a value of another kind is refused in one line, not by Python."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.driveline.quantities import Kind, parse
from trunnion.errors import InputError


def one_number(value: object, key: str, remedy: str = "") -> float:
    """One number.

    Raises
    ------
    InputError : it is none.
    """
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise InputError("must be a number", key=key, value=_said(value), remedy=remedy)
    return float(value)


def quantity(value: object, kind: Kind, key: str) -> float:
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

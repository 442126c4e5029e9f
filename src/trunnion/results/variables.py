"""What a dataset is made of: variables over named axes, coordinates that label these, attributes of the whole."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Variable:
    """Values over ``axes`` (names with blanks between; "" for one number); ``more``: further attributes, as flag
    meanings."""

    name: str
    values: Any
    axes: str = ""
    unit: str = ""
    words: str = ""
    more: Mapping[str, Any] = field(default_factory=dict)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the axes."""
        return tuple(self.axes.split())

    @property
    def attributes(self) -> dict[str, Any]:
        """Unit and words, as datasets have them."""
        named = {"units": self.unit, "long_name": self.words}
        return {**{name: text for name, text in named.items() if text}, **self.more}


class Coordinate(Variable):
    """What labels an axis: numbers with a unit, or names; one of another name labels it a second time."""


@dataclass(frozen=True)
class Attribute:
    """Something about the whole."""

    name: str
    values: Any


def attributes(**values: Any) -> Iterator[Attribute]:
    """Several at once, for what a result adds to its fields."""
    return (Attribute(name, as_stored(value)) for name, value in values.items())


def as_stored(values: Any) -> Any:
    """Values as files have them: yes and no as 1 and 0, and words for what is neither number nor array."""
    if isinstance(values, np.ndarray):
        return values.astype(np.int8) if values.dtype == bool else values
    if isinstance(values, bool):
        return int(values)
    if isinstance(values, tuple | list):
        flags = bool(values) and all(isinstance(one, bool) for one in values)
        return np.array(values, dtype=np.int8) if flags else [as_stored(one) for one in values]
    plain = values is None or isinstance(values, int | float | complex | str | np.generic)
    return values if plain and not isinstance(values, Enum) else str(values)

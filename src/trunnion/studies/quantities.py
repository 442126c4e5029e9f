"""A number of a result by its path: ``growth_rate``, ``binding.margin``, ``checks[max torque of shaft].spare``.

A path goes through names with dots, takes one of several by its place from 0 or by its name in brackets, and may end in
``max``, ``min`` or ``mean`` of an array, NaN left out. Numbers, yes and no, words and verdicts can be kept.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum
from typing import Any

import numpy as np

from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError
from trunnion.results.fields import labels

STEP = re.compile(r"([A-Za-z]\w*)((?:\[[^\[\]]+\])*)(?:\.|$)")
INDEX = re.compile(r"\[([^\[\]]+)\]")
OF_ARRAYS: dict[str, Callable[[Any], Any]] = {"max": np.nanmax, "min": np.nanmin, "mean": np.nanmean}
LETTERS = 48
"""Bytes of a word that is kept; longer ones are cut."""
KINDS = ("number", "code", "word")


class UnknownQuantity(InputError):
    """A path that a result does not have."""


@dataclass(frozen=True)
class StudyQuantity:
    """One quantity of every point: its path, what kind of value it is, unit, and what its codes mean."""

    path: str
    kind: str = "number"
    unit: str = ""
    meanings: tuple[str, ...] = ()
    codes: tuple[int, ...] = ()

    @property
    def content(self) -> dict[str, Any]:
        """As JSON keeps it."""
        return {**vars(self), "meanings": list(self.meanings), "codes": list(self.codes)}

    @classmethod
    def of_content(cls, content: Mapping[str, Any]) -> StudyQuantity:
        """What ``content`` says."""
        return cls(**{**content, "meanings": tuple(content["meanings"]), "codes": tuple(content["codes"])})

    @classmethod
    def of(cls, path: str, result: object) -> StudyQuantity:
        """As a first result has it.

        Raises
        ------
        InputError : it has no such quantity (the nearest is named), or one that is not a number, word or verdict.
        """
        value, owner, last = followed(result, path)
        label = labels(type(owner)).get(last)
        unit = label.unit if label and "{" not in label.unit else ""
        if isinstance(value, Enum):
            members = list(type(value))
            numbers = [int(m.value) for m in members] if isinstance(value, IntEnum) else list(range(len(members)))
            return cls(path, "code", "", tuple(map(str, members)), tuple(numbers))
        if isinstance(value, bool | np.bool_):
            return cls(path, "code", "", ("no", "yes"), (0, 1))
        if isinstance(value, str):
            return cls(path, "word")
        if value is None or (np.ndim(value) == 0 and isinstance(value, int | float | np.number)):
            return cls(path, "number", unit)
        raise InputError(f"is not a number, word or verdict but {_what(value)}", key=path, remedy=_inside(path, value))

    def read(self, result: object) -> float | str:
        """Its value in a result: a number, a code, or a word.

        Raises
        ------
        InputError : the result of this point has none.
        """
        value = followed(result, self.path)[0]
        if self.kind == "word":
            return "" if value is None else str(value)
        if value is None:
            return float("nan")
        if isinstance(value, Enum) and not isinstance(value, IntEnum):
            return float(list(type(value)).index(value))
        return float(value)

    def empty(self, points: int) -> Any:
        """Room for the values of some points, nothing known."""
        return np.zeros((points, LETTERS), dtype=np.uint8) if self.kind == "word" else np.full(points, np.nan)

    def put(self, values: Any, place: int, value: float | str) -> None:
        """Set the value of one point."""
        if self.kind == "word":
            letters = str(value).encode()[:LETTERS]
            letters = letters.decode(errors="ignore").encode()  # no half of a letter
            values[place, : len(letters)] = np.frombuffer(letters, dtype=np.uint8)
        else:
            values[place] = value

    def shown(self, values: Any) -> Any:
        """Values as people read them: words, or numbers as they are."""
        if self.kind == "word":
            return words_of(values)
        if self.kind == "code":
            known = dict(zip(self.codes, self.meanings, strict=True))
            return np.array([known.get(int(v), "") if np.isfinite(v) else "" for v in values], dtype=str)
        return values


def words_of(letters: Any) -> Any:
    """Words of rows of bytes."""
    rows = np.ascontiguousarray(letters).view(f"S{LETTERS}")[:, 0]
    return np.array([row.decode() for row in rows.tolist()], dtype=str)


def followed(result: object, path: str) -> tuple[Any, object, str]:
    """What stands at a path, what has it, and the last name of the path.

    Raises
    ------
    InputError : there is none; names the nearest.
    """
    if not isinstance(path, str) or not path or "".join(m.group(0) for m in STEP.finditer(path)) != path:
        raise InputError("is not a path of a quantity", key="quantities", value=path, remedy='"growth_rate", say')
    value, owner, last = result, result, ""
    for step in STEP.finditer(path):
        name, indices = step.group(1), INDEX.findall(step.group(2))
        owner, last = value, name
        value = _named(value, name, path)
        for index in indices:
            value = _picked(value, index, path)
    return value, owner, last


def _named(value: Any, name: str, path: str) -> Any:
    if isinstance(value, np.ndarray) and name in OF_ARRAYS:
        return float(OF_ARRAYS[name](value)) if np.isfinite(value).any() else None
    if isinstance(value, Mapping):
        return _picked(value, name, path)
    if value is None:
        return None  # a check that does not bind, say
    known = names_of(value)
    if name not in known:
        what = f"is not a quantity of {type(value).__name__}"
        raise UnknownQuantity(what, key="quantities", value=path, remedy=nearest(name, known))
    return getattr(value, name)


def names_of(value: object) -> list[str]:
    """Names that a path may take from here: labelled fields and properties first."""
    if isinstance(value, np.ndarray):
        return list(OF_ARRAYS)
    stated = list(labels(type(value)))
    more = [name for name, one in vars(type(value)).items() if not name.startswith("_") and not callable(one)]
    fields = [name for name in getattr(value, "__dict__", ()) if not name.startswith("_")]
    inherited = [
        name
        for kind in type(value).__mro__[1:-1]
        for name, one in vars(kind).items()
        if not name.startswith("_") and (isinstance(one, property) or hasattr(one, "attrname"))
    ]
    return list(dict.fromkeys([*stated, *fields, *more, *inherited]))


def _picked(value: Any, index: str, path: str) -> Any:
    if value is None:
        return None
    number = int(index) if re.fullmatch(r"-?\d+", index) else None
    if isinstance(value, Mapping):
        if index not in value:
            problem = f"has no {index}"
            raise UnknownQuantity(problem, key="quantities", value=path, remedy=nearest(index, map(str, value)))
        return value[index]
    if not isinstance(value, Sequence | np.ndarray) or isinstance(value, str):
        raise UnknownQuantity("takes one of what is not several", key="quantities", value=path, remedy="leave out […]")
    if number is not None:
        if not -len(value) <= number < len(value):
            problem = f"takes number {number} of {len(value)}"
            raise UnknownQuantity(problem, key="quantities", value=path, remedy="count from 0")
        return value[number]
    names = [str(getattr(one, "name", "")) for one in value]
    if index not in names:
        raise UnknownQuantity(
            f"has no {index}", key="quantities", value=path, remedy=nearest(index, filter(None, names))
        )
    return value[names.index(index)]


def _what(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    return f"a {type(value).__name__}"


def _inside(path: str, value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f'write "{path}.max", or "{path}[0]"'
    if isinstance(value, Sequence | Mapping):
        return f'take one of them: "{path}[0]"'
    names = names_of(value)
    return f'take something of it: "{path}.{names[0]}"' if names else "take another"

"""What all that a description states has in common: frozen values that refuse in sentences of ours, and lists of them.

Numbers are quantities (``quantities.Quantity``), from which files, text and schema take their units.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Annotated, Any, ClassVar, Self, TypeVar, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError
from pydantic.fields import FieldInfo

from trunnion.driveline.quantities import Quantity, QuantityKind
from trunnion.driveline.refusals import nearest, numbered, refuse
from trunnion.errors import InputError, all_made

LONGEST_NAME = 80


def is_name(value: object) -> bool:
    """Whether `value` can be a name: one line of text; no *, which stands for "all" in parameter paths."""
    if not isinstance(value, str) or len(value) > LONGEST_NAME:
        return False
    return value == value.strip() != "" and value.isprintable() and "*" not in value


def _name(value: object) -> object:
    if not is_name(value):
        remedy = f"write one line of text without * or outer blanks, of at most {LONGEST_NAME} characters"
        raise InputError("is not a name", value=value, remedy=remedy)
    return value


Name = Annotated[str, BeforeValidator(_name)]


def whole_from(least: int | None, most: int | None, example: int) -> Callable[[object], object]:
    """Reads a whole number of a range; None is no end of it."""
    reach = f"{least} or more" if most is None else f"from {least} to {most}"

    def read(value: object) -> object:
        if isinstance(value, bool) or not isinstance(value, int):
            raise InputError("must be a whole number", value=value, remedy=f"write {example}, say, without quotes")
        if (least is not None and value < least) or (most is not None and value > most):
            raise InputError(f"must be {reach}", value=value, remedy=f"write {example}, say")
        return value

    return read


_READ_WHOLE = whole_from(None, None, example=2)


def _whole_or_none(value: object) -> object:
    return None if value is None else _READ_WHOLE(value)


WholeNumber = Annotated[int | None, BeforeValidator(_whole_or_none)]


def _switch(value: object) -> object:
    if not isinstance(value, bool):
        raise InputError("is neither true nor false", value=value, remedy="write true or false, without quotes")
    return value


Switch = Annotated[bool, BeforeValidator(_switch)]
"""True or false, and no text or number that may mean it."""


class Record(BaseModel):
    """Base of all that is stated: checks itself when it is made, with an InputError for all that is wrong.

    ``what`` is how complaints call it, ``example`` what they offer where a key is missing.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")
    what: ClassVar[str] = ""
    example: ClassVar[str] = ""

    def __init__(self, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise refuse(error, type(self), data, element=self.called(data), example=self.example) from None

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """What complaints call the one that states ``data``."""
        return cls.what

    @property
    def stated(self) -> dict[str, Any]:
        """The fields that differ from their defaults: ``type(e)(**e.stated) == e``."""
        return {k: v for k, f in type(self).model_fields.items() if (v := getattr(self, k)) != f.default}

    def but(self, **changes: Any) -> Self:
        """The same with fields changed; None, or its default, takes a field away."""
        defaults = {key: field.default for key, field in type(self).model_fields.items()}
        fields = {**self.stated, **changes}
        return type(self)(**{k: v for k, v in fields.items() if v is not None and not _same(v, defaults.get(k))})

    @classmethod
    def quantity_of(cls, key: str) -> QuantityKind | None:
        """The physical kind of field `key`, or of the members of its list; None where it is not a quantity."""
        return _kind_in(cls.model_fields[key])


def _same(value: object, default: object) -> bool:
    """Whether a value is a default; an array is none."""
    return type(value) is type(default) and bool(value == default)


def _kind_in(part: Any) -> QuantityKind | None:
    """The kind that a field, or what its annotation is made of, is marked with."""
    inner = (part.annotation,) if isinstance(part, FieldInfo) else get_args(part)
    for mark in (*getattr(part, "metadata", ()), *getattr(part, "__metadata__", ())):
        if isinstance(mark, Quantity):
            return mark.kind
    return next((kind for one in inner if (kind := _kind_in(one)) is not None), None)


class Named(Record):
    """What has a ``name`` by which it is asked for, and tables by the names of elements."""

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """What it is, and its name."""
        return f"{cls.what} {data['name']}" if is_name(data.get("name")) else cls.what

    def __hash__(self) -> int:
        values = (getattr(self, key) for key in type(self).model_fields)
        return hash(tuple(frozenset(one.items()) if isinstance(one, dict) else one for one in values))


Made = TypeVar("Made", bound=Record)


def listed(
    kind: type[Made], word: str, remedy: str = "", owner: str = "", key: str = "", none: bool = True
) -> Callable[[object], tuple[Made, ...]]:
    """Reads a list of ``kind``, each made or as a table.

    Parameters
    ----------
    word : one of them in messages.
    remedy : how to write the list; by default as tables of a file.
    owner : key by which complaints about one already say which; the others get their number.
    key : that the list is stated by; by default what one of it is called.
    none : whether an empty list has a meaning.
    """
    key = key or kind.what
    remedy = remedy or f"write {key} = [{{ {kind.example.replace(' and ', ', ')} }}]"

    def one(place: int, item: object) -> Made:
        try:
            if not isinstance(item, kind | dict):
                raise InputError(f"is not a {word}", value=item, remedy=remedy)
            return kind(**item) if isinstance(item, dict) else item
        except InputError as error:
            if owner and isinstance(item, dict) and owner in item:
                raise
            raise numbered(error, key, place) from None

    def read(value: object) -> tuple[Made, ...]:
        if isinstance(value, str | dict | Record) or not isinstance(value, Iterable):
            raise InputError(f"is not a list of {word}s", value=value, remedy=remedy)
        made = tuple(all_made(partial(one, place, item) for place, item in enumerate(value, start=1)))
        if not made and not none:
            raise InputError(f"has no {word}s", value=value, remedy=f"{remedy}; or leave it out")
        return made

    return read


def as_tuple(members: str, remedy: str, none: bool = False) -> Callable[[object], object]:
    """Reads a list as a tuple, whose ``members`` a message names; without any only where ``none`` has a meaning."""

    def read(value: object) -> object:
        if isinstance(value, str | dict) or not isinstance(value, Iterable):
            raise InputError(f"is not a list of {members}", value=value, remedy=remedy)
        found = tuple(value)
        if not found and not none:
            raise InputError(f"has no {members}", value=value, remedy=f"{remedy}; or leave it out")
        return found

    return read


def one_of(words: Iterable[str], problem: str, remedy: str, near: bool = False) -> Callable[[object], object]:
    """Reads one of ``words``, or else says the ``problem``; where ``near``, another word is answered by the nearest."""
    known = tuple(words)

    def read(value: object) -> object:
        if value in known:
            return value
        offered = nearest(value, known) if near and isinstance(value, str) else remedy
        raise InputError(problem, value=value, remedy=offered)

    return read


def by_name(key: str, read: Callable[[object], Any], problem: str, remedy: str) -> Callable[[object], dict[str, Any]]:
    """Reads the table ``key`` of values by the names of elements, each with ``read``; ``problem``: of no table."""

    def one(name: object, value: object) -> tuple[str, Any]:
        try:
            return str(name), read(value)
        except InputError as error:
            raise error.but(key=f"{key}.{name}", value=value) from None

    def table(value: object) -> dict[str, Any]:
        if not isinstance(value, dict):
            raise InputError(problem, value=value, remedy=remedy)
        return dict(all_made(partial(one, name, item) for name, item in value.items()))

    return table

"""What a maker's sheet says of an element, kept beside the element that was made of it."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field, WithJsonSchema

from trunnion.driveline.record import Record, whole_from
from trunnion.errors import InputError

LONGEST = 400
"""Characters of a source, a date or a number as it is printed."""
MOST_LINES = 200


def _one_line(value: object) -> object:
    if not isinstance(value, str) or not value.strip() or len(value) > LONGEST or not value.isprintable():
        remedy = f"write one line of text, of at most {LONGEST} characters"
        raise InputError("is not a line of text", value=value, remedy=remedy)
    return value.strip()


def _printable(value: object) -> bool:
    return isinstance(value, str | int | float) and not isinstance(value, bool)


def _lines(value: object) -> object:
    """A table of texts and numbers as a sheet prints them."""
    plain = isinstance(value, dict) and len(value) <= MOST_LINES
    if not plain or not all(map(_printable, value.values())):  # type: ignore[attr-defined]
        remedy = 'write "C_Tdyn" = "65 kN m/rad", say, as the sheet prints it'
        raise InputError("is not a table of texts", value=value, remedy=remedy)
    return {str(_one_line(key)): _one_line(str(one)) for key, one in value.items()}  # type: ignore[attr-defined]


_PRINTED = {"type": "object", "additionalProperties": {"type": ["string", "number"]}}


def _numbers(value: object) -> object:
    if not isinstance(value, dict) or len(value) > MOST_LINES:
        raise InputError("is not a table", value=value, remedy="leave it to tn.component, which writes it")
    return dict(value)


Line = Annotated[str, BeforeValidator(_one_line)]


class Sheet(Record):
    """Where the numbers of an element come from: a component of the catalogue, and what was typed from its sheet.

    Parameters
    ----------
    component : "maker/type".
    version : of the entry, from 1.
    source, date : of the sheet: title and page; the day or year it was issued.
    printed : what the sheet prints, in its own symbols and units.
    numbers : what was typed of it into the keys of the element, as typed.
    note : what else one has to know.

    >>> Sheet(component="example/rubber-16", version=1, source="worked example", date="2026", numbers={}).component
    'example/rubber-16'
    """

    what: ClassVar[str] = "sheet"
    example: ClassVar[str] = 'component = "maker/type", say'

    component: Line = Field(description="maker/type")
    version: Annotated[int, BeforeValidator(whole_from(1, None, example=2))] = Field(
        default=1, ge=1, description="of the entry"
    )
    source: Line = Field(description="of the sheet: title and page")
    date: Line = Field(description="day or year of the sheet")
    printed: Annotated[dict[str, str], BeforeValidator(_lines), WithJsonSchema(_PRINTED)] = Field(
        default={}, description="as the sheet prints it"
    )
    numbers: Annotated[dict[str, Any], BeforeValidator(_numbers)] = Field(
        default={}, description="what was typed of it into the keys of the element"
    )
    note: Line | None = Field(default=None, description="what else one has to know")

    def __hash__(self) -> int:
        return hash((self.component, self.version))

    @property
    def words(self) -> str:
        """Component, source and date in one phrase."""
        return f"{self.component} (version {self.version}), {self.source}, {self.date}"

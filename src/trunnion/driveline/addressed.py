"""What is stated of one element by its name, of all of a kind or of a pattern of names: limits, tolerances."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, TypeVar

from pydantic import Field

from trunnion.driveline.elements import Element
from trunnion.driveline.patterns import closeness, kind_in, names
from trunnion.driveline.record import Record
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError

Elements = Sequence[tuple[str, Element]]
"""Elements of a line with their names."""
Where = dict[str, Any]
"""Element, key and value of a complaint."""


class Addressed(Record):
    """Base of what is stated ``of`` one element, of all of a kind or of all whose names fit a pattern."""

    of: str = Field(description='name of the element, "Shaft *" for each of a kind, "half shaft *" for names')

    @classmethod
    def called(cls, data: dict[str, Any]) -> str:
        """What it is, and of what."""
        return f"{cls.what} of {data['of']}" if isinstance(data.get("of"), str) else cls.what

    def concerns(self, name: str, element: Element) -> bool:
        """Whether it is stated of an element, its kind or a pattern that its name fits."""
        return names(self.of, name, element.kind)

    @property
    def shown(self) -> dict[str, object]:
        """What it states by key, as a file does."""
        return {}

    def wrong_for(self, key: str, concerned: Elements, where: Where) -> Iterator[InputError]:
        """What is wrong with one key of it for the elements ``concerned``."""
        yield from ()


Stated = TypeVar("Stated", bound=Addressed)


def in_turn(stated: Sequence[Stated], parts: Elements) -> Iterator[tuple[Stated, str, Element]]:
    """Each with every element that it concerns; what is stated most closely last, so that it stays."""
    for one in sorted(stated, key=lambda one: closeness(one.of)):
        for name, element in parts:
            if one.concerns(name, element):
                yield one, name, element


def wrong_addresses(stated: Sequence[Addressed], parts: Elements) -> Iterator[InputError]:
    """What is stated of no element, twice, or of elements that cannot have it."""
    seen: set[tuple[str, str]] = set()
    for one in stated:
        concerned = [(name, element) for name, element in parts if one.concerns(name, element)]
        if not concerned:
            known = [*(name for name, _ in parts), *(f"{kind} *" for kind in dict.fromkeys(e.kind for _, e in parts))]
            problem = "has no element in this driveline" if kind_in(one.of) else "is not an element"
            yield InputError(problem, element=one.what, key="of", value=one.of, remedy=nearest(one.of, known))
            continue
        for key, value in one.shown.items():
            where: Where = {"element": f"{one.what} of {one.of}", "key": key, "value": value}
            if (one.of, key) in seen:
                yield InputError("is stated twice", **where, remedy="leave one of the two out")
            seen.add((one.of, key))
            yield from one.wrong_for(key, concerned, where)

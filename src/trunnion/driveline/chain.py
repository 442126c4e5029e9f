"""Elements in order, each hanging on the one before it or on the one it names; what they are called."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cached_property, partial
from typing import Any

from pydantic import SerializeAsAny

from trunnion.driveline.composite import StatedChain, default_names, expanded, stated
from trunnion.driveline.elements import ConstantSpeed, Element
from trunnion.driveline.parts import Dragged, Jointed, Sprung
from trunnion.driveline.quantities import Dimensionless, Frequency
from trunnion.driveline.record import Name, Record
from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError, problems_of

MOST_ELEMENTS = 5000
"""Ten times the longest line of practice."""
HOURS = 0.006
"""What the stability of a chain of 2000 elements takes at one speed."""


class ElementChain(Record):
    """What the elements of a driveline are without where it runs and what it bears: see ``Driveline``."""

    elements: tuple[SerializeAsAny[Element], ...]
    name: Name | None = None
    description: str | None = None
    damping_ratio: Dimensionless | None = None
    damping_ratio_frequency: Frequency | None = None

    @cached_property
    def default_names(self) -> tuple[str, ...]:
        """Names that elements have when the user gives none: the kind and its ordinal among all of that kind. What is
        part of an engine has its own."""
        return default_names(self.elements)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Name of every element: as given, or its kind and its ordinal among all of that kind ("Shaft 2")."""
        return tuple(one.name or usual for one, usual in zip(self.elements, self.default_names, strict=True))

    @cached_property
    def parents(self) -> tuple[int | None, ...]:
        """Index of the element each one follows: the one named in ``after``, or the previous; first None."""
        return tuple(_parent(self, i)[0] for i in range(len(self.elements)))

    @cached_property
    def hangs_on(self) -> tuple[int, ...]:
        """Coordinate among the ``parts`` of the element each one follows; −1 is the last."""
        return tuple(_parent(self, i)[1] for i in range(len(self.elements)))

    def index(self, name: str) -> int:
        """Place of the element called `name`; InputError with the nearest name where there is none."""
        try:
            return self.names.index(name)
        except ValueError:
            raise InputError(
                "is not an element of this driveline", key=str(name), remedy=nearest(str(name), self.names)
            ) from None

    def spring_name(self, elements: Iterable[int], number: int = 0) -> str:
        """Name of the spring, of one element its ``number``, or of several in series."""
        return " + ".join(f"{self.elements[i].springs[number]} {self.names[i]}".lstrip() for i in elements)

    @cached_property
    def parts(self) -> tuple[tuple[str, Element], ...]:
        """Name and element, in order."""
        return tuple(zip(self.names, self.elements, strict=True))

    @cached_property
    def as_stated(self) -> StatedChain:
        """Elements, names and parents as they are written: an engine instead of its throws."""
        return stated(self.elements, self.names, self.parents)


def refuse_too_many(elements: int) -> None:
    """Refuse what would fill the memory and the day before it is looked at.

    Raises
    ------
    InputError : more than ``MOST_ELEMENTS``.
    """
    if elements > MOST_ELEMENTS:
        # Of a chain of disks and shafts, with about twenty matrices of its states at a time.
        memory, hours = 20 * 8 * elements**2 / 1e9, HOURS * (elements / 2000) ** 3
        raise InputError(
            f"has {elements} elements, at most {MOST_ELEMENTS} are taken; "
            f"stability would need {memory:.3g} GB and {hours:.2g} h",
            element="driveline",
            remedy="join neighbouring parts",
        )


def checked(elements: Iterable[Element]) -> tuple[Element, ...]:
    """The elements of a line, an engine as its throws.

    Raises
    ------
    InputError : no list, none, too many, or something else among them.
    """
    remedy = "write tn.Driveline([tn.ConstantSpeed(), tn.Shaft(...), tn.Disk(...)])"
    if isinstance(elements, Element) or not isinstance(elements, Iterable):
        raise InputError(f"must be a list, not of type {type(elements).__name__}", key="elements", remedy=remedy)
    found = tuple(elements)
    if not found:
        raise InputError("has no elements", element="driveline", remedy=remedy)
    refuse_too_many(len(found))
    wrong = [
        InputError("is not an element", element=f"element {i}", value=element, remedy=remedy)
        for i, element in enumerate(found, start=1)
        if not isinstance(element, Element)
    ]
    if wrong:
        raise InputError.together(wrong)
    whole = expanded(found)
    refuse_too_many(len(whole))
    return whole


def wrong_places(line: ElementChain) -> Iterator[InputError]:
    """Names twice, branches from nowhere, drives in mid-line."""
    wrong = [*_wrong_names(line.names), *problems_of(partial(_parent, line, i) for i in range(len(line.elements)))]
    wrong += list(_wrong_loops(line))
    yield from wrong
    if not wrong:
        yield from _wrong_ends(line)


def _wrong_names(names: tuple[str, ...]) -> Iterator[InputError]:
    for name, count in Counter(names).items():
        if count > 1:
            places = [str(i) for i, n in enumerate(names, start=1) if n == name]
            some = f"{', '.join(places[:3])} and {count - 3} more" if count > 4 else " and ".join(places)
            yield InputError(f"names elements {some}", element=name, key="name", remedy="rename one of them")


def _wrong_loops(line: ElementChain) -> Iterator[InputError]:
    for i, (name, element) in enumerate(line.parts):
        to = getattr(element, "to", None)
        if to is not None and to not in line.names[:i]:
            remedy = nearest(to, line.names[:i])
            yield InputError("is not an earlier element", element=name, key="to", value=to, remedy=remedy)


def _parent(line: ElementChain, place: int) -> tuple[int | None, int]:
    """The element that one follows, and the coordinate there; −1 is the last."""
    after, name = line.elements[place].after, line.names[place]
    if after is None:
        return (place - 1, line.elements[place - 1].onward) if place else (None, -1)
    owner, _, port = after.rpartition(".")
    if after not in line.names and owner in line.names[:place]:
        ports = line.elements[line.names.index(owner)].ports
        if port not in ports:
            offered = nearest(port, [f"{owner}.{one}" for one in ports]) if ports else f"write {owner} alone"
            raise InputError("names no shaft", element=name, key="after", value=after, remedy=offered)
        return line.names.index(owner), ports[port]
    where: dict[str, Any] = {"element": name, "key": "after", "value": after}
    if after not in line.names[:place]:
        if after in line.names:
            raise InputError("does not come earlier", **where, remedy=f"move {name} behind {after}")
        raise InputError("is not an earlier element", **where, remedy=nearest(after, line.names[:place]))
    parent = line.names.index(after)
    if any(isinstance(part, Jointed | Sprung | Dragged) for part in line.elements[parent].passes_on):
        remedy = "branches leave from a Disk, a ConstantSpeed or gears; put a Disk there"
        raise InputError(f"is a {line.elements[parent].kind}", **where, remedy=remedy)
    return parent, line.elements[parent].onward


def _wrong_ends(line: ElementChain) -> Iterator[InputError]:
    """A prescribed rotation in mid-line would cut it into two independent ones."""
    for i, element in enumerate(line.elements):
        if isinstance(element, ConstantSpeed) and i > 0 and i in line.parents:
            follower = line.names[line.parents.index(i)]
            remedy = f"make it the first or the last of its branch, or hang {follower} elsewhere with after"
            yield InputError("stands in the middle of the line", element=line.names[i], remedy=remedy)

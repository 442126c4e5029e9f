"""Elements that stand for several: an engine is the throws of its crank and the shafts between them.

A driveline keeps both. Its ``elements`` are the simple ones, which every analysis walks along and which parameters,
limits and tolerances name ("engine.throw 3.inertia"); its ``as_stated`` has the composite as it was written, for files,
tables and sketches. Simple elements bear a mark of the composite that they are part of. Where numbers of them change,
the composite takes them over if it can state them; else it dissolves into its parts, which keep their names.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby
from typing import Self

from trunnion.driveline.elements import Element
from trunnion.driveline.parts import Part


class Composite(Element):
    """Base of elements that stand for several in a row, of which each hangs on the one before it."""

    def made_of(self, name: str) -> tuple[Element, ...]:
        """The elements that it stands for, named "NAME.throw 1" where ``name`` is its own."""
        raise NotImplementedError

    def refitted(self, name: str, elements: Sequence[Element]) -> Self | None:
        """The same with the numbers of ``elements``, which are as many as it stands for; None where it cannot."""
        return None

    def parts(self) -> tuple[Part, ...]:
        """Of all that it stands for, one after the other; coordinates count from each shaft in front."""
        return tuple(part for element in self.made_of(self.name or self.kind) for part in element.parts())


@dataclass(frozen=True)
class StatedChain:
    """Elements as they are written, their names and parents."""

    elements: tuple[Element, ...]
    names: tuple[str, ...]
    parents: tuple[int | None, ...]

    @property
    def parts(self) -> tuple[tuple[str, Element], ...]:
        """Name and element, in order."""
        return tuple(zip(self.names, self.elements, strict=True))

    def index(self, name: str) -> int:
        """Place of the element called ``name``, or of the one that it is part of."""
        if name in self.names:
            return self.names.index(name)
        parts = enumerate(self.parts)
        return next(i for i, (own, e) in parts if isinstance(e, Composite) and name.startswith(f"{own}."))


def owners(parts: Iterable[tuple[str, Element]], names: Iterable[str]) -> tuple[str, ...]:
    """What ``names`` of ``parts`` are called in the file: of a composite's, the composite once."""
    owned = {name: one.part_of for name, one in parts}
    return tuple(dict.fromkeys(str(owned[name][0]) if owned.get(name) else name for name in names))


def default_names(elements: Sequence[Element]) -> tuple[str, ...]:
    """Kind and ordinal among all of that kind; what is part of a composite has its own name and does not count."""
    seen: Counter[str] = Counter()
    names = []
    for element in elements:
        if element.part_of is not None:
            names.append(str(element.name))
            continue
        seen[element.kind] += 1
        names.append(f"{element.kind} {seen[element.kind]}")
    return tuple(names)


def expanded(elements: tuple[Element, ...]) -> tuple[Element, ...]:
    """Composites as what they stand for; what hangs on one hangs on its last element."""
    if not any(isinstance(one, Composite) or one.part_of is not None for one in elements):
        return elements
    folded = _folded(elements)
    ends: dict[str, str] = {}
    found: list[Element] = []
    for name, one in zip(_names(folded), folded, strict=True):
        if one.after in ends:
            one = one.but(after=ends[one.after])
        if getattr(one, "to", None) in ends:
            one = one.but(to=ends[one.to])  # type: ignore[attr-defined]
        if isinstance(one, Composite):
            members = _made(one, name)
            ends[name] = str(members[-1].name)
            found += members
        else:
            found.append(one)
    return tuple(found)


def stated(elements: Sequence[Element], names: Sequence[str], parents: Sequence[int | None]) -> StatedChain:
    """The elements of a line with its composites as they are written."""
    whole: list[tuple[str, Element]] = []
    owner: list[int] = []
    for mark, run in _runs(elements):
        if mark is None:
            whole += [(names[len(owner) + i], one) for i, one in enumerate(run)]
            owner += range(len(whole) - len(run), len(whole))
        else:
            whole.append(mark)
            owner += [len(whole) - 1] * len(run)
    first = {place: i for i, place in reversed([*enumerate(owner)])}
    above = [parents[first[place]] for place in range(len(whole))]
    own = tuple(None if one is None else owner[one] for one in above)
    return StatedChain(tuple(one for _, one in whole), tuple(name for name, _ in whole), own)


Mark = tuple[str, Composite]
"""Name and composite that an element is part of."""


def _runs(elements: Sequence[Element]) -> Iterator[tuple[Mark | None, list[Element]]]:
    """Elements in a row that are part of one composite, or of none."""
    for mark, run in groupby(elements, key=lambda one: one.part_of):
        yield mark, list(run)


def _folded(elements: tuple[Element, ...]) -> tuple[Element, ...]:
    """Composites in place of their parts; one whose parts it cannot state any more leaves them by themselves."""
    found: list[Element] = []
    named = iter(_names(elements))
    names: list[str] = []
    dissolved = False
    for mark, run in _runs(elements):
        own = [next(named) for _ in run]
        whole = None if mark is None else _whole(*mark, run)
        if mark is None:
            found, names = found + run, names + own
        elif whole is not None:
            found, names = [*found, whole], [*names, mark[0]]
        else:
            found, names, dissolved = found + [_alone(one) for one in run], names + own, True
    if dissolved:  # the parts count among their kind from now on, which would rename those behind them
        found = [one if one.name else one.but(name=name) for one, name in zip(found, names, strict=True)]
    return tuple(found)


def _names(elements: Sequence[Element]) -> tuple[str, ...]:
    return tuple(one.name or usual for one, usual in zip(elements, default_names(elements), strict=True))


def _whole(name: str, composite: Composite, run: list[Element]) -> Composite | None:
    expected = _made(composite, name)
    if len(run) != len(expected) or [one.name for one in run] != [one.name for one in expected]:
        return None
    if all(one is usual or one == usual for one, usual in zip(run, expected, strict=True)):
        return composite
    return composite.refitted(name, run)


def _alone(element: Element) -> Element:
    return type(element)(**element.stated)


@lru_cache(maxsize=64)
def _made(composite: Composite, name: str) -> tuple[Element, ...]:
    return tuple(one.as_part_of(name, composite) for one in composite.made_of(name))

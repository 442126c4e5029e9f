"""What a result holds is said once, at its fields: over which axes, in which unit and words.

    @labelled
    class Torques(Result):
        speed: Array = coordinate("speed", "rad/s", "of the input")
        torque: Array = variable("speed spring", "N*m", "half peak to peak")
        springs: tuple[str, ...] = coordinate("spring")
        line: Driveline = internal("that was swept")

        @property
        @computed(variable("speed", "1", "1 where the amplitudes can be trusted"))
        def linear(self) -> Flags: ...

``declared`` turns them into variables, coordinates and attributes, of which dataset, dictionary and JSON are made.
Units and words may name what else the result has: "{self.unit}", "largest stable {self.parameter}".
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import Field, dataclass, field, fields, replace
from operator import attrgetter
from typing import Any, TypeVar, cast, dataclass_transform

import numpy as np

from trunnion.results.variables import Attribute, Coordinate, Variable, as_stored

LABEL = "label"
"""Key of the metadata of a field, and attribute of a function behind a property."""
T = TypeVar("T")
F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class FieldLabel:
    """What a field or a computed value is: a ``kind`` of value, or of its ``members`` each; None for what only the
    package uses."""

    kind: type[Variable] | type[Attribute] | None
    axes: str = ""
    unit: str = ""
    words: str = ""
    name: str = ""
    more: Mapping[str, Any] = field(default_factory=dict)
    members: type | None = None
    only: str = ""
    after: str = ""

    def of(self, owner: object, name: str, values: Any) -> Variable | Attribute:
        """``values`` of the field ``name``; ``owner`` has what unit and words name."""
        if self.kind is Attribute:
            return Attribute(self.name or name, values.tolist() if isinstance(values, np.ndarray) else values)
        assert self.kind is not None and issubclass(self.kind, Variable)
        unit, words = self.unit.format(self=owner), self.words.format(self=owner)
        return self.kind(self.name or name, values, self.axes, unit, words, self.more)

    @property
    def shown(self) -> str:
        """Axes, unit and words, for a docstring."""
        axes = f"({', '.join(self.axes.split())}{'' if ' ' in self.axes else ','})" if self.axes else ""
        unit = f"[{self.unit}]" if self.unit and "{" not in self.unit else ""
        return " ".join(part for part in (axes, unit, self.words) if part)


def coordinate(axis: str, unit: str = "", words: str = "", *, name: str = "", **given: Any) -> Any:
    """A field that labels an axis, under the name of the axis or another ``name``; ``given`` as of ``field``."""
    return _field(FieldLabel(Coordinate, axis, unit, words, name or axis), given)


def variable(axes: str = "", unit: str = "", words: str = "", *, name: str = "", more: Any = None, **given: Any) -> Any:
    """A field of values over axes; ``more`` as of ``Variable``."""
    return _field(FieldLabel(Variable, axes, unit, words, name, more or {}), given)


def attribute(words: str = "", unit: str = "", *, name: str = "", **given: Any) -> Any:
    """A field that says something about the whole."""
    return _field(FieldLabel(Attribute, "", unit, words, name), given)


def internal(words: str = "", unit: str = "", axes: str = "", **given: Any) -> Any:
    """A field that is in no dataset: what else is computed from, or is said in the text alone."""
    return _field(FieldLabel(None, axes, unit, words), given)


def members(kind: type, axis: str, words: str = "", *, name: str = "", only: str = "", **given: Any) -> Any:
    """A field with several of the labelled class ``kind``, each of whose fields is a variable over ``axis``.

    name : attribute that labels them along the axis, if there is one.
    only : attributes that are declared, in this order; by default all that are labelled.
    """
    return _field(FieldLabel(Variable, axis, "", words, name, {}, kind, only), given)


def computed(stated: Any, after: str = "") -> Callable[[F], F]:
    """Declares what a property computes as a field is: last of the variables, or ``after`` another."""

    def mark(function: F) -> F:
        function.__dict__[LABEL] = replace(stated.metadata[LABEL], after=after)
        return function

    return mark


@dataclass_transform(frozen_default=True, field_specifiers=(coordinate, variable, attribute, internal, members, field))
def labelled(kind: type[T]) -> type[T]:
    """A frozen dataclass whose docstring lists its labelled fields; a result shows itself, others as dataclasses do."""
    made: Any = dataclass(frozen=True, repr=vars(object)["__repr__"] is kind.__repr__)(kind)
    made.__labels__ = _in_order(made)
    rows = [f"{name} : {label.shown}" for name, label in made.__labels__.items() if label.shown]
    made.__doc__ = "\n    ".join([(kind.__doc__ or "").rstrip(), "", "Attributes", "----------", *rows])
    return cast(type[T], made)


def labels(kind: type) -> Mapping[str, FieldLabel]:
    """Labels of a class by the name of the field or property, in the order in which they are declared."""
    return getattr(kind, "__labels__", {})


def _in_order(kind: Any) -> dict[str, FieldLabel]:
    """Fields in their order, then what is computed, but for what goes ``after`` another."""
    found: dict[str, FieldLabel] = {one.name: one.metadata[LABEL] for one in fields(kind) if LABEL in one.metadata}
    for base in reversed(kind.__mro__):
        for name, one in vars(base).items():
            function = getattr(one, "fget", None) or getattr(one, "func", None)
            if label := getattr(function, LABEL, None):
                found[name] = label
    order = [name for name, label in found.items() if not label.after]
    for name, label in reversed(found.items()):
        if label.after:
            order.insert(order.index(label.after) + 1, name)
    return {name: found[name] for name in order}


def declared(one: Any) -> Iterator[Variable | Attribute]:
    """What the labelled fields and properties of a result hold, attributes last."""
    attributes = []
    for name, label in labels(type(one)).items():
        if label.kind is None:
            continue
        values = getattr(one, name)
        if label.members is not None:
            yield from _of_members(one, label, values)
        elif label.kind is Attribute:
            attributes.append(label.of(one, name, as_stored(values)))
        else:
            yield label.of(one, name, as_stored(values))
    yield from attributes


def _of_members(owner: object, label: FieldLabel, every: Iterable[object]) -> Iterator[Variable | Attribute]:
    several, stated = list(every), labels(label.members) if label.members else {}
    if label.name:
        yield Coordinate(label.axes, as_stored([attrgetter(label.name)(one) for one in several]), label.axes)
    every_one = [name for name, one in stated.items() if one.kind is not None and name != label.name]
    for path in label.only.split() or every_one:
        own = stated.get(path, FieldLabel(Variable))
        values = as_stored([attrgetter(path)(one) for one in several])
        yield replace(own, axes=label.axes).of(owner, path.rpartition(".")[2], values)


def _field(label: FieldLabel, given: dict[str, Any]) -> Any:
    made: Field[Any] = field(metadata={LABEL: label}, **given)
    return made

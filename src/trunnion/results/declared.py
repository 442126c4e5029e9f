"""Results declare their numbers once; dataset, dictionary and notebook display follow from that.

A result says in ``declared`` what it holds: values on named axes with their units, and remarks that concern the
whole. It prints as a paragraph (``str``), shows itself in a console as its first line, and in a notebook as that
paragraph above its dataset.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.portable import Portable
from trunnion.results.finding import Finding
from trunnion.results.outcome import Outcome
from trunnion.results.plain import plain

if TYPE_CHECKING:
    import xarray as xr

    from trunnion.systems.system import System

PARTS = ("real", "imaginary")


@dataclass(frozen=True)
class Held:
    """One thing a result holds: values over ``axes`` (no axis for one number), or a remark (``axes`` None)."""

    name: str
    values: Any
    axes: tuple[str, ...] | None
    attributes: Mapping[str, Any]
    coordinate: bool = False


def axis(name: str, values: Any, unit: str = "", about: str = "") -> Held:
    """The values along an axis: numbers with a unit, or names."""
    return Held(name, values, (name,), _attributes(unit, about), coordinate=True)


def along(axis: str, name: str, values: Any, unit: str = "", about: str = "") -> Held:
    """A second labelling of an axis, such as the orders of ``order_number``."""
    return Held(name, values, (axis,), _attributes(unit, about), coordinate=True)


def over(axes: str, name: str, values: Any, unit: str = "", about: str = "", **more: Any) -> Held:
    """Values over ``axes`` (names with blanks between; "" for one number); complex ones as two parts.

    ``more`` are further attributes of the variable, such as flag meanings.
    """
    return Held(name, values, tuple(axes.split()), _attributes(unit, about) | more)


def fields_over(axes: str, result: object, **units: str) -> Iterator[Held]:
    """Attributes of a result over ``axes``, under their own names, each with its unit ("" for none)."""
    for name, unit in units.items():
        yield over(axes, name, getattr(result, name), unit)


def members_over(axes: str, members: Iterable[object], about: str = "", **units: str) -> Iterator[Held]:
    """The same attributes of every one of ``members``, one along ``axes`` each, under their own names."""
    several = list(members)
    for name, unit in units.items():
        yield over(axes, name, [getattr(one, name) for one in several], unit, about)


def remark(name: str, value: object) -> Held:
    """Something about the whole: an attribute of the dataset."""
    return Held(name, value, None, {})


def remarks_of(result: object, *names: str) -> Iterator[Held]:
    """Attributes of a result as remarks, under their own names."""
    for name in names:
        yield remark(name, getattr(result, name))


def remarks(**values: object) -> Iterator[Held]:
    """Several remarks by name."""
    for name, value in values.items():
        yield remark(name, value)


def ending(outcome: Outcome) -> Iterator[Held]:
    """How the computation ended."""
    yield from remarks(outcome=outcome.kind, outcome_sentence=outcome.sentence)


def parameters_of(system: System) -> Iterator[Held]:
    """The parameters a system stood at."""
    for name, value in system.parameters.items():
        yield remark(f"parameter {name}", value)


def about(system: System, outcome: Outcome, **remarks: object) -> Iterator[Held]:
    """What a result on a system says of the whole: the system, ``remarks``, how it ended, the parameters."""
    yield remark("system", system.name)
    for name, value in remarks.items():
        yield remark(name, value)
    yield from ending(outcome)
    yield from parameters_of(system)


class Result(Portable, ABC):
    """Base of what analyses return; a subclass writes ``declared`` and its words, ``__str__`` or ``Described``."""

    @abstractmethod
    def declared(self) -> Iterator[Held]:
        """What the result holds, axes first."""

    @property
    def data(self) -> xr.Dataset:
        """Labelled dataset with units; complex numbers as real and imaginary parts."""
        import xarray as xr

        held = list(self.declared())
        variables = {h.name: _variable(h) for h in held if h.axes is not None and not h.coordinate}
        coordinates = {h.name: (h.axes, _array(h.values), dict(h.attributes)) for h in held if h.coordinate}
        if any("part" in axes for axes, _, _ in variables.values()):
            coordinates["part"] = (("part",), np.array(PARTS), {})
        attributes = {h.name: h.values for h in held if h.axes is None and h.values is not None}
        return xr.Dataset(variables, coords=coordinates, attrs=attributes)

    def to_dict(self) -> dict[str, Any]:
        """The same as plain lists, numbers and text, ready for JSON; what is not finite is None."""
        return {h.name: plain(h.values) for h in self.declared()}

    def to_json(self) -> str:
        """``to_dict`` as JSON text."""
        return json.dumps(self.to_dict(), indent=2, allow_nan=False)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {str(self).strip().splitlines()[0].rstrip(':')}>"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>{self.data._repr_html_()}"


class Described(Result):
    """A result whose words name speeds: in the unit of the line's description, or in another that is asked for."""

    @abstractmethod
    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""

    def __str__(self) -> str:
        return self.describe()


class Judged(Described):
    """One whose findings name speeds too."""

    unit: str

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first; speeds in the unit of the line's description."""
        return self.findings_in(self.unit)

    @abstractmethod
    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, gravest first, speeds in ``unit``."""


def _attributes(unit: str, about: str) -> dict[str, Any]:
    return ({"units": unit} if unit else {}) | ({"long_name": about} if about else {})


def _variable(held: Held) -> tuple[tuple[str, ...], Any, dict[str, Any]]:
    values, axes = _array(held.values), held.axes or ()
    if np.iscomplexobj(values):
        return (*axes, "part"), np.stack([values.real, values.imag], axis=-1), dict(held.attributes)
    return axes, values, dict(held.attributes)


def _array(values: Any) -> Any:
    values = values if isinstance(values, np.ndarray) else np.array(values)
    return values.astype(str) if values.dtype == object else values

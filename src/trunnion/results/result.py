"""Results introduce themselves, and dataset, dictionary and notebook display follow from their labelled fields.

A result prints as a paragraph (``str``), shows itself in a console as its first line, and in a notebook as that
paragraph above its dataset. What names speeds does so in the unit of the line's description, or in the one asked for.
"""

from __future__ import annotations

import json
from abc import ABC
from collections.abc import Iterable, Iterator
from copy import copy
from html import escape
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from trunnion.live import in_notebook
from trunnion.portable import Portable
from trunnion.results.fields import declared
from trunnion.results.finding import Finding
from trunnion.results.plain import plain
from trunnion.results.speeds import speed_factor
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.results.words import Words

if TYPE_CHECKING:
    import xarray as xr

PARTS = ("real", "imaginary")


class Result(Portable, ABC):
    """Base of what analyses return: ``labelled``, its words in ``_lines`` and, where it finds any, ``findings``."""

    SPEEDS_IN: ClassVar[str] = "unit"
    """Name of the field with the unit that speeds are printed in."""

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the result holds: its labelled fields, then what it computes; a subclass may add to them."""
        return declared(self)

    def _lines(self) -> Iterable[str]:
        """What the result says, line by line; the first says what it is."""
        raise NotImplementedError

    @property
    def _printed(self) -> tuple[Finding, ...]:
        """What stands below these lines: the findings, where there are any."""
        return getattr(self, "findings", ())

    @property
    def words(self) -> Words:
        """What turns the numbers of the result into text."""
        return Words(getattr(self, self.SPEEDS_IN, None))

    def in_unit(self, unit: str | None) -> Self:
        """The same result, its texts and pictures with speeds in ``unit``: "rpm", "Hz" or "rad/s"; None: as it is.

        What was put into words when it was computed, as the reasons of checks are, stays in the unit asked for then.
        """
        if unit is None or unit == self.words.unit:
            return self
        speed_factor(unit)
        made = copy(self)
        vars(made)[self.SPEEDS_IN] = unit
        return made

    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""
        return str(self.in_unit(unit))

    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, gravest first, speeds in ``unit``."""
        return getattr(self.in_unit(unit), "findings", ())

    @property
    def data(self) -> xr.Dataset:
        """Labelled dataset with units; complex numbers as real and imaginary parts."""
        import xarray as xr

        variables, coordinates, attributes = {}, {}, {}
        for one in self.declared():
            if isinstance(one, Coordinate):
                coordinates[one.name] = (one.dims, _array(one.values), one.attributes)
            elif isinstance(one, Variable):
                variables[one.name] = _in_parts(one)
            elif one.values is not None:
                attributes[one.name] = one.values
        if any("part" in axes for axes, _, _ in variables.values()):
            coordinates["part"] = (("part",), np.array(PARTS), {})
        return xr.Dataset(variables, coords=coordinates, attrs=attributes)

    def to_dict(self) -> dict[str, Any]:
        """The same as plain lists, numbers and text, ready for JSON; what is not finite is None."""
        return {one.name: plain(one.values) for one in self.declared()}

    def to_json(self) -> str:
        """``to_dict`` as JSON text."""
        return json.dumps(self.to_dict(), indent=2, allow_nan=False)

    def __str__(self) -> str:
        return "\n".join([*self._lines(), *(f"  {finding}" for finding in self._printed)])

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {str(self).strip().splitlines()[0].rstrip(':')}>"

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        return in_notebook(self)

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>{self.data._repr_html_()}"


def _in_parts(one: Variable) -> tuple[tuple[str, ...], Any, dict[str, Any]]:
    values = _array(one.values)
    if np.iscomplexobj(values):
        return (*one.dims, "part"), np.stack([values.real, values.imag], axis=-1), one.attributes
    return one.dims, values, one.attributes


def _array(values: Any) -> Any:
    values = values if isinstance(values, np.ndarray) else np.array(values)
    return values.astype(str) if values.dtype == object else values

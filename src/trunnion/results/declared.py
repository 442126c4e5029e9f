"""What results of motions declare by hand; it goes once their fields are labelled (``results.fields``)."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from trunnion.results.finding import Finding
from trunnion.results.outcome import Outcome
from trunnion.results.result import Result as Result
from trunnion.results.variables import Attribute, Coordinate, Variable

if TYPE_CHECKING:
    from trunnion.systems.system import System

DatasetItem = Variable | Attribute


def data_coordinate(name: str, values: Any, unit: str = "", about: str = "") -> DatasetItem:
    """The values along an axis: numbers with a unit, or names."""
    return Coordinate(name, values, name, unit, about)


def data_variable(axes: str, name: str, values: Any, unit: str = "", about: str = "", **more: Any) -> DatasetItem:
    """Values over ``axes`` (names with blanks between; "" for one number); complex ones as two parts.

    ``more`` are further attributes of the variable, such as flag meanings.
    """
    return Variable(name, values, axes, unit, about, more)


def data_variables(axes: str, result: object, **units: str) -> Iterator[DatasetItem]:
    """Attributes of a result over ``axes``, under their own names, each with its unit ("" for none)."""
    for name, unit in units.items():
        yield data_variable(axes, name, getattr(result, name), unit)


def data_attribute(name: str, value: object) -> DatasetItem:
    """Something about the whole: an attribute of the dataset."""
    return Attribute(name, value)


def data_attributes(**values: object) -> Iterator[DatasetItem]:
    """Several remarks by name."""
    for name, value in values.items():
        yield data_attribute(name, value)


def ending(outcome: Outcome) -> Iterator[DatasetItem]:
    """How the computation ended."""
    yield from data_attributes(outcome=outcome.kind, outcome_sentence=outcome.sentence)


def parameters_of(system: System) -> Iterator[DatasetItem]:
    """The parameters a system stood at."""
    for name, value in system.parameters.items():
        yield data_attribute(f"parameter {name}", value)


def about(system: System, outcome: Outcome, **remarks: object) -> Iterator[DatasetItem]:
    """What a result on a system says of the whole: the system, ``remarks``, how it ended, the parameters."""
    yield data_attribute("system", system.name)
    for name, value in remarks.items():
        yield data_attribute(name, value)
    yield from ending(outcome)
    yield from parameters_of(system)


class Described(Result):
    """A result whose words name speeds: in the unit of the line's description, or in another that is asked for."""

    @abstractmethod
    def describe(self, unit: str | None = None) -> str:
        """The result in a few lines, speeds in ``unit``, by default that of the line's description."""

    def __str__(self) -> str:
        return self.describe()


class DescribedWithFindings(Described):
    """One whose findings name speeds too."""

    unit: str

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to read first, gravest first; speeds in the unit of the line's description."""
        return self.findings_in(self.unit)

    @abstractmethod
    def findings_in(self, unit: str) -> tuple[Finding, ...]:
        """What to read first, gravest first, speeds in ``unit``."""

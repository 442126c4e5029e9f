"""What results of motions say beside their labelled fields: how they ended, the system, its states by name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from trunnion.arrays import Array
from trunnion.results.outcome import Outcome
from trunnion.results.variables import Attribute, Variable, attributes

if TYPE_CHECKING:
    from trunnion.systems.system import System


def ending(outcome: Outcome) -> Iterator[Attribute]:
    """How the computation ended."""
    return attributes(outcome=outcome.kind, outcome_sentence=outcome.sentence)


def about(system: System, outcome: Outcome) -> Iterator[Attribute]:
    """The system, how the computation ended, and the parameters that the system stood at."""
    yield Attribute("system", system.name)
    yield from ending(outcome)
    yield from (Attribute(f"parameter {name}", value) for name, value in system.parameters.items())


def states(system: System, axes: str, values: Array) -> Iterator[Variable]:
    """Every state under its own name; ``values`` over ``axes`` and the states (…, n)."""
    for i, (name, unit) in enumerate(zip(system.states, system.units, strict=True)):
        yield Variable(name, values[..., i], axes, unit)

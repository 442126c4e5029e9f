"""Parameters as directions in the packed numbers of a line, and the lines that lie beside it along them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import several
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import SPEED, Columns, PackedLine, Parameter
from trunnion.equations.aligned import aligned_matrices, frequencies
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.waiting import keep_time

ANGLES = ("rad",)


@dataclass(frozen=True)
class Direction:
    """One parameter: its label and unit, the value that the line has, and the size that steps are shares of (its own
    size; 1 rad of an angle; where it is zero, what is usual beside the line's other numbers)."""

    label: str
    unit: str
    value: float
    size: float
    columns: Columns

    def but(self, columns: Iterable[int]) -> Direction:
        """The same, leaving some columns alone."""
        kept = np.where(np.isin(self.columns.index, list(columns)), 0.0, self.columns.slope)
        return replace(self, columns=replace(self.columns, slope=kept))

    def times(self, factors: Mapping[int, float]) -> Direction:
        """The same where some columns move by a factor of what they do as described."""
        by = np.array([factors.get(int(column), 1.0) for column in self.columns.index])
        return replace(self, columns=replace(self.columns, slope=self.columns.slope * by))

    def moved(self, table: Array, share: Array | float) -> None:
        """Move the rows of ``table`` (rows, columns) by shares of the size."""
        table[..., self.columns.index] += self.columns.slope * (np.asarray(share) * self.size)[..., None]


def directions_of(assembly: Assembly, parameters: Iterable[str | Parameter] | None = None) -> tuple[Direction, ...]:
    """Directions of parameters, by default of every number that the description states, zeros of angles included.

    Raises
    ------
    InputError : no such parameter; the speed, which belongs to the analysis.
    """
    packed = assembly.packed
    given = (parameters,) if isinstance(parameters, Parameter) else parameters
    every = tuple(_stated(packed)) if given is None else several(given, "parameters", '["Shaft 1.stiffness"], say')
    if not every:
        raise InputError("names no parameter", key="parameters", remedy='parameters=["Shaft 1.stiffness"], say')
    single = [name for one in every for name in (packed.each(one) if isinstance(one, str) else (one,))]
    found = []
    for one in dict.fromkeys(single):
        columns = packed.resolve(one)
        if 0 in columns.index:
            raise InputError(
                "is not a parameter of the line but its speed", key="parameters", value=SPEED, remedy="leave it out"
            )
        found.append(direction(assembly, columns))
    return tuple(found)


def _stated(packed: PackedLine) -> Iterator[str]:
    """Labels of numbers that are not zero, angles, and zeros that somebody wrote down."""
    for (element, key), column in packed.place.items():
        stated = element < 0 or key.partition(" ")[0] in packed.line.elements[element].stated
        if key != SPEED and (packed.values[column] or packed.units[column] in ANGLES or stated):
            yield packed.labels[column]


def direction(assembly: Assembly, columns: Columns, value: float | None = None) -> Direction:
    """The direction of resolved columns; ``value`` where that is not the description's, as of a speed."""
    if value is None:
        first = columns.index[0]
        value = float((assembly.packed.values[first] - columns.offset[0]) / columns.slope[0])
    size = 1.0 if columns.unit in ANGLES else abs(value) or _usual(assembly, columns.unit)
    return Direction(columns.label, columns.unit, value, size, columns)


def _usual(assembly: Assembly, unit: str) -> float:
    """A size for a number of ``unit`` that is zero: the largest of its kind, else one that fits the line's own."""
    packed = assembly.packed
    alike = [abs(v) for v, u in zip(packed.values[1:], packed.units[1:], strict=True) if u == unit and v]
    if alike:
        return max(alike)
    found = assembly.coefficients(assembly.table(1), damped=False, free_play=True, statically_twisted=False)
    stiffness, inertia = float(found.stiffness.max(initial=1.0)), float(found.inertia.max(initial=1.0))
    return {
        "N*m*s/rad": float(np.sqrt(stiffness * inertia)),
        "N*m*s^2/rad^2": inertia,
        "N*m": 1e-3 * stiffness,
        "kg*m^2": inertia,
        "m": 1e-3,
    }.get(unit, 1.0)


def along_each(
    directions: Sequence[Direction],
    look: Callable[[Direction], tuple[Array, Array] | None],
    shape: tuple[int, ...],
    progress: Callable[[float], None] | None = None,
) -> tuple[Array, Array]:
    """Derivatives (…, direction) per unit of every direction and their errors, of what ``look`` finds of ``shape`` per
    share of its size; NaN where it finds none."""
    found = np.full((2, *shape, len(directions)), np.nan)
    for d, one in enumerate(directions):
        both = look(one)
        keep_time()  # what a limit cut short is not a derivative
        if both is not None:
            found[..., d] = np.array(both) / one.size
        if progress:
            progress((d + 1) / len(directions))
    return found[0], found[1]


class Neighbourhood:
    """Rows of numbers beside those of a line, with the frequency at which a common damping ratio holds as each has it.

    assembly: of the line, that frequency written out where the description leaves it to the lowest elastic mode.
    """

    def __init__(self, assembly: Assembly) -> None:
        line = assembly.line
        self.follows = line.damping_ratio is not None and line.damping_ratio_frequency is None
        if self.follows:
            line = line.replace_all({}, damping_ratio_frequency=assembly.damping_reference)
        self.assembly = assemble(line) if self.follows else assembly

    def row(self, speed: float | None = None) -> Array:
        """The line's own numbers (1, columns)."""
        return self.assembly.table(1, speed)

    def rows(self, row: Array, one: Direction, shares: Array, *, follow: bool = True) -> Array:
        """Rows (shares, columns) beside ``row`` along a direction, by shares of its size.

        The frequency of a common damping ratio follows the description's own numbers, moved likewise; not those of
        ``row``, where an axis holds other values, nor at all without ``follow``: along an axis it stays.
        """
        table = np.repeat(row, len(shares), axis=0)
        one.moved(table, shares)
        if self.follows and follow:
            topo, column = self.assembly.topology, self.assembly.packed.column
            own = np.repeat(self.row(), len(shares), axis=0)
            one.moved(own, shares)
            matrices = aligned_matrices(topo, self.assembly.coefficients(own, damped=False))
            table[:, column(-1, "damping_ratio_frequency")] = frequencies(matrices, still=topo.still)[:, topo.still]
        return table


class Neighbours:
    """Changed lines beside one, each checked as one written by hand; None where its elements refuse it."""

    def __init__(self, assembly: Assembly) -> None:
        self.assembly = assembly
        self._known: dict[tuple[str, float], Driveline | None] = {}

    def line(self, one: Direction, share: float) -> Driveline | None:
        """The line moved along a direction by a share of its size."""
        if not share:
            return self.assembly.line
        key = one.label, share
        if key not in self._known:
            row = self.assembly.packed.values[None].copy()
            one.moved(row, share)
            try:
                self._known[key] = self.assembly.packed.line_at(row[0])
            except InputError:
                self._known[key] = None
        return self._known[key]

"""What an element is made of, as the one walk along a line reads it (``trunnion.equations.topology``).

An element hangs on the shaft in front of it, which is its coordinate 0. Its parts come in order; those that make a new
shaft number it on: 1, 2, … Whatever follows in the line hangs on the last one, on the element's ``onward``, or on one
that its ``ports`` name. Parts say what is joined to what; numbers that can vary, stiffness, inertia, a joint's law,
stay with the element.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

Numbers = Callable[[str], Any]
"""The values of an element's number by its key, one or many."""


@dataclass(frozen=True)
class Prescribed:
    """The drive turns coordinate 0, whatever it takes."""


@dataclass(frozen=True)
class Heavy:
    """Something heavy on coordinate ``at``; its moment is the next of the element's ``inertias``.

    ``of``: "end of", say, of what bears no name of its own; ``loaded``: outer torques and excitations act on it.
    """

    at: int = 0
    of: str = ""
    loaded: bool = False


@dataclass(frozen=True)
class Geared:
    """A new shaft that gears tie rigidly to coordinate ``to``, which turns ``ratio`` times as fast."""

    ratio: Fraction
    to: int = 0


@dataclass(frozen=True)
class Jointed:
    """A new shaft behind the element's joint, whose unevenness has ``orders``: none where it passes rotation on
    unchanged, so that equations of rotation need no coordinate for it."""

    orders: tuple[int, ...]
    to: int = 0


@dataclass(frozen=True)
class Sprung:
    """A new shaft that the element's spring joins to coordinate ``to``; where it ``closes`` a loop, no new one, but the
    shaft behind the element of that name, or the element's own coordinate ``at``."""

    to: int = 0
    closes: str | None = None
    at: int | None = None


@dataclass(frozen=True)
class Dragged:
    """A new shaft that a damper without a spring joins to coordinate ``to``, oil or the slip of a tyre, so that nothing
    holds its rotation where it is; where it ``closes`` a loop, the shaft behind the element of that name. Where it
    ``converts``, what it takes on one side is not what it gives on the other."""

    to: int = 0
    closes: str | None = None
    converts: bool = False


@dataclass(frozen=True)
class Loose:
    """A new shaft with a rotation of its own, which on average turns ``speed`` times as fast as coordinate ``to``."""

    to: int = 0
    speed: Fraction = Fraction(1)


@dataclass(frozen=True)
class Tied:
    """A new shaft tied rigidly to several: it turns by the sum of ``share`` times what coordinate ``to`` turns by, over
    all (``to``, ``share``)."""

    of: tuple[tuple[int, Fraction], ...]


Part = Prescribed | Heavy | Geared | Jointed | Sprung | Dragged | Loose | Tied

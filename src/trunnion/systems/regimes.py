"""Regimes of a non-smooth system: in each the right-hand side is smooth; guards say where it changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.errors import InputError
from trunnion.portable import Portable
from trunnion.systems.user_functions import CFunction, guard_function, jump_function, parameter_tuple

SLACK = 1e-6
"""Share of its limit by which rounding may leave a state beyond it."""


class Switch(NamedTuple):
    """In ``regime``, when ``guard`` crosses zero in ``direction`` (+1 rising, −1 falling), go to ``then``.

    Parameters
    ----------
    regime : name of the one that is left.
    guard : name of the switching function.
    direction : +1 where it rises through zero, −1 where it falls.
    then : name of the regime behind.

    >>> Switch("free", "x = 1", +1, "contact").then
    'contact'
    """

    regime: str
    guard: str
    direction: int
    then: str


@dataclass(frozen=True)
class Regimes(Portable):
    """Regimes, the guards between them, and what happens there.

    Parameters
    ----------
    names : of the regimes; the right-hand side f(t, x, p, regime) receives their numbers 0, 1, ….
    guards : names of the switching functions.
    guard : (t, x, p) or (t, x, p, regime) → one number per guard, smooth wherever it is watched; or a
        ``CFunction`` of the guards' signature (see ``numerics.integration.integration_kernel``).
    switches : see ``Switch``.
    locate : (t, x, p) → number of the regime of a state, for starts.
    jump : (t, x, p, guard number) → state behind the guard, for impacts; by default the state is continuous.

    >>> gap = Regimes(
    ...     names=("free", "contact"),
    ...     guards=("x = 1",),
    ...     guard=lambda t, x, p: (x[0] - 1.0,),
    ...     switches=(Switch("free", "x = 1", +1, "contact"), Switch("contact", "x = 1", -1, "free")),
    ...     locate=lambda t, x, p: int(x[0] > 1.0),
    ... )
    """

    names: tuple[str, ...]
    guards: tuple[str, ...]
    guard: Callable[..., Any] | CFunction
    switches: Sequence[Switch]
    locate: Callable[..., int]
    jump: Callable[..., Any] | CFunction | None = None

    def __post_init__(self) -> None:
        for switch in self.switches:
            for key, value, known in (
                ("regime", switch.regime, self.names),
                ("then", switch.then, self.names),
                ("guard", switch.guard, self.guards),
                ("direction", switch.direction, (-1, 1)),
            ):
                if value not in known:
                    remedy = f"write one of {', '.join(map(str, known))}"
                    raise InputError("is unknown", element="Switch", key=key, value=value, remedy=remedy)

    def tables(self) -> tuple[Integers, Integers]:
        """Transitions and directions (regimes, guards), as the integrator takes them."""
        shape = (len(self.names), len(self.guards))
        then, direction = np.full(shape, -1, dtype=np.int64), np.zeros(shape, dtype=np.int64)
        for switch in self.switches:
            place = self.names.index(switch.regime), self.guards.index(switch.guard)
            if then[place] >= 0 and (then[place] != self.names.index(switch.then)):
                raise InputError(
                    "leads to two regimes",
                    element="Switch",
                    key=switch.guard,
                    value=switch.regime,
                    remedy="use two guards",
                )
            both = then[place] >= 0 and direction[place] != switch.direction
            then[place] = self.names.index(switch.then)
            direction[place] = 2 if both else switch.direction
        return then, direction

    @property
    def slider_names(self) -> tuple[str, ...]:
        """Parts with dry friction, whose deflections are the last states of the system."""
        return ()

    def limits(self, numbers: Array) -> Array | None:
        """Largest size (n,) that each state can have, inf where there is none; None where no state has one."""
        return None

    def refusal(self, state: Array, numbers: Array) -> tuple[str, str] | None:
        """What is wrong with a start beyond the limits, and the remedy; None where it lies within."""
        return None

    def stuck(self, regime: Integers, length: Array, most: float) -> Integers:
        """Numbers of the sliders that slip for no more than ``most`` of a motion whose steps were in ``regime`` for
        ``length`` [s], (steps,) each."""
        return np.zeros(0, dtype=np.int64)

    def conserved(self, which: Integers, slopes: Array) -> Array:
        """Gradients (k, n) of what the motion leaves as it was while the sliders ``which`` stick; ``slopes`` (guards,
        n + 1) are those of the guards by states and time."""
        return np.zeros((0, slopes.shape[1] - 1))

    def holding(self, which: Integers, numbers: Array) -> Array:
        """The numbers with which the sliders ``which`` are kept from slipping."""
        return numbers

    def compiled(
        self, size: int, names: tuple[str, ...], scale: tuple[float, ...], *, compiled: bool
    ) -> tuple[CFunction, CFunction | None, Integers, Integers]:
        """Guard and jump as C functions, transitions and directions, of a system of ``size`` states of that scale, its
        parameters ``names``."""
        guard, jump = self.guard, self.jump
        if not isinstance(guard, CFunction):
            guard = guard_function(guard, len(self.guards), size, names, scale, compiled=compiled)
        if not (jump is None or isinstance(jump, CFunction)):
            jump = jump_function(jump, size, names, scale, compiled=compiled)
        return (guard, jump, *self.tables())

    def at(self, time: float, state: Array, parameters: Mapping[str, float], numbers: Array) -> int:
        """Number of the regime of ``state``, as ``locate`` gives it; ``numbers``: what the right-hand side reads."""
        return self.locate(time, state, parameter_tuple(tuple(parameters))(*parameters.values()))

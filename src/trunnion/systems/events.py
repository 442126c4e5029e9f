"""Events: zeros of functions of the state that are located, and may stop an integration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

from trunnion.arrays import Array
from trunnion.errors import InputError
from trunnion.numerics.compiled import kernel_file
from trunnion.numerics.integration.integration import Watch
from trunnion.systems.system import System
from trunnion.systems.user_functions import CFunction, guard_function, takes


@dataclass(frozen=True)
class Event:
    """A zero of ``function`` crossed in ``direction``.

    Parameters
    ----------
    function : (t, x, p) → number; or the name of a state, for the crossing of ``level``.
    level : of the state named.
    direction : +1 rising, −1 falling, 0 both.
    stop : whether the integration ends there.
    name : in results; by default "z = 27" or the function's name.

    >>> Event("z", level=27.0, direction=+1).label
    'z = 27'
    """

    function: Callable[..., Any] | str
    level: float = 0.0
    direction: int = 0
    stop: bool = False
    name: str = ""

    def __post_init__(self) -> None:
        if self.direction not in (-1, 0, 1):
            raise InputError(
                "is not a direction", element="Event", key="direction", value=self.direction,
                remedy="write +1 (rising), -1 (falling) or 0 (both)",
            )  # fmt: skip

    @property
    def label(self) -> str:
        """What results call it."""
        if self.name:
            return self.name
        if isinstance(self.function, str):
            return f"{self.function} = {self.level:g}"
        return str(getattr(self.function, "__name__", "event"))

    def stopping(self) -> Event:
        """The same event, ending the integration."""
        return replace(self, stop=True)


def watch(system: System, events: Sequence[Event]) -> Watch:
    """The events as the integrator takes them.

    Raises
    ------
    InputError : an event that names no state, or a function of the wrong number of arguments.
    """
    if not events:
        return Watch()
    directions = np.array([2 if e.direction == 0 else e.direction for e in events], dtype=np.int64)
    stops = np.array([int(e.stop) for e in events], dtype=np.int64)
    if all(isinstance(e.function, str) for e in events):
        planes = np.zeros((len(events), system.size + 1))
        for row, event in zip(planes, events, strict=True):
            row[_place(system, str(event.function))], row[-1] = 1.0, event.level
        numbers = np.concatenate([[len(events), system.size], planes.ravel()])
        return Watch(_planes().address, numbers, directions, stops)
    assert system.scale is not None
    guard = _functions(
        tuple(e.function if callable(e.function) else (_place(system, e.function), e.level) for e in events),
        system.size,
        tuple(system.parameters),
        tuple(map(float, system.scale)),
    )
    return Watch(guard.address, np.array([*system.parameters.values()], dtype=float), directions, stops)


def _place(system: System, state: str) -> int:
    if state not in system.states:
        raise InputError(
            "is not a state", element=system.name, key="event", value=state,
            remedy=f"states are: {', '.join(system.states)}",
        )  # fmt: skip
    return system.states.index(state)


@cache
def _planes() -> CFunction:
    compiled = kernel_file(str(Path(__file__).with_name("plane_kernel.py"))).planes
    return CFunction(compiled.address, compiled)


@cache
def _functions(functions: tuple[Any, ...], size: int, names: tuple[str, ...], scale: tuple[float, ...]) -> CFunction:
    """Several functions, and states by their place and level, as one; called back where one cannot be compiled."""
    every = [_coordinate(*one) if isinstance(one, tuple) else one for one in functions]
    for one in every:
        takes(one, (3,), "event")
    plain = [getattr(one, "py_func", one) for one in every]

    def called(t: float, x: Array, p: Any) -> list[float]:
        return [one(t, x, p) for one in plain]

    machine = _together([one if hasattr(one, "py_func") else njit(one) for one in every])
    return guard_function(called, len(every), size, names, scale, machine=machine)


def _coordinate(place: int, level: float) -> Callable[..., Any]:
    return lambda t, x, p: x[place] - level


def _together(functions: list[Any]) -> Any:
    """Compiled functions as one of a tuple, link by link: a compiler calls what it knows by name, not from a list."""
    first, *others = functions
    if not others:

        @njit
        def last(t: Any, x: Any, p: Any) -> Any:
            return (first(t, x, p),)

        return last
    rest = _together(others)

    @njit
    def several(t: Any, x: Any, p: Any) -> Any:
        return (first(t, x, p), *rest(t, x, p))

    return several

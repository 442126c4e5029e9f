"""The section of a map where none is asked for, and how far an angle turns once around."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.systems.events import Event
from trunnion.systems.system import System


def usual_section(system: System, states: Array, turning: Array) -> Event:
    """The mean of the state that moves most, rising; where all are angles, the first of them passing whole turns."""
    free = [j for j in range(system.size) if not turning[:, j].any()]
    if not free:
        # An angle that wanders away from its mean for ever passes whole turns again and again.
        turn = turn_of(0, turning)
        angle = system.states[0] if turn == 2 * np.pi else f"{system.states[0]}·2π/{turn:.6g}"
        return Event(_sine_of(0, turn), direction=1, name=f"sin({angle}) = 0")
    j = max(free, key=lambda j: float(np.ptp(states[:, j])) / float(np.asarray(system.scale)[j]))
    return Event(system.states[j], float(np.mean(states[:, j])), direction=1)


def turn_of(place: int, turning: Array) -> float:
    """By how much a state turns once around; 0 of one that does not turn."""
    return float(np.abs(turning[:, place]).max(initial=0.0))


@cache
def _sine_of(place: int, turn: float) -> Callable[..., Any]:
    factor = 2 * np.pi / turn

    def sine(t: float, x: Any, p: Any) -> Any:
        return np.sin(factor * x[place])

    return sine

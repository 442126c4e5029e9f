"""What is watched along a piece of a motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from trunnion.motion.transients.place import Place


class WatchedValue(NamedTuple):
    """One watched value: kind, place, factor, level (since, four powers), direction; whether it ends the piece; what is
    then done, or None for a crossing of the user's, with its label."""

    kind: int
    of: int
    factor: float
    level: tuple[float, ...]
    direction: int
    stops: bool
    act: Callable[[Place], Place] | None
    label: str = ""

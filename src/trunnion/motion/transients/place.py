"""Where a motion stands, and the stretches that it is made of."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.equations.applied_torques import PlacedFriction, PlacedTorque
from trunnion.equations.line_system import LineSystem
from trunnion.numerics.integration.integration import Trajectory
from trunnion.results.outcome import Outcome

LOCATED = -1


@dataclass(frozen=True)
class Place:
    """Where a motion stands.

    time [s]; angle [rad], speed [rad/s] and acceleration [rad/s²] of the rotation that it is observed from; state (2n +
    sliders + lagging,) and regime, ``LOCATED`` where the state tells it; ``senses``: in which way the groups with
    friction turn, by their first station, 0 where they stand; ``lagging``: the disks whose lagging torques are the last
    states.
    """

    time: float
    state: Array
    angle: float = 0.0
    speed: float = 0.0
    acceleration: float = 0.0
    regime: int = LOCATED
    senses: dict[int, float] = field(default_factory=dict)
    lagging: tuple[str, ...] = ()


@dataclass(frozen=True)
class Piece:
    """A stretch without a switch: the steps taken, and the numbers that the right-hand side read."""

    line: LineSystem
    trajectory: Trajectory
    numbers: Array
    torques: tuple[PlacedTorque, ...]
    frictions: tuple[PlacedFriction, ...]

    def regime_at(self, times: Array) -> Integers:
        """In which the line was at times (m,)."""
        run = self.trajectory
        return run.regime[np.minimum(np.searchsorted(run.start[1:], times, side="right"), len(run.regime) - 1)]

    @property
    def acting(self) -> tuple[PlacedTorque | PlacedFriction, ...]:
        """All that acts, in the order of the numbers."""
        return (*self.torques, *self.frictions)


class Found(NamedTuple):
    """What became of a run."""

    pieces: list[Piece]
    place: Place
    outcome: Outcome
    crossed: list[tuple[float, str]]

"""P(x) = x as equations: of one orbit, solved by Newton's method, and of the curve that a branch of orbits is.

Unknown are the state x (n,) and some of the map's values, the last of which a branch moves along. Where a motion may
be shifted in time (nothing prescribes its phase) one value more is unknown, and one equation chooses among the shifted
ones: row · (x − anchor) = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.errors import InputError
from trunnion.numerics.continuation.arclength import CurvePoint, once
from trunnion.numerics.continuation.newton import Root, solve
from trunnion.results.parameter_names import Names
from trunnion.systems.maps import Passage, PeriodMap

M = TypeVar("M", bound=PeriodMap)
C = TypeVar("C", bound="Closing[Any]")
SETTLING = (0, 50, 500)
"""Applications of the map that pass before each attempt at shooting."""


class Phase(NamedTuple):
    """Which of all motions shifted in time is meant: row · (x − anchor) = 0, the row (n,) in units of the states."""

    row: Array
    anchor: Array

    @classmethod
    def held(cls, place: int, value: float, scale: Array) -> Phase:
        """One state held at a value."""
        unit = np.eye(len(scale))[place]
        return cls(unit / scale, unit * value)


@dataclass
class Closing(Generic[M]):
    """The closing of motions of a map as equations in z = (x, values).

    scale (n + unknown values,): size of each unknown that counts as one; tolerance: how well an orbit must close, in
    these units; within: between which an unknown value of one orbit is looked for; over: what a branch lies over; last:
    the last trial motion.
    """

    map: M
    scale: Array
    phase: Phase | None = None
    tolerance: float = 1e-11
    within: tuple[float, float] = (-np.inf, np.inf)
    over: Names = field(default_factory=Names)
    last: Passage | None = None

    @property
    def size(self) -> int:
        """Number of states."""
        return self.map.size

    def place(self, z: Array) -> M:
        """The map at z."""
        return self.map.at(*map(float, z[self.size :])) if len(z) > self.size else self.map

    def equations(self, z: Array) -> tuple[Array, Array]:
        """What is missing to close, and its derivative by z, in units of the scales; NaN where there is no motion."""
        n = self.size
        passage = self._tried(z)
        if passage is None or not passage.done:
            rows = n + (self.phase is not None)
            return np.full(rows, np.nan), np.full((rows, len(z)), np.nan)
        size = self.scale[:n]
        left = (passage.state - z[:n]) / size
        slope = np.empty((n, len(z)))
        slope[:, :n], slope[:, n:] = passage.tangents, passage.by_values
        slope.reshape(-1)[:: len(z) + 1] -= 1  # its diagonal
        slope /= size[:, None]
        if self.phase is not None:
            left = np.append(left, self.phase.row @ (z[:n] - self.phase.anchor))
            slope = np.vstack([slope, np.append(self.phase.row, np.zeros(len(z) - n))])
        return left, slope

    def _tried(self, z: Array) -> Passage | None:
        """The motion at z, kept as the last one tried; None where z is nowhere."""
        if not np.isfinite(z).all():
            return None
        n = self.size
        try:
            self.last = self.place(z)(z[:n], by=range(len(z) - n))
        except InputError:  # a trial value may be no value of this parameter
            return None
        return self.last

    def solve(self, guess: Array) -> Root:
        """The orbit near ``guess`` (n + unknown values,)."""
        n, low, high = self.size, *self.within

        def residual(z: Array) -> tuple[Array, Array]:
            inside = len(z) == n or low < z[n] < high
            left, slope = self.equations(z if inside else np.full_like(z, np.nan))
            return left * self.scale, slope * self.scale[:, None]

        return solve(residual, guess, self.scale, tolerance=self.tolerance)

    @once
    def passage(self, point: CurvePoint) -> Passage:
        """The closed motion at a point of the curve."""
        return self.place(point.z)(point.z[: self.size], watch=True)

    def start(self, point: CurvePoint) -> Array:
        """State at t = 0."""
        return point.z[: self.size]

    def changes(self, point: CurvePoint) -> int:
        """Changes of regime in a period; −1 where the motion cannot be computed."""
        passage = self.passage(point)
        return passage.changes if passage.done else -1

    def multipliers(self, point: CurvePoint) -> Complex:
        """Floquet multipliers by falling modulus; NaN where the motion cannot be computed."""
        passage = self.passage(point)
        return by_modulus(passage.tangents) if passage.done else np.full(self.size, np.nan, dtype=complex)

    def observed(self, point: CurvePoint) -> tuple[Array, Array, Array, float]:
        """See ``branch.Problem``."""
        place = self.place(point.z)
        return (*place.observe(self.start(point), self.passage(point)), place.length)


def close(
    start: Array, make: Callable[[Array], C], values: tuple[float, ...] = (), *, settle: bool = True
) -> tuple[C, Root]:
    """The closing and its root near ``start``, or from where the motion has settled: after each of ``SETTLING``.

    make : guess → its closing; values : guesses of the unknown values.
    """
    closing = make(start)
    root = closing.solve(np.append(start, values))
    for periods in SETTLING[1:] if settle else ():
        if root.converged:
            break
        settled = closing.map.settle(start, periods)
        if settled is None:
            break
        closing = make(settled)
        root = closing.solve(np.append(settled, values))
    return closing, root


def by_modulus(matrix: Array) -> Complex:
    """Eigenvalues by falling modulus."""
    values = np.linalg.eigvals(matrix).astype(complex)
    return np.asarray(values[np.argsort(-np.abs(values), kind="stable")])


def refuse_speed(oscillator: str, speed: float | str | None) -> None:
    """Refuse a speed given beside an oscillator, which has none.

    Raises
    ------
    InputError : a speed is given.
    """
    if speed is not None:
        raise InputError("belongs to a driveline", element=oscillator, key="speed", value=speed, remedy="leave it out")

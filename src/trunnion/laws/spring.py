"""A spring that is linear stage by stage: force (or torque) f = s x + d on every stage, continuous, f(0) = 0.

Knots (…, n) are the rising elongations at which the slope changes, slopes (…, n + 1) those below, between and above
them. Leading axes are cases; elongations and forces broadcast against them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers


@dataclass(frozen=True)
class StageSpring:
    """Knots (…, n) and slopes (…, n + 1)."""

    knots: Array
    slopes: Array

    @cached_property
    def offsets(self) -> Array:
        """d of every stage (…, n + 1)."""
        jumps = -np.diff(self.slopes, axis=-1) * self.knots
        running = np.concatenate([np.zeros((*self.slopes.shape[:-1], 1)), np.cumsum(jumps, axis=-1)], axis=-1)
        return np.asarray(running - self.of(running, self.stage(0.0))[..., None])

    @cached_property
    def at_knots(self) -> Array:
        """Force at every knot (…, n)."""
        return np.asarray(self.slopes[..., :-1] * self.knots + self.offsets[..., :-1])

    def stage(self, x: ArrayLike) -> Integers:
        """The stage of an elongation; at a knot the one below."""
        return _below(self.knots, x)

    def stage_under(self, force: ArrayLike) -> Integers:
        """The stage that carries a force."""
        return _below(self.at_knots, force)

    def of(self, numbers: Array, stage: Integers) -> Array:
        """Those of the stages' numbers (…, n + 1) that belong to ``stage``."""
        if numbers.ndim == 1:
            return np.asarray(numbers[stage])
        cases = np.broadcast_to(numbers, (*stage.shape, numbers.shape[-1]))
        return np.take_along_axis(cases, stage[..., None], axis=-1)[..., 0]

    def force(self, x: ArrayLike) -> Array:
        """f(x)."""
        stage = self.stage(x)
        return np.asarray(self.of(self.slopes, stage) * np.asarray(x, dtype=float) + self.of(self.offsets, stage))

    def slope(self, x: ArrayLike) -> Array:
        """f′(x); at a knot that of the stage below."""
        return self.of(self.slopes, self.stage(x))

    def energy(self, x: Array) -> Array:
        """∫f from 0 to x (times,), of one case."""
        ends = np.concatenate([[-np.inf], self.knots, [np.inf]])
        low, high = np.clip(0.0, ends[:-1], ends[1:]), np.clip(x[:, None], ends[:-1], ends[1:])
        return np.asarray(np.sum(self.slopes * (high**2 - low**2) / 2 + self.offsets * (high - low), axis=1))


def _below(rising: Array, x: ArrayLike) -> Integers:
    """How many of the rising numbers (…, n) are below x."""
    values = np.asarray(x, dtype=float)
    if rising.ndim == 1:
        return np.asarray(np.searchsorted(rising, values))
    return np.asarray(np.sum(rising < values[..., None], axis=-1))

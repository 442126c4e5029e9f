"""Maps made from a flow: the stroboscopic map, the section map, and their derivatives.

A map takes a state to a state, x → P(x), and is a system again: what works on a map (fixed points, multipliers,
orbits, Lyapunov exponents) works on any of these.

    stroboscopic, over one forcing period T:   P(x) = φ(t₀ + T; t₀, x),          DP = Φ
    section {g = 0, in one direction}:         P(x) = φ(τ(x); x),   DP = (I − f ∇gᵀ/ġ) Φ
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trunnion.errors import InputError
from trunnion.numerics.integration.integration import MOST_STEPS, TOLERANCE, End, Trajectory, integrate
from trunnion.numerics.integration.integration import kernel as compiled_core
from trunnion.systems.events import Event, watch
from trunnion.systems.system import System

if TYPE_CHECKING:
    from trunnion.numerics.integration.integration import Watch

Array = NDArray[np.float64]


class Image(NamedTuple):
    """What a map returns: the state (n,), the images of the tangent vectors (k, n), the time it took, how it
    ended (``End.REACHED``, or what went wrong: the state is then NaN), and the trajectory behind it."""

    state: Array
    tangents: Array
    duration: float
    end: End
    trajectory: Trajectory


@dataclass(frozen=True)
class StroboscopicMap:
    """x(t₀) → x(t₀ + periods · T); each application starts at the same phase, so no digits are lost to time.

    Parameters
    ----------
    system : with a forcing period.
    phase : t₀ [s].
    periods : forcing periods per application.
    """

    system: System
    phase: float = 0.0
    periods: int = 1
    tolerance: float = TOLERANCE
    most_steps: int = MOST_STEPS

    def __post_init__(self) -> None:
        if self.system.forcing_period is None:
            raise InputError(
                "is autonomous and has no forcing period",
                element=self.system.name,
                key="period",
                remedy="use a SectionMap, or give the system its period",
            )
        if isinstance(self.periods, bool) or self.periods != int(self.periods) or self.periods < 1:
            raise InputError("must be a whole number from 1", key="periods", value=self.periods)

    @property
    def duration(self) -> float:
        """Time of one application [s]."""
        assert self.system.forcing_period is not None
        return self.periods * self.system.forcing_period

    def apply(self, state: ArrayLike, tangents: ArrayLike | None = None, *, dense: bool = False) -> Image:
        """P(x), and DP·v for each row of ``tangents`` (k, n)."""
        block, regime = _block(self.system, self.phase, state, tangents)
        run = integrate(
            self.system.equations, self.phase, self.phase + self.duration, block,
            regime=regime, tolerance=self.tolerance, most_steps=self.most_steps, dense=dense,
        )  # fmt: skip
        return _image(run, run.final, self.duration, run.end)

    def __call__(self, state: ArrayLike) -> Array:
        return self.apply(state).state

    def jacobian(self, state: ArrayLike) -> Array:
        """DP (n, n)."""
        return self.apply(state, np.eye(self.system.size)).tangents.T


@dataclass(frozen=True)
class SectionMap:
    """From one crossing of a surface to the next in the same direction.

    Parameters
    ----------
    system : any.
    section : the surface, with a direction of +1 or −1.
    longest : time [s] after which the section counts as never crossed; by default 1000 forcing periods, or
        1000 s for an autonomous system.
    """

    system: System
    section: Event
    longest: float | None = None
    tolerance: float = TOLERANCE
    most_steps: int = MOST_STEPS

    def __post_init__(self) -> None:
        if self.section.direction not in (-1, 1):
            raise InputError(
                "must be +1 or −1 on a section", element="Event", key="direction", value=self.section.direction
            )

    @cached_property
    def _watch(self) -> Watch:
        return watch(self.system, (self.section.stopping(),))

    @property
    def limit(self) -> float:
        """Time [s] after which the section counts as never crossed."""
        return self.longest if self.longest is not None else 1000 * (self.system.forcing_period or 1.0)

    def apply(
        self, state: ArrayLike, tangents: ArrayLike | None = None, *, time: float = 0.0, dense: bool = False
    ) -> Image:
        """The next crossing after ``time``, and DP·v for each row of ``tangents``; ``end`` is ``End.STOPPED``
        where there is one and ``End.REACHED`` where there is none within ``longest``."""
        block, regime = _block(self.system, time, state, tangents)
        run = integrate(
            self.system.equations, time, time + self.limit, block, regime=regime,
            tolerance=self.tolerance, most_steps=self.most_steps, watch=self._watch, dense=dense,
        )  # fmt: skip
        if run.end is not End.STOPPED:
            return _image(run, np.full_like(run.final, np.nan), run.time - time, run.end)
        final = run.final.copy()
        rate = self.system.rate_at(run.time, final[0], run.final_regime)
        gradient, by_time = self._gradient(run)
        speed = gradient @ rate + by_time
        final[1:] -= np.outer(final[1:] @ gradient / speed, rate)
        return Image(final[0], final[1:], run.time - time, End.REACHED, run)

    def _gradient(self, run: Trajectory) -> tuple[Array, float]:
        n, g = self.system.size, np.zeros(1)
        slope = np.zeros(n + 1)
        compiled_core().call_guard(
            self._watch.address, run.time, run.final[0].copy(), self._watch.numbers, run.final_regime, g, slope
        )
        return slope[:n], float(slope[n])

    def __call__(self, state: ArrayLike) -> Array:
        return self.apply(state).state

    def jacobian(self, state: ArrayLike) -> Array:
        """DP (n, n), of rank n − 1: its range lies in the surface."""
        return self.apply(state, np.eye(self.system.size)).tangents.T


def _block(system: System, time: float, state: ArrayLike, tangents: ArrayLike | None) -> tuple[Array, int]:
    x = np.asarray(state, dtype=float)
    block = x[None] if tangents is None else np.vstack([x, np.atleast_2d(np.asarray(tangents, dtype=float))])
    return block, system.regime_at(time, x)


def _image(run: Trajectory, final: Array, duration: float, end: End) -> Image:
    if run.end is not End.REACHED:
        final = np.full_like(final, np.nan)
    return Image(final[0], final[1:], duration, end, run)

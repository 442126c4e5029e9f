"""Basins of attraction: which motion of a piecewise linear oscillator is reached from where."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.motion.orbits.exact_map import OscillatorMap
from trunnion.motion.orbits.exact_orbit import PiecewiseOrbit, piecewise_orbit, refuse_unbounded
from trunnion.numerics.memory import require_memory
from trunnion.numerics.workers import Workers, workers_of_client
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import computed, coordinate, internal, labelled, variable
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Variable
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator
from trunnion.waiting import keep_time

LEAST, MOST, SAME = 20, 2000, 1e-9
"""Periods that a start gets at least and at most; change per period that counts as settled."""
ONE_ATTRACTOR = 1e-5
"""Distance below which two settled states belong to one motion."""
A_PART = 64
"""Starts that a worker gets at least."""
BYTES_A_START = 64.0
"""What one start holds."""


@labelled
class Basins(Result):
    """Which motion is reached from where."""

    position: Array = coordinate("position", words="starts of x")
    velocity: Array = coordinate("velocity", words="starts of x′")
    number: Integers = variable("position velocity", "", "number of the attractor, -1 for none", name="attractor")
    attractors: tuple[PiecewiseOrbit, ...] = internal("motions that are reached")

    @property
    @computed(variable("attractor_number", "1", name="share"), after="number")
    def shares(self) -> Array:
        """Share of the starts that each attractor draws (attractors,)."""
        return np.array([np.mean(self.number == i) for i in range(len(self.attractors))])

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, and what every attractor does."""
        yield from super().declared()
        for name, kind in (("peak_to_peak", None), ("mean", None), ("contact", str)):
            values = np.array([getattr(orbit, name) for orbit in self.attractors], dtype=kind)
            yield Variable(name, values, "attractor_number")

    def plot(self, axes: Axes | None = None, *, length: str = "") -> Axes:
        """Map of the starts; see ``pictures.frequency_response``."""
        return drawing(self, "plot")(self, axes, length=length)

    def __str__(self) -> str:
        rows = [
            f"  {share:.1%}: {orbit.peak_to_peak:.6g} peak to peak, mean {orbit.mean:.6g}, contact {orbit.contact}"
            for share, orbit in zip(self.shares, self.attractors, strict=True)
        ]
        left = float(np.mean(self.number < 0))
        rest = [f"  {left:.1%}: no motion of that period within the time"] if left else []
        return "\n".join([f"{len(self.attractors)} attractors from {self.number.size} starts", *rows, *rest])


def basins(
    oscillator: PiecewiseOscillator, position: ArrayLike, velocity: ArrayLike, *, most: int = MOST, client: Any = None
) -> Basins:
    """Basins of attraction at the oscillator's own frequency: where the motions from a grid of starts settle.

    Motions that repeat every forcing period are told apart; the rest (subharmonic, chaotic, unsettled) counts as −1.

    Parameters
    ----------
    oscillator : a ``PiecewiseOscillator``.
    position : starting x (positions,), in its unit of length.
    velocity : starting x′ (velocities,), in that unit per second.
    most : forcing periods that a motion may take to settle.
    client : a ``distributed.Client``, whose workers follow the starts instead, to the same numbers.

    Returns
    -------
    Basins: ``number`` (positions, velocities) of the attractor that each start ends in, and the ``attractors``.

    Raises
    ------
    InputError : an undamped linear resonance; more starts than memory holds.

    Examples
    --------
    >>> import trunnion as tn
    >>> gap = tn.PiecewiseOscillator.gap(half_gap=1.0, damping=0.05, mean_force=0.2, force=0.4, frequency=0.7)
    >>> found = tn.basins(gap, [-2.0, 0.0, 2.0], [-1.0, 1.0])
    >>> found.number.shape, len(found.attractors), found.shares
    ((3, 2), 1, array([1.]))
    """
    refuse_unbounded(oscillator)
    x, v = (np.atleast_1d(np.asarray(a, dtype=float)) for a in (position, velocity))
    require_memory(
        BYTES_A_START * float(len(x)) * len(v),
        key="position, velocity", value=f"{len(x)} x {len(v)}", remedy="ask for fewer starts",
    )  # fmt: skip
    starts = np.ascontiguousarray(np.stack(np.meshgrid(x, v, indexing="ij"), axis=-1).reshape(-1, 2))
    settled = _settled(oscillator, starts, most, workers_of_client(client))
    number = np.full(len(starts), -1, dtype=np.int64)
    found: list[PiecewiseOrbit] = []
    for i in np.flatnonzero(np.isfinite(settled[:, 0])):
        near = [j for j, orbit in enumerate(found) if np.abs(orbit.start - settled[i]).max() < ONE_ATTRACTOR]
        if not near:
            orbit = piecewise_orbit(oscillator, settled[i], settle=False)
            if not orbit.outcome.ok:
                continue
            found.append(orbit)
            near = [len(found) - 1]
        number[i] = near[0]
    return Basins(x, v, number.reshape(len(x), len(v)), tuple(found))


@dataclass(frozen=True)
class _Settling:
    oscillator: PiecewiseOscillator
    most: int

    def of(self, starts: Array) -> Array:
        """Where motions from ``starts`` (m, 2) settle, NaN where they do not."""
        return OscillatorMap.of(self.oscillator).steady_from(starts, LEAST, self.most, SAME)


def _settled(oscillator: PiecewiseOscillator, starts: Array, most: int, workers: Workers | None) -> Array:
    settling = _Settling(oscillator, most)
    if workers is None:
        return settling.of(starts)
    parts = workers.parts(len(starts), A_PART)
    found = workers.all(settling.of, (starts[part.start : part.stop] for part in parts))
    if len(found) < len(parts):
        keep_time()
    return np.concatenate(found)

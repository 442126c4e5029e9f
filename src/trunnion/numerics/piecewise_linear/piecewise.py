"""Exact motion of a piecewise linear oscillator: through any time, and over a period with its derivative."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex, Integers
from trunnion.errors import ComputationError
from trunnion.numerics.compiled import kernel_file

MOST_EVENTS = 4096
"""Rows of the record of one call."""
COLUMNS = (
    "low",
    "high",
    "mean",
    "impacts",
    "energy",
    "impulse",
    "contact",
    "settled",
    "periods",
    "real",
    "imaginary",
    "x",
    "v",
)


class RegimeTables(Protocol):
    """Regimes of a motion; see ``numerics/piecewise_kernel.py``."""

    @property
    def pieces(self) -> Array:
        """(regimes, 3)."""

    @property
    def guards(self) -> Array:
        """(regimes, most, 3)."""

    @property
    def then(self) -> Integers:
        """(regimes, most)."""

    @property
    def side(self) -> Integers:
        """(regimes,)."""


@cache
def kernel() -> ModuleType:
    """The compiled file."""
    return kernel_file(str(Path(__file__).with_name("piecewise_kernel.py")))


@dataclass(frozen=True)
class PiecewiseSegment:
    """A stretch of motion: state (2,) at its end and its regime there, tangents (2, 3) = ∂(x, x′)
    by x₀, x₀′ and ω; events (count, 4): time, x, x′, regime begun (−1: an extremum, where they were asked for)."""

    state: Array
    regime: int
    tangents: Array
    events: Array

    @property
    def crossings(self) -> Array:
        """Events that change the regime, (count, 4)."""
        return self.events[self.events[:, 3] >= 0]


class TooManyEventsError(ComputationError):
    """A motion chatters: its crossings accumulate."""


def move(
    tables: RegimeTables,
    force: Complex,
    frequency: float,
    state: ArrayLike,
    start: float,
    end: float,
    *,
    regime: int | None = None,
    tangents: bool = True,
    extrema: bool = False,
) -> PiecewiseSegment:
    """The motion from time ``start`` to ``end``, exact to rounding.

    Raises
    ------
    TooManyEventsError : more crossings than can be recorded.
    """
    k = kernel()
    x = np.array(state, dtype=float)
    first = int(k.regime_at(x[0], x[1], tables.guards, tables.then)) if regime is None else regime
    w = np.eye(2, 3) if tangents else np.zeros((2, 0))
    record = np.empty((MOST_EVENTS, k.RECORDED))
    last, events, ended = k.advance(
        float(start), float(end), x, first, float(frequency), force, tables.pieces, tables.guards, tables.then,
        w, record, int(extrema), np.zeros(3),
    )  # fmt: skip
    if ended != k.DONE:
        raise TooManyEventsError(
            f"the motion crosses from piece to piece more than {MOST_EVENTS} times between t = {start:g} and {end:g} s "
            f"(the last at {record[max(events - 1, 0), 0]:g} s, x = {x[0]:g}); "
            "ask for less time at once or raise damping"
        )
    return PiecewiseSegment(x, int(last), w, record[:events].copy())


def states(
    tables: RegimeTables,
    force: Complex,
    frequency: float,
    state: ArrayLike,
    times: Array,
    regime: int | None = None,
) -> Array:
    """x and x′ (times, 2) at rising ``times``; ``state`` belongs to the first of them."""
    out = np.empty((len(times), 2))
    out[0] = state
    for i in range(1, len(times)):
        passage = move(tables, force, frequency, out[i - 1], times[i - 1], times[i], regime=regime, tangents=False)
        out[i], regime = passage.state, passage.regime
    return out


def period(tables: RegimeTables, force: Complex, frequency: float, state: Array, periods: int) -> PiecewiseSegment:
    """The motion over ``periods`` forcing periods, its last tangent the derivative by ω of the state after them.

    The time of the end depends on ω as well, and adds the rate there.
    """
    length = 2 * np.pi / frequency
    passage = move(tables, force, frequency, state, 0.0, periods * length)
    x, v = passage.state
    c, s, d = tables.pieces[passage.regime]
    # At phase zero.
    acceleration = float(np.sum(force.real)) - c * v - s * x - d
    w = passage.tangents
    w[:, 2] -= np.array([v, acceleration]) * periods * length / frequency
    return passage


def measure(tables: RegimeTables, force: Complex, frequency: float, state: ArrayLike, periods: int) -> dict[str, float]:
    """What the motion from ``state`` at phase zero does in ``periods`` periods: columns of a row, by name."""
    k = kernel()
    x = np.array(state, dtype=float)
    row = np.zeros(k.ROW)
    regime = k.regime_at(x[0], x[1], tables.guards, tables.then)
    record = np.empty((MOST_EVENTS, k.RECORDED))
    k.measure(
        x, regime, periods, float(frequency), force, tables.pieces, tables.guards, tables.then, tables.side, record, row
    )
    return dict(zip(COLUMNS, row.tolist(), strict=True))

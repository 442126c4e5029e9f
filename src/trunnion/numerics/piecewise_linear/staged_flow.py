"""Motion of springs with stages, to rounding: through any time, and over a period with its derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Complex, Integers
from trunnion.numerics.compiled import kernel_file
from trunnion.waiting import keep_time

MOST_EVENTS = 8192
"""Changes of stage in one call, unless told otherwise."""


@dataclass(frozen=True)
class StagedFlow:
    """q″ = −G f(q, q′) − D q′ + b(t) with its derivatives by one parameter; see ``staged_flow_kernel``.

    inverse (m, m): G; drag (m, m): D; constant (m,), frequencies (waves,), force (waves, m): b = B₀ + Σ Re[B_j
    e^{iω_j t}], and their derivatives constant_slope, frequency_slope, force_slope; pieces (m, stages, 3), guards (m,
    stages, 3, 4), then (m, stages, 3), counts (m,): stages of every spring; moves (m, stages) and source (m,): of
    sliders, see the kernel.
    """

    inverse: Array
    drag: Array
    constant: Array
    frequencies: Array
    force: Complex
    constant_slope: Array
    frequency_slope: Array
    force_slope: Complex
    pieces: Array
    guards: Array
    then: Integers
    counts: Integers
    moves: Array
    source: Integers

    @property
    def size(self) -> int:
        """Number of springs m."""
        return len(self.inverse)

    def torque(self, state: Array, stages: Integers) -> Array:
        """Torques (times, m) of states (times, 2m) in stages (times, m); that of a spring holds that of its sliders."""
        piece = self.pieces[np.arange(self.size), stages]
        m = self.size
        torque = np.asarray(piece[..., 0] * state[..., m:] + piece[..., 1] * state[..., :m] + piece[..., 2])
        for e in np.flatnonzero(self.source != np.arange(m)):
            torque[..., self.source[e]] += torque[..., e]
        return torque


@dataclass(frozen=True)
class StagedSegment:
    """A stretch of motion.

    time reached; state (2m,), its rate (2m,) and stages (m,) there; tangents (2m, 2m), with a last column by the
    parameter where it was asked for; states (times, 2m) and shown_stages (times, m) at the times asked for, NaN and
    −1 beyond the time reached; events (count, 5): time, spring, stage begun, twist rate, rate of the guard; seen (m,
    7 + stages): lowest and highest twist, lowest and highest torque, ∫twist, ∫torque, nearest distance of an extremum
    from an end of its stage, time per stage; ended: 0 at the end asked for, 1 for too many events, 2 where the time
    stands still.
    """

    time: float
    state: Array
    rate: Array
    stages: Integers
    tangents: Array
    states: Array
    shown_stages: Integers
    events: Array
    seen: Array
    ended: int

    @property
    def done(self) -> bool:
        """Whether the end asked for was reached."""
        return self.ended == 0


@cache
def kernel() -> ModuleType:
    """The compiled file."""
    return kernel_file(str(Path(__file__).with_name("staged_flow_kernel.py")))


def stages_of(flow: StagedFlow, state: ArrayLike) -> Integers:
    """The stage of every spring (m,) at a state (2m,)."""
    stages = np.zeros(flow.size, dtype=np.int64)
    kernel().locate(np.array(state, dtype=float), flow.counts, flow.guards, flow.then, stages)
    return stages


def move(
    flow: StagedFlow,
    state: ArrayLike,
    start: float,
    end: float,
    *,
    stages: Integers | None = None,
    times: ArrayLike = (),
    tangents: bool = False,
    by_parameter: bool = False,
    watch: bool = False,
    most_events: int = MOST_EVENTS,
) -> StagedSegment:
    """The motion from ``start`` to ``end``; ``times`` rise within it, ``watch`` fills ``seen``."""
    keep_time()
    k, m = kernel(), flow.size
    z = np.array(state, dtype=float)
    z[m:] = z[m:][flow.source]
    now = stages_of(flow, z) if stages is None else np.array(stages, dtype=np.int64)
    shown = np.ascontiguousarray(np.atleast_1d(np.asarray(times, dtype=float)))
    states, shown_stages = np.full((len(shown), 2 * m), np.nan), np.full((len(shown), m), -1, dtype=np.int64)
    w = np.eye(2 * m + by_parameter, 2 * m) if tangents else np.zeros((0, 2 * m))
    record, rate = np.empty((most_events, k.RECORDED)), np.zeros(m)
    seen = np.zeros((m if watch else 0, k.SHARES + flow.pieces.shape[1]))
    seen[:, [k.LOW, k.TORQUE_LOW, k.CLEARANCE]] = np.inf
    seen[:, [k.HIGH, k.TORQUE_HIGH]] = -np.inf
    time, events, ended = k.advance(
        float(start), float(end), z, now, flow.inverse, flow.drag, flow.constant, flow.frequencies, flow.force,
        flow.constant_slope, flow.frequency_slope, flow.force_slope, flow.pieces, flow.moves, flow.source,
        flow.guards, flow.then, w,
        int(by_parameter and tangents), record, shown, states, shown_stages, seen, rate,
    )  # fmt: skip
    events_found = record[:events].copy()
    gone = flow.moves[np.arange(m), now] * z[m:]
    return StagedSegment(
        time=float(time), state=z, rate=np.append(gone, rate), stages=now, tangents=w.T, states=states,
        shown_stages=shown_stages, events=events_found, seen=seen, ended=int(ended),
    )  # fmt: skip


def period(
    flow: StagedFlow, state: ArrayLike, length: float, length_slope: float = 0.0, *, watch: bool = False
) -> StagedSegment:
    """The motion from time 0 to ``length`` with all its tangents, the last by the parameter, on which ``length`` itself
    depends with ``length_slope``."""
    passage = move(flow, state, 0.0, length, tangents=True, by_parameter=True, watch=watch)
    passage.tangents[:, -1] += passage.rate * length_slope
    return passage

"""Monodromy matrices of many jointed chains (or trees) at once, each with its own error estimate.

Sixteen *lanes*, points of a chart whose motion is about equally fast, are integrated together with common,
error-controlled steps, by Taylor series (plain chains) or the order-8 pair of Dormand and Prince; every lane
has its own stiffness, damping, inertia, joint angles and phases. Unknowns are absolute rotations scaled by √J
and rates are in units of a typical frequency ν, so entries of Z are comparable and one number measures their
error. Half a period suffices where the joints allow (see ``half_period``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.chain_tables import ChainBatch, ChainProgram
from trunnion.numerics.chain.half_period import whole_periods
from trunnion.numerics.chain.long_series import integrate_long_series
from trunnion.numerics.chain.series_driver import integrate_series
from trunnion.numerics.chain.stages_driver import integrate_stages
from trunnion.numerics.threads import on_threads
from trunnion.numerics.workers import Workers, sharing
from trunnion.waiting import keep_time

MOST_STEPS = 200_000
SMALL = 3
"""Unknowns up to which a block of lanes takes less time than starting a thread."""
WORTH_SENDING = 3e6
"""Lanes times the cube of their unknowns from which workers elsewhere take less time than sending takes: 0.1 s."""
_KERNELS: dict[str, Callable[..., Any]] = {
    "series": integrate_series, "long series": integrate_long_series, "stages": integrate_stages
}  # fmt: skip
SHORT = 12
"""Unknowns up to which the coefficients of all columns lie in a processor's cache."""


@dataclass(frozen=True)
class Window:
    """Where the integration starts [rad of input angle], the period, and whether half of it suffices."""

    begin: float
    period: float
    half: bool


def chain_monodromy(
    program: ChainProgram,
    batch: ChainBatch,
    window: Window,
    tolerance: float,
    threads: int = 1,
) -> tuple[Array, Array, Array]:
    """Z (lanes, 2n, 2n) in scaled units, its error estimate (lanes,) and ∫ tr(M⁻¹C) dτ (lanes,).

    The error sums the local errors of the embedded pair, scaled by the norm of Z. A lane whose integration
    fails has NaN. Threads share blocks of lanes; the kernel releases the interpreter lock.
    """
    length = window.period / 2 if window.half else window.period
    asked = tolerance / 4 if window.half else tolerance
    phi, error, trace = chain_propagator(program, batch, window.begin, length, asked, threads)
    return complete(program, batch, window, phi, error, trace, threads)


def chain_propagator(
    program: ChainProgram, batch: ChainBatch, begin: float, length: float, tolerance: float, threads: int = 1
) -> tuple[Array, Array, Array]:
    """The same for any stretch of input angle from ``begin`` on."""
    n, count = batch.stiffness.shape
    found = np.empty((count, 2 * n, 2 * n)), np.empty(count), np.empty(count)
    order, stretch = _alike_together(batch), (begin, length, tolerance, MOST_STEPS)
    series = integrate_series if n <= SHORT else integrate_long_series
    integrate = integrate_stages if has_extra(program, batch) else series

    workers = sharing()
    if workers is not None and count * (2 * n) ** 3 > WORTH_SENDING:
        _on_workers(workers, integrate, program, batch, order, stretch, found)
        return found

    def run(first: int, last: int) -> None:
        integrate(program, batch, order, first, last, *stretch, *found)

    _in_pieces(run, count, threads, BATCH if n > SMALL else 4 * BATCH)
    return found


def complete(
    program: ChainProgram,
    batch: ChainBatch,
    window: Window,
    phi: Array,
    error: Array,
    trace: Array,
    threads: int = 1,
) -> tuple[Array, Array, Array]:
    """Monodromy matrices from propagators over the window's length: over half the period where that suffices."""
    if not window.half:
        return phi, error, trace
    matrix, error = np.empty_like(phi), error.copy()

    def run(first: int, last: int) -> None:
        whole_periods(program, batch, first, last, window.begin, window.period / 2, phi, error, matrix)

    _in_pieces(run, len(phi), threads, 4 * BATCH)
    return matrix, error, 2 * trace


def _alike_together(batch: ChainBatch) -> Places:
    """An order in which lanes of about the same frequency stand together, to a factor of two, and within those, where
    that is not so already, lanes with equal joint angles and phases.

    A block steps as its fastest lane does, so a slow speed beside a fast one would be integrated in needlessly short
    steps. Lanes with equal angles and phases share the joints' laws.
    """
    octave = np.frexp(batch.frequency)[1]
    rows = [*batch.cosine, *batch.phase, *batch.ripple, *batch.ripple_phase]
    moving = [row for row in rows if len(row) > 1 and np.ptp(row) > 0]
    changes = sum(np.count_nonzero(np.diff(row)) for row in moving)
    if changes >= max(1, len(octave) / 4):
        by_joints = np.lexsort((1 / batch.frequency, *moving))
        if sum(np.count_nonzero(np.diff(row[by_joints])) for row in moving) < changes / 4:
            return by_joints[np.argsort(octave[by_joints], kind="stable")]
    return np.argsort(octave, kind="stable")


@dataclass(frozen=True)
class _Stretch:
    """What is integrated of any lanes: the kernel of that name, the line, and stretch, tolerance and most steps."""

    kernel: str
    program: ChainProgram
    stretch: tuple[float, float, float, int]

    def of(self, batch: ChainBatch) -> tuple[Array, Array, Array]:
        """Propagators of lanes as they stand, their errors and traces."""
        # What was sent may not be written to, which the kernels are not compiled for.
        program, own = ChainProgram._make(map(np.array, self.program)), ChainBatch._make(map(np.array, batch))
        n, count = own.stiffness.shape
        found = np.empty((count, 2 * n, 2 * n)), np.empty(count), np.empty(count)
        _KERNELS[self.kernel](program, own, np.arange(count), 0, count, *self.stretch, *found)
        return found


def _on_workers(
    workers: Workers, integrate: Callable[..., Any], program: ChainProgram, batch: ChainBatch, order: Places,
    stretch: tuple[float, float, float, int], found: tuple[Array, Array, Array],
) -> None:  # fmt: skip
    """Blocks of lanes on other machines: the same blocks, and so the same steps, as here.

    Raises
    ------
    OutOfTime : the time was up before all were done.
    """
    name = next(name for name, kernel in _KERNELS.items() if kernel is integrate)
    blocks = workers.parts(-(-len(order) // BATCH))
    parts = [order[one.start * BATCH : one.stop * BATCH] for one in blocks]
    count, left = len(order), len(parts)
    own = ([np.take(row, part, axis=-1) if row.shape[-1] == count else row for row in batch] for part in parts)
    for number, one in workers.each(_Stretch(name, program, stretch).of, map(ChainBatch._make, own)):
        for whole, some in zip(found, one, strict=True):
            whole[parts[number]] = some
        left -= 1
    if left:
        keep_time()


def _in_pieces(run: Callable[[int, int], None], count: int, threads: int, few: int) -> None:
    """Call run(first, last) over blocks of lanes, several pieces per thread: slow lanes stand together, and between
    pieces a time limit is looked at.

    ``few`` lanes are done before other threads have begun.
    """
    if count <= few:
        keep_time()
        run(0, count)
        return
    blocks = -(-count // BATCH)
    edges = np.unique(np.linspace(0, blocks, 8 * max(threads, 1) + 1).astype(int)) * BATCH
    pieces = [(int(a), min(int(b), count)) for a, b in zip(edges[:-1], edges[1:], strict=True)]
    on_threads(lambda piece: run(*piece), pieces, threads)


def has_extra(program: ChainProgram, batch: ChainBatch) -> bool:
    """Whether static torque on an angled joint, angle-dependent inertia or stiffness add terms to the plain chain, or a
    joint has a law of harmonics, which plain chains do not take."""
    behind_joint = program.near_source >= 0
    varying = len(program.member_unknown) or len(program.wave_unknown) or len(program.ripple_order)
    return bool(varying) or bool(np.any(batch.torque[behind_joint]))


def symmetry_phase(program: ChainProgram, batch: ChainBatch, period: float) -> float | None:
    """Input angle about which every joint of every lane is even, or None where there is none.

    A joint is even about the input angles at which its χ is a whole number of quarter turns.
    """
    if has_extra(program, batch):
        return None
    joints = len(program.joint_rate)
    direct = [j for j in range(joints) if program.joint_speed_source[j] < 0]
    if not direct:
        return 0.0
    chained = [j for j in range(joints) if program.joint_speed_source[j] >= 0]
    if any(abs(program.joint_rate[j]) != 1.0 for j in chained) or not _quarter_turns(batch.phase[chained]):
        return None
    first = direct[0]
    for quarter in range(4):
        begin = (quarter * np.pi / 2 - batch.phase[first, 0]) / program.joint_rate[first]
        if all(_quarter_turns(program.joint_rate[j] * begin + batch.phase[j]) for j in direct):
            return float(np.mod(begin, period))
    return None


def _quarter_turns(angle: Array) -> bool:
    turns = angle / (np.pi / 2)
    return bool(np.all(np.abs(turns - np.round(turns)) < 1e-12))

"""Periodic motions of lines with joint angles, at many mean speeds or numbers at once, by the balance of their
harmonics.

    ẍ = a(t, x, ẋ) + T b(t, x, ẋ),    x = a₀ + Σ_k (a_k cos kbΩt + b_k sin kbΩt),    phaseᵀ a₀ = 0

T is the torque of the drives beyond the balance of the loads, which keeps the mean speed; the last equation fixes the
phase. Of a line whose input turns as prescribed neither is there. Newton's steps are taken for all speeds together:
along the tree of a line that is nothing else (``tree_newton``), of any other and of short ones with matrices of all
unknowns, accelerations and their slopes being those of the compiled nonlinear equations at samples of the period.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array, Flags, Places
from trunnion.equations.aligned import rigid_rotation
from trunnion.equations.coefficients import Assembly
from trunnion.equations.given_rotation import GivenRotation
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import LineMatrices, line_matrices, over_mass
from trunnion.equations.loads import drive_places, drive_torques
from trunnion.equations.prepared_line import ANGLE_SCALE
from trunnion.equations.released import placed_pendulums
from trunnion.equations.sliders import sliders
from trunnion.equations.slip_clutches import placed_clutches
from trunnion.equations.steady_base import refuse_dragged
from trunnion.numerics import harmonics as fourier
from trunnion.numerics.continuation.newton import solve_many
from trunnion.numerics.harmonics import solved
from trunnion.numerics.memory import require_estimate
from trunnion.numerics.threads import on_one_thread
from trunnion.results.counts import counted
from trunnion.steady.free import tree_newton
from trunnion.steady.free.tree_newton import TreeMotions, TreeNewton
from trunnion.waiting import keep_time

if TYPE_CHECKING:
    from trunnion.equations.line_system import LineMotion, LineSystem

FEWEST, MOST = 6, 48
"""Harmonics of the period kept."""
CLOSED = 1e-7
"""Correction, in units of ``ANGLE_SCALE``, at which a motion is found."""
NEGLIGIBLE = 1e-10
"""Size of the outermost harmonics [rad] that is small enough."""
CORRECTIONS, MATRICES = 8, 4
"""Newton's steps, and matrices of all unknowns that one takes."""
LONG = 6
"""Unknowns from which on steps along the tree cost less than matrices of all unknowns and compiled slopes: as much at
five, half at eight, a fifth at sixteen, whatever the harmonics."""
MOST_NUMBERS = 4_000_000
"""Numbers of a batch of Newton's matrices."""


@dataclass(frozen=True)
class SteadyStates:
    """Motions at ``value`` (case,), speeds [rad/s] or what else ``balance.rows`` reads: ``found`` (case,), rotations
    ``rows`` (case, n, 2h + 1) [rad] as series of the period, ``torque`` (case,) [N m at the input] that drives beyond
    the balance. ``read`` (case, number): what the compiled equations read, where that is at hand."""

    balance: FreeBalance
    value: Array
    found: Flags
    rows: Array
    torque: Array
    read: Array | None = None

    @cached_property
    def table(self) -> Array:
        """Packed numbers (case, column)."""
        return self.balance.rows(self.value)

    @property
    def speed(self) -> Array:
        """Mean speeds (case,) [rad/s]."""
        return np.asarray(self.table[:, 0])

    @property
    def h(self) -> int:
        """Harmonics kept."""
        return fourier.order(self.rows)

    @property
    def times(self) -> int:
        """Samples of the period that hold the motion and its slopes."""
        return 4 * self.h + 4

    @property
    def tau(self) -> Array:
        """Input angle [rad] of the samples, (time,)."""
        return self.balance.period * np.arange(self.times) / self.times

    @property
    def resolved(self) -> Flags:
        """Whether the outermost harmonics of all rotations are negligible (case,): as many as lie between those that
        the fastest joint makes."""
        h, last = self.h, self.balance.fastest
        size = np.hypot(self.rows[..., h + 1 - last : h + 1], self.rows[..., 2 * h + 1 - last :])
        return np.asarray(size.max(axis=(1, 2)) <= 2 * NEGLIGIBLE)

    @property
    def rate(self) -> Array:
        """bΩ [rad/s], (case,)."""
        return 2 * np.pi * self.speed / self.balance.period

    @cached_property
    def coefficients(self) -> LineCoefficients:
        """Of the lines, about zero twist."""
        return self.balance.assembly.untwisted(self.table)

    @cached_property
    def numbers(self) -> Array:
        """What the compiled equations read (case, number), without the torque that drives beyond the balance."""
        return self.balance.numbers(self.table, self.coefficients) if self.read is None else self.read

    @property
    def states(self) -> Array:
        """States (case, time, 2n) at ``tau`` [rad, rad/s]."""
        both = np.concatenate([self.rows, fourier.rate(self.rows, 1.0) * self.rate[:, None, None]], axis=1)
        return np.ascontiguousarray(fourier.samples(both, self.times).transpose(0, 2, 1))

    def sampled(self) -> tuple[Array, Array]:
        """Accelerations (case, time, n) [rad/s²] and their slopes (case, time, n, 2n) by the states at ``tau``; NaN
        where there are none.

        Of a line that is a tree they come from its matrices, with slopes as close as the motion is balanced, unless the
        balance is ``compiled``; of any other from the compiled equations.
        """
        n = len(self.balance.turn)
        if not self.balance.of_tree or self.balance.compiled:
            rates, slopes = self._compiled(0.0)
            return rates[..., n:], slopes[:, :, n:]
        m = self._matrices
        both = over_mass(m, np.concatenate([m.stiffness, m.damping, m.forcing[..., None]], axis=-1))
        bend = self._given.at(self.tau)[2] * (self.speed**2)[:, None, None]
        return bend + both[..., -1], -both[..., : 2 * n]

    def by_drive(self) -> Array:
        """What one N m more of the drives adds to the accelerations (case, time, n)."""
        if self.balance.of_tree and not self.balance.compiled:
            torques = self.balance.newton(self.table).driven(self.tau, self._given)
            return np.asarray(over_mass(self._matrices, torques[..., None])[..., 0])
        n = len(self.balance.turn)
        return np.asarray((self._compiled(1.0)[0] - self._compiled(0.0)[0])[..., n:])

    @cached_property
    def _given(self) -> GivenRotation:
        """The motions as what a tree is linearised about."""
        return self.balance.newton(self.table).given(TreeMotions(self.rows, self.torque, self.torque))

    @property
    def _matrices(self) -> LineMatrices:
        """Of a tree along the motions."""
        return line_matrices(self.balance.assembly.topology, self.coefficients, self.tau, self._given)

    def _compiled(self, more: float) -> tuple[Array, Array]:
        """Rates (case, time, 2n) and their slopes (case, time, 2n, 2n) of the compiled equations under ``more`` torque;
        NaN if none."""
        from trunnion.numerics.integration.sampled_rates import sampled_rates_of_cases

        times = self.tau / self.speed[:, None]
        return sampled_rates_of_cases(self.balance.address, times, self.states, self.driven(more))

    def observed(self) -> LineMotion:
        """Twist, torque (case, time, spring) and rotation (case, time, station) along the motions."""
        from trunnion.equations.line_system import LineMotion

        each = [
            self.balance.line.observed(self.tau / speed, states, numbers)
            for speed, states, numbers in zip(self.speed, self.states, self.driven(0.0), strict=True)
        ]
        return LineMotion(*(np.stack([getattr(one, key) for one in each]) for key in ("twist", "torque", "rotation")))

    @property
    def twists(self) -> Array:
        """Twist of every spring (case, time, spring) [rad] along the motions, none of several shafts in series; of a
        tree without the compiled equations."""
        if not self.balance.of_tree:
            return self.observed().twist
        topo, co = self.balance.assembly.topology, self.coefficients
        angle = base_motion(topo, co, self.tau, given=self._given).angle
        far = [topo.reference[one.far_group] if one.far is None else one.far for one in topo.compliances]
        behind = [topo.behind[one.shafts[-1], one.number] for one in topo.compliances]
        turned = angle[..., far] - angle[..., [one.near for one in topo.compliances]]
        return np.asarray(turned - co.shift[:, None, behind])

    def part(self, at: slice) -> SteadyStates:
        """Some of them."""
        read = None if self.read is None else self.read[at]
        return SteadyStates(self.balance, self.value[at], self.found[at], self.rows[at], self.torque[at], read)

    def driven(self, more: float) -> Array:
        """What the compiled equations read (case, number), with ``more`` torque than the motions have."""
        if not self.balance.free:
            return self.numbers
        return self.numbers + (self.torque + more)[:, None] * self._drive

    @cached_property
    def _drive(self) -> Array:
        """What one N m of the drives at the input changes of the numbers (case, number)."""
        return self.balance.line.drive_numbers(self.table)


def of_tree(assembly: Assembly) -> bool:
    """Whether the entries of a tree are all that a line's equations have about any motion."""
    topo, table = assembly.topology, assembly.table(1)
    row, co = table[0], assembly.untwisted(table)
    parts = sliders(assembly.packed, topo, row) or placed_clutches(assembly, row) or placed_pendulums(assembly, row)
    acting = topo.graph or topo.lost or topo.rubs or topo.drags or parts
    return not (acting or co.waves or co.across or co.loss.any())


Rows = Callable[[Array], Array]
"""Values (case,) → packed numbers (case, column)."""


class FreeBalance:
    """Motions of a line by the balance of their harmonics."""

    def __init__(self, assembly: Assembly, period: float, *, compiled: bool = True) -> None:
        """``assembly`` without exciters, which steps along the tree do not know; ``period`` [rad of input angle];
        ``compiled`` : False where no compiler is to be loaded for a line that is a tree, which costs up to twice the
        time for one of few unknowns."""
        refuse_dragged(assembly)
        topo = assembly.topology
        self.assembly, self.period, self.turn, self.free = assembly, period, rigid_rotation(topo), topo.free
        first = topo.coordinate[topo.group_of(0)] if topo.free else 0
        self.phase = np.eye(topo.size)[first]
        self.fastest = max(1, int(np.ceil(max(float(rate) for rate in topo.rates) * period / (2 * np.pi) - 1e-9)))
        self.fewest = max(FEWEST, 3 * self.fastest)
        self.weight = np.ones(2 * topo.size)
        self.rows: Rows = self._at_speeds
        self.of_tree, self.compiled = of_tree(assembly), compiled
        self.along_tree = self.of_tree and not (compiled and topo.size < LONG)

    @cached_property
    def line(self) -> LineSystem:
        """The compiled equations: loaded where they are needed, as they bring the compiler with them."""
        from trunnion.equations.line_system import LineSystem

        return LineSystem(self.assembly, 1.0)

    @property
    def address(self) -> int:
        """Of the compiled equations in this process: another one has it elsewhere."""
        return self.line.system.rate.address

    def along(self, rows: Rows) -> FreeBalance:
        """The same of lines whose packed numbers ``rows`` reads from the values asked for, in place of speeds."""
        other = copy(self)
        other.rows = rows
        return other

    def numbers(self, table: Array, co: LineCoefficients) -> Array:
        """What the compiled equations read (case, number)."""
        from trunnion.equations.numbers_of_rows import numbers_of_rows

        return numbers_of_rows(self.line, table, co)

    def _at_speeds(self, speed: Array) -> Array:
        table = self.assembly.table(len(speed))
        table[:, 0] = speed
        return table

    def solve(self, value: Array, h: int, guess: Array | None = None) -> SteadyStates:
        """Motions of ``h`` harmonics at ``value`` (case,), from a guess (case, n, 2h + 1) or rigid shafts."""
        unknowns = len(self.turn) * (2 * h + 1) + 1
        self.require_time(h, len(value))
        batch_size = max(1, MOST_NUMBERS // unknowns**2)
        with on_one_thread():
            parts = [
                self._batch(value[i : i + batch_size], h, None if guess is None else guess[i : i + batch_size])
                for i in range(0, len(value), batch_size)
            ]
        keys = ("value", "found", "rows", "torque")
        value, found, rows, torque = (np.concatenate([getattr(part, key) for part in parts]) for key in keys)
        read = [part.read for part in parts if part.read is not None]
        return SteadyStates(self, value, found, rows, torque, np.concatenate(read) if read else None)

    def require_time(self, h: int, many: int) -> None:
        """Refuse so ``many`` motions of ``h`` harmonics where they would not end, or fill the memory.

        Raises
        ------
        InputError : says how long they would take, and how much memory.
        """
        size = len(self.turn)
        if self.along_tree:  # no more than the response does along the tree
            return
        unknowns = size * (2 * h + 1) + 1
        seconds, memory = many * (1.5e-9 * unknowns**3 + 3e-7 * unknowns**2), MATRICES * 8.0 * unknowns**2
        what = f"its own periodic motion in {h} harmonics at {counted(many, 'point')}"
        require_estimate(size, what, seconds, memory, remedy="ask for fewer points, or join neighbouring parts")

    def _batch(self, value: Array, h: int, guess: Array | None) -> SteadyStates:
        table = self.rows(value)
        speed, co = table[:, 0], self.assembly.untwisted(table)
        first, unit = self.rigid(table, h, co) if guess is None else guess, self.torque_unit(co)
        if self.along_tree:
            motions_found, found = tree_newton.solved(
                lambda some: self.newton(table[some]), first, unit, ANGLE_SCALE, tolerance=CLOSED, most=CORRECTIONS
            )
            rows = np.where(found[:, None, None], motions_found.rows, 0.0)
            return SteadyStates(self, value, found, rows, np.where(found, motions_found.torque, 0.0))

        read = self.numbers(table, co)

        def motions(cases: Places, z: Array, found: Flags) -> SteadyStates:
            rows = ANGLE_SCALE * z[:, :-1].reshape(len(z), *first.shape[1:])
            return SteadyStates(self, value[cases], found, rows, unit[cases] * z[:, -1], read[cases])

        def equations(cases: Places, z: Array) -> tuple[Array, Array]:
            return self._equations(motions(cases, z, np.zeros(len(z), dtype=bool)), unit[cases])

        start = np.append(first.reshape(len(speed), -1) / ANGLE_SCALE, np.zeros((len(speed), 1)), axis=1)
        z, found = solve_many(equations, start, tolerance=CLOSED, most=CORRECTIONS)
        z[~found] = 0.0
        return motions(np.arange(len(speed)), z, found)

    def changes(self, motions: SteadyStates, tables: Sequence[Array]) -> list[Array]:
        """How the rows (case, n, 2h + 1) [rad] of ``motions`` change, to first order, where their packed numbers become
        each of ``tables`` (case, column); NaN at a motion that turns back."""
        batch_size = max(1, MOST_NUMBERS // (motions.rows[0].size + 1) ** 2)
        parts = [slice(i, i + batch_size) for i in range(0, len(motions.value), batch_size)]
        with on_one_thread():
            found = [self._changes(motions.part(one), [table[one] for table in tables]) for one in parts]
        return [np.concatenate(each) for each in zip(*found, strict=True)]

    def _changes(self, motions: SteadyStates, tables: list[Array]) -> list[Array]:
        keep_time()
        unit = self.torque_unit(motions.coefficients)
        left, matrix = self._equations(motions, unit)
        right = np.stack([self._moved(motions, table, unit) - left for table in tables], axis=2)
        change = -ANGLE_SCALE * np.asarray(solved(matrix, right))[:, :-1]
        return [change[..., k].reshape(motions.rows.shape) for k in range(len(tables))]

    def _moved(self, motions: SteadyStates, table: Array, unit: Array) -> Array:
        """What is missing of the balance of ``motions`` in lines of other packed numbers."""
        other = self.along(lambda value: table)
        moved = SteadyStates(other, motions.value, motions.found, motions.rows, motions.torque)
        return self._missing(moved, unit, moved.sampled()[0])

    def torque_unit(self, co: LineCoefficients) -> Array:
        """The torque of the drives (case,) [N m] that counts as one."""
        inertia = co.inertia @ np.array([float(q) for q in self.assembly.topology.speed_ratio]) ** 2
        return np.asarray(ANGLE_SCALE * co.speed**2 * inertia / self.period)

    def newton(self, table: Array) -> TreeNewton:
        """Newton's steps along the tree for lines of packed numbers ``table`` (case, column)."""
        topo, ones = self.assembly.topology, np.ones(len(table))
        drive = np.zeros((len(table), len(topo.stations)))
        if self.free:
            drive = drive_torques(topo, drive_places(topo, self.assembly.packed.column, table), ones)
        held = int(self.phase.argmax()) if self.free else None
        return TreeNewton(topo, self.assembly.untwisted(table), self.period, drive, held)

    def _equations(self, motions: SteadyStates, unit: Array) -> tuple[Array, Array]:
        """What is missing of the balance and of the phase (case, unknowns), and its derivative by the rows in units of
        ``ANGLE_SCALE`` and by the torque in those of ``unit`` (case,)."""
        n, h, rate = len(self.turn), motions.h, motions.rate
        cases, wide = len(rate), 2 * h + 1
        felt, slopes = motions.sampled()
        speed = motions.speed
        by_speed = np.repeat([-1.0 / speed**2, rate / speed**2], n, axis=0).T[:, None, None]
        both = fourier.product_blocks(slopes * by_speed, h)
        matrix = both[..., :n, :].copy()
        fourier.add_rate(matrix, both[..., n:, :])
        d = fourier.rate_matrix(h, 1.0)
        matrix[:, np.arange(n), :, np.arange(n), :] += (d @ d) * ((rate / speed) ** 2)[:, None, None]
        size = n * wide
        whole = np.zeros((cases, size + 1, size + 1))
        whole[:, :size, :size] = matrix.reshape(cases, size, size)
        missing = self._missing(motions, unit, felt)
        if not self.free:  # no torque is missing
            whole[:, size, size] = 1.0
            return missing, whole
        whole[:, :size, size] = -fourier.rows_of(motions.by_drive().transpose(0, 2, 1), h).reshape(cases, size) * (
            unit / (ANGLE_SCALE * speed**2)
        )[:, None]  # fmt: skip
        whole[:, size, :size:wide] = self.phase / np.linalg.norm(self.phase)
        return missing, whole

    def _missing(self, motions: SteadyStates, unit: Array, felt: Array) -> Array:
        """The first of these, of motions with the accelerations ``felt`` (case, time, n)."""
        h, rate = motions.h, motions.rate
        inertial = fourier.rate(fourier.rate(motions.rows, 1.0), 1.0) * (rate**2)[:, None, None]
        left = inertial - fourier.rows_of(felt.transpose(0, 2, 1), h)
        balance = left.reshape(len(rate), -1) / (ANGLE_SCALE * motions.speed**2)[:, None]
        if not self.free:
            return np.column_stack([balance, motions.torque / unit])
        phase = motions.rows[..., 0] @ self.phase / np.linalg.norm(self.phase) / ANGLE_SCALE
        return np.column_stack([balance, phase])

    def rigid(self, table: Array, h: int, co: LineCoefficients) -> Array:
        """Rigid shafts, each twisted by the torque that it carries on average, as series (case, n, 2h + 1)."""
        topo, times = self.assembly.topology, 4 * h + 4
        tau = self.period * np.arange(times) / times
        base, plain = (base_motion(topo, case, tau).angle for case in (co, co.straight))
        statically_loaded = self.assembly.coefficients(table, free_play=True)
        loaded, loose = (base_motion(topo, case, np.zeros(1)).angle[:, 0] for case in (statically_loaded, co))
        rows = fourier.rows_of((base - plain)[..., topo.firsts].transpose(0, 2, 1), h)
        rows[..., 0] += (loaded - loose)[:, topo.firsts]
        if self.free:
            rows[..., 0] -= np.outer(rows[..., 0] @ self.phase, self.phase) / (self.phase @ self.phase)
        return rows

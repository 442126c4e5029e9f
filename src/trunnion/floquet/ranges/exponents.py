"""Floquet exponents of chosen modes at chosen speeds, by Hill's blocks: where modes lie once joints have angles.

A free motion Re[e^{λt} Σ_h X_h e^{ihbΩt}], b = 2π/period of the equations in the input angle, makes

    Σ_l [(λ + ilbΩ)² M_{h−l} + (λ + ilbΩ) C_{h−l} + K_{h−l} (+ i sgn H)] X_l = 0.

Each exponent is followed from an eigenvalue of the straight line by inverse iteration,

    A(λ) u = A′(λ) x,    λ − x*x/x*u,

in a few harmonics about the mode's own, for every speed and mode by itself: so the cost does not grow with how slowly
the line turns, as that of a monodromy matrix does.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trunnion.arrays import Array, Complex, Integers, Places
from trunnion.equations.coefficients import Assembly
from trunnion.equations.linear import line_matrices
from trunnion.equations.topology import require_period
from trunnion.equations.tree_matrices import tree_matrices
from trunnion.numerics.sparse_matrices import SparseMatrices
from trunnion.steady.hill.hill import HillBlocks, interpolation_nodes, weights_at
from trunnion.steady.hill.tree_hill import TreeHill
from trunnion.steady.orders.groups import offsets
from trunnion.waiting import keep_time

REACH = 2
"""Layers of side orders about the mode's own: what is left out shifts it by the fourth power of the joints' spread."""
MOST_STEPS = 16
"""Between the harmonics of two modes that act on each other, at most."""
STEPS, PAIR_STEPS, CLOSER_STEPS = 6, 3, 2
MORE_STEPS, KNOWN = 6, 1e-2
"""How many more there are where the last one moved an exponent by more than this share of the slower decay."""
SETTLED = 1e-9
"""Share of |λ| by which the last step may still move it."""
ASIDE = (0.0, 2e-3 * (1 + 1j), -5e-3 * (1 + 1j))
"""Where the iteration begins, as shares of |λ| beside the straight line's: where two exponents lie alike about that, it
does not decide for one of them."""
STRAYED = 0.2
"""Share of |λ| by which no joint shifts an exponent: the iteration fell into another one."""
LONG = 8
"""Unknowns from which on what does not vary is eliminated along the tree."""
MOST_NUMBERS = 2_000_000
"""Complex numbers of a batch of matrices."""


@dataclass(frozen=True)
class ExponentOrders:
    """How far the coefficients of a line reach: harmonics (h,) about an order, in ``turns``⁻¹ cycles per turn, and the
    samples over the period that resolve them."""

    turns: Fraction
    harmonics: Integers
    times: int

    @classmethod
    def of(cls, assembly: Assembly, reach: int = REACH) -> ExponentOrders:
        """Raises InputError where the line has no period."""
        turns = require_period(assembly.line, assembly.topology)
        layers = sorted(offsets({int(rate * turns) for rate in assembly.topology.rates}, reach))
        return cls(turns, np.zeros(1, dtype=np.int64), 0).over(np.array(layers, dtype=np.int64))

    def over(self, harmonics: Integers) -> ExponentOrders:
        """The same with other ``harmonics``."""
        width = int(np.ptp(harmonics)) + 1
        return replace(self, harmonics=harmonics, times=1 << int(np.ceil(np.log2(max(64, 4 * width)))))


def floquet_exponents(
    assembly: Assembly, sides: ExponentOrders, table: Array, start: Complex, shape: NDArray[Any]
) -> Complex:
    """Exponents λ (case,) [1/s] at rows of packed numbers ``table`` (case, column) of the modes that are ``start``
    (case,) with ``shape`` (case, n) on the straight line. NaN where the iteration does not settle.
    """
    found = np.full(len(table), np.nan, dtype=complex)
    for aside in ASIDE:
        left = np.flatnonzero(np.isnan(found) & np.isfinite(start))
        for some in _batches(left, sides, assembly):
            near = start[some] + aside * np.abs(start[some])
            value = _one(_Blocks(assembly, sides, table[some]), near, shape[some])
            with np.errstate(invalid="ignore"):
                same = np.abs(value - start[some]) < STRAYED * np.abs(start[some])
            found[some] = np.where(same, value, np.nan)
    return found


def colliding_exponents(
    assembly: Assembly,
    sides: ExponentOrders,
    table: Array,
    cycles: Fraction,
    starts: tuple[Complex, Complex],
    shapes: tuple[NDArray[Any], NDArray[Any]],
    *,
    statically_twisted: bool = True,
    kept: KeptTrees | None = None,
) -> tuple[Complex, Array]:
    """The two exponents (case, 2) that are near λ_i and λ_j* + icΩ, of modes that meet or have met: with
    ``cycles`` c of the coefficients per turn, as of ``floquet_exponents``; and by how much the last step moved either
    (case,) [1/s]. ``kept``: blocks of the line, where other calls use them too.
    """
    away = -int(cycles * sides.turns)
    path = _path(assembly, sides, away)
    both = sides.over(np.unique(np.concatenate([sides.harmonics, sides.harmonics + away, path])))
    found, moved = np.full((len(table), 2), np.nan, dtype=complex), np.full(len(table), np.nan)
    for some in _batches(np.arange(len(table)), both, assembly):
        keep_time()
        blocks = _Blocks(assembly, both, table[some], statically_twisted, kept)
        partner = starts[1][some].conj() + 1j * float(cycles) * table[some, 0]
        x = np.zeros((len(some), len(both.harmonics), assembly.topology.size, 2), dtype=complex)
        x[:, int(np.searchsorted(both.harmonics, 0)), :, 0] = shapes[0][some]
        x[:, int(np.searchsorted(both.harmonics, away)), :, 1] = shapes[1][some].conj()
        found[some], moved[some], x = _two(blocks, (starts[0][some] + partner) / 2, x.reshape(len(some), -1, 2))
        for _ in range(MORE_STEPS // CLOSER_STEPS):
            with np.errstate(invalid="ignore"):
                poor = moved[some] > KNOWN * np.abs(found[some].real).min(axis=1)
            if not poor.any():
                break
            blocks, at = _Blocks(assembly, both, table[some][poor], statically_twisted, kept), some[poor]
            found[at], moved[at], x[poor] = _each_closer(blocks, found[at], x[poor])
    return found, moved


def _path(assembly: Assembly, sides: ExponentOrders, away: int) -> Integers:
    """Harmonics over which those about 0 act on those about ``away``, by as few steps as there are."""
    rates = {int(rate * sides.turns) for rate in assembly.topology.rates}
    steps, reach = {0: 0}, 0
    while away not in steps and reach < MOST_STEPS:
        reach += 1
        steps = offsets(rates, reach)
    between = [h for h, count in steps.items() if steps.get(away - h, reach + 1) + count <= reach]
    return np.array(between, dtype=np.int64)


def _along_tree(assembly: Assembly) -> bool:
    if assembly.topology.size < LONG:
        return False
    # Loss factors round loops are put into whole matrices only.
    return not (assembly.topology.graph and assembly.coefficients(assembly.table(1), any_frequency=True).loss.any())


def _batches(cases: Places, sides: ExponentOrders, assembly: Assembly) -> Iterator[Places]:
    numbers = len(sides.harmonics) * assembly.topology.size
    batch_size = max(1, MOST_NUMBERS // (8 * numbers if _along_tree(assembly) else numbers**2))
    for begin in range(0, len(cases), batch_size):
        yield cases[begin : begin + batch_size]


def _tree(assembly: Assembly, sides: ExponentOrders, table: Array, twisted: bool) -> tuple[Array | None, TreeHill]:
    """Blocks along the tree of rows of packed numbers, and the few speeds [rad/s] of theirs that stand for those at
    all, where nothing else varies."""
    co = assembly.coefficients(table, statically_twisted=twisted, any_frequency=True)
    few = None if co.across else interpolation_nodes(table[:, 0], co)
    if few is not None:
        nodes = np.repeat(table[:1], len(few), axis=0)
        nodes[:, 0] = few
        co = assembly.coefficients(nodes, statically_twisted=twisted, any_frequency=True)
    tau = 2 * np.pi * float(sides.turns) * np.arange(sides.times) / sides.times
    matrices = tree_matrices(assembly.topology, co, tau)
    return few, TreeHill(assembly.topology, matrices, co.loss, co.speed / float(sides.turns))


@dataclass(frozen=True)
class KeptTrees:
    """Blocks of a long line whose numbers stay the same over its speeds, made once for all calls; ``table``: rows of
    packed numbers at some of the speeds; ``made``: by samples over the period."""

    assembly: Assembly
    table: Array
    twisted: bool
    made: dict[int, tuple[Array | None, TreeHill]] = field(default_factory=dict)

    def of(self, sides: ExponentOrders) -> tuple[Array, TreeHill] | None:
        """The few speeds that stand for all, and the blocks; None where none do."""
        if sides.times not in self.made:
            self.made[sides.times] = _tree(self.assembly, sides, self.table, self.twisted)
        few, tree = self.made[sides.times]
        return None if few is None else (few, tree)


class _Blocks:
    """A(λ) of some rows of packed numbers and A′(λ), each (case, m, m)."""

    def __init__(
        self,
        assembly: Assembly,
        sides: ExponentOrders,
        table: Array,
        twisted: bool = True,
        kept: KeptTrees | None = None,
    ) -> None:
        self.harmonics, self.step = sides.harmonics, table[:, 0] / float(sides.turns)
        self.tree: TreeHill | None = None
        if _along_tree(assembly):
            few, self.tree = (kept and kept.of(sides)) or _tree(assembly, sides, table, twisted)
            self.weights = weights_at(few, table[:, 0])
            return
        co = assembly.coefficients(table, statically_twisted=twisted, any_frequency=True)
        tau = 2 * np.pi * float(sides.turns) * np.arange(sides.times) / sides.times
        self.blocks = HillBlocks(assembly.topology, line_matrices(assembly.topology, co, tau), co.loss, self.step)

    def at(self, value: Complex) -> SparseMatrices:
        """A at λ (case,)."""
        s = value[:, None] + 1j * self.harmonics * self.step[:, None]
        return self.blocks.matrices(s, self.harmonics)

    def slope_times(self, value: Complex, x: Complex) -> Complex:
        """A′x, exact by differences of any width: A is of second degree in λ."""
        width = np.abs(value)
        change = self.at(value + width).times(x) - self.at(value - width).times(x)
        return np.asarray(change / (2 * width)[:, None, None])

    def step_from(self, value: Complex, x: Complex) -> Complex:
        """A⁻¹A′x of x (case, m, …)."""
        keep_time()
        if self.tree is not None:
            found = self._along_tree(self.tree, value, x)
            return found if np.isfinite(found).all() else self._along_tree(self.tree, value * (1 + 1e-12), x)
        right = self.slope_times(value, x)
        found = self.at(value).solved(right)
        if np.isnan(found).any():  # one lies on an exponent already
            found = self.at(value * (1 + 1e-12)).solved(right)
        return found

    def _along_tree(self, tree: TreeHill, value: Complex, x: Complex) -> Complex:
        """``step_from`` of a long line, column by column."""
        s = value[:, None] + 1j * self.harmonics * self.step[:, None]
        found = np.empty_like(x)
        for k in range(x.shape[2]):
            one = np.ascontiguousarray(np.moveaxis(x[..., k].reshape(*s.shape, -1), 2, 0))
            found[..., k] = np.moveaxis(tree.stepped(s, self.harmonics, one, self.weights), 0, 2).reshape(len(s), -1)
        return found


def _one(blocks: _Blocks, value: Complex, shape: NDArray[Any]) -> Complex:
    cases, n = shape.shape
    x = np.zeros((cases, len(blocks.harmonics), n), dtype=complex)
    x[:, int(np.searchsorted(blocks.harmonics, 0))] = shape
    x, moved = x.reshape(cases, -1, 1), np.full(cases, np.inf)
    for _ in range(STEPS):
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        u = blocks.step_from(value, x)
        change = 1 / (x.conj() * u).sum(axis=(1, 2))
        value, moved, x = value - change, np.abs(change), u
    with np.errstate(invalid="ignore"):
        return np.where(moved <= SETTLED * np.abs(value), value, np.nan)


def _two(blocks: _Blocks, middle: Complex, x: Complex) -> tuple[Complex, Array, Complex]:
    """Two exponents about their ``middle`` (case,), from a plane x (case, m, 2) near that of their motions, by how much
    the last step moved either (case,), and their motions."""
    for _ in range(PAIR_STEPS):
        x = np.linalg.qr(x)[0]
        u = blocks.step_from(middle, x)
        little = x.conj().transpose(0, 2, 1) @ u
        with np.errstate(divide="ignore", invalid="ignore"):
            share, vectors = np.linalg.eig(little)
            pair = middle[:, None] - 1 / share
        middle, x = pair.mean(axis=1), u
    # Where a third is near, each by itself comes closer.
    return _each_closer(blocks, pair, x @ vectors)


def _each_closer(blocks: _Blocks, pair: Complex, x: Complex) -> tuple[Complex, Array, Complex]:
    """The same of exponents (case, 2) that are nearly known."""
    pair, x, moved = pair.copy(), x.copy(), np.zeros(len(pair))
    for k in range(2):
        pair[:, k], last, x[..., k : k + 1] = _closer(blocks, pair[:, k], x[..., k : k + 1])
        moved = np.maximum(moved, last)
    return pair, moved, x


def _closer(blocks: _Blocks, value: Complex, x: Complex) -> tuple[Complex, Array, Complex]:
    """An exponent after a few steps more, by how much the last moved it, and its motion."""
    moved = np.full(len(value), np.inf)
    for _ in range(CLOSER_STEPS):
        x = x / np.linalg.norm(x, axis=1, keepdims=True)
        x_next = blocks.step_from(value, x)
        with np.errstate(divide="ignore", invalid="ignore"):
            change = 1 / (x.conj() * x_next).sum(axis=(1, 2))
        value, moved, x = value - change, np.abs(change), x_next
    return value, moved, x

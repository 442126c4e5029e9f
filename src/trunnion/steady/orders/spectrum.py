"""The steady response of a line to everything that excites it, as amplitudes by order.

Each order of the result holds the complex amplitude Y of Re[Y e^{i(KΩ + ν)t}], K ``order`` and ν ``frequency``; what
turns the other way, (−K, −ν), is folded onto it by its conjugate.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from trunnion.arrays import Array, Complex, Integers
from trunnion.driveline.couplings import Coupling
from trunnion.driveline.pendulums import CentrifugalPendulum
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import (
    BaseOfExcitation,
    MeshError,
    Runnings,
    base_of_excitation,
    disk_torques,
    line_harmonics,
)
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import LineMatrices, line_matrices
from trunnion.equations.steady_base import has_joint_angles, has_periodic_base, require_steady_base
from trunnion.equations.topology import require_period
from trunnion.equations.tree_matrices import TreeMatrices, tree_matrices
from trunnion.errors import InputError
from trunnion.laws.joint import JointLaw
from trunnion.numerics.memory import require_memory
from trunnion.numerics.tree_blocks import AT_ONCE
from trunnion.steady.hill.hill import HillBlocks, interpolated, interpolation_nodes, weights_at
from trunnion.steady.hill.straight import coupled_response, straight_response
from trunnion.steady.hill.tree_hill import TreeHill
from trunnion.steady.orders.amplitudes import OrderSpectrum, OrderSum, stacked
from trunnion.steady.orders.channels import (
    channels_of,
    channels_of_harmonics,
    graph_channels_of_harmonics,
    motion_channels,
)
from trunnion.steady.orders.cost_model import along_tree, by_whole_matrices, looking_through, places_left, tree_pays
from trunnion.steady.orders.groups import OWN, CarrierGroup, SideOrders, groups_of, offsets
from trunnion.steady.orders.sidebands import DECADES, MOST_DECADES, OUTERMOST, side_orders, spreads
from trunnion.steady.orders.unbalanced import balanced
from trunnion.waiting import keep_time

if TYPE_CHECKING:
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed
    from trunnion.steady.orders.steady_state_orders import SteadyStateBase, SteadyStateOrders


FEWEST, MOST, ROUGH_REACH = 3, 48, 1
"""Harmonics kept on each side of an excitation: as many as the joints' angles ask for, more until ``SMALL_ENOUGH``."""
FLOOR = 1e-9
"""Share below which outermost harmonics that do not fall any more are rounding."""
SMALL_ENOUGH = 1e-11
"""Torque of the outermost harmonics, relative to the largest by order, up to which no more are taken."""
MOST_NUMBERS = 1_500_000
"""Complex numbers of a batch of vectors: bounded memory, and steps of progress."""
MOST_IN_MATRICES = 2 * MOST_NUMBERS
"""Those of a batch of matrices, zeros counted, which are not held where the rest is a narrow band."""


def order_spectrum(
    assembly: Assembly,
    speed: Array,
    *,
    table: Array | None = None,
    statically_twisted: bool = True,
    linearised: bool = False,
    rough: bool = False,
    motions: SteadyStatesBySpeed | None = None,
    progress: Callable[[float], None] | None = None,
) -> OrderSpectrum:
    """Solve ``assembly`` at every ``speed`` (speed,) [rad/s].

    ``table`` (speed, column): packed numbers of each case where more than the speed differs from case to case. With
    ``linearised`` each is solved as X₀ + A₀⁻¹(G − AX₀) about the first, X₀: right to first order, and as smooth a
    function of the numbers as A and G are, however near a resonance. With ``rough`` each cause
    makes the nearest side orders alone, and a free–free line with joint angles is taken about the motion of rigid
    shafts: right to first order in what joints force, a tenth of the time. ``motions``: periodic steady states that are
    known already.

    Raises
    ------
    InputError : a line with too long a period; a free–free line with joint angles, or an excitation's own frequency, in
    a ``table``.
    """
    if every := assembly.each(speed) if table is None else assembly.each_of(table):
        return stacked([
            order_spectrum(one, speed[[i]], statically_twisted=statically_twisted, linearised=linearised, rough=rough)
            for i, one in enumerate(every)
        ])  # fmt: skip
    numbers = _numbers(assembly, speed, table)

    def solved(*, whole: bool) -> tuple[_SpectrumProblem, OrderSpectrum]:
        case = _SpectrumProblem(assembly, statically_twisted, numbers, linearised, rough, motions, whole)
        return case, _at_all(case, speed, progress)

    case, found = solved(whole=False)
    if case.along_tree and not rough and not balanced(case.assembly, found, numbers, case.twisted, first=linearised):
        found = solved(whole=True)[1]
    return found


@dataclass(frozen=True)
class SearchCost:
    """What searching the response of a line with angled joints or varying meshes takes, which looks at a number of
    speeds: seconds of processor time, bytes, and side orders on either side; nothing worth naming of other lines."""

    seconds: float = 0.0
    memory: float = 0.0
    side_orders: int = 0


def search_cost(assembly: Assembly, some: Array, speeds: int) -> SearchCost:
    """At so many ``speeds``, about, by the harmonics that ``some`` of them [rad/s] take: slow speeds take more side
    orders, and resonances of these. Where more are needed than one begins with, all is solved again with more.

    Raises
    ------
    InputError : as of ``order_spectrum``.
    """
    case = _SpectrumProblem(assembly, True, _numbers(assembly, some, None), False, False, None, False)
    if not case.varies or case.own is not None:
        return SearchCost()
    *_, found = [case.solved(slice(i, i + case.batch)) for i in range(0, len(some), case.batch)]
    amplitudes = len(found.order) * found.channels.count * speeds
    seconds = case.seconds(speeds) + looking_through(amplitudes) / 1000
    return SearchCost(seconds, _room(found, speeds), found.side_orders)


def _at_all(case: _SpectrumProblem, speed: Array, progress: Callable[[float], None] | None) -> OrderSpectrum:
    """At every ``speed`` (speed,), batch by batch."""
    parts: list[OrderSpectrum] = []
    for done in range(0, len(speed), case.batch):
        keep_time()
        parts.append(case.solved(slice(done, done + case.batch)))
        if not done:
            _require_room(parts[0], len(speed))
        if progress:
            progress(min(done + case.batch, len(speed)) / len(speed))
    return stacked(parts)


def _numbers(assembly: Assembly, speed: Array, table: Array | None) -> Array:
    """The packed numbers (speed, column) to solve, which have a steady base; checked where they are given."""
    numbers = assembly.table(len(speed)) if table is None else table.copy()
    numbers[:, 0] = speed
    require_steady_base(assembly, numbers)
    if table is None:
        return numbers
    remedy = "ask order_response of each line by itself"
    if has_periodic_base(assembly, numbers):
        raise InputError(
            "is free–free and has joint angles: its cases are not solved together", element="driveline", remedy=remedy
        )
    for one in disk_torques(assembly):
        column = one.columns[2]
        if column >= 0 and np.ptp(numbers[:, column]) > 0:
            label = assembly.packed.labels[column]
            raise InputError(
                "is a frequency of excitation, which is not a parameter of the orders", key=label, remedy=remedy
            )
    return numbers


def _require_room(first: OrderSpectrum, speeds: int) -> None:
    """Refuse so many speeds that what the first of them show of the orders would not fit."""
    require_memory(_room(first, speeds), key="speeds", value=speeds, remedy="ask for fewer speeds")


def _room(first: OrderSpectrum, speeds: int) -> float:
    """Bytes of so many speeds: complex, and held twice while the parts are put together."""
    return 32.0 * len(first.order) * (first.channels.count + first.channels.points) * speeds


@dataclass(frozen=True)
class _StraightEquations:
    """Equations of one reach of harmonics, written out for the rows of ``table``."""

    table: Array
    co: LineCoefficients
    groups: list[CarrierGroup]
    sides: SideOrders
    matrices: LineMatrices | TreeMatrices
    base: BaseOfExcitation
    blocks: HillBlocks | TreeHill


class _SpectrumProblem:
    """What solving takes, apart from the speeds."""

    def __init__(
        self,
        assembly: Assembly,
        statically_twisted: bool,
        numbers: Array,
        linearised: bool,
        rough: bool,
        motions: SteadyStatesBySpeed | None,
        whole: bool,
    ) -> None:
        """With ``whole`` matrices however long the line is."""
        self.linearised, self.rough = linearised, rough
        self.assembly, self.topo, self.numbers = assembly, assembly.topology, numbers
        self.places = channels_of(self.topo)
        self.twisted = statically_twisted
        by_speed = any(
            isinstance(one, CentrifugalPendulum) or isinstance(one, Coupling) and one.torques
            for one in assembly.line.elements
        )
        self.alike = bool(np.all(numbers[:, 1:] == numbers[:1, 1:])) and not by_speed
        one = self.springs = self.coefficients(numbers[:1] if self.alike else numbers)
        # Largest of each number: an excitation counts where any case has it.
        few = numbers[[np.abs(numbers[:, 0]).argmax()]] if self.alike else numbers
        row = few[np.abs(few).argmax(axis=0), np.arange(few.shape[1])]
        self.acting = [one for one in line_harmonics(assembly, row) if one.acts]
        self.varies = has_joint_angles(assembly, numbers[:1] if self.alike else numbers) or bool(one.waves)
        self.turns = require_period(assembly.line, self.topo) if self.varies else Fraction(1)
        # Equations by motion know no damping whatever the frequency: about rigid shafts it is as right as all is there.
        about_rigid = rough or bool(one.loss.any())
        self.own: SteadyStateOrders | None = None
        if has_periodic_base(assembly) and not about_rigid:
            # Loaded for lines that need it: it brings the compiler and the orbits with it.
            from trunnion.steady.orders.steady_state_orders import SteadyStateOrders

            self.own = SteadyStateOrders(assembly, motions)
        self.plans: dict[float, tuple[list[CarrierGroup], SideOrders, int]] = {}
        self.rates = {int(rate * self.turns) for rate in self.topo.rates}
        self.fall: dict[int, float] | None = None
        self.reach: float = ROUGH_REACH if rough else _reach(one.joints)
        self.along_tree = self.varies and self.own is None and not whole and self._tree_pays()
        if self.along_tree and not rough:
            self.plans.clear()  # reaches count in decades now
            self.fall, self.reach = spreads(self.topo, one, self.turns), DECADES
        self.few: Array | None = None
        self.written: dict[float, _StraightEquations] = {}
        torques = disk_torques(assembly)
        # A frequency that the speed turns round has a sign, which a loss factor's torque follows.
        turns_round = bool(one.loss.any()) and any(torque.frequency for torque in torques)
        smooth = self.alike and not turns_round and not any(torque.law.speeds for torque in torques)
        if self.varies and smooth and self.own is None:
            self.few = interpolation_nodes(numbers[:, 0], self.coefficients(numbers))
        if self.own is not None:
            self.own.balance.require_time(self.own.balance.fewest, len(numbers))
            each = self.topo.size * (2 * self.own.balance.fewest + 1)
            self.batch = max(1, MOST_NUMBERS // (8 * each if self.own.balance.along_tree else each**2))
        elif self.varies:
            self.batch = self._batch()
        else:
            self.batch = max(1, MOST_NUMBERS // max(1, len(self.acting) * self.topo.size))
        if linearised:
            self.batch = len(numbers)

    def coefficients(self, table: Array) -> LineCoefficients:
        return self.assembly.coefficients(table, statically_twisted=self.twisted, any_frequency=True)

    def _plan(self, reach: float) -> tuple[list[CarrierGroup], SideOrders, int]:
        """Groups, the side orders of their harmonics, and samples over the period that resolve them."""
        if reach not in self.plans:
            sides = self._sides(reach)
            groups = [OWN, *groups_of(self.acting, 1 / self.turns, sides.width)]
            widest = max(int(np.ptp(sides.of(group)[0])) for group in groups) + 1
            self.plans[reach] = groups, sides, 1 << int(np.ceil(np.log2(max(64, 4 * widest))))
        return self.plans[reach]

    def _sides(self, reach: float) -> SideOrders:
        if self.fall is None:
            return SideOrders(offsets(self.rates, int(reach)), int(reach))
        return SideOrders(side_orders(self.fall, reach), OUTERMOST)

    def _tree_pays(self) -> bool:
        groups, sides, _ = self._plan(self.reach)
        harmonics = [len(sides.of(group)[0]) for group in groups]
        return not (self.topo.graph or self.topo.dragged) and tree_pays(self.topo, harmonics, len(self.numbers))

    def _batch(self) -> int:
        """Speeds together, by the largest arrays of one."""
        groups, sides, times = self._plan(self.reach)
        n = self.topo.size
        most = max(len(sides.of(group)[0]) for group in groups) * n
        if self.along_tree:
            return max(1, MOST_NUMBERS // (most if self.few is not None else max(most, times * n)))
        # To look around, equations that stand for all speeds are written out once.
        written = 0 if self.rough and self.few is not None else 4 * times * n**2
        return max(1, MOST_IN_MATRICES // max(most**2, written))

    def seconds(self, cases: int) -> float:
        """Processor time that so many cases take, about, in all the harmonics that were tried by now."""
        cost = along_tree if self.along_tree else by_whole_matrices
        tried = [[len(sides.of(group)[0]) for group in groups] for groups, sides, _ in self.plans.values()]
        return sum(cost(self.topo, harmonics, cases) for harmonics in tried) / 1000

    def solved(self, rows: slice) -> OrderSpectrum:
        """The sum of all responses at some of the cases."""
        total, cut_off = self._solved(self.numbers[rows])
        damping = self.springs.damping.copy()
        damping[:, list(self.topo.converting)] = 0.0  # a part of torques that are no damper's
        springs = (part[rows] if len(part) > 1 else part for part in (damping, self.springs.loss))
        found = total.spectrum(self.numbers[rows, 0], cut_off, *springs)
        if self.varies and self.own is None:
            return replace(found, side_orders=sum(offset > 0 for offset in self._sides(self.reach).layers))
        oils = () if self.own is not None else self.springs.oils
        return replace(found, oils=tuple(one.take(rows) for one in oils)) if oils else found

    def _solved(self, table: Array) -> tuple[OrderSum, Array]:
        """That sum, and the relative size of the outermost harmonics, (case,)."""
        if self.own is not None:
            return self._about_steady_states(self.own.at(table[:, 0]), table)
        if not self.varies:
            return self._straight(table), np.zeros(len(table))
        before: tuple[float, float] | None = None
        while True:
            found, last = self._bent(table, self.reach)
            most = MOST if self.fall is None else MOST_DECADES
            if self.rough or self.reach >= most or not np.any(last > SMALL_ENOUGH):
                return found, last
            worst = float(np.nanmax(last))
            if before is not None and self.topo.graph and FLOOR > worst > before[1] / 2:
                self.reach = before[0]  # rounding beside torques that cancel: more harmonics bring nothing
                return found, last
            before = self.reach, worst
            self.reach = min(most, self.reach + self._further(worst))

    def _further(self, last: float) -> float:
        """By how much to raise the reach, where the outermost harmonics have the share ``last``."""
        return max(1, self.reach // 2) if self.fall is None else max(2.0, 1.0 + np.log10(last / SMALL_ENOUGH))

    def _straight(self, table: Array) -> OrderSum:
        topo, co, once = self.topo, self.coefficients(table), np.zeros(1, dtype=np.int64)
        base = self._base(table, co, np.zeros(1))
        respond: Callable[..., Complex] = coupled_response if topo.graph else straight_response
        matrices = (line_matrices if topo.graph else tree_matrices)(topo, co, np.zeros(1))
        total = OrderSum(len(table), self.places)
        groups = groups_of(self.acting, None, 0)
        if groups:
            nu = np.stack([group.carrier_at(table[:, 0]) for group in groups])
            running: Runnings = {}
            sources = [
                self._sources(group, once, table, co, base, at[:, None], matrices.wave, running=running)
                for group, at in zip(groups, nu, strict=True)
            ]
            right = np.stack([force[:, 0] for force, _ in sources])
            y = respond(topo, matrices, co.loss, nu, right, lags=co.lags, oils=co.oils, linearised=self.linearised)
            for group, at, x, (_, error) in zip(groups, nu, y, sources, strict=True):
                seen = motion_channels(topo, x[:, None], matrices.ratio, base.relative)
                if topo.free:  # driven away by a constant torque, without bound
                    seen[at == 0, :, self.places.deviation] = seen[at == 0, :, self.places.point] = np.nan
                self._gather(total, group, once, seen, error, at[:, None], co, matrices.wave)
        self._add_static(total, co)
        return total

    def _written(self, reach: float, cases: Array) -> _StraightEquations:
        """The equations at the speeds that stand for all, or at those of ``cases``."""
        if self.few is not None and reach in self.written:
            return self.written[reach]
        table = cases
        if self.few is not None:
            table = np.repeat(self.numbers[:1], len(self.few), axis=0)
            table[:, 0] = self.few
        co = self.coefficients(table)
        groups, sides, times = self._plan(reach)
        self._require_room_for(max(len(sides.of(group)[0]) for group in groups), times, len(table))
        tau = 2 * np.pi * float(self.turns) * np.arange(times) / times
        base, step = self._base(table, co, tau), table[:, 0] / float(self.turns)
        matrices: LineMatrices | TreeMatrices
        blocks: HillBlocks | TreeHill
        if self.along_tree:
            matrices = tree_matrices(self.topo, co, tau)
            blocks = TreeHill(self.topo, matrices, co.loss, step, linearised=self.linearised)
        else:
            matrices = line_matrices(self.topo, co, tau)
            blocks = HillBlocks(self.topo, matrices, co.loss, step, linearised=self.linearised)
        found = _StraightEquations(table, co, groups, sides, matrices, base, blocks)
        if self.few is not None:
            self.written[reach] = found
        return found

    def _require_room_for(self, harmonics: int, times: int, nodes: int) -> None:
        """Refuse orders whose equations would not fit: ``harmonics`` of a group on ``times`` samples, at ``nodes``."""
        n = self.topo.size
        # Complex: the matrices of the nodes, those of a batch of cases and their factors; and what is sampled.
        matrices = nodes + 2 * min(self.batch, len(self.numbers))
        needed = 16.0 * (matrices * (harmonics * n) ** 2 + 4 * nodes * times * n**2)
        if self.along_tree:
            left = places_left(self.topo)
            needed = 16.0 * (8 * n * (matrices * harmonics + nodes * times) + max(AT_ONCE, 4 * left * harmonics**2))
        element, orders = (
            Counter(one.name for one in self.acting).most_common(1)[0] if self.acting else ("driveline", 0)
        )
        require_memory(
            needed,
            element=element,
            key="excitation",
            value=f"{orders} orders",
            remedy=f"its joints and meshes make {harmonics} side orders together: leave out the orders that matter "
            "least; with straight joints each is solved by itself",
        )

    def _bent(self, cases: Array, reach: float) -> tuple[OrderSum, Array]:
        topo, speed = self.topo, cases[:, 0]
        weights, out = weights_at(self.few, speed), self._written(reach, cases)
        every = self.springs if self.few is not None else out.co
        alike = slice(None) if self.few is None else slice(0, 1)  # ratios do not depend on the speed
        ratio, relative, wave = (part[alike] for part in (out.matrices.ratio, out.base.relative, out.matrices.wave))
        total = OrderSum(len(speed), self.places)
        running: Runnings = {}
        last, least = np.zeros(len(speed)), np.zeros(len(speed))  # least: below it a torque is rounding of its cause
        for group in out.groups:
            carrier = group.carrier_at(out.table[:, 0])
            h, rim = out.sides.of(group)
            nu = carrier[:, None] + h * out.blocks.step[:, None]
            right, error = self._sources(group, h, out.table, out.co, out.base, nu, out.matrices.wave, running=running)
            if group.own:
                right += self._harmonics(out.matrices.forcing, h)
                if isinstance(out.matrices, LineMatrices) and out.matrices.base_twist is not None:
                    right -= self._harmonics(_of_loss(out.matrices, out.co.loss), h)
                    error += self._harmonics(out.matrices.base_twist, h)
            least = np.maximum(least, 1e-6 * np.abs(interpolated(weights, right)).max(axis=(1, 2)))
            x = out.blocks.solve(weights, carrier, h, rim, right)
            if out.base.turning is None:
                seen = channels_of_harmonics(topo, x, h, out.blocks.times, ratio, relative)
            else:
                assert isinstance(out.matrices, LineMatrices) and out.matrices.elongations is not None
                rows = out.matrices.elongations[alike], out.base.turning[alike]
                seen = graph_channels_of_harmonics(topo, x, h, out.blocks.times, *rows)
            self._gather(total, group, h, seen, interpolated(weights, error), interpolated(weights, nu), every, wave)
            last = np.maximum(last, np.abs(seen[:, rim, self.places.torque]).max(axis=(1, 2)))
        self._add_base(total, out.base.rotation[alike], out.sides.width)
        self._add_static(total, every)
        return total, self._share(last, total, least)

    def _about_steady_states(self, own: SteadyStateBase, table: Array) -> tuple[OrderSum, Array]:
        """Some speeds of a free–free line with joint angles."""
        from trunnion.steady.orders.steady_state_orders import seen_about

        co, speed = own.coefficients, table[:, 0]
        total, last = OrderSum(len(speed), self.places), np.zeros(len(speed))
        running: Runnings = {}
        kept = np.arange(-own.count, own.count + 1)
        for harmonic, part in zip(kept.tolist(), self._harmonics(own.seen, kept).swapaxes(0, 1), strict=True):
            total.add(harmonic / self.turns, 0.0, part)
        for group in groups_of(self.acting, 1 / self.turns, own.count):
            carrier = group.carrier_at(speed)
            centres = [m for _, m in group.members]
            h = np.arange(min(centres) - own.count, max(centres) + own.count + 1, dtype=np.int64)
            nu = carrier[:, None] + own.rate[:, None] * h
            right, error = self._sources(group, h, table, co, own.base, nu, own.wave, own.mass, running=running)
            seen = seen_about(own, self.topo, h, own.equations.solved(carrier, h, right))
            self._gather(total, group, h, seen, error, nu, co, own.wave)
            last = np.maximum(last, np.abs(seen[:, [0, -1]][..., self.places.torque]).max(axis=(1, 2)))
        return total, self._share(last, total)

    def _share(self, last: Array, total: OrderSum, least: Array | float = 0.0) -> Array:
        """Torques ``last`` (case,) over the largest of any order, which is no less than ``least``."""
        sizes = [np.abs(a[:, self.places.torque]).max(axis=1) for a in total.amplitude.values()]
        largest = np.maximum(np.max([np.zeros(len(last)), *sizes], axis=0), least)
        return np.divide(last, largest, out=np.zeros_like(last), where=largest > 0)

    def _base(self, table: Array, co: LineCoefficients, tau: Array) -> BaseOfExcitation:
        plain = co
        if co.twist.any():
            plain = self.assembly.coefficients(table, statically_twisted=False, any_frequency=True)
        return base_of_excitation(self.topo, co, plain, tau)

    def _sources(
        self,
        group: CarrierGroup,
        h: Integers,
        table: Array,
        co: LineCoefficients,
        base: BaseOfExcitation,
        nu: Array,
        wave: Array,
        mass: Array | float = 1.0,
        *,
        running: Runnings,
    ) -> tuple[Complex, Complex]:
        """Torques on the unknowns (case, h, n), over their ``mass`` (case, time, n), and twists by transmission errors
        (case, h, spring) of a group's members at its harmonics ``h`` (h,) of frequency ``nu`` (case, h) [rad/s].
        ``running``: how disks run at the rows of ``table``, for all groups together."""
        right = np.zeros((len(base.relative), len(h), self.topo.size), dtype=complex)
        error = np.zeros((len(base.relative), len(h), len(self.topo.compliances)), dtype=complex)
        for one, m in group.members:
            at, size = int(np.searchsorted(h, m)), one.size(self.assembly, table, running)

            def spring(e: int, turns: Array = nu[:, at, None]) -> Complex:
                return np.asarray(co.stiffness[:, e, None] * wave[..., e] + 1j * turns * co.damping[:, e, None])

            acted, force = one.forcing(self.topo, size, base, spring)
            if isinstance(one, MeshError):
                error[:, at, one.mesh.compliance] += size
            if isinstance(mass, np.ndarray):
                force = force / mass[..., acted]
            if force.shape[1] == 1:  # nothing varies over the turn
                right[:, at, acted] += force[:, 0]
                continue
            near = 4 * np.abs(h - m) < force.shape[1]  # harmonics that the samples resolve
            right[:, np.flatnonzero(near)[:, None], acted] += self._harmonics(force, h[near] - m)
        return right, error

    def _harmonics(self, values: NDArray[Any], h: Integers) -> Complex:
        """Fourier coefficients (case, h, …) at ``h`` of values (case, time, …) over the period."""
        times = values.shape[1]
        return np.asarray(np.fft.fft(values, axis=1)[:, h % times] / times)

    def _gather(
        self,
        total: OrderSum,
        group: CarrierGroup,
        h: Integers,
        seen: Complex,
        error: Complex,
        nu: Array,
        co: LineCoefficients,
        wave: Array,
    ) -> None:
        """Give motions ``seen`` (case, h, channel) of a group their torques, in place, and add them up by order."""
        seen[..., self.places.twist] += error
        self._add_torque(seen, co, nu)
        self._add_waves(seen, co, h, wave, own=group.own)
        for j, harmonic in enumerate(h.tolist()):
            total.add(group.carrier + harmonic / self.turns, group.frequency, seen[:, j])

    def _add_torque(self, seen: Complex, co: LineCoefficients, nu: Array) -> None:
        """Torque of every spring from its elastic twist, in place."""
        places, v = self.places, nu[..., None]
        k, c, loss = (part[:, None, :] for part in (co.stiffness, co.damping, co.loss))
        seen[..., places.torque] = (k + 1j * v * c + 1j * np.sign(v) * loss) * seen[..., places.twist]
        for oil in () if self.varies or self.own is not None else co.oils:
            e = oil.compliance
            seen[..., places.torque.start + e] += oil.added(nu.T).T * seen[..., places.twist.start + e]
        for one in co.across:
            if one.compliance is not None:
                turned = seen[..., places.deviation] @ self.topo.turning[one.by]
                seen[..., places.torque.start + one.compliance] += 1j * nu * one.slope[:, None] * turned

    def _add_waves(self, seen: Complex, co: LineCoefficients, h: Integers, wave: Array, *, own: bool) -> None:
        """What the varying part of mesh stiffnesses adds to their torques, in place."""
        places, times = self.places, wave.shape[1]
        for e in sorted({mesh.compliance for mesh in co.waves}):
            change = np.fft.fft(wave[..., e] - 1.0, axis=1) / times
            apart = change[:, (h[:, None] - h[None, :]) % times]
            twist, k = seen[..., places.twist.start + e], co.stiffness[:, e, None]
            torque = k * (apart @ twist[..., None])[..., 0]
            if own:
                torque = torque + co.torque[:, e, None] * change[:, h % times]
            seen[..., places.torque.start + e] += torque

    def _add_static(self, total: OrderSum, co: LineCoefficients) -> None:
        total.mean[:, self.places.twist] += co.twist
        total.mean[:, self.places.torque] += co.torque

    def _add_base(self, total: OrderSum, rotation: Array, highest: int) -> None:
        """How the base motion itself turns: what joints force without any twist."""
        points = [station for station, _ in self.topo.points]
        spectrum = np.fft.rfft(rotation[..., points], axis=1) / rotation.shape[1]
        least = 1e-16 * np.abs(spectrum[:, 1:]).max(initial=0.0)
        for h in range(1, min(spectrum.shape[1] - 1, highest) + 1):
            if np.any(np.abs(spectrum[:, h]) > least):
                total.base[h / self.turns, 0.0] = 2 * spectrum[:, h]


def _of_loss(matrices: LineMatrices, loss: Array) -> Array:
    """Torques on the unknowns (case, time, n) of loss factors where the base motion itself twists springs of loops."""
    assert matrices.base_twist is not None and matrices.elongations is not None
    times = matrices.base_twist.shape[1]
    ahead = 1j * np.sign(np.fft.fftfreq(times))[:, None] * np.fft.fft(matrices.base_twist, axis=1)
    torque = np.fft.ifft(ahead, axis=1).real * loss[:, None]
    return np.asarray((torque[..., None, :] @ matrices.elongations)[..., 0, :])


def _reach(joints: tuple[JointLaw, ...]) -> int:
    """As many harmonics as the most uneven joint asks for: behind a Hooke's joint they fall off as tan^2h(β/2)."""
    share = max((law.spread for law in joints), default=0.0)
    return int(np.clip(np.ceil(np.log(SMALL_ENOUGH) / np.log(max(share, 1e-12))) + 1, FEWEST, MOST))

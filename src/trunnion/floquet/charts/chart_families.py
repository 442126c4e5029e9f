"""What a stability chart samples: quantities that are analytic in both axes, with their errors.

For up to three unknowns these are the characteristic coefficients of the monodromy matrix, beyond that its
entries; the last quantity is always ∫ tr(M⁻¹C) dτ. Speed enters through 1/Ω, of which both are entire
functions, so a speed axis is patched in 1/Ω.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.chain_batch import chain_batch, chain_program, loaded_by_speed
from trunnion.equations.coefficients import Assembly
from trunnion.equations.curve_speeds import curve_knots, curve_speeds
from trunnion.equations.first_order import LARGEST_DENSE, LineRates, fastest_cycles, steps_that_see
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.steady_base import has_joint_angles
from trunnion.equations.topology import require_period
from trunnion.floquet.charts.axes import ChartAxis
from trunnion.floquet.charts.chart_pixels import Pixels, undamped
from trunnion.floquet.charts.cost_model import compiling_pays, instead_of_compiling, without_groups
from trunnion.floquet.charts.leading_group import distinguished
from trunnion.floquet.charts.matrix_interpolation import matrix_patches
from trunnion.floquet.charts.multiplier_interpolation import corners_of, leading_patches
from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.chain_exponentials import ChainExponentials
from trunnion.numerics.chain.chain_monodromy import (
    Window,
    chain_monodromy,
    chain_propagator,
    complete,
    has_extra,
    symmetry_phase,
)
from trunnion.numerics.chain.chain_tables import ChainBatch, ChainProgram
from trunnion.numerics.chain.characteristic import LARGEST, coefficients_from_matrices, radii_on_rows
from trunnion.numerics.chain.exponential_batch import integrate_exponentials
from trunnion.numerics.chain.exponential_monodromy import exponential_monodromies
from trunnion.numerics.chain.series_driver import integrate_series
from trunnion.numerics.chain.stages_driver import integrate_stages
from trunnion.numerics.jit import is_compiled
from trunnion.numerics.patches.patches import NODES, Box, Evaluate, Grid, PatchedFunction, grid_by_grid, halved_across
from trunnion.numerics.patches.slabs import build_slabs, slab_edges
from trunnion.numerics.threads import on_threads


class ChartFamily(Protocol):
    """Anything a chart can be made of; ``affordable``: points that may each be integrated to settle doubts.

    What it says here of itself holds for families of which nothing but their matrices is known.
    """

    affordable: ClassVar[int]

    @property
    def size(self) -> int:
        """Number of unknowns."""

    @property
    def period(self) -> float:
        """Period in τ."""

    @property
    def set_aside(self) -> int:
        """How many multipliers that are exactly 1 are to be set aside, as ``Stability.set_aside``."""
        return 0

    @property
    def analytic(self) -> bool:
        """Whether what decides stability is an analytic function of both parameters."""
        return True

    @property
    def passive(self) -> bool:
        """Whether it is known that nothing grows anywhere on the axes."""
        return False

    @property
    def kinks(self) -> tuple[Array, Array]:
        """Values of x and of y at which the quantities are not smooth."""
        return np.empty(0), np.empty(0)

    def matrices(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array, Array]:
        """Monodromy matrices (points, m, m), their errors and ∫ tr(M⁻¹C) dτ (points,)."""

    def evaluate(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array]:
        """Quantities and their error bounds at points (x, y), each (points, quantities)."""
        return quantities(*self.matrices(x, y, tolerance, threads))

    def sampler(self, box: Box, pixels: int, tolerance: float, threads: int, *, slabs: bool = True) -> Sampler:
        """How to sample grids in the patch variables when building the patches of ``box``; by slabs where they pay."""
        return point_by_point(self, box, tolerance, threads)

    def leading(
        self, box: Box, pixels: int, tolerance: float, threads: int, report_progress: Callable[[float], None]
    ) -> PatchedFunction | None:
        """Patches of the largest multipliers alone, where those stand apart and cost less; else None."""
        return None

    def whole_matrices(
        self, box: Box, pixels: int, tolerance: float, threads: int, report_progress: Callable[[float], None]
    ) -> PatchedFunction | None:
        """Patches of all entries on grids whose degrees fit, where those cost less; else None."""
        return None

    def differ(self, x: Array, y: Array) -> bool:
        """Whether a cheap look tells the stability of two points (x, y) apart; False also where it would be dear."""
        return False

    def settled(self, x: Array, y: Array) -> Pixels | None:
        """Pixels at points (x, y) from steps that are halved until the multipliers stay; None where there is no way."""
        return None

    def in_numpy(self, x: Array, y: Array) -> Pixels | None:
        """The same of damped lines whose kernels would have to be compiled, which takes longer; else None."""
        return None

    def over_whole_periods(self) -> ChartFamily:
        """The same family integrated over whole periods, whatever symmetry it may have."""
        return self

    def to_patch(self, value: Array, of_x: bool) -> Array:
        """Axis values → the variable in which the quantities are smooth."""
        return np.asarray(value, dtype=float)

    def from_patch(self, value: Array, of_x: bool) -> Array:
        """The inverse of ``to_patch``."""
        return np.asarray(value, dtype=float)


def quantities(matrix: Array, error: Array, trace: Array) -> tuple[Array, Array]:
    """Analytic quantities of monodromy matrices (points, m, m) and their error bounds."""
    count, m = matrix.shape[:2]
    if m <= LARGEST:
        values, bounds = np.empty((count, m)), np.empty((count, m))
        coefficients_from_matrices(matrix, error, values, bounds)
        # Liouville: the last coefficient is det Z, known better from the damping than from the matrix.
        values[:, m - 1] = np.exp(-trace)
        bounds[:, m - 1] = values[:, m - 1] * (np.minimum(error, 1.0) + 1e-12 * np.abs(trace))
    else:
        values = matrix.reshape(count, -1)
        # Spread so that the Frobenius norm of the entries' bounds is the bound of the matrix.
        bounds = np.broadcast_to(error[:, None] / m, values.shape)
    return np.column_stack([values, trace]), np.column_stack([bounds, 1e-12 * np.abs(trace)])


@dataclass(frozen=True)
class LineFamily(ChartFamily):
    """A driveline over two of its parameters; ``half_windows``: half periods suffice where the joints' phases allow."""

    assembly: Assembly
    x: ChartAxis
    y: ChartAxis
    speed: float
    statically_twisted: bool
    half_windows: bool = True
    affordable: ClassVar[int] = 200_000

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.assembly.topology.size

    @property
    def set_aside(self) -> int:
        """A turn of what no spring holds, a free line as a whole or the ring of a damper; of a free line its speed too
        where no load depends on it anywhere on the axes."""
        topo = self.assembly.topology
        return topo.set_aside(topo.free and bool(self._by_speed))

    @property
    def period(self) -> float:
        """Period [rad of input angle]."""
        return 2 * np.pi * float(require_period(self.assembly.line, self.assembly.topology))

    def batch(self, x: Array, y: Array) -> ChainBatch:
        """The kernel's numbers at points (x, y)."""
        return self.batch_of(self.table(x, y))

    def batch_of(self, table: Array) -> ChainBatch:
        """The kernel's numbers of cases of packed numbers (case, column)."""
        coefficients = self.assembly.coefficients(table, statically_twisted=self.statically_twisted)
        return chain_batch(self.assembly.topology, coefficients, self._by_speed)

    @cached_property
    def _by_speed(self) -> frozenset[int]:
        """Stations with loads that depend on the speed anywhere on the axes."""
        box = Box.around(self.x.values, self.y.values)
        return loaded_by_speed(self.assembly.topology, self._coefficients(*spread(box, 5)))

    @cached_property
    def passive(self) -> bool:
        """Whether at points all over the axes nothing varies with the angle and nothing feeds energy in."""
        co = self.of_straight
        return co is not None and not co.fed and not np.any(co.stiffness < 0)

    @cached_property
    def of_straight(self) -> LineCoefficients | None:
        """Coefficients at points all over the axes of a line that nothing varies there; of others None."""
        table = self.table(*self._places)
        if has_joint_angles(self.assembly, table):
            return None
        co = self.assembly.coefficients(table, statically_twisted=self.statically_twisted)
        return None if co.waves else co

    @property
    def kinks(self) -> tuple[Array, Array]:
        """Speeds at which curves of machines go from one formula to another."""
        none, along = np.empty(0), self.x if self.x.is_speed else self.y
        if not along.is_speed:
            return none, none
        knots = curve_knots(self.assembly, float(along.values.min()), float(along.values.max()))
        return (knots, none) if self.x.is_speed else (none, knots)

    @property
    def _places(self) -> tuple[Array, Array]:
        """Points (x, y) all over the axes, with all speeds at which curves of machines show what they do."""
        box = Box.around(self.x.values, self.y.values)
        x, y = spread(box)
        if not (self.x.is_speed or self.y.is_speed):
            return x, y
        ends, across = ((box.u0, box.u1), y) if self.x.is_speed else ((box.v0, box.v1), x)
        speeds, across = curve_speeds(self.assembly, *ends), np.unique(across)
        speed, other = np.repeat(speeds, len(across)), np.tile(across, len(speeds))
        more = (speed, other) if self.x.is_speed else (other, speed)
        return np.concatenate([x, more[0]]), np.concatenate([y, more[1]])

    @cached_property
    def program(self) -> ChainProgram:
        """The line's topology as the kernel reads it."""
        ends = self._coefficients(self.x.values[:1], self.y.values[:1])
        return chain_program(self.assembly.topology, ends, self._by_speed)

    @property
    def needs_stages(self) -> bool:
        """Whether its equations have terms that series do not take."""
        return has_extra(self.program, self.batch(self.x.values[[0, -1]], self.y.values[[0, -1]]))

    def phase(self, x: Array, y: Array) -> float:
        """Radians of the highest mode over half a period, no less than these, on average of points (x, y)."""
        return float((self.batch(x, y).frequency * np.sqrt(self.size) * self.period / 2).mean())

    def rates(self, x: Array, y: Array) -> LineRates:
        """The equations at points (x, y), each a case."""
        return LineRates.of(self.assembly, self.table(x, y), self.statically_twisted)

    def exponentials(self, x: Array, y: Array) -> ChainExponentials:
        """Points (x, y) as lanes of the kernel of exponential steps."""
        steps = steps_that_see(fastest_cycles(self.assembly, self.period))
        return ChainExponentials(self.program, self.batch(x, y), self.period, steps)

    def _coefficients(self, x: Array, y: Array) -> LineCoefficients:
        return self.assembly.coefficients(self.table(x, y), statically_twisted=self.statically_twisted)

    def table(self, x: Array, y: Array) -> Array:
        """Packed numbers (point, column) at points (x, y)."""
        table = self.assembly.table(len(x), self.speed)
        self.x.columns.put(table, x)
        self.y.columns.put(table, y)
        return table

    def matrices(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array, Array]:
        """Monodromy matrices in the kernel's units, their errors and ∫ tr(M⁻¹C) dτ."""
        batch = self.batch(x, y)
        found, error, trace = self._integrated(batch, tolerance, threads)
        if self.size <= LARGEST_DENSE or self.set_aside:
            return found, error, trace
        rounding = self._rounding(batch, found)
        return found, np.minimum(error, RESERVE * self._compared[0] * error + rounding), trace

    def _rounding(self, batch: ChainBatch, found: Array) -> Array:
        """What rounding leaves of matrices ``found`` of the lanes of ``batch``."""
        size = np.sqrt((found**2).sum(axis=(1, 2)) / (2 * self.size))
        radians = batch.frequency * np.sqrt(self.size) * self.period
        return np.asarray(ROUNDING * radians * np.maximum(1.0, size))

    def _integrated(self, batch: ChainBatch, tolerance: float, threads: int) -> tuple[Array, Array, Array]:
        """As ``matrices``, with the kernel's own bounds."""
        return chain_monodromy(self.program, batch, self._window(self.program, batch), tolerance, threads)

    @cached_property
    def _compared(self) -> tuple[float, float]:
        """The largest share of the kernel's bound that errors reach, at the corners of the axes and between, and the
        largest bound over the tolerance that was asked for.

        The bound carries every step's error on as if nothing died out. Of long lines, whose fast modes do, it is a
        thousand times too large and more; so matrices of some points are compared with sharper ones. What rounding
        leaves is no share of a bound: the share is no less than what it hides where the bound is largest.
        """
        places = np.concatenate([[0.0, 0.0, 1.0, 1.0], np.mod(np.sqrt(2) * np.arange(1, BATCH - 3), 1.0)])
        others = np.concatenate([[0.0, 1.0, 0.0, 1.0], np.mod(np.sqrt(3) * np.arange(1, BATCH - 3), 1.0)])
        at = (axis.values[0] + share * (axis.values[-1] - axis.values[0])
              for axis, share in ((self.x, places), (self.y, others)))  # fmt: skip
        batch = self.batch(*at)
        rough, bound, _ = self._integrated(batch, COMPARED, 1)
        sharp = self._integrated(batch, COMPARED / 100, 1)[0]
        off, rounding = np.linalg.norm(rough - sharp, axis=(1, 2)), self._rounding(batch, sharp)
        share = np.maximum(off - rounding, 0.0) / bound
        if not np.isfinite(share).all():
            return 1.0, 1.0
        return float(max(share.max(), (rounding / bound).min())), float(bound.max() / COMPARED)

    def matrices_of(self, table: Array, tolerance: float, threads: int) -> Array:
        """Monodromy matrices of cases of packed numbers (case, column), over whole periods."""
        return chain_monodromy(self.program, self.batch_of(table), Window(0.0, self.period, False), tolerance, threads)[
            0
        ]

    def evaluate(self, x: Array, y: Array, tolerance: float, threads: int) -> tuple[Array, Array]:
        """See ``ChartFamily``."""
        return quantities(*self.matrices(x, y, tolerance / AMPLIFICATION.get(self.size, 4), threads))

    def over_whole_periods(self) -> LineFamily:
        """See ``ChartFamily``."""
        return replace(self, half_windows=False)

    def sampler(self, box: Box, pixels: int, tolerance: float, threads: int, *, slabs: bool = True) -> Sampler:
        """By slabs where the period spans many radians of the highest mode, else by plain integration."""
        if not slabs or pixels < FEWEST_PIXELS:
            return point_by_point(self, box, tolerance, threads)
        batch = self._patch_batch(*spread(box))
        program = self.program
        # One window serves the whole box, so it must suit every point of it: corners alone would not tell.
        window = self._window(program, batch)
        length = window.period / 2 if window.half else window.period
        # ν is the root mean square of the modes; the highest is at most √n times that.
        swiftest = float(batch.frequency.max())
        edges = slab_edges(swiftest * np.sqrt(self.size), *self._swiftness(spread(box, 5), window.begin, length))
        count = len(edges) - 1
        if count < FEWEST_SLABS:
            return point_by_point(self, box, tolerance, threads)
        # Slabs are so cheap that a sharper tolerance costs little, and every bound below grows with it.
        sharper = tolerance / (10 if self.size <= 2 else 100)

        def propagate(u: Array, v: Array, begin: float, stretch: float) -> tuple[Array, Array, Array]:
            asked = max(sharper / (4 * count), 1e-14)
            return chain_propagator(program, self._patch_batch(u, v), begin, stretch, asked, threads)

        built = build_slabs(propagate, box, edges, 2 * self.size, sharper / 4)
        if built is None:
            return point_by_point(self, box, tolerance, threads)

        def evaluate(grids: list[Grid]) -> list[tuple[Array, Array]]:
            return [
                quantities(*complete(program, self._grid_batch(grid), window, *parts, threads=threads))
                for grid, parts in zip(grids, on_threads(built.propagators, grids, threads), strict=True)
            ]

        # Products of slabs cost less than one integration, so no pixel is worth integrating by itself.
        strips, along_u = self._strips(box, swiftest), self.x.is_speed
        return Sampler(evaluate, -1, halved_across(evaluate, strips, along_u, tolerance) if len(strips) > 1 else strips)

    def leading(
        self, box: Box, pixels: int, tolerance: float, threads: int, report_progress: Callable[[float], None]
    ) -> PatchedFunction | None:
        """See ``ChartFamily``."""
        if self.set_aside or self.size > LARGEST_DENSE:
            return None
        batch = self._patch_batch(*spread(box, 6))
        half = self.half_windows and symmetry_phase(self.program, batch, self.period) is not None
        phase = batch.frequency * np.sqrt(self.size) * self.period / (2 if half else 1)
        elsewhere = without_groups(self.size, pixels, float(phase.mean()), float(phase.max()), FEWEST_PIXELS)
        corners = self.rates(*self._from_patch(*corners_of(box)))

        def points(u: Array, v: Array) -> ChainExponentials:
            return self.exponentials(*self._from_patch(u, v))

        return leading_patches(points, corners, box, pixels, tolerance, threads, elsewhere, report_progress)

    def whole_matrices(
        self, box: Box, pixels: int, tolerance: float, threads: int, report_progress: Callable[[float], None]
    ) -> PatchedFunction | None:
        """See ``ChartFamily``; only of lines too long for groups of multipliers."""
        if self.size <= LARGEST_DENSE:
            return None

        asked = self.sampled_to(tolerance)

        def sample(u: Array, v: Array) -> tuple[Array, Array, Array]:
            return self.matrices(*self._from_patch(u, v), asked, threads)

        most_nodes = NODES_FOR_PIXELS * pixels
        return matrix_patches(sample, box, 2 * self.size, tolerance, most_nodes, MOST_BYTES, report_progress)

    def sampled_to(self, tolerance: float) -> float:
        """What is asked of matrices of long lines, so that their errors stay well below ``tolerance``: more where those
        stay far below what is asked for, up to where that was found."""
        (share, grown), sampled = self._compared, SAMPLED * tolerance
        return max(sampled, min(SAMPLED * sampled / (RESERVE * share * grown), COMPARED))

    def differ(self, x: Array, y: Array) -> bool:
        """See ``ChartFamily``."""
        return LARGEST < 2 * self.size <= 2 * LARGEST_DENSE and distinguished(self.exponentials(x, y))

    def settled(self, x: Array, y: Array) -> Pixels | None:
        """See ``ChartFamily``."""
        if self.set_aside or not LARGEST < 2 * self.size <= 2 * LARGEST_DENSE:
            return None
        return self.step_halving(self.rates(x, y))

    def in_numpy(self, x: Array, y: Array) -> Pixels | None:
        """See ``ChartFamily``."""
        if len(x) > MOST_IN_NUMPY or compiling_pays() or not self.uncompiled:
            return None
        with instead_of_compiling():
            return self.stepped(x, y)

    def stepped(self, x: Array, y: Array) -> Pixels | None:
        """Points (x, y) by ``step_halving``; None where one is undamped, or the shortest steps do not tell."""
        rates = self.rates(x, y)
        if np.any(undamped(rates.trace, self.size)):
            return None
        found = self.step_halving(rates)
        return found if np.isfinite(found.radius).all() else None

    @property
    def uncompiled(self) -> bool:
        """Whether its matrices may be stepped in NumPy, and its kernels would have to be compiled."""
        if self.set_aside or self.size > LARGEST_DENSE:
            return False
        ends = self.batch(self.x.values[[0, -1]], self.y.values[[0, -1]])
        integrator = integrate_stages if has_extra(self.program, ends) else integrate_series
        by_steps = (integrate_exponentials,) if 2 * self.size > LARGEST else ()
        return not is_compiled(integrator, *by_steps, radii_on_rows)

    def step_halving(self, rates: LineRates, tolerance: float = 1e-10) -> Pixels:
        """The points of ``rates`` from exponential steps that are halved until the multipliers stay."""
        found = exponential_monodromies(
            rates, len(rates.table), 2 * self.size, self.period, tolerance=tolerance, least_steps=rates.steps
        )
        return Pixels.of(found.radius, found.error, found.critical, rates.trace, self.size)

    def _window(self, program: ChainProgram, batch: ChainBatch) -> Window:
        """The window that suits all ``batch``: half a period where every joint is even about one phase in each."""
        begin = symmetry_phase(program, batch, self.period) if self.half_windows else None
        return Window(0.0 if begin is None else begin, self.period, begin is not None)

    def _swiftness(self, points: tuple[Array, Array], begin: float, length: float) -> tuple[Array, Array]:
        """Input angles over a stretch, and the speed of the swiftest station over the input's at each."""
        topo = self.assembly.topology
        x, y = self._from_patch(*points)
        coefficients = self._coefficients(x, y)
        # Many points differ in numbers that move no joint, such as the speed.
        moving = [
            coefficients.shift,
            *(np.broadcast_to(part, (len(x), 1)) for law in coefficients.joints for part in law.numbers),
        ]
        unlike = np.unique(np.concatenate(moving, axis=1), axis=0, return_index=True)[1]
        coefficients = self._coefficients(x[unlike], y[unlike])
        tau = np.linspace(begin, begin + length, 801)
        speeds = np.abs(base_motion(topo, coefficients, tau).speed)
        return tau, np.maximum(speeds.max(axis=(0, 2)), 1.0)

    def _strips(self, box: Box, frequency: float) -> list[Box]:
        """Strips of 1/Ω across which the quantities oscillate as often as one patch resolves.

        Of coefficients the fastest is the product of n multipliers, a phase of at most n ν T at the lowest speed; of
        entries of the matrix the highest mode, √n ν T.
        """
        if not (self.x.is_speed or self.y.is_speed):
            return [box]
        low, high = (box.u0, box.u1) if self.x.is_speed else (box.v0, box.v1)
        fastest = frequency * (self.size if 2 * self.size <= LARGEST else np.sqrt(self.size))
        phase = fastest * self.period * (1 - low / high) / 2
        edges = np.linspace(low, high, max(1, int(np.ceil(phase / RESOLVED))) + 1)
        pairs = list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))
        if self.x.is_speed:
            return [Box(a, b, box.v0, box.v1) for a, b in pairs]
        return [Box(box.u0, box.u1, a, b) for a, b in pairs]

    def _patch_batch(self, u: Array, v: Array) -> ChainBatch:
        return self.batch(*self._from_patch(u, v))

    def _from_patch(self, u: Array, v: Array) -> tuple[Array, Array]:
        return self.from_patch(u, True), self.from_patch(v, False)

    def _grid_batch(self, grid: Grid) -> ChainBatch:
        u, v = grid
        return self._patch_batch(np.tile(u, len(v)), np.repeat(v, len(u)))

    def to_patch(self, value: Array, of_x: bool) -> Array:
        """1/Ω for a speed axis, the rapidity asinh(tan β) for a joint angle, the value itself otherwise.

        In β the singularities of η close in on 90° like cos β; in the rapidity cos β = 1/cosh v and they stay
        π/2 away from the real axis, so one patch reaches from 0° to the steepest angles. Joints are even in their
        angle: on one side of 0° the square of the rapidity needs half as many nodes.
        """
        axis = self.x if of_x else self.y
        if axis.is_speed:
            return np.asarray(1 / np.asarray(value))
        if axis.is_joint_angle:
            rapidity = np.asarray(np.arcsinh(np.tan(value)))
            return rapidity * np.abs(rapidity) if axis.one_sided else rapidity
        return np.asarray(value, dtype=float)

    def from_patch(self, value: Array, of_x: bool) -> Array:
        """The inverse of ``to_patch``."""
        axis = self.x if of_x else self.y
        if axis.is_speed:
            return np.asarray(1 / np.asarray(value))
        if axis.is_joint_angle:
            rapidity = np.sign(value) * np.sqrt(np.abs(value)) if axis.one_sided else np.asarray(value)
            return np.asarray(np.arctan(np.sinh(rapidity)))
        return np.asarray(value, dtype=float)


AMPLIFICATION = {1: 1.0, 2: 4.0, 3: 30.0}
"""How much an error of Z can grow in its coefficients (norms of N_k), by number of unknowns."""
RESOLVED = 20.0
"""Radians to either side of a patch's middle that its nodes resolve, with as many again for what is not a wave."""
SAMPLED = 0.25
"""Share of the tolerance that matrices of long lines are integrated to."""
COMPARED, RESERVE, ROUNDING = 1e-8, 10.0, 2e-15
"""Tolerance at which the kernel's bounds of long lines are compared with errors, by what the largest share of a bound
is multiplied, and rounding per radian of the fastest motion."""
NODES_FOR_PIXELS, MOST_BYTES = 0.8, 1e9
"""Matrices that may be spent for a pixel of a long line, which costs as much by itself; memory that they may take."""
FEWEST_SLABS = 3
"""Below this a slab is not much shorter than the period, and patching it saves nothing."""


MOST_IN_NUMPY = 1_000
"""Points that may be stepped at once in NumPy, lest a kernel be compiled."""
FEWEST_PIXELS = 20_000
"""Below this, pixels are integrated in less time than slabs are patched."""


@dataclass(frozen=True)
class Sampler:
    """``evaluate`` for ``patches.build``, the pixels up to which a box is not worth a patch, first boxes."""

    evaluate: Evaluate
    direct_below: float
    boxes: list[Box]


def point_by_point(family: ChartFamily, box: Box, tolerance: float, threads: int) -> Sampler:
    """Sample grids by plain evaluation of all their points in one call."""

    def evaluate(u: Array, v: Array) -> tuple[Array, Array]:
        return family.evaluate(family.from_patch(u, True), family.from_patch(v, False), tolerance, threads)

    return Sampler(grid_by_grid(evaluate), 0.8 * NODES**2, [box])


def spread(box: Box, count: int = 24) -> tuple[Array, Array]:
    """Points (u, v) all over a box: edges and ``count`` places per axis between them that share no period.

    What holds at the corners need not hold between them: a fork offset from 0 to 90° is symmetric at both ends.
    """
    places = np.concatenate([[0.0, 1.0], np.mod((np.sqrt(5) - 1) / 2 * np.arange(1, count + 1), 1.0)])
    u, v = box.u0 + places * (box.u1 - box.u0), box.v0 + places * (box.v1 - box.v0)
    return np.tile(u, len(v)), np.repeat(v, len(u))

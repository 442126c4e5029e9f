"""Derivative of the largest multiplier, exact through its Floquet mode and the adjoint of that.

A disturbance r(τ) of multiplier σ and its adjoint l(τ), right and left vector of the monodromy matrix carried over the
period with l·r = 1, give with x′ = A(τ)x

    ∂ ln σ/∂p = ∫ l(τ) ∂A/∂p r(τ) dτ   over one period,

to first order of perturbation theory. The integrand is periodic, so equal steps converge as its Fourier series does.
Where two multipliers meet neither has a derivative (theirs grows as the inverse of their distance), and where two of
different modes are equally large, the larger of them has none: both are refused.
(A. P. Seyranian and A. A. Mailybaev, *Multiparameter Stability Theory with Mechanical Applications*, 2003, ch. 9.)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.design.sensitivity.differences import CENTRAL, SMOOTH_STEP, central
from trunnion.design.sensitivity.directions import Direction, Neighbourhood
from trunnion.equations.linear import line_matrices, over_mass, periodic_linear_system, rigid_motions
from trunnion.equations.steady_base import require_steady_base
from trunnion.equations.topology import require_period
from trunnion.equations.tree_matrices import tree_matrices
from trunnion.floquet.propagation.floquet_modes import floquet_mode, judged_multipliers, propagated
from trunnion.floquet.propagation.tree_mode_motion import mode_motion
from trunnion.floquet.propagation.tree_modes import floquet_modes
from trunnion.floquet.stability.lagging import lagging_matrices, lagging_mode, lags_count
from trunnion.floquet.stability.stability import LONG
from trunnion.modes.mode_content import ModeMotion
from trunnion.numerics.spectrum import spectral_radius
from trunnion.waiting import keep_time

TOLERANCE = 1e-12
COALESCE = 1e-5
"""Relative error of a derivative by that of the monodromy matrix, from which two multipliers count as one."""
MOST_NUMBERS = 4_000_000
"""Entries of the matrices of lines beside one that are made together."""
EQUAL = 1e-9
"""Relative distance of two radii that count as equal."""


@dataclass(frozen=True)
class RadiusSlope:
    """Radius ρ of the largest multiplier; ∂ ln ρ/∂p along every direction (direction,) per unit of each, and its
    error; period [rad of input angle]; refused: why there is none, "" where there is."""

    radius: float
    period: float
    slope: Array
    error: Array
    refused: str = ""

    def growth_rate(self, speed: float) -> float:
        """Growth of the fastest disturbance [1/s]."""
        return float(np.log(self.radius) * speed / self.period)


def radius_slope(
    near: Neighbourhood, row: Array, directions: Sequence[Direction], axes: Sequence[Direction] = ()
) -> RadiusSlope:
    """Derivatives at one row (1, columns) of numbers, its speed included, of a line whose base motion is steady.

    Directions that are axes of a box, the speed for one, may follow as ``axes``.

    Raises
    ------
    InputError : no such line; see ``periodic_linear_system``.
    ComputationError : the integration did not settle.
    """
    every = [(one, True) for one in directions] + [(one, False) for one in axes]
    if lags_count(near.assembly, near.assembly.coefficients(row)):
        return _of_lagging(near, row, every)
    judged = _by_modes(near, row) or _by_the_period(near, row)
    none, radius = np.full(len(every), np.nan), judged.radius
    if not len(judged.multiplier):
        return RadiusSlope(1.0, judged.period, none, none, "the line can only turn as a whole")
    if isinstance(judged.motion, str):
        return RadiusSlope(radius, judged.period, none, none, judged.motion)
    slope, error = np.zeros((2, len(every)))
    for d, change in enumerate(_changes(near, row, every, judged)):
        whole, half = (float((part.mean() * judged.period).real) for part in (change, change[::2]))
        slope[d], error[d] = whole, abs(whole - half) + judged.relative * float(np.abs(change).mean() * judged.period)
    return RadiusSlope(radius, judged.period, slope, error)


def _of_lagging(near: Neighbourhood, row: Array, every: Sequence[tuple[Direction, bool]]) -> RadiusSlope:
    """Of a straight line some of whose torques lag: its equations are constant, ln σ = μ times the period with the
    eigenvalue μ of A/Ω, and ∂μ/∂p = l ∂(A/Ω)/∂p r."""
    period = 2 * np.pi * float(require_period(near.assembly.line, near.assembly.topology))
    found = lagging_mode(near.assembly, near.assembly.coefficients(row), period)
    none, radius = np.full(len(every), np.nan), float(np.abs(found.critical))
    if _equally_large(found.multiplier, found.critical, radius):
        return RadiusSlope(radius, period, none, none, _equal_words(radius))
    if not found.relative < COALESCE:
        return RadiusSlope(radius, period, none, none, _coalescing_words(found.critical, radius))
    slope, error = np.zeros((2, len(every)))
    for d, (one, follow) in enumerate(every):
        co = near.assembly.coefficients(near.rows(row, one, SMOOTH_STEP * CENTRAL, follow=follow))
        matrices = np.stack([matrix for _, matrix in lagging_matrices(near.assembly, co)]) / co.speed[:, None, None]
        change = central(matrices, SMOOTH_STEP * one.size)
        slope[d] = float((found.left @ change @ found.right).real) * period
        error[d] = found.relative * float(np.abs(found.left) @ np.abs(change) @ np.abs(found.right)) * period
    return RadiusSlope(radius, period, slope, error)


@dataclass(frozen=True)
class _CriticalMode:
    """multiplier: all that are judged; radius: of the largest; relative: error of a derivative by that of Z;
    motion: of the largest, or why it has no derivative."""

    multiplier: Complex
    radius: float
    period: float
    relative: float
    motion: ModeMotion | str


def _by_modes(near: Neighbourhood, row: Array) -> _CriticalMode | None:
    """Of a long line, from Hill's blocks along its tree; None where these do not tell all modes."""
    topo = near.assembly.topology
    if topo.size < LONG:
        return None
    co, turns = near.assembly.coefficients(row), require_period(near.assembly.line, topo)
    require_steady_base(near.assembly, row)
    modes = floquet_modes(topo, co, turns)
    if modes is None:
        return None
    values, period = modes.multiplier, 2 * np.pi * float(turns)
    radius, critical = float(spectral_radius(values, modes.error)[0]), complex(values[0])
    if _equally_large(values, critical, radius):
        return _CriticalMode(values, radius, period, np.inf, _equal_words(radius))
    distance = float(np.sort(np.abs(values - critical))[1])
    relative = 2 * float(modes.error[0]) / max(distance, 1e-300)
    motion = mode_motion(topo, co, turns, complex(modes.exponent[0]))
    if motion is None or not relative < COALESCE:
        return _CriticalMode(values, radius, period, relative, _coalescing_words(critical, radius))
    return _CriticalMode(values, radius, period, relative, motion)


def _by_the_period(near: Neighbourhood, row: Array) -> _CriticalMode:
    """From the matrices of a whole period."""
    assembly = near.assembly
    system = periodic_linear_system(assembly, row)
    run = propagated(system, TOLERANCE)
    values, bounds = judged_multipliers(run, rigid_motions(assembly.topology, assembly.coefficients(row)))
    if not len(values):
        return _CriticalMode(values, 1.0, system.period, np.inf, "")
    radius = float(spectral_radius(values, bounds)[0])
    critical = complex(values[int(np.argmax(np.abs(values)))])
    if _equally_large(values, critical, radius):
        return _CriticalMode(values, radius, system.period, np.inf, _equal_words(radius))
    motion = floquet_mode(system, run, critical)
    spread = np.linalg.eigvals(run.scaled_monodromy)
    distance = np.sort(np.abs(spread - critical))[1] if len(spread) > 1 else np.inf
    uncertain = run.error + 1e-15 * float(np.linalg.norm(run.scaled_monodromy, 2))
    condition = np.inf
    if motion is not None:
        condition = float(np.linalg.norm(motion.right[0] / run.scale) * np.linalg.norm(motion.left[0] * run.scale))
    relative = 2 * uncertain * condition / max(float(distance), 1e-300)
    if motion is None or not relative < COALESCE:
        return _CriticalMode(values, radius, system.period, relative, _coalescing_words(critical, radius))
    return _CriticalMode(values, radius, system.period, relative, motion)


def _equally_large(values: Complex, critical: complex, radius: float) -> bool:
    others = np.abs(values - critical) > 0
    others &= np.abs(values - critical.conjugate()) > 1e-12 * radius
    return bool(np.any(np.abs(values[others]) > radius * (1 - EQUAL)))


def _equal_words(radius: float) -> str:
    return f"two multipliers are equally large ({radius:.6g}), so the larger of them has none"


def _coalescing_words(critical: complex, radius: float) -> str:
    words = f"{critical.real:.6g}" if abs(critical.imag) < 1e-3 * radius else f"{critical:.6g}"
    return f"two multipliers coalesce at {words}"


def _changes(
    near: Neighbourhood, row: Array, every: Sequence[tuple[Direction, bool]], judged: _CriticalMode
) -> Iterator[Complex]:
    """l(τ) ∂A/∂p r(τ) (time,) along every direction."""
    motion = judged.motion
    assert isinstance(motion, ModeMotion)
    n, count = near.assembly.topology.size, len(motion.right)
    tau = judged.period * np.arange(count) / count
    whole = n < LONG or near.assembly.topology.graph
    look, together = (_whole, 1) if whole else (_along_tree, max(1, MOST_NUMBERS // (len(CENTRAL) * count * n)))
    for begin in range(0, len(every), together):
        some = every[begin : begin + together]
        keep_time()
        table = np.concatenate([near.rows(row, one, SMOOTH_STEP * CENTRAL, follow=follow) for one, follow in some])
        beside = look(near, table, tau, motion).reshape(len(some), len(CENTRAL), count)
        for (one, _), values in zip(some, beside, strict=True):
            yield -central(values, SMOOTH_STEP * one.size)


def _whole(near: Neighbourhood, table: Array, tau: Array, motion: ModeMotion) -> Complex:
    """l M⁻¹(K x/Ω² + C x′/Ω) (case, time) of lines beside one."""
    stiffness, damping = _per_mass(near, table, tau)
    n = stiffness.shape[-1]
    place, rate, adjoint = motion.right[:, :n], motion.right[:, n:], motion.left[:, n:]
    found: Complex = np.einsum("ti,ctij,tj->ct", adjoint, stiffness, place)
    return found + np.einsum("ti,ctij,tj->ct", adjoint, damping, rate)


def _along_tree(near: Neighbourhood, table: Array, tau: Array, motion: ModeMotion) -> Complex:
    """The same from the entries of a tree."""
    topo, co = near.assembly.topology, near.assembly.coefficients(table)
    m, n = tree_matrices(topo, co, tau), topo.size
    place, rate, adjoint = (part.T[:, None] for part in (motion.right[:, :n], motion.right[:, n:], motion.left[:, n:]))
    speed = co.speed[:, None]
    weight = adjoint / m.mass.own
    total = np.zeros((len(table), len(tau)), dtype=complex)
    tied = np.flatnonzero(m.parent >= 0)
    front = m.parent[tied]
    for entries, moved in ((m.stiffness, place / speed**2), (m.damping, rate / speed)):
        total += (weight * entries.own * moved).sum(axis=0)
        total += (weight[tied] * entries.down[tied] * moved[front]).sum(axis=0)
        total += (weight[front] * entries.up[tied] * moved[tied]).sum(axis=0)
    return total


def _per_mass(near: Neighbourhood, table: Array, tau: Array) -> tuple[Array, Array]:
    """M⁻¹K/Ω² and M⁻¹C/Ω (case, time, n, n) at input angles τ, each case at its own speed."""
    co = near.assembly.coefficients(table)
    m = line_matrices(near.assembly.topology, co, tau)
    speed = co.speed[:, None, None, None]
    return over_mass(m, m.stiffness) / speed**2, over_mass(m, m.damping) / speed

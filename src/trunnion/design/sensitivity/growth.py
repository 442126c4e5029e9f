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

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.design.sensitivity.differences import CENTRAL, SMOOTH_STEP, central
from trunnion.design.sensitivity.directions import Direction, Neighbourhood
from trunnion.equations.linear import line_matrices, over_mass, periodic_linear_system, rigid_motions
from trunnion.floquet.propagation.floquet_modes import floquet_mode, judged_multipliers, propagated
from trunnion.numerics.spectrum import spectral_radius

TOLERANCE = 1e-12
COALESCE = 1e-5
"""Relative error of a derivative by that of the monodromy matrix, from which two multipliers count as one."""
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
    assembly = near.assembly
    system = periodic_linear_system(assembly, row)
    run = propagated(system, TOLERANCE)
    co = assembly.coefficients(row)
    values, bounds = judged_multipliers(run, rigid_motions(assembly.topology, co))
    every = [(one, True) for one in directions] + [(one, False) for one in axes]
    none = np.full(len(every), np.nan)
    if not len(values):
        return RadiusSlope(1.0, system.period, none, none, "the line can only turn as a whole")
    radius = float(spectral_radius(values, bounds)[0])
    critical = complex(values[int(np.argmax(np.abs(values)))])

    def without(why: str) -> RadiusSlope:
        return RadiusSlope(radius, system.period, none, none, why)

    others = np.abs(values - critical) > 0
    others &= np.abs(values - critical.conjugate()) > 1e-12 * radius
    if np.any(np.abs(values[others]) > radius * (1 - EQUAL)):
        return without(f"two multipliers are equally large ({radius:.6g}), so the larger of them has none")
    motion = floquet_mode(system, run, critical)
    spread = np.linalg.eigvals(run.scaled_monodromy)
    distance = np.sort(np.abs(spread - critical))[1] if len(spread) > 1 else np.inf
    uncertain = run.error + 1e-15 * float(np.linalg.norm(run.scaled_monodromy, 2))
    condition = np.inf
    if motion is not None:
        condition = float(np.linalg.norm(motion.right[0] / run.scale) * np.linalg.norm(motion.left[0] * run.scale))
    relative = 2 * uncertain * condition / max(float(distance), 1e-300)
    if motion is None or not relative < COALESCE:
        words = f"{critical.real:.6g}" if abs(critical.imag) < 1e-3 * radius else f"{critical:.6g}"
        return without(f"two multipliers coalesce at {words}")
    n, count = system.size, len(motion.right)
    tau = system.period * np.arange(count) / count
    place, rate, adjoint = motion.right[:, :n], motion.right[:, n:], motion.left[:, n:]
    slope, error = np.zeros((2, len(every)))
    for d, (one, follow) in enumerate(every):
        table = near.rows(row, one, SMOOTH_STEP * CENTRAL, follow=follow)
        stiffness, damping = _per_mass(near, table, tau)
        change = -np.einsum("ti,tij,tj->t", adjoint, central(stiffness, SMOOTH_STEP * one.size), place)
        change -= np.einsum("ti,tij,tj->t", adjoint, central(damping, SMOOTH_STEP * one.size), rate)
        whole, half = (float((part.mean() * system.period).real) for part in (change, change[::2]))
        slope[d], error[d] = whole, abs(whole - half) + relative * float(np.abs(change).mean() * system.period)
    return RadiusSlope(radius, system.period, slope, error)


def _per_mass(near: Neighbourhood, table: Array, tau: Array) -> tuple[Array, Array]:
    """M⁻¹K/Ω² and M⁻¹C/Ω (case, time, n, n) at input angles τ, each case at its own speed."""
    co = near.assembly.coefficients(table)
    m = line_matrices(near.assembly.topology, co, tau)
    speed = co.speed[:, None, None, None]
    return over_mass(m, m.stiffness) / speed**2, over_mass(m, m.damping) / speed

"""A line's linearised equations as x′ = A(τ) x for many cases at once, in units that make its states alike.

States are (x√m, dx/dτ √m/ν) with the mean inertias m and a typical frequency ν per radian of input angle, so that the
entries of A and of a monodromy matrix are comparable.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from threading import get_ident

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import LineMatrices, line_matrices, over_mass, rigid_motions
from trunnion.equations.topology import require_period

LARGEST_DENSE = 12
"""Unknowns up to which products of dense matrices cost less than the chain kernel."""
STEPS_PER_CYCLE = 4
FEWEST_STEPS = 8
FEWEST_SAMPLES = 64


def period_of(assembly: Assembly) -> float:
    """Period of the coefficients [rad of input angle].

    Raises
    ------
    InputError : no period.
    """
    return 2 * np.pi * float(require_period(assembly.line, assembly.topology))


def fastest_cycles(assembly: Assembly, period: float) -> float:
    """Cycles of the fastest coefficient over a period."""
    return max((float(rate) for rate in assembly.topology.rates), default=1.0) * period / (2 * np.pi)


def steps_that_see(cycles: float) -> int:
    """Steps, a power of two, that cannot leap over ``cycles`` of the coefficients."""
    return max(FEWEST_STEPS, 1 << int(np.ceil(np.log2(max(STEPS_PER_CYCLE * cycles, 1.0)))))


@dataclass(frozen=True)
class LineRates:
    """The equations of the cases of ``table`` (case, column).

    root (case, n): √m; unit (case,): ν; trace (case,): ∫ tr(M⁻¹C) dτ over the period; steps: as many as see the fastest
    coefficient; kept: by thread.
    """

    assembly: Assembly
    table: Array
    twisted: bool
    period: float
    root: Array
    unit: Array
    trace: Array
    steps: int
    kept: dict[int, tuple[Places, LineCoefficients]] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def of(cls, assembly: Assembly, table: Array, statically_twisted: bool) -> LineRates:
        """Raises InputError where the line has no period."""
        period = period_of(assembly)
        cycles = fastest_cycles(assembly, period)
        times = max(FEWEST_SAMPLES, 16 * int(np.ceil(cycles)))
        co = assembly.coefficients(table, statically_twisted=statically_twisted)
        probe = line_matrices(assembly.topology, co, period * np.arange(times) / times)
        root, unit = scales(probe, co.speed)
        trace = np.einsum("ctii->ct", over_mass(probe, probe.damping)).mean(axis=1) * period / co.speed
        return cls(assembly, table, statically_twisted, period, root, unit, trace, steps_that_see(cycles))

    def __call__(self, which: Places, tau: Array) -> Array:
        """A (case, time, 2n, 2n) of the cases ``which`` at input angles ``tau``."""
        co = self._coefficients(which)
        matrices = line_matrices(self.assembly.topology, co, tau)
        return first_order(matrices, co.speed, self.root[which], self.unit[which])

    def _coefficients(self, which: Places) -> LineCoefficients:
        """Of the cases ``which``; those of the last ones asked for are kept, as a run asks at many times."""
        kept = self.kept.get(get_ident())
        if kept is None or not np.array_equal(kept[0], which):
            co = self.assembly.coefficients(self.table[which], statically_twisted=self.twisted)
            kept = self.kept[get_ident()] = (which.copy(), co)
        return kept[1]

    def rest(self) -> Array | None:
        """Orthonormal columns (case, 2n, left) beside the motions that a line keeps for ever; None where it has none.

        What is left of a monodromy matrix Z is restᵀ Z rest.
        """
        topo = self.assembly.topology
        aside = rigid_motions(topo, self.assembly.coefficients(self.table, statically_twisted=self.twisted))
        if not aside.shape[1]:
            return None
        scaled = aside * np.concatenate([self.root, self.root / self.unit[:, None]], axis=1)[:, :, None]
        return np.asarray(np.linalg.qr(scaled, mode="complete")[0][:, :, aside.shape[1] :])


def scales(m: LineMatrices, speed: Array) -> tuple[Array, Array]:
    """√m (case, n) and ν (case,) of matrices in time."""
    root = np.sqrt(np.einsum("ctii->cti", m.mass).mean(axis=1))
    stiffness = np.einsum("ctii->cti", m.stiffness).mean(axis=1) / root**2
    return root, np.sqrt(np.maximum(np.abs(stiffness).mean(axis=1), 1e-300)) / speed


def first_order(m: LineMatrices, speed: Array, root: Array, unit: Array) -> Array:
    """A (case, time, 2n, 2n) from matrices in time."""
    n = m.mass.shape[-1]
    ratio = root[:, None, :, None] / root[:, None, None, :]
    a = np.zeros((*m.mass.shape[:2], 2 * n, 2 * n))
    a[..., :n, n:] = np.eye(n) * unit[:, None, None, None]
    a[..., n:, :n] = over_mass(m, m.stiffness) * (ratio / (-(speed**2) * unit)[:, None, None, None])
    a[..., n:, n:] = over_mass(m, m.damping) * (ratio / -speed[:, None, None, None])
    return a

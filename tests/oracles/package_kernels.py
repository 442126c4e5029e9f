"""The package's compiled chain kernel on one line, for tests that compare it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import trunnion as tn
from trunnion.equations.chain_batch import chain_batch, chain_program, loaded_by_speed
from trunnion.equations.coefficients import assemble
from trunnion.equations.topology import require_period
from trunnion.numerics.chain.chain_monodromy import Window, chain_monodromy, symmetry_phase
from trunnion.numerics.spectrum import multipliers, spectral_radius

Array = NDArray[np.float64]


def chain_kernel(
    line: tn.Driveline, speed: float | Array, tolerance: float = 1e-10, *, halved: bool = True
) -> tuple[Array, Array, Array]:
    """Scaled Z (speeds, 2n, 2n), its error and ∫ tr(M⁻¹C) dτ; by half periods where the joints allow."""
    assembly = assemble(line)
    table = assembly.table(np.size(speed))
    table[:, 0] = speed
    topo = assembly.topology
    coefficients = assembly.coefficients(table)
    by_speed = loaded_by_speed(topo, coefficients)
    program, batch = chain_program(topo, coefficients, by_speed), chain_batch(topo, coefficients, by_speed)
    period = 2 * np.pi * float(require_period(line, topo))
    begin = symmetry_phase(program, batch, period) if halved else None
    window = Window(0.0 if begin is None else begin, period, begin is not None)
    return chain_monodromy(program, batch, window, tolerance)


def chain_radius(line: tn.Driveline, speed: float | Array, tolerance: float = 1e-10) -> tuple[Array, Array]:
    """Spectral radius and its reported error at each speed."""
    matrix, error, _ = chain_kernel(line, speed, tolerance)
    return spectral_radius(*multipliers(matrix, error))

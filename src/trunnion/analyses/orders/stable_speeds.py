"""At which speeds the steady response is reached: Floquet verdicts at many speeds, from the compiled chain kernel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.charts.chart_families import quantities
from trunnion.analyses.charts.chart_pixels import judge, judge_matrices
from trunnion.equations.coefficients import Assembly, LineCoefficients
from trunnion.equations.lanes import chain_lanes, chain_program, loaded_by_speed
from trunnion.equations.linear import line_matrices
from trunnion.equations.steady_base import bent
from trunnion.equations.topology import require_period
from trunnion.numerics.chain.chain_monodromy import Window, chain_monodromy
from trunnion.results.verdict import Verdict

Array = NDArray[np.float64]
Codes = NDArray[np.int8]
TOLERANCE = 1e-7
GROWS = 1e-9
"""Real part of an eigenvalue, relative to the largest, from which a straight line counts as unstable."""


def verdicts_at(assembly: Assembly, speed: Array, *, statically_twisted: bool = True) -> Codes:
    """Codes of ``Verdict`` (speed,) at every ``speed`` [rad/s]; FAILED where a loss factor holds at all frequencies.

    Such a loss has no equations in time, so that no multipliers exist.
    """
    table = assembly.table(len(speed))
    table[:, 0] = speed
    co = assembly.coefficients(table, statically_twisted=statically_twisted, any_frequency=True)
    varies = bent(assembly) or bool(co.waves)
    if co.loss.any() and varies:
        return np.full(len(speed), Verdict.FAILED, dtype=np.int8)
    return _periodic(assembly, co) if varies else _straight(assembly, co)


def _periodic(assembly: Assembly, co: LineCoefficients) -> Codes:
    topo, by_speed = assembly.topology, loaded_by_speed(assembly.topology, co)
    window = Window(0.0, 2 * np.pi * float(require_period(assembly.line, topo)), False)
    lanes = chain_lanes(topo, co, by_speed)
    matrix, error, trace = chain_monodromy(chain_program(topo, by_speed), lanes, window, TOLERANCE)
    if topo.free:
        values, bounds = quantities(matrix, error, trace)
        return judge(values.T.copy(), bounds.T.copy(), topo.size, True).verdict
    return judge_matrices(matrix, error, trace).verdict


def _straight(assembly: Assembly, co: LineCoefficients) -> Codes:
    """Only a drive whose torque grows with the speed can make a straight line unstable."""
    stable = np.full(len(co.speed), Verdict.STABLE, dtype=np.int8)
    if not np.any((co.viscous < 0) | (co.quadratic < 0)):
        return stable
    m = line_matrices(assembly.topology, co, np.zeros(1))
    mass, damping, stiffness = m.mass[:, 0], m.damping[:, 0], m.stiffness[:, 0]
    n = mass.shape[-1]
    system = np.zeros((len(stable), 2 * n, 2 * n))
    system[:, :n, n:] = np.eye(n)
    system[:, n:, :n], system[:, n:, n:] = -np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)
    values = np.linalg.eigvals(system)
    grows = values.real.max(axis=1) > GROWS * np.abs(values).max(axis=1)
    return np.where(grows, Verdict.UNSTABLE, stable).astype(np.int8)

"""At which speeds the steady response is reached: Floquet verdicts at many speeds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array, Codes
from trunnion.equations.coefficients import Assembly
from trunnion.equations.first_order import first_order, scales
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import line_matrices
from trunnion.equations.steady_base import has_joint_angles
from trunnion.floquet.stability.lagging import lagging_matrices
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.results.verdict import Verdict

if TYPE_CHECKING:
    from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed

GROWS = 1e-9
"""Real part of an eigenvalue, relative to the largest, from which a straight line counts as unstable."""


def verdicts_at(
    assembly: Assembly,
    speed: Array,
    *,
    statically_twisted: bool = True,
    motions: SteadyStatesBySpeed | None = None,
    table: Array | None = None,
) -> Codes:
    """Codes of ``Verdict`` (speed,) at every ``speed`` [rad/s]; FAILED where a loss factor holds at all frequencies,
    which has no equations in time, so that no multipliers exist, and where the computation failed.
    ``motions``: periodic steady states that are known already; ``table`` as of ``stability_along``.
    """
    if every := assembly.each(speed) if table is None else assembly.each_of(table):
        parts = [
            verdicts_at(one, speed[[i]], statically_twisted=statically_twisted) for i, one in enumerate(every)
        ]  # fmt: skip
        return np.concatenate(parts)
    table = assembly.table(len(speed), speed) if table is None else table
    co = assembly.coefficients(table, statically_twisted=statically_twisted, any_frequency=True)
    varies = has_joint_angles(assembly) or bool(co.waves)
    if co.loss.any() and varies:
        return np.full(len(speed), Verdict.FAILED, dtype=np.int8)
    if varies:
        along = stability_along(assembly, speed, statically_twisted=statically_twisted, motions=motions, table=table)
        return along.verdict
    return _straight(assembly, co)


def _straight(assembly: Assembly, co: LineCoefficients) -> Codes:
    """Only what feeds energy in makes a straight line unstable: negative damping, a drive whose torque grows with the
    speed, also where only the slope of a torque that lags makes up for it."""
    stable = np.full(len(co.speed), Verdict.STABLE, dtype=np.int8)
    if not co.fed:
        return stable
    if co.loss.any():
        return np.full_like(stable, Verdict.FAILED)
    if co.lags:
        matrices = np.stack([matrix for _, matrix in lagging_matrices(assembly, co)])
    else:
        m = line_matrices(assembly.topology, co, np.zeros(1))
        matrices = first_order(m, co.speed, *scales(m, co.speed))[:, 0]
    values = np.linalg.eigvals(matrices)
    grows = values.real.max(axis=1) > GROWS * np.abs(values).max(axis=1)
    return np.where(grows, Verdict.UNSTABLE, stable).astype(np.int8)

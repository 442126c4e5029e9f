"""What the compiled equations of a line read, of many rows of its packed numbers at once.

Most numbers of a line are where they stand alone: those of springs with stages, clutches, pendulums, torques and joints
that are Fourier series are put row by row. Of any other line one row is written out, and the others differ from it by
arrays.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.line_regimes import line_kernel, staged_springs
from trunnion.equations.line_system import LineSystem
from trunnion.laws.hooke import CrossLaw


def numbers_of_rows(line: LineSystem, table: Array, co: LineCoefficients) -> Array:
    """(case, number) of rows ``table`` (case, column), of which ``co`` are the coefficients about zero twist."""
    if not (len(table) and _in_arrays(line, table[0], co)):
        return np.stack([line.numbers(row, known=co, case=i) for i, row in enumerate(table)])
    topo, core = line.assembly.topology, line_kernel()
    found = np.repeat(line.numbers(table[0], known=co)[None], len(table), axis=0)
    found[:, core.OMEGA] = table[:, 0]
    at = core.HEAD + core.PER_STATION * len(topo.stations)
    stations = found[:, core.HEAD : at].reshape(len(table), -1, core.PER_STATION)
    springs = found[:, at : at + core.PER_COMPLIANCE * len(topo.compliances)]
    springs = springs.reshape(len(table), -1, core.PER_COMPLIANCE)
    stations[..., core.INERTIA], stations[..., core.LOAD] = co.inertia, co.load * np.sign(topo.mean_speeds)
    stations[..., core.VISCOUS], stations[..., core.QUADRATIC] = co.viscous, co.quadratic
    springs[..., core.STIFFNESS], springs[..., core.DAMPING] = co.stiffness, co.damping
    added = co.shift.copy()
    for s, law in zip(topo.joints, co.joints, strict=True):
        assert isinstance(law, CrossLaw)
        stations[:, s, core.PHASE] = added @ line.carried[s]
        added[:, s] += law.turned
        t = np.ravel(law.t)
        stations[:, s, core.SIZE], stations[:, s, core.COSINE] = t, np.ravel(law.cosine)
        stations[:, s, core.SQUARE] = 4 * t / (1 + t) ** 2
    return found


def _in_arrays(line: LineSystem, row: Array, co: LineCoefficients) -> bool:
    topo = line.assembly.topology
    acting = line.torques or line.sliders or line.clutches or line.pendulums or line.converters or topo.converting
    plain = not (acting or topo.lost or line.leaves or staged_springs(line.assembly, row))
    return bool(plain and all(isinstance(law, CrossLaw) for law in co.joints))

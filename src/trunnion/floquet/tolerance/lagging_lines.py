"""Stability of many straight lines some of whose torques lag behind the speed, by the eigenvalues of their matrices."""

from __future__ import annotations

import numpy as np

from trunnion.equations.coefficients import Assembly
from trunnion.equations.line_coefficients import LineCoefficients
from trunnion.equations.linear import rigid_motions
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.stability.lagging import lagging_matrices


def lagging_pixels(assembly: Assembly, coefficients: LineCoefficients, period: float) -> Pixels:
    """Radius, error, critical multiplier and verdict of every case, over a ``period`` [rad of input angle]."""
    aside = rigid_motions(assembly.topology, coefficients).shape[1]
    matrices = np.stack([matrix for _, matrix in lagging_matrices(assembly, coefficients)])
    matrices /= coefficients.speed[:, None, None]
    values, right = np.linalg.eig(matrices)
    sizes = np.linalg.norm(right, axis=1) * np.linalg.norm(np.linalg.inv(right), axis=2)
    off = np.finfo(float).eps * matrices.shape[1] * np.linalg.norm(matrices, axis=(1, 2))[:, None] * sizes
    moduli = np.exp(values.real * period)
    moduli[np.arange(len(values))[:, None], np.argsort(np.abs(values), axis=1)[:, :aside]] = -1.0
    most = moduli.argmax(axis=1)
    own = np.arange(len(values))
    critical = np.exp(values[own, most].astype(complex) * period)
    radius = np.abs(critical)
    trace = -np.trace(matrices, axis1=1, axis2=2) * period
    return Pixels.of(radius, off[own, most] * period * radius, critical, trace, assembly.topology.size)

"""Values of a parameter at which a box is searched first: evenly, or by equal ratios where it spans decades."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.coefficients import Assembly
from trunnion.floquet.charts.axes import ChartAxis

DAMPING = ("damping", "loss_factor", "relative_damping", "mesh_damping", "damping_ratio")
"""Numbers of a description that damp."""
DECADES = 2
"""Decades from which on a range is searched by equal ratios."""
FAINTEST = 1e-6
"""Share of the largest damping from which on a range that starts at none is searched by equal ratios."""


def levels_of(axis: ChartAxis, count: int, own: float | None = None) -> Array:
    """``count`` values (values,) along an axis, rising, and ``own`` among them where it lies inside.

    Damping acts over decades: of a range that starts at none, half of the values stand by equal ratios.
    """
    low, high = float(axis.values[0]), float(axis.values[-1])
    if low > 0 and high >= low * 10.0**DECADES:
        levels = np.geomspace(low, high, count)
    elif low == 0 and axis.label.rpartition(".")[2] in DAMPING:
        half = count // 2
        levels = np.concatenate([np.linspace(low, high, count - half), np.geomspace(FAINTEST * high, high, half + 1)])
    else:
        levels = np.linspace(low, high, count)
    inside = [own] if own is not None and low < own < high else []
    levels = np.unique(np.concatenate([levels, inside]))
    levels[[0, -1]] = low, high
    return levels


def own_value(assembly: Assembly, axis: ChartAxis) -> float | None:
    """The value that the line itself has of the parameter of ``axis``; None where several numbers differ."""
    columns = axis.columns
    if not len(columns.index) or np.any(columns.slope == 0):
        return None
    values = (assembly.packed.values[columns.index] - columns.offset) / columns.slope
    return float(values[0]) if np.ptp(values) <= 1e-12 * abs(values[0]) else None

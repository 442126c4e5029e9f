"""Derivatives of natural frequencies and damping ratios, exact through the modes.

    (λ²M + λC + K ± iH) x = 0:    λ′ = −yᵀ(λ²M′ + λC′ + K′ ± iH′)x / yᵀ(2λM + C)x

The matrices are symmetric, so y = x. Frequencies are those of the damped line, ω_d = Im λ. The coefficients are low
polynomials or smooth functions of the description's numbers: their own derivatives by differences of fourth order hold
to rounding.
(R. L. Fox and M. P. Kapoor, Rates of change of eigenvalues and eigenvectors, AIAA Journal 6 (1968) 2426.)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.design.sensitivity.differences import CENTRAL, SMOOTH_STEP, central
from trunnion.design.sensitivity.directions import Direction, Neighbourhood
from trunnion.design.sensitivity.result import EXACT, SensitivityQuantity, SensitivityRows
from trunnion.equations.aligned import AlignedMatrices, UnitMasses, loaded_matrices
from trunnion.modes.natural_frequencies import natural_frequencies

ROUNDING = 1e-11
"""Share of a slope that rounding may change."""
COINCIDE = 1e-7
"""Relative distance below which two modes count as one frequency, which has no derivative of its own."""


def mode_slopes(near: Neighbourhood, directions: Sequence[Direction]) -> Iterator[SensitivityRows]:
    """Frequencies [rad/s] and damping ratios [-] of every elastic mode of the aligned line along every direction."""
    assembly = near.assembly
    topo = assembly.topology
    found = natural_frequencies(assembly)
    first = found.still
    values = found.eigenvalue[first:, 0]

    def matrices(table: Array) -> AlignedMatrices:
        return loaded_matrices(topo, assembly.coefficients(table, any_frequency=True), np.zeros(len(table)))

    here = matrices(near.row())
    mass, damping = here.inertia[0], here.damping[0]
    vectors = UnitMasses(mass).rotations(found.modes.shape[:, first:])
    oscillating = np.flatnonzero(~found.overdamped[first:])
    frequency_slope, ratio_slope = np.full((2, len(values), len(directions)), np.nan)
    for d, one in enumerate(directions):
        step = SMOOTH_STEP
        beside = matrices(near.rows(near.row(), one, step * CENTRAL))
        dm, dc, dk, dh = (
            central(part, step * one.size) for part in (beside.inertia, beside.damping, beside.stiffness, beside.loss)
        )
        for m in oscillating:
            value, x = values[m], vectors[:, m]
            top = value**2 * (x @ dm @ x) + value * (x @ dc @ x) + x @ (dk + 1j * dh) @ x
            change = -top / (2 * value * (x @ mass @ x) + x @ damping @ x)
            frequency_slope[m, d], ratio_slope[m, d] = change.imag, _ratio_slope(value, change)
    names = [f"mode {m}" for m in range(first + 1, first + 1 + len(values))]
    refused = [_refused(values, m, first) for m in range(len(values))]
    frequency_slope[np.array(refused) != ""] = np.nan
    ratio_slope[np.array(refused) != ""] = np.nan
    frequencies = [
        SensitivityQuantity(f"natural frequency of {name}", "frequency", float(w), "rad/s", EXACT, refused=why)
        for name, w, why in zip(names, found.frequency[first:], refused, strict=True)
    ]
    yield SensitivityRows(frequencies, frequency_slope, ROUNDING * np.abs(frequency_slope))
    ratio = found.damping_ratio[first:]
    damped = np.flatnonzero(ratio != 0) if np.any(ratio_slope) else np.zeros(0, dtype=int)
    ratios = [
        SensitivityQuantity(
            f"damping ratio of {names[m]}", "damping ratio", float(ratio[m]), "1", EXACT, refused=refused[m]
        )
        for m in damped
    ]
    yield SensitivityRows(ratios, ratio_slope[damped], ROUNDING * np.abs(ratio_slope[damped]))


def _ratio_slope(value: complex, change: complex) -> float:
    """Derivative of −Re λ/|λ|."""
    size = abs(value)
    return float(-change.real / size + value.real * (value.conjugate() * change).real / size**3)


def _refused(values: Complex, m: int, first: int) -> str:
    """Why a mode has no derivative of its own; "" where it has."""
    if values[m].imag == 0:
        return "it is overdamped and does not oscillate"
    for j in range(len(values)):
        if j != m and abs(values[j] - values[m]) <= COINCIDE * abs(values[m]):
            return f"modes {min(m, j) + first + 1} and {max(m, j) + first + 1} have one frequency"
    return ""

"""Derivatives of natural frequencies and damping ratios, exact through the modes.

    (λ²M + λC + K ± iH) x = 0:    λ′ = −yᵀ(λ²M′ + λC′ + K′ ± iH′)x / yᵀ(2λM + C)x

The matrices are symmetric, so y = x. Undamped, 2ω ω′ = xᵀ(K′ − ω²M′)x/(xᵀMx). The coefficients are low polynomials or
smooth functions of the description's numbers: their own derivatives by differences of fourth order hold to rounding.
(R. L. Fox and M. P. Kapoor, Rates of change of eigenvalues and eigenvectors, AIAA Journal 6 (1968) 2426.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.analyses.linear.natural_frequencies import damped_modes, natural_frequencies
from trunnion.analyses.sensitivity.differences import CENTRAL, SMOOTH_STEP, central
from trunnion.analyses.sensitivity.directions import Direction, Neighbourhood
from trunnion.arrays import Array, Complex
from trunnion.equations.aligned import AlignedMatrices, aligned_matrices

COINCIDE = 1e-7
"""Relative distance below which two modes count as one frequency, which has no derivative of its own."""


@dataclass(frozen=True)
class ModeSlopes:
    """value (mode,), slope and error (mode, direction) of frequency [rad/s] and damping ratio [1]; refused: by mode,
    why there is none ("" where there is); numbers: of the modes, from 1."""

    numbers: tuple[int, ...]
    frequency: Array
    ratio: Array
    frequency_slope: Array
    ratio_slope: Array
    refused: tuple[str, ...]
    ratio_refused: tuple[str, ...]


def mode_slopes(near: Neighbourhood, directions: Sequence[Direction]) -> ModeSlopes:
    """Of every elastic mode of the aligned line along every direction."""
    assembly = near.assembly
    topo = assembly.topology
    found = natural_frequencies(assembly)
    first = int(found.rigid_body)
    omega, shape = found.frequency[first:], found.shape[:, first:]

    def matrices(table: Array) -> AlignedMatrices:
        return aligned_matrices(topo, assembly.coefficients(table, any_frequency=True))

    here = matrices(near.row())
    mass, damping, complex_stiffness = here.mass[0], here.damping[0], here.stiffness[0] + 1j * here.loss[0]
    weight = np.einsum("im,i,im->m", shape, mass, shape)
    root = np.sqrt(mass)
    over = 1 / np.outer(root, root)
    values, scaled = damped_modes(damping * over, complex_stiffness * over, float(omega.min(initial=np.inf)))
    vectors = scaled / root[:, None]
    matched = _matched(values, found.damping_ratio[first:])
    frequency_slope, ratio_slope = np.zeros((2, len(omega), len(directions)))
    for d, one in enumerate(directions):
        step = SMOOTH_STEP
        beside = matrices(near.rows(near.row(), one, step * CENTRAL))
        dm, dc, dk, dh = (
            central(part, step * one.size) for part in (beside.mass, beside.damping, beside.stiffness, beside.loss)
        )
        change = np.einsum("im,ij,jm->m", shape, dk, shape) - omega**2 * np.einsum("im,i,im->m", shape, dm, shape)
        frequency_slope[:, d] = change / (2 * omega * weight)
        for m, place in enumerate(matched):
            if place < 0:
                continue
            value, x = values[place], vectors[:, place]
            top = value**2 * (x * dm) @ x + value * (x @ dc @ x) + x @ (dk + 1j * dh) @ x
            bottom = 2 * value * (x * mass) @ x + x @ damping @ x
            ratio_slope[m, d] = _ratio_slope(value, -top / bottom)
    refused = tuple(_coincides(omega, m, first) for m in range(len(omega)))
    words = "it does not oscillate: a damping ratio near 1 has no derivative here"
    unmatched = tuple(refused[m] or ("" if place >= 0 else words) for m, place in enumerate(matched))
    for m in range(len(omega)):
        frequency_slope[m] = np.nan if refused[m] else frequency_slope[m]
        ratio_slope[m] = np.nan if unmatched[m] else ratio_slope[m]
    numbers = tuple(range(first + 1, first + 1 + len(omega)))
    return ModeSlopes(
        numbers, omega, found.damping_ratio[first:], frequency_slope, ratio_slope, refused, unmatched
    )  # fmt: skip


def _matched(values: Complex, ratio: Array) -> list[int]:
    """Which damped eigenvalue has the damping ratio of each mode: by modulus, where all modes oscillate; else −1."""
    if len(values) == len(ratio) and np.allclose(-values.real / np.abs(values), ratio, rtol=1e-9, atol=1e-12):
        return list(range(len(ratio)))
    return [-1] * len(ratio)


def _ratio_slope(value: complex, change: complex) -> float:
    """Derivative of −Re λ/|λ|."""
    size = abs(value)
    return float(-change.real / size + value.real * (value.conjugate() * change).real / size**3)


def _coincides(omega: Array, m: int, first: int) -> str:
    for j in range(len(omega)):
        if j != m and abs(omega[j] - omega[m]) <= COINCIDE * omega[m]:
            return f"modes {min(m, j) + first + 1} and {max(m, j) + first + 1} have one frequency"
    return ""

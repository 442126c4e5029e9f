"""Derivatives of natural frequencies and damping ratios, exact through the modes.

    (λ²M + λC + K ± iH) x = 0:    λ′ = −yᵀ(λ²M′ + λC′ + K′ ± iH′)x / yᵀ(2λM + C)x

The matrices are symmetric, so y = x. Undamped, 2ω ω′ = xᵀ(K′ − ω²M′)x/(xᵀMx). The coefficients are low polynomials or
smooth functions of the description's numbers: their own derivatives by differences of fourth order hold to rounding.
(R. L. Fox and M. P. Kapoor, Rates of change of eigenvalues and eigenvectors, AIAA Journal 6 (1968) 2426.)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from trunnion.analyses.linear.natural_frequencies import NO_OSCILLATION, damped_modes, natural_frequencies
from trunnion.analyses.sensitivity.differences import CENTRAL, SMOOTH_STEP, central
from trunnion.analyses.sensitivity.directions import Direction, Neighbourhood
from trunnion.analyses.sensitivity.result import EXACT, Quantity, Rows
from trunnion.arrays import Array, Complex
from trunnion.equations.aligned import AlignedMatrices, aligned_matrices

ROUNDING = 1e-11
"""Share of a slope that rounding may change."""
COINCIDE = 1e-7
"""Relative distance below which two modes count as one frequency, which has no derivative of its own."""


def mode_slopes(near: Neighbourhood, directions: Sequence[Direction]) -> Iterator[Rows]:
    """Frequencies [rad/s] and damping ratios [1] of every elastic mode of the aligned line along every direction."""
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
    values, scaled = damped_modes(
        damping * over, complex_stiffness * over, NO_OSCILLATION * float(omega.min(initial=np.inf))
    )
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
    names = [f"mode {m}" for m in range(first + 1, first + 1 + len(omega))]
    refused = [_coincides(omega, m, first) for m in range(len(omega))]
    words = "it does not oscillate: a damping ratio near 1 has no derivative here"
    unmatched = [why or ("" if place >= 0 else words) for why, place in zip(refused, matched, strict=True)]
    frequency_slope[np.array(refused) != ""] = np.nan
    ratio_slope[np.array(unmatched) != ""] = np.nan
    frequencies = [
        Quantity(f"natural frequency of {name}", "frequency", float(w), "rad/s", EXACT, refused=why)
        for name, w, why in zip(names, omega, refused, strict=True)
    ]
    yield Rows(frequencies, frequency_slope, ROUNDING * np.abs(frequency_slope))
    ratio = found.damping_ratio[first:]
    damped = np.flatnonzero(ratio != 0) if np.any(ratio_slope) else np.zeros(0, dtype=int)
    ratios = [
        Quantity(f"damping ratio of {names[m]}", "damping ratio", float(ratio[m]), "1", EXACT, refused=unmatched[m])
        for m in damped
    ]
    yield Rows(ratios, ratio_slope[damped], ROUNDING * np.abs(ratio_slope[damped]))


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

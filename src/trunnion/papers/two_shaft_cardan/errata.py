"""What S1 misprints, with the computed consequence of each version of its matrices."""

from __future__ import annotations

from functools import cache, partial

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.floquet.stability.stability import stability
from trunnion.papers.shared.drawing import curves
from trunnion.papers.shared.result import ComparisonTable, PaperFigure, TableRow
from trunnion.papers.shared.shares import sampled_share
from trunnion.papers.two_shaft_cardan.printed_matrices import VERSIONS, printed_system

BETA, GAMMA = 0.5, 100.0
SPEEDS = np.linspace(0.25, 1.6, 109)
"""Evenly spaced: shares of them are shares of the range."""
DIFFERENCE, HALF = 0.336, 0.705
AT_TONGUE = 1.41
"""A speed within the subharmonic tongue of ω₂."""
AROUND = 0.01
"""Half-width of the search for a false tongue about (ω₂−ω₁)/4."""


def _radius(version: str, speed: float, tolerance: float = 1e-7) -> float:
    system = printed_system(version, speed, BETA, inertia_of_disk_2=GAMMA)
    return stability(system, tolerance=tolerance).spectral_radius


@cache
def _radii() -> dict[str, Array]:
    return {version: np.array([_radius(version, float(s)) for s in SPEEDS]) for version in VERSIONS}


@cache
def difference_tongue() -> tuple[float, float, float]:
    """Where and how far the spectral radius rises near (ω₂−ω₁)/4 with a single η′, and what the derived one is there.

    The maximum is refined between the samples, to 1e-7 of the speed.
    """
    from scipy.optimize import minimize_scalar

    grid = np.linspace(DIFFERENCE - AROUND, DIFFERENCE + AROUND, 21)
    best = int(np.argmax([_radius("single", float(s)) for s in grid]))
    ends = float(grid[max(best - 1, 0)]), float(grid[min(best + 1, len(grid) - 1)])
    found = minimize_scalar(
        lambda s: -_radius("single", float(s), 1e-9), bounds=ends, method="bounded", options={"xatol": 1e-7}
    )
    at = float(found.x)
    return at, -float(found.fun), _radius("derived", at, 1e-9)


def versions_figure() -> PaperFigure:
    """Spectral radius over speed for every version of the matrices."""
    radii = _radii()
    peak, height, below = difference_tongue()
    order = np.argsort(np.append(SPEEDS, peak))
    x = np.append(SPEEDS, peak)[order]
    at_peak = {"single": height, "derived": below}
    rows = [
        (words, np.append(radii[version], at_peak.get(version, _radius(version, peak)))[order])
        for version, words in VERSIONS.items()
    ]
    marks = [(DIFFERENCE, "(ω₂−ω₁)/4"), (HALF, "ω₂/2"), (1.416, "ω₂")]
    title = f"S1's matrices at β = {BETA} rad, γ = {GAMMA:g}: filled above 1 is unstable"
    return PaperFigure(
        "errata",
        "Spectral radius over speed: matrices as printed, mended step by step, and derived",
        "β = 0.5 rad, γ = 100, ζ = 0.001; each point by direct integration of the matrices.",
        partial(curves, x, rows, marks, "spectral radius", title),
    )


def _as_printed(mu: float, gamma: float) -> tuple[float, float]:
    """Equation (25) with the brackets as printed: only (1/γ + 1) squared under the root."""
    middle, root = 1 + mu * (1 / gamma + 1), np.sqrt(1 + mu * (1 / gamma + 1) ** 2 - 4 * mu / gamma)
    low, high = np.sqrt((middle + np.array([-1, 1]) * root) / 2)
    return float(low), float(high)


def missed(multipliers: Complex) -> bool:
    """Whether "or Re σ ≤ 0", a rule for exponents, calls multipliers stable of which one lies outside the circle."""
    outside = np.abs(multipliers) > 1 + 1e-6
    return bool(outside.any() and np.all(multipliers[outside].real <= 0))


def _rule() -> str:
    found = [_multipliers(float(s)) for s in SPEEDS]
    unstable = sum(bool(np.any(np.abs(m) > 1 + 1e-6)) for m in found)
    wrong = sum(missed(m) for m in found)
    most = min(_multipliers(AT_TONGUE).real)
    return (
        f"the second is a rule for exponents: of multipliers it calls {wrong} of {unstable} unstable speeds stable, "
        f"those of subharmonic tongues, as σ = {most:.5f} at Ω = {AT_TONGUE:g}"
    )


def _multipliers(speed: float) -> Complex:
    system = printed_system("derived", speed, BETA, inertia_of_disk_2=GAMMA)
    return np.asarray(stability(system, tolerance=1e-9).multipliers)


def errata() -> ComparisonTable:
    """The misprints, and what the matrices give with and without them."""
    radii = _radii()

    unstable = {version: sampled_share(of_version > 1 + 1e-6, 1) for version, of_version in radii.items()}
    peak, height, below = difference_tongue()
    band = SPEEDS[(radii["single"] > 1 + 1e-5) & (np.abs(SPEEDS - HALF) < 0.06)]
    spans = f"{band.min():.2f}–{band.max():.2f}" if len(band) else "nowhere"
    printed = _as_printed(1.0, 100.0)
    return ComparisonTable(
        "Errata",
        (
            TableRow("E₂₁, P₂₁ as printed", "η′ − …, +η/Ω²", f"{unstable['printed']} of speeds unstable",
                "everything would be unstable"),
            TableRow("sign of P₂₁ mended", "−η/Ω²", f"{unstable['sign']} unstable", "nothing would be unstable"),
            TableRow("η″ added, η′ single", "η″ − η/Ω²", f"ρ up to {height:.5f} at {peak:.4f}",
                f"a false tongue near (ω₂−ω₁)/4, and a false band at {spans}"),
            TableRow("derived", "2η′, η″ − η/Ω²", f"ρ = {below:.5f} at {peak:.4f}",
                f"no difference tongue; {unstable['derived']} of the speeds unstable"),
            TableRow("eq 14", "ζ = c₁/√(k₁J₁)", "ζ = c₁/(2√(k₁J₁))", "the 2ζ/Ω of its matrix E needs the factor 2"),
            TableRow("eq 25", "√(1 + μ(1/γ+1)² − 4μ/γ)", "√((1 + μ(1/γ+1))² − 4μ/γ)",
                f"bracket: as printed it gives {printed[0]:.3f} and {printed[1]:.3f} for μ = 1, γ = 100"),
            TableRow("(25), stability", "mod σ ≤ 1, or Re σ ≤ 0", "mod σ ≤ 1", _rule()),
            TableRow("Figure 6, text", "damping ratio × 20", "stiffness ratio × 20", "slip in the text"),
        ),
        f"The first four rows: β = {BETA} rad, γ = {GAMMA:g}, {len(SPEEDS)} evenly spaced speeds from {SPEEDS[0]:g} to "
        f"{SPEEDS[-1]:g}, with the standard error of so many independent samples; maxima are refined between them.",
    )  # fmt: skip

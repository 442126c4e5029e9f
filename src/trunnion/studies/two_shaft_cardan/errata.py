"""What S1 misprints, with the computed consequence of each version of its matrices."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.linear.stability import stability
from trunnion.studies.drawing import curves
from trunnion.studies.result import Comparison, PaperFigure, Row
from trunnion.studies.two_shaft_cardan.printed_matrices import VERSIONS, printed_system

Array = NDArray[np.float64]
BETA, GAMMA = 0.5, 100.0
SPEEDS = np.unique(
    np.concatenate([np.linspace(0.25, 1.6, 91), np.linspace(0.325, 0.38, 23), np.linspace(1.36, 1.47, 12)])
)
DIFFERENCE, HALF = 0.336, 0.705


@cache
def _radii() -> dict[str, Array]:
    def radius(version: str, speed: float) -> float:
        system = printed_system(version, speed, BETA, inertia_of_disk_2=GAMMA)
        return stability(system, tolerance=1e-7).spectral_radius

    return {version: np.array([radius(version, s) for s in SPEEDS]) for version in VERSIONS}


def versions_figure() -> PaperFigure:
    """Spectral radius over speed for every version of the matrices."""
    radii = _radii()
    rows = [(words, radii[version]) for version, words in VERSIONS.items()]
    marks = [(DIFFERENCE, "(ω₂−ω₁)/4"), (HALF, "ω₂/2"), (1.416, "ω₂")]
    title = f"S1's matrices at β = {BETA} rad, γ = {GAMMA:g}: red above 1 is unstable"
    return PaperFigure(
        "errata",
        "Spectral radius over speed: matrices as printed, mended step by step, and derived",
        "β = 0.5 rad, γ = 100, ζ = 0.001; each point by direct integration of the matrices.",
        (),
        lambda: curves(SPEEDS, rows, marks, "spectral radius", title),
    )


def errata() -> Comparison:
    """The misprints, and what the matrices give with and without them."""
    radii = _radii()

    def unstable(version: str) -> float:
        return 100 * float(np.mean(radii[version] > 1 + 1e-6))

    def near(version: str, speed: float, width: float) -> float:
        return float(radii[version][np.abs(SPEEDS - speed) <= width].max())

    band = SPEEDS[(radii["single"] > 1 + 1e-5) & (np.abs(SPEEDS - HALF) < 0.06)]
    spans = f"{band.min():.2f}–{band.max():.2f}" if len(band) else "nowhere"
    return Comparison(
        "Errata",
        (
            Row("E₂₁, P₂₁ as printed", "η′ − …, +η/Ω²", f"{unstable('printed'):.0f} % of speeds unstable",
                "everything would be unstable"),
            Row("sign of P₂₁ mended", "−η/Ω²", f"{unstable('sign'):.0f} % unstable", "nothing would be unstable"),
            Row("η″ added, η′ single", "η″ − η/Ω²", f"ρ = {near('single', DIFFERENCE, 0.006):.5f} at (ω₂−ω₁)/4",
                f"a false difference tongue, and a false band at {spans}"),
            Row("derived", "2η′, η″ − η/Ω²", f"ρ = {near('derived', DIFFERENCE, 0.006):.5f} at (ω₂−ω₁)/4",
                f"no difference tongue; {unstable('derived'):.0f} % of these speeds unstable"),
            Row("eq 14", "ζ = c₁/√(k₁J₁)", "ζ = c₁/(2√(k₁J₁))", "the 2ζ/Ω of its matrix E needs the factor 2"),
            Row("eq 25", "two brackets", "½[(1+μ+μ/γ) ± √((1+μ+μ/γ)² − 4μ/γ)]",
                "the root's first term is squared as a whole"),
            Row("Figure 6, text", "damping ratio × 20", "stiffness ratio × 20", "slip in the text"),
        ),
        f"The first four rows: β = {BETA} rad, γ = {GAMMA:g}, {len(SPEEDS)} speeds from {SPEEDS[0]:g} to "
        f"{SPEEDS[-1]:g}.",
    )  # fmt: skip

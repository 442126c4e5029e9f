"""What S3 misprints, with the computed consequence."""

from __future__ import annotations

import numpy as np

from trunnion.floquet.stability.stability import stability
from trunnion.papers.shared.result import ComparisonTable, TableRow
from trunnion.papers.shared.shares import sampled_share
from trunnion.papers.three_shaft_cardan.printed_matrices import printed_three_shaft_system
from trunnion.papers.three_shaft_cardan.published import three_shaft_cardan
from trunnion.papers.two_shaft_cardan.errata import missed

ANGLES = (0.2, 0.5)
SPEEDS = np.linspace(0.15, 1.95, 31)
RULED = np.linspace(0.15, 1.95, 121)
"""Speeds at which the printed criterion is applied."""


def errata() -> ComparisonTable:
    """Printed, derived with the second joint at τ, derived, and the general equations, at β₁ = 0.2, β₂ = 0.5."""
    radius = {
        version: np.array(
            [stability(printed_three_shaft_system(version, s, ANGLES), tolerance=1e-7).spectral_radius for s in SPEEDS]
        )
        for version in ("printed", "second at input", "derived")
    }
    line = three_shaft_cardan(angle_1=ANGLES[0], angle_2=ANGLES[1])
    general = np.array([stability(line, float(s), tolerance=1e-9).spectral_radius for s in SPEEDS])
    ruled = [stability(line, float(s), tolerance=1e-8) for s in RULED]
    wrong = sum(missed(np.asarray(one.multipliers)) for one in ruled)
    right = sum(one.spectral_radius > 1 + 1e-6 for one in ruled)

    unstable = {version: f"{sampled_share(of > 1 + 1e-6, 0)} of speeds unstable" for version, of in radius.items()}
    shift = float(np.max(np.abs(radius["second at input"] - radius["derived"])))
    agree = float(np.max(np.abs(radius["derived"] - general)))
    return ComparisonTable(
        "Errata",
        (
            TableRow("E₂₁, E₃₁, E₃₂, F₂₁, F₃₁, F₃₂ as printed", "η₁′ …, +η₁/Ω² …", unstable["printed"],
                "factors 2 on slopes, terms in η″ and signs are missing: everything would be unstable"),
            TableRow("η₂ taken at τ", "η₂(τ)", unstable["second at input"],
                f"it belongs at ψ₁(τ), behind joint 1: spectral radii move by up to {shift:.2g}"),
            TableRow("Figures 4 to 6, captions", "β₂ = 0.2, 0.2, 0.4 rad", "β₁",
                "their axis is β₂; the text varies β₁ = 0.2, 0.4 (mended in the captions here)"),
            TableRow("criterion of stability", "mod σ ≤ 1, or Re σ ≤ 0", "mod σ ≤ 1",
                f"the second is a rule for exponents: of multipliers it calls {wrong} of {right} unstable ones among "
                f"{len(RULED)} speeds stable, those of subharmonic tongues"),
            TableRow("derived", "η₂(ψ₁(τ))", unstable["derived"],
                f"agrees with the general equations of this program to {agree:.0e}"),
        ),
        f"β₁ = {ANGLES[0]}, β₂ = {ANGLES[1]} rad, γ₂ = 10, ζ = 0.001, {len(SPEEDS)} evenly spaced speeds from "
        f"{SPEEDS[0]:g} to {SPEEDS[-1]:g}; with the standard error of so many independent samples.",
    )  # fmt: skip

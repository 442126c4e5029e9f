"""S1 and S3: edges of tongues, multipliers, frequencies and forced response.

Numbers of the re-derived equations (Soltan Rezaee and Ghazavi 2014 with its misprints mended), computed by
two independent implementations in twist and in absolute coordinates that agree to 3e-13; α = μ = 1.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import bisect

import trunnion as tn
from trunnion.equations.coefficients import assemble


def two_shafts(beta: float, gamma: float, zeta: float = 0.001) -> tn.Driveline:
    """S1 at angle β, inertia ratio γ, damping ratio ζ."""
    return tn.catalogue("two-shaft-cardan", angle=beta, inertia_of_disk_2=gamma, damping_ratio=zeta)


@pytest.mark.parametrize(
    ("gamma", "beta", "low", "high", "digits", "name"),
    [
        (100.0, 0.3, 1.400251, 1.432358, 6, "subharmonic ω₂"),
        (100.0, 0.5, 1.372337, 1.464882, 6, "subharmonic ω₂"),
        (1.0, 0.3, 1.601913, 1.634565, 6, "subharmonic ω₂"),
        (1.0, 0.5, 1.572483, 1.666968, 6, "subharmonic ω₂"),
        (100.0, 0.5, 0.37045, 0.37365, 5, "sum (ω₁+ω₂)/4"),
        (1.0, 0.3, 0.61204, 0.62460, 5, "subharmonic ω₁"),
        (1.0, 0.3, 1.11078, 1.12580, 5, "sum (ω₁+ω₂)/2"),
    ],
)
def test_tongue_edges(gamma: float, beta: float, low: float, high: float, digits: int, name: str) -> None:
    assembly = assemble(two_shafts(beta, gamma))

    def above_one(speed: float) -> float:
        return tn.stability(assembly, speed, tolerance=1e-11).spectral_radius - 1

    centre, tolerance = (low + high) / 2, 0.51 * 10.0**-digits
    inside = tn.stability(assembly, centre)
    assert inside.verdict.name == "UNSTABLE" and str(inside.resonance) == name
    width = (high - low) / 2
    assert bisect(above_one, low - width / 2, centre, xtol=1e-8) == pytest.approx(low, abs=tolerance)
    assert bisect(above_one, centre, high + width / 2, xtol=1e-8) == pytest.approx(high, abs=tolerance)


@pytest.mark.parametrize(
    ("speed", "beta", "moduli"),
    [
        (1.41, 0.5, [1.10174782, 0.99998884, 0.99998884, 0.89954117]),
        (0.37, 0.9, [1.00037279, 1.00037279, 0.98175148, 0.98175148]),
    ],
)
def test_multipliers(speed: float, beta: float, moduli: list[float]) -> None:
    result = tn.stability(two_shafts(beta, 100.0), speed)
    assert np.abs(result.multipliers) == pytest.approx(moduli, abs=5.1e-9)


def test_sum_tongue_height() -> None:
    assert tn.stability(two_shafts(0.3, 1.0), 1.12).spectral_radius == pytest.approx(1.009574, abs=5.1e-7)


def test_damping_opens_a_combination_tongue() -> None:
    """γ = 0.1, β = 0.9, Ω = 2.5: marginal without damping, ρ = 1.00111 with ζ = 0.001."""
    bare = tn.stability(two_shafts(0.9, 0.1, zeta=0.0), 2.5)
    assert bare.verdict.name == "MARGINAL" and bare.spectral_radius == pytest.approx(1, abs=1e-9)
    damped = tn.stability(two_shafts(0.9, 0.1), 2.5)
    assert damped.verdict.name == "UNSTABLE" and damped.spectral_radius == pytest.approx(1.00111, abs=5.1e-6)


def test_stable_is_not_quiet() -> None:
    """γ = 1, ζ = 0.001, β = 12°, Ω = 0.309 ≈ ω₁/2: stable, yet the linear twist of shaft 1 is 4.0 rad."""
    result = tn.stability(two_shafts(np.deg2rad(12), 1.0), 0.309)
    assert result.verdict.name == "STABLE"
    assert result.spectral_radius == pytest.approx(0.99624, abs=5.1e-6)
    assert result.response is not None
    assert result.response.twist_amplitude[0] == pytest.approx(4.0, abs=0.05)
    assert not result.response.linear
    assert any("beyond the linear range" in str(f) for f in result.findings)


def test_two_shaft_frequencies() -> None:
    """ω⁴ − (1 + μ + μ/γ)ω² + μ/γ = 0; the paper's equation 26 prints 0.072 and 1.422."""
    found = tn.natural_frequencies(two_shafts(0.3, 100.0)).undamped_frequency
    assert found == pytest.approx([0.070622, 1.415985], abs=5.1e-7)
    assert found == pytest.approx(np.sqrt(np.roots([1, -2.01, 0.01])[::-1]), rel=1e-12)


def test_three_shaft_frequencies() -> None:
    """S3's base case μ = 1, γ₁ = 1, γ₂ = 10; the paper prints 0.178, 1.025, 1.737."""
    found = tn.natural_frequencies(tn.catalogue("three-shaft-cardan")).undamped_frequency
    assert found == pytest.approx([0.177563, 1.025273, 1.737034], abs=5.1e-7)

"""What the printed matrices of S1 and S3 give, and why they cannot be right."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from oracles.comparisons import floquet, set_distance
from oracles.printed_matrices import VERSIONS, joint, system, three_shafts, two_shafts

import trunnion as tn

ZETA = 0.001
SPEEDS = [*np.arange(0.1, 2.01, 0.1), 0.336, 0.373, 0.705, 1.416]
ANGLES = [0.1, 0.3, 0.5]


def radius(version: str, gamma: float, speed: float, beta: float) -> float:
    """Spectral radius of S1's matrices in one of their versions."""
    found = tn.stability(system(two_shafts, speed, beta, ZETA, gamma, version=version), tolerance=1e-9)
    return found.spectral_radius


@pytest.mark.parametrize("gamma", [1.0, 100.0])
def test_as_printed_everything_is_unstable(gamma: float) -> None:
    assert all(radius("printed", gamma, s, b) > 1.1 for s, b in product(SPEEDS, ANGLES))


@pytest.mark.parametrize("gamma", [1.0, 100.0])
def test_with_the_sign_alone_nothing_is_unstable(gamma: float) -> None:
    assert all(radius("sign", gamma, s, b) < 1 - 1e-6 for s, b in product(SPEEDS, ANGLES))


@pytest.mark.parametrize(("gamma", "speed"), [(100.0, 0.336), (1.0, 0.5)])
def test_single_slope_opens_a_false_difference_tongue(gamma: float, speed: float) -> None:
    """At (ω₂ − ω₁)/4 for γ = 100, where S1's Table 2 has 0.338, and at (ω₂ − ω₁)/2 for γ = 1."""
    low, high = tn.natural_frequencies(tn.catalogue("two-shaft-cardan", inertia_of_disk_2=gamma)).undamped_frequency
    assert (high - low) / (4 if gamma > 1 else 2) == pytest.approx(speed, abs=1e-3)
    wrong = tn.stability(system(two_shafts, speed, 0.5, ZETA, gamma, version="single"))
    assert wrong.verdict.name == "UNSTABLE" and abs(wrong.multipliers[0].imag) > 1e-3
    right = tn.stability(tn.catalogue("two-shaft-cardan", angle=0.5, inertia_of_disk_2=gamma), speed)
    assert right.verdict.name == "STABLE"


@pytest.mark.parametrize("beta", [0.3, 0.5])
def test_single_slope_opens_a_shallow_band_about_half_the_second_mode(beta: float) -> None:
    """γ = 100: complex multipliers just outside the circle for Ω about 0.68–0.73, nothing in truth."""
    inside, outside = np.arange(0.69, 0.7201, 0.01), np.array([0.66, 0.75])
    wrong = np.array([radius("single", 100.0, s, beta) for s in inside])
    assert np.all(wrong > 1 + 1e-4) and np.all(wrong < 1.02)
    assert all(radius("single", 100.0, s, beta) < 1 for s in outside)
    for speed in inside:
        assert (
            tn.stability(tn.catalogue("two-shaft-cardan", angle=beta, inertia_of_disk_2=100.0), speed).verdict.name
            == "STABLE"
        )


@pytest.mark.parametrize("gammas", [(1.0, 10.0), (1.0, 1.0), (100.0, 100.0)])
def test_three_shafts_as_printed_are_unstable_everywhere(gammas: tuple[float, float]) -> None:
    for speed, beta in product(np.arange(0.2, 2.01, 0.3), (0.1, 0.5)):
        printed = system(three_shafts, speed, (beta, beta), ZETA, gammas, version="printed")
        assert tn.stability(printed, tolerance=1e-8).verdict.name == "UNSTABLE"


def test_printed_frequencies_of_two_shafts() -> None:
    """Equation 26 prints 0.072 and 1.422; the paper's own equation 25, signs and brackets mended, gives
    0.070622 and 1.415985. Table 1 mixes both: 1.422/2 = 0.711 (printed 0.712), 1.422/3 = 0.474."""
    found = tn.natural_frequencies(tn.catalogue("two-shaft-cardan", inertia_of_disk_2=100.0)).undamped_frequency
    total = 1 + 1 * (1 / 100 + 1)
    root = np.sqrt(total**2 - 4 / 100)
    assert found == pytest.approx(np.sqrt([(total - root) / 2, (total + root) / 2]), rel=1e-12)
    assert np.all(np.abs(found - [0.072, 1.422]) > 1e-3)


def test_damping_ratio_needs_the_factor_two() -> None:
    """Equation 14 prints ζ = c₁/√(k₁J₁), its E₁₁ = 2ζ/Ω needs c₁/(2√(k₁J₁))."""
    for zeta in (0.001, 0.05):
        line = tn.catalogue("two-shaft-cardan", angle=0.4, damping_ratio=zeta)
        same = tn.stability(system(two_shafts, 0.8, 0.4, zeta, 1.0)).multipliers
        twice = tn.stability(system(two_shafts, 0.8, 0.4, 2 * zeta, 1.0)).multipliers
        found = tn.stability(line, 0.8).multipliers
        assert set_distance(found, same) < 1e-11 < 1e-4 < set_distance(found, twice)


def test_joint_derivatives_of_the_matrices() -> None:
    phi, h = np.linspace(0, 3, 101), 1e-5
    ahead, behind, here = joint(phi + h, 0.8), joint(phi - h, 0.8), joint(phi, 0.8)
    for order in (0, 1):
        assert (ahead[order] - behind[order]) / (2 * h) == pytest.approx(here[order + 1], abs=1e-7)


@pytest.mark.parametrize("version", VERSIONS)
def test_your_own_matrices_against_scipy(version: str) -> None:
    """``stability`` of a system given as matrices, by an independent integration."""

    def at(tau: float) -> tuple[np.ndarray, np.ndarray]:
        e, p = two_shafts(np.array([tau]), 0.9, 0.6, 0.02, 2.0, version=version)
        return e[0], p[0]

    found = tn.stability(system(two_shafts, 0.9, 0.6, 0.02, 2.0, version=version)).multipliers
    other = floquet(at, 2, np.pi)
    assert set_distance(found, other) < 1e-9 * max(1.0, np.abs(other).max())

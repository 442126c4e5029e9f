"""S4's midshaft with its tripods, against a chain of disks and against its limits."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.papers.double_tripod.errata import errata
from trunnion.papers.double_tripod.midshaft import midshaft_frequencies, ratio_that_meets

LENGTH, MODULUS, DENSITY = 0.940, 77.3e9, 7850.0
"""L_DM2 [m], G [Pa], ρ [kg/m³] as the paper prints them."""


def chain(ratios: tuple[float, float], parts: int) -> np.ndarray:
    """Natural frequencies [Hz] of the shaft cut into equal pieces, each half at a disk to either side."""
    polar = 1e-6  # of any size: it drops out
    piece, stiffness = DENSITY * polar * LENGTH / parts, MODULUS * polar * parts / LENGTH
    inertia = np.full(parts + 1, piece)
    inertia[[0, -1]] = piece / 2 + np.array(ratios) * DENSITY * polar * LENGTH
    elements: list[object] = [tn.Disk(inertia=inertia[0])]
    for j in inertia[1:]:
        elements += [tn.Shaft(stiffness=stiffness), tn.Disk(inertia=float(j))]
    return tn.natural_frequencies(tn.Driveline(elements)).hertz[1:4]  # type: ignore[arg-type]


@pytest.mark.parametrize("ratios", [(0.0, 0.0), (0.05, 0.05), (0.3, 0.1), (2.0, 5.0)])
def test_against_a_chain_of_disks(ratios: tuple[float, float]) -> None:
    """Lumping errs by the square of the pieces' length, which two chains take out."""
    coarse, fine = chain(ratios, 30), chain(ratios, 60)
    assert midshaft_frequencies(ratios, 3) == pytest.approx((4 * fine - coarse) / 3, rel=2e-6)


def test_free_ends_give_the_printed_list_and_heavy_ones_the_same_one_lower() -> None:
    printed = np.arange(1, 6) * 1669.16
    assert midshaft_frequencies((0.0, 0.0)) == pytest.approx(printed, rel=1e-5)
    heavy = midshaft_frequencies((1e6, 1e6))
    assert heavy[0] < 1.0 and heavy[1:] == pytest.approx(printed[:4], rel=1e-5)


def test_tripods_that_meet_the_excitation() -> None:
    """Of equal ends: r x = −tan(x/2) for the second mode."""
    for hertz in (3066.5, 2791.9):
        x = 2 * np.pi * hertz * LENGTH / np.sqrt(MODULUS / DENSITY)
        assert ratio_that_meets(2, hertz) == pytest.approx(-np.tan(x / 2) / x, rel=1e-8)


def test_the_erratum_says_both() -> None:
    rows = {r.place: r for r in errata().rows}
    assert "ν₂ to 2Ω₁/2π" in rows["(17): midshaft"].remark and "no φ₂" in rows["(20), (21): midshaft terms"].remark

"""Widths as β² and tips as √ζ, exponent and coefficient, from ``tongues`` alone, against averaging."""

from __future__ import annotations

import numpy as np
import pytest
from small_angles import Averaged

import trunnion as tn

RESONANCES = [(0, 0), (1, 1), (0, 1)]
GAMMAS = [1.0, pytest.param(10.0, marks=pytest.mark.slow)]
ANGLES = np.array([0.05, 0.07, 0.1, 0.14])


def tongues_at(gamma: float, zeta: float, i: int, j: int, angles: tuple[float, float], share: float) -> tn.Tongues:
    """All tongues in a box about one resonance."""
    middle = Averaged(gamma).speed(i, j)
    return tn.tongues(
        tn.catalogue("two-shaft-cardan", inertia_of_disk_2=gamma, damping_ratio=zeta),
        ("speed", (1 - share) * middle, (1 + share) * middle),
        ("HookeJoint 1.angle", *angles),
        rows=3,
    )


def fitted(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Exponent of y over x as x falls to 0, with the next even power taken out, and that of the two smallest."""
    local = np.diff(np.log(y)) / np.diff(np.log(x))
    middle = np.sqrt(x[1:] * x[:-1])
    return float(np.polyfit(middle**2, local, 1)[1]), float(local[0])


@pytest.mark.parametrize("gamma", GAMMAS)
@pytest.mark.parametrize(("i", "j"), RESONANCES)
def test_widths_grow_as_the_square_of_the_angle(gamma: float, i: int, j: int) -> None:
    """Without damping: principal and sum resonance."""
    found = tongues_at(gamma, 0.0, i, j, (0.05, 0.14), 0.05)
    width = np.array([np.diff(found.intervals_at(float(angle)), axis=1).max() for angle in ANGLES])
    exponent, rough = fitted(ANGLES, width)
    assert exponent == pytest.approx(2.0, abs=2e-3) and rough == pytest.approx(2.0, abs=0.02)
    coefficient = np.polyfit(ANGLES**2, width / ANGLES**2, 2)[-1]
    assert coefficient == pytest.approx(Averaged(gamma).width(i, j, 1.0), rel=2e-3)


@pytest.mark.parametrize(("i", "j"), RESONANCES)
def test_tips_grow_as_the_root_of_damping(i: int, j: int) -> None:
    zetas = np.array([1e-5, 4e-5, 1.6e-4])
    tips = []
    for zeta in zetas:
        expected = Averaged(1.0, zeta).tip(i, j)
        found = tongues_at(1.0, zeta, i, j, (0.8 * expected, 1.6 * expected), 0.02)
        (one,) = [t for t in found if t.tip is not None]
        tips.append(one.tip[1])
        wide = 1.5 * expected
        assert one.width_at(wide) == pytest.approx(Averaged(1.0, zeta).width(i, j, wide), rel=5 * wide**2)
    tip = np.array(tips)
    exponent, rough = fitted(np.sqrt(zetas), tip)
    assert exponent == pytest.approx(1.0, abs=2e-3) and rough == pytest.approx(1.0, abs=0.01)
    coefficient = np.polyfit(zetas, tip / np.sqrt(zetas), 2)[-1]
    assert coefficient == pytest.approx(Averaged(1.0, 1.0).tip(i, j), rel=1e-3)


@pytest.mark.parametrize("gamma", GAMMAS)
def test_the_difference_resonance_does_not_open(gamma: float) -> None:
    """Averaged, it couples two modes of one sign of energy: nothing grows."""
    omega = Averaged(gamma).modes()[0]
    middle = (omega[1] - omega[0]) / 2
    found = tn.tongues(
        tn.catalogue("two-shaft-cardan", inertia_of_disk_2=gamma, damping_ratio=0.0),
        ("speed", 0.97 * middle, 1.03 * middle),
        ("HookeJoint 1.angle", 0.02, 0.2),
        rows=3,
    )
    assert not [t for t in found if t.width_at(float(t.y[-1])) > 1e-7]

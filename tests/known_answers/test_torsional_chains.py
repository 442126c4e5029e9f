"""Natural frequencies of free torsional lines (Friswell and co-authors, Dynamics of Rotating Machines)."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn


def test_five_disks() -> None:
    inertias, stiffnesses = [3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05], [12e3, 12e3, 14e3, 10e3]
    elements: list[object] = [tn.Disk(inertia=inertias[0])]
    for k, j in zip(stiffnesses, inertias[1:], strict=True):
        elements += [tn.Shaft(stiffness=k), tn.Disk(inertia=j)]
    modes = tn.natural_frequencies(tn.Driveline(elements))  # type: ignore[arg-type]
    assert modes.rigid_body and modes.frequency[0] == 0.0
    assert modes.hertz[1:] == pytest.approx([81.21, 141.21, 378.95, 536.36], abs=0.0051)
    assert np.ptp(modes.shape[:, 0]) < 1e-6
    assert np.abs(modes.damping_ratio).max() < 1e-15


def test_geared_system_with_a_branch() -> None:
    """A 1:1 gear pair whose second gear drives two shafts, one of them a branch."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=400e-6),
            tn.Shaft(stiffness=10e3),
            tn.Disk(inertia=25e-6),
            tn.Ratio(teeth_in=20, teeth_out=20, name="mesh"),
            tn.Disk(inertia=25e-6, name="second gear"),
            tn.Shaft(stiffness=5e3),
            tn.Disk(inertia=700e-6),
            tn.Shaft(stiffness=5e3, after="second gear"),
            tn.Disk(inertia=700e-6),
        ]
    )
    modes = tn.natural_frequencies(line)
    assert modes.rigid_body
    assert modes.hertz[1:] == pytest.approx([425.4, 634.1, 3247.2], abs=0.051)


def test_modes_of_a_geared_pair_by_hand() -> None:
    """k between J₁ and J₂ behind a ratio of 3: J₂ weighs J₂/9 and k weighs itself in front of it."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=2.0),
            tn.Shaft(stiffness=50.0, damping=0.1),
            tn.Disk(inertia=1e-9),
            tn.Ratio(ratio=3.0),
            tn.Disk(inertia=9.0),
        ]
    )
    modes = tn.natural_frequencies(line)
    undamped, ratio = modes.undamped_frequency[1], modes.damping_ratio[1]
    assert undamped == pytest.approx(np.sqrt(50.0 * (1 / 2.0 + 1 / 1.0)), rel=1e-8)
    assert ratio == pytest.approx(0.1 / 50.0 * undamped / 2, rel=1e-8)
    assert modes.frequency[1] == pytest.approx(undamped * np.sqrt(1 - ratio**2), rel=1e-12)


def test_without_damping_every_ratio_is_exactly_zero() -> None:
    parts = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=1e4),
        tn.Disk(inertia=1.0),
        tn.Shaft(stiffness=1e4),
        tn.Disk(inertia=1.0),
    ]
    found = tn.natural_frequencies(tn.Driveline(parts))
    assert not found.damping_ratio.any() and "damping ratio 0" in str(found)


def test_geared_branches_of_a_ship() -> None:
    """Friswell and co-authors, section 9.6.3: a machine that drives two equal branches over gears of 1.6.

    Read: the case as openTorsion's tests have it (``friswell_9_6_3``), with inertias, tubes, radii and the frequencies
    10.304, 20.479 and 24.423 Hz; the book itself was not read. Precision: five figures.
    """

    def branch(after: dict[str, str]) -> list[object]:
        return [
            tn.Ratio(ratio=0.8 / 0.5, **after),
            tn.Disk(inertia=800.0),
            tn.Shaft(outer_diameter=0.25, length=3.5, shear_modulus=68e9),
            tn.Disk(inertia=450.0),
        ]

    line = tn.Driveline(
        [
            tn.Disk(inertia=3200.0),
            tn.Shaft(outer_diameter=0.2, length=2.5, shear_modulus=68e9),
            tn.Disk(inertia=200.0, name="first gear"),
            tn.Ratio(ratio=1.0),
            tn.Disk(inertia=200.0),
            *branch({}),
            *branch({"after": "first gear"}),
        ]  # type: ignore[list-item]
    )
    assert tn.natural_frequencies(line).hertz[1:] == pytest.approx([10.304, 20.479, 24.423], abs=5.1e-4)


def test_two_disks() -> None:
    """211.4 and 8.3 kg m², 9.775e6 N m/rad: 176.1 Hz (the first of openTorsion's tests; to 0.05 Hz)."""
    line = tn.Driveline([tn.Disk(inertia=211.4), tn.Shaft(stiffness=9.775e6), tn.Disk(inertia=8.3)])
    assert tn.natural_frequencies(line).hertz[1:] == pytest.approx([176.1], abs=0.05)


def test_turbine_generator_of_the_first_benchmark() -> None:
    """IEEE task force, first benchmark model of subsynchronous resonance, Trans. PAS-96 (1977).

    HP and IP turbine, two LP turbines, generator and exciter, as inertia constants H [s] and stiffness in torque per
    electrical radian, both per unit.

    Read: two transcriptions of the model in public programs (one after Ong's book on electric machines), which agree
    but for the last figure of the exciter's shaft, 2.822 and 2.82. The article was not read. The frequencies, as the
    model is quoted with them to 0.01 Hz, and their equations solved here.
    """
    base = 2 * np.pi * 60.0
    h = np.array([0.092897, 0.155589, 0.858670, 0.884215, 0.868495, 0.0342165])
    k = np.array([19.303, 34.929, 52.038, 70.858, 2.822])
    elements: list[object] = [tn.Disk(inertia=2 * h[0] / base)]
    for stiffness, constant in zip(k, h[1:], strict=True):
        elements += [tn.Shaft(stiffness=stiffness), tn.Disk(inertia=2 * constant / base)]
    found = tn.natural_frequencies(tn.Driveline(elements)).hertz[1:]  # type: ignore[arg-type]
    assert found == pytest.approx([15.71, 20.21, 25.55, 32.28, 47.46], abs=0.0051)
    ends = np.diff(np.eye(6), axis=0)
    squares = np.linalg.eigvals(np.diag(base / (2 * h)) @ ends.T @ np.diag(k) @ ends).real
    assert found == pytest.approx(np.sqrt(np.sort(squares)[1:]) / (2 * np.pi), rel=1e-10)

"""Loss factors that hold at all frequencies, in natural frequencies: complex modes against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn


def test_one_spring_has_half_its_loss_factor() -> None:
    """λ² = −ω²(1 + iη): −Re λ/|λ| = sin(½ arctan η)."""
    for eta in (0.02, 0.3):
        shaft = tn.Shaft(stiffness=1e4, loss_factor=eta)
        modes = tn.natural_frequencies(tn.Driveline([tn.Disk(inertia=0.2), shaft, tn.Disk(inertia=0.8)]))
        assert modes.damping_ratio[1] == pytest.approx(np.sin(np.arctan(eta) / 2), rel=1e-12)
        assert modes.undamped_frequency[1] == pytest.approx(250.0) and modes.damping_ratio[0] == 0


def test_a_mode_loses_in_the_springs_where_its_energy_is() -> None:
    """With small losses ζ = ½ Σ η_e U_e/U over the energies of the undamped mode; viscous damping adds its own."""
    k, eta, c, inertia = np.array([3e3, 8e3, 5e3]), np.array([2e-5, 0.0, 5e-5]), 1e-4, np.array([0.3, 0.2, 0.5])
    shafts = [tn.Shaft(stiffness=k[0], loss_factor=eta[0]), tn.Shaft(stiffness=k[1], damping=c)]
    shafts.append(tn.Coupling(stiffness=k[2], relative_damping=2 * np.pi * eta[2]))
    elements = [tn.ConstantSpeed(), *(e for s, j in zip(shafts, inertia, strict=True) for e in (s, tn.Disk(inertia=j)))]
    modes = tn.natural_frequencies(tn.Driveline(elements))
    twist = np.diff(modes.shape, axis=0, prepend=0)
    energy = k[:, None] * twist**2
    lost = (eta @ energy) / (2 * energy.sum(axis=0))
    viscous = c * twist[1] ** 2 * modes.undamped_frequency / (2 * energy.sum(axis=0))
    assert modes.damping_ratio == pytest.approx(lost + viscous, rel=1e-7)

"""The largest torque of one mass on a prescribed rotation, in closed form, where the range ends beside its resonance.

|T| = T₀ √(1 + (2ζr)²) / √((1 − r²)² + (2ζr)²) with r = ν/ω is largest at r² = (√(1 + 8ζ²) − 1)/4ζ², below 1: of a
resonance that stands beyond the end the top may lie before it.
"""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn


def torque(r: float, zeta: float) -> float:
    return float(np.sqrt((1 + (2 * zeta * r) ** 2) / ((1 - r**2) ** 2 + (2 * zeta * r) ** 2)))


@pytest.mark.parametrize("seed", range(40))
def test_the_top_is_found_wherever_the_range_ends(seed: int) -> None:
    rng = np.random.default_rng(seed)
    inertia, k = 10 ** rng.uniform(-1, 0.5), 10 ** rng.uniform(3, 5)
    zeta, order, size, load = 10 ** rng.uniform(-3.3, -0.7), int(rng.choice([1, 2, 3, 24])), 30.0, 7.0
    top = np.sqrt((np.sqrt(1 + 8 * zeta**2) - 1) / (4 * zeta**2))
    # Ends before, in and behind what lies between top and resonance, and farther away.
    off = rng.choice([-1, 1]) * 10 ** rng.uniform(-4, -0.5) if seed % 2 else rng.uniform(-3, 3) * (1 - top)
    low, high = (rng.uniform(0.05, 0.5), 1 + off) if rng.random() < 0.7 else (1 + off, rng.uniform(2, 3))
    line = tn.Driveline([
        tn.ConstantSpeed(),
        tn.Coupling(stiffness=k, damping=2 * zeta * np.sqrt(k * inertia), maximum_torque=1e-3),
        tn.Disk(inertia=inertia, load_torque=load, excitation=[{"order": order, "amplitude": size}]),
    ])  # fmt: skip
    slow, fast = (share * np.sqrt(k / inertia) / order for share in (low, high))
    (check,) = [one for one in tn.assess(line, (slow, fast)).checks if one.name.startswith("maximum torque rating")]
    true = load + size * torque(float(np.clip(top, low, high)), zeta)
    assert true * (1 - 1e-9) <= check.value + check.error and check.value <= true * (1 + 1e-9)

"""Dampers and cycles."""

from __future__ import annotations

from collections import Counter

import numpy as np
from published.printed_numbers import Batch, Source

import trunnion as tn
from trunnion.design.fatigue.cycles import rainflow_cycles

SOURCES = {
    "Houdaille": Source(
        "A textbook on automotive chassis engineering, equation 5.47 and figure 5.17",
        "the best damping of an untuned viscous damper, 0.288 of the first disk's critical one at equal inertias",
    ),
    "ASTM E1049": Source(
        "ASTM E1049-85, Standard practices for cycle counting in fatigue analysis, section 5.4.4, figure 6",
        "the example's history and its counts by range",
    ),
}
HISTORY = (-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0)
CYCLES = {3.0: "0.5", 4.0: "1.5", 5.0: "0", 6.0: "0.5", 7.0: "0", 8.0: "1", 9.0: "0.5"}


def counted() -> dict[float, float]:
    """Cycles by range."""
    found = rainflow_cycles(np.array(HISTORY), repeats=False)
    counts: Counter[float] = Counter()
    for amplitude, count in zip(found.amplitude, found.count, strict=True):
        counts[2 * amplitude] += count
    return counts


def houdaille() -> list[float]:
    """The damper that ``optimise`` finds, over the critical damping of the disk on its spring."""
    spring = tn.Shaft(stiffness=1e4, name="spring")
    disk = tn.Disk(inertia=1.0, excitation=[{"order": 1, "amplitude": 10.0}])
    oil = tn.Shaft(stiffness=1e-6, damping=10.0, name="oil")
    line = tn.Driveline([tn.ConstantSpeed(), spring, disk, oil, tn.Disk(inertia=1.0)])
    best = tn.optimise(
        line, {"oil.damping": (5.0, 500.0)}, "peak torque of spring", (30.0, 130.0), checks=False, designs=20
    )
    return [best.values["oil.damping"] / (2 * np.sqrt(1e4 * 1.0))]


BATCHES = (
    Batch(
        "Houdaille", "figure 5.17", "", {"c / 2√(KJ) at equal inertias": "0.288"}, houdaille,
        absolute=2e-3, precision="read off a curve; the closed form is 1/√12 = 0.2887", slow=True,
    ),
    Batch(
        "ASTM E1049", "example", "", {f"cycles of range {size:g}": text for size, text in CYCLES.items()},
        lambda: [counted().get(size, 0.0) for size in CYCLES],
    ),
)  # fmt: skip

"""Random trees that swing about motions of their own: free or driven and loaded, stiff, branched, hardly damped, joints
with phases on the axes and between."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import trunnion as tn

Array = NDArray[np.float64]


def random_swung_line(seed: int, driven: bool | None = None) -> tuple[tn.Driveline, np.random.Generator]:
    """The line, and what goes on drawing; d0 is what drives, s0, s1, … the shafts."""
    rng = np.random.default_rng([77, seed])
    n = int(rng.integers(2, 5))
    begun = bool(rng.random() < 0.5) if driven is None else driven
    inertia, stiffness = 10 ** rng.uniform(-0.3, 0.3, n + 1), 10 ** rng.uniform(3.5, 4.2, n)
    if rng.random() < 0.25:
        stiffness[rng.integers(n)] *= 50
    own = {"name": "d0", "inertia": float(inertia[0]), "drive_share": 1.0}
    parts: list = [tn.ConstantSpeed(name="d0") if begun else tn.Disk(**own)]
    share = 10 ** rng.uniform(-3.5, -2)
    for i, (j, k) in enumerate(zip(inertia[1:].tolist(), stiffness.tolist(), strict=True)):
        after = {"after": f"d{i}" if rng.random() < 0.6 or i == 0 else f"d{int(rng.integers(0, i + 1))}"}
        if rng.random() < 0.75 or i == 0:
            angle = abs(rng.choice([rng.uniform(0.1, 0.35), -rng.uniform(0.1, 0.35), rng.uniform(0.3, 0.6)]))
            plane = rng.choice([0.0, np.pi / 2, np.pi / 4, rng.uniform(0, 3)])
            parts.append(tn.HookeJoint(name=f"j{i}", angle=float(angle), plane=float(plane), **after))
            after = {}
        fork = float(rng.choice([0.0, 0.0, np.pi / 2, rng.uniform(0, 2)]))
        damping = float(2 * share * np.sqrt(k * j))
        parts.append(tn.Shaft(name=f"s{i}", stiffness=k, damping=damping, fork_offset=fork, **after))
        load = float(rng.choice([0.0, rng.uniform(-1, 1) * 0.15 * k])) if begun else 0.0
        viscous = 0.0 if begun and rng.random() < 0.5 else float(10 ** rng.uniform(-3, -1.5))
        parts.append(tn.Disk(name=f"d{i + 1}", inertia=j, load_torque=load, viscous_load=viscous))
    return tn.Driveline(parts), rng


def damped(line: tn.Driveline, factor: float) -> tn.Driveline:
    """``line`` with its shafts' damping times a factor."""
    for name, part in line.parts:
        if part.kind == "Shaft":
            line = line.replace(name, damping=float(part.damping_coefficient * factor))
    return line


def moved(line: tn.Driveline, values: dict[str, float]) -> tn.Driveline:
    """``line`` with other numbers, by their paths."""
    for path, value in values.items():
        name, _, key = path.rpartition(".")
        line = line.replace(name, **{key: float(value)})
    return line

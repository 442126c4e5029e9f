"""Random lines: every kind of group, shaft and branch that the equations know."""

from __future__ import annotations

from typing import Any

import numpy as np

import trunnion as tn


def random_joint(rng: np.random.Generator, steepest: float) -> tn.driveline.elements.Joint:
    """Any kind that does not pass rotation unchanged; tripods and ripple more uneven than any that is built."""
    bend = {"angle": float(rng.uniform(0.1, steepest)), "plane": float(rng.uniform(-3, 3))}
    kind = int(rng.integers(4))
    if kind == 0:
        side = str(rng.choice(["input", "output"]))
        return tn.TripodJoint(**bend, radius=0.05, length=float(rng.uniform(0.1, 0.5)), spider=side)
    if kind == 1:
        ripple = [
            {"order": m, "amplitude": float(rng.uniform(0, 0.3)) / m**2, "phase": float(rng.uniform(-3, 3))}
            for m in (2, 6)
        ]
        bend["reference_angle"] = float(rng.uniform(bend["angle"], 1.2))
        return tn.RzeppaJoint(**bend, ripple=[h | {"growth": int(rng.integers(1, 4))} for h in ripple])
    if kind == 2:
        return tn.DoubleCardanJoint(**bend, distance_ratio=float(rng.uniform(0.4, 2.5)))
    return tn.HookeJoint(**bend)


def random_uneven_line(seed: int, steepest: float = 1.1) -> tn.Driveline:
    """As ``random_line``, with joints of all kinds."""
    return random_line(seed, steepest, kinds=True)


def random_line(seed: int, steepest: float = 1.1, *, kinds: bool = False) -> tn.Driveline:
    """Shafts, tubes with density, several joints and ratios in one group, disks behind joints, a branch.

    The joints are Hooke's, or of all ``kinds``.
    """
    rng = np.random.default_rng(seed)
    elements: list[Any] = [tn.ConstantSpeed(name="drive")]
    disks: list[str] = []

    def disk() -> tn.Disk:
        disks.append(f"disk {len(disks) + 1}")
        load = float(rng.uniform(-20, 60)) if rng.random() < 0.6 else 0.0
        return tn.Disk(inertia=float(rng.uniform(0.1, 2.0)), load_torque=load, name=disks[-1])

    def shaft(after: str | None = None) -> list[Any]:
        turned = {"fork_offset": float(rng.uniform(-3, 3)), "after": after}
        stiffness = float(rng.uniform(500, 3000))
        kind = rng.integers(4)
        if kind == 0:
            tube = {"outer_diameter": 0.03, "inner_diameter": 0.02, "length": 0.7, "shear_modulus": 79.3e9}
            return [tn.Shaft(**tube, density=7850 * 40.0, loss_factor=0.03, loss_factor_frequency=200.0, **turned)]
        if kind == 1:
            first = tn.Shaft(stiffness=stiffness, **turned)
            return [first, tn.Shaft(stiffness=2 * stiffness, fork_offset=float(rng.uniform(-1, 1)))]
        return [tn.Shaft(stiffness=stiffness, damping=float(rng.uniform(0, 5)), **turned)]

    def hooke() -> Any:
        if kinds:
            return random_joint(rng, steepest)
        return tn.HookeJoint(angle=float(rng.uniform(0.1, steepest)), plane=float(rng.uniform(-3, 3)))

    def group() -> list[Any]:
        found: list[Any] = [disk()]
        choice = int(rng.integers(9))
        if choice in (0, 1):
            found += [hooke()]
        elif choice == 2:
            found += [hooke(), hooke()]
        elif choice == 3:
            found += [tn.Ratio(teeth_in=10, teeth_out=31), hooke()]
        elif choice == 4:
            found += [hooke(), tn.Ratio(ratio=-1.5), disk()]
        elif choice == 5:
            found += [hooke(), disk(), hooke()]
        elif choice == 6:
            found += [tn.Ratio(ratio=-0.5), disk()]
        elif choice == 7:
            found += [tn.IdealJoint(), hooke(), tn.Ratio(teeth_in=3, teeth_out=2), hooke(), disk()]
        return found

    if rng.random() < 0.2:
        elements.append(hooke())
    for _ in range(int(rng.integers(2, 5))):
        elements += shaft() + group()
    if rng.random() < 0.6:
        elements += [*shaft(after=disks[int(rng.integers(len(disks)))]), *group()]
        elements += [*shaft(), *group()]
    return tn.Driveline(elements)


def random_geared_line(seed: int, steepest: float = 1.1) -> tn.Driveline:
    """A random line between two gear pairs whose stiffness varies; joints rigidly in front of either or not."""
    rng = np.random.default_rng(seed + 5000)

    def mesh() -> list[Any]:
        joint = [tn.HookeJoint(angle=float(rng.uniform(0.1, steepest)))] if rng.random() < 0.5 else []
        variation = [
            {"share": float(rng.uniform(0, 0.4)), "order": order, "phase": float(rng.uniform(-3, 3))}
            for order in (1, 2)
        ]
        teeth = {"teeth_in": int(rng.integers(2, 9)), "teeth_out": int(rng.integers(2, 9)), "module": 0.05}
        own = {"mesh_stiffness": float(rng.uniform(1e5, 1e6)), "mesh_damping": float(rng.uniform(0, 500))}
        disk = tn.Disk(inertia=float(rng.uniform(0.1, 1)), load_torque=float(rng.uniform(-20, 60)))
        return [*joint, tn.GearPair(**teeth, **own, stiffness_variation=variation[: int(rng.integers(1, 3))]), disk]

    inside = random_line(seed, steepest)
    front = [inside.elements[0], tn.Shaft(stiffness=2000.0, damping=1.0, fork_offset=0.4), tn.Disk(inertia=0.3)]
    return tn.Driveline([*front, *mesh(), *inside.elements[1:], *mesh()])

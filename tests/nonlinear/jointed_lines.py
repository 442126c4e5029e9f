"""Lines for the tests of nonlinear motion."""

from __future__ import annotations

from typing import Any

import trunnion as tn


def two_shafts(angle: float = 12.0, load: float = 0.0, damping: float = 3.0, **disk: Any) -> tn.Driveline:
    """Drive, shaft, disk, Hooke's joint of ``angle`` degrees, shaft, disk."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1.2e4, damping=damping),
            tn.Disk(inertia=0.4),
            tn.HookeJoint(angle=tn.deg(angle)),
            tn.Shaft(stiffness=1.0e4, damping=damping, fork_offset=0.2),
            tn.Disk(inertia=0.9, load_torque=load, **disk),
        ]
    )


def three_shafts(load: float = 0.0, damping: float = 4.0) -> tn.Driveline:
    """Two joints, 20 and 15 degrees, forks neither in line nor square."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1.5e4, damping=damping, fork_offset=0.3),
            tn.Disk(inertia=0.3),
            tn.HookeJoint(angle=tn.deg(20)),
            tn.Shaft(stiffness=1.1e4, damping=damping, fork_offset=1.0),
            tn.Disk(inertia=0.5),
            tn.HookeJoint(angle=tn.deg(15), plane=0.4),
            tn.Shaft(stiffness=0.9e4, damping=damping),
            tn.Disk(inertia=1.1, load_torque=load),
        ]
    )

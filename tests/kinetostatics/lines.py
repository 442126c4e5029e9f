"""One line twice: as the package describes it, and as the independent vector model does."""

import numpy as np
from vector_model import Line

import trunnion as tn


def driveline(line):
    """The package's description of a vector model's line: shaft, disk, joint, shaft, …"""
    n = len(line.angles)
    elements = [tn.ConstantSpeed()]
    for m in range(n + 1):
        stiffness = line.stiffness[m] if line.stiffness else 1e6
        elements.append(tn.Shaft(stiffness=stiffness, fork_offset=line.fork_offsets[m] if m < n else 0.0))
        if line.inertias[m] or m == n:
            load = line.load if m == n else 0.0
            elements.append(tn.Disk(inertia=line.inertias[m] or 1.0, load_torque=load))
        if m < n:
            elements.append(tn.HookeJoint(angle=line.angles[m], plane=line.planes[m]))
    return tn.Driveline(elements)


def random_line(joints, seed, **changes):
    """A vector model's line with random spatial geometry."""
    rng = np.random.default_rng(seed)
    numbers = {
        "angles": list(rng.uniform(0.1, 0.7, joints)),
        "planes": list(rng.uniform(-3, 3, joints)),
        "fork_offsets": list(rng.uniform(-3, 3, joints)),
        "lengths": list(rng.uniform(0.3, 1.5, joints - 1)),
        "load": 137.0,
        "speed": 3.0,
    }
    return Line(**(numbers | changes))


def arguments(line):
    """The arguments of ``tn.kinetostatics`` that a vector model's line stands for."""
    given = {
        "speed": line.speed,
        "acceleration": line.acceleration,
        "inertia": any(line.inertias),
        "lengths": {f"Shaft {m + 2}": length for m, length in enumerate(line.lengths)},
    }
    if line.bearings:
        given["supports"] = [(f"Shaft {m + 1}", *line.bearings[m]) for m in sorted(line.bearings)]
    if line.pin_friction:
        given["friction"] = tn.CrossFriction(coefficient=2 * line.pin_friction, pin_radius=0.05, arm=0.1)
    return given


def row(angles, planes=None, offsets=None, load=0.0):
    """A line of Hooke's joints by degrees: shaft, joint, shaft, …, disk."""
    n = len(angles)
    planes, offsets = planes or [0.0] * n, offsets or [0.0] * n
    elements = [tn.ConstantSpeed()]
    for angle, plane, offset in zip(angles, planes, offsets, strict=True):
        elements.append(tn.Shaft(stiffness=1e5, fork_offset=tn.deg(offset)))
        elements.append(tn.HookeJoint(angle=tn.deg(angle), plane=tn.deg(plane)))
    return tn.Driveline([*elements, tn.Shaft(stiffness=1e5), tn.Disk(inertia=1.0, load_torque=load)])

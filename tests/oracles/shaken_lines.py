"""Random lines of every structure that the linear steady response knows, all that shakes them scaled by one number."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

import trunnion as tn

KINDS = ("driven", "branched", "geared", "free", "free branched", "free geared", "free straight")
"""Structures, one after the other by seed."""


class _Parts:
    """Random elements; excitations, errors of teeth and shares of varying stiffness go with ``scale``, the joints'
    angles with its root, since β² is what they force."""

    def __init__(self, seed: int, scale: float, straight: bool) -> None:
        self.rng = np.random.default_rng(seed)
        self.scale, self.straight, self.count = scale, straight, 0

    def between(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def disk(self, load: bool = False, **more: Any) -> tn.Disk:
        """Of every second load a part grows with the speed or with its square."""
        harmonics = [
            {
                "order": float(self.rng.choice([0.5, 1, 1.5, 2, 3, 4])),
                "amplitude": self.scale * self.between(10, 60),
                "phase": self.between(-3, 3),
            }
            for _ in range(int(self.rng.integers(0, 3)))
        ]
        torque, kind = self.between(5, 40), int(self.rng.integers(4))
        if load:
            more |= {"load_torque": torque}
            more |= {"viscous_load": torque / 100} if kind == 0 else {}
            more |= {"quadratic_load": torque / 5000} if kind == 1 else {}
        self.count += 1
        return tn.Disk(name=f"disk {self.count}", inertia=self.between(0.1, 0.5), excitation=harmonics, **more)

    def shaft(self, **more: Any) -> tn.Shaft:
        k = self.between(5e3, 2e4)
        return tn.Shaft(stiffness=k, damping=k * 1e-3, fork_offset=self.between(-3, 3), **more)

    def joint(self) -> Any:
        """A Hooke's joint, or one in four a double Cardan joint that does not quite even out."""
        kind, bend = int(self.rng.integers(4)), np.sqrt(self.scale) * self.between(0.1, 0.4)
        plane = self.between(-3, 3)
        if self.straight:
            return tn.IdealJoint()
        if kind == 0:
            return tn.DoubleCardanJoint(angle=bend, plane=plane, distance_ratio=self.between(0.5, 2.0))
        return tn.HookeJoint(angle=bend, plane=plane)

    def ratio(self) -> list[Any]:
        kind = int(self.rng.integers(3))
        return [] if kind == 0 else [tn.Ratio(ratio=float(self.rng.choice([-2.0, 0.5, 2.0])))]

    def mesh(self) -> list[Any]:
        """Gears with an error of their teeth and, one in two, a stiffness that varies from tooth to tooth."""
        teeth = Fraction(*map(int, self.rng.choice([(12, 24), (9, 9), (20, 10), (12, 18)])))
        factor, varies = int(self.rng.integers(8, 13)), self.rng.random() < 0.5
        error, share = self.scale * self.between(1e-5, 5e-5), self.scale * self.between(0.05, 0.3)
        phases = self.between(-3, 3), self.between(-3, 3)
        pair = tn.GearPair(
            teeth_in=teeth.numerator * factor, teeth_out=teeth.denominator * factor, module=0.005,
            mesh_stiffness=self.between(2e7, 1e8), mesh_damping=self.between(2e3, 2e4),
            transmission_error=[{"order": 1, "amplitude": error, "phase": phases[0]}],
            stiffness_variation=[{"order": 1, "share": share, "phase": phases[1]}] if varies else [],
        )  # fmt: skip
        return [pair]

    def tail(self) -> list[Any]:
        """A joint, a disk, what follows it, and the load at the end."""
        return [self.joint(), self.disk(), *self.ratio(), self.shaft(), self.disk(load=True)]


def shaken_line(seed: int, scale: float) -> tn.Driveline:
    """The line of a seed, its structure ``KINDS[seed % 7]``, everything that shakes it scaled."""
    kind = KINDS[seed % len(KINDS)]
    parts = _Parts(seed, scale, straight=kind == "free straight")
    drive = [parts.disk(drive_share=1)] if "free" in kind else [tn.ConstantSpeed()]
    elements: list[Any] = [*drive, parts.shaft(), parts.disk()]
    if "geared" in kind:
        elements += [*parts.mesh(), parts.disk()]
    elements += [parts.joint(), parts.shaft(), parts.disk(load=True)]
    if "branched" in kind or "straight" in kind:
        fork = elements[-1 if seed % 2 else len(drive) + 1]
        elements += parts.tail()
        elements += [parts.shaft(after=fork.name), parts.disk(), *parts.tail()]
    elif seed % 3:
        elements += parts.tail()
    return tn.Driveline(elements)

"""Charts whose axes are phases, planes and offsets, on lines of many kinds; and a line with one number changed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

import trunnion as tn

QUARTER = math.pi / 2


@dataclass(frozen=True)
class PhaseChart:
    """A line with the two axes (parameter, low, high) of a chart and its speed where none is an axis."""

    line: tn.Driveline
    x: tuple[str, float, float]
    y: tuple[str, float, float]
    speed: float | None

    def compute(self, across: int = 160, up: int = 130) -> tn.StabilityChart:
        """The chart; by default just large enough for slabs."""
        return tn.stability_chart(self.line, (*self.x, across), (*self.y, up), speed=self.speed)

    def truth(self, x: float, y: float) -> tn.Stability:
        """``stability`` of the line with both numbers put in by hand."""
        line, speed = self.line, self.speed
        for (path, *_), value in ((self.x, x), (self.y, y)):
            if path == "speed":
                speed = value
            else:
                line = with_number(line, path, value)
        return tn.stability(line, speed)


def with_number(line: tn.Driveline, path: str, value: float) -> tn.Driveline:
    """The line with one number of one element replaced."""
    name, _, key = path.rpartition(".")
    elements = [
        type(e)(**{**e.stated, key: value}) if n == name else e for n, e in zip(line.names, line.elements, strict=True)
    ]
    return tn.Driveline(elements)


def _shaft(rng: np.random.Generator, damped: bool, fork: bool = True) -> tn.Shaft:
    stiffness = float(rng.uniform(0.5, 2.0))
    offset = float(rng.choice([0.0, QUARTER, 0.7])) if fork else 0.0
    return tn.Shaft(stiffness=stiffness, damping=0.004 * stiffness if damped else 0.0, fork_offset=offset)


def _disk(rng: np.random.Generator, load: float = 0.0) -> tn.Disk:
    return tn.Disk(inertia=float(rng.uniform(0.4, 1.6)), load_torque=load)


def random_line(seed: int, kind: str) -> tn.Driveline:
    """Three or four inertias with two or three joints: "plain", "loaded", "undamped", "geared", "branched", "stiff"."""
    rng = np.random.default_rng(seed)
    damped = kind != "undamped"
    elements: list[Any] = [tn.ConstantSpeed(), _shaft(rng, damped, fork=False), _disk(rng)]
    for j in range(3 if kind == "plain" and seed % 2 else 2):
        elements.append(tn.HookeJoint(angle=float(rng.uniform(0.2, 0.5))))
        if kind == "geared" and j == 0:
            elements.append(tn.Ratio(teeth_in=2, teeth_out=1))
        elements += [_shaft(rng, damped), _disk(rng, 0.02 if kind == "loaded" and j else 0.0)]
    if kind == "stiff":
        elements += [tn.Shaft(stiffness=60.0, damping=0.01), _disk(rng)]
    if kind == "branched":
        elements.append(tn.HookeJoint(angle=0.35, plane=0.3, after="Disk 1"))
        elements += [_shaft(rng, damped), _disk(rng)]
    return tn.Driveline(elements)


AXES = [
    ("Shaft 2.fork_offset", 0.0, QUARTER),
    ("HookeJoint 2.plane", -QUARTER, QUARTER),
    ("Shaft 1.fork_offset", 0.0, QUARTER),
    ("Shaft 2.fork_offset", -QUARTER, 2 * QUARTER),
]
PARTNERS = [
    ("speed", 0.05, 1.2),
    ("HookeJoint 2.plane", 0.0, QUARTER),
    ("HookeJoint 1.angle", 0.0, 0.6),
    ("speed", 0.1, 2.0),
]
KINDS = ("plain", "loaded", "undamped", "geared", "branched", "stiff")


def phase_chart(seed: int) -> PhaseChart:
    """The chart of one seed; the first few go through all kinds of line and all pairs of axes."""
    line = random_line(seed, KINDS[seed % len(KINDS)])
    x, y = PARTNERS[seed % 4], AXES[(seed // 2) % 4]
    if x[0] == y[0]:
        x = PARTNERS[0]
    return PhaseChart(line, x, y, None if x[0] == "speed" else 0.12)

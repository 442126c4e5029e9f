"""Driveline files to mutate: starters, examples, the catalogue, and every feature a line can have."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from feature_lines import CHANGES, bent, straight, with_tube

from trunnion.driveline.driveline import Driveline
from trunnion.driveline.files import dumps
from trunnion.driveline.starter import STARTERS, starter
from trunnion.errors import InputError
from trunnion.papers.entries import catalogue, entries

TESTS = Path(__file__).parents[1]

# Stated by hand: what ``dumps`` has turned into numbers.
STATED = """\
format = 1
name = "stated in many ways"
[operation]
speed = "1500 rpm"
speed_range = ["600 rpm", "2400 rpm"]
angle_range = ["0 deg", "20 deg"]
[[operation.load_case]]
name = "climb"
loads = { "load" = "250 N*m" }
[[element]]
type = "Disk"
name = "engine"
inertia = "0.4 kg*m^2"
drive_share = 1
excitation = [{ order = 2, amplitude = "20 N*m", phase = "10 deg" }, { frequency = "30 Hz", amplitude = "5 N*m" }]
[[element]]
type = "Shaft"
material = "steel"
outer_diameter = "60 mm"
inner_diameter = "40 mm"
length = "1.2 m"
loss_factor = 0.02
[[element]]
type = "Disk"
name = "hub"
inertia = "0.1 kg*m^2"
[[element]]
type = "HookeJoint"
angle = "12 deg"
plane = "20 deg"
[[element]]
type = "Shaft"
stiffness = "10 kN*m/rad"
fork_offset = "90 deg"
[[element]]
type = "Disk"
name = "load"
inertia = "0.9 kg*m^2"
load_torque = "100 N*m"
viscous_load = "0.1 N*m*s/rad"
[[element]]
type = "Coupling"
stiffness = "20 kN*m/rad"
relative_damping = 1.1
nominal_torque = "900 N*m"
[[element]]
type = "Disk"
name = "vehicle"
mass = "12 t"
radius = "0.5 m"
quadratic_load = "0.001 N*m*s^2/rad^2"
[[element]]
type = "PiecewiseShaft"
after = "hub"
stages = [{ stiffness = "5 kN*m/rad", limit = "1 deg" }, { stiffness = "9 kN*m/rad" }]
damping = "3 N*m*s/rad"
[[element]]
type = "Disk"
name = "side"
inertia = "0.05 kg*m^2"
"""


@cache
def texts() -> tuple[str, ...]:
    lines = [bent(), straight(), with_tube()]
    for change in (change for pair in CHANGES.values() for change in pair):
        for line in lines[:2]:
            try:
                lines.append(change(line))
            except InputError:  # what this line cannot have
                continue
    lines += [line for entry in entries() if isinstance(line := catalogue(entry.name), Driveline)]
    named = [path.read_text(encoding="utf-8") for path in sorted((TESTS.parent / "examples").glob("*.toml"))]
    return tuple(dict.fromkeys([*map(starter, STARTERS), *named, STATED, *map(dumps, lines)]))

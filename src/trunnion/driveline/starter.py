"""Commented driveline files to start from: what ``trunnion new two-shaft`` writes."""

from __future__ import annotations

from importlib.resources import files

from trunnion.driveline.refusals import nearest
from trunnion.errors import InputError

STARTERS = {
    "two-shaft": "drive, shaft, Hooke's joint, shaft, load: the smallest line with a joint",
    "three-shaft": "two Hooke's joints with forks in line, which cancel each other's irregularity",
    "electric-drive": "a pump on an asynchronous motor, which finds its own speed",
    "ship": "six-cylinder engine with viscous damper, flexible coupling, gear and propeller",
    "two-stroke": "six-cylinder engine that drives its propeller directly, with a barred speed range",
    "rolling-mill": "stand of a strip mill: pinion stand, two spindles, rolls in a loop that the strip closes",
    "passenger-car": "four-cylinder engine with dual-mass flywheel, gearbox, differential, tyres and car",
    "dumper": "engine, torque converter, gearbox and axle with their losses, tyres and a loaded vehicle",
    "truck": "one-piece propeller shaft with final drive, axle shafts and vehicle",
}
"""Name and one line about each."""


def starter(name: str) -> str:
    """TOML text of the starter called `name`; InputError with the nearest name where there is none."""
    if name not in STARTERS:
        raise InputError("is not a starter", key="new", value=name, remedy=nearest(name, STARTERS))
    return files("trunnion.driveline").joinpath("starters", f"{name}.toml").read_text(encoding="utf-8")

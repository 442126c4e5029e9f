"""Draws the pictures of docs/transients.md.

PYTHONPATH=src python docs/figures/transients.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import trunnion as tn
from trunnion.motion.passing.capture_map import CaptureMap
from trunnion.pictures.draw_matplotlib import draw, save
from trunnion.pictures.looks import curve
from trunnion.pictures.picture import Axis, Line, Panel, Picture
from trunnion.pictures.transients import capture_map

IMAGES = Path(__file__).parents[1] / "images"


def weak_motor() -> CaptureMap:
    """A motor behind a joint and a mode at 50 rad/s, which the joint shakes at 25 rad/s: angle and torque."""
    shaft = tn.Shaft(stiffness=2e3, damping=1.0)
    disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
    line = tn.Driveline([disks[0], tn.HookeJoint(angle="10 deg"), shaft, disks[1]])
    motor = tn.AppliedTorque(on="motor", time=[0], torque=[2.5], between="steps")
    angles = "HookeJoint 1.angle", tn.deg(3), tn.deg(17), 15
    return tn.capture_map(line, (15.0, 40.0), angles, ("factor", 0.5, 3.5, 13), torque=[motor], phases=4)


SHORT = {"on": "machine", "since": 0.02, "frequency": "50 Hz", "amplitude": 9e3, "decay": 0.08}
FAULTS = {
    "three-phase short circuit": {**SHORT, "mean": 1.5e3},
    "two-phase short circuit": {**SHORT, "twice_amplitude": 4.5e3},
    "reclosure": {**SHORT, "cleared": 0.1, "reclosed": 0.15, "reclosing_amplitude": 12e3, "lost": 2e3},
}
OTHERS = {
    "bite and tail-out": {"on": "machine", "since": 0.03, "torque": 5e3, "rise": 0.02, "until": 0.12, "fall": 0.03},
    "impacts": {
        "on": "machine",
        "peaks": [3e3, 4e3, 2.5e3],
        "width": "60 deg",
        "spacing": "100 deg",
        "angle": "150 deg",
    },
    "tip-in": {"on": "machine", "since": 0.05, "first": 0.0, "last": 3e3, "rise": 0.06},
    "emergency brake": {"on": "machine", "since": 0.06, "torque": 4e3, "rise": 0.05},
}


def disturbances() -> Picture:
    """Torque over time of what has a name, on a machine so heavy that it goes on at its speed."""
    heavy = tn.Disk(name="machine", inertia=1e5)
    line = tn.Driveline([heavy, tn.Shaft(stiffness=1e4, damping=1.0), tn.Disk(inertia=1e5)])
    times = np.linspace(0.0, 0.2, 2001)

    def torque(case: str, **keys: object) -> np.ndarray:
        run = tn.transient(line, 0.2, disturbance=[tn.Disturbance(case=case, **keys)], speed=50.0)
        return np.asarray(run.at(times).applied[:, 0]) / 1e3

    across = Axis("time", "s", 0.0, 0.2)
    panels = [
        Panel(across if several is OTHERS else Axis("", "", 0.0, 0.2), Axis("torque", "kN m"), [
            Line(times, torque(case, **keys), curve(k), case) for k, (case, keys) in enumerate(several.items())
        ], key="beside")
        for several in (FAULTS, OTHERS)
    ]  # fmt: skip
    return Picture(panels, 7.6, 5.2)


if __name__ == "__main__":
    save(draw(disturbances()).figure.figure, IMAGES / "disturbances-by-name.png")
    found = weak_motor()
    print(found)
    save(draw(capture_map(found)).figure.figure, IMAGES / "capture-of-a-weak-motor.png")

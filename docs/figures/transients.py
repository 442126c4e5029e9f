"""Draws the picture of docs/transients.md.

PYTHONPATH=src python docs/figures/transients.py
"""

from __future__ import annotations

from pathlib import Path

import trunnion as tn
from trunnion.motion.passing.capture_map import CaptureMap
from trunnion.pictures.draw_matplotlib import draw, save
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


if __name__ == "__main__":
    found = weak_motor()
    print(found)
    save(draw(capture_map(found)).figure.figure, IMAGES / "capture-of-a-weak-motor.png")

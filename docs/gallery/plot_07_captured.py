"""
Does a weak motor pass the resonance?
=====================================

A motor of 2.5 N m runs a line up: with a joint of 15° and with one of 5°.
"""

import matplotlib.pyplot as plt

import trunnion as tn

disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
weak = tn.AppliedTorque(on="motor", time=[0], torque=[2.5], between="steps")
figure, rows = plt.subplots(2, 1, figsize=(7, 6), layout="constrained")
for axes, angle in zip(rows, (15, 5), strict=True):
    shaft = tn.Shaft(stiffness=2e3, damping=1.0)
    line = tn.Driveline([disks[0], tn.HookeJoint(angle=tn.deg(angle)), shaft, disks[1]])
    found = tn.passing(line, (15.0, 40.0), torque=[weak])
    found.plot(axes)
    axes.set_title(f"joint of {angle}°")
    print(f"{angle}°: {found.outcome.kind}.")

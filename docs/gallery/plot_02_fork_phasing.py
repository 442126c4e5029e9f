"""
Which fork offset makes the output even?
========================================

Two joints of unlike angle: how uneven is the output over the fork offset of the shaft between them?
"""

import matplotlib.pyplot as plt
import numpy as np

import trunnion as tn


def line(offset):
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.HookeJoint(angle="12 deg"),
            tn.Shaft(stiffness="20 kN*m/rad", fork_offset=offset),
            tn.Disk(inertia=0.05),
            tn.HookeJoint(angle="9 deg"),
            tn.Disk(inertia=0.5),
        ]
    )


offsets = np.linspace(-90, 90, 73)
uneven = [100 * tn.kinetostatics(line(tn.deg(a)), speed=1.0).irregularity for a in offsets]
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
axes.plot(offsets, uneven)
axes.axhline(0.27, color="0.5", ls="--")
axes.text(-88, 0.36, "guideline 0.27 %", color="0.35")
axes.set(xlabel="fork offset [deg]", ylabel="unevenness of the output [%]", xlim=(-90, 90), ylim=(0, None))
best = int(np.argmin(uneven))
print(f"Forks in line ({offsets[best]:.0f}°) are best: {uneven[best]:.2f} % is left, because the angles differ.")

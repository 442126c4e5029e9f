"""
How much damping is best?
=========================

An untuned viscous damper of equal inertia: too little, the best, and too much.
"""

import matplotlib.pyplot as plt
import numpy as np

import trunnion as tn

best = 2 * 100.0 / np.sqrt(12)  # of K = 1e4 N m/rad and J = 1 kg m²
speeds = np.linspace(40, 140, 300)
peaks = {}
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for share, label in ((0.2, "a fifth"), (1.0, "the best"), (5.0, "five times")):
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e4, name="spring"),
            tn.Disk(inertia=1.0, excitation=[{"order": 1, "amplitude": 10.0}]),
            tn.ViscousDamper(ring_inertia=1.0, damping=share * best),
        ]
    )
    torque = tn.order_response(line, speeds).vibratory_torque[:, 0]
    peaks[share] = torque.max() / 10.0
    axes.semilogy(speeds, torque / 10.0, label=label)
axes.set(xlabel="frequency [rad/s]", ylabel="torque over static torque", ylim=(0.3, 30))
axes.legend(title="damping")
print(f"With the best damping the peak is {peaks[1.0]:.2f} times the static torque; theory says 3 for equal inertias.")

"""
Does a quick run-up spare the shafts?
=====================================

The same resonance passed slowly and quickly, beside the steady response.
"""

import matplotlib.pyplot as plt

import trunnion as tn

line = tn.Driveline(
    [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness="12 kN*m/rad", damping="1 N*m*s/rad"),
        tn.Disk(inertia="0.4 kg*m^2"),
        tn.HookeJoint(angle="8 deg"),
        tn.Shaft(stiffness="10 kN*m/rad", damping="1 N*m*s/rad"),
        tn.Disk(inertia="0.9 kg*m^2"),
    ]
)
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
peaks = {}
for rate in (10, 100):
    run = tn.run_up(line, tn.rpm(200), tn.rpm(600), acceleration=tn.rpm(rate), steady=21)
    motion = run.simulation
    peaks[rate] = abs(motion.torque[:, 0]).max()
    axes.plot(200 + rate * motion.time, motion.torque[:, 0], lw=0.6, label=f"{rate} rpm/s")
axes.set(xlabel="input speed [rpm]", ylabel="torque of shaft 1 [N m]")
axes.legend()
print(f"At 100 rpm/s the peak is {peaks[100]:.0f} N m, at 10 rpm/s {peaks[10]:.0f} N m.")

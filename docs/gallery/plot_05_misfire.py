"""
Which cylinder out of work is worst?
====================================

Every cylinder of a six-cylinder ship misfires in turn. File: :download:`six-cylinder-ship.toml <../../../examples/six-cylinder-ship.toml>` with :download:`six-cylinder-ship.csv <../../../examples/six-cylinder-ship.csv>`.
"""

import matplotlib.pyplot as plt
import numpy as np

import trunnion as tn

line = tn.load("../../examples/six-cylinder-ship.toml")
low, high = line.operation.speed_range
speeds = np.linspace(low, high, 60)
found = tn.misfire(line, speeds)
healthy = tn.order_response(line, speeds)
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for response, label in ((healthy, "all cylinders fire"), (found.response, f"cylinder {found.worst[1]} misfires")):
    axes.plot(speeds / tn.rpm(1), response.vibratory_torque.max(axis=1) / 1e3, label=label)
axes.set(xlabel="speed [rpm]", ylabel="largest vibratory torque of all shafts [kN m]")
axes.legend()
more = (found.response.vibratory_torque.max(axis=1) / healthy.vibratory_torque.max(axis=1)).max()
print(f"Cylinder {found.worst[1]} is the worst: at one speed the torque is {more:.1f} times that of normal running.")

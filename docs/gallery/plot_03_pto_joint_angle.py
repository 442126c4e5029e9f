"""
How far may a power take-off shaft be lifted?
=============================================

Stability over speed and the angle of both joints. File: :download:`pto-shaft.toml <../../../examples/pto-shaft.toml>`.
"""

import numpy as np

import trunnion as tn

line = tn.load("../../examples/pto-shaft.toml")
chart = tn.stability_chart(line, ("speed", tn.rpm(300), tn.rpm(1050), 150), ("HookeJoint *.angle", 0, tn.deg(45), 90))
picture = chart.plot()
unstable = np.asarray(chart.data["spectral_radius"]) > 1
first = int(np.flatnonzero(unstable.any(axis=1))[0])
angle = np.degrees(np.linspace(0, tn.deg(45), 90)[first])
print(f"The line is stable at every speed up to joint angles of {angle:.0f}°.")

"""
Does fork phasing move instability? (Soltan Rezaee and co-authors 2013)
=======================================================================

Three shafts and two joints: the forks as in the paper, and in line.
"""

import matplotlib.pyplot as plt
import numpy as np

import trunnion as tn

share = {}
figure, rows = plt.subplots(1, 2, figsize=(9, 4), layout="constrained", sharey=True)
for axes, offset in zip(rows, (np.pi / 2, 0.0), strict=True):
    line = tn.catalogue("three-shaft-cardan", fork_offset=offset)
    chart = tn.stability_chart(line, ("speed", 0.2, 2.0, 160), ("HookeJoint *.angle", 0.0, 1.0, 100))
    unstable = np.asarray(chart.data["spectral_radius"]) > 1
    axes.imshow(unstable, origin="lower", extent=(0.2, 2.0, 0, np.degrees(1.0)), aspect="auto", cmap="Greys")
    axes.set(xlabel="input speed Ω", title=f"fork offset {np.degrees(offset):.0f}°")
    share[offset] = 100 * unstable.mean()
    print(f"Fork offset {np.degrees(offset):.0f}°: {100 * unstable.mean():.1f} % of the chart is unstable.")
print(
    "Forks in line pass rotation evenly.",
    "They do" if share[0.0] < share[np.pi / 2] else "They do not",
    "make this line more stable.",
)
rows[0].set_ylabel("angle of both joints [deg]")

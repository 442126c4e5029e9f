"""
What does chaos look like?
==========================

The Poincaré map of Ueda's oscillator: one point a forcing period.
"""

import trunnion as tn

ueda = tn.reference_system("ueda")
picture = tn.poincare_map(ueda, 4000).plot()
spectrum = tn.lyapunov_spectrum(ueda, periods=2000, starts=1)
print(f"The largest Lyapunov exponent is {spectrum.exponents[0]:.3f} ± {spectrum.half_width[0]:.3f} 1/s: chaos.")

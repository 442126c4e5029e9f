"""Numbers of known motions, shared by tests of shooting, continuation, harmonic balance and events.

Duffing's and the dead-zone oscillator's were computed once by an independent code (shooting with piecewise exact
propagation, 40 harmonics) and are given to the digits printed there. The backlash values are the closed form of
the equations of ``Modelica.Mechanics.Rotational.Components.ElastoBacklash``.
"""

from __future__ import annotations

DUFFING_FOLDS = ((1.2696020, 2.8250167), (1.1157003, 1.0818703))
"""(ω, amplitude of the fundamental) of x″ + 0.05x′ + x + 0.1x³ = 0.18 cos ωt."""
DUFFING_LOWER, DUFFING_UPPER, DUFFING_UPPER_LARGEST = 0.4175205, 2.5091976, 2.5455767
"""Fundamental amplitudes at ω = 1.2 and the largest |x| on the upper branch (scipy's event at v = 0)."""

DEAD_ZONE_OUTER = (1.1774443369, 0.0043562439)
DEAD_ZONE_INNER = (0.3961252588, 0.1903978645)
"""States at t = 0 of the two attractors of x″ + 0.1x′ + g(x) = 0.1 + 0.05 cos 0.6t, |x| < 1 free."""
DEAD_ZONE_PEAK_TO_PEAK = (0.15556785, 1.2153164)
DEAD_ZONE_MULTIPLIER = 0.14600 + 0.57411j
DEAD_ZONE_GRAZING = (0.71068737, 1.21857436)
DEAD_ZONE_FOLDS = (0.45054, 0.74810)

BACKLASH = ((0.0235, 0.5687300), (0.04, -0.5228339), (0.0615, -1.3339752), (0.09, -0.2791013))
"""(t [s], φ [rad]) for J = 5 kg m², c = 20e3 N m/rad, d = 50 N m s/rad, gap 45° in all, from rest at 90°."""

TAYLOR_RUNS = {
    "duffing": (12.0, [0.5, 0.0], [0.8686429783190082, 0.643075473963459]),
    "driven-pendulum": (5.0, [0.3, 0.1], [8.86502862708379, -0.8605702810395685]),
    "ueda": (4.0, [2.5, 0.0], [-0.20884483553010968, 3.45740908929394]),
    "lorenz": (2.0, [1.0, 1.0, 20.0], [2.7868707480443824, 5.4906902820233325, 6.61155268749331]),
    "rossler": (12.0, [1.0, 1.0, 1.0], [4.244614604867771, 1.0047964124415778, 0.11889204155632827]),
    "mathieu": (10.0, [1.0, 0.0], [-1.9119621220866154, -0.3868580497742051]),
}
"""(duration, start, end) of reference systems by ``oracles.taylor`` with 20 digits; slow tests compute them again."""

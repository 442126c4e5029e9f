"""Coefficients of the eighth-order Runge–Kutta pair of Dormand and Prince (DOP853).

Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, 2nd ed., section II.5; the numbers are
taken from scipy's transcription. ``E3`` and ``E5`` weigh the stages for the two embedded error estimates.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate._ivp import dop853_coefficients as _published

STAGES = 12
A = np.ascontiguousarray(_published.A[:STAGES, :STAGES])
B = np.ascontiguousarray(_published.B[:STAGES])
C = np.ascontiguousarray(_published.C[:STAGES])
E3 = np.ascontiguousarray(_published.E3[:STAGES])
E5 = np.ascontiguousarray(_published.E5[:STAGES])

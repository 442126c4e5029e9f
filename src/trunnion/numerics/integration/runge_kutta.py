"""Coefficients of the eighth-order Runge–Kutta pair of Dormand and Prince (DOP853).

Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, 2nd ed., section II.5; the numbers are
taken from scipy's transcription. ``E3`` and ``E5`` weigh the stages for the two embedded error estimates.
"""

from __future__ import annotations

from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import numpy as np


def _transcription() -> ModuleType:
    """scipy's file of coefficients alone: its package of integrators takes long to load."""
    package = find_spec("scipy")
    assert package is not None and package.origin is not None
    file = Path(package.origin).parent / "integrate" / "_ivp" / "dop853_coefficients.py"
    spec = spec_from_file_location("dop853_coefficients", file) if file.exists() else None
    if spec is None or spec.loader is None:
        from scipy.integrate._ivp import dop853_coefficients

        return dop853_coefficients  # type: ignore[no-any-return]
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


_published = _transcription()

STAGES = 12
A = np.ascontiguousarray(_published.A[:STAGES, :STAGES])
B = np.ascontiguousarray(_published.B[:STAGES])
C = np.ascontiguousarray(_published.C[:STAGES])
E3 = np.ascontiguousarray(_published.E3[:STAGES])
E5 = np.ascontiguousarray(_published.E5[:STAGES])

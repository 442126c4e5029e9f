"""Reference problems of the literature."""

from __future__ import annotations

import numpy as np

from trunnion.systems.periodic_linear import PeriodicLinearSystem, from_matrices


def mathieu(a: float, q: float, damping: float = 0.0) -> PeriodicLinearSystem:
    """Damped Mathieu oscillator y″ + 2ζy′ + (a − 2q cos 2x) y = 0, period π; ``damping`` is ζ."""
    return from_matrices(
        np.eye(1),
        np.array([[2.0 * damping]]),
        lambda x: (a - 2 * q * np.cos(2 * x))[:, None, None],
        period=np.pi,
        names=("y",),
    )

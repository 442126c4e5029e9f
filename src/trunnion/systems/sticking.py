"""Sliders that stick throughout a periodic motion: what they leave as it was, and the system in which they hold.

The deflection of such a slider beside the twist that it follows comes back whatever it is. The motion is one of a
continuum, and the gradient of that difference is a left eigenvector of its monodromy matrix, with the multiplier 1.
"""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.numerics.integration.integration import kernel
from trunnion.systems.system import System


def conserved(system: System, time: float, state: Array, stuck: Integers) -> Array:
    """Gradients (k, n) by the state of the deflections beside the twists of the sliders that are ``stuck``."""
    if not len(stuck):
        return np.zeros((0, system.size))
    assert system.regimes is not None
    equations = system.equations
    count = equations.transitions.shape[1]
    g, slopes = np.zeros(count), np.zeros(count * (system.size + 1))
    kernel().call_guard(equations.guard, float(time), state, system.numbers.copy(), 0, g, slopes)
    return system.regimes.conserved(stuck, slopes.reshape(count, -1))


def holding(system: System, stuck: Integers) -> System:
    """The system in which sliders that are ``stuck`` are kept from slipping, which rounding could let them."""
    assert system.regimes is not None
    numbers = system.regimes.holding(stuck, system.numbers)
    return system.with_fields(numbers_of=lambda values: numbers)

"""A motion in time that ends where it leaves the curves of a torque converter."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.line_system import LineSystem
from trunnion.results.outcome import Outcome

NO_FURTHER = ("not finite", "step too small")


def converter_end(line: LineSystem, time: float, state: Array, numbers: Array, outcome: Outcome) -> Outcome:
    """The ``outcome`` of a motion that ends at a state, in words of the converter whose curves it leaves there."""
    if outcome.kind not in NO_FURTHER or not line.converters:
        return outcome
    speed = line.moving(np.array([time]), state[None], numbers)[1][0]
    for converter in line.converters:
        if words := converter.left_curves(speed):
            return Outcome(False, "beyond curves", f"stopped at t = {time:.6g} s, where {words}")
    return outcome

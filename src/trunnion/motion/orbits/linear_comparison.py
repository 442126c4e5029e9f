"""What the two linearisations of a line say beside its periodic motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline
from trunnion.errors import ComputationError
from trunnion.floquet.stability.stability import Stability, stability


@dataclass(frozen=True)
class LinearComparison:
    """The same line linearised: about zero twist and about the twist of its static load.

    growth_rate [1/s] of the true motion and of the two linearisations; torque_peak_to_peak (shaft,) [N m] of the
    true motion and of the linear steady response about static twist.
    """

    growth_rate: float
    zero_twist: Stability
    static_twist: Stability
    torque_peak_to_peak: Array
    linear_torque_peak_to_peak: Array
    shafts: tuple[str, ...]

    @property
    def agree(self) -> bool:
        """Whether all three say the same about stability."""
        signs = {np.sign(round(v, 9)) for v in (self.growth_rate, self.zero_twist.growth_rate)}
        return len(signs | {np.sign(round(self.static_twist.growth_rate, 9))}) == 1

    def __str__(self) -> str:
        worst = int(np.argmax(self.torque_peak_to_peak))
        return (
            f"growth rate {self.growth_rate:+.6g} 1/s here, {self.zero_twist.growth_rate:+.6g} linearised about zero "
            f"twist, {self.static_twist.growth_rate:+.6g} about the static twist; torque of {self.shafts[worst]} "
            f"{self.torque_peak_to_peak[worst]:.5g} N m peak to peak here, "
            f"{self.linear_torque_peak_to_peak[worst]:.5g} by linear theory"
        )


def compared(
    speed: float, line: Driveline, growth_rate: float, peak_to_peak: Array, shafts: tuple[str, ...]
) -> LinearComparison:
    """The comparison of a motion at ``speed`` [rad/s], with its growth rate and torques (shaft,) [N m] peak to peak.

    Raises
    ------
    InputError : the linear equations do not have what the line has.
    """
    static = stability(line, speed)
    if static.response is None:
        raise ComputationError(f"no linear response: {static.no_response}")
    return LinearComparison(
        growth_rate,
        stability(line, speed, statically_twisted=False),
        static,
        peak_to_peak,
        2 * static.response.torque_amplitude,
        shafts,
    )

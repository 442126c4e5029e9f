"""What gear meshes and shafts with stages do in a periodic motion: which sides they touch, and how hard they land.

A spring is in its play while it is in its softest stage, and lands where it passes from there to another. The impact
energy is that of the approach, ½ m q̇², m the inertia that the rest of the straight line opposes to a push between the
two ends of the spring, 1/m = eᵀM⁻¹e; its sum over a period is the rattle index of the spring.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from trunnion.equations.aligned import aligned_matrices
from trunnion.equations.line_regimes import StagedSpring, staged_springs

if TYPE_CHECKING:
    from trunnion.analyses.orbits.periodic_response import PeriodicResponse

Array = NDArray[np.float64]
SIDES = {"lower": "drive side", "upper": "coast side", "both": "drive and coast sides"}
AHEAD = 1e-6
"""Over the period: how long before an impact the rate of twist is taken."""


@dataclass(frozen=True)
class SpringContact:
    """One spring over a period of the motion.

    stage_shares (stages,): shares of the period in each stage; play_share: in the softest; sides touched: "none",
    "lower" (the output lags: the drive flank), "upper" or "both"; impacts per period; approach_speeds (impacts,) of
    twist [rad/s]; impact_energy per period [J].
    """

    spring: str
    stage_shares: Array
    play_share: float
    sides: str
    approach_speeds: Array
    impact_energy: float

    @property
    def impacts(self) -> int:
        """Landings per period of the motion."""
        return len(self.approach_speeds)

    @property
    def contact(self) -> str:
        """none, one-sided or two-sided."""
        return {"none": "none", "both": "two-sided"}.get(self.sides, "one-sided")

    @property
    def rattles(self) -> bool:
        """Whether it leaves its contact and lands again."""
        return self.impacts > 0

    def __str__(self) -> str:
        if self.sides == "none":
            return f"{self.spring} stays in its softest stage"
        if not self.rattles:
            return f"{self.spring} stays on its {SIDES[self.sides]}"
        times = "impact" if self.impacts == 1 else "impacts"
        return (
            f"{self.spring} lands on its {SIDES[self.sides]}, {self.impacts} {times} per period at up to "
            f"{self.approach_speeds.max():.4g} rad/s, {self.impact_energy:.4g} J in all; between its stages "
            f"{self.play_share:.1%} of the time"
        )


def spring_contacts(response: PeriodicResponse) -> tuple[SpringContact, ...]:
    """Contact of every gear mesh with backlash and every shaft with stages in a periodic response; () without any."""
    if not response.outcome.ok or response.orbit.system.regimes is None:
        return ()
    line, system = response.line, response.orbit.system
    row = np.array([system.parameters[label] for label in line.assembly.packed.labels])
    springs = {e: s for e, s in staged_springs(line.assembly, row).items() if s.stages > 1}
    assembly = line.assembly
    matrices = aligned_matrices(
        assembly.topology, assembly.coefficients(row[None], statically_twisted=False, free_play=True)
    )
    found = []
    for e, spring in springs.items():
        direction = assembly.topology.elongations[e]
        inertia = 1 / float(np.sum(direction**2 / matrices.mass[0]))
        found.append(_contact(response, e, spring, inertia))
    return tuple(found)


def _contact(response: PeriodicResponse, place: int, spring: StagedSpring, inertia: float) -> SpringContact:
    run, line, system = response.orbit.trajectory, response.line, response.orbit.system
    stage = run.regime // spring.stride % spring.stages
    shares = np.bincount(stage, weights=run.length, minlength=spring.stages) / run.length.sum()
    side = spring.side[stage]
    # The motion is periodic, so the first step follows the last.
    landed = np.flatnonzero((side != 0) & (np.roll(side, 1) == 0))
    ahead = AHEAD * response.period
    speeds = []
    for i in landed:
        end = run.start[i] if i else run.start[-1] + run.length[-1]
        times = np.array([max(end - ahead, run.start[0]), end])
        twist = line.observe(system, times, run.at(times)).twist[:, place]
        speeds.append(abs(twist[1] - twist[0]) / (times[1] - times[0]))
    touched = {int(s) for s in side}
    sides = "both" if {1, -1} <= touched else "upper" if 1 in touched else "lower" if -1 in touched else "none"
    play = float(shares[spring.side == 0].sum())
    energy = 0.5 * inertia * float(np.sum(np.square(speeds)))
    return SpringContact(spring.name, shares, play, sides, np.array(speeds), energy)

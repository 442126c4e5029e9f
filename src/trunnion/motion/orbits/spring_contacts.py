"""What gear meshes and shafts with stages do in a periodic motion: which sides they touch, and how hard they land.

A spring is in its play while it is in its softest stage, and lands where it passes from there to another. The impact
energy is that of the approach, ½ m q̇², m the inertia that the rest of the straight line opposes to a push between the
two ends of the spring, 1/m = eᵀM⁻¹e; its sum over a period is the rattle index of the spring.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.equations.aligned import aligned_matrices
from trunnion.equations.line_regimes import StagedSpring, staged_springs
from trunnion.equations.line_system import LineSystem
from trunnion.steady.shooting.periodic_orbit import IntegratedOrbit

SIDES = {"lower": "drive side", "upper": "coast side", "both": "drive and coast sides"}
AHEAD = 1e-6
"""Over the period: how long before an impact the rate of twist is taken."""
_TOUCHED = {frozenset(): "none", frozenset({-1}): "lower", frozenset({1}): "upper", frozenset({-1, 1}): "both"}


def contact_state(sides: str) -> str:
    """none, one-sided or two-sided."""
    return {"none": "none", "both": "two-sided"}.get(sides, "one-sided")


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

    @classmethod
    def of(cls, spring: str, shares: Array, sides: Integers, approach_speeds: Array, inertia: float) -> Self:
        """From the share of every stage, the side that it stands for (−1, 0 in the softest, 1), both (stages,), and the
        landings of an effective inertia [kg m²]."""
        touched = frozenset(sides[shares > 0].tolist()) - {0}
        energy = 0.5 * inertia * float(np.sum(approach_speeds**2))
        return cls(spring, shares, float(shares[sides == 0].sum()), _TOUCHED[touched], approach_speeds, energy)

    @property
    def impacts(self) -> int:
        """Landings per period of the motion."""
        return len(self.approach_speeds)

    @property
    def contact(self) -> str:
        """none, one-sided or two-sided."""
        return contact_state(self.sides)

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


def spring_contacts(line: LineSystem, orbit: IntegratedOrbit) -> tuple[SpringContact, ...]:
    """Contact of every gear mesh with backlash and every shaft with stages in a periodic motion of a line; () without
    any."""
    system, assembly = orbit.system, line.assembly
    if not orbit.outcome.ok or system.regimes is None:
        return ()
    row = np.array([system.parameters[label] for label in assembly.packed.labels])
    matrices = aligned_matrices(
        assembly.topology, assembly.coefficients(row[None], statically_twisted=False, free_play=True)
    )
    found = []
    for e, spring in staged_springs(assembly, row).items():
        if spring.stages > 1:
            inertia = 1 / float(np.sum(assembly.topology.elongations[e] ** 2 / matrices.mass[0]))
            found.append(_contact(line, orbit, e, spring, inertia))
    return tuple(found)


def _contact(
    line: LineSystem, orbit: IntegratedOrbit, place: int, spring: StagedSpring, inertia: float
) -> SpringContact:
    run = orbit.trajectory
    stage = run.regime // spring.stride % spring.stages
    shares = np.bincount(stage, weights=run.length, minlength=spring.stages) / run.length.sum()
    side = spring.side[stage]
    # The motion is periodic, so the first step follows the last.
    landed = np.flatnonzero((side != 0) & (np.roll(side, 1) == 0))
    speeds = np.empty(len(landed))
    for k, i in enumerate(landed):
        end = run.start[i] if i else run.start[-1] + run.length[-1]
        times = np.array([max(end - AHEAD * orbit.period, run.start[0]), end])
        twist = line.observe(orbit.system, times, run.at(times)).twist[:, place]
        speeds[k] = abs(twist[1] - twist[0]) / (times[1] - times[0])
    return SpringContact.of(spring.name, shares, spring.side, speeds, inertia)

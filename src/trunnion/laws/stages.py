"""Springs, contacts and sliders as stages in each of which the torque is linear, and the surfaces between those.

On a stage the torque is c q′ + s q + d, and of a contact that damps with its depth (a q + b) q′ besides. Two stages
see the surface between them as one function a q + h q′ − r under one number, crossed upwards from one and downwards
from the other, so that behind a crossing nothing starts at a zero whose sign is rounding.

A contact that never pulls presses with τ + min(τ, d), τ the elastic torque and d = c q′, and lets go where τ + d ≤ 0
(the law of Modelica.Mechanics.Rotational.Components.ElastoBacklash). A slider is a Jenkins element: q is the deflection
of its spring, which stands still at the end of its reach while it slips.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.laws.spring import StageSpring

GUARDS = 3
"""Numbers of surfaces per spring, as many as its stages need."""
SLIPS_BACK, STICKS, SLIPS_ON = range(3)
"""Stages of a slider: slips with falling twist, sticks, slips with rising twist."""
SLIDER_STAGES = 3
HELD = 1e6
"""Times what it holds, that a slider is given where it is not to slip: more than any motion asks of it."""


@dataclass(frozen=True)
class Stages:
    """Stages and the surfaces between them.

    pieces (stages, 3): c, s and d; side (stages,): −1 below the softest stage, +1 above, 0 in it; moves (stages,): 0
    where q stands still, else 1; impact (stages, 2): a and b, zero where damping does not go with depth; guards
    (stages, GUARDS, 4): a, h, r and the direction in which the surface is crossed from there, 0 where there is none;
    then (stages, GUARDS): the stage behind it, or −1.
    """

    pieces: Array
    side: Integers
    moves: Array
    impact: Array
    guards: Array
    then: Integers

    @classmethod
    def apart(cls, pieces: ArrayLike, side: ArrayLike = 0, moves: ArrayLike = 1.0) -> Stages:
        """Stages without surfaces."""
        rows = np.array(pieces, dtype=float)
        n = len(rows)
        return cls(
            rows, np.full(n, side, dtype=np.int64), np.full(n, moves, dtype=float), np.zeros((n, 2)),
            np.zeros((n, GUARDS, 4)),
            np.full((n, GUARDS), -1, dtype=np.int64),
        )  # fmt: skip

    def leave(self, stage: int, number: int, function: tuple[float, float, float], direction: int, behind: int) -> None:
        """Put a surface (a, h, r) at the end of a stage."""
        self.guards[stage, number] = *function, direction
        self.then[stage, number] = behind

    def part(self, before: int, number: int, function: tuple[float, float, float], direction: int, behind: int) -> None:
        """Put a surface between two stages, crossed in ``direction`` from ``before``."""
        self.leave(before, number, function, direction, behind)
        self.leave(behind, number, function, -direction, before)


def softest(spring: StageSpring) -> int:
    """The stage with the smallest slope, the gap of a backlash (the one nearest to 0 of several)."""
    ends = [-np.inf, *spring.knots, np.inf]
    distance = [max(ends[i], -ends[i + 1], 0.0) for i in range(len(spring.slopes))]
    return min(range(len(distance)), key=lambda i: (spring.slopes[i], distance[i]))


def stages_of(spring: StageSpring, damping: float, damping_law: str = "always", impact: float = 0.0) -> Stages:
    """The stages of a spring (of one case): damped "always", "in contact" (not in the softest stage) or "never
    pulling"; and by ``impact`` [N m s/rad²] times the depth beyond the softest stage."""
    if damping_law == "never pulling":
        return _contacts(spring, damping)
    count = len(spring.slopes)
    side = np.sign(np.arange(count) - softest(spring))
    damped = np.ones(count) if damping_law == "always" or count == 1 else np.abs(side)
    found = Stages.apart(np.stack([damping * damped, spring.slopes, spring.offsets], axis=1), side)
    if impact:
        gap = softest(spring)
        low, high = spring.knots[gap - 1], spring.knots[gap]
        found.impact[:gap], found.impact[gap + 1 :] = (-impact, impact * low), (impact, -impact * high)
    for i, knot in enumerate(spring.knots):
        found.part(i, i % 2, (1.0, 0.0, knot), 1, i + 1)
    return found


def _contacts(spring: StageSpring, c: float) -> Stages:
    """Gap 0; at each side: pressed no more than doubly, pressed with damping, let go."""
    found = Stages.apart(np.zeros((7, 3)), [0, 1, 1, 1, -1, -1, -1])
    for sign, doubly, at_end, at_double in ((1, 1, 0, 1), (-1, 4, 1, 0)):
        k, knot = float(spring.slopes[1 + sign]), float(spring.knots[0 if sign < 0 else 1])
        damped, free = doubly + 1, doubly + 2
        found.pieces[doubly] = 0.0, 2 * k, -2 * k * knot
        found.pieces[damped] = c, k, -k * knot
        found.part(0, at_end, (1.0, 0.0, knot), sign, doubly)
        found.part(doubly, at_double, (k, -c, k * knot), sign, damped)
        found.part(damped, 2, (k, c, k * knot), -sign, free)
        found.leave(free, at_end, (1.0, 0.0, knot), -sign, 0)
    return found


def slider_stages(stiffness: float, reach: float) -> Stages:
    """The stages of a slider whose spring is deflected by ``reach`` where it slips."""
    found = Stages.apart([[0.0, stiffness, 0.0]] * SLIDER_STAGES, [-1, 0, 1], [0.0, 1.0, 0.0])
    # The deflection is at rest on the first two in slip, which tell it from stick.
    found.part(STICKS, 0, (1.0, 0.0, -reach), -1, SLIPS_BACK)
    found.part(STICKS, 1, (1.0, 0.0, reach), 1, SLIPS_ON)
    found.leave(SLIPS_BACK, 2, (0.0, 1.0, 0.0), 1, STICKS)
    found.leave(SLIPS_ON, 2, (0.0, 1.0, 0.0), -1, STICKS)
    return found


def clutch_stages() -> Stages:
    """The stages of a slip clutch, whose surfaces ``equations.released_kernel`` knows: it slips beyond its capacity,
    and where the slip ends it sticks, or slips the other way at once."""
    found = Stages.apart([[0.0, 0.0, 0.0]] * SLIDER_STAGES, [-1, 0, 1])
    for stage, number, direction, behind in (
        (STICKS, 0, -1, SLIPS_BACK), (STICKS, 1, 1, SLIPS_ON), (SLIPS_ON, 2, -1, STICKS), (SLIPS_ON, 0, -1, SLIPS_BACK),
        (SLIPS_BACK, 2, 1, STICKS), (SLIPS_BACK, 1, 1, SLIPS_ON),
    ):  # fmt: skip
        found.leave(stage, number, (0.0, 0.0, 0.0), direction, behind)
    return found

"""Clutches in a periodic motion: sliders that never slip, and clutches that slip on with every period.

A slider that never slips keeps whatever deflection it came to stick at, and each makes another periodic motion: they
form a continuum. Where the spring of the clutch has one stiffness k and the joints are straight, all have the same
torques. A slider of stiffness kᵢ whose deflection may still move up by uᵢ and down by dᵢ until it slips then shifts the
mean twist by −kᵢuᵢ/k to +kᵢdᵢ/k; without a spring beside it the clutch may stand at any twist. Elsewhere the motions of
the continuum are followed to its ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.clutches import Clutch
from trunnion.equations.clutch_capacity import bounded_clutches
from trunnion.equations.coefficients import Assembly
from trunnion.equations.sliders import PlacedSlider
from trunnion.results.outcome import Outcome
from trunnion.steady.shooting.shooting_problem import ShootingProblem
from trunnion.systems.maps import RubbingMap

STEADY = 0.05
"""Relative change of what a clutch slips from one period to the next, below which it slips on."""
LEAST = 1e-6
"""Slip in a period, over the deflection at which its first slider slips, that counts as slipping on."""
WAITED = 100
"""Periods after which a clutch shows whether it slips on."""
TRIES = 40
"""Motions in which an end of the continuum is looked for."""
REACHED = 50.0
"""Room that a slider may have left there, over the deflection at which it slips and the tolerance of closing."""
HALVINGS = 6
"""Of one step, where the motion beyond it does not close."""
UNDRIVEN = 1e-7
"""Singular value of the closing condition, over its largest, that counts as none."""
FLAT, LONGER, MOST_FLAT = 1e-9, 4.0, 12
"""Share of a shift below which a spring takes up nothing of it; growth of the steps there, and how many are taken until
it is taken to go on without end."""


@dataclass(frozen=True)
class StuckClutch:
    """A clutch of which sliders never slip in a periodic motion, one of a continuum.

    sliders: their names; twist_mean: mean twist [rad] of the motion found; twist_low, twist_high: least and greatest of
    all motions of the continuum, infinite where any twist will do, NaN where the search for them found no end.
    """

    clutch: str
    sliders: tuple[str, ...]
    twist_mean: float
    twist_low: float
    twist_high: float

    def __str__(self) -> str:
        one = len(self.sliders) == 1
        verb, whose = ("sticks", "its multiplier 1 is") if one else ("stick", "their multipliers 1 are")
        names = ", ".join(self.sliders)
        words = f"{names} {verb} throughout ({whose} set aside), so that this motion is one of a continuum"
        if np.isnan([self.twist_low, self.twist_high]).any():
            return f"{words}, the end of which was not found"
        if np.isinf(self.twist_low):
            return f"{words}: {self.clutch} may stand at any mean twist"
        return (
            f"{words}: by where it came to stick the mean twist of {self.clutch} lies between {self.twist_low:.6g} and "
            f"{self.twist_high:.6g} rad, here at {self.twist_mean:.6g} rad"
        )


class Watched(NamedTuple):
    """Of a motion over its period: least and greatest deflection of every slider (slider,) [rad], and mean twist of
    every compliance (compliance,) [rad]."""

    low: Array
    high: Array
    twist_mean: Array


Watch = Callable[[Any, Array], Watched]
"""(map, state) → what the motion from there shows."""


def continuum(
    assembly: Assembly,
    friction_sliders: tuple[PlacedSlider, ...],
    problem: ShootingProblem[Any],
    start: Array,
    watch: Watch,
    shifts_alike: bool,
) -> tuple[StuckClutch, ...]:
    """The clutches with sliders that never slip, in the motion from ``start`` (n,).

    Parameters
    ----------
    rubbing : all sliders of the line.
    closing : of motions in which those that never slip are kept from it.
    shifts_alike : whether the motion only shifts with the mean twist of these clutches.
    """
    here, found = _Sticking(problem, start, watch), []
    stuck = problem.map.fixed
    for e in dict.fromkeys(friction_sliders[i].compliance for i in stuck):
        own = [i for i in stuck if friction_sliders[i].compliance == e]
        place = assembly.topology.compliances[e].shafts[0]
        clutch, mean = assembly.line.elements[place], float(here.seen.twist_mean[e])
        assert isinstance(clutch, Clutch)
        spring = assembly.packed.values[assembly.packed.column(place, "stiffness 1")]
        if shifts_alike:
            up = sum(
                friction_sliders[i].stiffness * max(friction_sliders[i].reach + here.seen.low[i], 0.0) for i in own
            )
            down = sum(
                friction_sliders[i].stiffness * max(friction_sliders[i].reach - here.seen.high[i], 0.0) for i in own
            )
            ends = (mean - down / spring, mean + up / spring) if spring else (-np.inf, np.inf)
        else:  # the further up the sliders of a clutch stand, the less its spring carries, and the lower is its twist
            reach = np.array([friction_sliders[i].reach for i in own])
            ends = (here.end(own, reach, e, 1), here.end(own, reach, e, -1))
        names = tuple(friction_sliders[i].name for i in own)
        found.append(StuckClutch(assembly.line.names[place], names, mean, *ends))
    return tuple(found)


@dataclass(frozen=True)
class _Sticking:
    """A periodic motion of a map that keeps some sliders from slipping, from its start (n,)."""

    problem: ShootingProblem[RubbingMap]
    start: Array
    watch: Watch

    @cached_property
    def seen(self) -> Watched:
        """What it shows."""
        return self.watch(self.problem.map, self.start)

    def end(self, own: list[int], reach: Array, compliance: int, side: int) -> float:
        """Mean twist [rad] of a clutch in the motion of the continuum in which its sliders ``own`` all just reach where
        they slip (``reach``, (own,) [rad]), on one side; infinite where there is none, NaN where none was found."""
        now, shift, flat = self, reach.min() / LONGER, 0
        for _ in range(TRIES):
            room = reach - now.seen.high[own] if side > 0 else -reach - now.seen.low[own]
            if np.abs(room / reach).max() <= REACHED * self.problem.tolerance:
                return float(now.seen.twist_mean[compliance])
            moves, taken = now._directions(own)
            if np.linalg.svd(taken, compute_uv=False)[-1] > FLAT:
                shifts = np.linalg.solve(taken, room)
            else:  # a stage in which the spring takes up nothing of a shift
                shift, flat = LONGER * shift, flat + 1
                shifts = np.full(len(own), side * shift)
            if flat > MOST_FLAT:
                return -side * np.inf
            beyond = (now._moved(moves @ (0.5**k * shifts)) for k in range(HALVINGS))
            further = next((one for one in beyond if one is not None), None)
            if further is None:
                break
            now = further
        return float("nan")

    def _directions(self, own: list[int]) -> tuple[Array, Array]:
        """How the start (n, own) of the motions of the continuum changes with what each of the sliders ``own`` has
        beside the twist that it follows, and their deflections (own, own) with it."""
        place, scale = self.problem.map, self.problem.scale
        closes = place(self.start).tangents * scale / scale[:, None] - np.eye(place.size)
        # Directions that nothing drives: of a free–free line its rotation is one as well.
        _, sizes, directions = np.linalg.svd(closes)
        count = max(len(place.fixed), int(np.sum(sizes <= UNDRIVEN * sizes[0])))
        alike = scale[:, None] * directions[-count:].T
        moves = alike @ np.linalg.pinv(place.conserved(self.start, place.fixed) @ alike)
        moves = moves[:, [place.fixed.index(one) for one in own]]
        return moves, moves[place.deflections[own]]

    def _moved(self, step: Array) -> Self | None:
        """The motion of the continuum near a step (n,) from the start."""
        root = self.problem.solve(self.start + step)
        return replace(self, start=root.x) if root.converged else None


def slipping_on(
    assembly: Assembly,
    speed: float,
    friction_sliders: tuple[PlacedSlider, ...],
    place: RubbingMap,
    start: Array,
    twists: Callable[[Array], Array],
) -> Outcome | None:
    """What to say of a line that has no periodic motion because a clutch slips on with every period once it has settled
    from ``start`` (n,); None where none does. ``twists`` : states (3, n) → (3, compliances) [rad]."""
    states = [start]
    for wait in (WAITED, 1, 1):
        settled = place.settle(states[-1], wait)
        if settled is None:
            return None
        states.append(settled)
    first, second = np.diff(twists(np.array(states[1:])), axis=0)
    for clutch in bounded_clutches(assembly, speed):
        e = clutch.compliance
        least = LEAST * min(slider.reach for slider in friction_sliders if slider.compliance == e)
        if abs(second[e]) > least and abs(second[e] - first[e]) <= STEADY * abs(second[e]):
            load = f"its load of {clutch.load:.6g} N m and the excitation together" if clutch.load else "the excitation"
            words = (
                f"{clutch.name} slips on by {abs(second[e]):.4g} rad in every period: the {clutch.holds:.6g} N m that "
                f"it holds do not carry {load}; raise its friction torque, lower the load, or give it a stiffness"
            )
            return Outcome(False, "slips on", words)
    return None

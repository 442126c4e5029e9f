"""Clutches in a periodic motion: sliders that never slip, and clutches that slip on with every period.

A slider that never slips keeps whatever deflection it came to stick at, and each makes another periodic motion: they
form a continuum. Where the spring of the clutch has one stiffness k and the joints are straight, all have the same
torques. A slider of stiffness kᵢ whose deflection may still move up by uᵢ and down by dᵢ until it slips then shifts the
mean twist by −kᵢuᵢ/k to +kᵢdᵢ/k; without a spring beside it the clutch may stand at any twist. Elsewhere the motions of
the continuum are followed to its ends.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.clutches import Clutch
from trunnion.equations.clutch_capacity import bounded_clutches
from trunnion.equations.coefficients import Assembly
from trunnion.equations.sliders import PlacedSlider
from trunnion.results.outcome import Outcome

STEADY = 0.05
"""Relative change of what a clutch slips from one period to the next, below which it slips on."""
LEAST = 1e-6
"""Slip in a period, over the deflection at which its first slider slips, that counts as slipping on."""


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


def stuck_clutches(
    assembly: Assembly,
    rubbing: Sequence[PlacedSlider],
    stuck: Sequence[int],
    low: Array,
    high: Array,
    twist_mean: Array,
    search: Callable[[list[int]], tuple[float, float]] | None = None,
) -> tuple[StuckClutch, ...]:
    """The clutches with sliders that never slip.

    Parameters
    ----------
    rubbing : all sliders of the line; stuck : places among them of those that never slip.
    low, high : least and greatest deflection of every slider (slider,) [rad] in the motion found.
    twist_mean : mean twist of every compliance [rad].
    search : sliders → least and greatest mean twist [rad] of their clutch, where a shift of the mean twist changes the
        motion otherwise; None where it does not.
    """
    found = []
    for e in dict.fromkeys(rubbing[i].compliance for i in stuck):
        own = [i for i in stuck if rubbing[i].compliance == e]
        place = assembly.topology.compliances[e].shafts[0]
        clutch, mean = assembly.line.elements[place], float(twist_mean[e])
        assert isinstance(clutch, Clutch)
        spring = assembly.packed.values[assembly.packed.column(place, "stiffness 1")]
        if search is not None:
            ends = search(own)
        else:
            up = sum(rubbing[i].stiffness * max(rubbing[i].reach + low[i], 0.0) for i in own)
            down = sum(rubbing[i].stiffness * max(rubbing[i].reach - high[i], 0.0) for i in own)
            ends = (mean - down / spring, mean + up / spring) if spring else (-np.inf, np.inf)
        names = tuple(rubbing[i].name for i in own)
        found.append(StuckClutch(assembly.line.names[place], names, mean, *ends))
    return tuple(found)


def slips_on(assembly: Assembly, speed: float, rubbing: Sequence[PlacedSlider], twists: Array) -> Outcome | None:
    """What to say of a line that has no periodic motion because a clutch slips on; None where none does.

    ``twists`` (3, compliances) [rad] : at the ends of two periods that follow each other, once the line has settled.
    """
    first, second = np.diff(twists, axis=0)
    for clutch in bounded_clutches(assembly, speed):
        e = clutch.compliance
        least = LEAST * min(slider.reach for slider in rubbing if slider.compliance == e)
        if abs(second[e]) > least and abs(second[e] - first[e]) <= STEADY * abs(second[e]):
            load = f"its load of {clutch.load:.6g} N·m and the excitation together" if clutch.load else "the excitation"
            words = (
                f"{clutch.name} slips on by {abs(second[e]):.4g} rad in every period: the {clutch.holds:.6g} N·m that "
                f"it holds do not carry {load}; raise its friction torque, lower the load, or give it a stiffness"
            )
            return Outcome(False, "slips on", words)
    return None

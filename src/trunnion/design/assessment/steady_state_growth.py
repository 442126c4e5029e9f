"""Whether the motion that a driven line really makes bears out a verdict about its static twist.

Stability of a driven line is searched about its static twist. Joints and loads make it swing besides, and a disturbance
of that motion grows faster or more slowly. At the speeds at which the verdict is closest, growth about the periodic
motion itself is computed too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Places
from trunnion.design.assessment.assessment_input import LoadCaseResponse
from trunnion.equations.steady_base import has_joint_angles
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.ranges.unstable import UnstableRanges
from trunnion.floquet.stability.stability_over_speed import stability_along, straight_decay
from trunnion.results.verdict import Verdict
from trunnion.waiting import OutOfTime

MOST = 6
"""Speeds of fastest growth that are looked at, beside the ends of what is unstable."""
SWING = 2e-3
"""Rotation [rad] at the joints by linear theory below which the motion is not worth finding."""
CLOSE = 0.3
"""Share of the straight line's damping that a top has to leave at most to be looked at."""
NOTICED = 0.01
"""Share of the straight line's damping from which on another growth is said."""


@dataclass(frozen=True)
class SteadyStateGrowth:
    """At a ``speed`` [rad/s] the growth [1/s] about the line's own motion, and about its static twist; whether it is
    unstable there though stable about the static twist."""

    speed: float
    growth: float
    static: float
    unstable: bool


def steady_state_growth(case: LoadCaseResponse, found: UnstableRanges) -> SteadyStateGrowth | None:
    """Where the line's own motion changes what was ``found`` most; None where it does not noticeably, or is not
    known."""
    assembly, along = case.assembly, found.along
    if assembly.topology.free or case.span.put or not has_joint_angles(assembly):
        return None
    if not isinstance(case.answer, str) and np.nanmax(case.answer.joint_rotation, initial=0.0) < SWING:
        return None
    places = _closest(case, found)
    if not len(places):
        return None
    try:
        own = stability_along(assembly, along.speed[places], about_steady_state=True)
    except (InputError, ComputationError):
        return None
    except OutOfTime as error:
        case.end(error)
        return None
    growth, static = own.growth_rate, along.growth_rate[places]
    change = np.where(np.isfinite(growth), np.abs(growth - static), 0.0)
    worse = (own.verdict == Verdict.UNSTABLE) & (along.verdict[places] == Verdict.STABLE)
    k = int(np.argmax(np.where(worse, growth, -np.inf) if worse.any() else change))
    speed = float(along.speed[places[k]])
    if not worse.any() and change[k] <= NOTICED * straight_decay(assembly, speed):
        return None
    return SteadyStateGrowth(speed, float(growth[k]), float(static[k]), bool(worse.any()))


def _closest(case: LoadCaseResponse, found: UnstableRanges) -> Places:
    """Places of the highest tops of growth that leave little damping, and of the ends of ranges, where it is about
    0."""
    along = found.along
    growth = np.where(np.isfinite(along.growth_rate), along.growth_rate, -np.inf)
    beside = np.concatenate([[-np.inf], growth, [-np.inf]])
    tops = np.flatnonzero(np.isfinite(growth) & (growth >= beside[:-2]) & (growth >= beside[2:]))
    tops = tops[np.argsort(-growth[tops], kind="stable")][:MOST]
    decay = np.array([straight_decay(case.assembly, float(speed)) for speed in along.speed[tops]])
    tops = tops[growth[tops] > -CLOSE * decay]
    ends = np.searchsorted(along.speed, [end for one in found.ranges[:MOST] for end in one])
    return np.unique(np.concatenate([tops, np.minimum(ends, len(along.speed) - 1)]).astype(np.intp))

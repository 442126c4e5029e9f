"""Stability of driven lines about the periodic motion that joints and loads make them swing in.

The motions are followed over the range; where they fold back, several have one speed, and nothing is judged. Unstable
ranges about them are searched as about the static twist (``floquet.ranges.unstable``), joints fed by the swing besides.
Of ``LONG`` lines, of which every motion takes seconds, only the speeds are looked at at which the verdict about the
static twist is closest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from trunnion.arrays import Array, Places
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.ranges.resonances import resonances
from trunnion.floquet.ranges.span import Gap, Span
from trunnion.floquet.ranges.unstable import Judge, UnstableRanges, unstable_ranges
from trunnion.floquet.stability.stability_over_speed import stability_along, straight_decay
from trunnion.results.counts import counted
from trunnion.results.verdict import Verdict
from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed, breaks

SWINGS = 2e-3
"""Rotation [rad] at the joints, by linear theory, from which on a driven line is judged about the motion that it makes:
a choice, as below it growth about the static twist hardly differs."""
LONG = 40
"""Unknowns from which on a search about the motions would take half an hour and more."""
MOST, CLOSE = 6, 0.3
"""Of long lines: tops of growth that are looked at, beside the ends of what is unstable, and the share of the straight
line's damping that they leave at most."""
ASIDE = 0.02
"""Share of the speed beyond the range up to which motions are followed, as a fold may lie across its ends."""


def ranges_about_motions(
    span: Span, swing: float, points: int, given: Array, static: Callable[[], UnstableRanges]
) -> UnstableRanges:
    """Of a driven line whose joints swing by ``swing`` [rad], at ``given`` speeds or over the range from so many
    ``points`` on; ``static``: what there is about the static twist, where the motions cannot be followed."""
    if span.put:
        return replace(static(), not_followed="its numbers follow the speed")
    motions = SteadyStatesBySpeed(span.assembly.line, compiled=False)
    judge = partial(stability_along, span.assembly, about_steady_state=True, motions=motions)
    try:
        if motions.obstacle:
            return replace(static(), not_followed="it has stages or play, with which each speed takes its own motion")
        if len(given):
            return UnstableRanges(judge(np.unique(given)), (), 0.0, (), about_steady_state=True)
        if span.assembly.topology.size >= LONG:
            return _where_closest(span, static(), judge)
        found = unstable_ranges(replace(span, lost=_folds(span, motions, points)), judge, points=points, swing=swing)
    except (InputError, ComputationError) as error:
        return replace(static(), not_followed=str(error).splitlines()[0])
    return replace(found, about_steady_state=True)


def lost_motions(span: Span, motions: SteadyStatesBySpeed, points: int, aside: float = 0.0) -> tuple[Gap, ...]:
    """Speeds of the range at which a line's periodic steady state breaks off, looked for from so many ``points`` on and
    a share ``aside`` beyond the ends."""
    met, low, high = resonances(span), span.start, span.high
    about = (met.speed[:, None] + met.width[:, None] * np.array([-1.0, 0.0, 1.0])).ravel()
    speeds = np.union1d(np.linspace(low, high, points), about[(about >= low) & (about <= high)])
    motions.broken = breaks(motions, np.union1d(speeds, [(1 - aside) * low, (1 + aside) * high]))
    inside = [one for one in motions.broken if one.low <= high and one.high >= low]
    return tuple(Gap(max(one.low, low), min(one.high, high), one.why) for one in inside)


def _folds(span: Span, motions: SteadyStatesBySpeed, points: int) -> tuple[Gap, ...]:
    try:
        return lost_motions(span, motions, points, ASIDE)
    except InputError:  # a curve of torque may end with the range
        return lost_motions(span, motions, points)


def _where_closest(span: Span, found: UnstableRanges, judge: Judge) -> UnstableRanges:
    """What was ``found`` about the static twist, with growth about the motions at some speeds; one that is unstable
    there alone is a range by itself."""
    along, places = found.along, _closest(span, found)
    if not len(places):
        return replace(
            found,
            not_followed=f"it has {LONG} unknowns or more, and nowhere is the verdict close",
        )
    own = judge(along.speed[places])
    known = np.isfinite(own.growth_rate)
    worse = along.speed[places][(own.verdict == Verdict.UNSTABLE) & (along.verdict[places] == Verdict.STABLE)]
    ranges = sorted([*found.ranges, *((float(one), float(one)) for one in worse)])
    kept = np.ones(len(along.speed), dtype=bool)
    kept[places[known]] = False
    return replace(
        found, along=along.of(kept).beside(own.of(known)), ranges=tuple(ranges),
        not_followed=f"it has {LONG} unknowns or more, so that its motion was looked at where the verdict is closest "
        f"alone, at {counted(int(known.sum()), 'speed')}",
    )  # fmt: skip


def _closest(span: Span, found: UnstableRanges) -> Places:
    """Places of the highest tops of growth that leave little damping, and of the ends of ranges, where it is about
    0."""
    along = found.along
    growth = np.where(np.isfinite(along.growth_rate), along.growth_rate, -np.inf)
    beside = np.concatenate([[-np.inf], growth, [-np.inf]])
    tops = np.flatnonzero(np.isfinite(growth) & (growth >= beside[:-2]) & (growth >= beside[2:]))
    tops = tops[np.argsort(-growth[tops], kind="stable")][:MOST]
    decay = np.array([straight_decay(span.assembly, float(speed)) for speed in along.speed[tops]])
    tops = tops[growth[tops] > -CLOSE * decay]
    ends = np.searchsorted(along.speed, [end for one in found.ranges[:MOST] for end in one])
    return np.unique(np.concatenate([tops, np.minimum(ends, len(along.speed) - 1)]).astype(np.intp))

"""Unstable speeds of a line that nothing varies: only what feeds energy in makes it grow."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.equations.curve_speeds import curve_speeds
from trunnion.floquet.ranges.span import Span
from trunnion.floquet.ranges.unstable import UnstableRanges, closed_in
from trunnion.floquet.stability.lagging import lagging_growth, lags_count
from trunnion.floquet.stability.stability_over_speed import StabilityOverSpeed, straight_decay
from trunnion.floquet.stability.stable_speeds import verdicts_at
from trunnion.results.verdict import Verdict

POINTS = 65
TURN = 2 * np.pi
"""Stands for a period, which a straight line has not."""


def straight_ranges(span: Span) -> UnstableRanges:
    """Negative damping, or a torque that grows with the speed, over a range."""
    curves = curve_speeds(span.assembly, span.start, span.high)
    speeds = np.unique(np.concatenate([[span.start], np.linspace(span.start, span.high, POINTS), curves]))

    def judge(at: Array) -> StabilityOverSpeed:
        verdict = verdicts_at(span.assembly, at, table=span.table(at))
        growth = _growth(span, at)
        with np.errstate(under="ignore", over="ignore"):
            radius = np.exp(growth * TURN / at)
        return StabilityOverSpeed(at, radius, np.zeros(len(at)), radius.astype(complex), verdict, growth, TURN)

    verdict = verdicts_at(span.assembly, speeds, table=span.table(speeds))
    if not np.any(verdict == Verdict.UNSTABLE):
        return UnstableRanges(judge(np.unique(speeds[[0, -1]])), (), 0.0, ())
    return UnstableRanges(*closed_in(judge(speeds), judge), 0.0, ())


def _growth(span: Span, at: Array) -> Array:
    """Of the fastest disturbance [1/s] at every speed, torques that lag among what damps it."""
    co = span.assembly.coefficients(span.table(at), any_frequency=True)
    if lags_count(span.assembly, co):
        return lagging_growth(span.assembly, co)
    return np.array([-straight_decay(span.assembly, speed, row) for speed, row in zip(at, span.table(at), strict=True)])

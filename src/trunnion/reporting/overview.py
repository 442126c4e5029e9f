"""Everything a first look at a driveline asks for, as one object: what ``trunnion analyze`` prints.

The object holds results, not text or pictures, so that the command line and a report read the same numbers. It comes in
three steps, each of which can be shown by itself: the answer, what else belongs to the operating speed, the chart.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from trunnion.design.assessment.assessment_input import lossy
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.equations.coefficients import assemble
from trunnion.errors import InputError
from trunnion.floquet.charts.axes import lowest_speed
from trunnion.floquet.charts.stability_chart import chart_of_report
from trunnion.floquet.stability.stability import Stability, stability
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.reporting.overview_assessment import OverviewAssessment, answer, asked, judged
from trunnion.reporting.overview_findings import chart_findings
from trunnion.reporting.ranges import angle_range
from trunnion.response.kinetostatics import Kinetostatics, kinetostatics
from trunnion.results.chart import StabilityChart
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words
from trunnion.waiting import OutOfTime

ALL_ANGLES = "HookeJoint *.angle"
FINE, COARSE = (200, 150), (56, 32)
"""Speeds × angles of a chart with borders of stability in it, and of one that shows the decay alone."""
TOLERANCE = 1e-7
"""Of the chart: far below what a picture shows; pixels too near a border to be decided so are judged more sharply."""


@dataclass(frozen=True)
class Overview(OverviewAssessment):
    """A driveline at a glance: the answer, and further findings.

    angle_range [rad]: of the description, or guessed from the line; turn:
    the joints over a turn at the operating speed (1 rad/s without one), None where the output is prescribed; stability:
    at the operating speed, None without one and where all frequencies are damped alike; chart: over the range and one
    angle of all joints, None for a line without Hooke's joints, for one that is free–free or damps all frequencies
    alike, and until it is computed.
    """

    angle_range: tuple[float, float]
    turn: Kinetostatics | None
    stability: Stability | None
    chart: StabilityChart | None

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the chart's axes were clipped to, and why."""
        return self.chart.remarks if self.chart else ()

    @property
    def chartable(self) -> bool:
        """Whether a chart belongs to this line."""
        slow = self.speed_range[1] <= lowest_speed(self.assembly)
        return (
            not self.assembly.topology.graph
            and bool(hooke_joints(self.line))
            and not (slow or self.assembly.topology.free or lossy(self.assembly))
        )


def overview(
    line: Driveline,
    *,
    speed: float | str | None = None,
    unit: str | None = None,
    points: tuple[int, int] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Overview:
    """Verdict, frequencies, resonance speeds, stability, chart and findings of ``line`` over the range it runs in.

    Parameters
    ----------
    line : the driveline.
    speed : operating speed [rad/s]; default the one of the description.
    unit : speed unit of the findings' sentences; default as ``speed_unit``.
    points : speeds × angles of the chart; default as many as its picture needs.
    progress : called as progress(share done) while the chart is computed.

    Raises
    ------
    InputError : the line has no equations of motion, or no steady motion to judge.
    """
    return charted(at_speed(answer(judged(asked(line, speed=speed, unit=unit)))), points, progress)


def at_speed(given: OverviewAssessment) -> Overview:
    """An answer with what belongs to the operating speed, without the chart."""
    judged = given.speed is not None and not lossy(given.assembly)  # which the findings say
    here: Stability | None = None
    said: tuple[Finding, ...] = ()
    try:
        if judged and given.speed is not None:
            here = stability(given.assembly, given.speed)
            said = here.findings_in(given.unit)
    except OutOfTime as error:
        said = (Finding(Gravity.CAUTION, f"Stability at the operating speed was not computed: {error.why}."),)
    except InputError as error:  # as the check of the range says
        said = (Finding(Gravity.CAUTION, f"Stability at the operating speed is not judged: {error}."),)
    known = {finding.sentence for finding in given.findings}
    new = [finding for finding in said if finding.sentence not in known]
    whole = {**vars(given), "findings": by_gravity([*new, *given.findings])}
    return Overview(
        **whole,
        angle_range=angle_range(given.line),
        turn=_turn(given.line, given.speed),
        stability=here,
        chart=None,
    )


def charted(
    seen: Overview, points: tuple[int, int] | None = None, progress: Callable[[float], None] | None = None
) -> Overview:
    """An overview with its chart, if it is to have one and the time allows."""
    if not seen.chartable:
        return seen
    low, high = seen.speed_range
    try:
        across, up = points or (FINE if _has_borders(seen) else COARSE)
        axes = ("speed", low, high, across), (ALL_ANGLES, *seen.angle_range, up)
        chart = chart_of_report(seen.assembly, *axes, TOLERANCE, progress)
    except OutOfTime as error:
        left = Finding(Gravity.NOTE, f"The stability chart was not computed: {error.why}; ask stability-chart for it.")
        return replace(seen, findings=by_gravity([*seen.findings, left]))
    return replace(seen, chart=chart, findings=by_gravity([*seen.findings, *chart_findings(chart, Words(seen.unit))]))


def _has_borders(seen: Overview) -> bool:
    """Whether anything but decay shows at the steepest angle, where instabilities are widest, or at the line's own."""
    along = seen.along
    if along is None or np.any(along.verdict != Verdict.STABLE):
        return True
    line = seen.line
    for name, _ in hooke_joints(line):
        line = line.replace(name, angle=seen.angle_range[1])
    return bool(np.any(stability_along(assemble(line), along.speed).verdict != Verdict.STABLE))


def _turn(line: Driveline, speed: float | None) -> Kinetostatics | None:
    try:
        return kinetostatics(line, speed)
    except InputError:  # a line clamped at both ends
        return None

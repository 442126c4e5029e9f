"""Everything a first look at a driveline asks for, as one object: what ``trunnion analyze`` prints.

The object holds results, not text or pictures, so that the command line and a report read the same numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trunnion.analyses.charts.axes import lowest_speed
from trunnion.analyses.charts.stability_chart import stability_chart
from trunnion.analyses.kinetostatics import Kinetostatics, kinetostatics
from trunnion.analyses.linear.natural_frequencies import NaturalFrequencies, natural_frequencies
from trunnion.analyses.linear.resonance_speeds import ResonanceSpeeds, resonance_speeds
from trunnion.analyses.linear.stability import Stability, stability
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.operating_speed import operating_speed, speed_unit
from trunnion.driveline.operation import Operation
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.reporting.overview_findings import (
    assessment_findings,
    chart_findings,
    free_findings,
    line_findings,
    remark_findings,
    resonance_findings,
    response_findings,
    slow_findings,
    sweep_findings,
)
from trunnion.results.chart import StabilityChart
from trunnion.results.finding import Finding, by_gravity

ALL_ANGLES = "HookeJoint *.angle"
CHART_POINTS = (200, 150)
SWEEP_POINTS = 601
MODES_IN_RANGE = 4
"""Modes that a speed range guessed from the line itself reaches up to."""


@dataclass(frozen=True)
class Overview:
    """A driveline at a glance.

    unit: speed unit to print in; operation: the description's, at the speed asked for; speed_range [rad/s]
    and angle_range [rad]: of the description, or guessed from the line where it states none;
    resonance_speeds: those in the range; turn: the joints over a turn at the operating speed (1 rad/s without
    one), None where the output is prescribed; stability: at the operating speed, None without one; sweep: a
    chart of one row over the range at the joints' own angles; chart: over the range and one angle common to
    all joints. Both are None for a line without Hooke's joints, and for one that starts free.
    """

    line: Driveline
    unit: str
    operation: Operation
    speed_range: tuple[float, float]
    angle_range: tuple[float, float]
    natural_frequencies: NaturalFrequencies
    resonance_speeds: ResonanceSpeeds
    turn: Kinetostatics | None
    stability: Stability | None
    sweep: StabilityChart | None
    chart: StabilityChart | None
    findings: tuple[Finding, ...]

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the chart's axes were clipped to, and why."""
        return self.chart.remarks if self.chart else ()


def overview(
    line: Driveline,
    *,
    speed: float | None = None,
    unit: str | None = None,
    points: tuple[int, int] = CHART_POINTS,
    progress: Callable[[float], None] | None = None,
) -> Overview:
    """Frequencies, resonance speeds, stability and findings of ``line`` over the range it runs in.

    Parameters
    ----------
    line : the driveline.
    speed : operating speed [rad/s]; default the one of the description.
    unit : speed unit of the findings' sentences; default as ``speed_unit``.
    points : speeds × angles of the chart.
    progress : called as progress(share done) while the chart is computed.

    Raises
    ------
    InputError : the line has no equations of motion, or no steady motion to judge.
    """
    unit = unit or speed_unit(line)
    assembly = assemble(line)
    modes = natural_frequencies(assembly)
    low, high = speed_range(assembly)
    if speed is not None or (line.operation and line.operation.speed):
        speed = operating_speed(line, speed)
    every = resonance_speeds(assembly)
    here = every.within(low, high)
    at_speed = None if speed is None else stability(assembly, speed)
    sweep = chart = None
    joints = hooke_joints(line)
    slowest = lowest_speed(assembly)
    drawn = bool(joints) and high > slowest and not assembly.topology.free
    if drawn:
        name, angle = joints[0]
        sweep = stability_chart(assembly, ("speed", low, high, SWEEP_POINTS), (f"{name}.angle", angle, angle, 1))
        across, up = ("speed", low, high, points[0]), (ALL_ANGLES, *angle_range(line), points[1])
        chart = stability_chart(assembly, across, up, progress=progress)
    findings = [
        *(at_speed.findings_in(unit) if at_speed else ()),
        *assessment_findings(line, (low, high), unit),
        *line_findings(line, speed),
        *(sweep_findings(assembly, sweep, unit) if sweep else ()),
        *resonance_findings(here, (low, high), speed, unit),
        *response_findings(assembly, every, (low, high), unit),
        *(chart_findings(chart, unit) if chart else ()),
        *(slow_findings(high, slowest, unit) if joints and high <= slowest else ()),
        *(free_findings(assembly, (low, high), unit) if joints and assembly.topology.free else ()),
        *remark_findings(line),
    ]
    return Overview(
        line=line,
        unit=unit,
        operation=(line.operation or Operation()).model_copy(update={"speed": speed}),
        speed_range=(low, high),
        angle_range=angle_range(line),
        natural_frequencies=modes,
        resonance_speeds=here,
        turn=_turn(line, speed),
        stability=at_speed,
        sweep=sweep,
        chart=chart,
        findings=by_gravity(dict.fromkeys(findings)),
    )


def _turn(line: Driveline, speed: float | None) -> Kinetostatics | None:
    try:
        return kinetostatics(line, speed or 1.0)
    except InputError:  # a line clamped at both ends
        return None


def speed_range(assembly: Assembly) -> tuple[float, float]:
    """The range of the description [rad/s]; else about the operating speed; else about the lowest modes."""
    operation = assembly.line.operation or Operation()
    if operation.speed_range:
        return operation.speed_range
    if operation.speed:
        return 0.25 * operation.speed, 2.0 * operation.speed
    elastic = natural_frequencies(assembly).elastic
    if not len(elastic):
        return 1.0, 100.0
    low, high = 0.3 * float(elastic[0]), 1.25 * float(elastic[:MODES_IN_RANGE].max())
    return float(f"{low:.2g}"), float(f"{high:.2g}")


def angle_range(line: Driveline) -> tuple[float, float]:
    """The range of the description [rad]; else from straight to 30° or half again the largest joint angle."""
    if line.operation and line.operation.angle_range:
        return line.operation.angle_range
    largest = max((abs(angle) for _, angle in hooke_joints(line)), default=0.0)
    return 0.0, float(np.deg2rad(min(85.0, max(30.0, 1.5 * np.rad2deg(largest)))))

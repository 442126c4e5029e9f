"""Everything the report shows, computed once: results only, no text and no pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from trunnion.design.fatigue.result import FatigueLife
from trunnion.design.limits.result import LimitKind, StableLimit
from trunnion.design.limits.stable_limit import limit_of_chart
from trunnion.design.remedies.remedies import remedies_of
from trunnion.design.remedies.result import Remedies
from trunnion.driveline.driveline import hooke_joints
from trunnion.equations.coefficients import Assembly
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.charts.axes import lowest_speed
from trunnion.modes.bending import BendingSpeed, bending_speeds
from trunnion.modes.resonance_speeds import ResonanceSpeeds, resonance_speeds
from trunnion.numerics.threads import beside
from trunnion.reporting.overview import Overview
from trunnion.reporting.overview_assessment import NEARLY
from trunnion.reporting.ranges import diagram_range
from trunnion.reporting.under_load import LoadedMotion, load_findings, loaded_motions
from trunnion.response.campbell_diagram import CampbellDiagram, campbell_diagram
from trunnion.response.kinetostatics import kinetostatics
from trunnion.response.kinetostatics.result import Kinetostatics
from trunnion.response.speed_sweep import SpeedSweep, response_over, sweep_of
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.words import Words
from trunnion.waiting import OutOfTime, time_kept

if TYPE_CHECKING:
    from trunnion.measured.overlay import MeasuredComparison
    from trunnion.measured.tracking.result import MeasuredOrders

Found = TypeVar("Found")
HELPED = inf, 0.4
"""Of a time limit around a report, what the search for remedies leaves to the chart, and the share that it takes."""
DRAWN = 241, 121
"""Speeds of the even grid on which torque is drawn; fewer where every speed takes a motion of its own. Resonances and
largest values have speeds of their own."""


@dataclass(frozen=True)
class Contents:
    """Results of a report; None where the line has no joints, or a question does not apply."""

    overview: Overview
    turn: Kinetostatics | None
    sweep: SpeedSweep | None
    limit: StableLimit | None
    bending: tuple[BendingSpeed, ...]
    loaded: tuple[LoadedMotion, ...]
    campbell: CampbellDiagram | None
    helped: Remedies | None
    life: FatigueLife | None
    measured: MeasuredComparison | None
    findings: tuple[Finding, ...]
    left_out: tuple[str, ...]


def gather(seen: Overview, measured: MeasuredOrders | None = None) -> Contents:
    """What an overview does not hold yet: what would help, modes and torques over speed, irregularity, bending; and
    ``measured`` orders over what the line predicts."""
    assembly, stated = seen.assembly, seen.subject.cases[0]
    low, high = _speeds(seen)
    left_out: list[str] = []

    def unless_refused(question: str, answer: Callable[[], Found]) -> Found | None:
        try:
            return answer()
        except (InputError, ComputationError) as error:
            left_out.append(f"{question}: {error}")
            return None
        except OutOfTime as error:
            left_out.append(f"{question}: not computed, {error.why}")
            return None

    turn = sweep = None
    speed = seen.stability.speed if seen.stability else None
    # A motion is integrated by kernels, without the interpreter's lock.
    with beside(lambda: loaded_motions(seen.line, speed)) as found_beside:
        if hooke_joints(seen.line):
            turn = seen.turn or unless_refused("Irregularity", lambda: kinetostatics(seen.line))
            sweep = unless_refused(
                "Torque over speed",
                lambda: sweep_of(
                    response_over(
                        assembly,
                        low,
                        high,
                        points=DRAWN[stated.costly],
                        known=stated.response,
                        around=stated.__dict__.get("around"),  # where the search took a rough look
                        motions=stated.motions,
                    )
                ),
            )
        campbell = unless_refused(
            "Campbell diagram", lambda: campbell_diagram(assembly, np.linspace(*diagram_range(low, high), 201))
        )
        bending = bending_speeds(assembly)
        loaded, without = found_beside()
    helped = _helped(seen)
    if helped is not None and helped.ended:
        left_out.append(f"Remedies: {helped.ended} before all was tried; assess --remedies looks further")
    more = [
        *(_torque_findings(sweep, seen) if sweep else []),
        *load_findings(loaded, seen.unit),
        *(Finding(Gravity.CAUTION, f"{sentence.rstrip('.')}.") for sentence in without),
    ]
    whole = Contents(
        overview=seen,
        turn=turn,
        sweep=sweep,
        limit=None,
        bending=bending,
        loaded=loaded,
        campbell=campbell,
        helped=helped,
        life=_life(seen, left_out),
        measured=None if measured is None else unless_refused("Measured orders", lambda: _compared(assembly, measured)),
        findings=by_gravity([*seen.findings, *more]),
        left_out=tuple(left_out),
    )
    return with_chart(whole, seen)


def _compared(assembly: Assembly, measured: MeasuredOrders) -> MeasuredComparison:
    from trunnion.measured.overlay import compare_measured  # which loads what reads and tracks signals

    return compare_measured(assembly, measured)


def with_chart(contents: Contents, seen: Overview) -> Contents:
    """The same with the chart of ``seen`` and the limit angle that follows from it."""
    before = {finding.sentence for finding in contents.findings}
    limit, left_out = None, contents.left_out
    try:
        limit = _limit(seen, resonance_speeds(seen.assembly))
    except OutOfTime as error:  # the chart stands without it
        left_out = (*left_out, f"Largest joint angle at every resonance speed: not computed, {error.why}")
    more = [*seen.findings, *(_limit_findings(limit, seen) if limit else [])]
    new = [finding for finding in more if finding.sentence not in before]
    findings = by_gravity([*contents.findings, *new])
    return replace(contents, overview=seen, limit=limit, findings=findings, left_out=left_out)


def _life(seen: Overview, left_out: list[str]) -> FatigueLife | None:
    """What the check of fatigue rests on, where an element has an S–N curve."""
    if not seen.line.sn_curves_by_element:
        return None
    found = seen.subject.fatigue
    if isinstance(found, str):
        left_out.append(f"Fatigue: {found}")
        return None
    return found


def _helped(seen: Overview) -> Remedies | None:
    """What would help, where a check is exceeded or nearly reached."""
    checks = seen.assessment.checks
    if not any(c.exceeded or (c.satisfied and c.spare < NEARLY) for c in checks):
        return None
    try:
        with time_kept(*HELPED):
            return remedies_of(seen.subject, checks)
    except (InputError, ComputationError):  # help beyond the answer, which stands without it
        return None


def _speeds(seen: Overview) -> tuple[float, float]:
    """The range, clipped as the chart's axis is."""
    low, high = seen.speed_range
    slowest = lowest_speed(seen.assembly)
    return max(low, slowest if slowest < high else high / 200), high


def _limit(seen: Overview, named: ResonanceSpeeds) -> StableLimit | None:
    """At the chart's speeds and at the resonance speeds themselves, where regions are narrowest."""
    chart = seen.chart
    if chart is None or len(chart.y) < 2:
        return None
    low, high = _speeds(seen)
    at = [r.speed for r in named if r.opens and low <= r.speed <= high]
    return limit_of_chart(chart, at, own=True)


def _limit_findings(limit: StableLimit, seen: Overview) -> Iterator[Finding]:
    """The chart's own finding says where instability begins; this one gives the angle to design by."""
    at = limit.critical_speed
    if at is None:
        return
    where = Words(seen.unit).rounded(at)
    if np.any(limit.kind == LimitKind.AT_ONCE):
        start = f"{np.rad2deg(limit.low):.3g}°"
        yield Finding(Gravity.DANGER, f"Even at {start} in all joints the line is unstable, at {where}.")
        return
    beyond = any(abs(getattr(e, "angle", 0.0)) > limit.smallest for e in seen.line.elements)
    yield Finding(
        Gravity.CAUTION if beyond else Gravity.NOTE,
        f"At the resonance speeds too, which may lie between the chart's points, the line is stable up to "
        f"{np.rad2deg(limit.smallest):.3g}° in all joints (searched to {np.rad2deg(limit.high):.3g}°); the limit is "
        f"set at {where}.",
    )


def _torque_findings(sweep: SpeedSweep, seen: Overview) -> Iterator[Finding]:
    if not np.any(sweep.linear):
        return
    trusted = np.where(sweep.linear[:, None], sweep.torque_amplitude, np.nan)
    i, j = np.unravel_index(int(np.nanargmax(trusted)), trusted.shape)
    at, most = Words(seen.unit).rounded(float(sweep.speed[i])), float(f"{trusted[i, j]:.3g}")
    yield Finding(
        Gravity.NOTE,
        f"Where linear theory holds, torques swing by up to ±{most:.10g} N m, in {sweep.shafts[j]} at {at}.",
    )
    beyond = ~sweep.linear
    if beyond.any():
        weight = np.gradient(sweep.speed)
        share = float(weight[beyond].sum() / weight.sum())
        yield Finding(
            Gravity.CAUTION,
            f"Over {100 * share:.2g} % of the speed range twists are so large that torques and verdicts there are "
            "an indication only.",
        )

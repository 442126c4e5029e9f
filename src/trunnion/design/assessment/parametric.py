"""Parametric stability along the range: no disturbance may grow.

    growth rate σ(Ω) = ln|largest multiplier| / period < 0     at every speed

The margin is the share that joints and meshes leave of the damping of the straight line, σ over the decay of its
slowest disturbance: 100 % where they take nothing, 0 on the border of stability. Every resonance that may open is
looked at, and the ends of unstable ranges are located (``floquet.ranges.unstable``). Lines with joint angles and with
play or stages that are free–free, where each speed takes its own periodic motion, are searched alike from fewer speeds;
resonances are then those of the stages that the static load puts them in. Driven lines are judged about their static
twist; where their joints swing, about the periodic motion that joints and loads make, searched alike: it may be
unstable where the static twist takes nothing. Where a certificate of a few boxes proves the whole range, about that
motion or the static twist, the check says so.

Nothing excites a straight line with even meshes parametrically; one that grows by itself, as by negative damping, is
exceeded all the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import PROVED, SEARCHED, Check, Rule, Status
from trunnion.design.assessment.compared import not_reached
from trunnion.driveline.machines import Generator, lagging
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.ranges.span import SmoothRange
from trunnion.floquet.ranges.unstable import UnstableRanges, unstable_ranges
from trunnion.floquet.stability.stability_over_speed import (
    SpeedBySpeedError,
    StabilityOverSpeed,
    stability_along,
    straight_decay,
)
from trunnion.results.counts import counted, listed
from trunnion.results.verdict import Verdict
from trunnion.waiting import OutOfTime, keep_time

RULE = Rule("growth rate of every disturbance < 0", "Floquet", "derived", "stability")
EACH, COARSE = 25, 1e-8
SPARSE = 9
"""Even speeds, the error asked of multipliers, and speeds at equal ratios, where each takes tenths of a second."""
ROUGHLY = 1e-5
"""How closely the ends of unstable ranges are located there, as a share of the speed."""
MOST_SAID = 4
NOTICED = 0.01
"""Share of the straight line's damping from which on another growth about the static twist is said."""
STILL = 1e-3
"""Share of the growth about a line's own motion below which that about its static twist is none."""
BOXES = 6
"""Boxes for a proof, each of some hundredths of a second."""
OWN_BOXES = 8
"""The same about the motion that a line makes, times its unknowns: each takes some tenths of a second."""
NAME = "parametric stability"
FED_AND_LOSSY = (
    "negative damping, or a torque that grows with the speed, feeds disturbances, and a loss factor at all frequencies "
    "has no equations in time that say whether they grow: state loss_factor_frequency"
)
NOT_EXCITED = "no joint has an angle and no mesh varies: nothing excites the line parametrically"


def parametric_stability(subject: AssessmentInput, case: LoadCaseResponse) -> Iterator[Check]:
    """One check: the speed at which the slowest disturbance dies out slowest."""
    try:
        found = _ranges_of(case)
    except (InputError, ComputationError) as error:
        if not case.parametric:
            yield Check(NAME, Status.NOT_APPLICABLE, RULE, NOT_EXCITED)
            return
        yield Check(NAME, Status.NOT_JUDGED, RULE, str(error).splitlines()[0], load_case=case.name)
        return
    except OutOfTime as error:
        case.end(error)
        yield not_reached(subject, case, NAME, RULE, error.why)
        return
    speeds, growth = found.along.speed, found.along.growth_rate
    if not case.parametric and not found.ranges:
        if np.any(found.along.verdict == Verdict.FAILED):
            yield Check(NAME, Status.NOT_JUDGED, RULE, FED_AND_LOSSY + case.suffix, load_case=case.name)
            return
        yield Check(NAME, Status.NOT_APPLICABLE, RULE, NOT_EXCITED)
        return
    known = np.isfinite(growth)
    if not np.any(known):
        yield Check(NAME, Status.NOT_JUDGED, RULE, "the computation failed at every speed" + case.suffix)
        return
    at = int(np.argmax(np.where(known, growth, -np.inf)))
    straight = straight_decay(case.assembly, float(speeds[at]), case.span.table(speeds[[at]])[0])
    worst = (float(growth[at]), float(speeds[at]), _looked_at(subject, found))
    here = f"at {subject.shown(speeds[at])}{case.suffix}"
    covered = _covered(case, found)
    gaps = "".join(f"; {subject.ranges([(gap.low, gap.high)])} not judged: {gap.why}" for gap in found.gaps)
    own = _of_motion(subject, case, found, worst[0], worst[1], straight)
    if found.ranges:
        fed = _constant_power(case) or "negative damping, or a torque that grows with the speed, feeds it"
        if not case.parametric:
            why = f"{here}: {_lag(case, straight) or fed}"
            margin = -np.inf
        else:
            why = here + (_resonance(case, float(speeds[at])) if subject.naming else "")
            if straight < 0:
                why += f": with joints straight and meshes even it grows too, {fed}"
            margin = min(-growth[at] / straight, -1e-12) if straight > 0 else -np.inf
        because = (
            f"a disturbance doubles every {np.log(2) / worst[0]:.3g} s {why}; unstable {_ranges(subject, found)}"
            f"{own}{gaps}"
        )
        yield _judged(case, Status.EXCEEDED, because, float(margin), worst, found.ranges, covered)
        return
    if np.any(found.undecided):
        verdicts = found.along.verdict[found.undecided]
        words = " and ".join(sorted({str(Verdict(int(v))) for v in verdicts}))
        remedy = "state the damping of the shafts, or damping_ratio = 0.01 of the line, say"
        because = f"{words} at some speeds: {remedy}{case.suffix}"
        yield Check(NAME, Status.NOT_JUDGED, RULE, because, inputs=worst[2], load_case=case.name)
        return
    share = min(-growth[at] / straight, 1.0) if straight > 0 else 1.0
    because = (
        f"every disturbance halves within {np.log(2) / -growth[at]:.3g} s, slowest {here}: {100 * share:.3g} % of "
        "the straight line's damping"
    )
    status = Status.NOT_JUDGED if found.gaps else Status.SATISFIED
    proof = ""
    if status is Status.SATISFIED and subject.naming:
        proved = _proved(case, found, alike=not own)
        proof = SEARCHED if proved is None else PROVED
        if proved is not None:
            because += f"; proved for every speed of the range{proved}"
    yield replace(_judged(case, status, because + own + gaps, float(share), worst, (), covered), proof=proof)


def _of_motion(
    subject: AssessmentInput,
    case: LoadCaseResponse,
    found: UnstableRanges,
    growth: float,
    speed: float,
    straight: float,
) -> str:
    """What is judged of a driven line whose joints swing, and what another growth about its static twist would be; a
    clause, or nothing."""
    if not subject.naming:
        return ""
    if found.not_followed:
        swing = f"{np.rad2deg(case.swing):.2g}° by linear theory"
        return f"; judged about its static twist, though its joints swing by up to {swing}: {found.not_followed}"
    if not found.about_steady_state:
        return ""
    static = float(stability_along(case.assembly, [speed]).growth_rate[0])
    if not abs(growth - static) > NOTICED * straight:
        return ""

    def rate(of: float) -> str:
        return f"{'grows' if of > 0 else 'decays'} by {abs(of):.3g} 1/s"

    beside = "stays as it is" if abs(static) < STILL * abs(growth) else rate(static)
    return (
        f"; about the motion that its joints and loads make it swing in a disturbance {rate(growth)} at "
        f"{subject.shown(speed)}, where it {beside} about the static twist"
    )


def _lag(case: LoadCaseResponse, at_once: float) -> str:
    """Whose torque would damp what grows if it followed the speed ``at_once``, with a decay [1/s] above 0."""
    names = lagging(case.assembly.line.parts)
    if not names or not at_once > 0:
        return ""
    remedy = "raise corner_frequency, or add damping"
    return f"the torque of {listed(names)} lags too far behind the speed to damp it: {remedy}"


def _constant_power(case: LoadCaseResponse) -> str:
    """Of the generators that take the same power at any speed, why that feeds a disturbance and what else to state."""
    parts = case.assembly.line.parts
    names = [name for name, one in parts if isinstance(one, Generator) and one.power is not None]
    if not names:
        return ""
    return (
        f"at constant power {listed(names)} resists with less torque the faster it turns, and no governor is in the "
        "model that keeps the speed: state its curve, of torque over speed, in place of power"
    )


def _proved(case: LoadCaseResponse, found: UnstableRanges, *, alike: bool) -> str | None:
    """What a few boxes prove what the search has found about, as they mostly do of damped lines: a clause, empty where
    nothing needs to be said; None where they do not. ``alike`` : whether growth about the static twist is the same."""
    if case.span.put or not 0 < case.low < case.high:
        return None
    from trunnion.floquet.certificate.certify import proved_over

    ends = case.low, case.high
    if found.about_steady_state:
        boxes = OWN_BOXES // case.assembly.topology.size
        if boxes and proved_over(case.assembly, ends, boxes, about_steady_state=True):
            return " about the motion that the line makes"
    if not alike or not proved_over(case.assembly, ends, BOXES):
        return None
    return " about the static twist" if found.about_steady_state else ""


def _covered(case: LoadCaseResponse, found: UnstableRanges) -> tuple[tuple[float, float], ...]:
    """The range without what was not looked at."""
    left = [SmoothRange(case.low, case.high)]
    for gap in found.gaps:
        left = [part for piece in left for part in piece.without(gap.low, gap.high)]
    return tuple((piece.low, piece.high) for piece in left)


Worst = tuple[float, float, str]
"""Growth rate [1/s] and speed [rad/s] where it is largest, and how many speeds were looked at."""


def _judged(
    case: LoadCaseResponse,
    status: Status,
    because: str,
    margin: float,
    worst: Worst,
    barred: tuple[tuple[float, float], ...],
    covered: tuple[tuple[float, float], ...],
) -> Check:
    growth, speed, inputs = worst
    return Check(
        NAME, status, RULE, because, margin=margin, value=growth, limit=0.0, unit="1/s", speed=speed, inputs=inputs,
        load_case=case.name, barred=barred, covered=covered,
    )  # fmt: skip


def _looked_at(subject: AssessmentInput, found: UnstableRanges) -> str:
    speeds = found.along.speed
    said = f"searched from {subject.shown(speeds[0])} to {subject.shown(speeds[-1])} at {counted(len(speeds), 'speed')}"
    return f"{said}; stable by a bound up to {subject.shown(found.slow)}" if found.slow else said


def _ranges(subject: AssessmentInput, found: UnstableRanges) -> str:
    """ "at 300 rpm", "between 300 rpm and 400 rpm, between …"."""
    if all(subject.shown(a) == subject.shown(b) for a, b in found.ranges):
        return f"at {' and '.join(subject.shown(a) for a, _ in found.ranges)}"
    words = [f"between {subject.shown(a)} and {subject.shown(b)}" for a, b in found.ranges[:MOST_SAID]]
    more = f" and in {len(found.ranges) - MOST_SAID} more ranges" if len(found.ranges) > MOST_SAID else ""
    return ", ".join(words) + more


def _resonance(case: LoadCaseResponse, speed: float) -> str:
    # Loaded where needed: it brings the compiler with it.
    from trunnion.floquet.stability.stability import stability

    try:
        found = stability(case.assembly, speed).resonance
    except (InputError, ComputationError):
        return ""
    return f" ({found})" if found else ""


def _ranges_of(case: LoadCaseResponse) -> UnstableRanges:
    try:
        return case.unstable
    except SpeedBySpeedError:
        return _one_by_one(case)


def _one_by_one(case: LoadCaseResponse) -> UnstableRanges:
    """The same, each speed about its periodic steady state, found by shooting."""
    # Loaded where needed: it brings the compiler with it.
    from trunnion.floquet.stability.stability import stability

    def judge(speeds: Array) -> StabilityOverSpeed:
        radius, growth = np.full(len(speeds), np.nan), np.full(len(speeds), np.nan)
        verdict, period = np.full(len(speeds), int(Verdict.FAILED), dtype=np.int8), 1.0
        for i, speed in enumerate(speeds):
            keep_time()
            with suppress(ComputationError):
                found = stability(case.assembly, float(speed), tolerance=COARSE)
                radius[i], growth[i], verdict[i] = found.spectral_radius, found.growth_rate, int(found.verdict)
        return StabilityOverSpeed(
            speeds, radius, np.zeros(len(speeds)), radius.astype(complex), verdict, growth, period
        )

    return unstable_ranges(case.span, judge, points=EACH, apart=SPARSE, bound=False, closely=ROUGHLY)

"""What the results of an overview say in sentences, beyond what the stability at one speed says itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Codes
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.joints import LARGE_ANGLE, HookeJoint, Joint
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import unexcited
from trunnion.equations.steady_base import has_joint_angles
from trunnion.errors import ComputationError, InputError
from trunnion.floquet.stability.stability_over_speed import StabilityOverSpeed
from trunnion.modes.resonance_speeds import ResonanceSpeeds
from trunnion.response.speed_sweep import speed_sweep
from trunnion.results.finding import Finding, Gravity
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words
from trunnion.waiting import OutOfTime

if TYPE_CHECKING:
    from trunnion.results.chart import StabilityChart

NEAR = 0.05
"""Relative distance from a resonance speed that deserves a word."""
BEYOND = 0.2
"""Share of the range's ends up to which a resonance outside it still raises torques inside."""
RAISED = 2.0
"""Times the usual torque of the range from which a resonance is grave enough to be named."""


def slow_findings(high: float, slowest: float, words: Words) -> Iterator[Finding]:
    """Why no chart is drawn for a line that turns far below its natural frequencies."""
    yield Finding(
        Gravity.NOTE,
        f"The line runs at no more than {words.rounded(high)} and follows its joints statically there: below "
        f"{words.rounded(slowest)} a turn spans hundreds of cycles of its highest mode, resonances of such "
        "high order stay closed, and no chart is drawn.",
    )


def line_findings(line: Driveline, speed: float | None) -> Iterator[Finding]:
    """What the description itself lacks or strains."""
    if speed is None:
        yield Finding(
            Gravity.NOTE,
            "No operating speed is given, so stability was judged over a range only; "
            "write speed under [operation], or pass one.",
        )
    for name, element in zip(line.names, line.elements, strict=True):
        if isinstance(element, HookeJoint) and abs(element.angle) > LARGE_ANGLE:
            angle = np.rad2deg(abs(element.angle))
            yield Finding(
                Gravity.CAUTION, f"{name} is bent by {angle:.3g}°, more than most Hooke's joints allow (45°)."
            )
    if not any(isinstance(element, HookeJoint) for element in line.elements):
        nonuniform = [n for n, e in zip(line.names, line.elements, strict=True) if isinstance(e, Joint) and e.orders]
        why = (
            f"no chart is drawn; ask trunnion chart for one over the angle of {nonuniform[0]}"
            if nonuniform
            else "so no joint excites it parametrically; no chart is drawn"
        )
        yield Finding(Gravity.NOTE, f"The line has no Hooke's joint, {why}.")


def along_findings(assembly: Assembly, found: StabilityOverSpeed, words: Words) -> Iterator[Finding]:
    """Stability over the range at the design angles: each unstable band with the resonance it belongs to."""
    whole = f"from {words.span(found.speed[0], found.speed[-1])}"
    checked = f"{len(found.speed)} speeds, the named resonance speeds among them"
    bands = runs(found.verdict == Verdict.UNSTABLE)
    for first, last in bands:
        worst = first + int(np.argmax(found.growth_rate[first : last + 1]))
        # Loaded where needed: it brings the compiler with it.
        from trunnion.floquet.stability.stability import stability

        there = stability(assembly, float(found.speed[worst]))
        cause = f" ({there.resonance.in_words})" if there.resonance else ""
        edges = f"from {words.span(found.speed[first], found.speed[last])}"
        at = f"worst at {words.rounded(there.speed)}, where"
        if first == last:
            edges, at = f"at {words.rounded(there.speed)}", "there"
        yield Finding(
            Gravity.DANGER,
            f"At its own joint angles the line is unstable {edges}{cause}; {at} a disturbance doubles "
            f"every {np.log(2) / there.growth_rate:.3g} s.",
        )
    if not bands and np.all(found.verdict == Verdict.STABLE):
        worst = int(np.argmax(found.growth_rate))
        yield Finding(
            Gravity.NOTE,
            f"At its own joint angles the line is stable {whole} ({checked}; disturbances decay slowest at "
            f"{words.rounded(float(found.speed[worst]))}, by {-found.growth_rate[worst]:.3g} 1/s).",
        )
    elif not bands and np.all(found.verdict == Verdict.MARGINAL):
        yield Finding(Gravity.NOTE, f"The line has no damping; no disturbance grows {whole} ({checked}).")
    yield from _unsettled(found.verdict, "at its own joint angles")


def resonance_findings(
    here: ResonanceSpeeds, limits: tuple[float, float], speed: float | None, words: Words
) -> Iterator[Finding]:
    """At how many resonances in the range instability can begin, and how near the operating speed is to one."""
    able = [r for r in here if r.opens]
    if not able:
        return
    many = "s" if len(able) > 1 else ""
    count = f"Instability can begin at {len(able)} parametric resonance speed{many} (up to order {here.orders})"
    within = f"between {words.span(*limits, 'and')}"
    if speed is None:
        yield Finding(Gravity.NOTE, f"{count} {within}.")
        return
    nearest = min(able, key=lambda r: (abs(np.log(r.speed / speed)), r.order))
    distance = nearest.speed / speed - 1
    side = "above" if distance > 0 else "below"
    yield Finding(
        Gravity.CAUTION if abs(distance) < NEAR else Gravity.NOTE,
        f"{count} {within}; nearest to the operating speed is the {nearest.in_words} at "
        f"{words.rounded(nearest.speed)}, {100 * abs(distance):.2g} % {side} it.",
    )


def response_findings(
    assembly: Assembly, named: ResonanceSpeeds, limits: tuple[float, float], words: Words
) -> Iterator[Finding]:
    """The resonance of the joints' own forcing, 2|R|Ω = ω, that raises a torque most within the range.

    Those outside are looked at too, up to ``BEYOND`` from its ends: their flank is what the range sees.
    """
    low, high = limits
    forced = [r for r in named if r.kind == "harmonic" and r.order == 1]
    forced = [r for r in forced if (1 - BEYOND) * low <= r.speed <= (1 + BEYOND) * high]
    if not forced or not has_joint_angles(assembly) or low <= 0:
        return
    places = np.clip([r.speed for r in forced], low, high)
    usual = np.linspace(low, high, 2 * len(forced) + 9)
    try:
        joints_alone = unexcited(assembly.line)
        sweep = speed_sweep(joints_alone, np.concatenate([places, usual]))
    except (InputError, ComputationError, OutOfTime):  # without a linear response, which the checks say
        return
    torque = sweep.torque_amplitude[: len(places)]
    raised = torque / np.maximum(np.median(sweep.torque_amplitude[len(places) :], axis=0), 1e-300)
    grave = np.where(raised >= RAISED, torque, 0.0)
    which, shaft = np.unravel_index(int(np.argmax(grave)), grave.shape)
    if not grave[which, shaft] > 0:
        return
    r, at = forced[which], float(places[which])
    outside = max(r.speed / high, low / r.speed) - 1
    side = f", {100 * outside:.2g} % {'above' if r.speed > high else 'below'} the range" if outside > 0 else ""
    said = f"Joints force {r.formula} at {words.rounded(r.speed)}{side}"
    if not sweep.linear[which]:
        said = f"{said}. Resonance at {words.about(at)}; do not use this amplitude: it is beyond linear theory."
    else:
        operation = assembly.line.operation
        loads = "under the loads as described " if operation and operation.load_cases else ""
        part = "the torque" if joints_alone == assembly.line else "their part of the torque"
        said = (
            f"{said}: {loads}{part} of {sweep.shafts[shaft]} rises to ±{torque[which, shaft]:.4g} N m at "
            f"{words.rounded(at)}, {raised[which, shaft]:.2g} times its median over the range."
        )
    yield Finding(Gravity.CAUTION, said)


def free_findings(assembly: Assembly, along: StabilityOverSpeed | None, words: Words) -> Iterator[Finding]:
    """Why a free–free line with joint angles has no chart."""
    if has_joint_angles(assembly):
        how = "" if along else ", found speed by speed"
        yield Finding(
            Gravity.NOTE,
            f"The line is free–free: each speed is judged about its own periodic motion{how}, and no chart is drawn.",
        )


def remark_findings(line: Driveline) -> Iterator[Finding]:
    """What of the line does nothing, or holds in part only, by where it stands."""
    for _, sentence in line.own_remarks:
        yield Finding(Gravity.CAUTION, sentence)


def chart_findings(chart: StabilityChart, words: Words) -> Iterator[Finding]:
    """The smallest common joint angle at which anything in the range is unstable."""
    rows = np.flatnonzero(np.any(chart.verdict == Verdict.UNSTABLE, axis=1))
    top = np.rad2deg(chart.y[-1])
    if len(rows):
        row = int(rows[0])
        bad = chart.verdict[row] == Verdict.UNSTABLE
        column = int(np.argmax(np.where(bad, chart.spectral_radius[row], -np.inf)))
        yield Finding(
            Gravity.CAUTION,
            "With all joints at one angle, the first unstable point of the chart is at "
            f"{np.rad2deg(chart.y[row]):.3g}° and {words.rounded(float(chart.x[column]))}; "
            f"{100 * chart.unstable_share:.2g} % of the chart is unstable.",
        )
    else:
        yield Finding(
            Gravity.NOTE, f"With all joints at one angle, no point of the chart is unstable up to {top:.3g}°."
        )
    yield from _unsettled(chart.verdict, "in the chart")


def runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """First and last index of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(int)))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]


def _unsettled(verdict: Codes, where: str) -> Iterator[Finding]:
    failed, undecided = (int(np.count_nonzero(verdict == v)) for v in (Verdict.FAILED, Verdict.UNDECIDED))
    total = verdict.size
    if failed:
        yield Finding(
            Gravity.CAUTION,
            f"{failed} of {total} points {where} could not be computed; raise the lowest speed.",
        )
    if undecided:
        yield Finding(
            Gravity.NOTE,
            f"{undecided} of {total} points {where} stand on a stability boundary: the spectral radius is 1 "
            "to within its error.",
        )

"""Parametric stability along the range: no disturbance may grow.

    growth rate σ(Ω) = ln|largest multiplier| / period < 0     at every speed

The margin is the share that joints and meshes leave of the damping of the straight line, σ over the decay of its
slowest disturbance: 100 % where they take nothing, 0 on the border of stability. 201 speeds at least, closer about the
peaks of the response, and at every named resonance speed; 25 for bent lines with play or stages that start free, where
each takes its own periodic motion.

Nothing excites a straight line with even meshes parametrically; one that grows by itself, as by negative damping, is
exceeded all the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from trunnion.analyses.assessment.check import Check, Rule, Status
from trunnion.analyses.assessment.own_limits import bands, judged_at
from trunnion.analyses.assessment.subject import Case, Subject
from trunnion.analyses.linear.along import NoSharedMotion, straight_decay
from trunnion.analyses.orders.stable_speeds import verdicts_at
from trunnion.arrays import Array, Codes, Flags
from trunnion.errors import ComputationError, InputError
from trunnion.results.counts import counted
from trunnion.results.verdict import Verdict

RULE = Rule("growth rate of every disturbance < 0", "Floquet", "derived")
EACH, COARSE = 25, 1e-8
NAME = "parametric stability"


def parametric_stability(subject: Subject, case: Case) -> Iterator[Check]:
    """One check: the speed at which the slowest disturbance dies out slowest."""
    if not case.parametric:
        yield _straight(subject, case)
        return
    try:
        speeds, growth, verdict = _along(case)
    except (InputError, ComputationError) as error:
        yield Check(NAME, Status.NOT_JUDGED, RULE, str(error).splitlines()[0], load_case=case.name)
        return
    judgeable = np.isfinite(growth)
    if not np.any(judgeable):
        yield Check(NAME, Status.NOT_JUDGED, RULE, "the computation failed at every speed" + case.suffix)
        return
    at = int(np.nanargmax(growth))
    straight = straight_decay(case.assembly, float(speeds[at]))
    worst = (float(growth[at]), float(speeds[at]), judged_at(subject, speeds))
    here = f"at {subject.shown(speeds[at])}{case.suffix}"
    unstable = verdict == Verdict.UNSTABLE
    if np.any(unstable):
        resonance = _resonance(case, float(speeds[at])) if subject.naming else ""
        margin = min(-growth[at] / straight, -1e-12) if straight > 0 else -np.inf
        yield _growing(subject, case, speeds, unstable, f"{here}{resonance}", float(margin), worst)
    elif np.all(verdict[judgeable] == Verdict.STABLE) and np.all(judgeable):
        share = min(-growth[at] / straight, 1.0) if straight > 0 else 1.0
        because = (
            f"every disturbance halves within {np.log(2) / -growth[at]:.3g} s, slowest {here}: {100 * share:.3g} % of "
            "the straight line's damping"
        )
        yield _judged(case, Status.SATISFIED, because, float(share), worst)
    else:
        words = sorted({str(Verdict(int(v))) for v in verdict if v != Verdict.STABLE})
        remedy = "state the damping of the shafts, or damping_ratio = 0.01 of the line, say"
        because = f"{' and '.join(words)} at some speeds: {remedy}{case.suffix}"
        yield Check(NAME, Status.NOT_JUDGED, RULE, because, inputs=worst[2], load_case=case.name)


def _straight(subject: Subject, case: Case) -> Check:
    """Of a line that nothing varies: only what feeds energy in makes it grow."""
    unstable = verdicts_at(case.assembly, case.speeds) == Verdict.UNSTABLE
    if not np.any(unstable):
        because = "no joint is bent and no mesh varies: nothing excites the line parametrically"
        return Check(NAME, Status.NOT_APPLICABLE, RULE, because)
    growth = np.array([-straight_decay(case.assembly, float(speed)) for speed in case.speeds])
    at = int(np.argmax(growth >= growth.max() * (1 - 1e-9)))
    fed = (
        f"at {subject.shown(case.speeds[at])}{case.suffix}: negative damping, or a torque that grows with the speed, "
        "feeds it, no joint or mesh"
    )
    worst = (float(growth[at]), float(case.speeds[at]), counted(len(case.speeds), "speed"))
    return _growing(subject, case, case.speeds, unstable, fed, -np.inf, worst)


Worst = tuple[float, float, str]
"""Growth rate [1/s] and speed [rad/s] where it is largest, and how many speeds were looked at."""


def _growing(
    subject: Subject, case: Case, speeds: Array, unstable: Flags, where: str, margin: float, worst: Worst
) -> Check:
    ranges = bands(speeds, np.where(unstable, 1.0, -1.0), np.zeros(len(speeds)))
    because = f"a disturbance doubles every {np.log(2) / worst[0]:.3g} s {where}; unstable {_ranges(subject, ranges)}"
    return _judged(case, Status.EXCEEDED, because, margin, worst, ranges)


def _judged(
    case: Case, status: Status, because: str, margin: float, worst: Worst, barred: tuple[tuple[float, float], ...] = ()
) -> Check:
    growth, speed, inputs = worst
    return Check(
        NAME, status, RULE, because, margin, 0.0, growth, 0.0, "1/s", speed, inputs, case.name, barred,
    )  # fmt: skip


def _ranges(subject: Subject, ranges: Sequence[tuple[float, float]]) -> str:
    """ "at 300 rpm", "between 300 rpm and 400 rpm, between …"."""
    if all(a == b for a, b in ranges):
        return f"at {' and '.join(subject.shown(a) for a, _ in ranges)}"
    return ", ".join(f"between {subject.shown(a)} and {subject.shown(b)}" for a, b in ranges)


def _resonance(case: Case, speed: float) -> str:
    # Loaded where needed: it brings the compiler with it.
    from trunnion.analyses.linear.stability import stability

    try:
        found = stability(case.assembly, speed).resonance
    except (InputError, ComputationError):
        return ""
    return f" ({found})" if found else ""


def _along(case: Case) -> tuple[Array, Array, Codes]:
    """Speeds, growth rates [1/s] and verdicts."""
    try:
        found = case.along
    except NoSharedMotion:
        return _one_by_one(case)
    return found.speed, found.growth_rate, found.verdict


def _one_by_one(case: Case) -> tuple[Array, Array, Codes]:
    """The same at few speeds, each about its own motion, found by shooting."""
    # Loaded where needed: it brings the compiler with it.
    from trunnion.analyses.linear.stability import stability

    low, high = float(case.speeds[0]), float(case.speeds[-1])
    speeds = np.linspace(low, high, EACH) if high > low else case.speeds
    growth, verdict = np.full(len(speeds), np.nan), np.full(len(speeds), int(Verdict.FAILED), dtype=np.int8)
    for i, speed in enumerate(speeds):
        try:
            found = stability(case.assembly, float(speed), tolerance=COARSE)
        except ComputationError:
            continue
        growth[i], verdict[i] = found.growth_rate, int(found.verdict)
    return speeds, growth, verdict

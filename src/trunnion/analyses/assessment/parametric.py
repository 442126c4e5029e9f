"""Parametric stability along the range: no disturbance may grow.

    growth rate σ(Ω) = ln|largest multiplier| / period < 0     at every speed

The margin is the share that joints and meshes leave of the damping of the straight line, σ over the decay of its
slowest disturbance: 100 % where they take nothing, 0 on the border of stability. 201 speeds at least, closer about the
peaks of the response, and at every named resonance speed; 25 for bent lines with play or stages that start free, where
each takes its own periodic motion.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.assessment.check import Check, Rule, Status
from trunnion.analyses.assessment.own_limits import bands
from trunnion.analyses.assessment.subject import Case, Subject
from trunnion.analyses.linear.along import NoSharedMotion, straight_decay
from trunnion.errors import ComputationError, InputError
from trunnion.results.verdict import Verdict

RULE = Rule("growth rate of every disturbance < 0", "Floquet", "derived")
EACH, COARSE = 25, 1e-8
NAME = "parametric stability"
Array = NDArray[np.float64]


def parametric_stability(subject: Subject, case: Case) -> Iterator[Check]:
    """One check: the speed at which the slowest disturbance dies out slowest."""
    if not case.parametric:
        because = "no joint is bent and no mesh varies: nothing excites the line parametrically"
        yield Check(NAME, Status.NOT_APPLICABLE, RULE, because)
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
    inputs = f"{len(speeds)} speeds, {subject.shown(speeds[0])} to {subject.shown(speeds[-1])}"
    here = f"at {subject.shown(speeds[at])}{case.suffix}"
    unstable = verdict == Verdict.UNSTABLE
    if np.any(unstable):
        ranges = bands(speeds, np.where(unstable, 1.0, -1.0), np.zeros(len(speeds)))
        spread = " and ".join(f"{subject.shown(a)} to {subject.shown(b)}" for a, b in ranges)
        resonance = _resonance(case, float(speeds[at])) if subject.naming else ""
        because = (
            f"a disturbance doubles every {np.log(2) / growth[at]:.3g} s {here}{resonance}; unstable between {spread}"
        )
        margin = min(-growth[at] / straight, -1e-12) if straight > 0 else -np.inf
        yield Check(
            NAME, Status.EXCEEDED, RULE, because, float(margin), 0.0, float(growth[at]), 0.0, "1/s",
            float(speeds[at]), inputs, case.name, ranges,
        )  # fmt: skip
    elif np.all(verdict[judgeable] == Verdict.STABLE) and np.all(judgeable):
        share = min(-growth[at] / straight, 1.0) if straight > 0 else 1.0
        because = (
            f"every disturbance halves within {np.log(2) / -growth[at]:.3g} s, slowest {here}: {100 * share:.3g} % of "
            "the straight line's damping"
        )
        yield Check(
            NAME, Status.SATISFIED, RULE, because, float(share), 0.0, float(growth[at]), 0.0, "1/s",
            float(speeds[at]), inputs, case.name,
        )  # fmt: skip
    else:
        words = sorted({str(Verdict(int(v))) for v in verdict if v != Verdict.STABLE})
        remedy = "state the damping of the shafts, or damping_ratio = 0.01 of the line, say"
        because = f"{' and '.join(words)} at some speeds: {remedy}{case.suffix}"
        yield Check(NAME, Status.NOT_JUDGED, RULE, because, inputs=inputs, load_case=case.name)


def _resonance(case: Case, speed: float) -> str:
    # Loaded where needed: it brings the compiler with it.
    from trunnion.analyses.linear.stability import stability

    try:
        found = stability(case.assembly, speed).resonance
    except (InputError, ComputationError):
        return ""
    return f" ({found})" if found else ""


def _along(case: Case) -> tuple[Array, Array, NDArray[np.int8]]:
    """Speeds, growth rates [1/s] and verdicts."""
    try:
        found = case.along
    except NoSharedMotion:
        return _one_by_one(case)
    return found.speed, found.growth_rate, found.verdict


def _one_by_one(case: Case) -> tuple[Array, Array, NDArray[np.int8]]:
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

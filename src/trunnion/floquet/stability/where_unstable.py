"""What verdicts over speed say about a steady motion: the speeds at which it is not reached."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array, Codes
from trunnion.results.finding import Finding, Gravity
from trunnion.results.stretches import stretches_above
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words


def where_unstable(speeds: Array, verdict: Codes, words: Words, *, lossy: bool = False) -> Iterator[Finding]:
    """Findings on codes of ``Verdict`` (speed,) at ``speeds`` [rad/s]; lossy: with a loss factor at all frequencies."""
    if np.any(failed := verdict == Verdict.FAILED):
        where = "" if failed.all() else f" at {failed.sum()} of {len(failed)} speeds"
        why = (
            "a loss factor that holds at all frequencies has no equations in time; give a loss_factor_frequency and "
            "ask stability()."
            if lossy
            else "the multipliers could not be computed side by side; ask stability() at single speeds."
        )
        yield Finding(Gravity.NOTE, f"Whether the motion is stable was not judged{where}: {why}")
    order = np.argsort(speeds)
    speed, unstable = speeds[order], verdict[order] == Verdict.UNSTABLE
    if not unstable.any():
        return
    where = words.ranges(stretches_above(speed, unstable.astype(float), 0.5, between=False))
    yield Finding(
        Gravity.DANGER,
        f"The steady motion is unstable at {where}: a small disturbance grows, "
        "and the amplitudes given there are not reached; ask stability() why, or tn.periodic_branch where it goes.",
    )

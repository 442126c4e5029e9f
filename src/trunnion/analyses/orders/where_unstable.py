"""What verdicts over speed say about a steady motion: the speeds at which it is not reached."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from trunnion.arrays import Array, Codes
from trunnion.results.finding import Finding, Gravity
from trunnion.results.speeds import show_speed, speed_factor
from trunnion.results.verdict import Verdict

MOST_STRETCHES = 4


def where_unstable(speeds: Array, verdict: Codes, unit: str, *, lossy: bool = False) -> Iterator[Finding]:
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
    edges = np.flatnonzero(np.diff(np.concatenate([[False], unstable, [False]]).astype(int)))
    stretches = [
        show_speed(speed[a], unit)
        if b == a + 1
        else f"{speed[a] * speed_factor(unit):.6g} to {show_speed(speed[b - 1], unit)}"
        for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]
    more = f" and {len(stretches) - MOST_STRETCHES} more stretches" if len(stretches) > MOST_STRETCHES else ""
    yield Finding(
        Gravity.DANGER,
        f"The steady motion is unstable at {', '.join(stretches[:MOST_STRETCHES])}{more}: a small disturbance grows, "
        "and the amplitudes given there are not reached; ask stability() why, or tn.periodic_branch where it goes.",
    )

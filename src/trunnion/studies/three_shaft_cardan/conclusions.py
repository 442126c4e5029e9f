"""S3's conclusions, each against a computed figure; and what forks in line change."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict
from trunnion.studies.result import ADDED, Conclusion
from trunnion.studies.shares import Share, bands, change, judged, percents, share, steps

PRACTICAL = float(np.pi / 4)
"""Joint angles that S3 calls practical, up to 45° [rad]."""
NEAR = 0.05
"""How nearly equal two joint angles are to count as equal [rad]."""
EVERYWHERE = 0.95
"""Share of the angles up to 45° at which a speed must be unstable to count as unstable throughout."""


def conclusions(
    four: StabilityChart, five: StabilityChart, six: StabilityChart, inline: Mapping[str, StabilityChart]
) -> tuple[Conclusion, ...]:
    """From Figures 4, 5, 6, and the same with the forks in line."""
    return (
        _second(four),
        _first_at_small(four, six),
        _first_as_a_whole(four, six),
        _inertia(four, five),
        _speed(four),
        _forks(four, five, six, inline),
    )


def _second(four: StabilityChart) -> Conclusion:
    low = bands(four, (0.0, 0.25, 0.5, PRACTICAL, 1.501), along="y")
    return Conclusion(
        "A larger angle of the second joint enlarges the unstable regions in the practical range.",
        judged(steps(low)),
        f"Unstable share of Figure 4 for β₂ in 0–0.25, 0.25–0.5, 0.5–0.79 and 0.79–1.5 rad: {percents(low)}.",
    )


def _first_at_small(four: StabilityChart, six: StabilityChart) -> Conclusion:
    small = [share(c, y=(0.0, 0.2)) for c in (four, six)]
    through = [_throughout(c) for c in (four, six)]
    return Conclusion(
        "A larger angle of the first joint makes small angles of the second unstable, at some speeds nearly all of "
        "them.",
        judged([change(*small), 1 if through[1] > through[0] else -1]),
        f"β₁ = 0.2 and 0.4 rad: {percents(small)} unstable for β₂ below 0.2 rad; {through[0]:.2g} % and "
        f"{through[1]:.2g} % of the speeds are unstable at nearly every β₂ up to 45°.",
    )


def _first_as_a_whole(four: StabilityChart, six: StabilityChart) -> Conclusion:
    practical = [share(c, y=(0.0, PRACTICAL)) for c in (four, six)]
    everything = [share(c) for c in (four, six)]
    return Conclusion(
        "As a whole the unstable regions seem to shrink with a larger angle of the first joint.",
        judged([-change(*practical), -change(*everything)]),
        f"β₁ = 0.2 and 0.4 rad: {percents(practical)} unstable up to 45°, {percents(everything)} of the whole chart.",
    )


def _throughout(chart: StabilityChart) -> float:
    rows = chart.y < PRACTICAL
    return 100 * float(np.mean(np.mean(chart.verdict[rows] == Verdict.UNSTABLE, axis=0) >= EVERYWHERE))


def _inertia(four: StabilityChart, five: StabilityChart) -> Conclusion:
    """The claim is of the practical range; it is judged below and above Ω = 1, which go opposite ways."""
    below, above = (_both(four, five, x) for x in ((0.0, 1.0), (1.0, 2.001)))
    whole = _both(four, five, (0.0, 2.001))
    judgement = judged([-change(*below), -change(*above)])
    apart = " The whole hangs on where the box ends." if change(*below) != change(*above) else ""
    return Conclusion(
        "A larger inertia of the third disk (γ₂ from 10 to 100) shrinks the unstable regions in the practical range.",
        judgement,
        f"γ₂ = 10 and 100, up to 45°: {percents(below)} unstable below Ω = 1, {percents(above)} above, "
        f"{percents(whole)} together.{apart}",
    )


def _both(one: StabilityChart, other: StabilityChart, x: tuple[float, float]) -> tuple[Share, Share]:
    y = (0.0, PRACTICAL)
    return share(one, x=x, y=y), share(other, x=x, y=y)


def _speed(four: StabilityChart) -> Conclusion:
    quarter = bands(four, (0.04, 0.5, 1.0, 1.5, 2.001), along="x", y=(0.0, PRACTICAL))
    judgement = judged(steps(quarter))
    mixed = len(set(steps(quarter))) > 1
    return Conclusion(
        "A higher speed generally means more instability, though natural frequencies decide.",
        judgement,
        f"Figure 4 up to 45°, for Ω in 0–0.5, 0.5–1, 1–1.5 and 1.5–2: {percents(quarter)} unstable."
        + (" It follows where the first-order tongues stand, not the speed." if mixed else ""),
    )


def _forks(
    four: StabilityChart, five: StabilityChart, six: StabilityChart, inline: Mapping[str, StabilityChart]
) -> Conclusion:
    charts = {"4": four, "5": five, "6": six}
    angle = {"4": 0.2, "5": 0.2, "6": 0.4}
    near = {n: (b - NEAR, b + NEAR) for n, b in angle.items()}
    equal = [[share(c[n], y=near[n]) for n in charts] for c in (charts, inline)]
    whole = [[share(c[n], y=(0.0, PRACTICAL)) for n in charts] for c in (charts, inline)]
    more = all(change(a, b) > 0 for a, b in zip(whole[0], whole[1], strict=True))
    return Conclusion(
        "Beside the paper: forks in line, as one would assemble them, cancel what equal joints force on the line, but "
        f"not the parametric excitation{'; slightly more is unstable' if more else ''}.",
        ADDED,
        f"Figures 4, 5 and 6 with β₂ within {NEAR} rad of β₁: {percents(equal[0])} unstable with joints in phase, "
        f"{percents(equal[1])} with forks in line; for all β₂ up to 45°: {percents(whole[0])} and "
        f"{percents(whole[1])}. The joints still modulate "
        "the coupling of their own two disks; only their sum at the output cancels.",
    )

"""S3's conclusions, each against a computed figure; and what forks in line change."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from trunnion.papers.shared.result import NEITHER, Conclusion, Reading, sign
from trunnion.papers.shared.shares import change, in_bands, percents, share
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict

PRACTICAL = float(np.pi / 4)
"""Joint angles that S3 calls practical, up to 45° [rad]."""
NEAR = 0.05
"""How nearly equal two joint angles are to count as equal [rad]."""
SMALL = (0.1, 0.2, 0.3)
"""Angles [rad] below which β₂ counts as small."""
EVERYWHERE = (0.9, 0.95, 0.99)
"""Shares of the angles up to 45° at which a speed must be unstable to count as unstable at nearly all of them."""


def conclusions(
    four: StabilityChart, five: StabilityChart, six: StabilityChart, inline: Mapping[str, StabilityChart]
) -> tuple[Conclusion, ...]:
    """From Figures 4, 5, 6, and the same with the forks in line."""
    return (
        _second(four, five, six),
        _first_at_small(four, six),
        _first_as_a_whole(four, six, inline),
        _inertia(four, five),
        _speed(four, five, six),
        _forks(four, five, six, inline),
    )


def _second(four: StabilityChart, five: StabilityChart, six: StabilityChart) -> Conclusion:
    edges = (0.0, 0.25, 0.5, PRACTICAL, 1.501)
    charts = {"4": four, "5": five, "6": six}
    return Conclusion(
        "A larger angle of the second joint enlarges the unstable regions in the practical range.",
        tuple(r for n, c in charts.items() for r in in_bands(f"Figure {n}, β₂ [rad]", c, edges, along="y")),
    )


def _first_at_small(four: StabilityChart, six: StabilityChart) -> Conclusion:
    readings = []
    for top in SMALL:
        small = [share(c, y=(0.0, top)) for c in (four, six)]
        readings.append(Reading(f"β₂ below {top:g} rad", f"{small[0]} → {small[1]} % unstable", change(*small)))
    for part in EVERYWHERE:
        through = [_throughout(c, part) for c in (four, six)]
        readings.append(
            Reading(
                f"speeds unstable at {100 * part:g} % of the β₂ up to 45°",
                f"{through[0]:.2g} → {through[1]:.2g} % of the speeds",
                sign(through[1] > through[0]),
            )
        )
    return Conclusion(
        "A larger angle of the first joint (β₁ from 0.2 to 0.4 rad) makes small angles of the second unstable, at some "
        "speeds nearly all of them.",
        tuple(readings),
    )


def _first_as_a_whole(four: StabilityChart, six: StabilityChart, inline: Mapping[str, StabilityChart]) -> Conclusion:
    readings = []
    for forks, pair in (("joints in phase", (four, six)), ("forks in line", (inline["4"], inline["6"]))):
        for name, top in (("up to 45°", PRACTICAL), ("as drawn", np.inf)):
            shares = [share(c, y=(0.0, top)) for c in pair]
            readings.append(Reading(f"{forks}, {name}", f"{shares[0]} → {shares[1]} %", -change(*shares)))
    return Conclusion(
        "As a whole the unstable regions seem to shrink with a larger angle of the first joint (β₁ from 0.2 to 0.4 "
        "rad).",
        tuple(readings),
    )


def _throughout(chart: StabilityChart, part: float) -> float:
    rows = chart.y < PRACTICAL
    return 100 * float(np.mean(np.mean(chart.verdict[rows] == Verdict.UNSTABLE, axis=0) >= part))


def _inertia(four: StabilityChart, five: StabilityChart) -> Conclusion:
    """The claim is of the practical range; where the box of speeds ends the paper does not say."""
    readings = []
    for name, x in (("below Ω = 1", (0.0, 1.0)), ("above", (1.0, 2.001)), ("together", (0.0, 2.001))):
        for angles, top in (("up to 45°", PRACTICAL), ("as drawn", np.inf)):
            shares = [share(c, x=x, y=(0.0, top)) for c in (four, five)]
            readings.append(Reading(f"{name}, {angles}", f"{shares[0]} → {shares[1]} %", -change(*shares)))
    return Conclusion(
        "A larger inertia of the third disk (γ₂ from 10 to 100) shrinks the unstable regions in the practical range.",
        tuple(readings),
        "The whole hangs on where the box ends.",
    )


def _speed(four: StabilityChart, five: StabilityChart, six: StabilityChart) -> Conclusion:
    edges = (0.04, 0.5, 1.0, 1.5, 2.001)
    charts = {"4": four, "5": five, "6": six}
    return Conclusion(
        "A higher speed generally means more instability, though natural frequencies decide.",
        tuple(
            r
            for n, c in charts.items()
            for r in in_bands(f"Figure {n} up to 45°, Ω", c, edges, along="x", y=(0.0, PRACTICAL))
        ),
        "It follows where the first-order tongues stand, not the speed.",
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
        (
            Reading(
                f"Figures 4, 5 and 6 with β₂ within {NEAR} rad of β₁",
                f"{percents(equal[0])} unstable with joints in phase, {percents(equal[1])} with forks in line",
                NEITHER,
            ),
            Reading("the same for all β₂ up to 45°", f"{percents(whole[0])} and {percents(whole[1])}", NEITHER),
        ),
        "The joints still modulate the coupling of their own two disks; only their sum at the output cancels.",
        in_paper=False,
    )

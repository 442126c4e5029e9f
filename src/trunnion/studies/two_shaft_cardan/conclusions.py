"""S1's conclusions, each against a computed figure."""

from __future__ import annotations

import numpy as np

from trunnion.analyses.linear.natural_frequencies import natural_frequencies
from trunnion.analyses.linear.resonance_speeds import resonance_speeds
from trunnion.results.chart import StabilityChart
from trunnion.studies.result import CONFIRMED, CORRECTED, Conclusion
from trunnion.studies.shares import bands, change, judged, percents, share, steps
from trunnion.studies.tips import tip

PRACTICAL = float(np.pi / 6)
"""Joint angles that S1 calls usual, up to 30° [rad]."""
HALVES = (0.06, 1.0, 2.001)
WIDE = (0.06, 12.0)
"""Speeds over which the stiffness ratio is judged: the first-order tongues of μ = 20 reach Ω = 6.4."""

SCALED = 1.5
"""Speeds up to this times ω₂ where each line is measured by its own frequency."""


def conclusions(
    base: StabilityChart,
    damped: StabilityChart,
    wide: StabilityChart,
    wide_stiff: StabilityChart,
    heavy: StabilityChart,
) -> tuple[Conclusion, ...]:
    """From Figures 3 (base), 4 (damped), 2 (heavy), and both stiffness ratios over ``WIDE`` up to 30°."""
    return (
        _angle(base),
        _stiffness(wide, wide_stiff),
        _damping(base, damped),
        _speed(base),
        _difference(heavy),
    )


def _angle(base: StabilityChart) -> Conclusion:
    low = bands(base, (0.0, 0.25, PRACTICAL, 1.0, 1.501), along="y")
    return Conclusion(
        "A larger joint angle widens the unstable regions.",
        judged(steps(low)),
        f"Unstable share of Figure 3 for β in 0–0.25, 0.25–0.52, 0.52–1 and 1–1.5 rad: {percents(low)}.",
    )


def _stiffness(soft: StabilityChart, stiff: StabilityChart) -> Conclusion:
    area = (WIDE[1] - WIDE[0]) * PRACTICAL / 100
    whole = [share(c) for c in (soft, stiff)]
    cut = [share(c, x=(WIDE[0], HALVES[-1])) for c in (soft, stiff)]
    beyond = [share(c, x=(HALVES[-1], 99.0)) for c in (soft, stiff)]
    scaled = [share(c, x=(WIDE[0], SCALED * _highest(c))) for c in (soft, stiff)]
    inside = (HALVES[-1] - WIDE[0]) * PRACTICAL / 100
    return Conclusion(
        "A stiffer second shaft enlarges the unstable regions, the more so at high speed.",
        judged([change(*whole), change(*scaled), change(*beyond)]),
        f"Up to 30° over Ω = {WIDE[0]:g}–{WIDE[1]:g} the unstable area is {area * whole[0].value:.3f} rad for μ = 1 "
        f"and {area * whole[1].value:.3f} rad for μ = 20 ({percents(whole)} of the box). Up to {SCALED:g} ω₂ of "
        f"each line, with Ω scaled by its own ω₂, it is {percents(scaled)}. The growth lies above "
        "Ω = 2, where natural frequencies that rise with μ carry the tongues "
        f"({percents(beyond)} there); a picture cut at Ω = 2 shows less of it ({inside * cut[0].value:.3f} and "
        f"{inside * cut[1].value:.3f} rad).",
    )


def _highest(chart: StabilityChart) -> float:
    assert chart.line is not None
    return float(natural_frequencies(chart.line).undamped_frequency[-1])


def _damping(base: StabilityChart, damped: StabilityChart) -> Conclusion:
    before, after = (bands(c, HALVES, along="x", y=(0.0, PRACTICAL)) for c in (base, damped))
    less = [a.value - b.value for a, b in zip(before, after, strict=True)]
    shrinks = [-change(a, b) for a, b in zip(before, after, strict=True)]
    wider = 100 * float(np.mean((damped.verdict == 1) & (base.verdict == 0)))
    assert base.line is not None
    second = next(r for r in resonance_speeds(base.line) if str(r) == "subharmonic ω₂")
    moved = abs(tip(damped, second).speed - tip(base, second).speed)
    return Conclusion(
        "More damping of the second shaft shrinks the unstable regions slightly, most at high speed; tips stay.",
        judged([*shrinks, 1 if less[1] > less[0] else -1]),
        f"Up to 30°, below and above Ω = 1: {percents(before)} unstable for α = 1, {percents(after)} for α = 20. The "
        f"tip at ω₂ moves by {moved:.1e} in Ω. Yet {wider:.2g} % of all points are stable for α = 1 and unstable for "
        "α = 20: damping of one shaft alone can widen a combination tongue.",
    )


def _speed(base: StabilityChart) -> Conclusion:
    quarter = bands(base, (0.04, 0.5, 1.0, 1.5, 2.001), along="x", y=(0.0, PRACTICAL))
    top = share(base, x=(1.8, 2.001), y=(0.0, PRACTICAL))
    return Conclusion(
        "A higher speed generally means more instability, though not everywhere.",
        judged(steps(quarter)),
        f"Up to 30°, for Ω in 0–0.5, 0.5–1, 1–1.5 and 1.5–2: {percents(quarter)} unstable. It is the first-order "
        "tongues that count, near ω₁, (ω₁+ω₂)/2 and ω₂; between and beyond them the line is stable (for Ω in 1.8–2: "
        f"{percents([top])}).",
    )


def _difference(heavy: StabilityChart) -> Conclusion:
    assert heavy.line is not None
    shut = []
    for r in resonance_speeds(heavy.line):
        if r.kind == "difference":
            shut.append((r.formula, share(heavy, x=(r.speed - 0.006, r.speed + 0.006), y=(0.0, 0.9)).value))
    said = " and ".join(f"{formula}: {value:.2g} %" for formula, value in shut)
    return Conclusion(
        "Difference combinations are among the resonances (Table 2).",
        CORRECTED if all(value == 0 for _, value in shut) else CONFIRMED,
        f"Unstable share within a pixel of them, up to 0.9 rad, γ = 100: {said}. Combination resonance of the derived "
        "equations without load is of sum type only. Matrices with a single η′ do have such a tongue (errata); whether "
        "the paper's entries came from them it does not say.",
    )

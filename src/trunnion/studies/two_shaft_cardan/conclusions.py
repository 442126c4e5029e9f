"""S1's conclusions, each against a computed figure."""

from __future__ import annotations

import numpy as np

from trunnion.analyses.linear.resonance_speeds import resonance_speeds
from trunnion.results.chart import StabilityChart
from trunnion.studies.result import Conclusion
from trunnion.studies.shares import bands, percents, rising, share
from trunnion.studies.tips import tip

PRACTICAL = float(np.pi / 6)
"""Joint angles that S1 calls usual, up to 30° [rad]."""
HALVES = (0.06, 1.0, 2.001)


def conclusions(
    base: StabilityChart,
    damped: StabilityChart,
    stiff: StabilityChart,
    stiffness: StabilityChart,
    heavy: StabilityChart,
) -> tuple[Conclusion, ...]:
    """From Figures 3 (base), 4 (damped), 6 (stiff), 7 (stiffness) and 2 (heavy)."""
    return (
        _angle(base),
        _stiffness(base, stiff, stiffness),
        _damping(base, damped),
        _speed(base),
        _difference(heavy),
    )


def _angle(base: StabilityChart) -> Conclusion:
    low = bands(base, (0.0, 0.25, PRACTICAL, 1.0, 1.501), along="y")
    return Conclusion(
        "A larger joint angle widens the unstable regions.",
        "confirmed" if rising(low) else "corrected",
        f"Unstable share of Figure 3 for β in 0–0.25, 0.25–0.52, 0.52–1 and 1–1.5 rad: {percents(low)}.",
    )


def _stiffness(base: StabilityChart, stiff: StabilityChart, stiffness: StabilityChart) -> Conclusion:
    before, after = (bands(c, HALVES, along="x", y=(0.0, PRACTICAL)) for c in (base, stiff))
    grows = all(b > a for a, b in zip(before, after, strict=True))
    return Conclusion(
        "A stiffer second shaft enlarges the unstable regions, the more so at high speed.",
        "confirmed" if grows and after[1] - before[1] > after[0] - before[0] else "corrected",
        f"Up to 30°, below and above Ω = 1: {percents(before)} unstable for μ = 1, {percents(after)} for μ = 20; over "
        f"all angles {share(base, x=(0.06, 3)):.3g} % and {share(stiff, x=(0.06, 3)):.3g} %; Figure 7 for μ in "
        f"0.05–1, 1–5 and 5–20: {percents(bands(stiffness, (0.05, 1.0, 5.0, 20.1), along='y'))}. Natural frequencies "
        "rise with μ and carry the tongues to higher speeds, most of them out of the box (Ω counts in units of the "
        "first shaft's frequency): what matters is where they stand, not how stiff the shaft is.",
    )


def _damping(base: StabilityChart, damped: StabilityChart) -> Conclusion:
    before, after = (bands(c, HALVES, along="x", y=(0.0, PRACTICAL)) for c in (base, damped))
    less = [a - b for a, b in zip(before, after, strict=True)]
    wider = 100 * float(np.mean((damped.verdict == 1) & (base.verdict == 0)))
    assert base.line is not None
    second = next(r for r in resonance_speeds(base.line) if str(r) == "subharmonic ω₂")
    moved = abs(tip(damped, second).speed - tip(base, second).speed)
    return Conclusion(
        "More damping of the second shaft shrinks the unstable regions slightly, most at high speed; tips stay.",
        "confirmed" if all(d > 0 for d in less) and less[1] > less[0] else "corrected",
        f"Up to 30°, below and above Ω = 1: {percents(before)} unstable for α = 1, {percents(after)} for α = 20. The "
        f"tip at ω₂ moves by {moved:.1e} in Ω. Yet {wider:.2g} % of all points are stable for α = 1 and unstable for "
        "α = 20: damping of one shaft alone can widen a combination tongue.",
    )


def _speed(base: StabilityChart) -> Conclusion:
    quarter = bands(base, (0.04, 0.5, 1.0, 1.5, 2.001), along="x", y=(0.0, PRACTICAL))
    return Conclusion(
        "A higher speed generally means more instability, though not everywhere.",
        "confirmed" if quarter[2] > quarter[0] and quarter[3] > quarter[1] else "corrected",
        f"Up to 30°, for Ω in 0–0.5, 0.5–1, 1–1.5 and 1.5–2: {percents(quarter)} unstable. It is the first-order "
        "tongues that count, near ω₁, (ω₁+ω₂)/2 and ω₂; between and beyond them the line is stable (for Ω in 1.8–2: "
        f"{share(base, x=(1.8, 2.001), y=(0.0, PRACTICAL)):.3g} %).",
    )


def _difference(heavy: StabilityChart) -> Conclusion:
    assert heavy.line is not None
    shut = []
    for r in resonance_speeds(heavy.line):
        if r.kind == "difference":
            shut.append((r.formula, share(heavy, x=(r.speed - 0.006, r.speed + 0.006), y=(0.0, 0.9))))
    said = " and ".join(f"{formula}: {value:.2g} %" for formula, value in shut)
    return Conclusion(
        "Difference combinations are among the resonances (Table 2).",
        "corrected" if all(value == 0 for _, value in shut) else "confirmed",
        f"Unstable share within a pixel of them, up to 0.9 rad, γ = 100: {said}. They come from the single η′ of the "
        "printed matrices; in truth combination resonance of an unloaded line is of sum type only.",
    )

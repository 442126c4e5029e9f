"""S1's conclusions, each against the computed figures of every reading that the paper leaves open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.modes.resonance_speeds import resonance_speeds
from trunnion.papers.shared.result import Conclusion, Reading, agreed, sign
from trunnion.papers.shared.shares import Share, bands, change, in_bands, share
from trunnion.papers.shared.tips import tip
from trunnion.papers.two_shaft_cardan.errata import difference_tongue
from trunnion.results.chart import StabilityChart

PRACTICAL = float(np.pi / 6)
"""Joint angles that S1 calls usual, up to 30° [rad]."""
USUAL = (0.0, PRACTICAL)
HALVES = (0.06, 1.0, 2.001)
DRAWN = (HALVES[0], HALVES[-1])
"""Speeds that Figures 3, 4 and 6 have in common."""
WIDE = (0.06, 12.0)
"""Speeds that hold the first-order tongues of both stiffness ratios: those of μ = 20 reach Ω = 6.4."""
SCALED = 1.5
"""Speeds up to this times ω₂ where each line is measured by its own frequency."""
SLIGHT = 0.25
"""Part of itself by which an unstable share may fall for the fall to count as slight; the paper has no number."""
LINES = "joint angles up to 30°"


@dataclass(frozen=True)
class Charts:
    """Figures 3 (base), 4 (damped), 6 (stiff), 2 (heavy), 5 and 7 (over damping and stiffness); both stiffness ratios
    over ``WIDE`` up to 30°; and Figures 3 and 4 with the α that the text prints, 0.001 and 20 times that."""

    base: StabilityChart
    damped: StabilityChart
    stiff: StabilityChart
    heavy: StabilityChart
    over_damping: StabilityChart
    over_stiffness: StabilityChart
    wide: tuple[StabilityChart, StabilityChart]
    printed_alpha: tuple[StabilityChart, StabilityChart]


def conclusions(charts: Charts) -> tuple[Conclusion, ...]:
    """S1's five."""
    return (_angle(charts), _stiffness(charts), _damping(charts), _speed(charts), _difference(charts.heavy))


def _angle(charts: Charts) -> Conclusion:
    whole = in_bands("Figure 3, β [rad]", charts.base, (0.0, 0.25, PRACTICAL, 1.0, 1.501), along="y")
    heavy = in_bands("Figure 2, β [rad]", charts.heavy, (0.0, 0.25, PRACTICAL, 1.0, 1.501), along="y")
    return Conclusion("A larger joint angle widens the unstable regions.", (*whole, *heavy))


def _pair(
    name: str, charts: tuple[StabilityChart, StabilityChart], grows: int = 1, **box: tuple[float, float]
) -> Reading:
    """Whether the share of a box grows (or shrinks) from one chart to the other."""
    before, after = (share(c, **box) for c in charts)
    return Reading(name, f"{before} → {after} %", grows * change(before, after))


def _stiffness(charts: Charts) -> Conclusion:
    figures, wide = (charts.base, charts.stiff), charts.wide
    scaled = [share(c, x=(WIDE[0], SCALED * _highest(c))) for c in wide]
    return Conclusion(
        "A stiffer second shaft enlarges the unstable regions, the more so at high speed.",
        (
            _pair("μ = 1 and 20 in Figures 3 and 6 as drawn, Ω up to 2", figures, x=DRAWN),
            _pair(f"the same for {LINES}", figures, x=DRAWN, y=USUAL),
            _pair(f"{LINES}, Ω up to {WIDE[1]:g}, where the first-order tongues of μ = 20 lie", wide),
            _pair(f"{LINES}, Ω from 2 to {WIDE[1]:g}", wide, x=(HALVES[-1], 99.0)),
            Reading(
                f"{LINES}, Ω up to {SCALED:g} ω₂ of each line",
                f"{scaled[0]} → {scaled[1]} %",
                change(scaled[0], scaled[1]),
            ),
            _groups("Figure 7 (β = 0.5 rad, taken), μ below and above 10", charts.over_stiffness, 1),
        ),
        "Natural frequencies that rise with μ carry the tongues out of a box that ends at Ω = 2.",
    )


def _groups(name: str, chart: StabilityChart, grows: int) -> Reading:
    """The lower and the upper half of Figure 5 or 7."""
    low, high = bands(chart, (0.0, 10.0, 20.1), along="y")
    return Reading(name, f"{low} → {high} %", grows * change(low, high))


def _highest(chart: StabilityChart) -> float:
    assert chart.line is not None
    return float(natural_frequencies(chart.line).undamped_frequency[-1])


def _damping(charts: Charts) -> Conclusion:
    base, damped = charts.base, charts.damped
    pair = (base, damped)
    low, high = ([share(c, x=ends, y=USUAL) for c in pair] for ends in (HALVES[:2], HALVES[1:]))
    drawn = [share(c, x=DRAWN) for c in pair]
    fell = [_fall(*shares) for shares in (low, high, drawn)]
    less = [before.value - after.value for before, after in (low, high)]
    wider = 100 * float(np.mean((damped.verdict == 1) & (base.verdict == 0)))
    assert base.line is not None
    second = next(r for r in resonance_speeds(base.line) if str(r) == "subharmonic ω₂")
    moved = abs(tip(damped, second).speed - tip(base, second).speed)
    pixel = float(np.diff(base.x).max())
    return Conclusion(
        "More damping of the second shaft shrinks the unstable regions slightly, most at high speed; tips stay.",
        (
            _pair("shrinks: α = 1 and 20 in Figures 3 and 4 as drawn", pair, -1, x=DRAWN),
            _pair(f"the same for {LINES}, below Ω = 1", pair, -1, x=HALVES[:2], y=USUAL),
            _pair(f"{LINES}, above Ω = 1", pair, -1, x=HALVES[1:], y=USUAL),
            _pair("α = 0.001 and 0.02, as printed for the base state, as drawn", charts.printed_alpha, -1, x=DRAWN),
            _groups("Figure 5 (β = 0.5 rad, taken), α below and above 10", charts.over_damping, -1),
            Reading(
                f"slightly, by less than {100 * SLIGHT:g} % of itself",
                f"it falls by {100 * fell[0]:.0f} % below Ω = 1 and {100 * fell[1]:.0f} % above, up to 30°, and by "
                f"{100 * fell[2]:.0f} % as drawn",
                agreed([sign(f < SLIGHT) for f in fell]),
            ),
            Reading(
                "most at high speed, up to 30°",
                f"{less[0]:.2f} points below Ω = 1, {less[1]:.2f} above",
                change(_difference_of(*low), _difference_of(*high)),
            ),
            Reading("tips stay, at ω₂", f"moves by {moved:.1e} in Ω, a pixel is {pixel:.1e}", sign(moved < pixel)),
        ),
        f"{wider:.2g} % of all points of Figure 3 are stable for α = 1 and unstable for α = 20: damping of one shaft "
        "alone can widen a combination tongue.",
    )  # fmt: skip


def _fall(before: Share, after: Share) -> float:
    return 1 - after.value / before.value


def _difference_of(before: Share, after: Share) -> Share:
    return Share(before.value - after.value, float(np.hypot(before.error, after.error)))


def _speed(charts: Charts) -> Conclusion:
    edges = (0.04, 0.5, 1.0, 1.5, 2.001)
    return Conclusion(
        "A higher speed generally means more instability, though not everywhere.",
        (
            *in_bands("Figure 3 up to 30°, Ω", charts.base, edges, along="x", y=USUAL),
            *in_bands("Figure 3 as drawn, Ω", charts.base, edges, along="x"),
        ),
        "It is the first-order tongues that count, near ω₁, (ω₁+ω₂)/2 and ω₂; between and beyond them the line is "
        "stable at such angles.",
    )


def _difference(heavy: StabilityChart) -> Conclusion:
    assert heavy.line is not None
    shut = []
    for r in resonance_speeds(heavy.line):
        if r.kind == "difference":
            near = share(heavy, x=(r.speed - 0.006, r.speed + 0.006), y=(0.0, 0.9)).value
            shut.append(Reading(r.formula, f"{near:.2g} % unstable within a pixel up to 0.9 rad", sign(near > 0)))
    at, height, below = difference_tongue()
    return Conclusion(
        "Difference combinations are among the resonances (Table 2), γ = 100.",
        tuple(shut),
        "Combination resonance of the derived equations without load is of sum type only. Matrices with a single η′, "
        f"which are wrong, do have such a tongue: spectral radius {height:.5f} at Ω = {at:.4f}, where the derived ones "
        f"have {below:.5f} (errata). Whether the paper's entries came from them it does not say.",
    )

"""S5 computed anew: Figures 2 and 3 as one picture, every method overlaid, and what its claim is worth.

M. Rezaee and A. Farshidianfar: nonlinear equations of rattling vibration of two meshing gears with damping, by
multiple scales and averaging (in Persian).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from trunnion.motion.orbits.basins import Basins, basins
from trunnion.motion.orbits.exact_orbit import piecewise_orbit
from trunnion.motion.orbits.frequency_response import (
    METHODS,
    FrequencyResponse,
    ResponseComparison,
    compare_responses,
    frequency_response,
)
from trunnion.motion.orbits.sweep import OscillatorSweep, sweep
from trunnion.motion.perturbation.multiple_scales import multiple_scales
from trunnion.motion.perturbation.slow_flow import ApproximateResponse
from trunnion.papers.gear_rattle.figures import basins_figure, index_figure, methods_figure, ranges_figure
from trunnion.papers.gear_rattle.published import gear_rattle as published
from trunnion.papers.shared.result import (
    AGAINST,
    NEITHER,
    ComparisonTable,
    Conclusion,
    PaperFigure,
    Reading,
    Reproduction,
    TableRow,
    agreed,
    rounded,
    sign,
)
from trunnion.systems.piecewise_oscillator import PiecewiseOscillator

NAME = "gear-rattle"
LOW, HIGH = 0.3, 1.3
RANGES = (2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0)
"""Half lengths of the cubic fit in half gaps; the paper states none."""
ACCURATE = 0.05
"""Largest error in height and in place that counts as "very good accuracy"."""
DOUBLED = 0.43, 1.27
"""Frequencies at which motions of twice the period are stable."""
IMPACT = "small at low speed and load, says the paper; GearPair has it as impact_damping"
FORCE = 0.03
"""B₁ of Table 1."""
SMALL = 0.6
"""Below this frequency lie the smaller peaks."""


def gear_rattle(points: int, report_progress: Callable[[float], None]) -> Reproduction:
    """Reproduce S5; sweeps of 100 to 400 steps, about ``points``."""
    grid = np.linspace(LOW, HIGH, 1 + 100 * min(max(round(points / 100), 1), 4))
    loaded, unloaded = published(), published(mean_force=0.0)
    half_gap = loaded.breakpoints[1]
    ranges = {r: multiple_scales(loaded, fit_range=r * half_gap).response(0.1, 8.0) for r in RANGES}
    truth = frequency_response(loaded, LOW, HIGH)
    off = {r: _off(a, truth) for r, a in ranges.items()}
    used = min(off, key=lambda r: max(map(abs, off[r])))
    report_progress(0.1)
    fit = {"fit_range": used * half_gap}
    steps = {"points": len(grid)}
    options: dict[str, dict[str, Any]] = {
        "averaging": fit, "multiple scales": fit, "sweep up": steps, "sweep down": steps,
    }  # fmt: skip
    found = compare_responses(loaded, LOW, HIGH, methods=METHODS, options=options)
    report_progress(0.5)
    free = compare_responses(unloaded, LOW, HIGH, methods=METHODS, options=options)
    doubled = tuple(_doubled(loaded, at) for at in DOUBLED)
    report_progress(0.8)
    up, down = sweep(loaded, grid), sweep(loaded, grid[::-1])
    at_08 = basins(loaded, np.linspace(-1, 1, 101), np.linspace(-1, 1, 101))
    report_progress(0.95)
    assumed = (
        f"Table 1 of the paper. The range of the cubic fit is not stated; ±{used:g} b is drawn here, of "
        f"±{RANGES[0]:g} to ±{RANGES[-1]:g} b the nearest to the truth. The exact curve stands for Figure 3, multiple "
        "scales and averaging (one curve) for Figure 2."
    )
    figures = (
        PaperFigure("2 and 3", "Frequency response by every method, B₀ = 0.05", assumed,
                    partial(methods_figure, found, "Gear pair with backlash, B₀ = 0.05", doubled)),
    )  # fmt: skip
    evidence = (
        PaperFigure("unloaded", "The same without mean force", assumed,
                    partial(methods_figure, free, "Gear pair with backlash, B₀ = 0")),
        PaperFigure("ranges", "First-order perturbation for several ranges of the cubic fit",
                    "Uniform least squares of the force over ± the range.",
                    partial(ranges_figure, found["exact"], ranges)),
        PaperFigure("rattle-index", "Energy of the impacts per period over frequency, B₀ = 0.05",
                    "Entries into contact from the gap, on either side.", partial(index_figure, up, down)),
        PaperFigure("basins", "Which motion is reached from where, B₀ = 0.05",
                    "101 × 101 starts at phase zero; crosses: the motions.", partial(basins_figure, at_08)),
    )  # fmt: skip
    tables = (
        _methods(found, "B₀ = 0.05"),
        _methods(free, "B₀ = 0"),
        _sweeps(up, down),
        _epsilons(used),
        _ranges(ranges, off),
    )
    return Reproduction(
        NAME,
        "Rattling of two meshing gears with damping (S5)",
        "M. Rezaee and A. Farshidianfar, multiple scales and averaging for gear rattle (in Persian)",
        figures,
        tables,
        _errata(),
        evidence,
        _conclusions(found, off, doubled[0], at_08, (up, down)),
        assumed=_assumed(used, off, truth),
    )


def _doubled(loaded: PiecewiseOscillator, at: float) -> FrequencyResponse:
    """The exact motions of twice the period on the branch that passes a frequency."""
    start = piecewise_orbit(loaded.but(frequency=at), periods=2).start
    return frequency_response(loaded, LOW, HIGH, begin=at, start=start, periods=2)


def _methods(found: ResponseComparison, what: str) -> ComparisonTable:
    exact = found["exact"]
    at, size = exact.peak
    rows = []
    for name, r in found.responses.items():
        f, a = r.peak
        motions = ", ".join(f"{value:.5f}" for value, stable in r.at(0.8) if stable)
        words = f"height {100 * (a / size - 1):+.2f} %, place {100 * (f / at - 1):+.2f} %; {r.seconds:.2g} s"
        folds = ", ".join(f"{x:.5f}" for x in r.folds()) or "none in range"
        rows.append(TableRow(name, "—", f"peak {a:.5f} at {f:.5f}; turns at {folds}; stable at 0.8: {motions}", words))
    return ComparisonTable(
        f"Methods against the exact motion, {what} (half peak-to-peak, ω)", tuple(rows),
        "The paper draws its curves without numbers. Turns are folds, of sweeps the last frequency before a jump; "
        "motions at 0.8 are interpolated along the curves.",
    )  # fmt: skip


def _sweeps(up: OscillatorSweep, down: OscillatorSweep) -> ComparisonTable:
    def row(words: str, one: OscillatorSweep) -> TableRow:
        jumps = ", ".join(f"{a:.3f} → {b:.3f}" for a, b in one.jumps)
        kinds = ", ".join(f"{one.contact.count(k)} {k}" for k in ("none", "one-sided", "two-sided"))
        return TableRow(words, "—", f"jumps {jumps}", f"contact {kinds}; {int((~one.settled).sum())} not of one period")

    return ComparisonTable(
        "Sweeps, B₀ = 0.05", (row("up", up), row("down", down)),
        "Between the period doublings motions of twice the period are reached: the paper's smaller peaks and more.",
    )  # fmt: skip


def _epsilon_peak(epsilon: float, reach: float) -> tuple[float, float]:
    """Frequency and height of the main peak for another ε, cubic fit to ± ``reach`` half gaps."""
    line = published()
    return multiple_scales(line, epsilon=epsilon, fit_range=reach * line.breakpoints[1]).response(0.1, 8).peak


def _epsilons(used: float) -> ComparisonTable:
    rows = []
    for epsilon in (1e-4, 0.01, 0.1, 1.0):
        f, a = _epsilon_peak(epsilon, used)
        rows.append(TableRow(f"ε = {epsilon:g}", "Figure 2" if epsilon == 0.01 else "—", f"peak {a:.8f} at {f:.8f}"))
    return ComparisonTable(
        f"Other ε, cubic fit to ±{used:g} b", tuple(rows),
        "ε scales U, μ, σ and B* so that it drops out of u(t): a small ε does not make the nonlinearity weak.",
    )  # fmt: skip


def _off(response: ApproximateResponse, truth: FrequencyResponse) -> tuple[float, float]:
    """Relative errors of the main peak: height, place."""
    return response.peak[1] / truth.peak[1] - 1, response.peak[0] / truth.peak[0] - 1


def _ranges(by_range: dict[float, ApproximateResponse], off: dict[float, tuple[float, float]]) -> ComparisonTable:
    rows = [
        TableRow(f"fit to ±{r:g} b", "not stated", f"peak {a.peak[1]:.4f} at {a.peak[0]:.4f}",
            f"height {100 * off[r][0]:+.1f} %, place {100 * off[r][1]:+.1f} %; {a.note}")
        for r, a in by_range.items()
    ]  # fmt: skip
    return ComparisonTable(
        "The range of the cubic fit", tuple(rows),
        "Least squares, evenly over the range. The truth is in the first table; its peak is 4 b high.",
    )  # fmt: skip


def _errata() -> ComparisonTable:
    rows = (
        TableRow("(13)", "λ₁²T² = 1", "λ₁T² = 1", "λ₁ already is a frequency squared"),
        TableRow("(50), (63)", "B₁²T²/(4ω²ε²)", "B₁²T⁴/(4ε²U²)", "from (18) and (49)"),
        TableRow("(51), (52)", "U² = ελ₁²/λ₂, T² = 1/λ₁²", "U² = ελ₁/λ₂, T² = 1/λ₁", "as (13)"),
        TableRow("(9)", "range not stated", "decides the answer", "see the table of ranges"),
    )
    return ComparisonTable("Misprints", rows)


def _assumed(used: float, off: dict[float, tuple[float, float]], truth: FrequencyResponse) -> ComparisonTable:
    """What the text leaves open, and what another value changes."""
    worst = max(off, key=lambda r: max(map(abs, off[r])))
    return ComparisonTable(
        "What is assumed",
        (
            TableRow("(9), range of the cubic fit", "not stated", f"±{used:g} b where one is drawn, the best",
                f"±{worst:g} b is off by {100 * off[worst][0]:+.1f} % in height and {100 * off[worst][1]:+.1f} % in "
                "place; every range is a reading of its own among the conclusions"),
            TableRow("b", "10° beside nondimensional numbers", f"{published().breakpoints[1]:.5f} rad",
                f"u is in radians: the static rotation is {_static():.3f}, just outside the gap"),
            TableRow("(1), impact damping D_MI", "left out", "left out", IMPACT),
            TableRow("amplitude of Figures 2, 3", "pictures without numbers", "half peak-to-peak",
                f"half peak-to-peak of the peak is {truth.peak[1]:.4f}, its fundamental by energy balance B₁/(cω) = "
                f"{FORCE / (published().damping * truth.peak[0]):.4f}"),
        ),
    )  # fmt: skip


def _static() -> float:
    """Where the mean force of Table 1 holds the gears, outside the gap: B₀ + (1 − α)b."""
    line = published()
    return float(line.coefficients[0].real + (1 - line.slopes[1]) * line.breakpoints[1])


def _conclusions(
    found: ResponseComparison,
    off: dict[float, tuple[float, float]],
    doubled: FrequencyResponse,
    reached: Basins,
    sweeps: tuple[OscillatorSweep, OscillatorSweep],
) -> tuple[Conclusion, ...]:
    exact, simple = found["exact"], found["describing function"]
    at, size = exact.peak
    alike = max(abs(found["averaging"].peak[i] / found["multiple scales"].peak[i] - 1) for i in (0, 1))
    tops = [_epsilon_peak(e, 5.0)[1] for e in (1e-4, 0.01, 0.1, 1.0)]
    spread = max(tops) / min(tops) - 1
    good = sum(_accurate(errors) for errors in off.values())
    return (
        Conclusion(
            "Multiple scales and averaging find height and place of the main peak with very good accuracy.",
            tuple(
                Reading(f"fit to ±{r:g} b", f"{100 * h:+.1f} %, {100 * w:+.1f} %", sign(_accurate((h, w))))
                for r, (h, w) in off.items()
            ),
            f"Errors of height and place; the truth is {size:.4f} at {at:.4f}, and up to {100 * ACCURATE:g} % in both "
            "count as very good. The paper does not state the range of its fit. Averaging the exact force needs none: "
            f"{100 * (simple.peak[1] / size - 1):+.1f} % and {100 * (simple.peak[0] / at - 1):+.2f} %.",
        ),
        Conclusion(
            "They cannot find the smaller peaks.",
            (
                Reading(
                    f"below ω = {SMALL:g}",
                    f"exact {_small(exact)}; one harmonic {_small(simple)}",
                    sign(bool(_peaks(exact)) and not _peaks(simple)),
                ),
            ),
            f"Between the period doublings there are motions of twice the period up to {doubled.peak[1]:.3f} at "
            f"{doubled.peak[0]:.3f}. The first peak is superharmonic; where the period doubles the simple motion is "
            "unstable.",
        ),
        Conclusion(
            "The same result of both derivations proves it right.",
            (
                Reading(
                    "peaks of both",
                    f"equal to {rounded(alike)} (below 1e-10), yet within {100 * ACCURATE:g} % of the truth for {good} "
                    f"of {len(off)} ranges of the fit",
                    -sign(alike < 1e-9 and good < len(off)),
                ),
            ),
            "They are the same first order of one cubic.",
        ),
        Conclusion(
            "With ε = 0.01 the nonlinearity is weak (Figure 2).",
            (
                Reading(
                    "ε = 1e-4, 0.01, 0.1 and 1",
                    f"the same peak to {rounded(spread)} (below 1e-10)",
                    AGAINST if spread < 1e-6 else NEITHER,
                ),
            ),
            "ε scales U, μ, σ and B* and drops out of u(t).",
        ),
        *_trends(),
        Conclusion(
            "Beside the paper: which motion is reached decides how it rattles.",
            (
                Reading(
                    "energy of the impacts per period",
                    f"up to {np.nanmax(sweeps[0].impact_energy):.2g} on the sweep up, "
                    f"{np.nanmax(sweeps[1].impact_energy):.2g} on the sweep down",
                    NEITHER,
                ),
                Reading("at ω = 0.8", _reached(reached), NEITHER),
            ),
            in_paper=False,
        ),
    )


def _accurate(errors: tuple[float, float]) -> bool:
    return max(map(abs, errors)) <= ACCURATE


def _reached(found: Basins) -> str:
    """Shares of the starts, evenly spaced, from which each motion is reached."""
    shares = [100 * float(share) for share in found.shares]
    errors = [np.sqrt(s * (100 - s) / found.number.size) for s in shares]
    words = " and ".join(f"{s:.1f} ± {e:.1f} %" for s, e in zip(shares, errors, strict=True))
    return f"its motions are reached from {words} of the starts within ±1"


TREND_RANGES = (5.0, 8.0, 10.0)
"""Half lengths of the fit [b] behind the claims on backlash and damping."""
TRENDS: dict[str, dict[str, dict[str, float]]] = {
    "damping": {
        "two thirds of it": {"damping": published().damping / 1.5},
        "1.5 times": {"damping": 1.5 * published().damping},
    },
    "backlash": {
        "half of it": {"half_gap": published().breakpoints[1] / 2},
        "twice": {"half_gap": 2 * published().breakpoints[1]},
    },
}
"""What is changed of Table 1 to see what the formula says of it."""


def _trends() -> list[Conclusion]:
    """Whether height and place of the formula's peak follow damping and backlash, for fits of several ranges."""
    base = published()
    truth = _exact_peak(base)
    conclusions = []
    for what, changes in TRENDS.items():
        exact = {words: _over(_exact_peak(published(**change)), truth) for words, change in changes.items()}
        readings = []
        for reach in TREND_RANGES:
            fits = {"scaled with b": None, "held": reach * base.breakpoints[1]}
            for kind, half in fits.items() if what == "backlash" else [("held", reach * base.breakpoints[1])]:
                before = _formula_peak(base, half or reach * base.breakpoints[1])
                signs, said = [], []
                for words, change in changes.items():
                    line = published(**change)
                    found = _over(_formula_peak(line, half or reach * line.breakpoints[1]), before)
                    follows = [_follows(f, t) for f, t in zip(found, exact[words], strict=True)]
                    signs.append(agreed([sign(f) for f in follows]))
                    said.append(f"{words} {100 * found[0]:+.1f} %, {100 * found[1]:+.1f} %")
                where = f"±{reach:g} b" if what == "damping" or half is None else f"±{half:.3f} rad"
                readings.append(Reading(f"fit to {where}, {kind}", ", ".join(said), agreed(signs)))
        true = ", ".join(f"{words} {100 * h:+.1f} %, {100 * w:+.1f} %" for words, (h, w) in exact.items())
        conclusions.append(
            Conclusion(
                f"The formula shows what {what} does to the response, so that a designer can avoid resonance.",
                tuple(readings),
                f"Changes of height and place of the main peak; exact: {true}. The formula follows where each goes the "
                "same way and at least half as far, or neither goes by 1 %. The range of the cubic fit, and whether it "
                "goes with b, the paper does not state.",
            )
        )
    return conclusions


STILL = 0.01
"""Change of a peak's height or place below which it counts as none."""


def _follows(formula: float, exact: float) -> bool:
    if abs(exact) < STILL:
        return abs(formula) < STILL
    return formula * exact > 0 and abs(formula) > abs(exact) / 2


def _over(peak: tuple[float, float], base: tuple[float, float]) -> tuple[float, float]:
    """Relative changes of height and place."""
    return peak[1] / base[1] - 1, peak[0] / base[0] - 1


def _formula_peak(line: PiecewiseOscillator, half: float) -> tuple[float, float]:
    """Place and height, cubic fit to ± ``half`` [rad]."""
    return multiple_scales(line, fit_range=half).response(0.1, 8.0).peak


def _exact_peak(line: PiecewiseOscillator) -> tuple[float, float]:
    return frequency_response(line, 0.5, HIGH).peak


def _peaks(response: FrequencyResponse) -> list[tuple[float, float]]:
    """Local peaks below SMALL: size, frequency."""
    frequency, size = response.frequency, response.half_peak_to_peak
    inside = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] > size[2:]) & (frequency[1:-1] < SMALL)) + 1
    return [(float(size[i]), float(frequency[i])) for i in inside]


def _small(response: FrequencyResponse) -> str:
    """The same in words."""
    peaks = [f"{size:.3f} at {at:.3f}" for size, at in _peaks(response)]
    flips = [f"{f:.3f}" for kind, f, _ in response.marks if kind == "period doubling" and f < SMALL]
    doubled = f", period doubling at {' and '.join(flips)}" if flips else ""
    return (f"peaks {', '.join(peaks)}" if peaks else "no peak") + doubled

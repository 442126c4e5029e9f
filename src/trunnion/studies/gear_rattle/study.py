"""S5 computed anew: Figures 2 and 3 as one picture, every method overlaid, and what its claim is worth.

M. Rezaee and A. Farshidianfar: nonlinear equations of rattling vibration of two meshing gears with damping, by
multiple scales and averaging (in Persian).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from trunnion.analyses.orbits.basins import Basins, basins
from trunnion.analyses.orbits.frequency_response import (
    METHODS,
    FrequencyResponse,
    ResponseComparison,
    compare_responses,
    frequency_response,
)
from trunnion.analyses.orbits.piecewise_orbit import piecewise_orbit
from trunnion.analyses.orbits.piecewise_sweep import Sweep, sweep
from trunnion.analyses.perturbation.multiple_scales import multiple_scales
from trunnion.analyses.perturbation.slow_flow import ApproximateResponse
from trunnion.studies.gear_rattle.figures import basins_figure, index_figure, methods_figure, ranges_figure
from trunnion.studies.gear_rattle.published import gear_rattle as published
from trunnion.studies.result import (
    ADDED,
    CONFIRMED,
    CORRECTED,
    UNDECIDED,
    Comparison,
    Conclusion,
    PaperFigure,
    Reproduction,
    Row,
    rounded,
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
SMALL = 0.6
"""Below this frequency lie the smaller peaks."""


def gear_rattle(points: int, tell: Callable[[float], None]) -> Reproduction:
    """Reproduce S5; sweeps of 100 to 400 steps, about ``points``."""
    grid = np.linspace(LOW, HIGH, 1 + 100 * min(max(round(points / 100), 1), 4))
    loaded, unloaded = published(), published(mean_force=0.0)
    half_gap = loaded.breakpoints[1]
    ranges = {r: multiple_scales(loaded, fit_range=r * half_gap).response(0.1, 8.0) for r in RANGES}
    truth = frequency_response(loaded, LOW, HIGH)
    off = {r: _off(a, truth) for r, a in ranges.items()}
    used = min(off, key=lambda r: max(map(abs, off[r])))
    tell(0.1)
    fit = {"fit_range": used * half_gap}
    steps = {"points": len(grid)}
    options: dict[str, dict[str, Any]] = {
        "averaging": fit, "multiple scales": fit, "sweep up": steps, "sweep down": steps,
    }  # fmt: skip
    found = compare_responses(loaded, LOW, HIGH, methods=METHODS, options=options)
    tell(0.5)
    free = compare_responses(unloaded, LOW, HIGH, methods=METHODS, options=options)
    doubled = tuple(_doubled(loaded, at) for at in DOUBLED)
    tell(0.8)
    up, down = sweep(loaded, grid), sweep(loaded, grid[::-1])
    at_08 = basins(loaded, np.linspace(-1, 1, 101), np.linspace(-1, 1, 101))
    tell(0.95)
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
        _conclusions(found, off, doubled[0], _trends(), at_08, (up, down)),
    )


def _doubled(loaded: PiecewiseOscillator, at: float) -> FrequencyResponse:
    """The exact motions of twice the period on the branch that passes a frequency."""
    start = piecewise_orbit(loaded.but(frequency=at), periods=2).start
    return frequency_response(loaded, LOW, HIGH, begin=at, start=start, periods=2)


def _methods(found: ResponseComparison, what: str) -> Comparison:
    exact = found["exact"]
    at, size = exact.peak
    rows = []
    for name, r in found.responses.items():
        f, a = r.peak
        motions = ", ".join(f"{value:.5f}" for value, stable in r.at(0.8) if stable)
        words = f"height {100 * (a / size - 1):+.2f} %, place {100 * (f / at - 1):+.2f} %; {r.seconds:.2g} s"
        folds = ", ".join(f"{x:.5f}" for x in r.folds()) or "none in range"
        rows.append(Row(name, "—", f"peak {a:.5f} at {f:.5f}; turns at {folds}; stable at 0.8: {motions}", words))
    return Comparison(
        f"Methods against the exact motion, {what} (half peak-to-peak, ω)", tuple(rows),
        "The paper draws its curves without numbers. Turns are folds, of sweeps the last frequency before a jump; "
        "motions at 0.8 are interpolated along the curves.",
    )  # fmt: skip


def _sweeps(up: Sweep, down: Sweep) -> Comparison:
    def row(words: str, one: Sweep) -> Row:
        jumps = ", ".join(f"{a:.3f} → {b:.3f}" for a, b in one.jumps)
        kinds = ", ".join(f"{one.contact.count(k)} {k}" for k in ("none", "one-sided", "two-sided"))
        return Row(words, "—", f"jumps {jumps}", f"contact {kinds}; {int((~one.settled).sum())} not of one period")

    return Comparison(
        "Sweeps, B₀ = 0.05", (row("up", up), row("down", down)),
        "Between the period doublings motions of twice the period are reached: the paper's smaller peaks and more.",
    )  # fmt: skip


def _epsilon_peak(epsilon: float, reach: float) -> tuple[float, float]:
    """Frequency and height of the main peak for another ε, cubic fit to ± ``reach`` half gaps."""
    line = published()
    return multiple_scales(line, epsilon=epsilon, fit_range=reach * line.breakpoints[1]).response(0.1, 8).peak


def _epsilons(used: float) -> Comparison:
    rows = []
    for epsilon in (1e-4, 0.01, 0.1, 1.0):
        f, a = _epsilon_peak(epsilon, used)
        rows.append(Row(f"ε = {epsilon:g}", "Figure 2" if epsilon == 0.01 else "—", f"peak {a:.8f} at {f:.8f}"))
    return Comparison(
        f"Other ε, cubic fit to ±{used:g} b", tuple(rows),
        "ε scales U, μ, σ and B* so that it drops out of u(t): a small ε does not make the nonlinearity weak.",
    )  # fmt: skip


def _off(response: ApproximateResponse, truth: FrequencyResponse) -> tuple[float, float]:
    """Relative errors of the main peak: height, place."""
    return response.peak[1] / truth.peak[1] - 1, response.peak[0] / truth.peak[0] - 1


def _ranges(by_range: dict[float, ApproximateResponse], off: dict[float, tuple[float, float]]) -> Comparison:
    rows = [
        Row(f"fit to ±{r:g} b", "not stated", f"peak {a.peak[1]:.4f} at {a.peak[0]:.4f}",
            f"height {100 * off[r][0]:+.1f} %, place {100 * off[r][1]:+.1f} %; {a.note}")
        for r, a in by_range.items()
    ]  # fmt: skip
    return Comparison(
        "The range of the cubic fit", tuple(rows),
        "Least squares, evenly over the range. The truth is in the first table; its peak is 4 b high.",
    )  # fmt: skip


def _errata() -> Comparison:
    rows = (
        Row("(13)", "λ₁²T² = 1", "λ₁T² = 1", "λ₁ already is a frequency squared"),
        Row("(50), (63)", "B₁²T²/(4ω²ε²)", "B₁²T⁴/(4ε²U²)", "from (18) and (49)"),
        Row("(51), (52)", "U² = ελ₁²/λ₂, T² = 1/λ₁²", "U² = ελ₁/λ₂, T² = 1/λ₁", "as (13)"),
        Row("(9)", "range not stated", "decides the answer", "see the table of ranges"),
    )
    return Comparison("Misprints", rows)


def _conclusions(
    found: ResponseComparison,
    off: dict[float, tuple[float, float]],
    doubled: FrequencyResponse,
    trends: dict[str, tuple[float, float]],
    reached: Basins,
    sweeps: tuple[Sweep, Sweep],
) -> tuple[Conclusion, ...]:
    exact, simple = found["exact"], found["describing function"]
    at, size = exact.peak
    good = [r for r, errors in off.items() if max(map(abs, errors)) <= ACCURATE]
    words = "; ".join(f"±{r:g} b: {100 * h:+.1f} %, {100 * w:+.1f} %" for r, (h, w) in off.items())
    small = [_peaks(r) for r in (exact, simple)]
    alike = max(
        abs(found["averaging"].peak[i] / found["multiple scales"].peak[i] - 1) for i in (0, 1)
    )  # fmt: skip
    tops = [_epsilon_peak(e, 5.0)[1] for e in (1e-4, 0.01, 0.1, 1.0)]
    spread = max(tops) / min(tops) - 1
    return (
        Conclusion(
            "Multiple scales and averaging find height and place of the main peak with very good accuracy.",
            _of_all(len(good), len(off)),
            f"The truth is {size:.4f} at {at:.4f}. It hangs on the range of the cubic fit, which the paper does not "
            f"state; errors of height and place: {words}. Within {100 * ACCURATE:g} % in both: "
            f"{', '.join(f'±{r:g} b' for r in good) or 'none'}. Averaging the exact force needs no fit: "
            f"{100 * (simple.peak[1] / size - 1):+.1f} % and {100 * (simple.peak[0] / at - 1):+.2f} %.",
        ),
        Conclusion(
            "They cannot find the smaller peaks.",
            CONFIRMED if small[0] and not small[1] else CORRECTED,
            f"Exact response below ω = {SMALL:g}: {_small(exact)}, and between these motions of twice the period up to "
            f"{doubled.peak[1]:.3f} at {doubled.peak[0]:.3f}; one harmonic has none there: {_small(simple)}. "
            "The first peak is superharmonic; where the period doubles the simple motion is unstable.",
        ),
        Conclusion(
            "The same result of both derivations proves it right.",
            CORRECTED if alike < 1e-9 and len(good) < len(off) else CONFIRMED,
            f"They are the same first order of one cubic, equal to {rounded(alike)}, and wrong by the figures above.",
        ),
        Conclusion(
            "With ε = 0.01 the nonlinearity is weak (Figure 2).",
            CORRECTED if spread < 1e-6 else UNDECIDED,
            f"ε = 1e-4, 0.01, 0.1 and 1 give the same peak to {rounded(spread)}: it scales U, μ, σ and B* and "
            "drops out of u(t).",
        ),
        _trend("damping", [trends["1.5 times the damping"]]),
        _trend("backlash", [trends["half the backlash"], trends["twice the backlash"]]),
        Conclusion(
            "Beside the paper: which motion is reached decides how it rattles.",
            ADDED,
            f"Energy of the impacts per period: up to {np.nanmax(sweeps[0].impact_energy):.2g} on the sweep up, "
            f"{np.nanmax(sweeps[1].impact_energy):.2g} on the sweep down; at ω = 0.8 {_reached(reached)}.",
        ),
    )


def _trend(what: str, heights: list[tuple[float, float]]) -> Conclusion:
    """Whether the formula's peak follows a parameter: the same way, and at least half as far as the exact one."""
    follows = [(f - 1) * (t - 1) > 0 and abs(f - 1) > abs(t - 1) / 2 for f, t in heights]
    said = "; ".join(f"{100 * (f - 1):+.0f} % by the formula, {100 * (t - 1):+.0f} % exact" for f, t in heights)
    changed = {"damping": "1.5 times the damping", "backlash": "Half and twice the backlash"}[what]
    why = ": a fit whose range scales with b leaves the height where it was" if not any(follows) else ""
    return Conclusion(
        f"The formula shows what {what} does to the response, so that a designer can avoid resonance.",
        _of_all(sum(follows), len(follows)),
        f"{changed}, fit to ±{FITTED:g} b: height of the main peak {said}{why}.",
    )


def _of_all(count: int, total: int) -> str:
    """A claim that holds in all cases, in none, or in some of those the paper leaves open."""
    return CONFIRMED if count == total else CORRECTED if count == 0 else UNDECIDED


def _reached(found: Basins) -> str:
    """Shares of the starts, evenly spaced, from which each motion is reached."""
    shares = [100 * float(share) for share in found.shares]
    errors = [np.sqrt(s * (100 - s) / found.number.size) for s in shares]
    words = " and ".join(f"{s:.1f} ± {e:.1f} %" for s, e in zip(shares, errors, strict=True))
    return f"its motions are reached from {words} of the starts within ±1"


FITTED = 8.0
"""Half length of the fit [b] behind the claims on backlash and damping: near the truth for the paper's numbers."""


def _trends() -> dict[str, tuple[float, float]]:
    """Height of the main peak over that of Table 1, first order and exact, for other backlash and damping."""
    changed: dict[str, dict[str, float]] = {
        "half the backlash": {"half_gap": published().breakpoints[1] / 2},
        "twice the backlash": {"half_gap": published().breakpoints[1] * 2},
        "1.5 times the damping": {"damping": 1.5 * published().damping},
    }
    bases = _heights({})
    found = {}
    for words, change in changed.items():
        first, exact = _heights(change)
        found[words] = first / bases[0], exact / bases[1]
    return found


def _heights(change: dict[str, float]) -> tuple[float, float]:
    line = published(**change)
    first = multiple_scales(line, fit_range=FITTED * line.breakpoints[1]).response(0.1, 8.0)
    return first.peak[1], frequency_response(line, 0.5, HIGH).peak[1]


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

"""The papers' tables of resonance speeds against computed frequencies and computed tongues."""

from __future__ import annotations

import numpy as np

from trunnion.modes.resonance_speeds import Resonance, resonance_speeds
from trunnion.papers.shared.result import ComparisonTable, TableRow
from trunnion.papers.shared.tips import FOLLOWED, Tip, tip
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict

Printed = tuple[str, tuple[int, ...], int, float]
"""Kind, modes, order k and the value a paper prints."""


def resonance_table(
    title: str,
    printed: tuple[Printed, ...],
    charts: tuple[StabilityChart, ...],
    faint: tuple[StabilityChart, ...],
    note: str,
) -> ComparisonTable:
    """Printed resonance speeds, one a row.

    Parameters
    ----------
    charts : the paper's, speed × angle; the one that holds the speed best is used, and its pixels.
    faint : the same line with a hundredth of the damping, in which tongues start near β = 0.
    """
    return ComparisonTable(title, tuple(_row(one, charts, faint) for one in printed), note)


def _row(printed: Printed, charts: tuple[StabilityChart, ...], faint: tuple[StabilityChart, ...]) -> TableRow:
    kind, modes, order, value = printed
    assert charts[0].line is not None
    every = tuple(resonance_speeds(charts[0].line, max(3, order)))
    named = next(r for r in every if (r.kind, r.modes, r.order) == (kind, modes, order))
    others = tuple(r.speed for r in every if r.kind == kind and r is not named)
    computed = f"{named.speed:.5f}"
    off = "" if abs(named.speed - value) < 0.6e-3 else f"printed {value - named.speed:+.4f} off; "
    pixel = float(np.diff(_holding(charts, named).x).max())
    if kind == "difference":
        return TableRow(f"{named}", f"{value:.3f}", computed, off + _stays_shut(_holding(charts, named), named, pixel))
    at, low = (tip(_holding(group, named), named, others) for group in (charts, faint))
    return TableRow(f"{named}", f"{value:.3f}", computed, off + _tongue(at, low, pixel))


def _holding(charts: tuple[StabilityChart, ...], named: Resonance) -> StabilityChart:
    """The chart that holds the speed deepest inside its range."""
    return max(charts, key=lambda c: min(named.speed - c.x[0], c.x[-1] - named.speed))


def _tongue(at: Tip, low: Tip, pixel: float) -> str:
    if not low.found:
        return "so narrow that nothing shows, even at a hundredth of the damping"
    if low.angle > FOLLOWED:
        return (
            f"opens above β = {low.angle:.1f} rad only, even at a hundredth of the damping: "
            "its speed at β → 0 is not seen"
        )
    limit = low.intercept if np.isfinite(low.intercept) else low.speed
    away = limit - low.resonance.speed
    where = f"within a pixel of {pixel:.4f}" if abs(away) <= pixel else f"{away:+.4f} from its name"
    text = f"tongue for β → 0 at {limit:.4f}, {where}"
    return text + (
        f"; at ζ = 0.001 its tip is ({at.speed:.4f}, {at.angle:.2f} rad)"
        if at.found
        else "; closed by damping at ζ = 0.001"
    )


def _stays_shut(chart: StabilityChart, named: Resonance, pixel: float) -> str:
    """How far up the column about a difference resonance is stable."""
    fine = chart.zoom(
        (max(named.speed - pixel, float(chart.x[0])), named.speed + pixel, 41),
        (float(chart.y[0]), float(chart.y[-1]), 201),
    )
    rows = np.flatnonzero(np.any(fine.verdict == Verdict.UNSTABLE, axis=1))
    reach = float(fine.y[rows[0]] if len(rows) else fine.y[-1])
    tail = ", where another tongue passes" if len(rows) else ", the top of the chart"
    return f"does not open: stable within a pixel of it up to β = {reach:.2f} rad{tail}"


def frequency_rows(place: str, printed: tuple[float, ...], computed: np.ndarray, remark: str) -> tuple[TableRow, ...]:
    """Natural frequencies as printed and computed."""
    below = str.maketrans("123", "₁₂₃")
    return tuple(
        TableRow(
            f"{place}, ω{str(i).translate(below)}",
            f"{p:.3f}",
            f"{w:.5f}",
            remark if abs(p - w) > 0.6e-3 else "agrees",
        )
        for i, (p, w) in enumerate(zip(printed, computed, strict=True), start=1)
    )

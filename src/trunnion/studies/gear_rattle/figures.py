"""Pictures of the gear pair's frequency response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trunnion.arrays import Array
from trunnion.motion.orbits.basins import Basins
from trunnion.motion.orbits.frequency_response import FrequencyResponse, ResponseComparison
from trunnion.motion.orbits.sweep import OscillatorSweep
from trunnion.motion.perturbation.slow_flow import ApproximateResponse
from trunnion.plots.frequency_response import DASHED, draw_basins, draw_responses
from trunnion.plots.style import ACCENT, FAINT, INK, SMALL, TEXT, TITLE, VERMILION, label_axes, new_axes

RIGHT = 2.0
"""Highest frequency of the picture of ranges."""
DRAWN = (2.0, 3.0, 4.0, 5.0, 8.0)
"""Ranges of the fit in that picture; the table has all."""

FREQUENCY = "frequency ω, dimensionless"


def methods_figure(found: ResponseComparison, title: str, doubled: Sequence[FrequencyResponse] = ()) -> Figure:
    """All methods on one picture, and the exact motions of twice the period."""
    axes = found.plot(new_axes(8.4, 5.6), length="rad", unit="", top=0.95)
    for response in doubled:
        words = "exact, twice the period" if response is doubled[0] else None
        for part, style in ((response.stable, "-"), (~response.stable, DASHED)):
            size = np.where(part, response.half_peak_to_peak, np.nan)
            axes.plot(response.frequency, size, color=FAINT, lw=2.2, ls=style, label=words, zorder=1.5)
            words = None
    axes.set_xlabel(FREQUENCY, fontsize=TEXT, color=INK)
    axes.legend(fontsize=SMALL, frameon=False, loc="upper right")
    axes.set_title(title, fontsize=TITLE, color=INK)
    return axes.figure.figure


def ranges_figure(exact: FrequencyResponse, by_range: Mapping[float, ApproximateResponse]) -> Figure:
    """First order for several ranges of the cubic fit, beside the exact response."""
    axes = draw_responses({"exact": exact}, new_axes(8.4, 5.2), length="rad", unit="", marks=False)
    drawn = {gaps: response for gaps, response in by_range.items() if gaps in DRAWN}
    looks = zip(("#cc79a7", "#d55e00", "#e69f00", "#009e73", "#56b4e9"), ("-", "-.", ":", "-", "-."), strict=True)
    for (gaps, response), (colour, style) in zip(drawn.items(), looks, strict=False):
        stable = response.stable
        upper = np.where(stable, response.amplitude, np.nan)
        axes.plot(response.frequency, upper, label=f"fit to ±{gaps:g} b", color=colour, ls=style, lw=1.8)
        axes.plot(response.frequency, np.where(~stable, response.amplitude, np.nan), color=colour, lw=1, ls=(0, (4, 2)))
    axes.set_xlim(0.2, RIGHT)
    axes.set_ylim(0, 1.1)
    for response in drawn.values():
        _beyond(axes, response)
    axes.set_xlabel(FREQUENCY, fontsize=TEXT, color=INK)
    axes.legend(fontsize=SMALL, frameon=False, loc="upper left")
    axes.set_title("Multiple scales: the range of the cubic fit decides", fontsize=TITLE, color=INK)
    return axes.figure.figure


def _beyond(axes: Axes, response: ApproximateResponse) -> None:
    """Where the peak of a curve lies that leaves the picture."""
    at, size = response.peak
    if at > RIGHT:
        edge = float(np.interp(RIGHT, *_rising(response)))
        words = f"to {size:.2f} at ω = {at:.1f}"
        axes.text(RIGHT - 0.02, edge + 0.03, words, ha="right", fontsize=SMALL, color=INK)


def _rising(response: ApproximateResponse) -> tuple[Array, Array]:
    """The upper stable branch, by rising frequency."""
    whole = np.flatnonzero(response.stable & (response.amplitude > response.peak[1] / 4))
    order = whole[np.argsort(response.frequency[whole])]
    return response.frequency[order], response.amplitude[order]


def index_figure(up: OscillatorSweep, down: OscillatorSweep) -> Figure:
    """Rattle index over frequency, swept both ways."""
    axes = new_axes(8.0, 4.4)
    for one, shape, colour in ((up, "^-", VERMILION), (down, "v-", ACCENT)):
        words = "sweep up" if one.up else "sweep down"
        look: dict[str, Any] = {"ms": 3.5, "lw": 1.2, "mfc": "none", "markevery": 0.02}
        axes.plot(one.frequency, one.impact_energy, shape, color=colour, label=words, **look)
    label_axes(axes, FREQUENCY, "energy of the impacts per period, Σ I v²/2")
    axes.set_ylim(bottom=0)
    axes.legend(fontsize=SMALL, frameon=False)
    axes.set_title("Rattle index, B₀ = 0.05", fontsize=TITLE, color=INK)
    return axes.figure.figure


def basins_figure(found: Basins) -> Figure:
    """Which motion is reached from where at ω = 0.8."""
    axes = draw_basins(found, new_axes(7.4, 5.2), length="rad")
    axes.set_ylabel("x′ at phase zero", fontsize=TEXT, color=INK)  # its time has no unit
    axes.set_title("Basins of attraction at ω = 0.8, B₀ = 0.05", fontsize=TITLE, color=INK)
    return axes.figure.figure

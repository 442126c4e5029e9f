"""Pictures of the gear pair's frequency response."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from trunnion.analyses.frequency_response import FrequencyResponse, ResponseComparison
from trunnion.analyses.piecewise_sweep import Basins, Sweep
from trunnion.analyses.slow_flow import ApproximateResponse
from trunnion.plots.frequency_response import draw_basins, draw_responses
from trunnion.plots.style import INK, SMALL, TEXT, TITLE, new_axes, plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def methods_figure(found: ResponseComparison, title: str) -> Figure:
    """All methods on one picture."""
    axes = found.plot(new_axes(8.4, 5.6), length="rad", top=0.95)
    axes.set_title(title, fontsize=TITLE, color=INK)
    return axes.figure.figure


def ranges_figure(exact: FrequencyResponse, by_range: Mapping[float, ApproximateResponse]) -> Figure:
    """First order for several ranges of the cubic fit, beside the exact response."""
    axes = draw_responses({"exact": exact}, new_axes(8.4, 5.2), length="rad", marks=False)
    for (gaps, response), colour in zip(by_range.items(), ("#cc79a7", "#d55e00", "#e69f00", "#009e73"), strict=False):
        stable = response.stable
        axes.plot(
            response.frequency, np.where(stable, response.amplitude, np.nan), color=colour, label=f"fit to ±{gaps:g} b"
        )
        axes.plot(response.frequency, np.where(~stable, response.amplitude, np.nan), color=colour, lw=1, ls=(0, (4, 2)))
    axes.set_xlim(0.2, 2.0)
    axes.set_ylim(0, 1.1)
    axes.legend(fontsize=SMALL, frameon=False, loc="upper left")
    axes.set_title("Multiple scales: the range of the cubic fit decides", fontsize=TITLE, color=INK)
    return axes.figure.figure


def index_figure(up: Sweep, down: Sweep) -> Figure:
    """Rattle index over frequency, swept both ways."""
    axes = new_axes(8.0, 4.4)
    for one, shape, colour in ((up, "^-", "#d55e00"), (down, "v-", "#0072b2")):
        words = "sweep up" if one.up else "sweep down"
        axes.plot(
            one.frequency,
            one.impact_energy,
            shape,
            color=colour,
            ms=3.5,
            lw=1.2,
            mfc="none",
            label=words,
            markevery=0.02,
        )
    axes.set_xlabel("frequency ω [rad/s]", fontsize=TEXT, color=INK)
    axes.set_ylabel("Σ I v²/2 of the impacts per period", fontsize=TEXT, color=INK)
    axes.set_ylim(bottom=0)
    axes.grid(which="major", color="#dddddd", lw=0.6)
    axes.legend(fontsize=SMALL, frameon=False)
    axes.set_title("Rattle index", fontsize=TITLE, color=INK)
    plain(axes)
    return axes.figure.figure


def basins_figure(found: Basins) -> Figure:
    """Which motion is reached from where at ω = 0.8."""
    axes = draw_basins(found, new_axes(7.4, 5.2))
    axes.set_title("Basins of attraction at ω = 0.8", fontsize=TITLE, color=INK)
    return axes.figure.figure

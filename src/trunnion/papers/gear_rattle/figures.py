"""Pictures of the gear pair's frequency response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.motion.orbits.basins import Basins
from trunnion.motion.orbits.frequency_response import FrequencyResponse, ResponseComparison
from trunnion.motion.orbits.sweep import OscillatorSweep
from trunnion.motion.perturbation.slow_flow import ApproximateResponse
from trunnion.pictures.frequency_response import basins, response, responses
from trunnion.pictures.picture import Axis, Item, Line, Picture, Texts, single

RIGHT = 2.0
"""Highest frequency of the picture of ranges."""
DRAWN = (2.0, 3.0, 4.0, 5.0, 8.0)
"""Ranges of the fit in that picture; the table has all."""

FREQUENCY = Axis("frequency ω, dimensionless")


def methods_figure(found: ResponseComparison, title: str, doubled: Sequence[FrequencyResponse] = ()) -> Picture:
    """All methods on one picture, and the exact motions of twice the period."""
    items: list[Item] = []
    for k, one in enumerate(doubled):
        words = "" if k else "exact, twice the period"
        for part, role in ((one.stable, "doubled"), (~one.stable, "doubled, unstable")):
            name = "" if part is not one.stable else words
            items.append(Line(one.frequency, np.where(part, one.half_peak_to_peak, np.nan), role, name))
    drawn = response(found, length="rad", unit="", top=0.95)
    named = drawn.with_panel(x=FREQUENCY, items=(*drawn.panel.items, *items), key="inside", title=title)
    return replace(named, width=8.4, height=5.6)


def ranges_figure(exact: FrequencyResponse, by_range: Mapping[float, ApproximateResponse]) -> Picture:
    """First order for several ranges of the cubic fit, beside the exact response."""
    drawn = responses({"exact": exact}, length="rad", unit="", marks=False)
    items: list[Item] = []
    for k, gaps in enumerate(g for g in by_range if g in DRAWN):
        one = by_range[gaps]
        for part, role, name in (
            (one.stable, f"fit {k}", f"fit to ±{gaps:g} b"), (~one.stable, f"fit, unstable {k}", "")
        ):  # fmt: skip
            items.append(Line(one.frequency, np.where(part, one.amplitude, np.nan), role, name))
        items += _beyond(one)
    named = drawn.with_panel(
        x=replace(FREQUENCY, low=0.2, high=RIGHT), y=replace(drawn.panel.y, high=1.1), key="inside",
        items=(*drawn.panel.items, *items), title="Multiple scales: the range of the cubic fit decides",
    )  # fmt: skip
    return replace(named, width=8.4, height=5.2)


def _beyond(response: ApproximateResponse) -> list[Item]:
    """Where the peak of a curve lies that leaves the picture."""
    at, size = response.peak
    if at <= RIGHT:
        return []
    edge = float(np.interp(RIGHT, *_rising(response)))
    return [Texts([RIGHT], [edge], [f"to {size:.2f} at ω = {at:.1f}"], beside="above left")]


def _rising(response: ApproximateResponse) -> tuple[Array, Array]:
    """The upper stable branch, by rising frequency."""
    whole = np.flatnonzero(response.stable & (response.amplitude > response.peak[1] / 4))
    order = whole[np.argsort(response.frequency[whole])]
    return response.frequency[order], response.amplitude[order]


def index_figure(up: OscillatorSweep, down: OscillatorSweep) -> Picture:
    """Rattle index over frequency, swept both ways."""
    items = [
        Line(one.frequency, one.impact_energy, f"index of {way}", way)
        for one, way in ((up, "sweep up"), (down, "sweep down"))
    ]
    energy = Axis("energy of the impacts per period, Σ I v²/2", low=0.0)
    return single(FREQUENCY, energy, items, 8.0, 4.4, "Rattle index, B₀ = 0.05", key="inside")


def basins_figure(found: Basins) -> Picture:
    """Which motion is reached from where at ω = 0.8."""
    drawn = basins(found, length="rad")
    up = Axis("x′ at phase zero")  # its time has no unit
    return replace(drawn.with_panel(y=up, title="Basins of attraction at ω = 0.8, B₀ = 0.05"), width=7.4, height=5.2)

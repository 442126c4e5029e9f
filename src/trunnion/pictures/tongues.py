"""Tongues as curves: their boundaries, tips and names, alone or over a stability chart; and windows between them."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.driveline.operating_speed import speed_unit
from trunnion.floquet.tongues.result import Tongue, Tongues
from trunnion.floquet.tongues.windows import StableWindows
from trunnion.pictures.picture import Axis, Item, Line, Picture, Points, Shapes, Spans, Texts, single
from trunnion.pictures.shared import axis_of
from trunnion.results.quantity_axes import QuantityAxis
from trunnion.results.words import Words

WIDE = 100.0
"""How many times the low end of a searched range the high end must be for a logarithmic axis."""
LEAP = 100.0
"""How many times steeper than on the whole an edge must run to count as leaping."""
LABELLED = 12
"""Names written at most: those of the fastest growth."""
NARROWER = "region narrower than a pixel"


def tongues(
    found: Tongues,
    *,
    unit: str | None = None,
    pixel: float | None = None,
    labelled: int = LABELLED,
    wide: bool = False,
) -> Picture:
    """Regions of instability over two parameters.

    Parameters
    ----------
    unit : of speeds; default the one of the description.
    pixel : distance of a chart's pixels along x (SI): tongues nowhere as wide are marked, as its picture may hide them.
    labelled : how many names are written.
    wide : whether y runs over powers of ten.
    """
    quantities = _quantities(found, unit)
    across, up = (axis_of(one, *ends) for one, ends in zip(quantities, (found.x_range, found.y_range), strict=True))
    if wide and up.low is not None and up.high is not None:
        up = up.logarithmic(up.low, up.high)
    scale = [one.factor for one in quantities]
    shapes = [tongue.boundary * scale for tongue in found]
    items: list[Item] = [Shapes(shapes, "tongue", says=[str(t.resonance or t.kind) for t in found])] if shapes else []
    items += _edges(found, *quantities, "tongue edge", pixel)
    items += _names(found, across, up, (scale[0], scale[1]), labelled)
    if not shapes:
        items.append(Texts([0.5], [0.5], ["no instability found"], "words", inside=True))
    return single(across, up, items, 6.3, 4.9, grid="")


def windows(found: StableWindows, *, unit: str | None = None, labelled: int = LABELLED) -> Picture:
    """The unstable regions over speed and parameter, and the windows in which every speed is stable."""
    low, high = found.tongues.y_range
    drawn = tongues(found.tongues, unit=unit, labelled=labelled, wide=0 < WIDE * low <= high)
    factor = Words().parameter(found.parameter, found.unit).factor
    free = Spans(np.reshape(found.windows, (-1, 2)) * factor, "window", on="y")
    return drawn.with_panel(items=(free, *drawn.panel.items))


def edges_of(found: Tongues, unit: str | None, pixel: float) -> list[Item]:
    """Edges of the tongues over a chart of the same axes, and marks at those that its pixels may hide."""
    return _edges(found, *_quantities(found, unit), "tongue over", pixel)


def _quantities(found: Tongues, unit: str | None) -> tuple[QuantityAxis, QuantityAxis]:
    unit = unit or (speed_unit(found.line) if found.line is not None else "rad/s")
    pairs = ((found.x_label, found.x_unit), (found.y_label, found.y_unit))
    return tuple(Words(unit).parameter(*pair) for pair in pairs)  # type: ignore[return-value]


def _edges(found: Tongues, across: QuantityAxis, up: QuantityAxis, role: str, pixel: float | None) -> list[Item]:
    items: list[Item] = []
    for tongue in found:
        for side in (tongue.low, tongue.high):
            shown = np.where(_leaps(side, tongue), np.nan, side) * across.factor
            items.append(Line(shown, tongue.y * up.factor, role, says=str(tongue.resonance or tongue.kind)))
    hidden = [] if pixel is None else found.narrower_than(pixel)
    if hidden:
        x, y = np.array([_middle(t) for t in hidden]).T
        items.append(Points(x * across.factor, y * up.factor, "narrow tongue", NARROWER))
    return items


def _leaps(side: Array, tongue: Tongue) -> Flags:
    """Where an edge leaps because another tongue joins or parts, so that no line is drawn across."""
    steps, apart = np.abs(np.diff(side)), np.abs(np.diff(tongue.y))
    steep = steps > LEAP * np.median(np.abs(side.max() - side.min()) / max(np.ptp(tongue.y), 1e-300)) * apart
    wide = steps > 0.3 * np.minimum(tongue.high - tongue.low, np.inf)[:-1]
    return np.append(steep & wide & (steps > 0.002 * np.ptp(tongue.boundary[:, 0])), False)


def _middle(tongue: Tongue) -> tuple[float, float]:
    k = len(tongue.y) // 2
    return float(tongue.low[k] + tongue.high[k]) / 2, float(tongue.y[k])


def _beginning(tongue: Tongue) -> tuple[float, float] | None:
    """Its tip, or from where on it is known."""
    faint = float(tongue.low[0] + tongue.high[0]) / 2, float(tongue.y[0])
    return faint if tongue.tip is None and "below" in tongue.fades else tongue.tip


def _names(found: Tongues, across: Axis, up: Axis, scale: tuple[float, float], most: int) -> list[Item]:
    """Names under the tips, leaving out those that would stand on another; ``scale`` are factors from SI."""
    taken: list[tuple[float, float]] = []
    items: list[Item] = []
    named = [(t.resonance, _beginning(t)) for t in found]
    for resonance, place in [one for one in named if None not in one][:most]:
        assert resonance is not None and place is not None
        at = place[0] * scale[0], place[1] * scale[1]
        right, top = float(across.share(at[0])), float(up.share(at[1]))
        if any(abs(right - a) < 0.13 and abs(top - b) < 0.06 for a, b in taken):
            continue
        taken.append((right, top))
        low = top < 0.05  # below it stand the numbers of the axis
        side = " left" if right > 0.92 else " right" if right < 0.08 or low else ""
        items.append(Texts([at[0]], [at[1]], [resonance.label], beside=("above" if low else "below") + side))
    return items

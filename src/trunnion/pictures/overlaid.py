"""Pictures of variants on the axes of one of them: what is a curve or a mark in the others lies upon it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trunnion.pictures.looks import VARIANTS
from trunnion.pictures.picture import Axis, Item, Key, Level, Line, Panel, Picture, Points

CURVES = (Line, Points, Level)
"""What is laid upon another picture; areas and words would hide it."""


@dataclass(frozen=True)
class LargestOf:
    """The largest size of a curve in the pictures of two variants, and where along x, in the units of the axes."""

    curve: str
    unit: str
    at_unit: str
    now: float
    at: float
    other: float
    other_at: float

    @property
    def share(self) -> float:
        """By what share of the other the present one is larger; NaN where that is zero."""
        return self.now / self.other - 1 if self.other else float("nan")


def can_lie_upon(own: Panel, other: Panel) -> bool:
    """Whether two panels have the same axes, so that numbers of one are numbers of the other."""
    alike = all(
        (a.words, a.unit, a.scale, tuple(a.names)) == (b.words, b.unit, b.scale, tuple(b.names))
        for a, b in ((own.x, other.x), (own.y, other.y))
    )
    return alike and own.frame and not own.polar and not own.even


def overlaid(own: Picture, others: Sequence[tuple[str, Picture]]) -> Picture:
    """A picture with the curves of those of other variants, by their names, in its panels of the same axes."""
    panels = list(own.panels)
    for number, (name, other) in enumerate(others[:VARIANTS]):
        for k, (panel, upon) in enumerate(zip(panels, other.panels, strict=False)):
            if not can_lie_upon(panel, upon):
                continue
            curves = [_of_variant(item, number) for item in upon.items if isinstance(item, CURVES)]
            if curves:
                both = panel.with_items(*curves, Key(f"variant {number}", name))
                panels[k] = replace(both, x=_widened(panel.x, upon.x), y=_widened(panel.y, upon.y))
    return replace(own, panels=tuple(panels))


def _of_variant(item: Item, number: int) -> Item:
    """A curve as one of a variant: in its own colour, with the dash of the variant, and no entry in the legend."""
    assert isinstance(item, CURVES)
    return replace(item, role=f"of variant {number}: {item.role}", name="")


def _widened(own: Axis, other: Axis) -> Axis:
    """An axis out to the ends of both, where they are stated."""
    if own.low is None or own.high is None or other.low is None or other.high is None:
        return replace(own, low=None, high=None) if None in (other.low, other.high) else own
    first, last = (min, max) if own.low <= own.high else (max, min)
    return replace(own, low=first(own.low, other.low), high=last(own.high, other.high))


def largest(own: Picture, other: Picture) -> Iterator[LargestOf]:
    """Of every curve that both pictures name, the largest size in each, with its place along x.

    Where several lines share a role, as the modes of a Campbell diagram do, a name stands for all of them and none is
    compared."""
    for panel, upon in zip(own.panels, other.panels, strict=False):
        if not can_lie_upon(panel, upon):
            continue
        named = {item.name: item for item in _alone(upon)}
        for item in _alone(panel):
            if item.name in named:
                now, before = _peak(item), _peak(named[item.name])
                if now and before:
                    yield LargestOf(item.name, panel.y.unit, panel.x.unit, now[1], now[0], before[1], before[0])


def _alone(panel: Panel) -> list[Line]:
    """Curves with a name that are the only ones of their role."""
    curves = [item for item in panel.items if isinstance(item, Line)]
    roles = [item.role for item in curves]
    return [item for item in curves if item.name and roles.count(item.role) == 1]


def _peak(item: Line) -> tuple[float, float] | None:
    """Place along x and size of the largest value of a curve, by its magnitude."""
    y = np.asarray(item.y, dtype=float)
    if not np.isfinite(y).any():
        return None
    k = int(np.nanargmax(np.abs(y)))
    return float(np.asarray(item.x, dtype=float)[k]), float(y[k])

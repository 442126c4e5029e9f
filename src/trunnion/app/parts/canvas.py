"""Where the page shows a picture: a figure for each of its panels, whose contents are replaced in place."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import panel as pn

from trunnion.app.parts.widgets import column
from trunnion.pictures.draw_bokeh import PIXELS, Drawn, height_of
from trunnion.pictures.overlaid import overlaid
from trunnion.pictures.picture import Item, Picture

BROAD, BROADER = 6.0, 1.3
"""Width [inches] from which on a picture fills the page, and how much broader than on paper a narrower one may be."""


class Canvas:
    """Panels of a picture below each other, none at first.

    on : what hears of events of a figure, by their class; name : of what the figures draw, for scripts of the page.
    """

    def __init__(self, on: Mapping[type, Callable[[Any], None]] | None = None, name: str = "") -> None:
        self.on, self.name, self.is_narrow = on or {}, name, False
        self.drawn: list[Drawn] = []
        self.panel = column(css_classes=["drawn"])
        self.own: tuple[Picture, tuple[Item, ...]] | None = None
        self.others: Sequence[tuple[str, Picture]] = ()

    def show(self, picture: Picture, *more: Item) -> None:
        """A picture, with ``more`` in each of its panels. Figures stay where it has the same kinds of axes."""
        self.own = picture, more
        self._draw(overlaid(picture, self.others), more)

    def lay_upon(self, others: Sequence[tuple[str, Picture]]) -> None:
        """What pictures of other variants, by their names, show on the same axes, from now on."""
        if self.own is not None and (others or self.others):
            self.others = others
            self._draw(overlaid(self.own[0], others), self.own[1])

    def _draw(self, picture: Picture, more: Sequence[Item]) -> None:
        panels, height = [panel.with_items(*more) for panel in picture.panels], height_of(picture)
        if [one.kind for one in self.drawn] != [Drawn.kind_of(panel, height) for panel in panels]:
            self.drawn = [Drawn(panel, height, self.name) for panel in panels]
            for one in self.drawn:
                one.narrow(self.is_narrow)
                for event, heard in self.on.items():
                    one.figure.on_event(event, heard)
            most = round(BROADER * PIXELS * picture.width) if picture.width < BROAD else None
            self.panel.objects = [
                pn.pane.Bokeh(one.figure, sizing_mode="stretch_width", max_width=most) for one in self.drawn
            ]
        else:
            for one, panel in zip(self.drawn, panels, strict=True):
                one.show(panel, height)

    def clear(self) -> None:
        """Show nothing."""
        self.own, self.others = None, ()
        self.drawn, self.panel.objects = [], []

    def narrow(self, is_narrow: bool) -> None:
        """Take half of the page, or all of it again."""
        self.is_narrow = is_narrow
        for one in self.drawn:
            one.narrow(is_narrow)

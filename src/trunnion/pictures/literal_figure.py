"""A figure that shows names as they are written, and that is drawn once when it is saved.

matplotlib reads ``$`` in any text as the start of mathematics and fails where that does not parse, so that a disk
called "load $a_$" would end in a traceback. Only numbers at ticks keep their mathematics: powers of ten.

To save a figure whose layout adapts to its texts, matplotlib draws it twice, the first time only to lay it out; laying
out needs the sizes of the texts and no drawing.
"""

from __future__ import annotations

from typing import Any

from matplotlib import rcParams
from matplotlib.artist import allow_rasterization
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import LogFormatter, ScalarFormatter


class LiteralFigure(Figure):
    """A ``Figure`` without mathematics in its texts, whoever draws or saves it."""

    _settled = False

    @allow_rasterization  # type: ignore[untyped-decorator]
    def draw(self, renderer: Any) -> None:
        """Draw everything, names as they are written."""
        literal(self)
        super().draw(renderer)

    def settle(self) -> None:
        """Give the axes the places that they will have when drawn."""
        engine = super().get_layout_engine()
        if engine is None:
            self.draw_without_rendering()
            return
        literal(self)
        engine.execute(self)

    def get_layout_engine(self) -> Any:
        """As ``Figure.get_layout_engine``; None while a figure is saved whose axes have their places."""
        return None if self._settled else super().get_layout_engine()

    def savefig(self, fname: Any, *, transparent: bool | None = None, **kwargs: Any) -> None:
        """As ``Figure.savefig``."""
        cut, engine = kwargs.get("bbox_inches", rcParams["savefig.bbox"]), super().get_layout_engine()
        if cut is not None or engine is None:  # what is cut out is measured on a drawing
            super().savefig(fname, transparent=transparent, **kwargs)
            return
        self.settle()
        self._settled = True
        try:
            super().savefig(fname, transparent=transparent, **kwargs)
        finally:
            self._settled = False
            self.set_layout_engine(engine)

    def get_tightbbox(self, renderer: Any = None, bbox_extra_artists: Any = None) -> Any:
        """As ``Figure.get_tightbbox``; it measures texts, so it must not read them as mathematics either."""
        literal(self)
        return super().get_tightbbox(renderer, bbox_extra_artists=bbox_extra_artists)


def literal(figure: Figure) -> None:
    """Switch mathematics off in all texts of ``figure`` but the numbers at its axes."""
    numbers = {text for axes in figure.axes for axis in _axes_of(axes) for text in _numbers(axis)}
    for text in figure.findobj(Text):
        assert isinstance(text, Text)
        text.set_parse_math(text in numbers)


def _axes_of(axes: Any) -> tuple[Any, ...]:
    """The x and y axis, and the z axis where there is one."""
    return tuple(axis for name in ("xaxis", "yaxis", "zaxis") if (axis := getattr(axes, name, None)) is not None)


def _numbers(axis: Any) -> tuple[Text, ...]:
    if not isinstance(axis.get_major_formatter(), LogFormatter | ScalarFormatter):  # names at the ticks
        return ()
    # Not by ``get_ticklabels``, which writes and places them all.
    ticks = (*axis.get_major_ticks(), *axis.get_minor_ticks())
    return (*(label for tick in ticks for label in (tick.label1, tick.label2)), axis.get_offset_text())

"""A figure that shows names as they are written.

matplotlib reads ``$`` in any text as the start of mathematics and fails where that does not parse, so that a disk
called "load $a_$" would end in a traceback. Only numbers at ticks keep their mathematics: powers of ten.
"""

from __future__ import annotations

from typing import Any

from matplotlib.artist import allow_rasterization
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import LogFormatter, ScalarFormatter


class LiteralFigure(Figure):
    """A ``Figure`` without mathematics in its texts, whoever draws or saves it."""

    @allow_rasterization  # type: ignore[untyped-decorator]
    def draw(self, renderer: Any) -> None:
        """Draw everything, names as they are written."""
        literal(self)
        super().draw(renderer)

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
    return (*axis.get_ticklabels(which="both"), axis.get_offset_text())

"""Figures as text inside a page: SVG as a data address, so that nothing is fetched and ids cannot clash."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

RASTER_DPI = 200
"""Of meshes inside an SVG: a chart stays sharp in print and small in the file."""


@dataclass(frozen=True)
class ReportPicture:
    """An image for a page: its address, words for those who cannot see it, a caption, the figure it shows."""

    address: str
    alt: str
    caption: str
    figure: Figure | None = field(default=None, repr=False, compare=False)


def picture(drawn: Figure | Axes, alt: str, caption: str = "") -> ReportPicture:
    """What is drawn as SVG; meshes in it as pixels."""
    figure = cast("Figure", drawn.figure).figure
    stream = io.BytesIO()
    figure.savefig(stream, format="svg", dpi=RASTER_DPI, metadata={"Date": None})
    return ReportPicture(address("image/svg+xml", stream.getvalue()), alt, caption, figure)


def address(kind: str, content: bytes) -> str:
    """``content`` as a data address of a page."""
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"

"""Pictures of the gallery: every figure that a variable of an example holds, or the axes of one, once."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

LOOK = {"dpi": 110, "facecolor": "white"}


def pictures(block: tuple[str, str, int], block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save them and give what shows them."""
    names = block_vars["example_globals"]
    figures: dict[int, Figure] = {}
    for thing in [*names.values()]:
        found = thing.get_figure() if isinstance(thing, Axes) else thing
        if isinstance(found, Figure) and not hasattr(found, "shown_in_gallery"):
            figures[id(found)] = found
    paths = []
    for figure, path in zip(figures.values(), block_vars["image_path_iterator"], strict=False):
        figure.savefig(path, **LOOK)
        figure.shown_in_gallery = True  # type: ignore[attr-defined]
        paths.append(path)
    plt.close("all")
    return str(figure_rst(paths, gallery_conf["src_dir"]))

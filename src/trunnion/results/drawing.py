"""How a result finds its drawing: in ``trunnion.registry``, by its class and method."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from trunnion.registry import PICTURES, found_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:  # what draws takes long to load, and results are drawn seldom
    Axes = Figure = Any


def drawing(result: object, method: str) -> Callable[..., Any]:
    """The function that draws ``method`` of ``result``. A result knows no picture; pictures know results."""
    keys = (f"{kind.__name__}.{method}" for kind in type(result).__mro__)
    found: Callable[..., Any] = found_at(PICTURES[next(key for key in keys if key in PICTURES)])
    return found

"""How a result finds its picture: in ``trunnion.registry``, by its class, or what that is a kind of, and method."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from trunnion.registry import PICTURES, found_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:  # what draws takes long to load, and results are drawn seldom
    Axes = Figure = Any


def described(result: object, method: str) -> Callable[..., Any]:
    """The function that describes what ``method`` of ``result`` draws: pictures know results, not the reverse."""
    keys = (f"{kind.__name__}.{method}" for kind in type(result).__mro__)
    found: Callable[..., Any] = found_at(PICTURES[next(key for key in keys if key in PICTURES)])
    return found


def drawing(result: object, method: str) -> Callable[..., Any]:
    """The function that draws ``method`` of ``result``, into axes where it is given any, by Matplotlib."""

    def draw(of: object, axes: Axes | None = None, **options: Any) -> Any:
        picture = described(result, method)(of, **options)
        return import_module("trunnion.pictures.draw_matplotlib").draw(picture, axes)

    return draw

"""How a result finds its drawing: in the table that ``trunnion.plots`` keeps, by its class and method."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:  # what draws takes long to load, and results are drawn seldom
    Axes = Figure = Any


def drawing(result: object, method: str) -> Callable[..., Any]:
    """The function that draws ``method`` of ``result``. A result knows no picture; pictures know results."""
    drawings: dict[str, str] = import_module("trunnion.plots").DRAWINGS
    keys = (f"{kind.__name__}.{method}" for kind in type(result).__mro__)
    module, name = next(drawings[key] for key in keys if key in drawings).split(":")
    found: Callable[..., Any] = getattr(import_module(module), name)
    return found

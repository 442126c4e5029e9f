"""What one quantity follows: bars by the change that a usual step of every parameter makes, the largest on top."""

from __future__ import annotations

from matplotlib.axes import Axes

from trunnion.design.sensitivity.result import Quantity, Sensitivities, share_of, smaller, too_large
from trunnion.errors import InputError
from trunnion.plots.style import (
    ACCENT,
    INK,
    TEXT,
    UNBROKEN,
    VERMILION,
    head,
    key_below,
    new_axes,
    printed,
    rows_of_names,
)

SHOWN = 10
"""Parameters shown at most."""
FIRST = ("check", "torque", "growth rate", "tip", "frequency")
"""Kinds of quantities in the order in which one is chosen to be drawn."""


def draw(found: Sensitivities, quantity: str | None = None, axes: Axes | None = None, *, most: int = SHOWN) -> Axes:
    """A tornado of ``quantity``, by default of the first check, torque or growth rate that follows several parameters.

    Every bar goes to both sides: what the step upwards and the one downwards make of the quantity.
    """
    chosen = found.quantity(quantity) if quantity is not None else _chosen(found)
    effects = found.ranked(chosen.name, most)
    if not effects:
        why = chosen.refused or "follows none of the parameters"
        raise InputError(f"has nothing to draw: {why}", key="quantity", value=chosen.name, remedy="name another one")
    alone = axes is None
    axes = axes if axes is not None else new_axes(7.2, 1.8 + 0.36 * len(effects))
    factor, label = share_of(chosen)
    tenths = too_large(chosen, effects[0].change)
    for place, one in enumerate(effects):
        size = one.change * factor / 10**tenths
        axes.barh(place, size, color=ACCENT, height=0.62, label="step upwards" if not place else None)
        axes.barh(place, -size, color=VERMILION, alpha=0.55, height=0.62, label="step downwards" if not place else None)
    axes.axvline(0.0, color=INK, lw=1.0)
    steps = [smaller(e.step_words, tenths).replace("+", "±").replace(" ", UNBROKEN) for e in effects]
    names = [f"{e.parameter} ({step})" for e, step in zip(effects, steps, strict=True)]
    rows_of_names(axes, names, f"change{label}")
    title = f"{chosen.name}: {printed(found.shown(chosen))}"
    if alone:
        head(axes.figure.figure, title, TEXT)
    else:
        axes.set_title(title, fontsize=TEXT, color=INK, loc="left")
    key_below(axes, 2, loc="outside lower right", labelcolor=INK)
    return axes


def _chosen(found: Sensitivities) -> Quantity:
    """The first that follows several parameters; an angle, which only follows itself, needs no picture."""
    for several in (2, 1):
        for kind in FIRST:
            for one in found.quantities:
                if one.kind == kind and len(found.ranked(one.name, several)) == several:
                    return one
    if not found.quantities:
        raise InputError("holds no quantity to draw", element="sensitivity", remedy="ask for frequencies, say")
    return found.quantities[0]

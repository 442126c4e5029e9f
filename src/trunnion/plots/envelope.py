"""Margins of checks along a schedule: where in the travel, or at which speed, each binds."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from trunnion.design.envelope import Envelope
from trunnion.errors import InputError
from trunnion.plots.style import INK, key_below, label_axes, new_axes
from trunnion.results.speeds import speed_factor

SHOWN = 6
"""Checks at most, the worst ones."""
WORST, BEST = -100.0, 100.0
"""Margins [%] beyond these stand at the edge."""
MARKS = ("o", "s", "^", "D", "v", "P")


def draw(found: Envelope, axes: Axes | None = None, *, schedule: str = "") -> Axes:
    """Margin of the worst checks over travel or speed of one schedule (default: where the binding check is worst)."""
    named = list(dict.fromkeys(p.schedule for p in found.places if p.schedule))
    if not named:
        remedy = "state [[operation.schedule]]; str(result) says what load cases do"
        raise InputError("has nothing to draw: no schedule is judged", element="envelope", remedy=remedy)
    if schedule and schedule not in named:
        raise InputError("is not judged", key="schedule", value=schedule, remedy=f"choose {named[0]}, say")
    bound = found.places[found.where[0]].schedule if found.where else ""
    chosen = schedule or bound or named[0]
    here = [k for k, p in enumerate(found.places) if p.schedule == chosen and p.along is None]
    over = found.places[here[0]].over
    factor, label = (
        (speed_factor(found.unit), f"input speed [{found.unit}]") if over == "speed" else (1e3, "travel [mm]")
    )
    x = np.array([found.places[k].value for k in here]) * factor
    axes = axes if axes is not None else new_axes(7.2, 4.0)
    margins = found.margin[here]
    with_margin = [c for c in range(margins.shape[1]) if np.isfinite(margins[:, c]).any()]
    for n, c in enumerate(with_margin[:SHOWN]):
        axes.plot(x, np.clip(100 * margins[:, c], WORST, BEST), marker=MARKS[n], ms=5, label=found.checks[c].name)
    axes.axhline(0.0, color=INK, lw=1.0)
    far = np.nanmax(np.abs(100 * margins[:, with_margin[:SHOWN]]), initial=0.0) > BEST
    label_axes(axes, f"{label}, {chosen}", "margin [%]" + "\n(beyond ±100 at the edge)" * bool(far))
    key_below(axes, 2, loc="outside lower right", labelcolor=INK)
    return axes

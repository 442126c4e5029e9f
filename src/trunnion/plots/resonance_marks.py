"""Named resonance speeds along the edge of a chart, spread so that no two names touch.

Each name stands outside the frame, joined to its speed by a leader; where names are crowded they are pushed
apart, and where they do not all fit the lowest orders stay.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Annotation, Text
from matplotlib.transforms import ScaledTranslation

from trunnion.modes.resonance_speeds import Resonance
from trunnion.plots.style import FAINT, INK, SMALL

PITCH = 1.45
"""Room for one name, in heights of its text."""
LEADER = 12
"""Length of the leader [pt]."""


def mark_resonances(axes: Axes, resonances: Iterable[Resonance], factor: float, *, along: str) -> float:
    """Mark those that can open and lie inside the axis ``along`` ("x": on top, "y": at the right).

    ``factor`` turns rad/s into the axis' numbers. Call it when limits and size of the axes are settled.
    Returns the room that the names take outside the frame [pt].
    """
    place = _place(axes, along)
    low, high = sorted(axes.get_xlim() if along == "x" else axes.get_ylim())
    inside = [r for r in resonances if r.opens and low <= r.speed * factor <= high]
    inside.sort(key=lambda r: (r.order, r.kind != "subharmonic", r.speed))
    extent = axes.get_window_extent()
    pixels = extent.width if along == "x" else extent.height
    pitch = PITCH * SMALL / (72 * pixels / axes.figure.dpi)
    kept = sorted(inside[: int(1 / pitch)], key=lambda r: r.speed)
    exact = np.array([place(r.speed * factor) for r in kept])
    names = [
        _mark(axes, r, float(at), float(name_at), along)
        for r, at, name_at in zip(kept, exact, spread(exact, pitch), strict=True)
    ]
    deepest = max((Text.get_window_extent(name) for name in names), key=lambda b: b.height, default=None)
    return 0.0 if deepest is None else LEADER + 72 * deepest.height / axes.figure.dpi


def spread(wanted: np.ndarray, pitch: float) -> np.ndarray:
    """Places in [0, 1] as near to the wanted ones (ascending) as a distance of ``pitch`` between them allows.

    Crowded names form blocks, each centred on the mean of its own wanted places.
    """
    blocks: list[list[float]] = []  # [sum of (wanted − offset within the block), members]
    starts: list[float] = []
    for value in wanted:
        blocks.append([float(value), 1])
        starts.append(float(value))
        while True:
            total, count = blocks[-1]
            starts[-1] = float(np.clip(total / count, 0.0, max(0.0, 1.0 - (count - 1) * pitch)))
            if len(blocks) < 2 or starts[-2] + blocks[-2][1] * pitch <= starts[-1] + 1e-12:
                break
            total, count = blocks.pop()
            starts.pop()
            before = blocks[-1]
            blocks[-1] = [before[0] + total - count * before[1] * pitch, before[1] + count]
    return np.array([s + i * pitch for s, (_, n) in zip(starts, blocks, strict=True) for i in range(int(n))])


def _place(axes: Axes, along: str) -> Callable[[float], float]:
    """From a value on the axis to its fraction of the axis, log or linear."""

    def fraction(value: float) -> float:
        corner = (value, axes.get_ylim()[0]) if along == "x" else (axes.get_xlim()[0], value)
        inside = axes.transAxes.inverted().transform(axes.transData.transform(corner))
        return float(inside[0 if along == "x" else 1])

    return fraction


def _mark(axes: Axes, resonance: Resonance, at: float, name_at: float, along: str) -> Annotation:
    top = along == "x"
    right, up = (0.0, LEADER / 72) if top else (LEADER / 72, 0.0)
    return axes.annotate(
        resonance.formula,
        xy=(at, 1.0) if top else (1.0, at),
        xycoords="axes fraction",
        xytext=(name_at, 1.0) if top else (1.0, name_at),
        textcoords=axes.transAxes + ScaledTranslation(right, up, axes.figure.dpi_scale_trans),
        rotation=90 if top else 0,
        ha="center" if top else "left",
        va="bottom" if top else "center",
        fontsize=SMALL,
        color=INK,
        arrowprops={
            "arrowstyle": "-", "color": FAINT, "lw": 0.7, "shrinkA": 1, "shrinkB": 0,
            "relpos": (0.5, 0.0) if top else (0.0, 0.5),
        },
    )  # fmt: skip

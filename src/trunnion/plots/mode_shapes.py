"""Mode shapes as small multiples: one column per mode, one row per inertia, from the drive downwards."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from trunnion.modes.natural_frequencies import NaturalFrequencies
from trunnion.plots.style import ACCENT, FAINT, INK, SMALL, TEXT, new_figure
from trunnion.results.speeds import show_speed, speed_factor

PER_ROW = 6
"""Modes side by side; more begin a new row of panels."""
ROW_HEIGHT = 0.27
"""Height of one inertia [inches]."""
WIDTH = 7.2


def draw(modes: NaturalFrequencies, *, unit: str = "Hz", drive: str | None = None) -> Figure:
    """Rotation of every inertia in every undamped mode, the largest drawn to full width; titles are damped frequencies.

    Parameters
    ----------
    modes : natural frequencies with their shapes.
    unit : of the frequencies.
    drive : name of the prescribed rotation in front of the line, drawn at rest; None leaves it out.
    """
    names = [*([drive] if drive else []), *modes.names]
    count, columns = len(modes.names), min(PER_ROW, len(modes.names))
    rows = -(-count // columns)
    height = rows * (ROW_HEIGHT * len(names) + 0.65) + 0.35
    figure = new_figure(WIDTH, height)
    grid: Any = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    place = np.arange(len(names))
    for i, axes in enumerate(grid.ravel()):
        if i >= count:
            axes.set_visible(False)
            continue
        shape = np.concatenate([[0.0] if drive else [], modes.shape[:, i]])
        axes.axvline(0.0, color=FAINT, lw=0.8)
        axes.hlines(place, 0.0, shape, color=ACCENT, lw=1.2)
        axes.plot(shape, place, "o-", color=ACCENT, ms=4.5, lw=0.9, mfc=ACCENT, mec="white", mew=0.6)
        frequency = _shown(modes, i, unit)
        axes.set_title(f"mode {i + 1}\n{frequency}", fontsize=SMALL, color=INK)
        axes.set_yticks(place, names, fontsize=SMALL)
        axes.set_xticks([-1, 0, 1], ["−1", "0", "1"], fontsize=SMALL - 1)
        axes.set_xlim(-1.15, 1.15)
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.tick_params(colors=INK, length=2.5)
        axes.grid(axis="y", color="#e4e4e4", lw=0.7)
        axes.set_axisbelow(True)
        for spine in axes.spines.values():
            spine.set_color(FAINT)
    figure.supxlabel("rotation, largest = 1", fontsize=TEXT - 1, color=INK)
    return figure


def _shown(modes: NaturalFrequencies, mode: int, unit: str) -> str:
    if modes.rigid_body and mode == 0:
        return "rigid body"
    if mode < modes.still:
        return "dragged by oil"
    if modes.overdamped[mode]:
        return "overdamped"
    frequency = float(modes.frequency[mode])
    if unit == "rad/s":
        return show_speed(float(f"{frequency:.4g}"), unit)
    return f"{frequency * speed_factor(unit):.4g} {unit}"

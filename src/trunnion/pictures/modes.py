"""Mode shapes as small multiples, and what stands at one point of a stability chart: multipliers and the mode."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from trunnion.modes.natural_frequencies import NaturalFrequencies
from trunnion.pictures.picture import Axis, Item, Level, Line, Panel, Picture, Points, rows, single
from trunnion.results.speeds import speed_factor
from trunnion.results.words import Words

PER_ROW = 6
"""Modes side by side; more begin a new row of panels."""
ROTATION = "rotation, largest = 1"
ROW_HEIGHT = 0.27
"""Height of one inertia [inches]."""


def mode_shapes(modes: NaturalFrequencies, *, unit: str = "Hz", drive: str | None = None) -> Picture:
    """Rotation of every inertia in every undamped mode, the largest drawn to full width; titles are damped frequencies.

    Parameters
    ----------
    unit : of the frequencies.
    drive : name of the prescribed rotation in front of the line, drawn at rest; None leaves it out.
    """
    panels = [_shape(modes, i, f"mode {i + 1}\n{_frequency(modes, i, unit)}", drive) for i in range(len(modes.names))]
    columns = min(PER_ROW, len(panels))
    height = -(-len(panels) // columns) * (ROW_HEIGHT * len(panels[0].y.names) + 0.65) + 0.35
    return Picture(panels, 7.2, height, columns, shared=True, x_words=ROTATION)


def mode_shape(modes: NaturalFrequencies, number: int, *, unit: str = "Hz") -> Picture:
    """One mode by its number from 1, or the last."""
    i = min(max(number, 1), len(modes.names)) - 1
    damping = f"damping ratio {modes.damping_ratio[i]:.3g}"
    words = f"mode {i + 1} of {len(modes.names)}: {_frequency(modes, i, unit)}, {damping}"
    panel = _shape(modes, i, words)
    panel = replace(panel, x=replace(panel.x, words=ROTATION))
    return Picture((panel,), 7.2, 1.3 + ROW_HEIGHT * len(panel.y.names))


def _shape(modes: NaturalFrequencies, mode: int, words: str, drive: str | None = None) -> Panel:
    """Rotations in one mode, inertias in rows."""
    names = [*([drive] if drive else []), *modes.names]
    shape = np.concatenate([[0.0] if drive else [], modes.shape[:, mode]])
    reach = [Line([0.0, turn], [k, k], "reach") for k, turn in enumerate(shape)]
    items: list[Item] = [Level(0.0, "rest", on="x"), *reach, Line(shape, np.arange(len(names)), "shape")]
    across = Axis(low=-1.15, high=1.15, ticks=(-1, 0, 1), names=("−1", "0", "1"))
    return Panel(across, rows(names), items, remark=words, key="", grid="y")


def _frequency(modes: NaturalFrequencies, mode: int, unit: str) -> str:
    if mode < modes.rigid_motions:
        return "rigid body"
    if mode < modes.still:
        return "dragged"
    if modes.overdamped[mode]:
        return "overdamped"
    frequency = float(modes.frequency[mode])
    if unit == "rad/s":
        return Words(unit).speed(float(f"{frequency:.4g}"))
    return f"{frequency * speed_factor(unit):.4g} {unit}"


def multipliers(found: Any) -> Picture:
    """Multipliers of a judged line in the plane of complex numbers, about the unit circle."""
    z, turn = np.asarray(found.multipliers), np.linspace(0, 2 * np.pi, 181)
    says = [f"modulus {abs(one):.6f}, {one.real:.5f} {one.imag:+.5f} i" for one in z]
    items: list[Item] = [Line(np.cos(turn), np.sin(turn), "line"), Points(z.real, z.imag, "multiplier", says=says)]
    far = 1.1 * max(1.0, float(np.abs(z).max(initial=0.0)))
    across, up = (Axis(words, "", -far, far) for words in ("real", "imaginary"))
    return single(across, up, items, 4.0, 4.0, "multipliers", even=True, key="")


def growing(found: Any) -> Picture:
    """The disturbance that grows fastest: rotations at the start of a period, and a quarter of a cycle later."""
    names = [str(n) for n in found.names]
    column = int(np.abs(np.abs(found.multipliers) - found.spectral_radius).argmin())  # those set aside may be larger
    mode = found.floquet_modes[: len(names), column]
    mode = mode / mode[np.argmax(np.abs(mode))] if np.any(mode) else mode
    place = np.arange(len(names))
    items: list[Item] = [
        Level(0.0, "rest", on="x"),
        Line(mode.real, place, "shape", "at the start"),
        Line(mode.imag, place, "shape later", "a quarter later"),
    ]
    across = Axis("rotation, largest 1", "", -1.15, 1.15)
    return single(across, rows(names), items, 7.2, 1.5 + ROW_HEIGHT * len(names), "what grows first", grid="y")

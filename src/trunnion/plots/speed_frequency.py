"""Speed–frequency diagram (Campbell): what the joints excite at each speed, and which modes that meets.

A joint whose shaft turns at R times the input excites with 2RΩ and, weaker, with 4RΩ. Where such a line
crosses a natural frequency the forced vibration is largest: Ω = ω_i/(2R) and ω_i/(4R).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.analyses.linear.natural_frequencies import natural_frequencies
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operation import Operation
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.plots.style import ACCENT, FAINT, INK, SMALL, TEXT, new_axes, plain
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ORDERS = (2, 4)
VERMILION = "#d55e00"
_SUBSCRIPT = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@dataclass(frozen=True)
class Crossing:
    """An excitation line meets a natural frequency: input speed and frequency [rad/s], order, mode from 1,
    speed ratio of the shaft, and whether a joint excites at that ratio."""

    speed: float
    frequency: float
    order: int
    mode: int
    ratio: float
    excited: bool


def crossings(line: Driveline | Assembly, low: float, high: float) -> tuple[Crossing, ...]:
    """Crossings of the 2Ω and 4Ω lines of every shaft with the modes between two input speeds [rad/s]."""
    assembly = assemble(line)
    excited, rates = shaft_ratios(assembly)
    modes = natural_frequencies(assembly)
    found = [
        Crossing(float(w) / (order * rate), float(w), order, i, rate, rate in excited)
        for i, w in enumerate(modes.frequency, start=1)
        for order in ORDERS
        for rate in rates
        if w > 0 and low <= w / (order * rate) <= high
    ]
    return tuple(sorted(found, key=lambda c: c.speed))


def shaft_ratios(assembly: Assembly) -> tuple[set[float], list[float]]:
    """Speed ratios over the input at which joints excite twice a turn, and those of all shafts, descending."""
    topo = assembly.topology
    excited = {abs(float(topo.speed_ratio[j])) for j in topo.joints if ORDERS[0] in topo.stations[j].orders}
    shafts = {abs(float(topo.speed_ratio[c.near])) for c in topo.compliances}
    return excited, sorted(excited | shafts, reverse=True)


def draw(
    line: Driveline | Assembly,
    axes: Axes | None = None,
    *,
    speeds: tuple[float, float],
    unit: str = "rpm",
    frequency_unit: str = "Hz",
    operating: Operation | None = None,
) -> Axes:
    """Draw the diagram for input speeds from ``speeds[0]`` to ``speeds[1]`` [rad/s].

    Parameters
    ----------
    unit, frequency_unit : of the two axes.
    operating : its speed is marked.
    """
    assembly = assemble(line)
    axes = axes or new_axes(7.2, 4.3)
    modes = natural_frequencies(assembly)
    excited, rates = shaft_ratios(assembly)
    x, y = speed_factor(unit), speed_factor(frequency_unit)
    high = speeds[1]
    top = 1.06 * max(ORDERS) * high * max(excited or set(rates) or {1.0})
    in_sight = modes.frequency[(modes.frequency > 0) & (modes.frequency < top)]
    left_out = int(np.count_nonzero(modes.frequency >= top))
    axes.set_xlim(0, high * x)
    axes.set_ylim(0, top * y)
    for rate in rates:
        for order in ORDERS:
            _excitation(axes, rate, order, high, top, (x, y), rate in excited)
    for w in modes.frequency:
        if 0 < w < top:
            axes.axhline(w * y, color=INK, lw=1.1)
    _name_modes(axes, modes.frequency, in_sight, top, y, frequency_unit)
    bar: dict[str, Any] = {"color": ACCENT, "lw": 3, "solid_capstyle": "butt", "clip_on": False, "zorder": 6}
    axes.plot([speeds[0] * x, speeds[1] * x], [0, 0], transform=axes.get_xaxis_transform(), **bar)
    met = [c for c in crossings(assembly, *speeds) if c.frequency < top and c.excited]
    for c in met:
        axes.plot(c.speed * x, c.frequency * y, "o", ms=6, mfc="white", mec=VERMILION, mew=1.6, zorder=5)
    if operating and operating.speed:
        axes.axvline(operating.speed * x, color=ACCENT, ls=(0, (5, 3)), lw=1.5)
    axes.set_xlabel(f"input speed [{unit}]", fontsize=TEXT, color=INK)
    axes.set_ylabel(f"frequency [{frequency_unit}]", fontsize=TEXT, color=INK)
    plain(axes)
    if left_out:
        which = f"{left_out} higher mode{'s lie' if left_out > 1 else ' lies'}" if len(in_sight) else "all modes lie"
        axes.text(
            0.012, 0.98, f"{which} above the diagram",
            transform=axes.transAxes, fontsize=SMALL, color=FAINT, va="top",
        )  # fmt: skip
    _key(
        axes, bool(operating and operating.speed), any(r not in excited for r in rates), bool(len(in_sight)), bool(met)
    )
    return axes


def _excitation(
    axes: Axes, rate: float, order: int, high: float, top: float, factor: tuple[float, float], excited: bool
) -> None:
    """One line through the origin, its name where it leaves the picture."""
    end = min(high, top / (order * rate))
    colour, width = (VERMILION, 1.5 if order == 2 else 1.1) if excited else (FAINT, 0.9)
    style = "-" if order == 2 else (0, (6, 2.5))
    axes.plot([0, end * factor[0]], [0, order * rate * end * factor[1]], color=colour, lw=width, ls=style)
    name = f"{order}Ω" if rate == 1 else f"{order}·{rate:.3g}Ω"
    at = 0.93 * end
    axes.annotate(
        name, (at * factor[0], order * rate * at * factor[1]), fontsize=SMALL, color=colour,
        ha="center", va="center", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.2}, zorder=6,
    )  # fmt: skip


def _name_modes(axes: Axes, every: np.ndarray, seen: np.ndarray, top: float, y: float, unit: str) -> None:
    """Names at the right edge, pushed apart where modes are close."""
    from trunnion.plots.resonance_marks import spread

    if not len(seen):
        return
    height = 72 * axes.get_window_extent().height / axes.figure.dpi
    pitch = 1.25 * SMALL / max(height * 0.8, 1.0)
    places = spread(np.sort(seen) / top, pitch)
    first = int(np.searchsorted(every, seen.min()))
    for k, (w, place) in enumerate(zip(np.sort(seen), places, strict=True), start=first + 1):
        axes.annotate(
            f"ω{k}".translate(_SUBSCRIPT) + f"  {w * y:.4g} {unit}",
            xy=(1.0, w / top), xycoords="axes fraction", xytext=(1.025, place), textcoords="axes fraction",
            fontsize=SMALL, color=INK, va="center", annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": FAINT, "lw": 0.6, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip


def _key(axes: Axes, operating: bool, silent: bool, modes: bool, met: bool) -> None:
    from matplotlib.lines import Line2D

    dashed = (0, (6, 2.5))
    handles = [
        Line2D([], [], color=VERMILION, lw=1.5, label="twice per turn of a joint"),
        Line2D([], [], color=VERMILION, lw=1.1, ls=dashed, label="four times"),
        Line2D([], [], color=ACCENT, lw=3, label="speed range"),
    ]
    if silent:
        handles.insert(2, Line2D([], [], color=FAINT, lw=0.9, label="the same, shaft without joint"))
    if modes:
        handles.insert(0, Line2D([], [], color=INK, lw=1.1, label="natural frequency"))
    if met:
        look: dict[str, Any] = {"ls": "none", "marker": "o", "mfc": "white", "mec": VERMILION, "mew": 1.6}
        handles.append(Line2D([], [], label="crossing in the range", **look))
    if operating:
        handles.append(Line2D([], [], color=ACCENT, ls=(0, (5, 3)), lw=1.5, label="operating speed"))
    axes.figure.figure.legend(
        handles=handles, loc="outside lower left", ncols=3, fontsize=SMALL, frameon=False, columnspacing=1.5
    )

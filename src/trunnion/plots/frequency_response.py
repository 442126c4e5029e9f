"""Frequency responses on one picture: stable full, unstable dashed, special points and jumps marked; basins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from trunnion.arrays import Array
from trunnion.motion.orbits.basins import Basins
from trunnion.motion.orbits.frequency_response import ResponseComparison
from trunnion.motion.orbits.sweep import LineSweep, OscillatorSweep, Sweep, abrupt_changes
from trunnion.plots.style import FAINT, INK, SMALL, key_below, label_axes, new_axes
from trunnion.results.speeds import speed_factor

STYLES = {
    "exact": ("#1a1a1a", 3.0),
    "shooting": ("#1a1a1a", 3.0),
    "harmonic balance": ("#56b4e9", 1.2),  # upon the exact curve, with which it coincides
    "describing function": ("#d55e00", 1.5),
    "averaging": ("#009e73", 3.6),  # beneath multiple scales, with which it coincides
    "multiple scales": ("#cc79a7", 1.5),
}
SWEEPS = {"sweep up": ("^", "#0072b2", 0.0), "sweep down": ("v", "#e69f00", 0.5)}
"""Shape, colour, and by what part of the distance between marks they begin later, not to hide each other."""
SWEPT = 36
"""Marks of a sweep, evenly over its range; it may have many more steps."""
MARKS = {"fold": "o", "period doubling": "s", "Neimark–Sacker": "D", "branch point": "*", "grazing": "x"}
DASHED = (0, (4, 2))
ARROW = {"arrowstyle": "-|>", "color": FAINT, "lw": 1.0}
JUMP = "jump of a slow sweep"
LOOSE = "not of one period"
CONTACTS = {"none": "#a6d5f2", "one-sided": "#e08a00", "two-sided": "#8c2d04"}
"""Darker with every side touched, so that they are told apart in grey too."""


def draw_responses(
    responses: Mapping[str, Any],
    axes: Axes | None = None,
    *,
    length: str = "",
    unit: str | None = None,
    marks: bool = True,
    jumps: bool = True,
    top: float | None = None,
) -> Axes:
    """Half peak-to-peak over frequency of several methods.

    Parameters
    ----------
    responses : method → response; the special points are those of the first that has any.
    length : unit of x, for the axis.
    unit : of the frequency, ``rad/s``, ``rpm`` or ``Hz``; "" for a number without one; default the description's.
    marks, jumps : draw special points; draw arrows where a slow sweep leaves a fold.
    top : of the vertical axis.
    """
    axes = axes or new_axes(7.2, 4.9)
    unit = next((getattr(r, "unit", "rad/s") for r in responses.values()), "rad/s") if unit is None else unit
    factor = speed_factor(unit) if unit else 1.0
    for name, response in responses.items():
        _curve(axes, name, response, factor)
    if any(not r.stable.all() for r in responses.values() if hasattr(r, "stable")):
        axes.plot([], [], color=FAINT, lw=1.2, ls=DASHED, label="unstable")
    marked = next((r for r in responses.values() if any(m[0] in MARKS for m in getattr(r, "marks", ()))), None)
    if marks and marked is not None:
        _special_points(axes, marked, factor)
        if jumps:
            _arrows(axes, marked, factor)
    of, what, own = _followed(responses)
    label_axes(axes, _with_unit(of, unit), _with_unit(f"half peak-to-peak of {what}", length or own))
    axes.set_ylim(bottom=0, top=top)
    axes.legend(fontsize=SMALL, frameon=False, loc="best", ncols=1)
    return axes


def _curve(axes: Axes, name: str, response: Any, factor: float) -> None:
    """One method: a line, full where stable and dashed where not; or the marks of a sweep."""
    frequency, size = response.frequency * factor, response.half_peak_to_peak
    if name in SWEEPS:
        shape, colour, later = SWEEPS[name]
        every = max(len(frequency) // SWEPT, 1)
        shown = slice(int(later * every), None, every)
        axes.plot(frequency[shown], size[shown], shape, color=colour, ms=4.5, mfc="none", mew=1.0, label=name, zorder=4)
        return
    colour, width = STYLES.get(name, (FAINT, 1.4))
    stable = response.stable
    axes.plot(frequency, np.where(_spread(stable), size, np.nan), color=colour, lw=width, label=name)
    axes.plot(frequency, np.where(~stable, size, np.nan), color=colour, lw=0.8 * width, ls=DASHED)


def _special_points(axes: Axes, response: Any, factor: float) -> None:
    for kind, shape in MARKS.items():
        points = [(f * factor, a) for k, f, a in response.marks if k == kind]
        if points:
            x, y = np.array(points).T
            axes.plot(x, y, shape, color=INK, ms=6, mfc="none", ls="", label=kind, zorder=5)


def _followed(responses: Mapping[str, Any]) -> tuple[str, str, str]:
    """What runs along the axis, what is drawn, and its unit; a driveline's branch knows better than the usual words."""
    first = next((r for r in responses.values() if hasattr(r, "detail")), None)
    detail = getattr(first, "detail", None)
    branch: Any = getattr(detail, "branch", detail)
    curve = getattr(first, "curve", "x")
    if getattr(branch, "curve_unit", "") == "N*m":
        return "input speed" if branch.label == "speed" else branch.label, f"the torque of {curve}", "N·m"
    return "frequency ω", curve, ""


def _spread(stable: Any) -> Any:
    """A stable stretch is drawn to the middle of its change of stability, so that no gap is left."""
    out = stable.copy()
    out[1:] |= stable[:-1]
    return out


def _arrows(axes: Axes, response: Any, factor: float) -> None:
    """From every fold to the stable motion that is left there: the nearest in size of the others."""
    drawn = False
    for kind, at, size in response.marks:
        if kind != "fold":
            continue
        side = 1e-4 * at
        left = [a for shift in (side, -side) for a, ok in response.at(at + shift) if ok and abs(a - size) > 0.1 * size]
        both = [a for a in left if abs(a - size) > 0.05 * max(left)]
        if both:
            landing = (
                max(both, key=lambda a: abs(a - size)) if len(both) == 1 else min(both, key=lambda a: abs(a - size))
            )
            arrow = {**ARROW, "shrinkA": 4, "shrinkB": 2}
            axes.annotate("", (at * factor, landing), (at * factor, size), arrowprops=arrow)
            drawn = True
    if drawn:
        _arrow_entry(axes, FAINT)


def _arrow_entry(axes: Axes, colour: str) -> None:
    """A line of the legend for the arrows, which have none of their own."""
    axes.plot([], [], color=colour, lw=1.0, marker=r"$\rightarrow$", ms=11, mew=0.2, ls="", label=JUMP)


def draw_sweeps(
    sweeps: Sequence[OscillatorSweep], axes: Axes | None = None, *, length: str = "", unit: str | None = None
) -> Axes:
    """Half peak-to-peak of sweeps, coloured by what is touched (full going up, hollow going down), jumps marked."""
    axes = axes or new_axes(7.2, 4.4)
    unit = sweeps[0].unit if unit is None else unit
    factor = speed_factor(unit) if unit else 1.0
    for one in sweeps:
        _draw_sweep_marks(axes, one, one.frequency * factor, one.peak_to_peak / 2, one.contact)
    words = _with_unit("half peak-to-peak of x", length)
    _label_sweeps(axes, _with_unit("frequency ω", unit), words, "contact, sweep")
    return axes


def draw_line_sweeps(
    sweeps: Sequence[LineSweep], axes: Axes | None = None, *, spring: str = "", unit: str | None = None
) -> Axes:
    """Peak-to-peak torque of one spring over speed, in the manner of ``draw_sweeps``; by default the first with a gap.

    Raises
    ------
    InputError : no such spring.
    """
    axes = axes or new_axes(7.2, 4.4)
    line = sweeps[0].line
    unit = unit or sweeps[0].unit
    name = spring or line.springs[line.staged[0] if len(line.staged) else 0]
    for one in sweeps:
        _draw_sweep_marks(axes, one, one.value * speed_factor(unit), one.swing_of(name), one.contact_of(name))
    over = "speed" if line.clock == "speed" else "frequency"
    _label_sweeps(axes, f"{over} [{unit}]", f"torque of {name}, peak to peak [N·m]", f"contact of {name}, sweep")
    return axes


def _draw_sweep_marks(axes: Axes, one: Sweep, x: Array, size: Array, contact: Sequence[str]) -> None:
    """``x`` and ``size`` (points,) in the picture's units, with the contact of each point."""
    axes.plot(x, size, color="#bbbbbb", lw=0.8, zorder=1)
    for kind, colour in CONTACTS.items():
        here = np.array([c == kind for c in contact])
        if here.any():
            shape, wide, inside = ("^", 3.4, colour) if one.up else ("v", 6.0, "none")
            label = f"{kind}, {'up' if one.up else 'down'}"
            axes.plot(x[here], size[here], shape, color=colour, ms=wide, mfc=inside, ls="", label=label)
    loose = ~one.settled
    if loose.any():
        known = LOOSE in axes.get_legend_handles_labels()[1]
        axes.plot(x[loose], size[loose], "_", color=INK, ms=8, mew=0.8, label=None if known else LOOSE, zorder=5)
    for i in abrupt_changes(size):
        axes.annotate("", (x[i + 1], size[i + 1]), (x[i], size[i]), arrowprops={**ARROW, "color": INK})
        if JUMP not in axes.get_legend_handles_labels()[1]:
            _arrow_entry(axes, INK)


def _label_sweeps(axes: Axes, across: str, up: str, title: str) -> None:
    label_axes(axes, across, up)
    axes.set_ylim(bottom=0)
    # What belongs to both directions comes last.
    entries = sorted(zip(*axes.get_legend_handles_labels(), strict=True), key=lambda e: e[1] in (LOOSE, JUMP))
    handles, words = zip(*entries, strict=True)
    axes.legend(handles, words, title=title, fontsize=SMALL, title_fontsize=SMALL, frameon=False, loc="best")


def draw_basins(basins: Basins, axes: Axes | None = None, *, length: str = "") -> Axes:
    """The plane of starts, one colour per attractor, its start at phase zero as a cross."""
    axes = axes or new_axes(6.3, 4.9)
    colours = ["#eeeeee", "#0072b2", "#f0b84c", "#004d3a", "#dba6c2", "#a03c00"]  # dark and light in turn
    count = len(basins.attractors)
    shades = ListedColormap([colours[0], *(colours[1 + i % 5] for i in range(max(count, 1)))])
    axes.pcolormesh(
        basins.position, basins.velocity, basins.number.T, cmap=shades, vmin=-1.5, vmax=max(count, 1) - 0.5,
        shading="nearest",
    )  # fmt: skip
    for i, orbit in enumerate(basins.attractors):
        words = f"{orbit.contact} contact, half peak-to-peak {orbit.peak_to_peak / 2:.3g}"
        axes.plot(*orbit.start, "x", color="white", ms=10, mew=4.5)
        axes.plot(*orbit.start, "x", color=INK, ms=8, mew=1.8)
        axes.plot([], [], "s", color=colours[1 + i % 5], label=words)
    if np.any(basins.number < 0):
        axes.plot([], [], "s", color=colours[0], mec=FAINT, label="no motion of one period")
    rate = f"{length}/s" if length else ""
    label_axes(axes, _with_unit("x at phase zero", length), _with_unit("x′ at phase zero", rate), grid=False)
    key_below(axes, 3)
    return axes


def _with_unit(words: str, unit: str) -> str:
    return f"{words} [{unit}]" if unit else words


def draw_response(
    found: Any,
    axes: Axes | None = None,
    *,
    length: str = "",
    unit: str | None = None,
    marks: bool = True,
    jumps: bool = True,
    top: float | None = None,
) -> Axes:
    """``draw_responses`` of one method's curve, or of all that a comparison holds."""
    responses = found.responses if isinstance(found, ResponseComparison) else {found.method: found}
    return draw_responses(responses, axes, length=length, unit=unit, marks=marks, jumps=jumps, top=top)


def draw_sweep(sweep: OscillatorSweep, axes: Axes | None = None, *, length: str = "", unit: str | None = None) -> Axes:
    """``draw_sweeps`` of one."""
    return draw_sweeps([sweep], axes, length=length, unit=unit)


def draw_line_sweep(sweep: LineSweep, axes: Axes | None = None, *, spring: str = "", unit: str | None = None) -> Axes:
    """``draw_line_sweeps`` of one."""
    return draw_line_sweeps([sweep], axes, spring=spring, unit=unit)

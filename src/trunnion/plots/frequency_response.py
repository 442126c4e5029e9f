"""Frequency responses on one picture: stable full, unstable dashed, special points and jumps marked; basins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.plots.style import FAINT, INK, SMALL, TEXT, new_axes, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from trunnion.analyses.piecewise_sweep import Basins, Sweep

STYLES = {
    "exact": ("#1a1a1a", 2.2),
    "shooting": ("#1a1a1a", 2.2),
    "harmonic balance": ("#0072b2", 1.3),
    "describing function": ("#d55e00", 1.5),
    "averaging": ("#009e73", 3.6),  # beneath multiple scales, with which it coincides
    "multiple scales": ("#cc79a7", 1.5),
}
SWEEPS = {"sweep up": ("^", "#56b4e9"), "sweep down": ("v", "#e69f00")}
MARKS = {"fold": "o", "period doubling": "s", "Neimark–Sacker": "D", "branch point": "*", "grazing": "x"}
DASHED = (0, (4, 2))


def draw_responses(
    responses: Mapping[str, Any],
    axes: Axes | None = None,
    *,
    length: str = "",
    marks: bool = True,
    jumps: bool = True,
    top: float | None = None,
) -> Axes:
    """Half peak-to-peak over frequency of several methods.

    Parameters
    ----------
    responses : method → response; the special points are those of the first that has any.
    length : unit of x, for the axis.
    marks, jumps : draw special points; draw arrows where a slow sweep leaves a fold.
    top : of the vertical axis.
    """
    axes = axes or new_axes(7.2, 4.9)
    marked = False
    for name, response in responses.items():
        frequency, size = response.frequency, response.half_peak_to_peak
        if name in SWEEPS:
            shape, colour = SWEEPS[name]
            axes.plot(frequency, size, shape, color=colour, ms=3.8, mfc="none", mew=0.9, ls="", label=name, zorder=4)
            continue
        colour, width = STYLES.get(name, (FAINT, 1.4))
        stable = response.stable
        axes.plot(frequency, np.where(_spread(stable), size, np.nan), color=colour, lw=width, label=name)
        axes.plot(frequency, np.where(~stable, size, np.nan), color=colour, lw=0.8 * width, ls=DASHED)
        special = [m for m in getattr(response, "marks", ()) if m[0] in MARKS]
        if marks and special and not marked:
            marked = True
            for kind, shape in MARKS.items():
                points = [(f, a) for k, f, a in special if k == kind]
                if points:
                    axes.plot(*np.array(points).T, shape, color=INK, ms=6, mfc="none", ls="", label=kind, zorder=5)
            if jumps:
                _arrows(axes, response)
    if any(not r.stable.all() for r in responses.values() if hasattr(r, "stable")):
        axes.plot([], [], color=FAINT, lw=1.2, ls=DASHED, label="unstable")
    of, what, unit = _followed(responses)
    axes.set_xlabel(f"{of} [rad/s]", fontsize=TEXT, color=INK)
    unit = f" [{length or unit}]" if length or unit else ""
    axes.set_ylabel(f"half peak-to-peak of {what}{unit}", fontsize=TEXT, color=INK)
    axes.set_ylim(bottom=0, top=top)
    axes.grid(which="major", color="#dddddd", lw=0.6)
    plain(axes)
    axes.legend(fontsize=SMALL, frameon=False, loc="best", ncols=1)
    return axes


def _followed(responses: Mapping[str, Any]) -> tuple[str, str, str]:
    """What runs along the axis, what is drawn, and its unit; a driveline's branch knows better than the usual words."""
    detail = next((r.detail for r in responses.values() if hasattr(r, "detail")), None)
    branch: Any = getattr(detail, "branch", detail)
    if getattr(branch, "label", "") == "speed":
        return "input speed", f"the torque of {branch.curves[0]}", "N·m"
    return "frequency ω", "x", ""


def _spread(stable: Any) -> Any:
    """A stable stretch is drawn to the middle of its change of stability, so that no gap is left."""
    out = stable.copy()
    out[1:] |= stable[:-1]
    return out


def _arrows(axes: Axes, response: Any) -> None:
    """From every fold to the stable motion that is left there: the nearest in size of the others."""
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
            arrow = {"arrowstyle": "-|>", "color": FAINT, "lw": 1.0, "shrinkA": 4, "shrinkB": 2}
            axes.annotate("", (at, landing), (at, size), arrowprops=arrow)


def draw_sweeps(sweeps: Sequence[Sweep], axes: Axes | None = None, *, length: str = "") -> Axes:
    """Half peak-to-peak of sweeps, coloured by what is touched, jumps marked."""
    axes = axes or new_axes(7.2, 4.4)
    colours = {"none": "#56b4e9", "one-sided": "#e69f00", "two-sided": "#d55e00"}
    shown: set[str] = set()
    for one in sweeps:
        size = one.peak_to_peak / 2
        axes.plot(one.frequency, size, color="#bbbbbb", lw=0.8, zorder=1)
        for kind, colour in colours.items():
            here = np.array([c == kind for c in one.contact])
            if here.any():
                label = f"{kind}, {'up' if one.up else 'down'}"
                shape = "^" if one.up else "v"
                axes.plot(one.frequency[here], size[here], shape, color=colour, ms=4, ls="", label=label)
                shown.add(label)
        for a, b in one.jumps:
            i, j = int(np.flatnonzero(one.frequency == a)[0]), int(np.flatnonzero(one.frequency == b)[0])
            arrow = {"arrowstyle": "-|>", "color": INK, "lw": 1.0}
            axes.annotate("", (b, size[j]), (a, size[i]), arrowprops=arrow)
    axes.set_xlabel("frequency ω [rad/s]", fontsize=TEXT, color=INK)
    axes.set_ylabel(f"half peak-to-peak of x{f' [{length}]' if length else ''}", fontsize=TEXT, color=INK)
    axes.set_ylim(bottom=0)
    axes.grid(which="major", color="#dddddd", lw=0.6)
    plain(axes)
    axes.legend(title="contact, sweep", fontsize=SMALL, title_fontsize=SMALL, frameon=False, loc="best")
    return axes


def draw_basins(basins: Basins, axes: Axes | None = None) -> Axes:
    """The plane of starts, one colour per attractor, its start at phase zero as a cross."""
    from matplotlib.colors import ListedColormap

    axes = axes or new_axes(6.3, 4.9)
    colours = ["#eeeeee", "#56b4e9", "#e69f00", "#009e73", "#cc79a7", "#d55e00"]
    count = len(basins.attractors)
    shades = ListedColormap([colours[0], *(colours[1 + i % 5] for i in range(max(count, 1)))])
    axes.pcolormesh(
        basins.position, basins.velocity, basins.number.T, cmap=shades, vmin=-1.5, vmax=max(count, 1) - 0.5,
        shading="nearest",
    )  # fmt: skip
    for i, orbit in enumerate(basins.attractors):
        words = f"{orbit.contact} contact, {orbit.peak_to_peak / 2:.3g}"
        axes.plot(*orbit.start, "x", color=INK, ms=8, mew=1.8)
        axes.plot([], [], "s", color=colours[1 + i % 5], label=words)
    axes.set_xlabel("x at phase zero", fontsize=TEXT, color=INK)
    axes.set_ylabel("x′ at phase zero", fontsize=TEXT, color=INK)
    plain(axes)
    axes.figure.figure.legend(loc="outside lower left", ncols=3, fontsize=SMALL, frameon=False)
    return axes

"""The front of two aims; of one aim, where the chosen numbers lie between their bounds."""

from __future__ import annotations

from matplotlib.axes import Axes

from trunnion.design.optimisation.result import Optimum
from trunnion.plots.style import ACCENT, FAINT, INK, SMALL, TEXT, label_axes, new_axes, plain, printed
from trunnion.results.units import in_words


def draw(found: Optimum, axes: Axes | None = None) -> Axes:
    """Two aims: every design of the front, the line before and the design taken. One: bounds, before and after."""
    return _front(found, axes) if len(found.aims) > 1 else _bounds(found, axes)


def _front(found: Optimum, axes: Axes | None) -> Axes:
    axes = axes if axes is not None else new_axes()
    axes.plot(found.front[:, 0], found.front[:, 1], "o-", color=ACCENT, ms=5, lw=1.2, label="no design beats these")
    axes.plot(*found.aim[:, None], "o", color=INK, ms=9, label="taken")
    axes.plot(*found.aim_before[:, None], "s", mfc="white", mec=INK, ms=8, label="before")
    labels = [
        f"{name}{f' [{printed(unit)}]' if unit != '1' else ''}{', larger is better' if largest else ''}"
        for name, unit, largest in zip(found.aims, found.aim_units, found.largest, strict=True)
    ]
    label_axes(axes, labels[0], labels[1], grid=False)
    return _with_key(axes, 1)


def _bounds(found: Optimum, axes: Axes | None) -> Axes:
    axes = axes if axes is not None else new_axes(7.2, 1.8 + 0.5 * len(found.free))
    for place, unit in enumerate(found.units):
        low, high = found.low[place], found.high[place]
        axes.plot([0, 1], [place, place], color="#c8c8c8", lw=4, solid_capstyle="butt", zorder=1)
        before, after = ((v - low) / (high - low) for v in (found.before[place], found.value[place]))
        axes.plot(min(max(before, 0), 1), place, "s", mfc="white", mec=INK, ms=8, zorder=3,
                  label="before" if not place else None)  # fmt: skip
        axes.plot(after, place, "o", color=ACCENT, ms=9, zorder=4, label="best" if not place else None)
        axes.annotate(in_words(found.rounded(found.value)[place], unit, 5), (after, place), textcoords="offset points",
                      xytext=(0, 9), ha="center", fontsize=SMALL, color=INK)  # fmt: skip
        for end, where, side in ((low, -0.02, "right"), (high, 1.02, "left")):
            axes.annotate(in_words(end, unit, 5), (where, place), ha=side, va="center", fontsize=SMALL, color=FAINT)
    axes.set_yticks(range(len(found.free)), found.free, fontsize=SMALL)
    axes.set_ylim(len(found.free) - 0.4, -0.7)
    axes.set_xlim(-0.28, 1.28)
    axes.set_xticks([])
    before, after = (in_words(v[0], found.aim_units[0], 5) for v in (found.aim_before, found.aim))
    axes.set_title(f"{found.aims[0]}: {after} instead of {before}", fontsize=TEXT, color=INK, loc="left")
    plain(axes)
    axes.tick_params(axis="y", labelsize=SMALL)
    return _with_key(axes, 2)


def _with_key(axes: Axes, columns: int) -> Axes:
    axes.legend(fontsize=SMALL, frameon=False, loc="best", ncols=columns, labelcolor=FAINT)
    return axes

"""Exponents, Poincaré maps, bifurcations and the certificate of a motion as pictures."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from trunnion.arrays import Array
from trunnion.motion.chaos.bifurcation_diagram import BifurcationDiagram
from trunnion.motion.chaos.certify_chaos import ChaosCertificate
from trunnion.motion.chaos.lyapunov_map import LyapunovMap, LyapunovSweep
from trunnion.motion.chaos.lyapunov_spectrum import LyapunovSpectrum
from trunnion.motion.chaos.poincare_map import PoincareMap
from trunnion.numerics.integration.integration import integrate
from trunnion.plots.motion import pair_of_states
from trunnion.plots.style import (
    COLOURS,
    FAINT,
    SMALL,
    TEXT,
    colour_bar,
    curve_style,
    head,
    headed,
    key_below,
    label_axes,
    logarithmic,
    new_axes,
    new_figure,
)
from trunnion.results.counts import counted
from trunnion.results.quantity_axes import axis_of_parameter, state_axes
from trunnion.steady.shooting.repetition import modulo

PORTRAIT = 60
"""Periods of a motion in its portrait."""
FEW = 6
"""The smaller number of points of a map, as a share of all: one in so many."""
INSIDE = 6
"""Exponents whose names have room inside a panel of the certificate."""
SMALLEST_DOTS = 400
"""Points of a map above which they are drawn as small as can be seen."""


def draw_convergence(result: LyapunovSpectrum, axes: Axes | None = None) -> Axes:
    """Running means of the exponents of every start, with the final intervals at the right."""
    axes = axes or new_axes(7.2, 4.2)
    time, means = result.histories
    _running_means(axes, time, means, lw=1.1, alpha=0.8)
    for j, (value, width) in enumerate(zip(result.exponents, result.half_width, strict=True)):
        axes.axhspan(value - width, value + width, color=curve_style(j)["color"], alpha=0.25, lw=0)
    if len(time) > 1:
        axes.set_xlim(time[0], time[-1])
    key_below(axes, 6)
    return axes


def _running_means(axes: Axes, time: Array, means: Array, **look: Any) -> None:
    """Means (start, time, exponent) over a logarithmic axis of time."""
    for j in range(means.shape[2]):
        for i, history in enumerate(means):
            axes.plot(time, history[:, j], **_look(j), label=f"L{j + 1}" if i == 0 else None, **look)
    _zero(axes)
    logarithmic(axes, "x")
    _labels(axes, "time averaged over [s]", "exponent [1/s]")


def _zero(axes: Axes) -> None:
    axes.axhline(0.0, color=FAINT, lw=0.8, ls=(0, (4, 3)))


def draw_map(
    result: PoincareMap, axes: Axes | None = None, *, x: str = "", y: str = "", points: int | None = None
) -> Axes:
    """Points of a Poincaré map: one state over another, by default the first two that differ along the map."""
    axes = axes or new_axes(5.2, 4.6)
    i, j = pair_of_states(result.system, x, y, result.section)
    shown = result.wrapped if points is None else result.wrapped[:points]
    crowd = len(shown) > SMALLEST_DOTS
    size = 8.0 if result.repeat else 2.0 if crowd else 5.0
    states = state_axes(result.system)
    across, up = states[i], states[j]
    axes.plot(shown[:, i] * across.factor, shown[:, j] * up.factor, marker=".", ls="", color=COLOURS[0], ms=size, mew=0)
    if result.repeat:  # shown at the size of the motion, not of its rounding errors
        _widen(axes, (result.size[i] * across.factor, result.size[j] * up.factor), 0.05, 0.5)
    _labels(axes, across.label, up.label)
    headed(axes, counted(len(shown), "point"))
    return axes


def draw_bifurcations(result: BifurcationDiagram, axes: Axes | None = None, *, state: str = "") -> Axes:
    """One state of the map over the parameter, in a colour for each direction."""
    axes = axes or new_axes(7.2, 4.4)
    i = result.system.states.index(state) if state else 0
    across, up = axis_of_parameter(result.system, result.parameter), state_axes(result.system)[i]
    for d, direction in enumerate(result.directions):
        values = np.repeat(result.values * across.factor, result.points.shape[2])
        look: dict[str, Any] = {"marker": ".", "ls": "", "ms": 1.6, "mew": 0, "color": COLOURS[d]}
        axes.plot(values, result.points[d, :, :, i].ravel() * up.factor, **look)
        axes.plot([], [], marker="o", ls="", ms=5, color=COLOURS[d], label=direction)
    _labels(axes, across.label, up.label)
    axes.set_xlim(result.values[0] * across.factor, result.values[-1] * across.factor)
    key_below(axes, 6)
    return axes


def draw_sweep(result: LyapunovSweep, axes: Axes | None = None, *, mark: float | None = None) -> Axes:
    """Exponents over one parameter, with their intervals; ``mark`` a value of it."""
    axes = axes or new_axes(7.2, 4.2)
    across = axis_of_parameter(result.system, result.parameter)
    along = result.values * across.factor
    for j in range(result.exponents.shape[1]):
        value, width, colour = result.exponents[:, j], result.half_width[:, j], curve_style(j)["color"]
        axes.fill_between(along, value - width, value + width, color=colour, alpha=0.25, lw=0)
        axes.plot(along, value, **_look(j), lw=1.3, marker=".", ms=4, label=f"L{j + 1}")
    _zero(axes)
    if mark is not None:
        axes.axvline(mark * across.factor, color=FAINT, lw=0.8, ls=(0, (1, 2)))
    _labels(axes, across.label, "exponent [1/s]")
    if len(result.values) > 1:
        axes.set_xlim(along[0], along[-1])
    return axes


def draw_lyapunov_map(result: LyapunovMap, axes: Axes | None = None) -> Axes:
    """The largest exponent in colour: red where positive, blue where negative, white at 0, grey where it failed."""
    axes = axes or new_axes(7.0, 4.8)
    high = max(float(np.nanmax(result.exponent)), 1e-12)
    low = min(float(np.nanmin(result.exponent)), -1e-12)
    axes.set_facecolor("#9a9a9a")
    across, up = (axis_of_parameter(result.system, name) for name in result.parameters)
    drawn = axes.pcolormesh(
        result.x * across.factor, result.y * up.factor, result.exponent, cmap="RdBu_r",
        norm=TwoSlopeNorm(0.0, low, high), shading="nearest", rasterized=True,
    )  # fmt: skip
    colour_bar(axes, drawn, "largest exponent [1/s]")
    label_axes(axes, across.label, up.label, grid=False)
    return axes


def draw_certificate(result: ChaosCertificate) -> Figure:
    """Portrait; exponents over the swept parameter, or their convergence; the map at two numbers of points."""
    figure = new_figure(9.4, 7.6)
    grid: Any = figure.subplots(2, 2)
    what = str(result.verdict) + (f", {result.kind}" if result.kind else "")
    head(figure, f"{result.system.name}: {what}")
    _portrait(result, grid[0, 0])
    if result.sweep is not None:
        draw_sweep(result.sweep, grid[0, 1], mark=result.system.parameters[result.sweep.parameter])
    else:
        time, means = result.spectrum.histories
        _running_means(grid[0, 1], time, means[:1], lw=1.2)
    _panel_legend(grid[0, 1])
    for axes, share in zip(grid[1], (FEW, 1), strict=True):
        if result.map is None or not len(result.map.points):
            axes.set_axis_off()
            axes.text(0.5, 0.5, _no_map(result), ha="center", va="center", fontsize=TEXT, color=FAINT)
            continue
        draw_map(result.map, axes, points=max(len(result.map.points) // share, 1))
    return figure


def _portrait(result: ChaosCertificate, axes: Axes) -> None:
    system, spectrum = result.system, result.spectrum
    i, j = pair_of_states(system)
    states = state_axes(system)
    across, up = states[i], states[j]
    state = spectrum.runs[0].states[-1] if len(spectrum.runs[0].states) else spectrum.starts[0]
    state = state if np.all(np.isfinite(state)) and np.all(np.abs(state) < 1e50) else spectrum.starts[0]
    run = integrate(
        system.equations, 0.0, PORTRAIT * spectrum.interval, state, regime=system.regime_at(0.0, state), tolerance=1e-8
    )
    if run.steps:
        times = np.linspace(0.0, run.time, 30_000)
        turns = result.map.turns if result.map is not None else np.zeros((0, system.size))
        path = modulo(run.at(times), turns, np.asarray(system.scale))
        for turn in turns[:, [i, j]]:  # no line across the page where an angle starts anew
            anew = np.abs(np.diff(path[:, [i, j]], axis=0)) > np.abs(turn) / 2
            path[1:][np.any(anew & (turn != 0), axis=1)] = np.nan
        axes.plot(path[:, i] * across.factor, path[:, j] * up.factor, color=COLOURS[0], lw=0.5)
        rests = [np.ptp(path[:, k]) < 1e-4 * np.abs(path[:, k]).max() for k in (i, j)]
        if all(rests):
            axes.plot(path[-1, i] * across.factor, path[-1, j] * up.factor, "o", color=COLOURS[0], ms=5)
        # A motion at rest is a point, not the rounding errors about it.
        middles = np.abs([np.mean(axes.get_xlim()), np.mean(axes.get_ylim())])
        least = 1e-6 * np.asarray(system.scale)[[i, j]] * (across.factor, up.factor)
        _widen(axes, np.maximum(middles, least), 1e-4, 0.1)
    _labels(axes, across.label, up.label)
    word = "period" if system.forcing_period is not None else "sample"
    headed(axes, f"portrait over {PORTRAIT} {word}s")


def _widen(axes: Axes, sizes: Sequence[float] | Array, least: float, half: float) -> None:
    """Where less than the ``least`` share of a size is seen, show ``half`` of it to both sides."""
    for name, size in zip("xy", sizes, strict=True):
        low, high = getattr(axes, f"get_{name}lim")()
        middle = 0.5 * (low + high)
        if high - low < least * size:
            getattr(axes, f"set_{name}lim")(middle - half * size, middle + half * size)


def _no_map(result: ChaosCertificate) -> str:
    """Why there is none."""
    reason = next((r for r in result.reasons if r.startswith("no map")), f"no map: {(*result.reasons, 'no points')[0]}")
    return fill(reason, 44)


def _look(j: int) -> dict[str, Any]:
    """Without markers, which are those of the points."""
    return {key: curve_style(j)[key] for key in ("color", "linestyle")}


def _panel_legend(axes: Axes) -> None:
    """Inside where there is room for it, beside the axes where the exponents are many."""
    many = len(axes.get_legend_handles_labels()[1]) > INSIDE
    place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if many else {"loc": "best"}
    axes.legend(fontsize=SMALL, frameon=False, **place)


def _labels(axes: Axes, x: str, y: str) -> None:
    label_axes(axes, x, y)
    axes.set_axisbelow(True)
    if axes.get_xscale() == "linear":
        axes.locator_params(axis="x", nbins=5)  # small panels: more labels would touch

"""Exponents, Poincaré maps, bifurcations and the certificate of a motion as pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.analyses.chaos.bifurcation_diagram import BifurcationDiagram
from trunnion.analyses.chaos.certify_chaos import ChaosCertificate
from trunnion.analyses.chaos.lyapunov_map import LyapunovMap, LyapunovSweep
from trunnion.analyses.chaos.lyapunov_result import LyapunovSpectrum
from trunnion.analyses.chaos.poincare_map import PoincareMap
from trunnion.analyses.motion.long_motion import wrapped
from trunnion.numerics.integration.integration import integrate
from trunnion.plots.style import COLOURS, FAINT, INK, SMALL, TEXT, TITLE, curve_style, logarithmic, new_axes, plain
from trunnion.results.quantity_axes import QuantityAxis, parameter_axis, state_axis
from trunnion.systems.system import System

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

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
    for j in range(len(result.exponents)):
        look, colour = _look(j), curve_style(j)["color"]
        for i, history in enumerate(means):
            axes.plot(time, history[:, j], **look, lw=1.1, label=f"L{j + 1}" if i == 0 else None, alpha=0.8)
        value, width = result.exponents[j], result.half_width[j]
        axes.axhspan(value - width, value + width, color=colour, alpha=0.25, lw=0)
    axes.axhline(0.0, color=FAINT, lw=0.8, ls=(0, (4, 3)))
    logarithmic(axes, "x")
    _labels(axes, "time averaged over [s]", "exponent [1/s]")
    if len(time) > 1:
        axes.set_xlim(time[0], time[-1])
    _legend(axes)
    return axes


def draw_map(
    result: PoincareMap, axes: Axes | None = None, *, x: str = "", y: str = "", points: int | None = None
) -> Axes:
    """Points of a Poincaré map: one state over another, by default the first two that differ along the map."""
    axes = axes or new_axes(5.2, 4.6)
    i, j = _pair(result.system, x, y, result.section)
    shown = result.wrapped if points is None else result.wrapped[:points]
    crowd = len(shown) > SMALLEST_DOTS
    look: dict[str, Any] = {"marker": ".", "ls": "", "color": COLOURS[0], "ms": 2.0 if crowd else 5.0, "mew": 0}
    if result.repeat:
        look |= {"ms": 8.0}
    across, up = _state(result.system, i), _state(result.system, j)
    axes.plot(shown[:, i] * across.factor, shown[:, j] * up.factor, **look)
    if result.repeat:
        _widen(axes, result, i, j)
    _labels(axes, across.label, up.label)
    axes.set_title(f"{len(shown)} point{'s' * (len(shown) != 1)}", fontsize=SMALL, color=FAINT, loc="left")
    return axes


def draw_bifurcations(result: BifurcationDiagram, axes: Axes | None = None, *, state: str = "") -> Axes:
    """One state of the map over the parameter, in a colour for each direction."""
    axes = axes or new_axes(7.2, 4.4)
    i = result.system.states.index(state) if state else 0
    across, up = _parameter(result.system, result.parameter), _state(result.system, i)
    for d, direction in enumerate(result.directions):
        values = np.repeat(result.values * across.factor, result.points.shape[2])
        look: dict[str, Any] = {"marker": ".", "ls": "", "ms": 1.6, "mew": 0, "color": COLOURS[d]}
        axes.plot(values, result.points[d, :, :, i].ravel() * up.factor, **look)
        axes.plot([], [], marker="o", ls="", ms=5, color=COLOURS[d], label=direction)
    _labels(axes, across.label, up.label)
    axes.set_xlim(result.values[0] * across.factor, result.values[-1] * across.factor)
    _legend(axes)
    return axes


def draw_sweep(result: LyapunovSweep, axes: Axes | None = None, *, mark: float | None = None) -> Axes:
    """Exponents over one parameter, with their intervals; ``mark`` a value of it."""
    axes = axes or new_axes(7.2, 4.2)
    across = _parameter(result.system, result.parameter)
    along = result.values * across.factor
    for j in range(result.exponents.shape[1]):
        value, width, colour = result.exponents[:, j], result.half_width[:, j], curve_style(j)["color"]
        axes.fill_between(along, value - width, value + width, color=colour, alpha=0.25, lw=0)
        axes.plot(along, value, **_look(j), lw=1.3, marker=".", ms=4, label=f"L{j + 1}")
    axes.axhline(0.0, color=FAINT, lw=0.8, ls=(0, (4, 3)))
    if mark is not None:
        axes.axvline(mark * across.factor, color=FAINT, lw=0.8, ls=(0, (1, 2)))
    _labels(axes, across.label, "exponent [1/s]")
    if len(result.values) > 1:
        axes.set_xlim(along[0], along[-1])
    return axes


def draw_lyapunov_map(result: LyapunovMap, axes: Axes | None = None) -> Axes:
    """The largest exponent in colour: red where positive, blue where negative, white at 0, grey where it failed."""
    axes = axes or new_axes(7.0, 4.8)
    from matplotlib.colors import TwoSlopeNorm

    high = max(float(np.nanmax(result.exponent)), 1e-12)
    low = min(float(np.nanmin(result.exponent)), -1e-12)
    axes.set_facecolor("#9a9a9a")
    across, up = (_parameter(result.system, name) for name in result.parameters)
    drawn = axes.pcolormesh(
        result.x * across.factor, result.y * up.factor, result.exponent, cmap="RdBu_r",
        norm=TwoSlopeNorm(0.0, low, high), shading="nearest", rasterized=True,
    )  # fmt: skip
    bar = axes.figure.figure.colorbar(drawn, ax=axes)
    bar.set_label("largest exponent [1/s]", fontsize=TEXT, color=INK)
    bar.ax.tick_params(labelsize=SMALL, colors=INK)
    axes.set_xlabel(across.label, fontsize=TEXT, color=INK)
    axes.set_ylabel(up.label, fontsize=TEXT, color=INK)
    plain(axes)
    return axes


def draw_certificate(result: ChaosCertificate) -> Figure:
    """Portrait; exponents over the swept parameter, or their convergence; the map at two numbers of points."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from trunnion.plots.literal_figure import LiteralFigure

    figure = LiteralFigure(figsize=(9.4, 7.6), layout="constrained")
    FigureCanvasAgg(figure)
    grid: Any = figure.subplots(2, 2)
    what = str(result.verdict) + (f", {result.kind}" if result.kind else "")
    figure.suptitle(f"{result.system.name}: {what}", fontsize=TITLE, color=INK, x=0.01, ha="left")
    _portrait(result, grid[0, 0])
    if result.sweep is not None:
        draw_sweep(result.sweep, grid[0, 1], mark=result.system.parameters[result.sweep.parameter])
        _panel_legend(grid[0, 1])
    else:
        _convergence_panel(result.spectrum, grid[0, 1])
    for axes, share in zip(grid[1], (FEW, 1), strict=True):
        if result.map is None or not len(result.map.points):
            axes.set_axis_off()
            axes.text(0.5, 0.5, _no_map(result), ha="center", va="center", fontsize=TEXT, color=FAINT)
            continue
        draw_map(result.map, axes, points=max(len(result.map.points) // share, 1))
    return figure


def _convergence_panel(spectrum: LyapunovSpectrum, axes: Axes) -> None:
    time, means = spectrum.histories
    for j in range(len(spectrum.exponents)):
        axes.plot(time, means[0, :, j], **_look(j), lw=1.2, label=f"L{j + 1}")
    axes.axhline(0.0, color=FAINT, lw=0.8, ls=(0, (4, 3)))
    logarithmic(axes, "x")
    _labels(axes, "time averaged over [s]", "exponent [1/s]")
    _panel_legend(axes)


def _portrait(result: ChaosCertificate, axes: Axes) -> None:
    system, spectrum = result.system, result.spectrum
    i, j = _pair(system, "", "")
    across, up = _state(system, i), _state(system, j)
    state = spectrum.runs[0].states[-1] if len(spectrum.runs[0].states) else spectrum.starts[0]
    state = state if np.all(np.isfinite(state)) and np.all(np.abs(state) < 1e50) else spectrum.starts[0]
    run = integrate(
        system.equations, 0.0, PORTRAIT * spectrum.interval, state, regime=system.regime_at(0.0, state), tolerance=1e-8
    )
    if run.steps:
        times = np.linspace(0.0, run.time, 30_000)
        turning = result.map.angles if result.map is not None else ()
        path = wrapped(run.at(times), turning)
        for k in {i, j} & set(turning):  # no line across the page where an angle starts anew
            path[1:][np.abs(np.diff(path[:, k])) > np.pi] = np.nan
        axes.plot(path[:, i] * across.factor, path[:, j] * up.factor, color=COLOURS[0], lw=0.5)
        rests = [np.ptp(path[:, k]) < 1e-4 * np.abs(path[:, k]).max() for k in (i, j)]
        if all(rests):
            axes.plot(path[-1, i] * across.factor, path[-1, j] * up.factor, "o", color=COLOURS[0], ms=5)
        _open(axes, system, i, j)
    _labels(axes, across.label, up.label)
    word = "period" if system.forcing_period is not None else "sample"
    axes.set_title(f"portrait over {PORTRAIT} {word}s", fontsize=SMALL, color=FAINT, loc="left")


def _widen(axes: Axes, result: PoincareMap, i: int, j: int) -> None:
    """Show a map that repeats at the size of the motion, not of its rounding errors."""
    for k, limits, change in ((i, axes.get_xlim(), axes.set_xlim), (j, axes.get_ylim(), axes.set_ylim)):
        size = float(result.size[k]) * _state(result.system, k).factor
        if size > 0 and limits[1] - limits[0] < 0.05 * size:
            middle = 0.5 * (limits[0] + limits[1])
            change(middle - 0.5 * size, middle + 0.5 * size)


def _open(axes: Axes, system: System, i: int, j: int) -> None:
    """Show a motion at rest as a point, not the rounding errors about it."""
    for k, limits, change in ((i, axes.get_xlim(), axes.set_xlim), (j, axes.get_ylim(), axes.set_ylim)):
        middle = 0.5 * (limits[0] + limits[1])
        size = max(abs(middle), 1e-6 * float(np.asarray(system.scale)[k]) * _state(system, k).factor)
        if limits[1] - limits[0] < 1e-4 * size:
            change(middle - 0.1 * size, middle + 0.1 * size)


def _no_map(result: ChaosCertificate) -> str:
    """Why there is none."""
    import textwrap

    reason = next((r for r in result.reasons if r.startswith("no map")), f"no map: {(*result.reasons, 'no points')[0]}")
    return textwrap.fill(reason, 44)


def _look(j: int) -> dict[str, Any]:
    """Without markers, which are those of the points."""
    return {key: curve_style(j)[key] for key in ("color", "linestyle")}


def _panel_legend(axes: Axes) -> None:
    """Inside where there is room for it, beside the axes where the exponents are many."""
    many = len(axes.get_legend_handles_labels()[1]) > INSIDE
    place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if many else {"loc": "best"}
    axes.legend(fontsize=SMALL, frameon=False, **place)


def _pair(system: System, x: str, y: str, section: str = "") -> tuple[int, int]:
    """Places of two states: those named, or a rotation and its rate, or the first two that vary on the section."""
    names = system.states
    half = len(names) // 2 if names[0].startswith("rotation of ") else min(1, len(names) - 1)
    if "rate" in names:
        half = names.index("rate")
    pair = (0, half)
    varied = [k for k, name in enumerate(names) if not section.startswith(f"{name} = ")]
    if not {*pair} <= {*varied} and len(varied) > 1:
        pair = (varied[0], varied[1])
    return (names.index(x) if x else pair[0]), (names.index(y) if y else pair[1])


def _state(system: System, i: int) -> QuantityAxis:
    return state_axis(system.states[i], system.units[i], system.speed_unit)


def _parameter(system: System, name: str) -> QuantityAxis:
    return parameter_axis(name, system.parameter_units.get(name, "1"), system.speed_unit)


def _labels(axes: Axes, x: str, y: str) -> None:
    axes.set_xlabel(x, fontsize=TEXT, color=INK)
    axes.set_ylabel(y, fontsize=TEXT, color=INK)
    axes.grid(which="major", color="#dddddd", lw=0.6)
    axes.set_axisbelow(True)
    if axes.get_xscale() == "linear":
        axes.locator_params(axis="x", nbins=5)  # small panels: more labels would touch
    plain(axes)


def _legend(axes: Axes) -> None:
    axes.figure.figure.legend(
        *axes.get_legend_handles_labels(), loc="outside lower left", ncols=6, fontsize=SMALL, frameon=False
    )

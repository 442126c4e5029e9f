"""Exponents, Poincaré maps, bifurcations and the certificate of a motion."""

from __future__ import annotations

from dataclasses import replace
from textwrap import fill

import numpy as np

from trunnion.arrays import Array
from trunnion.motion.chaos.bifurcation_diagram import BifurcationDiagram
from trunnion.motion.chaos.certify_chaos import ChaosCertificate
from trunnion.motion.chaos.lyapunov_map import LyapunovMap, LyapunovSweep
from trunnion.motion.chaos.lyapunov_spectrum import LyapunovSpectrum
from trunnion.motion.chaos.poincare_map import PoincareMap
from trunnion.numerics.integration.integration import integrate
from trunnion.pictures.motion import pair_of_states, plane
from trunnion.pictures.picture import (
    MARGIN,
    Axis,
    Band,
    Cells,
    ColouredGrid,
    Colours,
    Item,
    Key,
    Level,
    Line,
    Panel,
    Picture,
    Points,
    Spans,
    Texts,
    points_at,
    single,
)
from trunnion.pictures.shared import axis_of
from trunnion.results.counts import counted
from trunnion.results.quantity_axes import axis_of_parameter, state_axes
from trunnion.steady.shooting.repetition import modulo

PORTRAIT, FINE = 60, 30_000
"""Periods of a motion in its portrait, and its points."""
FEW = 6
"""The smaller number of points of a map, as a share of all: one in so many."""
INSIDE = 6
"""Exponents whose names have room inside a panel of the certificate."""
CROWD = 400
"""Points of a map above which they are drawn as small as can be seen."""


def convergence(result: LyapunovSpectrum) -> Picture:
    """Running means of the exponents of every start, with the final intervals at the right."""
    time, means = result.histories
    spans = [
        Spans([(value - width, value + width)], f"interval {j}", on="y")
        for j, (value, width) in enumerate(zip(result.exponents, result.half_width, strict=True))
    ]
    return _running_means(time, means, spans)


def _running_means(time: Array, means: Array, more: list[Spans]) -> Picture:
    """Means (start, time, exponent) over a logarithmic axis of time."""
    items: list[Item] = [
        Line(time, history[:, j], f"plain {j}", "" if i else f"L{j + 1}")
        for j in range(means.shape[2])
        for i, history in enumerate(means)
    ]
    across = Axis("time averaged over", "s", scale="log")
    if len(time) > 1:
        across = across.logarithmic(float(time[0]), float(time[-1]))
    return single(across, Axis("exponent", "1/s"), [*items, *more, Level(0.0, "zero")], height=4.2)


def poincare_map(result: PoincareMap, *, x: str = "", y: str = "", points: int | None = None) -> Picture:
    """Points of a Poincaré map: one state over another, by default the first two that differ along the map."""
    i, j = pair_of_states(result.system, x, y, result.section)
    shown = result.wrapped if points is None else result.wrapped[:points]
    states = state_axes(result.system)
    across, up = (
        _widened(axis_of(states[k]), shown[:, k] * states[k].factor, result.size[k] * states[k].factor, 0.05, 0.5)
        if result.repeat  # shown at the size of the motion, not of its rounding errors
        else axis_of(states[k])
        for k in (i, j)
    )
    role = "single point" if result.repeat else "crowded points" if len(shown) > CROWD else "map points"
    marks = Points(shown[:, i] * states[i].factor, shown[:, j] * states[j].factor, role)
    return single(across, up, [marks], 5.2, 4.6, remark=counted(len(shown), "point"), key="")


def bifurcations(result: BifurcationDiagram, *, state: str = "") -> Picture:
    """One state of the map over the parameter, in a colour for each direction."""
    i = result.system.states.index(state) if state else 0
    across, up = axis_of_parameter(result.system, result.parameter), state_axes(result.system)[i]
    items: list[Item] = []
    for d, direction in enumerate(result.directions):
        values = np.repeat(result.values * across.factor, result.points.shape[2])
        items.append(Points(values, result.points[d, :, :, i].ravel() * up.factor, f"dots {d}"))
        items.append(Key(f"dot {d}", direction, "mark"))
    axis = axis_of(across, result.values[0], result.values[-1])
    return single(axis, axis_of(up), items, height=4.4)


def lyapunov_sweep(result: LyapunovSweep, *, mark: float | None = None) -> Picture:
    """Exponents over one parameter, with their intervals; ``mark`` a value of it."""
    across = axis_of_parameter(result.system, result.parameter)
    along = result.values * across.factor
    items: list[Item] = []
    for j in range(result.exponents.shape[1]):
        value, width = result.exponents[:, j], result.half_width[:, j]
        items.append(Band(along, value - width, value + width, f"interval {j}"))
        items.append(Line(along, value, f"dotted {j}", f"L{j + 1}"))
    items.append(Level(0.0, "zero"))
    if mark is not None:
        items.append(Level(mark * across.factor, "mark", on="x"))
    ends = (result.values[0], result.values[-1]) if len(along) > 1 else ()
    return single(axis_of(across, *ends), Axis("exponent", "1/s"), items, height=4.2)


def lyapunov_map(result: LyapunovMap) -> Picture:
    """The largest exponent in colour: red where positive, blue where negative, white at 0, grey where it failed."""
    high = max(float(np.nanmax(result.exponent)), 1e-12)
    low = min(float(np.nanmin(result.exponent)), -1e-12)
    across, up = (axis_of_parameter(result.system, name) for name in result.parameters)
    x, y = result.x * across.factor, result.y * up.factor
    colours = Colours("largest exponent [1/s]", "signed", low, high, "zero")
    items: list[Item] = [ColouredGrid(x, y, result.exponent, colours)]
    if np.isnan(result.exponent).any():
        items.append(Cells(x, y, np.isnan(result.exponent), "not found", "not found"))
    return single(axis_of(across), axis_of(up), items, 7.0, 4.8, grid="")


def certificate(result: ChaosCertificate) -> Picture:
    """Portrait; exponents over the swept parameter, or their convergence; the map at two numbers of points."""
    what = str(result.verdict) + (f", {result.kind}" if result.kind else "")
    if result.sweep is not None:
        second = lyapunov_sweep(result.sweep, mark=result.system.parameters[result.sweep.parameter]).panel
    else:
        time, means = result.spectrum.histories
        second = _running_means(time, means[:1], []).panel
    many = sum(1 for item in second.items if getattr(item, "name", "")) > INSIDE
    panels = [_portrait(result), replace(second, key="beside" if many else "inside")]
    for share in (FEW, 1):
        if result.map is None or not len(result.map.points):
            panels.append(Panel(Axis(), Axis(), [Texts([0.5], [0.5], [_no_map(result)], "faint words", inside=True)],
                                frame=False))  # fmt: skip
        else:
            panels.append(poincare_map(result.map, points=max(len(result.map.points) // share, 1)).panel)
    return Picture(panels, 9.4, 7.6, 2, f"{result.system.name}: {what}")


def _portrait(result: ChaosCertificate) -> Panel:
    system, spectrum = result.system, result.spectrum
    i, j = pair_of_states(system)
    state = spectrum.runs[0].states[-1] if len(spectrum.runs[0].states) else spectrum.starts[0]
    state = state if np.all(np.isfinite(state)) and np.all(np.abs(state) < 1e50) else spectrum.starts[0]
    run = integrate(
        system.equations, 0.0, PORTRAIT * spectrum.interval, state, regime=system.regime_at(0.0, state), tolerance=1e-8
    )
    word = "period" if system.forcing_period is not None else "sample"
    remark = f"portrait over {PORTRAIT} {word}s"
    if not run.steps:
        return replace(plane(system, i, j, state[None], "fine path").panel, remark=remark)
    turns = result.map.turns if result.map is not None else np.zeros((0, system.size))
    path = modulo(run.at(np.linspace(0.0, run.time, FINE)), turns, np.asarray(system.scale))
    for turn in turns[:, [i, j]]:  # no line across the page where an angle starts anew
        anew = np.abs(np.diff(path[:, [i, j]], axis=0)) > np.abs(turn) / 2
        path[1:][np.any(anew & (turn != 0), axis=1)] = np.nan
    panel = plane(system, i, j, path, "fine path").panel
    axes = state_axes(system)
    if all(np.ptp(path[:, k]) < 1e-4 * np.abs(path[:, k]).max() for k in (i, j)):
        panel = panel.with_items(points_at([path[-1, k] * axes[k].factor for k in (i, j)], "point"))
    # A motion at rest is a point, not the rounding errors about it.
    ends = []
    for k, axis in ((i, panel.x), (j, panel.y)):
        values = path[:, k] * axes[k].factor
        middle = abs(np.nanmin(values) + np.nanmax(values)) / 2
        least = 1e-6 * float(np.asarray(system.scale)[k]) * axes[k].factor
        ends.append(_widened(axis, values, max(middle, least), 1e-4, 0.1))
    return replace(panel, x=ends[0], y=ends[1], remark=remark)


def _widened(axis: Axis, values: Array, size: float, least: float, half: float) -> Axis:
    """Where less than the ``least`` share of a size is seen, show ``half`` of it to both sides."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if (high - low) * (1 + 2 * MARGIN) >= least * size:
        return axis
    middle = (low + high) / 2
    return replace(axis, low=middle - half * size, high=middle + half * size)


def _no_map(result: ChaosCertificate) -> str:
    """Why there is none."""
    reason = next((r for r in result.reasons if r.startswith("no map")), f"no map: {(*result.reasons, 'no points')[0]}")
    return fill(reason, 44)

"""S4's figures drawn anew: Ω(β), time histories and portraits, exponents over the range, Poincaré maps."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from trunnion.arrays import Array
from trunnion.motion.chaos.lyapunov_map import LyapunovSweep
from trunnion.motion.chaos.poincare_map import PoincareMap, poincare_map
from trunnion.motion.simulation.simulate import simulate_system
from trunnion.motion.simulation.simulation import SystemSimulation
from trunnion.plots.style import ACCENT, COLOURS, FAINT, INK, SMALL, TITLE, VERMILION, head, label_axes
from trunnion.studies.double_tripod.estimator import printed_estimator
from trunnion.studies.double_tripod.published import WORST_ANGLE, DoubleTripod

HISTORY = 0.12
"""Time drawn [s]; the paper does not state its own."""
DIES_OUT = 12.0
"""Times 1/(ζΩ) after which a motion counts as settled: the start is then below 1e-5 of itself."""
SETTLED = 0.0102
"""Time [s] of the settled portrait: three periods of the motor's torque."""
TRANSIENT = 4000
COUNTS = (100, 200)
"""Intervals N of the printed estimator."""


def frequency_figure(element: str) -> Figure:
    """Ω over the joint angle: Figure 9 or 10."""
    figure, (axes,) = _figure(1)
    beta = np.linspace(0, WORST_ANGLE, 91)
    part = DoubleTripod().element(element)
    axes.plot(np.rad2deg(beta), [part.natural_frequency(b) for b in beta], color=ACCENT, lw=1.6)
    _labels(axes, "joint angle β [°]", f"natural frequency of {part.name} [rad/s]")
    axes.set_xlim(0, 9)
    return figure


def motion_of(element: str, damping_ratio: float) -> SystemSimulation:
    """A motion of (25) or (26) from rest without twist, until it has settled."""
    system = DoubleTripod(damping_ratio=damping_ratio).system(element, phase="own")
    p = system.parameters
    settled = DIES_OUT / (p["damping_ratio"] * p["natural_frequency"])
    return simulate_system(system, max(HISTORY, settled) + SETTLED, tolerance=1e-9)


def beats(motion: SystemSimulation) -> int:
    """How often the swing per natural period rises again by more than RISE of the first, while the start dies out."""
    p = motion.system.parameters
    period = 2 * np.pi / p["natural_frequency"]
    count = int(min(3 / p["damping_ratio"] / (2 * np.pi), 0.9 * motion.end / period))
    phi = motion.at(np.linspace(0, count * period, 64 * count, endpoint=False))[:, 0].reshape(count, 64)
    swing = np.ptp(phi, axis=1)
    low, risen, rises = swing[0], False, 0
    for value in swing:
        if value > low + RISE * swing[0] and not risen:
            rises, risen, high = rises + 1, True, value
        if risen and value < high - RISE * swing[0]:
            risen, low = False, value
        high, low = (max(high, value), low) if risen else (value, min(low, value))
    return rises


def turning_beats(element: str, frequencies: tuple[float, ...]) -> dict[float, int]:
    """The same by frequency η/2π [Hz] where the rotation in every cosine turns with half the phase, ζ = 0.0016."""
    found = {}
    for hertz in frequencies:
        system = DoubleTripod().system(element, phase="turning", excitation=2 * np.pi * hertz)
        p = system.parameters
        length = DIES_OUT / (p["damping_ratio"] * p["natural_frequency"])
        found[hertz] = beats(simulate_system(system, length, tolerance=1e-9))
    return found


RISE = 0.02
"""Share of the first swing by which an envelope must rise again to count as beating."""


def motion_figure(motion: SystemSimulation, title: str) -> Figure:
    """The paper's panels (a) to (d), φ and φ̇ over time, both in space with time, and the portrait; beside them what is
    left once the start has died out, at its own scale."""
    figure = _blank(10.0, 7.2)
    mosaic: Any = [["a", "a", "a", "b", "b", "b"], ["c", "c", "d", "d", "e", "e"]]
    axes: Any = figure.subplot_mosaic(mosaic, per_subplot_kw={"c": {"projection": "3d"}})
    times = np.linspace(0, HISTORY, 20_000)
    late = np.linspace(motion.end - SETTLED, motion.end, 8_000)
    state, settled = (motion.at(t) * np.array([1e6, 1.0]) for t in (times, late))
    phi, rate = "rotation [µrad]", "rate [rad/s]"
    axes["a"].plot(times, state[:, 0], color=ACCENT, lw=0.4)
    axes["b"].plot(times, state[:, 1], color=ACCENT, lw=0.4)
    axes["c"].plot(state[:, 0], state[:, 1], times, color=ACCENT, lw=0.3)
    axes["d"].plot(state[:, 0], state[:, 1], color=ACCENT, lw=0.3)
    axes["e"].plot(settled[:, 0], settled[:, 1], color="#c04f00", lw=1.0)
    rests = bool(np.all(np.ptp(settled, axis=0) < 1e-3 * np.ptp(state, axis=0)))
    if rests:
        axes["e"].plot(settled[-1:, 0], settled[-1:, 1], "o", color="#c04f00", ms=7)
        _about(axes["e"], settled[-1], np.ptp(state, axis=0) / 20)
    for letter, x, y in (("a", "time [s]", phi), ("b", "time [s]", rate), ("d", phi, rate), ("e", phi, rate)):
        _labels(axes[letter], x, y)
    _in_space(axes["c"], phi, rate)
    for letter in "ab":
        axes[letter].set_xlim(0, HISTORY)
    names = {"a": "(a)", "b": "(b)", "c": "(c)", "d": "(d)", "e": "settled: at rest" if rests else "settled"}
    for letter, name in names.items():
        _named(axes[letter], name)
    head(figure, title, TITLE - 1)
    return figure


def _about(axes: Axes, middle: Array, half: Array) -> None:
    """Show a place (2,) and so much to both sides."""
    (left, bottom), (right, top) = middle - half, middle + half
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)


def _in_space(axes: Any, phi: str, rate: str) -> None:
    """Labels of the panel in space, small enough to stay apart."""
    for set_label, words in ((axes.set_xlabel, phi), (axes.set_ylabel, rate), (axes.set_zlabel, "time [s]")):
        set_label(words, fontsize=8, labelpad=2)
    axes.tick_params(labelsize=7, pad=0)
    axes.locator_params(nbins=4)
    axes.set_box_aspect(None, zoom=0.82)


def exponents_figure(sweep: LyapunovSweep, title: str) -> Figure:
    """Exponents and their sum over η/2π: the panels (a) to (d) of Figures 17 to 24."""
    figure, (left, right) = _figure(2)
    x = sweep.values / (2 * np.pi)
    for j, style in enumerate(("-", "-", "--")):
        left.plot(x, sweep.exponents[:, j], style, color=COLOURS[j], lw=1.4, label=f"L{j + 1}")
    left.axhline(0.0, color=FAINT, lw=0.8, ls=(0, (4, 3)), zorder=0)
    right.plot(x, sweep.exponents.sum(axis=1), color=INK, lw=1.4)
    total = float(np.mean(sweep.exponents.sum(axis=1)))
    right.set_ylim(total - 0.1 * abs(total), total + 0.1 * abs(total))
    left.legend(fontsize=SMALL, frameon=False, loc="center right")
    _labels(left, "excitation frequency η/2π [Hz]", "exponent [1/s]")
    _labels(right, "excitation frequency η/2π [Hz]", "sum of the exponents [1/s]")
    for axes in (left, right):
        axes.set_xlim(x[0], x[-1])
    head(figure, title, TITLE - 1)
    return figure


def map_of(element: str, damping_ratio: float, points: int) -> PoincareMap:
    """Points of (29) or (30) at η = 2Ω, once per turn of the phase."""
    system = DoubleTripod(damping_ratio=damping_ratio).system(element)
    turn = 2 * np.pi / system.parameters["excitation"]
    return poincare_map(system, points, every=turn, transient=TRANSIENT, tolerance=1e-9)


def map_figure(found: PoincareMap, counts: tuple[int, int], title: str) -> Figure:
    """The map at two numbers of points: Figures 25 to 30."""
    figure, panels = _figure(2)
    for axes, points in zip(panels, counts, strict=True):
        at = found.points[:points, [0, 2]] * np.array([1e6, 1.0])
        size = 8.0 if found.repeat else 2.4 if points < 20_000 else 1.2
        axes.plot(at[:, 0], at[:, 1], marker=".", ls="", color=ACCENT, mew=0, ms=size, rasterized=True)
        if found.repeat:  # one point: shown at the size of the motion
            _about(axes, at[-1], found.size[[0, 2]] * np.array([1e6, 1.0]))
        _named(axes, f"N = {points}" + (", all on one point" if found.repeat else ""))
        _labels(axes, "rotation [µrad]", "rate [rad/s]")
    head(figure, title, TITLE - 1)
    return figure


def estimator_curves(element: str, frequencies: Array, counts: tuple[int, ...] = COUNTS) -> Array:
    """The printed estimator (counts, frequencies, 3) over 0.02 s, from the static rotation."""
    out = np.empty((len(counts), len(frequencies), 3))
    for i, frequency in enumerate(frequencies):
        system = DoubleTripod().system(element, excitation=2 * np.pi * float(frequency))
        p = system.parameters
        start = [p["torque_over_inertia"] / p["natural_frequency"] ** 2, 1.0, 0.1]
        for k, count in enumerate(counts):
            out[k, i] = printed_estimator(system, start, 0.02 / count, count, tolerance=1e-9)
    return out


def estimator_figure(frequencies: Array, curves: Array) -> Figure:
    """The printed estimator of the rotation over η/2π for two numbers of intervals N."""
    figure, (axes,) = _figure(1)
    for count, curve, colour in zip(COUNTS, curves, (ACCENT, VERMILION), strict=True):
        axes.plot(frequencies, curve[:, 0], color=colour, lw=1.3, label=f"N = {count}")
    axes.legend(fontsize=SMALL, frameon=False, loc="best")
    axes.set_xlim(frequencies[0], frequencies[-1])
    _labels(axes, "excitation frequency η/2π [Hz]", "printed “exponent” L₁₁ [log₁₀/s]")
    head(figure, "Not a Lyapunov exponent: it changes with N", TITLE - 1)
    return figure


def _blank(width: float, height: float) -> Figure:
    """A figure laid out at the resolution that it is saved with."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _figure(count: int) -> tuple[Figure, list[Any]]:
    figure = _blank({1: 6.3, 2: 9.6}[count], 3.9)
    grid: Any = figure.subplots(1, count, squeeze=False)
    return figure, list(grid[0])


def _labels(axes: Axes, x: str, y: str) -> None:
    label_axes(axes, x, y)
    axes.ticklabel_format(useOffset=False)


def _named(axes: Axes, name: str) -> None:
    axes.set_title(name, fontsize=SMALL, color="#4a4a4a", loc="left")

"""S4's figures drawn anew: Ω(β), time histories and portraits, exponents over the range, Poincaré maps."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trunnion.arrays import Array
from trunnion.motion.chaos.lyapunov_map import LyapunovSweep
from trunnion.motion.chaos.poincare_map import PoincareMap, poincare_map
from trunnion.motion.simulation.simulate import simulate_system
from trunnion.motion.simulation.simulation import SystemSimulation
from trunnion.papers.double_tripod.estimator import printed_estimator
from trunnion.papers.double_tripod.published import WORST_ANGLE, DoubleTripod
from trunnion.pictures.draw_matplotlib import SMALL, TEXT, TITLE, head, new_figure
from trunnion.pictures.looks import ACCENT, GRID, INK, curve
from trunnion.pictures.picture import Axis, Level, Line, Panel, Picture, points_at, single

HISTORY = 0.12
"""Time drawn [s]; the paper does not state its own."""
DIES_OUT = 12.0
"""Times 1/(ζΩ) after which a motion counts as settled: the start is then below 1e-5 of itself."""
SETTLED = 0.0102
"""Time [s] of the settled portrait: three periods of the motor's torque."""
TRANSIENT = 4000
CROWD = 20_000
"""Points of a map from which on they are drawn as small as can be seen."""
COUNTS = (100, 200)
"""Intervals N of the printed estimator."""


def frequency_figure(element: str) -> Picture:
    """Ω over the joint angle: Figure 9 or 10."""
    beta = np.linspace(0, WORST_ANGLE, 91)
    part = DoubleTripod().element(element)
    line = Line(np.rad2deg(beta), [part.natural_frequency(b) for b in beta], curve(0))
    up = Axis(f"natural frequency of {part.name}", "rad/s")
    return single(Axis("joint angle β", "°", 0.0, 9.0), up, [line], 6.3, 3.9)


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
    figure = new_figure(10.0, 7.2)
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


def exponents_figure(sweep: LyapunovSweep, title: str) -> Picture:
    """Exponents and their sum over η/2π: the panels (a) to (d) of Figures 17 to 24."""
    x = sweep.values / (2 * np.pi)
    across = Axis("excitation frequency η/2π", "Hz", float(x[0]), float(x[-1]))
    whole = sweep.exponents.sum(axis=1)
    total = float(np.mean(whole))
    ends = (total - 0.1 * abs(total), total + 0.1 * abs(total))
    each = [Line(x, sweep.exponents[:, j], curve(j), f"L{j + 1}") for j in range(3)]
    panels = (
        Panel(across, Axis("exponent", "1/s"), [*each, Level(0.0, "zero")], key="inside"),
        Panel(across, Axis("sum of the exponents", "1/s", *ends), [Line(x, whole, "line")]),
    )
    return Picture(panels, 9.6, 3.9, 2, title)


def map_of(element: str, damping_ratio: float, points: int) -> PoincareMap:
    """Points of (29) or (30) at η = 2Ω, once per turn of the phase."""
    system = DoubleTripod(damping_ratio=damping_ratio).system(element)
    turn = 2 * np.pi / system.parameters["excitation"]
    return poincare_map(system, points, every=turn, transient=TRANSIENT, tolerance=1e-9)


def map_figure(found: PoincareMap, counts: tuple[int, int], title: str) -> Picture:
    """The map at two numbers of points: Figures 25 to 30."""
    panels = []
    for points in counts:
        at = found.points[:points, [0, 2]] * np.array([1e6, 1.0])
        across, up = Axis("rotation", "µrad"), Axis("rate", "rad/s")
        if found.repeat:  # one point: shown at the size of the motion
            half = found.size[[0, 2]] * np.array([1e6, 1.0])
            ends = np.stack([at[-1] - half, at[-1] + half]).T
            across, up = Axis("rotation", "µrad", *ends[0]), Axis("rate", "rad/s", *ends[1])
        role = "single point" if found.repeat else "map points" if points < CROWD else "crowded points"
        remark = f"N = {points}" + (", all on one point" if found.repeat else "")
        panels.append(Panel(across, up, [points_at(at, role)], remark=remark))
    return Picture(panels, 9.6, 3.9, 2, title)


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


def estimator_figure(frequencies: Array, curves: Array) -> Picture:
    """The printed estimator of the rotation over η/2π for two numbers of intervals N."""
    items = [Line(frequencies, one[:, 0], curve(k), f"N = {COUNTS[k]}") for k, one in enumerate(curves)]
    across = Axis("excitation frequency η/2π", "Hz", float(frequencies[0]), float(frequencies[-1]))
    up = Axis("printed “exponent” L₁₁", "log₁₀/s")
    return single(across, up, items, 6.3, 3.9, "Not a Lyapunov exponent: it changes with N", key="inside")


def _labels(axes: Axes, x: str, y: str) -> None:
    axes.set_xlabel(x, fontsize=TEXT, color=INK)
    axes.set_ylabel(y, fontsize=TEXT, color=INK)
    axes.grid(color=GRID, lw=0.6)
    axes.tick_params(labelsize=TEXT, colors=INK)
    axes.ticklabel_format(useOffset=False)


def _named(axes: Axes, name: str) -> None:
    axes.set_title(name, fontsize=SMALL, color="#4a4a4a", loc="left")

"""Motions as pictures: time histories, phase portraits, one period of torque, order spectra."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from trunnion.driveline.quantities import TORQUE, shown
from trunnion.motion.orbits.periodic_response import PeriodicResponse
from trunnion.motion.simulation.simulation import LineSimulation, SystemSimulation
from trunnion.plots.style import (
    COLOURS,
    curve_style,
    headed,
    key_below,
    label_axes,
    logarithmic,
    new_axes,
    printed,
)
from trunnion.results.quantity_axes import state_axes
from trunnion.results.speeds import rounded_speed, show_speed
from trunnion.steady.shooting.periodic_orbit import PeriodicOrbit
from trunnion.systems.system import System

POINTS = 6000
"""Points of a curve, about three per pixel of a printed figure."""
MOST_TURNS = 4
"""Turns of a longer period that are drawn."""
DENSE = 400
"""Cycles beyond which a history is drawn as its envelope."""


def draw_history(result: SystemSimulation, axes: Axes | None = None, *, states: tuple[str, ...] = ()) -> Axes:
    """States over time; all of them, or those named."""
    axes = axes or new_axes(7.2, 4.0)
    names, states_shown = states or result.system.states, state_axes(result.system)
    low, high = result.time_range
    times = np.linspace(low, high, POINTS) if len(result.trajectory.coefficients) else result.time
    values = result.at(times) if len(result.trajectory.coefficients) else result.state
    for k, name in enumerate(names):
        i = result.system.states.index(name)
        axes.plot(times, values[:, i] * states_shown[i].factor, label=states_shown[i].label, **_look(k))
    label_axes(axes, "time [s]", "state" if len(names) > 1 else states_shown[i].label)
    if len(names) > 1:
        _legend(axes)
    axes.set_xlim(low, high)
    return axes


def draw_portrait(
    result: SystemSimulation, axes: Axes | None = None, *, x: str = "", y: str = "", from_time: float = 0.0
) -> Axes:
    """One state over another, from ``from_time`` on; by default the second over the first."""
    axes = axes or new_axes(5.2, 4.6)
    names = result.system.states
    i, j = names.index(x) if x else 0, names.index(y) if y else min(1, len(names) - 1)
    low, high = result.time_range
    times = np.linspace(max(low, from_time), high, 4 * POINTS)
    values = result.at(times) if len(result.trajectory.coefficients) else result.state
    shown = state_axes(result.system)
    across, up = shown[i], shown[j]
    axes.plot(values[:, i] * across.factor, values[:, j] * up.factor, color=COLOURS[0], lw=0.7)
    label_axes(axes, across.label, up.label)
    return axes


def draw_orbit(result: PeriodicOrbit, axes: Axes | None = None, *, x: str = "", y: str = "") -> Axes:
    """A periodic motion in the plane of two states, with its state at the start of the period."""
    axes = axes or new_axes(5.2, 4.6)
    i, j = pair_of_states(result.system, x, y)
    shown = state_axes(result.system)
    across, up = shown[i], shown[j]
    axes.plot(result.state[:, i] * across.factor, result.state[:, j] * up.factor, color=COLOURS[0], lw=1.6)
    begin = result.start[[i, j]] * (across.factor, up.factor)
    axes.plot(*begin, "o", color=COLOURS[1], ms=6, label="start of the period")
    label_axes(axes, across.label, up.label)
    _legend(axes)
    return axes


def pair_of_states(system: System, x: str = "", y: str = "", section: str = "") -> tuple[int, int]:
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


def draw_line_history(
    result: LineSimulation, axes: Axes | None = None, *, shafts: tuple[str, ...] = (), unit: str = ""
) -> Axes:
    """Torque of the shafts over time; the envelope where the cycles are too many to tell apart."""
    axes = axes or new_axes(7.2, 4.2)
    chosen = [result.shafts.index(s) for s in shafts] or range(len(result.shafts))
    torque = result.torque
    for k, i in enumerate(chosen):
        look = _look(k)
        if result.turns > DENSE:
            count = max(len(result.time) // 600, 2)
            whole = len(result.time) // count * count
            blocks = torque[:whole, i].reshape(-1, count)
            at = result.time[:whole].reshape(-1, count).mean(axis=1)
            axes.fill_between(
                at, blocks.min(axis=1), blocks.max(axis=1), color=look["color"], alpha=0.35, lw=0.8,
                label=f"{result.shafts[i]} (envelope)",
            )  # fmt: skip
        else:
            axes.plot(result.time, torque[:, i], label=result.shafts[i], **{**look, "lw": 0.9})
    label_axes(axes, "time [s]", "torque [N·m]")
    axes.set_xlim(result.time[0], result.time[-1])
    headed(axes, f"input at {_input_speeds(result, unit or result.unit)}")
    _legend(axes)
    return axes


def _input_speeds(result: LineSimulation, unit: str) -> str:
    """The first and the last speed of the input: of a line that starts free, means of its first and last turn."""
    if not result.starts_free:
        low, high = result.profile.at(np.array([0.0, result.end]))
        return show_speed(low, unit) if low == high else f"{show_speed(low, unit)} to {show_speed(high, unit)}"
    speed = result.whole.turns[1]
    low, high = float(speed[0]) if len(speed) else result.profile.speed[0], result.whole.last_turn()[1]
    first, last = rounded_speed(low, unit), rounded_speed(high, unit)
    return first if first == last else f"{first} in the first turn, {last} in the last"


def draw_period(result: PeriodicResponse, axes: Axes | None = None, *, unit: str = "") -> Axes:
    """Torque of every shaft over one period, with linear theory where it applies.

    Where the means are much larger than what varies, torques are drawn about them and the key names them.
    """
    axes = axes or new_axes(7.2, 4.2)
    degrees = 360 * result.turns * np.arange(len(result.time) + 1) / len(result.time)
    torque, mean = result.torque, result.torque_mean
    about = bool(np.abs(mean).max() > 2 * result.torque_peak_to_peak.max())
    below = mean if about else np.zeros_like(mean)
    for i, name in enumerate(result.shafts):
        label = f"{name}, about {printed(shown(mean[i], TORQUE, digits=4))}" if about else name
        axes.plot(degrees, np.append(torque[:, i], torque[0, i]) - below[i], label=label, **_look(i))
    linear = result.comparison.static_twist.response if result.comparison else None
    if linear is not None:
        repeats = max(int(np.ceil(degrees[-1] / np.rad2deg(linear.tau[-1]) - 1e-9)), 1)
        tau = np.concatenate([np.rad2deg(linear.tau + k * linear.tau[-1]) for k in range(repeats)])
        every = max(len(linear.tau) // 20, 1)
        for i in range(len(result.shafts)):
            axes.plot(
                tau, np.tile(linear.torque[:, i], repeats) - below[i], color=_look(i)["color"], ls="", marker="o",
                mfc="white", ms=3.5, markevery=(i * every // len(result.shafts), every),
                label="linear theory" if i == 0 else None,
            )  # fmt: skip
    label_axes(axes, "input angle [°]", "torque about its mean [N·m]" if about else "torque [N·m]")
    part = result.turns > MOST_TURNS
    axes.set_xlim(0, 360 * MOST_TURNS if part else degrees[-1])
    at = show_speed(result.speed, unit or result.unit)
    title = f"{result.verdict} periodic motion at {at}"
    title += f", {MOST_TURNS} turns of the {result.turns:g} of its period" if part else ""
    headed(axes, title)
    _legend(axes)
    return axes


ROWS, ROW = 4, 0.19
"""Rows of names for which a figure has room, and the height of one more [inches]."""
DECADES, MOST_BARS = 1e4, 40
"""Largest amplitude over the smallest that is drawn; groups of bars that can be told apart side by side."""
HATCHES = ("", "////", "xxxx", "....", "||||", "----", "\\\\\\\\")


def draw_orders(result: PeriodicResponse, axes: Axes | None = None, *, highest: float = 12.0) -> Axes:
    """Torque amplitude of every order, mean left out, on a logarithmic axis of four decades."""
    axes = axes or new_axes(7.2, 4.0)
    orders, amplitude = result.order_spectrum(highest)
    orders, amplitude = orders[1:], amplitude[1:]
    # Of a long period most orders are empty: bars are as wide as those that are not leave room for.
    seen = amplitude.max(axis=1, initial=0.0) > amplitude.max(initial=0.0) / DECADES
    orders, amplitude = orders[seen], amplitude[seen]
    gap = max(float(np.diff(orders, prepend=0.0).min()), highest / MOST_BARS) if len(orders) else 1.0
    count = len(result.shafts)
    width = 0.8 * gap / count
    for i, name in enumerate(result.shafts):
        place = orders + (i - (count - 1) / 2) * width
        # Hatched, for those who print in grey.
        colour, hatch = curve_style(i)["color"], HATCHES[i % len(HATCHES)]
        axes.bar(place, amplitude[:, i], width, label=name, color=colour, hatch=hatch, edgecolor="white", lw=0.3)
    top = float(amplitude.max()) if amplitude.size else 1.0
    if top > 0:
        logarithmic(axes, "y")
        axes.set_ylim(top / DECADES, 2 * top)
    axes.set_xlim(0, highest + gap / 2)
    label_axes(axes, "order [cycles per turn of the input]", "torque amplitude [N·m]")
    _legend(axes)
    return axes


def _look(k: int) -> dict[str, Any]:
    return {**curve_style(k), "lw": 1.3}


def _legend(axes: Axes) -> None:
    labels = axes.get_legend_handles_labels()[1]
    # Four short names stand side by side, or two long ones.
    columns = min(4, max(1, 112 // (12 + max(map(len, labels), default=0))))
    figure, rows = axes.figure.figure, -(-len(labels) // columns)
    if rows > ROWS and len(figure.axes) == 1:  # the curves keep their height
        figure.set_figheight(figure.get_figheight() + ROW * (rows - ROWS))
    key_below(axes, columns, columnspacing=1.5, handlelength=2.6)

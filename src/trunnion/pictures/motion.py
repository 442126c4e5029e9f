"""Motions: time histories, portraits, one period of torque, its orders over speed, a run-up, linear beside true."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.quantities import TORQUE, shown
from trunnion.motion.linearity.linearity_check import LinearityCheck
from trunnion.motion.orbits.periodic_response import PeriodicResponse
from trunnion.motion.passing.run_up import RunUp
from trunnion.motion.simulation.order_map import OrderMap, order_map
from trunnion.motion.simulation.simulation import LineSimulation, SystemSimulation
from trunnion.pictures.looks import curve
from trunnion.pictures.picture import (
    Axis,
    Band,
    Bars,
    ColouredGrid,
    Colours,
    Item,
    Level,
    Line,
    Picture,
    Points,
    points_at,
    single,
)
from trunnion.pictures.shared import axis_of, place_of, printed
from trunnion.results.quantity_axes import state_axes
from trunnion.results.speeds import speed_factor
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words
from trunnion.steady.shooting.periodic_orbit import PeriodicOrbit
from trunnion.systems.system import System

POINTS = 6000
"""Points of a curve, about three per pixel of a printed figure."""
MOST_TURNS = 4
"""Turns of a longer period that are drawn."""
DENSE, BLOCKS = 400, 600
"""Cycles beyond which a history is drawn as its envelope, of so many parts."""
DECADES, MOST_BARS = 1e4, 40
"""Largest amplitude over the smallest that is drawn; groups of bars that can be told apart side by side."""
MAP_DECADES = 3.0
LEAST = 0.01
"""Relative change of the speed over a run that makes it an axis: a free–free line always drifts a bit."""
MOST_ORDERS = 16
"""Orders of a comparison drawn, the largest of them."""
BAR = 0.38
ORDER = Axis("order", "cycles per turn of the input")
TORQUES = Axis("torque", "N m")


def history(result: SystemSimulation, *, states: tuple[str, ...] = ()) -> Picture:
    """States over time; all of them, or those named."""
    names, axes = states or result.system.states, state_axes(result.system)
    low, high = result.time_range
    dense = len(result.trajectory.coefficients) > 0
    times = np.linspace(low, high, POINTS) if dense else result.time
    values = result.at(times) if dense else result.state
    chosen = [result.system.states.index(name) for name in names]
    items = [Line(times, values[:, i] * axes[i].factor, curve(k), axes[i].label) for k, i in enumerate(chosen)]
    up = axis_of(axes[chosen[0]]) if len(names) == 1 else Axis("state")
    return single(Axis("time", "s", low, high), up, items, height=4.0, key="below" if len(names) > 1 else "")


def portrait(result: SystemSimulation, *, x: str = "", y: str = "", from_time: float = 0.0) -> Picture:
    """One state over another, from ``from_time`` on; by default the second over the first."""
    names = result.system.states
    i, j = names.index(x) if x else 0, names.index(y) if y else min(1, len(names) - 1)
    low, high = result.time_range
    times = np.linspace(max(low, from_time), high, 4 * POINTS)
    values = result.at(times) if len(result.trajectory.coefficients) else result.state
    return plane(result.system, i, j, values, "path")


def orbit(result: PeriodicOrbit, *, x: str = "", y: str = "") -> Picture:
    """A periodic motion in the plane of two states, with its state at the start of the period."""
    i, j = pair_of_states(result.system, x, y)
    drawn = plane(result.system, i, j, result.state, "orbit")
    axes = state_axes(result.system)
    start = points_at([result.start[k] * axes[k].factor for k in (i, j)], "start", "start of the period")
    return drawn.with_panel(items=(*drawn.panel.items, start), key="below")


def plane(system: System, i: int, j: int, states: Array, role: str) -> Picture:
    """A path through states (point, state) in the plane of two of them."""
    axes = state_axes(system)
    across, up = axes[i], axes[j]
    path = Line(states[:, i] * across.factor, states[:, j] * up.factor, role)
    return single(axis_of(across), axis_of(up), [path], 5.2, 4.6, key="")


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


def line_history(result: LineSimulation, *, shafts: tuple[str, ...] = (), unit: str = "") -> Picture:
    """Torque of the shafts over time; the envelope where the cycles are too many to tell apart."""
    chosen = [result.shafts.index(s) for s in shafts] or range(len(result.shafts))
    items: list[Item] = []
    for k, i in enumerate(chosen):
        name, torque = result.shafts[i], result.torque[:, i]
        if result.turns > DENSE:
            count = max(len(torque) // BLOCKS, 2)
            whole = len(torque) // count * count
            blocks, at = torque[:whole].reshape(-1, count), result.time[:whole].reshape(-1, count).mean(axis=1)
            items.append(Band(at, blocks.min(axis=1), blocks.max(axis=1), f"envelope {k}", f"{name} (envelope)"))
        else:
            items.append(Line(result.time, torque, curve(k), name))
    across = Axis("time", "s", float(result.time[0]), float(result.time[-1]))
    remark = f"input at {_input_speeds(result, unit or result.unit)}"
    return single(across, TORQUES, items, height=4.2, remark=remark)


def _input_speeds(result: LineSimulation, unit: str) -> str:
    """The first and the last speed of the input: of a free–free line, means of its first and last turn."""
    if not result.starts_free:
        low, high = result.profile.at(np.array([0.0, result.end]))
        return Words(unit).speed(low) if low == high else Words(unit).ends(low, high)
    speed = result.whole.turns[1]
    low, high = float(speed[0]) if len(speed) else result.profile.speed[0], result.whole.last_turn()[1]
    first, last = Words(unit).rounded(low), Words(unit).rounded(high)
    return first if first == last else f"{first} in the first turn, {last} in the last"


def period(result: PeriodicResponse, *, unit: str = "") -> Picture:
    """Torque of every shaft over one period, with linear theory where it applies.

    Where the means are much larger than what varies, torques are drawn about them and the key names them.
    """
    degrees = 360 * result.turns * np.arange(len(result.time) + 1) / len(result.time)
    torque, mean = result.torque, result.torque_mean
    about = bool(np.abs(mean).max() > 2 * result.torque_peak_to_peak.max())
    below = mean if about else np.zeros_like(mean)
    items: list[Item] = []
    for i, shaft in enumerate(result.shafts):
        name = f"{shaft}, about {printed(shown(mean[i], TORQUE, digits=4))}" if about else shaft
        items.append(Line(degrees, np.append(torque[:, i], torque[0, i]) - below[i], curve(i), name))
    linear = result.comparison.static_twist.response if result.comparison else None
    if linear is not None:
        repeats = max(int(np.ceil(degrees[-1] / np.rad2deg(linear.tau[-1]) - 1e-9)), 1)
        tau = np.concatenate([np.rad2deg(linear.tau + k * linear.tau[-1]) for k in range(repeats)])
        every = max(len(linear.tau) // 20, 1)
        for i in range(len(result.shafts)):
            few = slice(i * every // len(result.shafts), None, every)
            values = np.tile(linear.torque[:, i], repeats)[few] - below[i]
            items.append(Points(tau[few], values, f"theory {i}", "" if i else "linear theory"))
    part = result.turns > MOST_TURNS
    end = 360.0 * MOST_TURNS if part else float(degrees[-1])
    remark = f"{result.verdict} periodic motion at {Words(unit or result.unit).speed(result.speed)}"
    remark += f", {MOST_TURNS} turns of the {result.turns:g} of its period" if part else ""
    up = Axis("torque about its mean", "N m") if about else TORQUES
    return single(Axis("input angle", "°", 0.0, end), up, items, height=4.2, remark=remark)


def orders(result: PeriodicResponse, *, highest: float = 12.0) -> Picture:
    """Torque amplitude of every order, mean left out, on a logarithmic axis of four decades."""
    order, amplitude = result.order_spectrum(highest)
    order, amplitude = order[1:], amplitude[1:]
    # Of a long period most orders are empty: bars are as wide as those that are not leave room for.
    seen = amplitude.max(axis=1, initial=0.0) > amplitude.max(initial=0.0) / DECADES
    order, amplitude = order[seen], amplitude[seen]
    gap = max(float(np.diff(order, prepend=0.0).min()), highest / MOST_BARS) if len(order) else 1.0
    count = len(result.shafts)
    width = 0.8 * gap / count
    items = [
        Bars(order + (i - (count - 1) / 2) * width, amplitude[:, i], width, f"bar {i}", name)
        for i, name in enumerate(result.shafts)
    ]
    top = float(amplitude.max()) if amplitude.size else 1.0
    up = Axis("torque amplitude", "N m")
    across = Axis(ORDER.words, ORDER.unit, 0.0, highest + gap / 2)
    return single(across, up.logarithmic(top / DECADES, 2 * top) if top > 0 else up, items, height=4.0)


def map_of_orders(
    result: LineSimulation | OrderMap, *, shaft: str = "", window: int = 8, highest: float = 12.0, unit: str = ""
) -> Picture:
    """Torque amplitude of one shaft (the first, or ``shaft``) over order and speed, three decades below the largest.

    Over input speed where it rises or falls all along, over time where it does not.
    """
    found = result if isinstance(result, OrderMap) else order_map(result, window=window, highest=highest)
    unit = unit or found.unit
    i = found.shafts.index(shaft) if shaft else 0
    change = np.diff(found.speed)
    varies = len(change) and (np.all(change > 0) or np.all(change < 0)) and np.ptp(found.speed) > LEAST * found.speed[0]
    x = found.speed * speed_factor(unit) if varies else found.time
    amplitude = found.amplitude[:, 1:, i]
    top = max(float(amplitude.max()), 1e-300)
    least, order = top / 10**MAP_DECADES, np.argsort(x)
    colours = Colours(f"torque amplitude of {found.shafts[i]} [N m]", "amplitude", least, top, "log")
    mesh = ColouredGrid(x[order], found.order[1:], np.maximum(amplitude[order].T, least), colours)
    across = Axis("input speed", unit) if varies else Axis("time", "s")
    return single(across, ORDER, [mesh], height=4.6, grid="")


def run_up(result: RunUp, *, shaft: str = "", unit: str = "") -> Picture:
    """Largest |torque| of one shaft in every turn (the most loaded one, or ``shaft``) over input speed, or in the turns
    in which its excitations repeat.

    The steady response is drawn where it was computed: full where the motion is stable, dotted where it is not.
    """
    i = result.shafts.index(shaft) if shaft else int(np.argmax(result.peak_torque))
    unit = unit or result.unit
    words = Words(unit)
    factor = words.factor
    items: list[Item] = []
    if result.steady is not None:
        x, y = result.steady.speed * factor, result.steady.largest[:, i]
        unstable = result.steady.verdict == Verdict.UNSTABLE
        items.append(Line(x, np.where(unstable, np.nan, y), "steady", "steady motion, stable"))
        if unstable.any():
            items.append(Points(x[unstable], y[unstable], "steady, unstable", "steady motion, unstable"))
    peak, at = result.peak_torque[i], result.peak_speed[i]
    turns = "turn" if result.period == 1 else f"{result.period} turns"
    items += [
        Level(float(result.inertia_torque[i]), "accelerates", "accelerates what is behind it"),
        Line(result.speed * factor, result.envelope[:, i], "turns", f"largest in each {turns}"),
        Points([at * factor], [peak], "top", f"{peak:.5g} N m at {words.rounded(at)}"),
    ]
    asked = result.schedule
    remark = f"{words.ends(asked.first, asked.last)} at {words.acceleration(asked.acceleration)}"
    if result.ending is not None and result.ending.kind != "reached":
        hung = result.ending.hung_speed
        remark += f": {result.ending.kind} at {words.about(hung)}"
        items.append(Level(hung * factor, "hangs", "where it hangs", "x"))
    up = Axis(f"largest torque of {result.shafts[i]}", "N m", 0.0)
    return single(Axis("input speed", unit), up, items, remark=remark)


def linearity(check: LinearityCheck, *, spring: str | None = None, unit: str | None = None) -> Picture:
    """Two bars an order [N m], linear and nonlinear; a mark at the size of their difference, phases counted.

    Parameters
    ----------
    spring : name of a shaft, mesh or coupling; by default the one where the two are farthest apart.
    unit : of the speed; by default the one of the driveline's description.

    Raises
    ------
    InputError : no such spring; no motion to draw.
    """
    check.nonlinear.outcome.require()
    farthest = 0 if spring else int(np.nanargmax(check.relative_difference))
    remedy = f"it has: {', '.join(check.springs)}"
    s = place_of(spring, check.springs, farthest, "spring", "not a spring of this line", remedy)
    linear, true = np.abs(check.linear_torque[:, s]), np.abs(check.nonlinear_torque[:, s])
    drawn = np.sort(np.argsort(-np.fmax(linear, true), kind="stable")[:MOST_ORDERS])
    x = np.arange(len(drawn))
    items: list[Item] = [
        Bars(x - BAR / 2, linear[drawn], BAR, "linear", "linear"),
        Bars(x + BAR / 2, true[drawn], BAR, "nonlinear", "nonlinear"),
        Points(x, check.difference[drawn, s], "difference", "difference, phases counted"),
    ]
    words = "linear theory holds" if check.holds else "linear theory misleads"
    at = Words(unit or check.unit).speed(check.speed)
    apart = f"apart by {100 * check.relative_difference[s]:.2g} % of the largest order"
    across = Axis(ORDER.words, ORDER.unit, names=[f"{check.order[k]:.4g}" for k in drawn])
    up = Axis(f"torque of {check.springs[s]}", "N m")
    return single(across, up, items, height=3.9, title=f"{at}: {words}, {apart}", key="inside", grid="")

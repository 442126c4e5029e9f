"""Amplitudes of harmonic torques where the speed changes, in pieces that the equations of motion in time read.

A e^{iφ} of an excitation by the square of the speed, by a table over the speed or over the load, or by a share of that,
is taken at the mean speed that the line has at the moment: the input's where it is prescribed, else that of the mean
rotation of the whole line, Σ Jρφ̇/Σ Jρ². The load is the one that is balanced at that speed, as everywhere, without what
accelerates. Over the speed A is a cubic in pieces, between the points of its table and the speeds at which its load
comes to one: exactly so for the square, for tables over the speed, and where the load is a sum of powers of the speed
up to the second; of other loads pieces are halved until A is met within 1e-11 of its largest value.

Beyond the ends of a table the speeds asked for are refused. A free–free line may turn faster or slower than asked: A is
held there, which its motion says.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.driveline.dampers import Damper
from trunnion.driveline.slip_clutches import SlipClutch
from trunnion.equations.amplitudes import beyond
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import DiskTorque, Runnings
from trunnion.equations.line_system import LineSystem
from trunnion.errors import InputError

CLOSE = 1e-11
"""Of the largest amplitude, within which the pieces meet it."""
HALVINGS = 40
"""Of a piece about a bend; what is left then is as narrow as rounding."""
ASKED = 65
"""Speeds at which a table must cover the range asked for."""
PARTS = 16
"""Of the range to begin with, where an amplitude goes by the load."""
ROUNDING = 1e-12
"""Share of the speed by which two bends are apart at least."""
FASTEST, SLOWEST = 2.0, 1e-3
"""Times the speeds asked for, between which a free–free line may turn with its own amplitude."""
REFINED = 4
"""Times that the end of a table is looked for in a thousandth of where it is known to be."""
SWINGS = 0.01
"""Of its speed by which a line may turn beyond a table without a word."""
NODES = np.array([0.0, 0.25, 0.75, 1.0])
"""Of the cubic of a piece, whose ends it meets; Chebyshev's."""
TESTS = np.array([0.07, 0.15, 0.5, 0.6, 0.85, 0.93])
POWERS = np.linalg.inv(NODES[:, None] ** np.arange(4))


def amplitudes_by_speed(line: LineSystem, row: Array, low: float, high: float) -> dict[int, Array]:
    """Of the harmonic torques of ``line`` whose amplitude varies, by their place: what the kernel reads of each
    (piece, 9), at a ``row`` of packed numbers, for input speeds asked for from ``low`` to ``high`` [rad/s].

    Raises
    ------
    InputError : a table that does not cover them; a line parts of which may slip.
    """
    known = refuse_uncovered(line, row, low, high)
    found, edges = dict[int, Array](), dict[object, Array]()
    for h, one in enumerate(line.torques):
        if not one.law.varies:
            continue
        if not one.acts:
            found[h] = np.zeros((1, 9))
            continue
        sense = float(np.sign(line.assembly.topology.mean_speeds[one.station]))
        size = partial(_size, line.assembly, one, row, sense, known)
        if one.law.quadratic_amplitude is not None:
            found[h] = _piece(np.zeros(1), np.array([[0.0, 0.0, size(np.ones(1))[0], 0.0]]))
            continue
        alike = one.element, one.law.axes  # all orders of an element bend at the same speeds
        if alike not in edges:
            edges[alike] = _edges(line.assembly, one, row, low, high)
        found[h] = _pieces(size, edges[alike])
    return found


def refuse_uncovered(line: LineSystem, row: Array, low: float, high: float) -> dict[bytes, Runnings]:
    """Refuse input speeds from ``low`` to ``high`` [rad/s] that the tables of excitations do not cover, and a line
    whose disks may turn otherwise than the whole of it; give how disks run, by the speeds asked for.

    Raises
    ------
    InputError : so.
    """
    known = dict[bytes, Runnings]()
    for one in line.torques:
        if one.law.varies:
            _refuse_slip(line, one)
            _size(line.assembly, one, row, 1.0, known, np.linspace(low, high, ASKED))
    return known


def _refuse_slip(line: LineSystem, one: DiskTorque) -> None:
    topo, elements = line.assembly.topology, line.assembly.line.elements
    slips = any(isinstance(element, SlipClutch) for element in elements)
    oil = any(not isinstance(elements[topo.compliances[e].shafts[0]], Damper) for e in topo.dragged)
    if slips or oil or line.sliders or line.converters:
        raise InputError(
            "has an amplitude by its mean speed, which is not that of the whole line where a clutch, a converter, a "
            "tyre or oil slips", element=one.name, key="excitation",
            remedy="use tn.transient, where it goes by the speed of its own disk, or give it an amplitude",
        )  # fmt: skip


def table_left(line: LineSystem, row: Array, low: float, high: float, speed: Array) -> tuple[str, float] | None:
    """The first excitation whose table does not cover one of the input speeds (m,) [rad/s] at which a line turned, and
    the speed; ``low`` and ``high``: what was asked for, beyond which it may swing a little without a word."""
    within = np.where(speed < low, np.minimum(low, (1 + SWINGS) * speed), speed)
    within = np.where(speed > high, np.maximum(high, (1 - SWINGS) * speed), within)
    looked = set[object]()
    for one in line.torques:
        alike = one.element, one.law.axes
        if one.law.axes and one.acts and alike not in looked:
            looked.add(alike)
            left = _outside(line.assembly, one, row, within)
            if left.any():
                worst = np.where(left, np.maximum(low - speed, speed - high), -np.inf)
                return f"{one.name}.excitation {one.number}", float(speed[int(np.argmax(worst))])
    return None


def _outside(assembly: Assembly, one: DiskTorque, row: Array, speed: Array) -> Flags:
    """Which speeds (m,) [rad/s] the table of a torque does not cover."""
    return np.any([beyond(points, place) for points, place in one.places(assembly, _rows(row, speed))], axis=0)


def _covered(assembly: Assembly, one: DiskTorque, row: Array, low: float, high: float) -> tuple[float, float]:
    """The input speeds [rad/s] about the range from ``low`` to ``high`` that the table of a torque covers without a
    gap, at most far beyond it."""
    found = []
    for begin, end in ((low, SLOWEST * low), (high, FASTEST * high)):
        inner, outer = begin, end
        for _ in range(REFINED):
            speeds = np.linspace(inner, outer, 16 * ASKED)
            left = np.flatnonzero(_outside(assembly, one, row, speeds)) if one.law.axes else np.zeros(0, dtype=np.intp)
            if not len(left):
                inner = outer
                break
            inner, outer = float(speeds[max(left[0] - 1, 0)]), float(speeds[left[0]])
        found.append(float(inner))
    return found[0], found[1]


def _rows(row: Array, speed: Array) -> Array:
    table = np.repeat(row[None], len(speed), axis=0)
    table[:, 0] = speed
    return table


def _size(
    assembly: Assembly, one: DiskTorque, row: Array, sense: float, known: dict[bytes, Runnings], speed: Array
) -> Complex:
    """Its complex amplitude (case,) [N m] in the sense of the line; ``known``: how disks run by the speeds asked for,
    which all orders of a disk ask for alike."""
    return sense * one.size(assembly, _rows(row, speed), known.setdefault(speed.tobytes(), {}))


def _edges(assembly: Assembly, one: DiskTorque, row: Array, low: float, high: float) -> Array:
    """Speeds [rad/s], rising, between which an amplitude is smooth."""
    if assembly.topology.free:
        low, high = _covered(assembly, one, row, low, high)
    inner = [np.array(one.law.speeds) / abs(float(assembly.topology.speed_ratio[one.station]))]
    if one.law.torques or one.law.share is not None:

        def over(speed: Array) -> Array:
            return one.load(assembly, _rows(row, speed))

        grid = np.linspace(low, high, PARTS + 1)
        inner += [grid, _crossings(over, np.array(one.law.torques or (0.0,)), grid)]
    every = np.unique(np.concatenate(inner))
    apart = ROUNDING * high
    within = every[(every > low + apart) & (every < high - apart)]
    return np.concatenate([[low], within[np.diff(within, prepend=low) > apart], [high]])


def _crossings(of: Callable[[Array], Array], values: Array, grid: Array) -> Array:
    """Where a function passes any of ``values`` between the points of a grid."""
    above = of(grid)[:, None] > values
    place, which = np.nonzero(above[1:] != above[:-1])
    if not len(place):
        return np.zeros(0)
    begin, end, first = grid[place], grid[place + 1], above[place, which]
    for _ in range(HALVINGS):
        middle = (begin + end) / 2
        before = (of(middle) > values[which]) == first
        begin, end = np.where(before, middle, begin), np.where(before, end, middle)
    return np.asarray((begin + end) / 2)


def _pieces(size: Callable[[Array], Complex], edges: Array) -> Array:
    """The cubics between ``edges`` (m,) [rad/s] and in their halves, held beyond the first and the last."""
    begin, end = edges[:-1], edges[1:]
    most, starts, powers = 0.0, [edges[:1] - 1.0], [_held(size(edges[:1]))]
    for halving in range(HALVINGS + 1):
        wide = (end - begin)[:, None]
        every = size((begin[:, None] + wide * np.concatenate([NODES, TESTS])).ravel()).reshape(len(begin), -1)
        most = max(most, float(np.abs(every).max()))
        cubic = every[:, : len(NODES)] @ POWERS.T
        off = np.abs(cubic @ (TESTS[:, None] ** np.arange(4)).T - every[:, len(NODES) :]).max(axis=1)
        good = (off <= CLOSE * most) | (halving == HALVINGS)
        starts.append(begin[good])
        powers.append(cubic[good] / wide[good] ** np.arange(4))
        begin, end = begin[~good], end[~good]
        if not len(begin):
            break
        middle = (begin + end) / 2
        begin, end = np.concatenate([begin, middle]), np.concatenate([middle, end])
    starts.append(edges[-1:])
    powers.append(_held(size(edges[-1:])))
    start = np.concatenate(starts)
    order = np.argsort(start, kind="stable")
    return _piece(start[order], np.concatenate(powers)[order])


def _held(value: Complex) -> Complex:
    return np.concatenate([value[:, None], np.zeros((len(value), 3))], axis=1)


def _piece(start: Array, powers: Complex) -> Array:
    return np.concatenate([start[:, None], powers.real, powers.imag], axis=1)

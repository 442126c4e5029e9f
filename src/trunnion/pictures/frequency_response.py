"""Responses over frequency: stable full, unstable dashed, special points and jumps marked; sweeps; basins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.refusals import nearest
from trunnion.motion.orbits.basins import Basins
from trunnion.motion.orbits.branch import PeriodicBranch
from trunnion.motion.orbits.frequency_response import ResponseComparison
from trunnion.motion.orbits.sweep import LineSweep, OscillatorSweep, Sweep, abrupt_changes
from trunnion.pictures.looks import LOOKS
from trunnion.pictures.picture import Arrows, Axis, Cells, Item, Key, Line, Picture, Points, points_at, single
from trunnion.pictures.shared import axis_of, place_of
from trunnion.results.speeds import speed_factor
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words

SWEEPS = {"sweep up": 0.0, "sweep down": 0.5}
"""By what part of the distance between marks they begin later, not to hide each other."""
SWEPT = 36
"""Marks of a sweep, evenly over its range; it may have many more steps."""
MARKS = ("fold", "period doubling", "Neimark–Sacker", "branch point", "grazing")
JUMP = "jump of a slow sweep"
LOOSE = "not of one period"
CONTACTS = ("none", "one-sided", "two-sided")


def branch(result: PeriodicBranch, *, curve: str = "", unit: str = "", jumps: bool = True) -> Picture:
    """One curve (the first, or ``curve``): full where stable, dashed where not, special points marked.

    Parameters
    ----------
    unit : of a speed on the axis, by default that of the line's description.
    jumps : draw an arrow from every fold to the stable motion that is left there.

    Raises
    ------
    InputError : no such curve.
    """
    i = place_of(curve, result.curves, 0, "curve", "not a curve of this branch", nearest(curve, result.curves))
    across = result.axis if not unit or result.label != "speed" else Words(unit).parameter("speed", result.unit)
    x, y, stable = result.parameter * across.factor, result.peak_to_peak[:, i], result.stable
    # A fold or a doubling belongs to both sides, so that the line has no gap.
    between = (result.verdict != Verdict.STABLE) & (result.verdict != Verdict.UNSTABLE)
    items: list[Item] = [Line(x, np.where(stable | between, y, np.nan), "stable branch", "stable")]
    if not stable.all():
        items.append(Line(x, np.where(~stable, y, np.nan), "unstable branch", "unstable"))
    special = [(p.kind, p.parameter * across.factor, float(p.peak_to_peak[i])) for p in result.special]
    items += _special_points(special)
    folds = [(f.parameter, float(f.peak_to_peak[i])) for f in result.folds] if jumps else []
    leaps = [(at, left, _landing(result, at, left, i)) for at, left in folds]
    items += _jumps([(at * across.factor, left, end) for at, left, end in leaps if end is not None], "jump")
    torque = result.curve_unit == "N*m"
    name = result.curves[i]
    up = Axis(f"torque of {name}, peak to peak", "N m", 0.0) if torque else Axis(f"{name}, peak to peak", "", 0.0)
    return single(axis_of(across), up, items, height=4.4)


def _landing(result: PeriodicBranch, value: float, left: float, i: int) -> float | None:
    """The stable motion that a slow passage over a fold jumps to: the nearest other one at that parameter."""
    side = result.parameter - value
    found = []
    for k in np.flatnonzero(side[:-1] * side[1:] < 0):
        share = side[k] / (side[k] - side[k + 1])
        level = result.peak_to_peak[k, i] + share * (result.peak_to_peak[k + 1, i] - result.peak_to_peak[k, i])
        if result.stable[k] and result.stable[k + 1] and abs(level - left) > 0.03 * max(left, level):
            found.append(float(level))
    return min(found, key=lambda level: abs(level - left), default=None)


def response(
    found: Any,
    *,
    length: str = "",
    unit: str | None = None,
    marks: bool = True,
    jumps: bool = True,
    top: float | None = None,
) -> Picture:
    """``responses`` of one method's curve, or of all that a comparison holds."""
    every = found.responses if isinstance(found, ResponseComparison) else {found.method: found}
    return responses(every, length=length, unit=unit, marks=marks, jumps=jumps, top=top)


def responses(
    found: Mapping[str, Any],
    *,
    length: str = "",
    unit: str | None = None,
    marks: bool = True,
    jumps: bool = True,
    top: float | None = None,
) -> Picture:
    """Half peak-to-peak over frequency of several methods.

    Parameters
    ----------
    found : method → response; the special points are those of the first that has any.
    length : unit of x, for the axis.
    unit : of the frequency, ``rad/s``, ``rpm`` or ``Hz``; "" for a number without one; default the description's.
    marks, jumps : draw special points; draw arrows where a slow sweep leaves a fold.
    top : of the vertical axis.
    """
    unit = next((getattr(r, "unit", "rad/s") for r in found.values()), "rad/s") if unit is None else unit
    factor = speed_factor(unit) if unit else 1.0
    items = [item for name, one in found.items() for item in method_curve(name, one, factor)]
    if any(not r.stable.all() for r in found.values() if hasattr(r, "stable")):
        items.append(Key("unstable motions", "unstable"))
    marked = next((r for r in found.values() if any(m[0] in MARKS for m in getattr(r, "marks", ()))), None)
    if marks and marked is not None:
        items += _special_points([(kind, f * factor, a) for kind, f, a in marked.marks])
        items += _jumps([(f * factor, a, end) for f, a, end in _leaps(marked)], "jump", JUMP) if jumps else []
    of, what, own = _followed(found)
    up = Axis(f"half peak-to-peak of {what}", length or own, 0.0, top)
    return single(Axis(of, unit), up, items, height=4.9)


def method_curve(name: str, found: Any, factor: float) -> list[Item]:
    """One method: a line, full where stable and dashed where not; or the marks of a sweep."""
    frequency, size = found.frequency * factor, found.half_peak_to_peak
    if name in SWEEPS:
        every = max(len(frequency) // SWEPT, 1)
        shown = slice(int(SWEEPS[name] * every), None, every)
        return [Points(frequency[shown], size[shown], name, name)]
    role = name if name in LOOKS else "other method"
    return stability_parts(found, role, name, size, frequency)


def stability_parts(found: Any, role: str, name: str, size: Array, frequency: Array) -> list[Item]:
    """A curve, full where stable, up to the middle of a change so that no gap is left, and dashed where not."""
    spread = found.stable.copy()
    spread[1:] |= found.stable[:-1]
    full = Line(frequency, np.where(spread, size, np.nan), role, name)
    broken = Line(frequency, np.where(~found.stable, size, np.nan), f"{role}, unstable", says=f"{name}, unstable")
    return [full, broken]


def _special_points(points: Sequence[tuple[str, float, float]]) -> list[Item]:
    """Kind, place and size of folds and their like."""
    here = {kind: [(x, y) for found, x, y in points if found == kind] for kind in MARKS}
    return [points_at(at, kind, kind) for kind, at in here.items() if at]


def _jumps(leaps: Sequence[tuple[float, float, float]], role: str, name: str = "") -> list[Item]:
    """Arrows at x from one size to another."""
    begin, end = ([(leap[0], leap[k]) for leap in leaps] for k in (1, 2))
    return [Arrows(np.array(begin), np.array(end), role, name)] if leaps else []


def _followed(found: Mapping[str, Any]) -> tuple[str, str, str]:
    """What runs along the axis, what is drawn, and its unit; a driveline's branch knows better than the usual words."""
    first = next((r for r in found.values() if hasattr(r, "detail")), None)
    detail = getattr(first, "detail", None)
    followed: Any = getattr(detail, "branch", detail)
    curve = getattr(first, "curve", "x")
    if getattr(followed, "curve_unit", "") == "N*m":
        return "input speed" if followed.label == "speed" else followed.label, f"the torque of {curve}", "N m"
    return "frequency ω", curve, ""


def _leaps(found: Any) -> list[tuple[float, float, float]]:
    """From every fold to the stable motion that is left there: the nearest in size of the others."""
    leaps = []
    for kind, at, size in found.marks:
        if kind != "fold":
            continue
        side = 1e-4 * at
        left = [a for shift in (side, -side) for a, ok in found.at(at + shift) if ok and abs(a - size) > 0.1 * size]
        both = [a for a in left if abs(a - size) > 0.05 * max(left)]
        if both:
            leaps.append((at, size, min(both, key=lambda a: abs(a - size))))
    return leaps


def sweep(found: OscillatorSweep, *, length: str = "", unit: str | None = None) -> Picture:
    """``sweeps`` of one."""
    return sweeps([found], length=length, unit=unit)


def sweeps(found: Sequence[OscillatorSweep], *, length: str = "", unit: str | None = None) -> Picture:
    """Half peak-to-peak of sweeps, coloured by what is touched (full going up, hollow going down), jumps marked."""
    unit = found[0].unit if unit is None else unit
    factor = speed_factor(unit) if unit else 1.0
    items = [item for one in found for item in _swept(one, one.frequency * factor, one.peak_to_peak / 2, one.contact)]
    return _of_sweeps(items, Axis("frequency ω", unit), Axis("half peak-to-peak of x", length, 0.0), "contact, sweep")


def line_sweep(found: LineSweep, *, spring: str = "", unit: str | None = None) -> Picture:
    """``line_sweeps`` of one."""
    return line_sweeps([found], spring=spring, unit=unit)


def line_sweeps(found: Sequence[LineSweep], *, spring: str = "", unit: str | None = None) -> Picture:
    """Peak-to-peak torque of one spring over speed, in the manner of ``sweeps``; by default the first with a gap.

    Raises
    ------
    InputError : no such spring.
    """
    line, unit = found[0].line, unit or found[0].unit
    name = spring or line.springs[line.staged[0] if len(line.staged) else 0]
    items: list[Item] = []
    for one in found:
        items += _swept(one, one.value * speed_factor(unit), one.swing_of(name), one.contact_of(name))
    across = Axis("speed" if line.independent_variable == "speed" else "frequency", unit)
    return _of_sweeps(items, across, Axis(f"torque of {name}, peak to peak", "N m", 0.0), f"contact of {name}, sweep")


def _swept(one: Sweep, x: Array, size: Array, contact: Sequence[str]) -> list[Item]:
    """``x`` and ``size`` (points,) in the picture's units, with the contact of each point."""
    items: list[Item] = [Line(x, size, "sweep")]
    way = "up" if one.up else "down"
    for kind in CONTACTS:
        here = np.array([c == kind for c in contact])
        if here.any():
            items.append(Points(x[here], size[here], f"{kind}, {way}", f"{kind}, {way}"))
    if not one.settled.all():
        items.append(Points(x[~one.settled], size[~one.settled], "loose", LOOSE))
    leaps = list(abrupt_changes(size))
    if leaps:
        begin, end = (np.array([(x[i + k], size[i + k]) for i in leaps]) for k in (0, 1))
        items.append(Arrows(begin, end, "abrupt", JUMP))
    return items


def _of_sweeps(items: Sequence[Item], across: Axis, up: Axis, title: str) -> Picture:
    """What belongs to both directions comes last in the legend."""
    last = (LOOSE, JUMP)
    return single(across, up, sorted(items, key=lambda item: getattr(item, "name", "") in last), key_title=title)


def basins(found: Basins, *, length: str = "") -> Picture:
    """The plane of starts, one colour per attractor, its start at phase zero as a cross."""
    items: list[Item] = []
    for i, orbit in enumerate(found.attractors):
        words = f"{orbit.contact} contact, half peak-to-peak {orbit.peak_to_peak / 2:.3g}"
        items.append(Cells(found.position, found.velocity, found.number.T == i, f"basin {i}", words))
        x, y = [[value] for value in orbit.start]
        items += [Points(x, y, "attractor ground"), Points(x, y, "attractor", says=[words])]
    if np.any(found.number < 0):
        lost = found.number.T < 0
        items.append(Cells(found.position, found.velocity, lost, "no basin", "no motion of one period"))
    across, up = Axis("x at phase zero", length), Axis("x′ at phase zero", f"{length}/s" if length else "")
    return single(across, up, items, 6.3, 4.9, grid="")

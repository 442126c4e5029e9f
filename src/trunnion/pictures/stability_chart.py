"""A stability chart: white is stable, dark unstable, darker where disturbances grow faster; and as papers print it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.operation import Operation
from trunnion.driveline.parameters import SPEED
from trunnion.floquet.tongues.result import Tongues
from trunnion.modes.resonance_speeds import Resonance, resonance_speeds
from trunnion.pictures.picture import (
    Axis,
    Cells,
    ColouredGrid,
    Colours,
    EdgeNames,
    Item,
    Key,
    Level,
    Line,
    Panel,
    Picture,
    Points,
    Spans,
    edges,
    single,
)
from trunnion.pictures.tongues import edges_of
from trunnion.results.chart import StabilityChart, is_log
from trunnion.results.speeds import speed_factor
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words

OTHERS = {
    Verdict.MARGINAL: ("marginal", "marginal (no damping)"),
    Verdict.UNDECIDED: ("undecided", "undecided (boundary)"),
    Verdict.FAILED: ("failed", "not computed"),
}
"""Role and words of what is neither stable nor unstable."""
DECAYS, STEPS = 7, (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10)
"""Steps of decay at most, and how large they may be beside a power of ten."""
GROWTH = "growth per turn of the input [%]"


def stability_chart(
    chart: StabilityChart,
    *,
    unit: str | None = None,
    resonances: Iterable[Resonance] | None = None,
    operating: Operation | None = None,
    tongues: Tongues | None = None,
) -> Picture:
    """What is stable and what is not over two parameters.

    Parameters
    ----------
    unit : of speeds, "rpm", "Hz" or "rad/s"; default the one of the description.
    resonances : named along the speed axis; default those of the chart's line up to order 2, () for none.
    operating : range and point to mark; default the operation of the chart's line.
    tongues : of the same line over the same axes, drawn as curves; those narrower than a pixel are marked.
    """
    line = chart.line  # None for matrices of one's own
    unit = unit or chart.unit
    operating = operating or (line.operation if line else None)
    x, y, across, up = _axes(chart, unit)
    items = [*_verdicts(chart, x, y), *_folds(chart, x, y), *_operating(chart, operating, across, up, unit)]
    if tongues is not None:
        items += edges_of(tongues, unit, float(np.diff(chart.x).max()) if len(chart.x) > 1 else 0.0)
    if resonances is None and line is not None:
        resonances = resonance_speeds(line)
    items += _named(chart, resonances or (), speed_factor(unit), across, up)
    return single(across, up, items, 6.3, 4.9, _title(chart, unit), grid="")


def paper_panel(
    chart: StabilityChart, x_label: str, y_label: str, limits: tuple[float, float], named: Sequence[Resonance],
    caption: str,
) -> Panel:  # fmt: skip
    """``chart`` in black and white, in the paper's symbols over the paper's speeds; what it leaves out is hatched."""
    items: list[Item] = [
        Cells(chart.x, chart.y, chart.verdict == verdict, role)
        for verdict, role in ((Verdict.UNSTABLE, "printed unstable"), (Verdict.UNDECIDED, "printed undecided"))
        if chart.count(verdict)
    ]
    if chart.x[0] > limits[0]:
        items.append(Spans([(limits[0], float(chart.x[0]))], "not covered"))
    across = Axis(x_label, "", *limits)
    items += _named(chart, named, 1.0, across, across)
    return Panel(across, Axis(y_label, "", float(chart.y[0]), float(chart.y[-1])), items, remark=caption, grid="")


def _axes(chart: StabilityChart, unit: str) -> tuple[Array, Array, Axis, Axis]:
    """Points of both axes in their units, and the axes."""
    found: list[tuple[Array, Axis]] = []
    for values, label, si in ((chart.x, chart.x_label, chart.x_unit), (chart.y, chart.y_label, chart.y_unit)):
        quantity = Words(unit).parameter(label, si)
        shown = values * quantity.factor
        ends = shown if len(shown) > 1 else edges(shown)
        axis = Axis(quantity.quantity, quantity.unit, float(ends[0]), float(ends[-1]))
        found.append((shown, replace(axis, scale="log") if is_log(shown) else axis))
    return found[0][0], found[1][0], found[0][1], found[1][1]


def _verdicts(chart: StabilityChart, x: Array, y: Array) -> list[Item]:
    """Growth where it is unstable, or where all is stable the decay: the margin that is left; the rest by its kind."""
    bad, stable = chart.verdict == Verdict.UNSTABLE, chart.count(Verdict.STABLE)
    with np.errstate(divide="ignore"):
        growth = 100 * np.expm1(np.log(chart.spectral_radius) * 2 * np.pi / chart.period)
    everywhere = stable == chart.verdict.size and min(chart.verdict.shape) > 1
    items: list[Item] = []
    if everywhere:
        words = "stable at every point (yellow: slowest decay)"
        decay = Colours("decay of the slowest disturbance per turn [%]", "decay", *_steps(-growth))
        items += [ColouredGrid(x, y, -growth, decay, growth), Key("stable everywhere", words, "area")]
    else:
        items += [Key("stable", "stable", "area")] if stable else []
        if bad.any():
            colours = Colours(GROWTH, "growth", 0.0, float(growth[bad].max()))
            items.append(ColouredGrid(x, y, np.where(bad, growth, np.nan), colours, growth))
            items.append(Key("unstable", "unstable (stronger: faster)", "area"))
    for verdict, (role, words) in OTHERS.items():
        if chart.count(verdict):
            items.append(Cells(x, y, chart.verdict == verdict, role, words))
    return items


def _folds(chart: StabilityChart, x: Array, y: Array) -> list[Item]:
    """Where the line's own motion folds back, at both ends on every row, and between rows."""
    on_rows = [(at, row) for row, *pair in chart.folds for at in pair]
    between = [(column, at) for column, *pair in chart.column_folds for at in pair]
    (left, right), (low, high) = (axis[[0, -1]] for axis in (chart.x, chart.y))
    ends = [(a, b) for a, b in on_rows if left < a < right and low <= b <= high]
    ends += [(a, b) for a, b in between if left <= a <= right and low < b < high]
    if not ends:
        return []
    across, up = np.array(ends).T
    inside = Points(
        np.interp(across, chart.x, x), np.interp(up, chart.y, y), "fold", "the line's own motion folds back"
    )
    return [inside]


def _steps(decay: Array) -> tuple[float, float, str, Sequence[float]]:
    """Ends, scale and round steps of the colours of a decay."""
    low, high = float(decay.min()), float(decay.max())
    if high <= 1.01 * low:
        levels = np.array([0.99 * low, 1.01 * high])
    else:
        ten = 10.0 ** np.floor(np.log10((high - low) / DECAYS))
        step = next(s * ten for s in STEPS if s * ten * DECAYS >= high - low)
        levels = step * np.arange(np.floor(low / step), np.ceil(high / step) + 1)
    return float(levels[0]), float(levels[-1]), "linear", levels.tolist()


def _operating(chart: StabilityChart, operating: Operation | None, across: Axis, up: Axis, unit: str) -> list[Item]:
    """The range as a bar along each axis' edge, the speed as a dashed line, the point as a diamond."""
    items: list[Item] = []
    here: list[float | None] = []
    for label, si, axis, other in (
        (chart.x_label, chart.x_unit, across, up), (chart.y_label, chart.y_unit, up, across)
    ):  # fmt: skip
        assert axis.low is not None and axis.high is not None and other.low is not None
        factor = Words(unit).parameter(label, si).factor
        low, high = sorted((axis.low, axis.high))
        ends = np.clip(np.multiply(_range_of(label, operating) or (0, 0), factor), low, high)
        if ends[0] < ends[1]:
            edge = np.full(2, other.low)
            name = "" if any(isinstance(one, Line) for one in items) else "operating range"
            x, y = (ends, edge) if axis is across else (edge, ends)
            items.append(Line(x, y, "operating range", name))
        value = _value_of(label, chart.line, operating)
        here.append(value * factor if value is not None and low <= value * factor <= high else None)
    if None not in here:
        return [*items, Points(here[:1], here[1:], "operating point", "operating point")]
    for value, label, on in ((here[0], chart.x_label, "x"), (here[1], chart.y_label, "y")):
        if value is not None and label == SPEED:
            items.append(Level(value, "operating", "operating speed", on))
    return items


def _range_of(label: str, operating: Operation | None) -> tuple[float, float] | None:
    if operating is None:
        return None
    if label == SPEED:
        return operating.speed_range
    return operating.angle_range if label.startswith("HookeJoint") and label.endswith(".angle") else None


def _value_of(label: str, line: Driveline | None, operating: Operation | None) -> float | None:
    """Where the line stands on an axis; None where that is not one number."""
    if label == SPEED:
        return operating.speed if operating else None
    owner, _, key = label.rpartition(".")
    if key != "angle" or line is None:
        return None
    angles = {abs(angle) for name, angle in hooke_joints(line) if owner in (name, "HookeJoint *")}
    return angles.pop() if len(angles) == 1 else None


def _named(chart: StabilityChart, resonances: Iterable[Resonance], factor: float, across: Axis, up: Axis) -> list[Item]:
    """Names of the resonances at which instability can begin, along the axis of the speed, the lowest orders first."""
    if SPEED not in (chart.x_label, chart.y_label):
        return []
    axis, edge = (across, "top") if chart.x_label == SPEED else (up, "right")
    assert axis.low is not None and axis.high is not None
    inside = [r for r in resonances if r.opens and axis.low <= r.speed * factor <= axis.high]
    inside.sort(key=lambda r: (r.order, r.kind != "subharmonic", r.speed))
    says = [f"{r.kind} {r.formula}" for r in inside]
    found = EdgeNames([r.speed * factor for r in inside], [r.formula for r in inside], edge, says)
    return [found] if inside else []


def _title(chart: StabilityChart, unit: str) -> str:
    """The line's name, and below it what is held fixed."""
    line = chart.line
    if line is None:
        return "Stability chart"
    name = line.name or f"driveline of {len(line.elements)} elements"
    fixed = [] if chart.speed is None else [f"at {Words(unit).speed(chart.speed)}"]
    varied = (chart.x_label, chart.y_label)
    if not any(label.startswith(("HookeJoint *", "factor of HookeJoint *")) for label in varied):
        angles = [f"{n} {np.rad2deg(a):.3g}°" for n, a in hooke_joints(line) if f"{n}.angle" not in varied]
        fixed += angles if len(angles) <= 3 else [f"{len(angles)} joint angles as described"]
    return "\n".join([f"Stability of {name}", *([", ".join(fixed)] if fixed else [])])

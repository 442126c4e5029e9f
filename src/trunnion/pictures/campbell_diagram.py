"""Campbell diagram: modes with their margin over speed, excitation lines, crossings by amplification."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.operation import Operation
from trunnion.pictures.picture import Axis, Band, EdgeNames, Item, Line, Picture, Texts, points_at
from trunnion.pictures.shared import over_speed
from trunnion.response.campbell_diagram import CampbellDiagram, ExcitationLine
from trunnion.results.speeds import speed_factor
from trunnion.results.units import amplification_words

HEADROOM = 1.35
"""Height of the picture over the highest mode that is crossed, or else the lowest mode."""


def campbell_diagram(
    result: CampbellDiagram,
    *,
    unit: str | None = None,
    frequency_unit: str = "Hz",
    operating: Operation | None = None,
) -> Picture:
    """Input speed in ``unit`` (default: the description's) across, frequency up.

    The area of a crossing's mark grows with its amplification.
    """
    unit = unit or result.unit
    x, y = speed_factor(unit), speed_factor(frequency_unit)
    speed, top = result.speed, _top(result)
    items: list[Item] = []
    for m, number in enumerate(result.mode):
        w = result.frequency[:, m] * y
        around = "" if m else f"±{100 * result.margin:.3g} % of a mode"
        items += [
            Band(speed * x, (1 - result.margin) * w, (1 + result.margin) * w, "margin", around),
            Line(speed * x, w, "mode", "" if m else "mode", f"mode {number}"),
        ]
    for i, line in enumerate(result.lines):
        at = _ends(result, line)
        items.append(Line(at * x, line.at(at) * y, "excitation", "" if i else "excitation", line.name))
    seen = [c for c in result.crossings if c.frequency <= top]
    if seen:
        gain = np.log2(np.maximum([c.amplification for c in seen], 1.0))
        says = [
            f"{c.line.name} ({', '.join(c.line.owners)}) on mode {c.mode}, "
            f"amplification {amplification_words(c.amplification)}"
            for c in seen
        ]
        places, sizes = [(c.speed * x, c.frequency * y) for c in seen], 5 + 2.2 * np.minimum(gain, 6.0)
        items.append(points_at(places, "crossing", "crossing, larger with 1/(2ζ)", sizes, says))
    items += _names_of_lines(result, top, x, y, operating, [(c.speed, c.frequency) for c in seen])
    last = result.frequency[-1]
    named = [m for m in np.argsort(last) if last[m] < top]
    texts = [f"{result.mode[m]}:  {last[m] * y:.4g} {frequency_unit}" for m in named]
    items.append(EdgeNames(last[named] * y, texts, "right"))
    up = Axis("frequency", frequency_unit, 0.0, top * y)
    return over_speed(speed * x, unit, up, items, operating, height=4.6, grid="")


def _top(result: CampbellDiagram) -> float:
    crossed = [c.frequency for c in result.crossings]
    lowest = float(np.nanmin(result.frequency)) if np.any(np.isfinite(result.frequency)) else float(result.speed[-1])
    reach = max((float(line.at(result.speed[-1])) for line in result.lines), default=lowest)
    return HEADROOM * max([lowest, *crossed]) if crossed else 1.06 * max(lowest, min(reach, HEADROOM * lowest))


def _ends(result: CampbellDiagram, line: ExcitationLine) -> Array:
    """Speeds [rad/s] between which an excitation is a straight line: the range, and where it stands still within it."""
    low, high = result.speed[[0, -1]]
    return np.array([low, line.standstill, high] if low < line.standstill < high else [low, high])


def _names_of_lines(
    result: CampbellDiagram,
    top: float,
    x: float,
    y: float,
    operating: Operation | None,
    marks: list[tuple[float, float]],
) -> list[Item]:
    """Each line's name near where it leaves the picture, beside the operating speed, the ``marks`` of crossings and
    names that would lie on it."""
    found: list[Item] = []
    placed = list(marks)
    wide, high = 0.07 * float(result.speed[-1] - result.speed[0]), 0.03 * top
    taken = [operating.speed] if operating and operating.speed else []
    for line in result.lines:
        begin, end = map(float, _ends(result, line)[-2:])
        if line.order and line.at(end) > top:
            end = line.standstill + top / abs(line.order)
        at = begin + 0.93 * (end - begin)
        while at > begin and (
            any(abs(at - speed) < wide / 2 for speed in taken)
            or any(abs(at - speed) < wide and abs(float(line.at(at)) - height) < high for speed, height in placed)
        ):
            at -= wide / 4
        if at > begin and end > begin and not (line.order and line.at(at) > top):
            text = line.name.removeprefix("order ") if not line.frequency else line.name
            placed.append((at, float(line.at(at))))
            found.append(Texts([at * x], [float(line.at(at)) * y], [text], "excitation name"))
    return found

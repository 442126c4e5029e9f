"""The largest stable value of a parameter over speed, the unstable ranges above it, and the limits beside it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from trunnion.arrays import Array
from trunnion.design.limits.result import LimitKind, StableLimit
from trunnion.driveline.operation import Operation
from trunnion.pictures.picture import Axis, Item, Key, Level, Line, Picture, Points, Shapes, Texts, edges, single
from trunnion.pictures.shared import axis_of, speed_axis
from trunnion.results.counts import counted
from trunnion.results.words import Words

ENDS = "ends of what is stable at every speed"


def stable_limit(
    limit: StableLimit,
    *,
    unit: str = "",
    operating: Operation | None = None,
    values: Mapping[str, float] | None = None,
) -> Picture:
    """Unstable ranges over speed, the largest stable value, and where other limits are reached.

    Parameters
    ----------
    unit : of the speed; default the description's.
    operating : its speed is marked.
    values : where the line stands, by name (SI units); each is a horizontal mark.
    """
    unit = unit or limit.speed_unit
    up, factor = Words(unit).parameter(limit.parameter, limit.unit), Words(unit).factor
    x, y = limit.speed * factor, limit.limit * up.factor
    beyond = limit.kind == LimitKind.BEYOND
    found = limit.whole is not None and len(limit.whole.tongues) > 0
    bounded = found or not beyond.all()
    items: list[Item] = [Key("stable", "stable" if bounded else "stable up to the end of the range", "area")]
    items += [Key("unstable region", "unstable", "area")] if bounded else []
    columns = edges(x)
    items += _columns(limit, columns, up.factor) if limit.whole is None else _regions(limit, up.factor, factor)
    # Between single points a line would claim what is not so.
    few = len(x) == 1 or limit.whole is not None
    name = f"largest stable value at {counted(len(limit.speed), 'speed')}" if bounded else ""
    shown = np.where(beyond, np.nan, y)
    items.append(
        Points(x, shown, "largest stable point", name) if few else Line(x, shown, "largest stable", name)
    )  # fmt: skip
    if found:
        items.append(Key("end of stable", ENDS))
    for k, other in enumerate(o for o in limit.others if np.any(o.reached <= limit.high)):
        reached = np.where(other.reached <= limit.high, other.reached * up.factor, np.nan)
        alone = len(x) == 1  # as wide as what is unstable there
        items.append(
            Line(columns if alone else x, reached.repeat(2) if alone else reached, f"other limit {k}", other.name)
        )
    across = speed_axis(columns if len(x) == 1 else x, unit)
    items += _values(values or {}, limit, up.factor, across)
    if operating and operating.speed:
        items.append(Level(operating.speed * factor, "operating", "operating speed", "x"))
    if not bounded:
        items.append(Texts([0.5], [0.5], ["no instability found"], "boxed words", inside=True))
    return single(across, axis_of(up, limit.low, limit.high), items, height=3.6, grid="")


def _columns(limit: StableLimit, ends: Array, factor: float) -> list[Item]:
    """Every unstable range of every speed, as wide as its column between two of ``ends``."""
    corners = [
        np.array([(ends[i], a), (ends[i + 1], a), (ends[i + 1], b), (ends[i], b)])
        for i, ranges in enumerate(limit.unstable)
        for a, b in (ranges * factor).tolist()
    ]
    return [Shapes(corners, "unstable column")] if corners else []


def _regions(limit: StableLimit, factor: float, speed: float) -> list[Item]:
    """Every unstable region between the lowest and the highest speed, and the ends of what is stable at all of them."""
    assert limit.whole is not None
    tongues = limit.whole.tongues
    shapes = [
        np.column_stack([np.concatenate([t.low, t.high[::-1]]) * speed, np.concatenate([t.y, t.y[::-1]]) * factor])
        for t in tongues
    ]
    says = [str(t.resonance or t.kind) for t in tongues]
    items: list[Item] = [Shapes(shapes, "unstable region", says=says)] if shapes else []
    ends = [end for end in np.unique(limit.whole.windows) if limit.low < end < limit.high]
    return [*items, *(Level(float(end) * factor, "end of stable") for end in ends)]


def _values(values: Mapping[str, float], limit: StableLimit, factor: float, across: Axis) -> list[Item]:
    """Where the line stands: lines across, and names at the right, those of equal values together."""
    together: dict[float, list[str]] = {}
    for name, value in values.items():
        if limit.low <= value <= limit.high:
            together.setdefault(round(value * factor, 6), []).append(name)
    items: list[Item] = []
    below, step_aside = -np.inf, 0
    crowded = 0.07 * (limit.high - limit.low) * factor
    assert across.low is not None and across.high is not None
    for value, names in sorted(together.items()):
        # A label too close above the one below stands to its left.
        step_aside = (step_aside + 1) % 4 if value - below < crowded else 0
        below = value
        x = across.low + (0.995 - 0.16 * step_aside) * (across.high - across.low)
        items += [Level(value, "stands"), Texts([x], [value], [", ".join(names)], "stands name", "above left")]
    return items

"""Temperatures at which couplings settle, over speed."""

from __future__ import annotations

import numpy as np

from trunnion.driveline.operation import Operation
from trunnion.driveline.quantities import FREEZING
from trunnion.pictures.looks import curve
from trunnion.pictures.picture import Axis, Item, Level, Line, Picture
from trunnion.pictures.shared import over_speed, stretches
from trunnion.response.coupling_temperatures import CouplingTemperatures
from trunnion.results.speeds import speed_factor


def coupling_temperatures(
    found: CouplingTemperatures, *, unit: str = "", operating: Operation | None = None
) -> Picture:
    """Temperature of every coupling [°C] from cold, the highest at which it could stay, and what it may have.

    Parameters
    ----------
    unit : of the speed; default the description's.
    operating : its speed is marked.
    """
    unit = unit or found.unit
    x = found.speed * speed_factor(unit)
    items: list[Item] = []
    for c, name in enumerate(found.couplings):
        items.append(Line(x, found.temperature[:, c] - FREEZING, curve(c), name))
        other = np.where(found.settled > 1, found.hottest[:, c], np.nan)
        if np.isfinite(other).any():
            items.append(Line(x, other - FREEZING, "largest", f"{name}, after a hot spell"))
        if np.isfinite(found.ratings[c]):
            items.append(Level(float(found.ratings[c]) - FREEZING, f"limit {c}", f"{name} may have"))
    lost = np.asarray(np.isnan(found.temperature).any(axis=1))
    items += stretches(x, lost, "not reached", "settles nowhere: heats on")
    return over_speed(x, unit, Axis("settled temperature", "°C"), items, operating)

"""Fatigue: cycles over amplitude against the S–N curve, and damage by element and history."""

from __future__ import annotations

import numpy as np

from trunnion.arrays import Array, Flags
from trunnion.design.fatigue.damage import cycles_to_failure
from trunnion.design.fatigue.result import CycleSpectrum, FatigueLife, hours
from trunnion.pictures.looks import curve
from trunnion.pictures.picture import Axis, Bars, Item, Level, Line, Picture, rows, single
from trunnion.pictures.shared import printed

CLASS = 1e-3
"""Share of an amplitude within which cycles are drawn as one."""
DEEPEST = 100.0
"""Amplitudes so many times below the largest are not drawn: no curve makes them count."""
ROOM = 3.0
"""Factor that the axes leave free beyond what is drawn."""
HOUR = 3600.0


def fatigue(found: FatigueLife, *, element: str = "") -> Picture:
    """How many cycles exceed each amplitude, in all and by history, over the operating life; and the S–N curve.

    Amplitudes are those about zero that do what the cycles do, means counted.

    Parameters
    ----------
    element : by default the one that lasts shortest.

    Raises
    ------
    InputError : no such element, or one without cycles.
    """
    spectrum, name = found.spectrum(element), element or found.weakest
    over, words = _span(found)
    top = float(spectrum.reversed[np.isfinite(spectrum.reversed)].max(initial=0.0))
    low, high = (top or spectrum.curve.amplitude) / DEEPEST, max(top, spectrum.curve.amplitude) * ROOM
    symbol, size = spectrum.axis(high)
    drawn = {"all cycles": exceeded(spectrum, np.ones(len(spectrum.rate), dtype=bool), over, low)}
    if len(found.histories) > 1:
        drawn |= {one: exceeded(spectrum, spectrum.history == j, over, low) for j, one in enumerate(found.histories)}
    items: list[Item] = [
        Line(count, amplitude / size, curve(k - 1) if k else "sum", label)
        for k, (label, (count, amplitude)) in enumerate(drawn.items())
        if len(count)
    ]
    stress = np.geomspace(low, high, 400)
    life = cycles_to_failure(spectrum.curve, stress)
    known = np.isfinite(life) & (life > 0)
    items.append(Line(life[known], stress[known] / size, "limit 0", "S–N curve"))
    most = max(float(drawn["all cycles"][0].max(initial=1.0)), spectrum.curve.cycles)
    what = "stress" if spectrum.curve.of_stress else "torque"
    y = Axis(f"{what} amplitude about zero", printed(symbol)).logarithmic(low / size, high / size)
    x = Axis(f"cycles {words} that reach it").logarithmic(1.0, ROOM * most)
    lasts = hours(float(found.life[found.elements.index(name)]))
    return single(x, y, items, title=f"{name}: lasts {lasts}")


def damage(found: FatigueLife) -> Picture:
    """Damage of every element by history, as a share of the sum that is allowed, over the operating life."""
    over, words = _span(found)
    share = 100 * found.damage_rate * over / found.allowed[:, None]
    count, places = len(found.histories), np.arange(len(found.elements))
    thick = 0.8 / max(count, 1)
    bars: list[Item] = [
        Bars(places + (j - (count - 1) / 2) * thick, np.nan_to_num(share[:, j]), thick, f"bar {j}", name, lie=True)
        for j, name in enumerate(found.histories)
    ]
    x = Axis(f"damage {words}, share of what is allowed", "%")
    if np.isfinite(share).any() and np.nansum(share, axis=1).max() >= 50:
        bars.append(Level(100.0, "limit 0", "allowed, all together", "x"))
    height = 1.7 + 0.3 * (count + 0.5) * len(found.elements)
    return single(x, rows(found.elements), bars, 7.6, min(height, 9.0), grid="x")


def _span(found: FatigueLife) -> tuple[float, str]:
    """Seconds that the picture counts over, and how its axis calls them."""
    if found.operating_life is None:
        return HOUR, "in an hour"
    return found.operating_life, f"in {hours(found.operating_life)}"


def exceeded(spectrum: CycleSpectrum, chosen: Flags, over: float, low: float) -> tuple[Array, Array]:
    """A staircase: how many of the chosen cycles reach an amplitude over so many seconds, down to ``low``."""
    amplitude, rate = spectrum.reversed[chosen], spectrum.rate[chosen]
    kept = np.isfinite(amplitude) & (amplitude > low)
    if not np.any(kept):
        return np.zeros(0), np.zeros(0)
    amplitude, rate = amplitude[kept], rate[kept]
    classes, place = np.unique(np.round(np.log(amplitude) / CLASS), return_inverse=True)
    tops = np.zeros(len(classes))
    np.maximum.at(tops, place, amplitude)
    count = np.cumsum(np.bincount(place, rate)[::-1]) * over
    x = np.concatenate([[min(1.0, count[0])], np.repeat(count, 2)])
    return x, np.concatenate([np.repeat(tops[::-1], 2), [low]])

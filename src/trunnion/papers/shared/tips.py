"""Where tongues of instability start: the tip of each named resonance, computed and against its name.

In a window about a resonance speed the chart is evaluated finely; the lowest unstable point whose critical
multiplier is of the resonance's kind (real positive, real negative, complex) is the tongue's tip. With damping
it lies above the axis, and natural frequencies shift with β², so the middle of the tongue is also followed
down to β = 0 by a fit in β²: that intercept is what the name predicts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.modes.resonance_speeds import Resonance
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import Verdict

WINDOW = 0.05
"""Half-width of the window, relative to the resonance speed."""
POINTS = (401, 201)
ABOVE = 0.25
"""How far above its tip a tongue is followed [rad]."""
FOLLOWED = 0.7
"""Largest angle of a tip [rad] from which a tongue is still followed down to 0."""
COMPLEX = 1e-5
"""Imaginary part over modulus above which a multiplier counts as complex."""


@dataclass(frozen=True)
class Tip:
    """Tip of a tongue: speed and angle of its lowest unstable point; ``intercept`` of its middle at β = 0,
    NaN where too few points show it."""

    resonance: Resonance
    speed: float
    angle: float
    intercept: float

    @property
    def found(self) -> bool:
        """Whether the tongue opens in the chart at all."""
        return bool(np.isfinite(self.speed))


def tip(chart: StabilityChart, resonance: Resonance, others: tuple[float, ...] = ()) -> Tip:
    """The tip of ``resonance`` in a chart of speed × angle; ``others`` are resonance speeds not to mistake for it."""
    low, high = _window(resonance.speed, others, float(chart.x.min()), float(chart.x.max()))
    top = float(chart.y.max())
    nothing = Tip(resonance, float("nan"), float("nan"), float("nan"))
    if not low < high:
        return nothing
    fine = chart.zoom((low, high, POINTS[0]), (float(chart.y.min()), top, POINTS[1]))
    inside = (fine.verdict == Verdict.UNSTABLE) & _of_kind(fine.critical_multiplier, resonance.kind)
    tongue = _nearest_tongue(inside, np.abs(fine.x - resonance.speed))
    if tongue is None:
        return nothing
    rows = np.flatnonzero(tongue.any(axis=1))
    first = rows[0]
    column = int(np.argmax(np.where(tongue[first], fine.spectral_radius[first], -np.inf)))
    middle = [
        (float(fine.y[r]), float(fine.x[tongue[r]].mean()))
        for r in rows
        if fine.y[r] <= fine.y[first] + ABOVE and not tongue[r, 0] and not tongue[r, -1]
    ]
    return Tip(resonance, float(fine.x[column]), float(fine.y[first]), _intercept(middle))


def _nearest_tongue(inside: Flags, distance: Array) -> Flags | None:
    """The connected region whose lowest point is nearest to the named speed.

    Regions that come in through the side of the window are tongues of other resonances.
    """
    from scipy.ndimage import label

    regions, count = label(inside, structure=np.ones((3, 3)))
    best, nearest = None, np.inf
    for number in range(1, count + 1):
        region = regions == number
        row = region[np.argmax(region.any(axis=1))]
        if row[0] or row[-1]:
            continue
        if (there := float(distance[row].min())) < nearest:
            best, nearest = region, there
    return best


def _window(speed: float, others: tuple[float, ...], least: float, most: float) -> tuple[float, float]:
    """About the speed, no further than halfway to a neighbour of the same kind."""
    low, high = speed * (1 - WINDOW), speed * (1 + WINDOW)
    for other in others:
        if other < speed * (1 - 1e-9):
            low = max(low, (other + speed) / 2)
        elif other > speed * (1 + 1e-9):
            high = min(high, (other + speed) / 2)
    return max(low, least), min(high, most)


def _of_kind(multiplier: Complex, kind: str) -> Flags:
    real = np.abs(multiplier.imag) <= COMPLEX * np.abs(multiplier)
    if kind in ("sum", "difference"):
        return np.asarray(~real)
    return np.asarray(real & (multiplier.real > 0 if kind == "harmonic" else multiplier.real < 0))


def _intercept(middle: list[tuple[float, float]]) -> float:
    """Speed at β = 0 of a quadratic in β² through the middles of the tongue's rows."""
    if len(middle) < 3:
        return float("nan")
    beta, speed = np.array(middle).T
    degree = 2 if len(middle) > 8 else 1
    return float(np.polynomial.polynomial.polyfit(beta**2, speed, degree)[0])

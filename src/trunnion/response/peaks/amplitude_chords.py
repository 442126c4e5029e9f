"""Amplitudes that follow from the speed or the mean torque, over a range of speeds: a straight line, and how far off it
they may be.

Between the points of its table an amplitude is linear in the speed and in the torque, which is of second degree in the
speed: so it is a cubic, which lies within its coefficients in Bernstein's basis. That it is one is checked at two more
places of each piece.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from trunnion.arrays import Array, Complex
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import DiskTorque

BERNSTEIN = np.array([[6, 0, 0, 0], [-5, 18, -9, 2], [2, -9, 18, -5], [0, 0, 0, 6]]) / 6
"""From values of a cubic at thirds of a piece to its coefficients there."""
BETWEEN = (0.2, 0.7)
"""Shares of a piece at which one looks whether it is a cubic, but for ``CUBIC`` of its size."""
CUBIC = 1e-9


@dataclass(frozen=True)
class AmplitudeChord:
    """A e^{iφ} at the speed middle + p half, −1 ≤ p ≤ 1, is within ``apart`` of centre + p slope; ``centre`` in the
    middle."""

    centre: complex
    slope: complex
    apart: float
    largest: float


def follows(one: DiskTorque) -> bool:
    """Whether the amplitude follows from a table, or is a share of the mean torque."""
    return one.law.stated_as in ("amplitudes", "share")


def amplitude_chord(one: DiskTorque, assembly: Assembly, speeds: tuple[float, float]) -> AmplitudeChord | None:
    """Over all ``speeds`` [rad/s], one or a range; None where it goes along another curve.

    Raises
    ------
    InputError : a table that does not cover them.
    """
    low, high = speeds

    def sizes(places: Array) -> Complex:
        return one.size(assembly, assembly.table(len(places), places))

    centre, *ends = sizes(np.array([(low + high) / 2, low, high])).tolist()
    slope, apart, largest = (ends[1] - ends[0]) / 2, 0.0, abs(centre)
    for a, b in pairwise(_cuts(one, assembly, low, high)):
        places = a + (b - a) * np.array([0, 1 / 3, 2 / 3, 1, *BETWEEN])
        values = sizes(places)
        largest = max(largest, float(np.abs(values).max()))
        off = values - centre - slope * ((2 * places - low - high) / (high - low))
        inside = BERNSTEIN @ off[:4]
        t = np.array(BETWEEN)
        cubic = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=1) @ inside
        if np.abs(cubic - off[4:]).max() > CUBIC * largest:
            return None
        apart = max(apart, float(np.abs(inside).max()) + CUBIC * largest)
    return AmplitudeChord(centre, slope, apart, largest)


def _cuts(one: DiskTorque, assembly: Assembly, low: float, high: float) -> list[float]:
    """Ends of pieces: speeds at which the disk or its torque passes a point of the table."""
    if not low < high:
        return [low, high]
    ratio = abs(float(assembly.topology.speed_ratio[one.station]))
    found = [low, high]
    for over, points in one.law.axes or (("torques", (0.0,)),):
        found += [point / ratio for point in points] if over == "speeds" else _reached(one, assembly, low, high, points)
    return sorted({place for place in found if low <= place <= high})


def _reached(one: DiskTorque, assembly: Assembly, low: float, high: float, points: tuple[float, ...]) -> list[float]:
    """Speeds at which the mean torque, of second degree in the speed, is one of ``points``."""
    middle, half = (low + high) / 2, (high - low) / 2
    least, here, most = (
        -assembly.exciting_load(one.element, assembly.table(3, np.array([low, middle, high])))
    ).tolist()
    square, slope = (least + most) / 2 - here, (most - least) / 2
    roots = [root for point in points for root in np.roots([square, slope, here - point]).tolist()]
    return [middle + half * root.real for root in roots if abs(root.imag) < 1e-6 * (1 + abs(root))]

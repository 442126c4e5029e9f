"""The laws of a harmonic torque's amplitude: constant, by the square of the disk's speed, a share of the mean torque on
it, or from a table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Complex, Flags
from trunnion.driveline.excitation import Excitation
from trunnion.errors import InputError

BEYOND = 1e-9
"""Share by which a speed may lie beyond the end of a table, as rounding."""


@dataclass(frozen=True)
class Running:
    """How a disk runs: ``speed`` (case,) its mean speed [rad/s]; ``torque()`` (case,) the mean torque that it drives
    with [N m]."""

    speed: Array
    torque: Callable[[], Array]


def amplitude(law: Excitation, number: Array, running: Running) -> Complex:
    """A e^{iφ} (case,) [N m] of the packed ``number`` (case,) that it follows from, φ what a table adds to the phase.

    Raises
    ------
    InputError : a speed or a torque beyond the ends of a table.
    """
    return np.asarray(number * LAWS[law.stated_as](law, running)).astype(complex)


def where(law: Excitation, running: Running) -> list[tuple[tuple[float, ...], Array]]:
    """All that the table of ``law`` goes over: points, and where it is read (case,), speeds [rad/s], torques [N m]."""
    return [(points, running.torque() if over == "torques" else running.speed) for over, points in law.axes]


def beyond(points: Sequence[float], place: Array) -> Flags:
    """Which places (case,) lie beyond the ends of what a table goes over."""
    slack = BEYOND * max(abs(point) for point in points)
    return np.asarray(~((place >= points[0] - slack) & (place <= points[-1] + slack)))


def _shape(law: Excitation, running: Running) -> Complex:
    """A e^{iφ} of a table over its largest |A|, linear between its points; over two axes bilinear."""
    read = where(law, running)
    for (over, points), (_, place) in zip(law.axes, read, strict=True):
        if np.any(beyond(points, place)):
            apart = np.maximum(points[0] - place, place - points[-1])
            worst = place[int(np.argmax(np.where(np.isnan(apart), np.inf, apart)))]
            raise InputError(
                law.does_not_cover(over, float(worst)), remedy="extend the table, or narrow the range of speeds"
            )
    phases = np.array(law.phases) if law.phases else np.zeros(len(law.amplitudes))
    values: Complex = (np.array(law.amplitudes) * np.exp(1j * phases) / (law.largest or 1.0)).astype(complex)
    (points, place), *second = read
    if not second:
        return _line(place, points, values)
    (others, load), by_load = second[0], values.reshape(-1, len(points))
    after = np.clip(np.searchsorted(others, load), 1, len(others) - 1)
    share = np.clip((load - np.take(others, after - 1)) / (np.take(others, after) - np.take(others, after - 1)), 0, 1)
    rows = np.stack([_line(place, points, row) for row in by_load], axis=1)
    case = np.arange(len(rows))
    return np.asarray((1 - share) * rows[case, after - 1] + share * rows[case, after])


def _line(place: Array, points: Sequence[float], values: Complex) -> Complex:
    return np.asarray(np.interp(place, points, values.real) + 1j * np.interp(place, points, values.imag))


LAWS: dict[str, Callable[[Excitation, Running], Complex | Array | float]] = {
    "amplitude": lambda law, running: 1.0,
    "quadratic_amplitude": lambda law, running: running.speed**2,
    "share": lambda law, running: np.abs(running.torque()),
    "amplitudes": _shape,
}
"""A over the packed number, by the key that states it (``driveline.excitation.AMPLITUDES``)."""

"""Multipliers of many points at a growing number of steps, from systems whose answers are written out here."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import NDArray

from trunnion.floquet.charts.leading_group import ConvergingMultipliers, settle

Array = NDArray[np.float64]


class Sixth:
    """Points of one multiplier 0.5 + error · steps⁻⁶ beside one that is 0.1; ``asked``: steps by point and run."""

    steps, states = 8, 2

    def __init__(self, error: Array) -> None:
        self.error, self.count = error, len(error)
        self.asked: list[tuple[int, int]] = []

    def monodromies(self, which: NDArray[np.intp], steps: int) -> tuple[Array, Array]:
        self.asked += [(int(point), steps) for point in which]
        z = np.zeros((len(which), 2, 2))
        z[:, 0, 0], z[:, 1, 1] = 0.5 + self.error[which] / steps**6.0, 0.1
        return z, np.ones(len(which))

    def and_also(self, other: Self) -> Self:
        raise AssertionError("one kind of points is settled here")


def test_each_point_takes_as_many_steps_as_it_needs_and_no_more():
    points = Sixth(np.array([0.0, 1e-2, 1.0, 50.0, 4e3]))
    found = ConvergingMultipliers(points, 1)  # type: ignore[arg-type]
    assert settle(found, 1, 1e-9, np.inf)
    # An error e/N⁶ is seen as the change from N/2 to N, of which an eighth is claimed from the second halving on.
    last, before = (points.error * ((found.steps / k) ** -6.0 - (found.steps * 2 / k) ** -6.0) for k in (2, 4))
    assert (last * np.where(found.steps > 16, 1 / 8, 1.0) <= 1e-9).all()
    assert (before * np.where(found.steps > 32, 1 / 8, 1.0) > 1e-9)[found.steps > 16].all()
    assert found.steps.tolist() == [16, 32, 64, 128, 256]
    assert len(points.asked) == len(set(points.asked)), "a run twice"


def test_points_of_unlike_steps_are_sharpened_once_each():
    points = Sixth(np.zeros(3))
    found = ConvergingMultipliers(points, 1)  # type: ignore[arg-type]
    found.sharpen(np.array([2]))
    found.sharpen(np.array([0, 2]))
    assert found.steps.tolist() == [32, 16, 64]

"""Folds of a line's own motion between the points of a chart, in both directions, against arc length followed here:
collocation at even points of half a turn, of equations written here, nothing of the package."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq

import trunnion as tn
from trunnion.floquet.charts.chart_pixels import Pixels
from trunnion.floquet.charts.steady_state_chart import SteadyStatePixels
from trunnion.results.verdict import Verdict
from trunnion.steady.free.periodic_steady_states import SEVERAL, Break

Array = NDArray[np.float64]
POINTS = 40
TAU = np.pi * np.arange(POINTS) / POINTS
SIZE = 2 * POINTS


def rate_matrix() -> Array:
    """d/dτ of a function of half a turn, by its values."""
    order = np.fft.fftfreq(POINTS, 0.5 / POINTS)
    order[POINTS // 2] = 0.0
    return np.asarray(np.fft.ifft(1j * order[:, None] * np.fft.fft(np.eye(POINTS), axis=0), axis=0).real)


D = rate_matrix()


def behind(chi: Array, angle: float) -> tuple[Array, Array]:
    """Output angle of a Hooke's joint and its slope: tan ψ = tan χ/cos β."""
    c, s2 = np.cos(angle), np.sin(angle) ** 2
    turned = np.arctan2((1 - c) * np.sin(chi) * np.cos(chi), c * np.cos(chi) ** 2 + np.sin(chi) ** 2)
    return chi + turned, c / (1 - s2 * np.cos(chi) ** 2)


@dataclass(frozen=True)
class Two:
    """Drive – joint – spring – J₁ – joint – spring – J₂, a load on J₂."""

    speed: float = 1.0
    load: float = 700.0
    damping: tuple[float, float] = (1.0, 0.5)
    angles: tuple[float, float] = (0.5, 0.6)
    stiffness: tuple[float, float] = (9e3, 6e3)
    inertia: tuple[float, float] = (0.7, 0.9)

    def description(self) -> tn.Driveline:
        elements: list[tn.Element] = [tn.ConstantSpeed()]
        for angle, k, c, j in zip(self.angles, self.stiffness, self.damping, self.inertia, strict=True):
            elements += [tn.HookeJoint(angle=angle), tn.Shaft(stiffness=k, damping=c), tn.Disk(inertia=j)]
        return tn.Driveline(elements[:-1] + [tn.Disk(inertia=self.inertia[1], load_torque=self.load)])

    def missing(self, q: Array, v: Array, a: Array) -> Array:
        """Of the balance over Ω² (2, points), of what both turn beyond Ωt and its derivatives by τ."""
        (k1, k2), (c1, c2), (j1, j2), w = self.stiffness, self.damping, self.inertia, self.speed
        first, slope = behind(TAU, self.angles[0])
        second, ratio = behind(TAU + q[0] + np.pi / 2, self.angles[1])
        one = k1 * (TAU + q[0] - first) + c1 * w * (1 + v[0] - slope)
        two = k2 * (TAU + q[1] - second + np.pi / 2) + c2 * w * (1 + v[1] - ratio * (1 + v[0]))
        return np.stack([a[0] - (ratio * two - one) / (j1 * w**2), a[1] + (two + self.load) / (j2 * w**2)])


Family = Callable[[float], Two]


def missing(family: Family, z: Array) -> Array:
    """Of z = (both rotations at all points, parameter)."""
    q = z[:-1].reshape(2, POINTS)
    return family(float(z[-1])).missing(q, q @ D.T, q @ D.T @ D.T).ravel()


def jacobian(family: Family, z: Array) -> Array:
    found, line = np.zeros((SIZE, SIZE + 1)), family(float(z[-1]))
    q = z[:-1].reshape(2, POINTS)
    v, a, e = q @ D.T, q @ D.T @ D.T, 1e-6
    for k in range(2):
        d = np.zeros((2, 1))
        d[k] = e
        by_angle = (line.missing(q + d, v, a) - line.missing(q - d, v, a)) / (2 * e)
        by_speed = (line.missing(q, v + d, a) - line.missing(q, v - d, a)) / (2 * e)
        for i in range(2):
            block = np.diag(by_angle[i]) + by_speed[i][:, None] * D + (D @ D if i == k else 0.0)
            found[i * POINTS : (i + 1) * POINTS, k * POINTS : (k + 1) * POINTS] = block
    step = np.zeros(SIZE + 1)
    step[-1] = e * abs(z[-1])
    found[:, -1] = (missing(family, z + step) - missing(family, z - step)) / (2 * step[-1])
    return found


@dataclass(frozen=True)
class Curve:
    """Followed by arc length, the parameter counted in ``unit``."""

    family: Family
    unit: float

    def corrected(self, start: Array, across: Array) -> tuple[Array, Array] | None:
        """The point of the curve in the plane through ``start`` across a direction, and the tangent there."""
        scale, z = np.append(np.ones(SIZE), self.unit), start
        for _ in range(12):
            matrix = np.vstack([jacobian(self.family, z) * scale, across])
            right = np.append(-missing(self.family, z), across @ ((start - z) / scale))
            change, tangent = np.linalg.solve(matrix, np.stack([right, np.eye(SIZE + 1)[-1]], axis=1)).T
            z = z + change * scale
            if np.abs(change).max() < 1e-10:
                return z, tangent / np.linalg.norm(tangent)
        return None

    def folds(self, low: float, high: float) -> list[float]:
        """Values of the parameter, rising, where the curve from ``low`` turns back before it reaches ``high``."""
        scale, line = np.append(np.ones(SIZE), self.unit), self.family(low)
        twist = -line.load / np.array(line.stiffness)
        start = np.append(np.repeat(np.cumsum(twist), POINTS), low)
        point = self.corrected(start, np.eye(SIZE + 1)[-1])
        assert point is not None
        found, step = [], 0.1
        while point[0][-1] < high:
            z, tangent = point

            def at(length: float, z: Array = z, tangent: Array = tangent) -> tuple[Array, Array] | None:
                return self.corrected(z + length * tangent * scale, tangent)

            further = at(step)
            if further is None or further[1] @ tangent < 0.95:
                step /= 2
                continue
            if further[1][-1] * tangent[-1] < 0:
                length = brentq(lambda one, at=at: at(one)[1][-1], 0.0, step, xtol=1e-9)
                turn = at(length)
                assert turn is not None
                found.append(float(turn[0][-1]))
            point, step = further, min(1.3 * step, 0.5)
        return sorted(found)


@cache
def along_speed(load: float) -> list[float]:
    """Speeds at which the motion of a line turns back under a load."""
    return Curve(lambda speed: Two(speed=speed, load=load), 10.0).folds(70, 81)


def test_folds_narrower_than_a_cell_along_a_row() -> None:
    """No point lies between the two, and all are judged."""
    axes = ("speed", 70.0, 84.0, 3), ("Disk 2.load_torque", 650.0, 800.0, 2)
    chart = tn.stability_chart(Two().description(), *axes, about_steady_state=True)
    assert [y for y, *_ in chart.folds] == [650.0, 800.0]
    load, low, high = chart.folds[0]
    assert [low, high] == pytest.approx(along_speed(load), rel=2e-6)
    assert 77 < low < high < 84
    assert np.isfinite(chart.spectral_radius).all() and not chart.column_folds
    assert "at 2 places the periodic motion folds back between two neighbouring points (the first: " in str(chart)


def test_folds_between_two_rows(tmp_path: Path) -> None:
    """Rows follow the load, on which nothing turns back: what lies between them is crossed by columns."""
    axes = ("Disk 2.load_torque", 650.0, 800.0, 2), ("speed", 70.0, 86.0, 2)
    chart = tn.stability_chart(Two().description(), *axes, about_steady_state=True)
    assert not chart.folds and [x for x, *_ in chart.column_folds] == [650.0, 800.0]
    load, low, high = chart.column_folds[0]
    assert [low, high] == pytest.approx(along_speed(load), rel=2e-6)
    assert "at 2 places the periodic motion folds back between two neighbouring points (the first: " in str(chart)
    path = f"{tmp_path}/chart.nc"
    chart.save(path)
    assert tn.load_chart(path).column_folds == chart.column_folds


WIDE = Two(damping=(0.5, 0.25))
"""So little damped that several points of a chart lie within its folds."""
LOADS, SPEEDS = ("Disk 2.load_torque", 650.0, 750.0, 2), ("speed", 74.0, 86.0, 4)


@cache
def wide_folds(load: float) -> tuple[float, float]:
    low, high = Curve(lambda speed: Two(speed=speed, load=load, damping=WIDE.damping), 10.0).folds(74, 86)
    return low, high


@pytest.mark.parametrize("by_column", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_points_within_a_fold_have_several_motions_whichever_axis_it_lies_along(by_column: bool) -> None:
    """Rows that follow the load within it find nothing that turns back: their columns tell."""
    axes = (LOADS, SPEEDS) if by_column else (SPEEDS, LOADS)
    chart = tn.stability_chart(WIDE.description(), *axes, about_steady_state=True)
    loads, speeds = (chart.x, chart.y) if by_column else (chart.y, chart.x)
    radius = chart.spectral_radius.T if by_column else chart.spectral_radius
    found = chart.column_folds if by_column else chart.folds
    assert [one[0] for one in found] == loads.tolist()
    for load, fold, own in zip(loads.tolist(), found, radius, strict=True):
        low, high = wide_folds(load)
        assert fold[1:] == pytest.approx((low, high), abs=2e-6 * 12)
        inside = (speeds > low) & (speeds < high)
        assert inside.sum() == 1 and (np.isnan(own) == inside).all()
    assert "at 2 points the periodic motion folds back: several belong to one point" in str(chart)
    assert "none was found" not in str(chart) and "not found" not in str(chart)


@pytest.mark.slow
@pytest.mark.parametrize("by_column", [True, False])
def test_single_points_beside_and_within_a_fold(by_column: bool) -> None:
    """Where the row through the point finds no motion, its column leads to one; within the fold that is not judged."""
    axes = (LOADS, SPEEDS) if by_column else (SPEEDS, LOADS)
    chart = tn.stability_chart(WIDE.description(), *axes, about_steady_state=True)
    outside, within = ((700.0, 76.5), (700.0, 79.0)) if by_column else ((76.5, 700.0), (79.0, 700.0))
    assert chart.at(*outside).spectral_radius < 1 and np.isnan(chart.at(*within).spectral_radius)


def test_good_motions_within_the_fold_of_a_column_are_not_judged() -> None:
    """Of rows that judge everything, with one fold of a column that holds two of its three points and one that none."""
    points, x, y = (3, 2), np.array([1.0, 2.0]), np.array([10.0, 20.0, 30.0])
    judged = Pixels(np.full(points, 0.5), np.full(points, 1e-9), np.full(points, 0.5j), np.zeros(points, dtype=np.int8))
    nowhere = np.zeros(points, dtype=bool)
    rows = SteadyStatePixels(judged, nowhere, nowhere | (y[:, None] == 20.0), (), (), np.zeros((*points, 4)))
    found = rows.with_columns(((2.0, Break(5.0, 25.0, SEVERAL)), (1.0, Break(11.0, 12.0, SEVERAL))), y, x)
    assert found.several.tolist() == [[False, True], [False, True], [False, False]]
    assert found.none.tolist() == [[False, False], [True, False], [False, False]]
    assert np.isnan(found.every.radius).tolist() == [[False, True], [False, True], [False, False]]
    assert (found.every.verdict == Verdict.FAILED).tolist() == found.several.tolist()


def test_one_place_is_told_without_counting() -> None:
    line = Two(load=700.0).description()
    axes = ("speed", 70.0, 84.0, 2), ("Shaft 1.damping", 1.0, 12.0, 2)
    assert not Curve(lambda speed: Two(speed=speed, damping=(12.0, 0.5)), 10.0).folds(70, 84)
    said = str(tn.stability_chart(line, *axes, about_steady_state=True))
    assert "at one place the periodic motion folds back between two neighbouring points (Shaft 1.damping = 1, " in said

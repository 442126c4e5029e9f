"""An ideal joint between two Hooke's joints: its angle cannot matter, its plane does, by vectors in space."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import trunnion as tn

FIRST, SECOND, INERTIA, BEHIND, STIFFNESS, DAMPING, SPEED = 0.3, 0.4, 0.2, 0.3, 1e4, 3.0, 140.0
NODES = 256


def line(angle: float, plane: float) -> tn.Driveline:
    """Hooke's joint, shaft, disk, ideal joint, Hooke's joint, disk."""
    return tn.Driveline(
        [tn.ConstantSpeed(), tn.HookeJoint(angle=FIRST), tn.Shaft(stiffness=STIFFNESS, damping=DAMPING),
         tn.Disk(inertia=INERTIA), tn.IdealJoint(angle=angle, plane=plane), tn.HookeJoint(angle=SECOND),
         tn.Disk(inertia=BEHIND)]
    )  # fmt: skip


def _bent(axis: np.ndarray, side: np.ndarray, angle: float) -> np.ndarray:
    return np.cos(angle) * axis + np.sin(angle) * side


def _nonuniformity(arms: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Rotation of a shaft less that of what drives it, at equal steps, from a fork arm (steps, 3) across ``axis``."""
    across = arms[0] / np.linalg.norm(arms[0])
    angle = np.unwrap(np.arctan2(arms @ np.cross(axis, across), arms @ across))
    return np.asarray(angle - np.linspace(0, 2 * np.pi, len(arms), endpoint=False))


def _series(samples: np.ndarray) -> Callable[[float, int], float]:
    """A periodic function and its derivatives from samples over a turn."""
    found, orders = np.fft.rfft(samples) / len(samples), np.arange(len(samples) // 2 + 1)
    found[1:] *= 2
    return lambda at, times: float(np.real((1j * orders) ** times * found @ np.exp(1j * orders * at)))


def radius_in_space(angle: float, plane: float, *, rigid: bool = False) -> float:
    """Spectral radius over half a turn of the periodic motion of ``line`` (``rigid``: of the motion that its shaft
    would make if it did not twist, which linear theory stands on), from pins at right angles in two crosses
    and a constant-velocity joint that turns one shaft's directions into the other's by the shortest rotation."""
    turns = np.linspace(0, 2 * np.pi, NODES, endpoint=False)
    first, side = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    middle = _bent(first, side, FIRST)
    driving = Rotation.from_rotvec(turns[:, None] * first).apply(side)  # its fork begins in the plane of the joint
    driven = np.cross(middle, driving)
    feed = _series(_nonuniformity(driven, middle))
    fork = driven[0] / np.linalg.norm(driven[0])
    # The plane of the first bend, seen from the middle shaft, and that of the ideal joint ``plane`` further round.
    onward = np.cos(FIRST) * side - np.sin(FIRST) * first
    away = Rotation.from_rotvec(plane * middle).apply(onward)
    last = _bent(middle, away, angle)
    carry = Rotation.from_rotvec(angle * np.cross(middle, away))
    forks = carry.apply(Rotation.from_rotvec(turns[:, None] * middle).apply(fork))
    output = _bent(last, carry.apply(away), SECOND)
    behind = _series(_nonuniformity(np.cross(output, forks), output))

    def rate(t: float, y: np.ndarray) -> list[float]:
        drive, speed = SPEED * t + feed(SPEED * t, 0), SPEED * (1 + feed(SPEED * t, 1))
        x, v = (drive, speed) if rigid else y[:2]
        slope, bend, third = 1 + behind(x, 1), behind(x, 2), behind(x, 3)
        mass, by, second = (
            INERTIA + BEHIND * slope**2,
            2 * BEHIND * slope * bend,
            2 * BEHIND * (bend**2 + slope * third),
        )
        push = -STIFFNESS * (x - drive) - DAMPING * (v - speed) - by * v**2 / 2
        a = SPEED**2 * feed(SPEED * t, 2) if rigid else push / mass
        p, q = y[2:].reshape(2, 2)
        return [v, a, *q, *(-(STIFFNESS + second * v**2 / 2 + by * a) * p - (DAMPING + by * v) * q) / mass]

    begin, period = np.array([feed(0.0, 0), SPEED * (1 + feed(0.0, 1))]), np.pi / SPEED
    for _ in range(1 if rigid else 8):
        run = solve_ivp(rate, (0, period), [*begin, 1, 0, 0, 1], method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
        matrix = run[2:].reshape(2, 2)
        begin = begin + np.linalg.solve(np.eye(2) - matrix, run[:2] - [np.pi, 0] - begin)
    return float(np.abs(np.linalg.eigvals(matrix)).max())


@pytest.mark.parametrize("plane", [0.0, 0.7])
def test_the_true_motion_feels_the_plane_and_not_the_angle(plane: float) -> None:
    truth = [radius_in_space(angle, plane) for angle in (0.1, 0.5)]
    assert truth[0] == pytest.approx(truth[1], abs=1e-9)
    for angle in (0.1, 0.5):
        orbit = tn.periodic_response(line(angle, plane), speed=SPEED)
        assert np.abs(orbit.multipliers).max() == pytest.approx(truth[0], abs=1e-7)


def test_stability_counts_the_plane_and_not_the_angle() -> None:
    even, turned, bent = (tn.stability(line(*at), SPEED).spectral_radius for at in ((0.1, 0.0), (0.1, 0.7), (0.5, 0.7)))
    assert bent == turned and abs(turned - even) > 1e-3
    assert even == pytest.approx(radius_in_space(0.1, 0.0, rigid=True), abs=1e-8)
    assert turned == pytest.approx(radius_in_space(0.3, 0.7, rigid=True), abs=1e-8)

"""Torques of many harmonics on one disk: of orders that follow each other evenly or not, and in time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn

RNG = np.random.default_rng(51)
EVEN = [(0.5 * k, 0.0) for k in range(1, 25)]
UNEVEN = [(3.0, 0.0), (0.5, 0.0), (0.5, 40.0), (1.0, 0.0), (1.5, 0.0), (1.5, 0.0), (6.0, 0.0), (2.0, 0.0), (0.0, 25.0)]
TURNED_BACK = [(12.0 - 0.75 * k, 0.0) for k in range(16)]
SPEED, INERTIA, STIFFNESS, DAMPING = 12.0, (0.8, 0.5), (900.0, 700.0), (1.5, 1.0)


@pytest.mark.parametrize("orders", [EVEN, UNEVEN, TURNED_BACK], ids=["even", "uneven", "falling"])
def test_a_torque_of_many_harmonics_moves_a_line_as_its_sum(orders: list[tuple[float, float]]) -> None:
    """J φ″ = Σ A cos(order φ + ν t + phase) and the springs, φ the disk's own angle, its twist included."""
    parts = [
        [(order, frequency, RNG.uniform(2, 9), RNG.uniform(0, 2 * np.pi)) for order, frequency in orders]
        for _ in range(2)
    ]
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=STIFFNESS[0], damping=DAMPING[0]),
            tn.Disk(inertia=INERTIA[0], excitation=[stated(*one) for one in parts[0]]),
            tn.Shaft(stiffness=STIFFNESS[1], damping=DAMPING[1]),
            tn.Disk(inertia=INERTIA[1], excitation=[stated(*one) for one in parts[1]]),
        ]
    )

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        angle = SPEED * t + y[:2]
        push = [sum(a * np.cos(k * angle[i] + v * t + p) for k, v, a, p in parts[i]) for i in range(2)]
        first = STIFFNESS[0] * y[0] + DAMPING[0] * y[2]
        second = STIFFNESS[1] * (y[1] - y[0]) + DAMPING[1] * (y[3] - y[2])
        return np.array([y[2], y[3], (push[0] - first + second) / INERTIA[0], (push[1] - second) / INERTIA[1]])

    start = np.array([0.05, -0.1, 0.0, 0.3])
    run = tn.simulate(line, 2.0, speed=SPEED, start=start, tolerance=1e-11)
    own = solve_ivp(slope, (0, 2.0), start, "DOP853", rtol=1e-11, atol=1e-13)
    assert run.state[-1] == pytest.approx(own.y[:, -1], rel=1e-7, abs=1e-8)


def stated(order: float, frequency: float, amplitude: float, phase: float) -> dict[str, float]:
    """As a disk states a harmonic."""
    turning = {"order": order} if order else {}
    timed = {"frequency": frequency} if frequency else {}
    return {**turning, **timed, "amplitude": amplitude, "phase": phase}

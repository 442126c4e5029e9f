"""The untuned viscous damper (Houdaille): a disk of inertia J_d coupled to a disk J by oil alone, no spring.

Of K − J − c − J_d, shaken at J, the largest rotation over frequency is smallest for c/(2 √(KJ)) = μ/√(2(1 + μ)(2 + μ)),
μ = J_d/J, and then (1 + 2/μ) times the static one: every curve over frequency passes one point of that height, and the
best damping has its top there. For μ = 1 the ratio is 0.2887.

Read: a textbook on automotive chassis engineering, equation 5.47 and figure 5.17 (0.288 for μ = 1), with damping over
the first disk's critical one.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import trunnion as tn

INERTIA, STIFFNESS, TORQUE = 1.0, 1e4, 10.0
NATURAL = np.sqrt(STIFFNESS / INERTIA)
NOTHING = 1e-6
"""Stiffness beside the oil [N m/rad], a ten-thousand-millionth of the spring's."""


def line(mu: float, damping: float) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=STIFFNESS, name="spring"),
            tn.Disk(inertia=INERTIA, excitation=[{"order": 1, "amplitude": TORQUE}]),
            tn.Shaft(stiffness=NOTHING, damping=damping, name="oil"),
            tn.Disk(inertia=mu * INERTIA),
        ]
    )


def closed(mu: float) -> float:
    """Best c [N m s/rad]."""
    return 2 * np.sqrt(STIFFNESS * INERTIA) * mu / np.sqrt(2 * (1 + mu) * (2 + mu))


def written_out(mu: float, damping: float, speed: np.ndarray) -> np.ndarray:
    """|θ| K/T of the two equations, the second eliminated."""
    oil = 1j * speed * damping
    behind = oil * (-(speed**2) * mu * INERTIA) / (oil - speed**2 * mu * INERTIA)
    return np.abs(STIFFNESS / (STIFFNESS - speed**2 * INERTIA + behind))


def largest(mu: float, damping: float) -> float:
    """Largest torque of the spring over the static one, by ``order_response`` on a grid and between its points."""

    def at(speed: float) -> float:
        return -float(tn.order_response(line(mu, damping), [speed]).vibratory_torque[0, 0]) / TORQUE

    grid = np.linspace(0.3, 1.3, 101) * NATURAL
    found = tn.order_response(line(mu, damping), grid)
    middle = grid[int(np.argmax(found.vibratory_torque[:, found.springs.index("spring")]))]
    ends = middle - 0.01 * NATURAL, middle + 0.01 * NATURAL
    return -float(minimize_scalar(at, bounds=ends, method="bounded", options={"xatol": 1e-7 * NATURAL}).fun)


@pytest.mark.parametrize("mu", [0.25, 1.0, 2.5])
def test_response_is_that_of_the_equations(mu: float) -> None:
    speed = np.linspace(20.0, 200.0, 91)
    for share in (0.1, 1.0, 10.0):
        found = tn.order_response(line(mu, share * closed(mu)), speed)
        torque = found.vibratory_torque[:, found.springs.index("spring")] / TORQUE
        assert torque == pytest.approx(written_out(mu, share * closed(mu), speed), rel=1e-8)


def test_ratio_at_equal_inertias() -> None:
    assert closed(1.0) / (2 * np.sqrt(STIFFNESS * INERTIA)) == pytest.approx(0.288675, abs=1e-6)


@pytest.mark.parametrize("mu", [0.25, 1.0, 2.5])
def test_smallest_largest_response(mu: float) -> None:
    best = minimize_scalar(lambda c: largest(mu, c), bounds=(0.5 * closed(mu), 2 * closed(mu)), method="bounded",
        options={"xatol": 1e-4 * closed(mu)})  # fmt: skip
    assert best.x == pytest.approx(closed(mu), rel=2e-3)
    assert best.fun == pytest.approx(1 + 2 / mu, rel=1e-6)


def test_optimise_finds_it() -> None:
    best = tn.optimise(
        line(1.0, 10.0), {"oil.damping": (5.0, 500.0)}, "peak torque of spring", (30.0, 130.0), checks=False, designs=20
    )
    assert best.values["oil.damping"] == pytest.approx(closed(1.0), rel=5e-3)
    assert best.aim[0] == pytest.approx(3 * TORQUE, rel=1e-5)

"""The coaster of the examples against a mass–elastic table written out by hand and solved order by order.

Nothing of the package is shared: pressures are read from the CSV, the slider crank is differentiated in closed form,
harmonics are means over 46 080 angles, shafts are Gπd⁴/(32 L) with half of their inertia at each end, and the rest is
one dense solve an order.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn

EXAMPLES = Path(__file__).parents[2] / "examples"
BORE, STROKE, ROD, PISTON, RATIO = 0.23, 0.3, 0.58, 38.0, 3.0
G, DENSITY = 79.3e9, 7850.0  # of "steel", see docs/components.md
ORDERS = np.arange(0.5, 12.01, 0.5)
BLADES = 4 / RATIO
FIRING = {cylinder: 4 * np.pi / 6 * place for place, cylinder in enumerate((1, 5, 3, 6, 2, 4))}
NOSE, RING, THROWS, FLYWHEEL, PINION, FLANGE, PROPELLER = 0, 1, range(2, 8), 8, 9, 10, 11
ANGLE = np.arange(720 * 64) * 4 * np.pi / (720 * 64) - 2 * np.pi


def lever() -> np.ndarray:
    """−dx/dθ of the piston [m]."""
    r, sine, cosine = STROKE / 2, np.sin(ANGLE), np.cos(ANGLE)
    return r * sine + r**2 * sine * cosine / np.sqrt(ROD**2 - (r * sine) ** 2)


def spectrum(wave: np.ndarray) -> np.ndarray:
    return np.array([2 * np.mean(wave * np.exp(-1j * k * ANGLE)) for k in ORDERS])


def gas() -> tuple[np.ndarray, np.ndarray]:
    """Mean torque of a cylinder at every load of the file, rising, and its harmonics."""
    curves: dict[str, list[tuple[float, float]]] = {}
    with open(EXAMPLES / "six-cylinder-ship.csv", encoding="utf-8", newline="") as file:
        for load, angle, pressure in list(csv.reader(file))[1:]:
            curves.setdefault(load, []).append((np.deg2rad(float(angle)), 1e5 * float(pressure)))
    found = []
    for points in curves.values():
        at, pressure = np.array(sorted(points)).T
        torque = (np.interp(ANGLE, at, pressure, period=4 * np.pi) - 101325.0) * np.pi / 4 * BORE**2 * lever()
        found.append((torque.mean(), spectrum(torque)))
    found.sort(key=lambda one: one[0])
    return np.array([mean for mean, _ in found]), np.array([row for _, row in found])


def by_hand(speed: float) -> dict[str, dict[float, complex]]:
    """Torque [N m] of every shaft by order, referred to the crank."""
    kinetic = PISTON * lever() ** 2 / 2  # over ω²
    inertial = -1j * ORDERS * spectrum(kinetic) * speed**2
    heavy = [DENSITY * np.pi * d**4 / 32 * length / RATIO**2 for d, length in ((0.21, 4.0), (0.24, 5.0))]
    inertia = np.array([2.0, 8.0, *[3.2 + 2 * kinetic.mean()] * 6, 110.0, 5.0, 0.0, 0.0])
    inertia[[PINION, FLANGE, PROPELLER]] += np.array([75.0, 8.0, 700.0]) / RATIO**2
    inertia[[PINION, FLANGE]] += heavy[0] / 2
    inertia[[FLANGE, PROPELLER]] += heavy[1] / 2
    tubes = [G * np.pi * d**4 / 32 / length / RATIO**2 for d, length in ((0.21, 4.0), (0.24, 5.0))]
    springs = {
        "damper": (NOSE, RING, 0.0, 1500.0),
        "nose shaft": (NOSE, THROWS[0], 8e6, 0.0),
        **{f"engine.crank {j}-{j + 1}": (j + 1, j + 2, 1e7, 0.01 * 1e7 / (2 * np.pi * 50)) for j in range(1, 6)},
        "shaft to flywheel": (THROWS[-1], FLYWHEEL, 12e6, 0.0),
        "flexible coupling": (FLYWHEEL, PINION, 70e3, 1.1 / (2 * np.pi) * 70e3 / (2 * np.pi * 10)),
        "intermediate shaft": (PINION, FLANGE, tubes[0], 0.0),
        "propeller shaft": (FLANGE, PROPELLER, tubes[1], 0.0),
    }
    stiffness, damping, incidence = np.zeros((12, 12)), np.zeros((12, 12)), {}
    for name, (a, b, k, c) in springs.items():
        row = np.zeros(12)
        row[a], row[b] = 1.0, -1.0
        incidence[name] = row
        stiffness, damping = stiffness + k * np.outer(row, row), damping + c * np.outer(row, row)
    damping[PROPELLER, PROPELLER] += 2 * 52.0 * (speed / RATIO) / RATIO**2
    mean = 52.0 * (speed / RATIO) ** 2 / RATIO  # at the crank
    drives = np.zeros(12)
    drives[list(THROWS)], drives[PROPELLER] = mean / 6, -mean
    held = [
        i for i in range(12) if i not in (RING, THROWS[0])
    ]  # the ring turns with the nose; angles count from throw 1
    twist = np.zeros(12)
    twist[held] = np.linalg.solve(stiffness[np.ix_(held, held)], drives[held])

    def solved(order: float, torque: np.ndarray) -> dict[str, complex]:
        w = order * speed
        swing = np.linalg.solve(stiffness + 1j * w * damping - w**2 * np.diag(inertia), torque)
        return {name: (springs[name][2] + 1j * w * springs[name][3]) * (row @ swing) for name, row in incidence.items()}

    means, table = gas()
    cylinder = [
        np.interp(mean / 6, means, column.real) + 1j * np.interp(mean / 6, means, column.imag) for column in table.T
    ]
    found: dict[str, dict[float, complex]] = {name: {} for name in springs}
    for order, amplitude in zip(ORDERS, np.array(cylinder) + inertial, strict=True):
        torque = np.zeros(12, dtype=complex)
        for number, angle in FIRING.items():
            place = THROWS[number - 1]
            torque[place] = amplitude * np.exp(-1j * order * (angle - twist[place]))
        for name, value in solved(order, torque).items():
            found[name][order] = value
    blades = np.zeros(12, dtype=complex)
    rpm = speed / RATIO * 30 / np.pi
    blades[PROPELLER] = np.interp(rpm, [90.0, 270.0], [400.0, 3000.0]) / RATIO * np.exp(1j * BLADES * twist[PROPELLER])
    for name, value in solved(BLADES, blades).items():
        found[name][BLADES] = value
    return found


@pytest.mark.parametrize("rpm", [313.0, 607.3, 780.0])
def test_orders_and_synthesis_of_the_coaster(rpm: float) -> None:
    """The vibratory torque of every shaft, half of peak to peak over the six turns after which all repeats."""
    line = tn.load(EXAMPLES / "six-cylinder-ship.toml")
    expected = by_hand(rpm * np.pi / 30)
    found = tn.order_response(line, [rpm * np.pi / 30])
    turned = np.linspace(0, 12 * np.pi, 60_001)
    for s, name in enumerate(found.springs):
        own = RATIO if name in ("intermediate shaft", "propeller shaft") else 1.0
        orders = np.array([expected[name][min(expected[name], key=lambda k: abs(k - order))] for order in found.order])
        largest = np.abs(orders).max()
        assert np.abs(found.torque[0, :, s]) / own == pytest.approx(np.abs(orders), abs=1e-6 * largest)
        wave = sum((c * np.exp(1j * k * turned)).real for k, c in expected[name].items())
        assert found.vibratory_torque[0, s] / own == pytest.approx(np.ptp(wave) / 2, rel=1e-5)

"""Models of others whose responses are drawn only, or whose equations are short: solved here a second time."""

from __future__ import annotations

import numpy as np
import pytest
from published.cases.chains import motorcycle_crank, turbine_generator, wind_turbine

import trunnion as tn


def test_responses_of_the_wind_turbine() -> None:
    """Sopanen, Ruuskanen, Nerg and Pyrhönen (2011): three equations, the ripple of the generator by order."""
    k1, k2, j = 3.67e8, 5.496e9, np.array([1e7, 5770.0, 97030.0])
    share = {4: 0.0018, 6: 0.0179, 8: 0.0024, 10: 0.0034, 12: 0.0117, 14: 0.0018, 16: 0.0011}
    c1, c2 = 4e-4 * k1, 4e-5 * k2
    speed = tn.rpm(np.array([1.5, 4.0, 15.0]))
    found = tn.order_response(wind_turbine(), speed)
    assert found.order.tolist() == [60.0 * v for v in share]
    for s, w in enumerate(speed):
        for k, (v, a) in enumerate(share.items()):
            nu = 60 * v * w
            z1, z2 = k1 + 1j * nu * c1, k2 + 1j * nu * c2
            matrix = np.array([[z1, -z1, 0], [-z1, z1 + z2, -z2], [0, -z2, z2]]) - nu**2 * np.diag(j)
            # The ripple follows the generator, which the load holds back by its static twist.
            behind = 60 * v * 2.9e6 * (1 / k1 + 1 / k2)
            y = np.linalg.solve(matrix, [0, 0, 2.9e6 * a * np.exp(-1j * behind)])
            assert found.torque[s, k] == pytest.approx([z1 * (y[1] - y[0]), z2 * (y[2] - y[1])], rel=1e-8)


def test_frequencies_of_the_turbine_generator() -> None:
    """IEEE's first benchmark: its equations of six inertias and five stiffnesses."""
    base = 2 * np.pi * 60.0
    h = np.array([0.092897, 0.155589, 0.858670, 0.884215, 0.868495, 0.0342165])
    k = np.array([19.303, 34.929, 52.038, 70.858, 2.822])
    ends = np.diff(np.eye(6), axis=0)
    squares = np.linalg.eigvals(np.diag(base / (2 * h)) @ ends.T @ np.diag(k) @ ends).real
    found = tn.natural_frequencies(turbine_generator()).hertz[1:]
    assert found == pytest.approx(np.sqrt(np.sort(squares)[1:]) / (2 * np.pi), rel=1e-10)


def test_frequencies_of_the_motorcycle_crank() -> None:
    """Biedenkopf's six masses by Holzer's recursion: at a natural frequency no torque is left behind the last one."""
    j = [0.0000199, 0.0016958, 0.0021595, 0.0018157, 0.0012602, 0.0000154]
    k = [one * 180 / np.pi for one in (3014, 2562, 2430, 2636, 2562)]

    def left(hertz: float) -> float:
        square, angle, torque = (2 * np.pi * hertz) ** 2, 1.0, 0.0
        for i, inertia in enumerate(j):
            torque += inertia * square * angle
            angle -= torque / k[i] if i < len(k) else 0.0
        return torque

    for number, found in enumerate(tn.natural_frequencies(motorcycle_crank()).hertz[1:], start=1):
        below, above = left(found * (1 - 1e-9)), left(found * (1 + 1e-9))
        assert below * above < 0, number

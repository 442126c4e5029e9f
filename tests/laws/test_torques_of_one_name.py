"""Vibratory torque without S_f, rated torque with it: each one number, in every analysis that prints it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import trunnion as tn

K, C, J1, J2 = 2e4, 12.0, 0.5, 0.9
ORDERS = {1.5: 300.0, 3.0: 120.0}
LOW, HIGH = tn.rpm(300), tn.rpm(2400)


def line(temperature: float = 1.0) -> tn.Driveline:
    engine = tn.Disk(name="engine", inertia=J1, excitation=[{"order": k, "amplitude": m} for k, m in ORDERS.items()])
    coupling = tn.Coupling(name="coupling", stiffness=K, damping=C, vibratory_torque="800 N*m")
    limits = [tn.Limit(of="coupling", temperature_factor=temperature, vibratory_torque="2 kN*m")]
    operation = tn.Operation(speed_range=("300 rpm", "2400 rpm"), speed="1500 rpm")
    return tn.Driveline([engine, coupling, tn.Disk(name="load", inertia=J2)], operation=operation, limits=limits)


def amplitude(order: float, speed: float) -> float:
    """Of the torque between two inertias, one of them shaken: T = M (k + icω)/(1 + J₁/J₂)/(k + icω − Jω²)·…"""
    w = order * speed
    spring = K + 1j * C * w
    return abs(ORDERS[order] * spring / J1 / (spring * (1 / J1 + 1 / J2) - w * w))


def rated(speed: float) -> float:
    """Σ S_f|T|, S_f = √(f/10 Hz) above 10 Hz."""
    return sum(np.sqrt(max(k * speed / (2 * np.pi) / 10, 1.0)) * amplitude(k, speed) for k in ORDERS)


def swing(speed: float) -> float:
    """Half of the peak to peak of both orders with their phases, on a fine grid of the cycle."""
    angle = np.linspace(0, 4 * np.pi, 2001)
    torque = np.zeros_like(angle)
    for k, moment in ORDERS.items():
        spring = K + 1j * C * k * speed
        value = moment * spring / J1 / (spring * (1 / J1 + 1 / J2) - (k * speed) ** 2)
        torque += (value * np.exp(1j * k * angle)).real
    return float(np.ptp(torque) / 2)


def largest(of, low: float = LOW, high: float = HIGH) -> float:
    """Over the range: the best of a fine grid, refined."""
    grid = np.linspace(low, high, 601)
    at = int(np.argmax([of(one) for one in grid]))
    ends = grid[max(at - 1, 0)], grid[min(at + 1, len(grid) - 1)]
    return -float(minimize_scalar(lambda n: -of(n), bounds=ends, method="bounded", options={"xatol": 1e-9}).fun)


def test_each_torque_is_one_number_in_every_room(run, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    one = line()
    Path("one.toml").write_text(tn.dumps(one), encoding="utf-8")
    expected = {"vibratory": largest(swing), "rated": largest(rated)}
    assert expected["rated"] > 1.5 * expected["vibratory"]  # so that no room can take one for the other
    judged = tn.assess(one)
    changed = tn.compare(one, one.replace("load", inertia=1.0))
    response = tn.order_response(one, tn.sweep_speeds(one, LOW, HIGH))
    shown = json.loads(run("order-response", "one.toml", "--json").stdout)["springs"][0]
    row, columns = response.table()[0], {"vibratory": response.vibratory_torque, "rated": response.rated_torque}
    checks = {"vibratory": "vibratory torque of coupling", "rated": "rated torque of coupling"}
    for name, column in columns.items():
        values = [
            judged.check(checks[name]).value,
            changed.difference(f"{name} torque of coupling").before,
            response.largest(column[:, 0])[0],
            shown[f"{name}_torque"],
            row[f"{name} torque [N m]"],
        ]
        assert values == pytest.approx([expected[name]] * len(values), rel=1.5e-3), name
    assert "rated torque, Σ S_f|T|, up to" in str(response)
    assert "upper bound" in judged.check(checks["rated"]).because


def test_a_hot_coupling_bears_less_and_is_loaded_alike() -> None:
    """S_t lowers T_KW: the rated torque stays the number that it is, the margin falls."""
    cold, hot = (tn.assess(line(factor)).check("rated torque of coupling") for factor in (1.0, 1.4))
    assert hot.value == pytest.approx(cold.value, rel=1e-12) and hot.limit == pytest.approx(cold.limit / 1.4)
    assert hot.margin == pytest.approx(1 - cold.value * 1.4 / 800.0)

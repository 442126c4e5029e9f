"""An Engine that is given a torque: its gas torques follow the load of every instant, against equations written out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

import trunnion as tn

THROW, LOAD, CRANK, SHAFT, DAMPING = 0.2, 3.0, 4e5, 9e3, 8.0
SPEED = 90.0
POINTS, SIZES, PHASES = (0.0, 30.0, 80.0), ((5.0, 40.0, 60.0), (2.0, 9.0, 30.0)), ((1.0, 1.2, 1.1), (0.4, 0.2, 0.6))
ORDERS = (0.5, 1.5)
SQUARE = 6e-4
"""Of the masses, order 2, over the square of the speed."""


def engine(**more: Any) -> tn.Engine:
    """Two cylinders, a turn apart, on two throws; each drives with half of what the engine is given."""
    gas = [
        {"order": order, "torques": POINTS, "amplitudes": sizes, "phases": phases}
        for order, sizes, phases in zip(ORDERS, SIZES, PHASES, strict=True)
    ]
    stated = {"firing_order": "1-2", "throw_inertia": THROW, "throw_stiffness": CRANK, "damping": DAMPING}
    return tn.Engine(name="engine", **{**stated, "gas_torque": gas, "drive_share": 1, **more})


def line(*parts: Any) -> tn.Driveline:
    load = tn.Disk(name="car", inertia=LOAD, viscous_load=0.3)
    return tn.Driveline([*(parts or [engine()]), tn.Shaft(name="shaft", stiffness=SHAFT, damping=DAMPING), load])


def gas(torque: float, angle: float, fires: float) -> float:
    total = 0.0
    for order, sizes, phases in zip(ORDERS, SIZES, PHASES, strict=True):
        values = np.array(sizes) * np.exp(1j * np.array(phases))
        at = np.interp(torque, POINTS, values.real) + 1j * np.interp(torque, POINTS, values.imag)
        total += (at * np.exp(1j * order * (angle - fires))).real
    return total


def by_hand(torque: Any, until: float, breaks: list[float]) -> Any:
    """Angles and speeds (6, time) of both throws and the load, in absolute angles; ``torque(t, ω)`` of a throw."""

    def rates(t: float, x: np.ndarray) -> list[float]:
        crank = CRANK * (x[1] - x[0]) + DAMPING * (x[4] - x[3])
        shaft = SHAFT * (x[2] - x[1]) + DAMPING * (x[5] - x[4])
        one, two = torque(t, x[3]), torque(t, x[4])
        first = one + gas(one, x[0], 0.0) + crank
        second = two + gas(two, x[1], 2 * np.pi) - crank + shaft
        return [x[3], x[4], x[5], first / THROW, second / THROW, (-shaft - 0.3 * x[5]) / LOAD]

    x, pieces = np.array([0.0, 0.0, 0.0, SPEED, SPEED, SPEED]), []
    for since, end in zip([0.0, *breaks], [*breaks, until], strict=True):
        pieces.append(solve_ivp(rates, (since, end), x, "DOP853", rtol=1e-11, atol=1e-11, dense_output=True))
        x = pieces[-1].y[:, -1]
    return lambda t: pieces[int(np.searchsorted(breaks, t, side="right"))].sol(t)


def compared(run: tn.Transient, known: Any, until: float) -> None:
    times = np.linspace(0.0, until, 61)
    found = run.at(times)
    expected = np.array([known(t) for t in times])
    stations = run._stations
    assert np.abs(found.speed[:, stations] - expected[:, 3:]).max() < 1e-6 * SPEED
    assert np.abs(found.angle[:, stations] - expected[:, :3]).max() < 1e-6
    assert run.energy.error < 1e-9


STILL = np.zeros(6)


@pytest.mark.parametrize("name", ["tip-in", "back-out"])
def test_tip_in_and_back_out_of_an_engine_by_name(name: str) -> None:
    first, last = (10.0, 120.0) if name == "tip-in" else (120.0, 10.0)
    change = tn.Disturbance(on="engine", case=name, since=0.1, first=first, last=last, rise=0.15)
    run = tn.transient(line(), 0.4, disturbance=[change], speed=SPEED, start=STILL, tolerance=1e-11)
    compared(run, by_hand(lambda t, w: np.interp(t, [0.1, 0.25], [first, last]) / 2, 0.4, [0.1, 0.25]), 0.4)


def test_a_step_and_a_ramp_together() -> None:
    asked = [
        tn.AppliedTorque(on="engine", time=[0.0, 0.12], torque=[20.0, 70.0], between="steps"),
        tn.AppliedTorque(on="engine", time=[0.05, 0.2], torque=[0.0, 60.0], hold=True),
    ]
    run = tn.transient(line(), 0.3, torque=asked, speed=SPEED, start=STILL, tolerance=1e-11)

    def torque(t: float, w: float) -> float:
        return (20.0 if t < 0.12 else 70.0) / 2 + np.interp(t, [0.05, 0.2], [0.0, 60.0]) / 2

    compared(run, by_hand(torque, 0.3, [0.05, 0.12, 0.2]), 0.3)


def test_full_load_over_the_speed() -> None:
    """By straight lines of the speed, whose knot and the table's points are passed on the way."""
    speeds, torques = [80.0, 100.0, 140.0], [150.0, 90.0, 60.0]
    asked = [tn.AppliedTorque(on="engine", speed=speeds, torque=torques)]
    run = tn.transient(line(), 0.8, torque=asked, speed=SPEED, start=STILL, tolerance=1e-11)
    known = by_hand(lambda t, w: np.interp(w, speeds, torques) / 2, 0.8, [])
    times = np.linspace(0.0, 0.8, 31)
    expected = np.array([known(t) for t in times])
    assert np.abs(run.at(times).speed[:, run._stations] - expected[:, 3:]).max() < 1e-4 * SPEED


def test_a_share_goes_with_any_formula_and_masses_with_the_speed() -> None:
    share = [{"order": 2, "share": 0.4, "phase": 0.3}, {"order": 1, "quadratic_amplitude": SQUARE}]
    one = tn.Disk(name="engine", inertia=1.0, excitation=share, load_torque=5.0)
    asked = [tn.AppliedTorque(on="engine", formula="40 - 30*t + 0.1*speed")]
    run = tn.transient(line(one), 0.3, torque=asked, speed=SPEED, tolerance=1e-10)
    moving = run.at(np.linspace(0.0, 0.3, 101))
    w, phi = moving.speed[:, 0], moving.angle[:, 0]
    drives = 40.0 - 30.0 * np.linspace(0.0, 0.3, 101) + 0.1 * w
    expected = drives + 0.4 * np.abs(drives - 5.0) * np.cos(2 * phi + 0.3) + SQUARE * w**2 * np.cos(phi)
    np.testing.assert_allclose(moving.applied[:, 0], expected, rtol=1e-9)


KLOSS = {"breakdown_torque": 300.0, "breakdown_slip": 0.2, "synchronous_speed": 150.0}
CURVE = ((0.0, 20.0), (60.0, 50.0), (90.0, 45.0), (160.0, 180.0))


@pytest.mark.parametrize(
    ("machine", "curve"),
    [
        (tn.Motor(inertia=1.0, name="machine", **KLOSS), lambda s: 2 * 300 * s * 0.2 / (s**2 + 0.04)),
        (tn.Motor(inertia=1.0, name="machine", curve=[{"speed": w, "torque": t} for w, t in CURVE]), None),
        (tn.Fan(inertia=1.0, name="machine", curve=[{"speed": w, "torque": t} for w, t in CURVE]), None),
        (tn.Motor(inertia=1.0, name="machine", gain=3.0, set_speed=120.0, torque_limit=60.0), "limit"),
        (tn.Generator(inertia=1.0, name="machine", power=4000.0), "power"),
    ],
    ids=["kloss", "points", "a fan by points", "a controller", "constant power"],
)
def test_a_share_of_what_a_machine_gives_by_its_curve(machine: Any, curve: Any) -> None:
    shaken = machine.but(excitation=[{"order": 6, "share": 0.05, "phase": 0.7}])
    push = tn.AppliedTorque(on="car", time=[0.0], torque=[60.0], between="steps")
    run = tn.transient(line(shaken), 0.5, torque=[push], speed=80.0, tolerance=1e-10)
    plain = tn.transient(line(machine), 0.01, torque=[push], speed=80.0)
    assert plain.outcome.kind == run.outcome.kind == "reached"
    times = np.linspace(0.0, 0.5, 101)
    moving = run.at(times)
    w, phi = moving.speed[:, 0], moving.angle[:, 0]
    if callable(curve):
        known = curve(1 - w / 150.0)
    elif curve == "limit":
        known = np.clip(3.0 * (120.0 - w), -60.0, 60.0)
    elif curve == "power":
        known = -4000.0 / w
    else:
        known = PchipInterpolator(*np.transpose(CURVE))(w) * (-1 if isinstance(machine, tn.Fan) else 1)
    expected = known + 0.05 * np.abs(known) * np.cos(6 * phi + 0.7)
    np.testing.assert_allclose(moving.applied[:, 0], expected, rtol=1e-8)


@pytest.mark.slow
def test_a_least_factor_of_an_engine_scales_what_it_gives_and_not_its_masses() -> None:
    """At twice the factor the run is that of twice the torque; the masses' torque stays."""
    masses = {"reciprocating_mass": 0.5, "stroke": 0.08, "rod_length": 0.15}
    made = line(engine(**masses))
    give = [tn.AppliedTorque(on="engine", time=[0.0], torque=[30.0], between="steps")]
    twice = [tn.AppliedTorque(on="engine", time=[0.0], torque=[60.0], between="steps")]
    least = tn.least_drive(
        made, (90.0, 120.0), torque=give, factors=(2.0, 2.2), points=2, accuracy=0.5, around=0, phases=1
    )
    assert tn.passing(made, (90.0, 120.0), torque=twice).passes
    assert least.drive == "engine" and all(one.share == 1.0 for one in least.trials)


def test_what_no_amplitude_can_be_made_by_is_refused_by_name() -> None:
    for asked, says in (
        ({"formula": "20 + 5*t"}, "engine.throw 1.excitation 1: goes by the load of its disk"),
        ({"time": [0, 9], "torque": [20, 30], "corner_frequency": 5.0}, "which a torque that lags gives"),
        ({"time": [0, 9], "torque": [20, 400], "between": "steps"}, "does not cover 200 N"),
    ):
        with pytest.raises(tn.InputError, match=says):
            tn.transient(line(), 0.1, torque=[tn.AppliedTorque(on="engine", **asked)], speed=SPEED)
    with pytest.raises(tn.InputError, match="is not a Disk of this driveline"):
        tn.transient(line(), 0.1, torque=[tn.AppliedTorque(on="engin", formula="1")], speed=SPEED)

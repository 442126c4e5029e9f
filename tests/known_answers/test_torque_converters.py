"""Torque converters against equations of motion written out in absolute angles, their curves by scipy alone."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq, fsolve

import trunnion as tn
from trunnion.laws.converter import balances

SHEET = [
    (0.0, 2.1, 4.2e-3), (0.3, 1.75, 4.2e-3), (0.5, 1.5, 4.1e-3), (0.7, 1.22, 3.7e-3), (0.85, 1.0, 3e-3),
    (0.95, 1.0, 1.4e-3), (1.0, 1.0, 0.0),
]  # fmt: skip
RATIO, MU, K = np.array(SHEET).T
CAPACITY, TORQUE_RATIO = PchipInterpolator(RATIO, K), PchipInterpolator(RATIO, MU)
CURVES = [{"speed_ratio": v, "torque_ratio": m, "capacity": k} for v, m, k in SHEET]
GEAR = 2.0
INERTIA = {"engine": 0.3, "pump": 0.15, "turbine": 0.05, "gear": 0.2, "wheels": 4.0}
SPRINGS = {"crank": (3e4, 4.0), "input": (2e4, 5.0), "prop": (8e3, 6.0)}


def converter(**more: object) -> tn.TorqueConverter:
    return tn.TorqueConverter(name="converter", curves=CURVES, inertia_in=0.15, inertia_out=0.05, **more)


def line(load: float = 60.0, square: float = 0.02, engine: dict | None = None, **more: object) -> tn.Driveline:
    """Engine, converter, a gear of 2 and wheels."""
    drives = {"drive_share": 1.0, "excitation": [{"order": 2, "amplitude": 80.0}]} if engine is None else engine
    return tn.Driveline(
        [
            tn.Disk(inertia=0.3, name="engine", **drives),
            tn.Shaft(stiffness=3e4, damping=4.0, name="crank"),
            converter(),
            tn.Shaft(stiffness=2e4, damping=5.0, name="input"),
            tn.Disk(inertia=0.2, name="gear"),
            tn.Ratio(ratio=GEAR),
            tn.Shaft(stiffness=8e3, damping=6.0, name="prop"),
            tn.Disk(inertia=4.0, name="wheels", load_torque=load, quadratic_load=square),
        ],
        **more,
    )


def torques(pump: float, turbine: float) -> tuple[float, float]:
    """What the pump takes and the turbine gives."""
    ratio = max(turbine / pump, 0.0) if pump else 0.0
    takes = float(CAPACITY(ratio)) * pump**2
    return takes, float(TORQUE_RATIO(ratio)) * takes


def rates(state: np.ndarray, drive: float, load: float, square: float) -> np.ndarray:
    """Of the angles of engine, pump, turbine, gear and wheels, and of their speeds."""
    angle, speed = np.split(state, 2)
    crank, shaft, prop = (
        k * (angle[j] - angle[i] / g) + c * (speed[j] - speed[i] / g)
        for (k, c), (i, j, g) in zip(SPRINGS.values(), ((0, 1, 1.0), (2, 3, 1.0), (3, 4, GEAR)), strict=True)
    )
    takes, gives = torques(speed[1], speed[2])
    acting = np.array(
        [drive + crank, -takes - crank, gives + shaft, -shaft + prop / GEAR, -prop - load - square * speed[4] ** 2]
    )
    return np.concatenate([speed, acting / np.array(list(INERTIA.values()))])


def balanced(speed: float, load: float, square: float) -> float:
    """The ratio of speeds at which the turbine carries its load."""
    return brentq(
        lambda v: torques(speed, v * speed)[1] - (load + square * (v * speed / GEAR) ** 2) / GEAR, 1e-6, 1.0, xtol=1e-15
    )


@pytest.mark.parametrize("speed", [120.0, 200.0, 310.0])
def test_the_mean_torques_are_those_of_the_balance(speed: float) -> None:
    ratio = balanced(speed, 60.0, 0.02)
    takes, gives = torques(speed, ratio * speed)
    found = tn.order_response(line(), [speed, 1.1 * speed])
    assert_allclose(found.mean_torque[0], [-takes, -gives, -gives, -GEAR * gives], rtol=1e-9)
    assert not np.isclose(found.mean_torque[1, 0], -takes, rtol=0.05)


def linearised(speed: float, load: float = 60.0, square: float = 0.02) -> tuple[np.ndarray, float]:
    """Jacobian of the speeds and angles about the steady rotation, by differences, and the torque that drives."""
    ratio = balanced(speed, load, square)
    drive, gives = torques(speed, ratio * speed)
    twist = np.array([0.0, -drive / 3e4, 0.0, -gives / 2e4, -gives / 2e4 / GEAR - GEAR * gives / 8e3])
    middle = np.concatenate([twist, speed * np.array([1.0, 1.0, ratio, ratio, ratio / GEAR])])
    # Steady: what speeds change by is nothing.
    assert_allclose(rates(middle, drive, load, square)[5:], 0.0, atol=1e-8 * drive / 0.05)
    columns = []
    for i in range(10):
        step = 1e-5 * max(abs(middle[i]), 1.0)
        ends = [middle + way * step * np.eye(10)[i] for way in (-1, 1)]
        low, high = (rates(one, drive, load, square) for one in ends)
        columns.append((high - low) / (2 * step))
    return np.array(columns).T, drive


def test_the_response_is_that_of_the_linearised_equations() -> None:
    found = tn.order_response(line(), [150.0, 200.0], orders=[2.0])
    for i, speed in enumerate((150.0, 200.0)):
        jacobian, _ = linearised(speed)
        push = np.zeros(10)
        push[5] = 80.0 / INERTIA["engine"]
        w = 2j * speed
        x = np.linalg.solve(w * np.eye(10) - jacobian, push)
        crank = (3e4 + w * 4.0) * (x[1] - x[0])
        shaft = (2e4 + w * 5.0) * (x[3] - x[2])
        prop = (8e3 + w * 6.0) * (x[4] - x[3] / GEAR)
        gives = -(INERTIA["turbine"] * w**2 * x[2] - shaft)  # with the twist, as the spring would
        assert_allclose(np.abs(found.torque[i, 0]), np.abs([crank, gives, shaft, prop]), rtol=1e-6)


def test_disturbances_decay_as_eigenvalues_say() -> None:
    jacobian, _ = linearised(200.0)
    values = np.linalg.eigvals(jacobian)
    slowest = np.sort(values.real)[::-1]
    assert_allclose(slowest[:2], 0.0, atol=1e-5)  # where pump and turbine stand matters to nothing
    assert_allclose(tn.stability(line(), 200.0).growth_rate, slowest[2], rtol=1e-5)
    diagram = tn.campbell_diagram(line(), [150.0, 200.0])
    oscillating = np.sort(values[values.imag > 1].imag)
    assert_allclose(np.sort(diagram.frequency[1]), oscillating, rtol=1e-6)


def test_a_start_is_that_of_the_equations() -> None:
    """From standstill through the curves; a torque that rises and stays."""
    plain = line(load=0.0, engine={})
    torque = tn.AppliedTorque(on="engine", time=[0, 1, 3], torque=[0, 150, 150])
    run = tn.transient(plain, 3.0, torque=[torque], speed=0.0, tolerance=1e-11)
    assert run.outcome.kind == "reached"
    assert run.energy.error < 1e-9
    assert run.energy.losses > 5e3  # the heat of the oil above all

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        return rates(y, 150.0 * min(t, 1.0), 0.0, 0.02)

    y = np.zeros(10)
    for span in ((0.0, 1.0), (1.0, 3.0)):
        y = solve_ivp(rate, span, y, method="DOP853", rtol=1e-11, atol=1e-11, max_step=0.01).y[:, -1]
    places = [run.disks.index(name) for name in ("engine", "wheels")]
    assert_allclose(run.speed[-1, places], y[[5, 9]], rtol=2e-6)


def test_a_run_in_time_settles_on_the_response() -> None:
    shaken = {"drive_share": 1.0, "excitation": [{"order": 2, "amplitude": 8.0}]}
    small = line(engine=shaken)
    run = tn.simulate(small, 8.0, speed=200.0, tolerance=1e-10)
    torque = run.torque[run.times > 7.0, run.shafts.index("crank")]
    found = tn.order_response(small, [200.0])
    half = (torque.max() - torque.min()) / 2
    assert_allclose(half, found.vibratory_torque[0, 0], rtol=2e-3)
    assert_allclose(torque.mean(), found.mean_torque[0, 0], rtol=1e-3)


def test_tangents_of_the_equations_of_motion() -> None:
    """The compiled right-hand side against differences of itself, both converters' sides moving."""
    from trunnion.equations.line_system import line_system

    system = line_system(line(), 200.0, leaves=True).system
    rng = np.random.default_rng(3)
    x, v = (rng.normal(size=10) * np.repeat([1e-3, 4.0], 5) for _ in range(2))
    parts = [system.rate_at(0.0, x + m * 1e-3 * v) for m in (-2, -1, 1, 2)]
    slope = (parts[0] - 8 * parts[1] + 8 * parts[2] - parts[3]) / (12 * 1e-3)
    assert_allclose(system.jacobian_times(0.0, x, v), slope, atol=1e-7 * np.abs(slope).max())


def test_a_motor_finds_its_speed() -> None:
    """Both balances together, of a motor with a curve and of the turbine, against two equations in two unknowns."""
    motor = tn.Motor(inertia=0.3, breakdown_torque=400.0, breakdown_slip=0.3, synchronous_speed=300.0, name="engine")
    stated = line()
    free = stated.but(elements=[motor, *stated.elements[1:]])

    def left(x: np.ndarray) -> list[float]:
        slip = 1 - x[0] / 300.0
        drives = 2 * 400.0 * slip * 0.3 / (slip**2 + 0.09)
        takes, gives = torques(x[0], x[1])
        return [drives - takes, gives - (60.0 + 0.02 * (x[1] / GEAR) ** 2) / GEAR]

    pump, turbine = fsolve(left, [285.0, 260.0], xtol=1e-13)
    (stable,) = [one for one in tn.mean_speeds(free) if one.stable]
    assert_allclose(stable.speed, pump, rtol=1e-9)
    assert_allclose(tn.order_response(free, [stable.speed]).mean_torque[0, 1], -torques(pump, turbine)[1], rtol=1e-8)


def test_a_closed_lock_up_clutch_is_a_ratio_of_one() -> None:
    locked = line().replace("converter", locked=True)
    place = locked.index("converter")
    pump, turbine = tn.Disk(inertia=0.15, name="pump"), tn.Disk(inertia=0.05, name="turbine")
    rigid = locked.but(elements=[*locked.elements[:place], pump, turbine, *locked.elements[place + 1 :]])
    speeds = [100.0, 150.0, 200.0]
    own, same = (tn.order_response(one, speeds).vibratory_torque for one in (locked, rigid))
    assert_allclose(own, same, rtol=1e-12)


def test_heat_is_judged_at_the_worst_speed() -> None:
    """Against a scan of the balance by brentq."""
    rated = line(operation=tn.Operation(speed=200.0, speed_range=[120.0, 300.0])).replace("converter", heat_rating=3e3)
    (check,) = [one for one in tn.assess(rated).checks if one.name == "heat of converter"]

    def heat(speed: float) -> float:
        ratio = balanced(speed, 60.0, 0.02)
        takes, gives = torques(speed, ratio * speed)
        return takes * speed - gives * ratio * speed

    scanned = [heat(one) for one in np.linspace(120.0, 300.0, 181)]
    assert abs(check.value - max(scanned)) <= check.error + 1e-6 * max(scanned)
    assert check.status.name == "EXCEEDED"


def test_a_pump_torque_at_a_reference_speed_is_a_capacity() -> None:
    points = [{"speed_ratio": v, "torque_ratio": m, "pump_torque": k * 200.0**2} for v, m, k in SHEET]
    same = tn.TorqueConverter(curves=points, reference_speed=200.0)
    assert_allclose(same.capacities, K, rtol=1e-14)


def test_two_balances_of_the_turbine_that_lie_close() -> None:
    """A load whose peak rises past the turbine's torque over 0.3 % of its speed: all three balances, found by hand."""
    pump, at = 200.0, 130.0
    beside = float(TORQUE_RATIO(at / pump) * CAPACITY(at / pump)) * pump**2
    points = [(0.0, 20.0), (at - 1, beside - 6.0), (at, beside + 0.02), (at + 1, beside - 6.0), (400.0, beside)]
    load = tn.Fan(inertia=1.0, curve=[{"speed": w, "torque": m} for w, m in points])
    curve = PchipInterpolator(*np.array(points).T)

    def lacks(w: float) -> float:
        return float(curve(w) - TORQUE_RATIO(w / pump) * CAPACITY(w / pump) * pump**2)

    fine = np.linspace(1.0, 0.999 * pump, 400001)
    values = curve(fine) - TORQUE_RATIO(fine / pump) * CAPACITY(fine / pump) * pump**2
    known = [brentq(lacks, fine[i], fine[i + 1], xtol=1e-14) for i in np.flatnonzero(values[:-1] * values[1:] < 0)]
    assert len(known) == 3 and known[1] - known[0] < 0.003 * at
    found = list(balances(converter().law, [(1.0, load.load)], pump))
    assert_allclose([ratio * pump for ratio, _ in found], known, rtol=1e-10)
    assert [lasts for _, lasts in found] == [True, False, True]


def test_two_balances_of_a_line_that_lie_between_two_scanned_speeds() -> None:
    """A motor whose torque dips below what the pump takes between two of its points: both sides of the dip."""
    plain = line(engine={}).but(elements=[tn.Disk(inertia=0.3, name="engine"), *line().elements[1:]])
    ratio = balanced(200.0, 60.0, 0.02)
    needed = torques(200.0, ratio * 200.0)[0]
    for width in (3.0, 1.0):
        points = [(0.0, 400.0), (200 - width, needed + 15), (200.0, needed - 0.05), (200 + width, needed + 15)]
        points += [(260.0, needed), (400.0, 0.0)]
        motor = tn.Motor(inertia=0.3, name="engine", curve=[{"speed": w, "torque": m} for w, m in points])
        found = tn.mean_speeds(plain.but(elements=[motor, *plain.elements[1:]]))
        curve = PchipInterpolator(*np.array(points).T)

        def lacks(w: float, curve: PchipInterpolator = curve) -> float:
            return torques(w, balanced(w, 60.0, 0.02) * w)[0] - float(curve(w))

        fine = np.union1d(np.linspace(195.0, 205.0, 401), np.linspace(205.0, 300.0, 96))
        values = np.array([lacks(w) for w in fine])
        known = [brentq(lacks, fine[i], fine[i + 1], xtol=1e-13) for i in np.flatnonzero(values[:-1] * values[1:] < 0)]
        assert len(known) == 3
        near = [one for one in found if one.speed > 195.0]
        assert_allclose([one.speed for one in near], known, rtol=1e-8)
        assert [one.stable for one in near] == [True, False, True]

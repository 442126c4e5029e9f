"""A line as a system: the same equations as written out slowly, exact tangents, conserved energy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from jointed_lines import three_shafts, two_shafts
from line_energy import energy
from oracles.random_lines import random_line, random_uneven_line
from oracles.written_out import nonlinear_line

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.equations.kinematics import base_motion
from trunnion.equations.line_system import LineSystem, line_system

SPEED = 37.0


def straight_angles(line: LineSystem) -> np.ndarray:
    """Angles of the unknowns at t = 0 with straight joints: what deviations are counted from."""
    topo = line.assembly.topology
    co = line.assembly.coefficients(line.assembly.table(1, line.speed), statically_twisted=False)
    motion = base_motion(topo, co.straight, np.zeros(1))
    return motion.angle[0, 0, [topo.reference[g] for g, c in enumerate(topo.coordinate) if c >= 0]]


def mean_rates(line: LineSystem) -> np.ndarray:
    topo = line.assembly.topology
    return np.array([float(topo.speed_ratio[topo.reference[g]]) for g, c in enumerate(topo.coordinate) if c >= 0])


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("made", [random_line, random_uneven_line])
def test_compiled_equations_are_the_written_ones(seed: int, made: Callable[[int], tn.Driveline]) -> None:
    """Branches, ratios, joints of all kinds, several in a group, tubes, loads: the same accelerations to rounding."""
    assembly = assemble(made(seed))
    line = line_system(assembly, SPEED)
    slow = nonlinear_line(assembly, assembly.table(1, SPEED))
    rng = np.random.default_rng(seed)
    n, mean, offset = assembly.topology.size, mean_rates(line), straight_angles(line)
    for time in (0.0, 0.31):
        state = rng.normal(size=2 * n) * np.repeat([0.1, 3.0], n)
        expected = slow.acceleration(time, offset + mean * SPEED * time + state[:n], mean * SPEED + state[n:])
        found = line.system.rate_at(time, state)
        np.testing.assert_allclose(found[n:], expected, atol=2e-13 * np.abs(expected).max())
        np.testing.assert_array_equal(found[:n], state[n:])
    # The rigid line is at rest in both descriptions.
    np.testing.assert_allclose(line.rest()[:n] + offset, slow.base_angles(0.0), atol=1e-14)


def loaded_lines() -> dict[str, tn.Driveline]:
    tripod: list[Any] = [
        tn.ConstantSpeed(),
        tn.Shaft(stiffness=2e4, damping=1.0),
        tn.Disk(inertia=0.3),
        tn.TripodJoint(angle=tn.deg(35), radius=0.07, length=0.2),
        tn.Disk(inertia=0.05),
        tn.Shaft(stiffness=1e4, damping=2.0),
        tn.Disk(inertia=0.5),
        tn.TripodJoint(angle=tn.deg(30), radius=0.07, length=0.2, plane=0.3, spider="input"),
        tn.Shaft(stiffness=1e4),
        tn.Disk(inertia=0.7, viscous_load=0.4, quadratic_load=0.01),
    ]
    orders = [{"order": 1.5, "amplitude": 30.0, "phase": 0.4}, {"frequency": 50.0, "amplitude": 20.0}]
    geared: list[Any] = [
        tn.Disk(inertia=0.2, excitation=orders, load_torque=-20.0),
        tn.HookeJoint(angle=tn.deg(25)),
        tn.Ratio(ratio=-1.5),
        tn.Disk(
            inertia=0.1,
            viscous_load=0.2,
            quadratic_load=0.02,
            excitation=[{"order": 2, "amplitude": 9.0, "phase": 0.5}],
        ),
        tn.Shaft(stiffness=5e3, damping=1.0),
        tn.Disk(inertia=0.6, load_torque=10.0),
    ]
    return {
        "tripods": tn.Driveline(tripod),
        "geared and excited": tn.Driveline(geared),
        "two shafts": two_shafts(load=80.0, viscous_load=0.3, excitation=orders),
        "three shafts": three_shafts(load=120.0),
    }


@pytest.mark.parametrize("name", loaded_lines())
def test_tangents_are_exact(name: str) -> None:
    """J v against differences of sixth order, and again from random states."""
    system = line_system(loaded_lines()[name], SPEED).system
    rng = np.random.default_rng(5)
    n = system.size // 2
    for _ in range(4):
        x, v = (rng.normal(size=2 * n) * np.repeat([0.2, 4.0], n) for _ in range(2))
        t = float(rng.uniform(0, 1))
        parts = [system.rate_at(t, x + m * 2e-3 * v) for m in (-3, -2, -1, 1, 2, 3)]
        slope = (-parts[0] + 9 * parts[1] - 45 * parts[2] + 45 * parts[3] - 9 * parts[4] + parts[5]) / (60 * 2e-3)
        exact = system.jacobian_times(t, x, v)
        np.testing.assert_allclose(exact, slope, atol=3e-11 * np.abs(exact).max())


def lagrange(line: LineSystem, time: float, state: np.ndarray) -> np.ndarray:
    """Accelerations from the energies and the power of the loads alone, by differences: d/dt ∂L/∂v − ∂L/∂a."""
    system, n = line.system, line.assembly.topology.size

    def kinetic(x: np.ndarray, t: float) -> float:
        return float(energy(line, system, [t], [x])[0][0])

    def potential(x: np.ndarray, t: float) -> float:
        return float(energy(line, system, [t], [x])[1][0])

    def slope(f: Any, x: np.ndarray, i: int, h: float) -> float:
        e = np.zeros(2 * n)
        e[i] = h
        return (f(x - 2 * e, time) - 8 * f(x - e, time) + 8 * f(x + e, time) - f(x + 2 * e, time)) / (12 * h)

    mass = np.zeros((n, n))
    for i in range(n):
        unit = np.zeros(2 * n)
        unit[n + i] = 1.0
        # T is quadratic in the rates: its second difference is the mass.
        mass[i, i] = kinetic(state + unit, time) - 2 * kinetic(state, time) + kinetic(state - unit, time)
    force = np.array([slope(kinetic, state, i, 1e-3) - slope(potential, state, i, 1e-3) for i in range(n)])
    # d/dt (M v) − M v̇ = (dM/dt) v, with v = v̄ + rate and time running on.
    h = 1e-5

    def momentum(at: float) -> np.ndarray:
        moved = state.copy()
        moved[:n] += (at - time) * state[n:]
        out = np.zeros(n)
        for i in range(n):
            unit = np.zeros(2 * n)
            unit[n + i] = 0.5
            out[i] = kinetic(moved + unit, at) - kinetic(moved - unit, at)
        return out

    drift = (momentum(time - 2 * h) - 8 * momentum(time - h) + 8 * momentum(time + h) - momentum(time + 2 * h)) / (
        12 * h
    )
    return np.linalg.solve(mass, force - drift)


def test_tripods_and_ratios_follow_from_their_energies() -> None:
    """Undamped lines without loads: the accelerations are Lagrange's, tripods and varying inertia included."""
    for name in ("tripods", "geared and excited"):
        bare = [
            type(e)(
                **{
                    k: v
                    for k, v in e.stated.items()
                    if k not in ("damping", "load_torque", "viscous_load", "quadratic_load", "excitation")
                }
            )
            for e in loaded_lines()[name].elements
        ]
        line = line_system(tn.Driveline(bare), SPEED)
        n = line.assembly.topology.size
        state = np.random.default_rng(1).normal(size=2 * n) * np.repeat([0.05, 2.0], n)
        expected = lagrange(line, 0.2, state)
        np.testing.assert_allclose(line.system.rate_at(0.2, state)[n:], expected, atol=1e-6 * np.abs(expected).max())


def test_loads_act_on_the_disk_they_belong_to() -> None:
    """Constant, viscous, quadratic and harmonic torques through a ratio, against their virtual work."""
    full = loaded_lines()["geared and excited"]
    bare = full
    for name in ("Disk 1", "Disk 2", "Disk 3"):
        bare = bare.replace(name, load_torque=None, viscous_load=None, quadratic_load=None, excitation=None)
    one, other = line_system(full, SPEED), line_system(bare, SPEED)
    state, time = np.array([0.1, -0.05, 1.3, 0.7]), 0.23
    change = (one.system.rate_at(time, state) - other.system.rate_at(time, state))[2:]
    chi = SPEED * time + state[0]
    eta = float(np.cos(tn.deg(25)) / (1 - np.sin(tn.deg(25)) ** 2 * np.cos(chi) ** 2))
    lead = np.arctan2(np.tan(tn.deg(12.5)) ** 2 * np.sin(2 * chi), 1 - np.tan(tn.deg(12.5)) ** 2 * np.cos(2 * chi))
    r = -eta / 1.5
    speed = (SPEED + state[2]) * r
    rotation = -(chi + lead) / 1.5
    first = 20.0 + 30.0 * np.cos(1.5 * chi + 0.4) + 20.0 * np.cos(50.0 * time)
    second = -0.2 * speed - 0.02 * speed * abs(speed) - 9.0 * np.cos(-2 * rotation + 0.5)
    assert change[0] == pytest.approx((first + r * second) / (0.2 + 0.1 * r**2), rel=1e-12)
    # The last disk turns backwards: a positive load resists that.
    assert change[1] == pytest.approx(10.0 / 0.6, rel=1e-12)


@pytest.mark.slow
def test_energy_of_a_free_line_over_a_thousand_turns() -> None:
    """Two discs, Hooke's joint, no damping: energy constant to 1e-10 of itself."""
    line = tn.Driveline(
        [tn.Disk(inertia=0.4), tn.HookeJoint(angle=tn.deg(20)), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.9)]
    )
    run = tn.simulate(line, speed=100.0, turns=1000, tolerance=1e-13)
    kinetic, potential = energy(run.line, run.pieces[0].system, run.time, run.state)
    total = kinetic + potential
    assert potential.max() > 0.2 * total[0]
    assert np.abs(total / total[0] - 1).max() < 1e-10


def test_numbers_follow_parameters() -> None:
    """Varying the system's parameters is making another line."""
    line = line_system(two_shafts(), SPEED)
    other = line_system(two_shafts(angle=20.0, load=50.0).replace("Disk 2", inertia=1.3), 50.0)
    varied = line.system.with_parameters(
        {"HookeJoint 1.angle": tn.deg(20), "Disk 2.load_torque": 50.0, "Disk 2.inertia": 1.3, "speed": 50.0}
    )
    np.testing.assert_array_equal(varied.numbers, other.system.numbers)
    assert varied.forcing_period == other.system.forcing_period == pytest.approx(np.pi / 50.0)
    np.testing.assert_array_equal(line.varied("HookeJoint *.angle")(0.2).parameters["HookeJoint 1.angle"], 0.2)


PERIODS: list[tuple[Any, float | None]] = [
    ({}, 0.5),
    ({"excitation": [{"order": 2, "amplitude": 1.0}]}, 0.5),
    ({"excitation": [{"order": 0.5, "amplitude": 1.0}]}, 2.0),
    ({"excitation": [{"order": 1.5, "amplitude": 1.0}, {"order": 3, "amplitude": 1.0}]}, 2.0),
    ({"excitation": [{"frequency": 3 * SPEED, "amplitude": 1.0}]}, 1.0),
    ({"excitation": [{"frequency": np.pi * SPEED, "amplitude": 1.0}]}, None),
]


@pytest.mark.parametrize(("disk", "turns"), PERIODS)
def test_common_period(disk: dict[str, Any], turns: float | None) -> None:
    period = line_system(two_shafts(**disk), SPEED).system.forcing_period
    shown = repr(line_system(two_shafts(**disk), SPEED).system)
    assert ("without a common period" in shown) == (turns is None) and "in all" in shown
    if turns is None:
        assert period is None
    else:
        assert period == pytest.approx(turns * 2 * np.pi / SPEED, rel=1e-12)


def test_periods_of_torques_in_time_alone() -> None:
    """Straight shafts: one frequency, two in a simple ratio, two in none."""

    def period(*frequencies: float) -> float | None:
        shaken = [{"frequency": f, "amplitude": 1.0} for f in frequencies]
        line = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0, excitation=shaken)]
        return line_system(tn.Driveline(line), SPEED).system.forcing_period

    assert period(30.0) == pytest.approx(2 * np.pi / 30)
    assert period(30.0, 45.0) == pytest.approx(2 * np.pi / 15)
    assert period(30.0, 30.0 * np.sqrt(2)) is None


def test_tripods_repeat_after_a_turn() -> None:
    assert line_system(loaded_lines()["tripods"], SPEED).system.forcing_period == pytest.approx(2 * np.pi / SPEED / 3)
    mixed = tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.2),
         tn.Disk(inertia=1.0), tn.TripodJoint(angle=0.2, radius=0.05, length=0.4), tn.Disk(inertia=1.0)]
    )  # fmt: skip
    assert line_system(mixed, SPEED).system.forcing_period == pytest.approx(2 * np.pi / SPEED)


def test_excitations_survive_the_file() -> None:
    """load → dump → load, the schema, and their numbers by path."""
    jsonschema = pytest.importorskip("jsonschema")
    import tomllib

    from trunnion.driveline import json_schema

    line = loaded_lines()["geared and excited"]
    text = tn.dumps(line)
    assert tn.loads(text) == line and tn.dumps(tn.loads(text)) == text
    jsonschema.Draft202012Validator(json_schema()).validate(tomllib.loads(text))
    packed = tn.pack(line)
    assert packed.value("Disk 1.excitation 2 frequency") == 50.0
    assert packed.units[packed.labels.index("Disk 1.excitation 1 phase")] == "rad"
    assert "excitation of 2 harmonics" in str(line) and "excitation of one harmonic" in str(line)


REFUSED: list[tuple[Any, str]] = [
    ([{"order": 2}], "amplitude: is missing"),
    ([{"amplitude": 2.0}], "order: is needed with amplitude"),
    ([{"amplitude": 2.0, "order": 0, "frequency": 3.0}], "order = 0: must not be zero; leave it out"),
    ([{"amplitude": 2.0, "order": 2, "frequency": 0}], "frequency = 0: must not be zero"),
    ([{"amplitude": 2.0, "frequency": -3.0}], "frequency = -3: must be positive"),
    ([{"amplitude": 2.0, "order": -1}], "must be positive"),
    ([{"amplitude": "2 deg", "order": 1}], "not the unit of a torque"),
    ([{"amplitud": 2.0, "order": 1}], "did you mean"),
    ([3], "not a harmonic torque"),
    ("x", "not a list"),
    ({"order": 2, "amplitude": 1.0}, "not a list"),
]


@pytest.mark.parametrize(("value", "words"), REFUSED, ids=[w for _, w in REFUSED])
def test_wrong_excitations_are_refused(value: Any, words: str) -> None:
    with pytest.raises(tn.InputError, match=words) as refusal:
        tn.Disk(inertia=1.0, excitation=value)
    assert "\n" not in str(refusal.value) and str(refusal.value).startswith("Disk.excitation")

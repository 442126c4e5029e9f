"""GearPair and PiecewiseShaft as elements of a driveline: described, linearised, simulated, reduced to one equation."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from line_energy import energy
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli.program import app
from trunnion.equations.coefficients import assemble
from trunnion.equations.line_system import line_system
from trunnion.errors import InputError
from trunnion.motion.orbits.periodic_response import PeriodicResponse
from trunnion.motion.simulation.simulate import simulate_system
from trunnion.numerics.integration.integration import integrate
from trunnion.numerics.piecewise_linear import piecewise
from trunnion.systems.reference import dead_zone_oscillator

TEETH: dict[str, Any] = {"teeth_in": 18, "teeth_out": 27, "module": 0.005}
RADII: dict[str, Any] = {"base_radius_in": 0.04, "base_radius_out": 0.06}


def mesh(**changes: Any) -> tn.GearPair:
    return tn.GearPair(**{**TEETH, "mesh_stiffness": 2e6, **changes})


def clutch(**changes: Any) -> tn.PiecewiseShaft:
    numbers = {"breakpoints": [-0.02, 0.01, 0.05], "stiffnesses": [300.0, 20.0, 100.0, 500.0], "damping": 0.05}
    return tn.PiecewiseShaft(**{**numbers, **changes})


def full_line() -> tn.Driveline:
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=3e3, damping=1.0),
            tn.Disk(inertia=0.05),
            tn.HookeJoint(angle=0.5),
            tn.GearPair(
                teeth_in=20, teeth_out=30, module="4 mm", mesh_stiffness=5e6, mesh_damping=3000, backlash="0.2 mm",
                damping_law="never pulling", transmission_error=[{"amplitude": "20 um"}],
            ),
            tn.Disk(inertia=0.05),
            tn.PiecewiseShaft(
                breakpoints=[-0.01, 0.01], stiffnesses=[4e3, 0.0, 6e3], damping=2.0, damping_law="in contact"
            ),
            tn.Disk(inertia=0.1, load_torque=2.0),
        ]
    )  # fmt: skip


def chain(pair: tn.GearPair | tn.Ratio) -> tn.Driveline:
    """The geared chain of Friswell and co-authors: the second gear drives two shafts."""
    return tn.Driveline(
        [
            tn.Disk(inertia=400e-6),
            tn.Shaft(stiffness=10e3),
            tn.Disk(inertia=25e-6),
            pair,
            tn.Disk(inertia=25e-6, name="second gear"),
            tn.Shaft(stiffness=5e3),
            tn.Disk(inertia=700e-6),
            tn.Shaft(stiffness=5e3, after="second gear"),
            tn.Disk(inertia=700e-6),
        ]
    )


def test_files_and_summary() -> None:
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.1),
            mesh(
                backlash="0.1 mm", stiffness_ratio=0.1, damping_law="in contact", mesh_damping=30,
                transmission_error=[{"amplitude": "5 um"}, {"amplitude": 1e-6, "order": 2, "phase": "30 deg"}],
                stiffness_variation=[{"share": 0.1}],
            ),
            tn.Disk(inertia=0.1),
            tn.PiecewiseShaft.symmetric([(20.0, "4 deg"), (300.0, "12 deg"), (2000.0, None)], damping=0.3),
            tn.Disk(inertia=0.1),
            tn.GearPair(**RADII, mesh_stiffness="2e8 N/m", angular_backlash="1 deg"),
            tn.Disk(inertia=0.2),
        ]
    )  # fmt: skip
    assert tn.loads(tn.dumps(line)) == line
    assert "transmission error of 2 harmonics" in str(line) and "breakpoints -12 deg, -4 deg" in str(line)
    packed = tn.pack(line)
    wanted = {
        "GearPair 1.backlash": 1e-4, "GearPair 1.transmission_error 2 amplitude": 1e-6,
        "GearPair 1.stiffness_variation 1 share": 0.1, "PiecewiseShaft 1.stiffness 2": 300.0,
        "PiecewiseShaft 1.breakpoint 4": np.deg2rad(12), "GearPair 2.angular_backlash": np.deg2rad(1),
    }  # fmt: skip
    for label, value in wanted.items():
        assert packed.value(label) == pytest.approx(value)
    assert "GearPair 1.angular_backlash" not in packed.labels  # it does nothing there
    assert packed.units[packed.labels.index("GearPair 1.transmission_error 1 amplitude")] == "m"


def test_what_follows_from_the_numbers() -> None:
    pair = mesh(angular_backlash="1 deg")
    assert pair.radii == pytest.approx((0.045 * np.cos(np.deg2rad(20)), 0.0675 * np.cos(np.deg2rad(20))))
    assert pair.total_backlash == pytest.approx(np.deg2rad(1) * pair.radii[1])
    assert tn.GearPair(**RADII, mesh_stiffness=1.0).fraction == mesh().fraction


@pytest.mark.parametrize(
    ("make", "key", "words"),
    [
        (lambda: mesh(backlash=-1e-4), "backlash", "must not be negative"),
        (lambda: mesh(angular_backlash="-1 deg"), "angular_backlash", "must not be negative"),
        (lambda: mesh(backlash=1e-4, stiffness_ratio=1.2), "stiffness_ratio", "between 0 and 1"),
        (lambda: mesh(backlash=1e-4, stiffness_ratio=-0.1), "stiffness_ratio", "between 0 and 1"),
        (lambda: mesh(backlash=1e-4, angular_backlash=0.1), "angular_backlash", "conflicts with backlash"),
        (lambda: mesh(mesh_stiffness=0.0), "mesh_stiffness", "must be positive"),
        (lambda: mesh(mesh_damping=-1.0), "mesh_damping", "must not be negative"),
        (lambda: mesh(damping_law="sometimes"), "damping_law", "is unknown"),
        (lambda: mesh(damping_law="never pulling"), "damping_law", "needs a backlash"),
        (
            lambda: mesh(damping_law="never pulling", backlash=1e-4, stiffness_ratio=0.1),
            "stiffness_ratio", "does not go with",
        ),
        (lambda: mesh(module=None), "module", "is missing"),
        (lambda: mesh(base_radius_in=0.1), "base_radius_in", "conflicts with"),
        (lambda: tn.GearPair(mesh_stiffness=1.0), "teeth_in", "is missing"),
        (lambda: tn.GearPair(**TEETH), "mesh_stiffness", "is missing"),
        (lambda: mesh(pressure_angle="50 deg"), "pressure_angle", "45 deg"),
        (lambda: mesh(transmission_error=[{"amplitude": 1e-6, "order": 0.5}]), "transmission_error 1", "whole number"),
        (lambda: mesh(transmission_error=[{"size": 1e-6}]), "transmission_error 1 size", "unknown key"),
        (lambda: mesh(transmission_error=3.0), "transmission_error", "not a list"),
        (lambda: mesh(stiffness_variation=[{"share": 0.6}, {"share": 0.5}]), "stiffness_variation", "vanish"),
        (
            lambda: tn.GearPair(**RADII, mesh_stiffness=1.0, transmission_error=[{"amplitude": 1e-6}]),
            "transmission_error", "no mesh phase",
        ),
        (lambda: clutch(breakpoints=[0.01, -0.02, 0.05]), "breakpoints", "must rise"),
        (lambda: clutch(breakpoints=[]), "breakpoints", "is empty"),
        (lambda: clutch(stiffnesses=[1.0, 2.0]), "stiffnesses", "one more than"),
        (lambda: clutch(stiffnesses=[1.0, -2.0, 1.0, 1.0]), "stiffnesses", "must not be negative"),
        (lambda: clutch(stiffnesses=[0.0, 0.0, 0.0, 0.0]), "stiffnesses", "all zero"),
        (lambda: clutch(breakpoints="4 deg"), "breakpoints", "not a list"),
        (lambda: clutch(damping=-1.0), "damping", "must not be negative"),
        (lambda: clutch(damping_law="never pulling"), "damping_law", "is unknown"),
        (lambda: tn.PiecewiseShaft.symmetric([(1.0, 0.1)]), "stages", "two stages"),
    ],
)  # fmt: skip
def test_bad_numbers(make: Any, key: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        make()
    assert key in str(caught.value) and "\n" not in str(caught.value)


def test_a_stiff_mesh_is_a_ratio() -> None:
    """As k → ∞ the frequencies tend to those behind a Ratio, with an error that falls as 1/k."""
    rigid = tn.natural_frequencies(chain(tn.Ratio(teeth_in=20, teeth_out=20))).hertz
    assert rigid[1:] == pytest.approx([425.4, 634.1, 3247.2], abs=0.051)
    errors = []
    for k in (1e9, 1e10, 1e11):
        pair = tn.GearPair(teeth_in=20, teeth_out=20, module="2 mm", mesh_stiffness=k)
        found = tn.natural_frequencies(chain(pair)).hertz
        assert found[0] == 0.0 and len(found) == 5
        errors.append(np.abs(found[:4] - rigid).max())
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.02) and errors[1] / errors[2] == pytest.approx(10, rel=0.02)


def test_a_geared_chain_by_hand() -> None:
    """J₁ – k – J₂ with ratio 3/2: in rotations of the input, k r₂²·(2/3)² and J₂·(2/3)²."""
    pair = mesh()
    found = tn.natural_frequencies(tn.Driveline([tn.Disk(inertia=2e-3), pair, tn.Disk(inertia=5e-3)]))
    k, j = 2e6 * pair.radii[0] ** 2, 5e-3 / 1.5**2
    assert found.frequency[1] == pytest.approx(np.sqrt(k * (1 / 2e-3 + 1 / j)), rel=1e-12)


def test_linear_analyses_take_the_stage_under_load() -> None:
    def first(load: float, **changes: Any) -> float:
        elements = [tn.ConstantSpeed(), clutch(**changes), tn.Disk(inertia=0.02, load_torque=load)]
        return float(tn.natural_frequencies(tn.Driveline(elements)).undamped_frequency[0])

    # Torque at the breakpoints: −0.4, 0.2, 4.2 N m; a positive load twists backwards.
    for load, slope in ((0.0, 20.0), (1.0, 300.0), (-1.0, 100.0), (-5.0, 500.0), (-0.1, 20.0)):
        assert first(load) == pytest.approx(np.sqrt(slope / 0.02), rel=1e-12)
    with pytest.raises(InputError, match=r"PiecewiseShaft 1: turns freely .* load_torque"):
        first(0.0, stiffnesses=[300.0, 0.0, 100.0, 500.0])
    assert first(1.0, stiffnesses=[300.0, 0.0, 100.0, 500.0]) == pytest.approx(np.sqrt(300.0 / 0.02), rel=1e-12)
    with pytest.raises(InputError, match="no stage that carries"):
        first(1.0, stiffnesses=[0.0, 20.0, 100.0, 500.0])
    pair = tn.Driveline([tn.Disk(inertia=1e-3), mesh(backlash=1e-4), tn.Disk(inertia=1e-3)])
    with pytest.raises(InputError, match="turns freely"):
        tn.natural_frequencies(pair)


def test_static_twist_under_load() -> None:
    line = tn.Driveline([tn.ConstantSpeed(), clutch(), tn.Disk(inertia=0.02, load_torque=-2.0)])
    assembly = assemble(line)
    found = assembly.coefficients(assembly.table(1, 10.0))
    assert found.twist[0, 0] == pytest.approx(0.01 + (2.0 - 0.2) / 100.0)


@pytest.mark.parametrize(
    "elements",
    [
        [tn.Disk(inertia=1.0), tn.Shaft(stiffness=1.0), clutch(), tn.Disk(inertia=1.0)],
        [tn.Disk(inertia=1.0), clutch(), tn.Shaft(stiffness=1.0), tn.Disk(inertia=1.0)],
        [tn.Disk(inertia=1.0), mesh(), tn.Shaft(stiffness=1.0), tn.Disk(inertia=1.0)],
        [tn.Disk(inertia=1.0), tn.Shaft(stiffness=1.0), mesh(), tn.Disk(inertia=1.0)],
    ],
)
def test_springs_with_stages_need_inertia_on_both_sides(elements: list[Any]) -> None:
    with pytest.raises(InputError, match="no inertia"):
        tn.natural_frequencies(tn.Driveline(elements))


@pytest.mark.parametrize("law", ["always", "in contact", "never pulling"])
def test_the_pair_of_gears_is_the_papers_equation(law: str) -> None:
    """Both rotations integrated as they are give the deflection of the reduced equation, moved exactly."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=2e-3, load_torque=-1.0, excitation=[{"amplitude": 6.0, "frequency": 900.0, "phase": 0.3}]),
            tn.GearPair(**RADII, mesh_stiffness=2e6, mesh_damping=60, backlash=4e-5, damping_law=law),
            tn.Disk(inertia=5e-3, load_torque=1.5),
        ]
    )
    o = tn.exact_oscillator(line)
    assert o.inertia == pytest.approx(2e-3 * 5e-3 / (2e-3 * 0.06**2 + 5e-3 * 0.04**2))
    assert o.mean_force / o.inertia == pytest.approx(1.0 * 0.04 / 2e-3 + 1.5 * 0.06 / 5e-3)
    system = line_system(line, 100.0).system
    times = np.linspace(0, 0.03, 40)
    run = simulate_system(system, 0.03, start=[3e-5 / 0.04, 0, 0, 0], tolerance=1e-12).at(times)
    exact = piecewise.states(o.regimes, o.coefficients, o.frequency, [3e-5, 0.0], times)
    np.testing.assert_allclose(0.04 * run[:, 0] - 0.06 * run[:, 1], exact[:, 0], atol=1e-12)
    np.testing.assert_allclose(0.04 * run[:, 2] - 0.06 * run[:, 3], exact[:, 1], atol=1e-9)


def test_transmission_error_excites_the_reduced_equation() -> None:
    line = tn.Driveline(
        [
            tn.Disk(inertia=2e-3, load_torque=-1.0),
            mesh(
                backlash=4e-5, stiffness_ratio=0.2, mesh_damping=60,
                transmission_error=[{"amplitude": 3e-6, "phase": 0.5}, {"amplitude": 1e-6, "order": 2}],
            ),
            tn.Disk(inertia=5e-3, load_torque=1.5),
        ]
    )  # fmt: skip
    o = tn.exact_oscillator(line, 100.0)
    assert o.frequency == pytest.approx(1800.0)
    prepared = line_system(line, 100.0)
    assert prepared.period_turns is not None and float(prepared.period_turns) == pytest.approx(1 / 18)
    r1, r2 = mesh().radii
    e, rate = 3e-6 * np.cos(0.5) + 1e-6, -3e-6 * 1800 * np.sin(0.5)
    times = np.linspace(0, 0.03, 40)
    # The mesh runs with the mean rotation, that of the whole line as a rigid body: here it turns by itself as asked.
    turning, inertia = prepared.assembly.topology.mean_speeds[[0, -1]], np.array([2e-3, 5e-3])
    apart = np.array([1.0, 0.0]) - turning * (inertia * turning)[0] / (inertia @ turning**2)
    start = np.concatenate([apart * (3e-5 + e) / r1, apart * rate / r1])
    run = simulate_system(prepared.system, 0.03, start=start, tolerance=1e-12)
    u = -r2 * prepared.observe(prepared.system, times, run.at(times)).twist[:, 0]
    exact = piecewise.states(o.regimes, o.coefficients, o.frequency, [3e-5, 0.0], times)[:, 0]
    np.testing.assert_allclose(u, exact, atol=1e-12)


@pytest.mark.parametrize("law", ["always", "in contact"])
@pytest.mark.parametrize("start", [0.012, 0.01, -0.02])
def test_a_clutch_damper_is_one_equation(law: str, start: float) -> None:
    """Stages that differ in both directions, from within a stage and from between two."""
    disk = tn.Disk(inertia=0.02, load_torque=1.0, excitation=[{"amplitude": 2.0, "frequency": 90.0, "phase": 0.2}])
    line = tn.Driveline([tn.ConstantSpeed(), clutch(damping_law=law), disk])
    o = tn.exact_oscillator(line)
    times = np.linspace(0, 0.5, 20)
    run = simulate_system(line_system(line, 50.0).system, 0.5, start=[start, 0.0], tolerance=1e-12).at(times)
    exact = piecewise.states(o.regimes, o.coefficients, o.frequency, [start, 0.0], times)
    np.testing.assert_allclose(run, exact, atol=1e-10)


@pytest.mark.parametrize("start", [[1.0, 0.1], [1.0, 0.0], [-1.0, -0.1], [1.0, -0.1]])
def test_a_motion_may_start_on_a_switching_surface(start: list[float]) -> None:
    system = dead_zone_oscillator(frequency=0.6)
    o = tn.PiecewiseOscillator.gap(1.0, damping=0.1, mean_force=0.1, force=0.05, frequency=0.6)
    times = np.linspace(0, 10, 6)
    run = simulate_system(system, 10.0, start=start, tolerance=1e-11).at(times)
    np.testing.assert_allclose(run, piecewise.states(o.regimes, o.coefficients, 0.6, start, times), atol=1e-9)


def test_energy_is_conserved_through_a_geared_line() -> None:
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.05),
            tn.HookeJoint(angle=0.3),
            tn.Shaft(stiffness=8e3),
            tn.Disk(inertia=0.03),
            tn.GearPair(
                teeth_in=20, teeth_out=30, module=0.004, mesh_stiffness=5e7, backlash=2e-4, stiffness_ratio=0.05
            ),
            tn.Disk(inertia=0.05),
            tn.PiecewiseShaft(breakpoints=[-0.01, 0.01], stiffnesses=[4e3, 300.0, 6e3]),
            tn.Disk(inertia=0.1),
        ]
    )
    prepared = line_system(line, 60.0)
    start = np.array([0.01, -0.02, 0.015, 0.03, 3.0, -2.0, 1.0, 4.0])
    run = simulate_system(prepared.system, 0.3, start=start, tolerance=1e-12)
    times = np.linspace(0, 0.3, 60)
    kinetic, potential = energy(prepared, prepared.system, times, run.at(times))
    assert potential.max() > 5.0 and run.outcome.ok
    np.testing.assert_allclose(kinetic + potential, kinetic[0] + potential[0], rtol=1e-10)


def test_tangents_cross_every_surface() -> None:
    """Saltation at guards of twist and of rate, behind a Hooke's joint and with transmission error."""
    system = line_system(full_line(), 60.0).system
    n = system.size
    start = np.array([0.01, -0.02, 0.015, 3.0, -2.0, 1.0])

    def end(x: Any, tangents: bool = False) -> Any:
        block = np.vstack([x, np.eye(n)]) if tangents else x[None]
        return integrate(system.equations, 0.0, 0.08, block, regime=system.regime_at(0.0, x), tolerance=1e-13)

    run = end(start, tangents=True)
    assert len(run.event_time) > 10
    steps = np.array([1e-7] * 3 + [1e-6] * 3)
    columns = [
        (end(start + h * e).final[0] - end(start - h * e).final[0]) / (2 * h)
        for h, e in zip(steps, np.eye(n), strict=True)
    ]
    np.testing.assert_allclose(run.final[1:].T, np.array(columns).T, atol=2e-6 * np.abs(run.final[1:]).max())


def test_mesh_stiffness_that_varies_is_a_mathieu_oscillator() -> None:
    """No backlash, stiffness k(1 + s cos ωt): multipliers against the Mathieu equation's."""
    k, j, s = 2e6, 5e-3, 0.4
    pair = mesh(mesh_stiffness=k, mesh_damping=20.0, stiffness_variation=[{"share": s}])
    line = tn.Driveline([tn.ConstantSpeed(), pair, tn.Disk(inertia=j)])
    speed = 60.0
    found = tn.periodic_response(line, speed)
    r2, w = pair.radii[1], 18 * speed

    def rate(t: float, y: Any) -> list[float]:
        return [y[1], -(20.0 * r2**2 * y[1] + k * r2**2 * (1 + s * np.cos(w * t)) * y[0]) / j]

    from scipy.integrate import solve_ivp

    columns = [
        solve_ivp(rate, (0, 2 * np.pi / w), e, rtol=1e-12, atol=1e-14, method="DOP853").y[:, -1] for e in np.eye(2)
    ]
    wanted = np.linalg.eigvals(np.array(columns).T)
    assert np.sort_complex(found.multipliers) == pytest.approx(np.sort_complex(wanted), abs=1e-8)


@pytest.mark.slow
def test_shooting_and_harmonic_balance_agree_on_a_geared_line() -> None:
    """A Hooke-driven line whose mesh loses contact twice a turn: multipliers, torque, contact."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=8e3, damping=4.0),
            tn.Disk(inertia=0.05),
            tn.HookeJoint(angle=tn.deg(15)),
            tn.GearPair(
                teeth_in=20, teeth_out=30, module="4 mm", mesh_stiffness=3e6, mesh_damping=5000, backlash="0.4 mm",
                stiffness_ratio=0.1,
            ),
            tn.Disk(inertia=0.05, load_torque=8.0),
        ]
    )  # fmt: skip
    speed = tn.rpm(600)
    shot = tn.periodic_response(line, speed)
    assert len(shot.orbit.trajectory.event_time) == 2 and shot.outcome.ok
    balanced = tn.harmonic_balance(line, "speed", speed, speed * 1.0005, harmonics=24)
    i = int(np.argmin(np.abs(balanced.branch.parameter - speed)))
    np.testing.assert_allclose(balanced.branch.peak_to_peak[i], shot.torque_peak_to_peak, rtol=1e-3)
    assert np.abs(balanced.branch.multipliers[i]).max() == pytest.approx(shot.spectral_radius, rel=1e-3)


def test_two_surfaces_crossed_in_one_step() -> None:
    """The second guard is crossed first, both within a fraction of a step: neither is overlooked."""
    regimes = tn.Regimes(
        names=("00", "10", "01", "11"),
        guards=("late", "early"),
        guard=lambda t, x, p: (x[0] - 1.0, x[0] - p.early),
        switches=(
            tn.Switch("00", "late", +1, "10"), tn.Switch("00", "early", +1, "01"),
            tn.Switch("01", "late", +1, "11"), tn.Switch("10", "early", +1, "11"),
        ),
        locate=lambda t, x, p: int(x[0] > 1.0) + 2 * int(x[0] > p.early),
    )  # fmt: skip
    system = tn.System.from_function(
        lambda t, x, p, regime: (1.0 + 0.1 * regime,),
        ["x"],
        parameters={"early": 0.999},
        regimes=regimes,
        compiled=False,
    )
    run = simulate_system(system, 2.0, start=[0.0], tolerance=1e-9)
    assert run.trajectory.event_time == pytest.approx([0.999, 0.999 + 0.001 / 1.2])
    assert run.final[0] == pytest.approx(1.0 + 1.3 * (2.0 - 0.999 - 0.001 / 1.2))


@pytest.mark.parametrize(("load", "contact"), [(0.0, "two-sided"), (12.0, "one-sided"), (40.0, "one-sided")])
def test_contacts_are_those_of_the_exact_orbit(load: float, contact: str) -> None:
    """Shares, sides, impacts and their energy against the orbit of the reduced equation."""
    disk = tn.Disk(inertia=0.02, load_torque=load, excitation=[{"amplitude": 9.0, "frequency": 70.0}])
    spring = tn.PiecewiseShaft(breakpoints=[-0.05, 0.05], stiffnesses=[300.0, 0.0, 300.0], damping=0.5)
    line = tn.Driveline([tn.ConstantSpeed(), spring, disk])
    orbit = tn.piecewise_orbit(tn.exact_oscillator(line))
    response = tn.periodic_response(line, 70.0, start=orbit.start)
    assert isinstance(response, PeriodicResponse) and response.outcome.ok
    (found,) = response.contacts
    assert found.contact == contact == orbit.contact
    assert found.impacts == orbit.impacts
    assert found.impact_energy == pytest.approx(orbit.impact_energy, rel=1e-4, abs=1e-12)
    if load == 40.0:
        assert found.stage_shares == pytest.approx([1, 0, 0]) and "stays on its drive side" in str(found)
    else:
        times, states = orbit.motion(20_000)
        assert found.play_share == pytest.approx(np.mean(np.abs(states[:, 0]) < 0.05), abs=1e-3)
        assert any("contact is lost" in f.sentence for f in response.findings)


@pytest.mark.parametrize(
    ("line", "options", "words"),
    [
        (lambda: tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1.0), tn.Disk(inertia=1.0)]), {}, "one spring"),
        (full_line, {}, "one spring"),
        (lambda: pair_of(viscous_load=0.1), {}, "depends on the speed"),
        (lambda: pair_of(spring=mesh(stiffness_variation=[{"share": 0.1}])), {}, "vary in time"),
        (lambda: pair_of(spring=mesh(transmission_error=[{"amplitude": 1e-6}])), {}, "is needed by"),
        (
            lambda: pair_of(excitation=[{"amplitude": 1, "frequency": 100}, {"amplitude": 1, "frequency": 141.42}]),
            {}, "no common period",
        ),
    ],
)  # fmt: skip
def test_what_is_not_one_equation(line: Any, options: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        tn.exact_oscillator(line(), **options)


def pair_of(spring: Any = None, **disk: Any) -> tn.Driveline:
    return tn.Driveline([tn.Disk(inertia=1e-3), spring or mesh(), tn.Disk(inertia=2e-3, **disk)])


def test_kinematics_take_a_mesh_rigid() -> None:
    """Behind a GearPair everything turns as behind its Ratio; a shaft with stages twists as its load has it."""

    def line(gears: Any) -> tn.Driveline:
        return tn.Driveline(
            [
                tn.ConstantSpeed(),
                tn.Shaft(stiffness=1e4),
                tn.HookeJoint(angle=0.2),
                tn.Shaft(stiffness=1e4),
                tn.Disk(inertia=0.1),
                gears,
                tn.Disk(inertia=0.1),
                clutch(stiffnesses=[3e3, 200.0, 1e3, 5e3]),
                tn.Disk(inertia=0.1, load_torque=20.0),
            ]
        )

    one = tn.kinetostatics(line(mesh(backlash=1e-4)), speed=10.0)
    other = tn.kinetostatics(line(tn.Ratio(teeth_in=18, teeth_out=27)), speed=10.0)
    np.testing.assert_allclose(one.output_speed, other.output_speed, rtol=1e-12)
    # −4 N m up to the first breakpoint, then 16 N m at 3 kN m/rad.
    twist = one.angle[-1] - one.angle[-1].mean()
    assert np.isfinite(twist).all()
    assert tn.sketch(line(mesh())) is not None


PAIR = """
format = 1
name = "gear pair"
[[element]]
type = "Disk"
inertia = "0.002 kg*m^2"
load_torque = "-1 N*m"
[[element.excitation]]
amplitude = "6 N*m"
frequency = 3000
[[element]]
type = "GearPair"
teeth_in = 18
teeth_out = 27
module = "5 mm"
mesh_stiffness = "2e6 N/m"
mesh_damping = "60 N*s/m"
backlash = "40 um"
stiffness_ratio = 0.1
[[element]]
type = "Disk"
inertia = "0.005 kg*m^2"
load_torque = "1.5 N*m"
"""


@pytest.mark.slow
def test_commands_take_a_file(tmp_path: Path) -> None:
    file, picture = tmp_path / "pair.toml", tmp_path / "r.png"
    file.write_text(PAIR, encoding="utf-8")

    def told(*arguments: str) -> Any:
        result = CliRunner().invoke(app, [*arguments, "--json", "-o", str(picture)])
        assert result.exit_code == 0, result.output
        return json.loads(result.stdout)

    o = tn.exact_oscillator(tn.load(file))
    (up,) = told("sweep", str(file), "--points", "31", "--direction", "up")["sweeps"]
    assert up["frequency"][0] == 1500.0 and up["frequency"][-1] == 4500.0
    assert up["half_peak_to_peak"] == pytest.approx(tn.sweep(o, up["frequency"]).peak_to_peak / 2)
    (exact,) = told("frequency-response", str(file), "--from", "1700", "--to", "1900")["methods"]
    assert exact["peak"]["half_peak_to_peak"] == pytest.approx(0.000687911, rel=1e-3)
    file.write_text(
        PAIR.replace("backlash", 'transmission_error = [{ amplitude = "2 um" }]\nbacklash'), encoding="utf-8"
    )
    for arguments, words in (
        (["sweep", str(file)], "have no common period"),
        (["sweep", str(file), "--set", "a=1"], "belongs to"),
    ):
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code != 0 and words in f"{result.output} {result.exception}"


@pytest.mark.slow
def test_report_of_a_line_with_backlash() -> None:
    """Its own table: the clutch that lands, the mesh that stays where the load has it."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=4e3, damping=3.0),
            tn.Disk(inertia=0.05),
            tn.GearPair(
                teeth_in=20, teeth_out=30, module="4 mm", mesh_stiffness=5e7, mesh_damping=2000, backlash="0.1 mm"
            ),
            tn.Disk(inertia=0.05, load_torque=40.0),
            tn.PiecewiseShaft(breakpoints=[-0.01, 0.01], stiffnesses=[4e3, 200.0, 4e3], damping=3.0),
            tn.Disk(inertia=0.1, load_torque=1.0, excitation=[{"amplitude": 60.0, "order": 4}]),
        ],
        operation=tn.Operation(speed="900 rpm"),
    )
    page = tn.report(line).html
    # Nor does it break at its hyphen.
    assert '<td class="whole">one-sided</td>' in page and ".whole { white-space: nowrap; }" in page
    assert "Backlash and stages" in page and "GearPair 1" in page and "one-sided" in page and "contact is lost" in page

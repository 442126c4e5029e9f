"""Exact motion of lines with several inertias and gaps, against other ways to the same numbers and against laws."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import trunnion as tn
from trunnion.equations.line_system import line_system
from trunnion.equations.staged_line import StagedLine, staged_line
from trunnion.errors import InputError
from trunnion.numerics.piecewise_linear import piecewise
from trunnion.numerics.piecewise_linear.staged_flow import StagedFlow, move, period, stages_of

SPEED = 40.0


def gap_pair(law: str, **changes: Any) -> tn.Driveline:
    """Two inertias and a mesh: the line that is one equation too."""
    numbers = {"mesh_damping": 1500.0, "backlash": 80e-6, "damping_law": law, **changes}
    return tn.Driveline(
        [
            tn.Disk(inertia=1.5e-3, load_torque=-20.0, excitation=[{"amplitude": 45.0, "frequency": 9000.0}]),
            tn.GearPair(teeth_in=25, teeth_out=40, module=0.003, mesh_stiffness=2e8, **numbers),
            tn.Disk(inertia=6e-3, load_torque=32.0),
        ]
    )


def long_line(law: str = "in contact", excitation: Any = ({"amplitude": 30.0, "frequency": 90.0},)) -> tn.Driveline:
    """Four inertias behind a drive, a mesh with backlash and error and a clutch damper among them."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=8e3, damping=4.0),
            tn.Disk(inertia=0.05),
            tn.GearPair(
                teeth_in=20, teeth_out=30, module="4 mm", mesh_stiffness="2e7 N/m", mesh_damping=900, damping_law=law,
                backlash="0.1 mm", transmission_error=[{"amplitude": "20 um"}],
            ),
            tn.Disk(inertia=0.05),
            tn.PiecewiseShaft.symmetric([(200.0, "0.5 deg"), (4000.0, None)], damping=2.0),
            tn.Disk(inertia=0.1),
            tn.Shaft(stiffness=3e3, damping=1.0),
            tn.Disk(inertia=0.2, load_torque=3.0, viscous_load=0.05, excitation=list(excitation)),
        ]
    )  # fmt: skip


def branched() -> tn.Driveline:
    """Free, with a branch, a ratio, a viscous load, and a gap in either arm."""
    gap = {"breakpoints": [-0.004, 0.004], "stiffnesses": [4e3, 0.0, 6e3], "damping": 2.0}
    return tn.Driveline(
        [
            tn.Disk(inertia=0.4, load_torque=-9.0, excitation=[{"amplitude": 25.0, "frequency": 70.0, "phase": 0.4}]),
            tn.Shaft(stiffness=5e3, damping=1.5),
            tn.Disk(inertia=0.05, name="middle"),
            tn.PiecewiseShaft(**gap),
            tn.Disk(inertia=0.1, viscous_load=0.04),
            tn.Ratio(teeth_in=20, teeth_out=30, after="middle"),
            tn.PiecewiseShaft(**gap, damping_law="in contact"),
            tn.Disk(inertia=0.08, load_torque=2.0),
        ]
    )


def matrices(flow: StagedFlow, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A (2m, 2m) and the constant (2m,) of z′ = A z + a + forcing, in the stages of a state."""
    m = flow.size
    pieces = flow.pieces[np.arange(m), stages_of(flow, state)]
    a = np.block(
        [[np.zeros((m, m)), np.eye(m)], [-flow.inverse * pieces[:, 1], -flow.inverse * pieces[:, 0] - flow.drag]]
    )
    return a, np.append(np.zeros(m), flow.constant - flow.inverse @ pieces[:, 2])


@pytest.mark.parametrize("law", ["always", "in contact", "never pulling"])
def test_one_spring_is_the_oscillator(law: str) -> None:
    """The same pair by closed forms of one equation: state, events, tangents, orbit."""
    line = gap_pair(law)
    one, flow, out = tn.exact_oscillator(line), staged_line(line).flow(), line.elements[1].radii[1]
    start, end = np.array([5e-5, 0.1]), 10 * one.period
    there = piecewise.move(one.regimes, one.coefficients, one.frequency, start, 0.0, end)
    here = move(flow, -start / out, 0.0, end, tangents=True, by_parameter=True)
    size = np.array([5e-5, 0.1])
    np.testing.assert_allclose(-here.state * out / size, there.state / size, atol=1e-12)
    assert len(here.events) == len(there.crossings) > 15
    np.testing.assert_allclose(here.events[:, 0], there.crossings[:, 0], atol=1e-13 * end)
    np.testing.assert_allclose(here.tangents[:, :2], there.tangents[:, :2], rtol=1e-10)
    np.testing.assert_allclose(-here.tangents[:, 2] * out, there.tangents[:, 2], rtol=1e-10)
    known = tn.piecewise_orbit(one)
    orbit = tn.piecewise_orbit(line, -known.start / out)
    np.testing.assert_allclose(np.sort_complex(orbit.multipliers), np.sort_complex(known.multipliers), rtol=1e-9)
    np.testing.assert_allclose(orbit.twist_low * -out, known.highest, rtol=1e-11)
    np.testing.assert_allclose(orbit.twist_mean * -out, known.mean, rtol=1e-9)
    if law != "never pulling":  # there the ends of stages are not twists alone
        assert orbit.clearance * out == pytest.approx(known.clearance, rel=1e-7)
    (contact,) = orbit.contacts
    assert contact.impacts == known.impacts and contact.contact == known.contact
    assert contact.impact_energy == pytest.approx(known.impact_energy, rel=1e-9)


def test_linear_chain_against_the_matrix_exponential() -> None:
    """Constant torques on linear springs, viscous loads and a common ratio of damping; a long step of a stiff line."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            *(e for k in (2e3, 5e5, 3e3) for e in (tn.Shaft(stiffness=k), tn.Disk(inertia=0.03, viscous_load=0.2))),
            tn.Ratio(ratio=2.5),
            tn.Shaft(stiffness=900.0),
            tn.Disk(inertia=0.2, load_torque=7.0),
        ],
        damping_ratio=0.02,
    )
    flow, start = staged_line(line, SPEED).flow(), np.array([1, -2, 3, 4, 100, 20, -30, 50]) * 1e-3
    run = move(flow, start, 0.0, 0.7, tangents=True)
    a, constant = matrices(flow, start)
    whole = expm(0.7 * np.block([[a, constant[:, None]], [np.zeros(9)]]))
    size = np.repeat([0.003, 0.3], 4)
    np.testing.assert_allclose(run.state / size, (whole @ np.append(start, 1.0))[:8] / size, atol=1e-11)
    np.testing.assert_allclose(run.tangents, whole[:8, :8], atol=1e-11 * np.abs(whole).max())


def test_an_undamped_resonance_and_free_flight() -> None:
    """Both have closed forms that divide by nothing here: t sin ωt / 2ω, and t²."""
    shaken = tn.Disk(inertia=2.0, excitation=[{"amplitude": 3.0, "frequency": 10.0}])
    line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=200.0), shaken])
    motion = tn.exact_motion(line, times=[0.0, 4.0, 9.0])
    t = motion.time
    np.testing.assert_allclose(motion.twist[:, 0], 1.5 * t * np.sin(10 * t) / 20, atol=1e-13)
    gap = tn.PiecewiseShaft(breakpoints=[-3.0, 3.0], stiffnesses=[1.0, 0.0, 1.0])
    free = tn.Driveline([tn.ConstantSpeed(), gap, tn.Disk(inertia=2.0, load_torque=3.0)])
    motion = tn.exact_motion(free, times=[0.0, 0.5, 1.5, 2.5])
    np.testing.assert_allclose(motion.twist[:3, 0], -0.75 * motion.time[:3] ** 2, rtol=1e-14)
    assert motion.events.time == pytest.approx([np.sqrt(3 / 0.75)], rel=1e-15) and motion.events.side.tolist() == [-1]


@pytest.mark.parametrize("law", ["in contact", "never pulling"])
def test_simulate_agrees(law: str) -> None:
    line, times = long_line(law), np.linspace(0.0, 0.4, 101)
    exact = tn.exact_motion(line, times=times, speed=SPEED)
    run = tn.simulate(line, times=times, speed=SPEED, tolerance=1e-11)
    assert exact.outcome.ok and len(exact.events) > 60 and len(set(exact.events.spring)) == 2
    np.testing.assert_allclose(exact.events.time, run.event_time, atol=1e-10)
    assert np.all(np.diff(exact.events.time) >= 0)
    np.testing.assert_allclose(exact.twist, run.twist, atol=2e-9 * np.ptp(run.twist, axis=0).max())
    # At a landing the torque of a damper jumps, which no sample may fall on.
    np.testing.assert_allclose(exact.torque, run.torque, atol=1e-7 * np.ptp(run.torque))


def test_a_free_line_with_branches_agrees_with_simulate() -> None:
    line, times = branched(), np.linspace(0.0, 0.5, 101)
    exact = tn.exact_motion(line, times=times, speed=SPEED)
    run = tn.simulate(line, times=times, speed=SPEED, tolerance=1e-11)
    assert exact.line.turns and exact.start.shape == (8,) and exact.twist.shape == (101, 3)
    assert len(exact.events) == len(run.event_time) > 20
    np.testing.assert_allclose(exact.twist, run.twist, atol=1e-9 * np.ptp(run.twist))
    # Twists from rotations, as for a start taken from a simulation.
    last = exact.line.from_rotations(run.final, times[-1])
    np.testing.assert_allclose(last, exact.final, atol=1e-8 * np.abs(exact.final).max())


def test_parts_make_the_whole() -> None:
    """A run continued from the middle, dense states between the samples, events in the order of time."""
    line = long_line()
    whole = tn.exact_motion(line, 0.3, speed=SPEED)
    first = tn.exact_motion(line, 0.11, speed=SPEED)
    rest = tn.exact_motion(line, 0.19, speed=SPEED, start=first.final, start_time=0.11)
    size = np.abs(whole.state).max(axis=0)
    np.testing.assert_allclose(rest.final / size, whole.final / size, atol=1e-10)
    assert len(first.events) + len(rest.events) == len(whole.events)
    np.testing.assert_allclose(whole.at(whole.time[::-7]), whole.state[::-7], atol=0)
    assert np.isnan(whole.at(0.31)).all()
    # Between two events of a spring its stages follow each other.
    clutch = whole.events.spring == 2
    assert np.all(np.abs(np.diff(np.append([1], whole.events.stage[clutch]))) == 1)
    sides = whole.events.side[whole.events.spring == 1]
    assert np.all((sides[1:] == 0) != (sides[:-1] == 0))


@pytest.mark.parametrize(
    ("law", "independent_variable"), [("in contact", "speed"), ("never pulling", "speed"), ("always", "frequency")]
)
def test_tangents_through_crossings(law: str, independent_variable: str) -> None:
    """Against central differences of the motion over a period, by start and by speed or frequency."""
    line = long_line(law, ()) if independent_variable == "speed" else branched()
    prepared = staged_line(line, 12.3)
    value = prepared.value if independent_variable == "frequency" else 12.3
    assert prepared.independent_variable == independent_variable

    def after(state: np.ndarray, value: float) -> np.ndarray:
        return move(prepared.flow(value), state, 0.0, 4 * prepared.period(value)).state

    start = move(prepared.flow(value), prepared.rest() + 1e-3, 0.0, 3 * prepared.period(value)).state
    length = 4 * prepared.period(value)
    run = period(prepared.flow(value), start, length, -length / value)
    assert len(run.events) >= 4
    steps = np.append(np.repeat([1e-8, 1e-6], prepared.size), 1e-6 * value)
    for i, h in enumerate(steps):
        ends = []
        for side in (-1, 1):
            moved = np.append(start, value)
            moved[i] += side * h
            ends.append(after(moved[:-1], moved[-1]))
        expected = (ends[1] - ends[0]) / (2 * h)
        np.testing.assert_allclose(run.tangents[:, i], expected, atol=2e-6 * np.abs(expected).max())


def test_energy() -> None:
    """Work of the torques and of the drive's twisting = change of energy + dissipation, through landings."""
    line = replace_error(long_line())
    exact = tn.exact_motion(line, 0.25, speed=SPEED)
    assert len(exact.events) > 20
    prepared, m = exact.line, exact.line.size
    flow = prepared.flow()
    nodes, weights = np.polynomial.legendre.leggauss(12)
    cuts = np.unique(np.concatenate([exact.events.time, np.linspace(0, 0.25, 300)]))
    half = np.diff(cuts)[:, None] / 2
    times, weight = (cuts[:-1, None] + half * (1 + nodes)).ravel(), (half * weights).ravel()
    run = move(flow, exact.start, 0.0, 0.25, times=times)
    rate, torque = run.states[:, m:], flow.torque(run.states, run.shown_stages)
    piece = flow.pieces[np.arange(m), run.shown_stages]
    # In twists M becomes G⁻¹: G⁻¹ q″ + f + G⁻¹ D q′ = G⁻¹ b.
    mass = np.linalg.inv(flow.inverse)
    push = flow.constant + np.real(np.exp(1j * np.outer(times, flow.frequencies)) @ flow.force)
    work = weight @ np.sum((push @ mass) * rate, axis=1)
    lost = weight @ np.sum(piece[..., 0] * rate**2 + (rate @ (mass @ flow.drag).T) * rate, axis=1)

    def energy(state: np.ndarray) -> float:
        total = 0.5 * state[m:] @ mass @ state[m:]
        for e in range(m):
            grid = np.append(np.sort(flow.guards[e, :, :, 2][flow.then[e] >= 0]), [0.0, state[e]])
            path = np.unique(np.clip(grid, min(0.0, state[e]), max(0.0, state[e])))
            middle = (path[1:] + path[:-1]) / 2
            for a, b, x in zip(path, path[1:], middle, strict=False):
                at = np.zeros(2 * m)
                at[e] = x
                c, s, d = flow.pieces[e, stages_of(flow, at)[e]]
                total += np.sign(state[e]) * (s * (b**2 - a**2) / 2 + d * (b - a))
        return float(total)

    change = energy(run.state) - energy(exact.start)
    assert lost > 1.0 and work == pytest.approx(change + lost, rel=1e-11)
    assert np.abs(torque).max() > 50


def replace_error(line: tn.Driveline) -> tn.Driveline:
    """Without transmission error, whose work is not that of a torque."""
    return line.replace("GearPair 1", transmission_error=None)


def test_orbit_is_that_of_periodic_response() -> None:
    """With impacts: start, multipliers, contacts and torques, to the tolerance of the integration; the sum rule."""
    line = long_line(excitation=())
    orbit = tn.piecewise_orbit(line, speed=12.05)
    assert orbit.outcome.ok and orbit.contacts[0].rattles and orbit.contacts[1].rattles
    prepared = line_system(line, 12.05)
    twisting = np.linalg.inv(np.array([prepared_row(orbit.line, i) for i in range(4)]).T)
    e, rate = orbit.line.errors(0.0)
    start = np.concatenate([twisting @ (orbit.start[:4] - e), twisting @ (orbit.start[4:] - rate)])
    response = tn.periodic_response(prepared.assembly, 12.05, start=start, compare=False)
    assert response.outcome.ok
    np.testing.assert_allclose(np.abs(response.multipliers), np.abs(orbit.multipliers), atol=1e-6)
    np.testing.assert_allclose(response.torque_mean, orbit.torque_mean, rtol=1e-4)
    # At a landing the torque of the mesh jumps with its damping, between the samples.
    plain = [0, 2, 3]
    np.testing.assert_allclose(response.torque.max(axis=0)[plain], orbit.torque_high[plain], rtol=1e-5)
    assert orbit.torque_high[1] > response.torque[:, 1].max()
    for found, known in zip(orbit.contacts, response.contacts, strict=True):
        assert (found.spring, found.impacts, found.sides) == (known.spring, known.impacts, known.sides)
        assert found.impact_energy == pytest.approx(known.impact_energy, rel=1e-3)
        np.testing.assert_allclose(found.stage_shares, known.stage_shares, atol=1e-6)
    assert orbit.slowest_crossing == np.abs(orbit.events.rate).min() > 0


def prepared_row(line: StagedLine, coordinate: int) -> np.ndarray:
    """Twists by one rotation alone, without the errors."""
    unit = np.zeros(8)
    unit[coordinate] = 1.0
    return line.from_rotations(unit)[:4] - line.errors(0.0)[0]


def test_multipliers_of_modes_that_the_motion_does_not_excite() -> None:
    """A motion in one stage: Φ is the exponential of its matrix, fast decaying modes included."""
    orbit = tn.piecewise_orbit(long_line(excitation=()), speed=20.0)
    assert orbit.outcome.ok and len(orbit.events) == 0 and 0 < orbit.clearance < 1e-3
    flow = orbit.line.flow()
    a, _ = matrices(flow, orbit.start)
    np.testing.assert_allclose(orbit.monodromy, expm(a * orbit.period), atol=1e-12 * np.abs(orbit.monodromy).max())


def test_grazing_is_where_the_branch_says() -> None:
    """Towards the grazing the closest approach goes to zero from one side, the slowest crossing from the other."""
    line = long_line(excitation=())
    branch = tn.piecewise_branch(line, 16.0, 17.0)
    assert branch.outcome.ok and branch.curves == ("Shaft 1", "GearPair 1", "PiecewiseShaft 1", "Shaft 2")
    (grazing,) = [p for p in branch.special if p.kind == "grazing"]
    below = tn.piecewise_orbit(line, grazing.start, speed=grazing.parameter - 1e-6)
    above = tn.piecewise_orbit(line, grazing.start, speed=grazing.parameter + 1e-6)
    touching, clear = (below, above) if len(below.events) else (above, below)
    assert len(touching.events) == 2 and len(clear.events) == 0
    assert 0 < clear.clearance < 1e-9
    usual = np.abs(clear.motion()[1][:, 4 + int(touching.events.spring[0])]).max()
    assert touching.slowest_crossing < 0.02 * usual
    swing = branch.peak_to_peak[0]
    np.testing.assert_allclose(swing, tn.piecewise_orbit(line, speed=16.0).torque_peak_to_peak, rtol=1e-10)


def test_sweep_finds_the_stable_motions_and_the_jump() -> None:
    line = long_line(excitation=())
    speeds = [10.5, 11.5, 13.0, 14.0]
    swept = tn.sweep(line, speeds)
    assert swept.outcome.ok and swept.settled.all()
    for i in (0, 3):
        orbit = tn.piecewise_orbit(line, swept.state[i], speed=speeds[i])
        np.testing.assert_allclose(swept.torque_peak_to_peak[i], orbit.torque_peak_to_peak, rtol=1e-6)
    assert swept.contacts[0][0].sides == "lower" and swept.up
    assert swept.data.sizes == {"speed": 4, "spring": 4, "staged_spring": 2}
    response = tn.frequency_response(line, 16.0, 17.0, method="exact")
    assert response.outcome.ok and len(response.frequency) > 5


def test_too_many_changes_end_the_run_in_a_sentence() -> None:
    motion = tn.exact_motion(long_line(), 0.5, speed=SPEED, most_events=10)
    assert not motion.outcome.ok and motion.outcome.kind == "chatter" and "most_events" in motion.outcome.sentence
    assert len(motion.events) == 10 and motion.events.time[-1] <= motion.end < 0.5
    assert motion.time[-1] <= motion.end and np.isfinite(motion.state).all()
    assert "GearPair 1 changes its stage too often" in str(motion)
    assert tn.exact_motion(long_line(), motion.end, speed=SPEED).twist[-1] == pytest.approx(motion.final[:4], abs=1e-9)


def test_states_on_the_end_of_a_stage() -> None:
    """At rest there nothing happens; pushed either way the stage is the one entered, without an event behind it."""

    def line(load: float) -> tn.Driveline:
        gap = tn.PiecewiseShaft(breakpoints=[-0.1, 0.1], stiffnesses=[10.0, 0.0, 10.0])
        return tn.Driveline([tn.ConstantSpeed(), gap, tn.Disk(inertia=1.0, load_torque=load)])

    resting = tn.exact_motion(line(0.0), 5.0, start=[0.1, 0.0])
    assert len(resting.events) == 0 and resting.final.tolist() == [0.1, 0.0]
    pushed = tn.exact_motion(line(-0.2), 0.3, start=[0.1, 0.0])
    assert len(pushed.events) <= 1 and pushed.final[0] == pytest.approx(0.1 + 0.02 * (1 - np.cos(np.sqrt(10) * 0.3)))
    pulled = tn.exact_motion(line(0.2), 0.3, start=[0.1, 0.0])
    assert len(pulled.events) <= 1 and pulled.final[0] == pytest.approx(0.1 - 0.1 * 0.3**2, rel=1e-14)
    # Two gaps that end at the same time.
    gap = tn.PiecewiseShaft(breakpoints=[-0.1, 0.1], stiffnesses=[10.0, 0.0, 10.0])
    disk = tn.Disk(inertia=1.0, load_torque=0.3)
    arms = [gap, disk, tn.PiecewiseShaft(**{**gap.stated, "after": "root"}), disk]
    both = tn.exact_motion(tn.Driveline([tn.ConstantSpeed(name="root"), *arms]), 3.0)
    assert sorted(both.events.spring[:2]) == [0, 1] and both.events.time[0] == both.events.time[1]
    np.testing.assert_allclose(both.twist[:, 0], both.twist[:, 1], atol=1e-14)


def pair(spring: Any = None, **disk: Any) -> tn.Driveline:
    return tn.Driveline([tn.ConstantSpeed(), spring or tn.Shaft(stiffness=1e3), tn.Disk(inertia=2e-3, **disk)])


MESH: dict[str, Any] = {"teeth_in": 20, "teeth_out": 30, "module": 0.004, "mesh_stiffness": 1e7}
ORDER, TIME = {"amplitude": 1.0, "order": 2}, {"amplitude": 1.0, "frequency": 30.0}


def between(element: Any) -> tn.Driveline:
    shaft = tn.Shaft(stiffness=1e3)
    return tn.Driveline([tn.ConstantSpeed(), shaft, tn.Disk(inertia=0.1), element, shaft, tn.Disk(inertia=0.1)])


@pytest.mark.parametrize(
    ("act", "words"),
    [
        (lambda: tn.exact_motion(between(tn.HookeJoint(angle=0.1)), 1.0), r"HookeJoint 1\.angle = 0\.1: .*tn\.sim"),
        (
            lambda: tn.exact_motion(between(tn.TripodJoint(angle=0.1, radius=0.05, length=1)), 1.0),
            r"TripodJoint 1\.angle",
        ),
        (
            lambda: tn.exact_motion(pair(tn.GearPair(**MESH, stiffness_variation=[{"share": 0.1}])), 1.0),
            r"GearPair 1\.stiffness_variation: makes the stages vary",
        ),
        (lambda: tn.exact_motion(pair(quadratic_load=0.1), 1.0), r"Disk 1\.quadratic_load = 0\.1: is not linear"),
        (
            lambda: tn.exact_motion(
                tn.Driveline([*pair().elements, tn.Shaft(stiffness=1.0), tn.ConstantSpeed()]), 1.0
            ),
            "second prescribed speed",
        ),
        (lambda: tn.exact_motion(pair(excitation=[ORDER]), 1.0), "speed: is needed"),
        (lambda: tn.exact_motion(pair(viscous_load=0.1), 1.0), "speed: is needed"),
        (lambda: tn.exact_motion("truck"), "is a str"),
        (lambda: tn.exact_motion(pair()), "duration.*must be a positive time"),
        (lambda: tn.exact_motion(pair(), 1.0, start=[0.0]), r"driveline\.start.*must be 2 finite numbers.*Shaft 1"),
        (lambda: tn.exact_motion(pair(), 1.0, times=[0.5, 0.1]), "times.*must rise"),
        (lambda: tn.exact_motion(pair(), 1.0, times=[0.5, 1.1]), "times.*within the run"),
        (lambda: tn.exact_motion(pair(), 1.0, most_events=0), "most_events = 0"),
        (lambda: tn.piecewise_orbit(pair()), "excited by nothing"),
        (lambda: tn.piecewise_orbit(pair(excitation=[TIME]), periods=0), "periods = 0"),
        (lambda: tn.piecewise_orbit(pair(excitation=[TIME, {**TIME, "frequency": 44.44}])), "no common period"),
        (lambda: tn.piecewise_orbit(branched().replace("Disk 1", excitation=[ORDER]), speed=9.0), "is free–free under"),
        (lambda: tn.piecewise_branch(pair(excitation=[TIME, ORDER]), 15.0, 60.0), "by its rotation and in time"),
        (lambda: tn.piecewise_branch(pair(), 15.0, 60.0), "excited by nothing"),
        (lambda: tn.piecewise_branch(pair(excitation=[TIME]), 60.0, 15.0), "rising range"),
        (lambda: tn.sweep(pair(excitation=[TIME]), [0.0, 1.0]), "must be positive"),
        (lambda: tn.sweep(tn.catalogue("gear-rattle"), [0.5], speed=3.0), "speed = 3: belongs to a driveline"),
        (lambda: tn.piecewise_orbit(tn.catalogue("gear-rattle"), speed=3.0), "speed = 3: belongs to a driveline"),
        (lambda: tn.piecewise_branch(tn.catalogue("gear-rattle"), 0.5, 0.6, speed=3.0), "belongs to a driveline"),
        (lambda: tn.sweep(pair(excitation=[TIME], viscous_load=1.0), [20.0]), "speed: is needed"),
    ],
)  # fmt: skip
def test_refusals(act: Callable[[], Any], words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        act()
    assert "\n" not in str(caught.value)


def test_straight_joints_and_no_motion() -> None:
    """A joint without angle is none; where no orbit is found the result says so and what to do."""
    assert tn.exact_motion(between(tn.HookeJoint(angle=0.0)), 0.1).outcome.ok
    undamped = pair(tn.Shaft(stiffness=2e-3 * 30.0**2), excitation=[TIME])
    orbit = tn.piecewise_orbit(undamped, settle=False)
    assert not orbit.outcome.ok and "no periodic motion" in str(orbit) and np.isnan(orbit.multipliers).all()
    assert "give some damping" in str(orbit)

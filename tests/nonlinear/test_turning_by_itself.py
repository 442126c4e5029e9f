"""Free–free lines turn as their torques let them: turns, speeds, orders and meshes are those of that rotation.

Truth is integrated by scipy in absolute angles, of equations written here.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.integrate import odeint, solve_ivp

import trunnion as tn
from trunnion.equations.line_system import line_system

ENGINE, LOAD, STIFFNESS, DAMPING = 0.4, 1.7, 6e3, 1.5


def runaway(**drive: object) -> tn.Driveline:
    """A drive of 90 N m that outruns the speed it is begun at fivefold; its own is just below 100 rad/s."""
    engine = {"load_torque": -90.0, "viscous_load": 0.6, "excitation": [{"order": 2, "amplitude": 40.0}]} | drive
    return tn.Driveline(
        [
            tn.Disk(inertia=ENGINE, **engine),
            tn.Shaft(stiffness=STIFFNESS, damping=DAMPING),
            tn.Disk(inertia=LOAD, quadratic_load=0.003),
        ]
    )


def truth(drive, times: np.ndarray, speed: float) -> np.ndarray:
    """Rotations and speeds (4, times) of both disks under the drive's torque by time."""

    def rate(t: float, y: np.ndarray) -> list[float]:
        a, b, u, v = y
        shaft = STIFFNESS * (b - a) + DAMPING * (v - u)
        return [u, v, (drive(t) - 0.6 * u + 40 * np.cos(2 * a) + shaft) / ENGINE, (-shaft - 0.003 * v * abs(v)) / LOAD]

    start = [0.0, 0.0, speed, speed]
    return odeint(rate, start, times, rtol=1e-10, atol=1e-9, mxstep=10_000, tfirst=True, hmax=0.05).T


@pytest.fixture(scope="module")
def motion() -> tn.motion.simulation.simulation.LineSimulation:
    return tn.simulate(runaway(), 20.0, speed=20.0)


def test_turns_and_input_speed_are_those_that_the_line_makes(motion) -> None:
    """Begun at 20 rad/s, of which 20 s would make 64 turns."""
    times = np.linspace(0.0, 20.0, 20_001)
    a, _, u, _ = truth(lambda t: 90.0, times, 20.0)
    assert motion.turns == pytest.approx(a[-1] / (2 * np.pi), abs=1e-6) and motion.turns > 290
    np.testing.assert_allclose(motion.input.angle(times), a, atol=1e-5)
    np.testing.assert_allclose(motion.input.speed(times), u, atol=1e-4)
    assert motion.input_speed[-1] == pytest.approx(u[-1], abs=1e-4)
    data = motion.data
    np.testing.assert_allclose(np.interp(times, data.time, data.input_angle), a, atol=0.02)
    assert float(data.input_speed[-1]) == pytest.approx(u[-1], abs=1e-4) and float(data.reference_speed[-1]) == 20.0
    # Every turn takes as long as it does.
    ends, speed = motion.input.turns
    assert len(motion.whole.turns[1]) == len(speed)
    k = 2 * np.pi * np.arange(len(ends))
    np.testing.assert_allclose(np.interp(ends, times, a), k, atol=1e-3)
    np.testing.assert_allclose(motion.input.angle(ends), k, atol=1e-8)
    assert speed[-1] == pytest.approx(100.0, abs=0.1)  # 90 = 0.6 w + 0.003 w²
    assert "(293.271 turns)" in str(
        motion
    ) and "it turns at 24.56 rad/s in its first turn and at 99.99 rad/s in its last" in str(motion)


def test_orders_are_of_the_rotation_that_the_line_makes(motion) -> None:
    """The excitation is of order 2 whatever the line was begun at; its torque by a Fourier sum of the truth."""
    found = tn.order_map(motion)
    assert len(found.speed) == 72 and found.speed[0] < 45 and found.speed[-1] == pytest.approx(99.99, abs=0.01)
    assert np.all(found.order[1:][found.amplitude[5:, 1:, 0].argmax(axis=1)] == 2.0)
    times = np.linspace(0.0, 20.0, 200_001)
    a, b, u, v = truth(lambda t: 90.0, times, 20.0)
    whole = (ENGINE * a + LOAD * b) / (ENGINE + LOAD)
    angles = whole[-1] - 2 * np.pi * np.arange(1, 8 * 256 + 1) / 256
    shaft = np.interp(np.interp(angles, whole, times), times, STIFFNESS * (b - a) + DAMPING * (v - u))
    expected = 2 * np.abs(np.mean(shaft * np.exp(2j * angles)))
    assert found.amplitude[-1, found.order == 2.0, 0] == pytest.approx(expected, rel=2e-3)
    axes = motion.plot_order_map()
    low, high = axes.get_xlim()
    assert "input speed" in axes.get_xlabel() and low < 45 and 99 < high < 101
    assert "20 rad/s" not in motion.plot().get_title(loc="left") + motion.plot().get_title()


def test_a_light_input_may_swing_back_within_a_turn() -> None:
    """As a captured line's does: its orders are of the rotation of the whole line, which goes on."""
    light = tn.Disk(inertia=0.02, drive_share=1.0, excitation=[{"order": 2, "amplitude": 60.0}])
    line = tn.Driveline([light, tn.Shaft(stiffness=400.0, damping=0.02), tn.Disk(inertia=5.0, load_torque=1.0)])
    run = tn.simulate(line, 5.0, speed=50.0)
    assert run.input.turned_back is not None and run.whole.turned_back is None
    found = tn.order_map(run, window=4)
    np.testing.assert_allclose(found.speed, 50.0, rtol=0.2)
    assert found.order[1:][found.amplitude[-1, 1:, 0].argmax()] == 2.0
    assert run.turns == pytest.approx(run.whole.angle(5.0)[0] / (2 * np.pi), abs=0.5)


def test_a_line_that_keeps_its_speed_is_drawn_over_time() -> None:
    run = tn.simulate(runaway(), 2.0, speed=99.99)
    assert tn.order_map(run).speed == pytest.approx(99.9, abs=0.2)
    assert run.plot_order_map().get_xlabel() == "time [s]"


@pytest.mark.parametrize("speed", [20.0, 99.99, 300.0])
def test_turns_asked_for_are_made(speed: float) -> None:
    """Whether it speeds up, keeps its speed or slows down; with dense output and without."""
    run = tn.simulate(runaway(), turns=30, speed=speed)
    times = np.linspace(0.0, run.end, 3001)
    a = truth(lambda t: 90.0, times, speed)[0]
    assert run.outcome.ok and run.turns == pytest.approx(30, abs=1e-9)
    assert a[-1] == pytest.approx(60 * np.pi, abs=1e-4)
    assert len(run.pieces) < 6 and run.time[-1] == run.end
    short = tn.simulate(runaway(), turns=30, speed=speed, dense=False)
    assert short.end == pytest.approx(run.end, abs=1e-9) and short.turns == pytest.approx(30, abs=1e-9)


def test_turns_that_are_never_made_say_so() -> None:
    """Its drive is weaker than the load, which turns it back."""
    line = runaway(load_torque=30.0, viscous_load=0.0, excitation=[])
    run = tn.simulate(line, turns=30, speed=20.0)
    assert not run.outcome.ok and run.outcome.kind == "too slow"
    assert "of the 30 turns asked for" in str(run.outcome) and "it turns back at t = 1.38" in str(run)
    assert run.input.turned_back == pytest.approx(20 / (30 / (ENGINE + LOAD)), rel=0.1)


def test_a_line_along_a_profile_turns_by_itself_too() -> None:
    """Its drive gives what the loads need at the speed asked for; excited through its resonance it turns otherwise."""
    profile = tn.SpeedProfile([0.0, 2.0, 6.0], [30.0, 30.0, 60.0])
    line = runaway(load_torque=0.0, drive_share=1.0)

    def drive(t: float) -> float:
        w, rise = float(profile.at(t)), 7.5 if t > 2.0 else 0.0
        return 0.6 * w + 0.003 * w * w + (ENGINE + LOAD) * rise

    times = np.linspace(0.0, 6.0, 121)
    run = tn.simulate(line, 6.0, speed=profile)
    a, _, u, _ = truth(drive, times, 30.0)
    np.testing.assert_allclose(run.input.angle(times), a, atol=1e-4)
    np.testing.assert_allclose(run.input.speed(times), u, atol=1e-3)
    assert np.abs(u - profile.at(times)).max() > 0.5


def gears(error: float, share: float, backlash: float = 0.0) -> tn.Driveline:
    more = {"backlash": backlash} if backlash else {}
    mesh = tn.GearPair(
        teeth_in=11, teeth_out=22, module=0.004, mesh_stiffness=4e7, mesh_damping=900.0, **more,
        transmission_error=[{"amplitude": error, "phase": 0.4}], stiffness_variation=[{"order": 2, "share": share}],
    )  # fmt: skip
    return tn.Driveline(
        [
            tn.Disk(inertia=0.05, load_torque=-20.0),
            mesh,
            tn.Disk(inertia=0.2),
            tn.Shaft(stiffness=3e3, damping=2.0),
            tn.Disk(inertia=0.3, viscous_load=1.6),
        ]
    )


def test_meshes_run_with_the_rotation_that_the_line_makes() -> None:
    """Transmission error and varying stiffness at the teeth that pass, of a line begun at half of its speed."""
    r1, r2, inertia = 0.011 * 2 * np.cos(np.pi / 9), 0.022 * 2 * np.cos(np.pi / 9), np.array([0.05, 0.2, 0.3])
    ratio = np.array([1.0, -0.5, -0.5])
    share = inertia * ratio / (inertia @ ratio**2)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        x, v = y[:3], y[3:]
        theta, omega = share @ x, share @ v
        e, slope = 3e-6 * np.cos(11 * theta + 0.4), -33e-6 * np.sin(11 * theta + 0.4)
        # Both turn outwards from the mesh: r1 x1 + r2 x2 − e is what presses the teeth together.
        pressed = r1 * x[0] + r2 * x[1] - e
        force = 4e7 * (1 + 0.2 * np.cos(22 * theta)) * pressed + 900.0 * (r1 * v[0] + r2 * v[1] - slope * omega)
        shaft = 3e3 * (x[2] - x[1]) + 2.0 * (v[2] - v[1])
        return np.concatenate([v, np.array([20.0 - r1 * force, -r2 * force + shaft, -shaft - 1.6 * v[2]]) / inertia])

    line = gears(3e-6, 0.2)
    times = np.linspace(0.0, 1.0, 2001)
    start = np.concatenate([np.zeros(3), 25.0 * ratio])
    found = solve_ivp(rate, (0, 1.0), start, method="DOP853", rtol=1e-10, atol=1e-12, t_eval=times)
    run = tn.simulate(line, 1.0, speed=25.0)
    # 20 N m at the input drive against 1.6/4 N m s/rad there: towards 50 rad/s.
    assert found.y[3, -1] > 45
    np.testing.assert_allclose(run.input.angle(times), found.y[0], atol=1e-6)
    shaft = 3e3 * (found.y[2] - found.y[1]) + 2.0 * (found.y[5] - found.y[4])
    late = slice(1500, None)
    torque = np.abs(run.torque_at(times)[:, 1])
    np.testing.assert_allclose(torque[late], np.abs(shaft[late]), atol=1e-4 * np.ptp(shaft[late]) + 1e-6)


@pytest.mark.parametrize("backlash", [0.0, 2e-4])
def test_tangents_know_that_meshes_run_with_the_line(backlash: float) -> None:
    system = line_system(gears(3e-6, 0.2, backlash), 25.0, leaves=True).system
    rng = np.random.default_rng(3)
    for _ in range(5):
        t, x = rng.uniform(0, 1), rng.normal(size=6) * np.repeat([3e-3, 1.0], 3)
        regime = system.regime_at(t, x)
        exact = system.jacobian(t, x, regime)
        steps = np.repeat([1e-7, 1e-4], 3)
        for i, step in enumerate(steps):
            up, down = x.copy(), x.copy()
            up[i], down[i] = up[i] + step, down[i] - step
            by = (system.rate_at(t, up, regime) - system.rate_at(t, down, regime)) / (2 * step)
            np.testing.assert_allclose(exact[:, i], by, atol=1e-5 * np.abs(exact).max())


def test_the_command_tells_the_turns_and_speeds_of_the_line(run, here) -> None:
    tn.dump(runaway(), "free.toml")
    answer = run("simulate", "free.toml", "--duration", 20, "--speed", "20 rad/s", "--unit", "rpm")
    assert answer.exit_code == 0, answer.stderr
    assert "(293.271 turns)" in answer.stdout and "954.8 rpm in its last" in answer.stdout
    data = json.loads(run("simulate", "free.toml", "--turns", 30, "--speed", "20 rad/s", "--json").stdout)
    assert data["turns"] == pytest.approx(30) and data["first_speed"] == pytest.approx(24.6, abs=0.1)
    assert 80 < data["last_speed"] < 99 and data["end"] < 4


def test_less_than_a_turn_is_said_with_how_fast() -> None:
    motion = tn.simulate(runaway(), turns=0.5, speed=100.0)
    turned = float(motion.whole.angle(motion.time[-1])[0])
    assert 0.4 * 2 * np.pi < turned < 2 * np.pi
    said = f"it made {turned / (2 * np.pi):.3g} of a turn, at {turned / motion.time[-1]:.4g} rad/s on average"
    assert said in str(motion)

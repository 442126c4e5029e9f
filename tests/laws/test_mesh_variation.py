"""Mesh stiffness that varies with the teeth is a periodic stiffness: linear verdicts, charts, limits and names."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.comparisons import floquet, set_distance
from oracles.package_kernels import chain_kernel
from oracles.random_lines import random_geared_line
from oracles.sampling import quick_every
from scipy.integrate import solve_ivp
from scipy.special import mathieu_a, mathieu_b

import trunnion as tn
from trunnion.results.verdict import Verdict

RADIUS_IN, RADIUS_OUT = (teeth * 0.003 * np.cos(np.deg2rad(20.0)) / 2 for teeth in (25, 40))


def geared(share: float, *joint: tn.HookeJoint, load: float = 100.0, **harmonic: Any) -> tn.Driveline:
    """Shaft, disk, mesh of 25 and 40 teeth, disk, shaft, disk."""
    return tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=1e5, damping=1), tn.Disk(inertia=0.01), *joint,
         tn.GearPair(teeth_in=25, teeth_out=40, module=0.003, mesh_stiffness=1e8, mesh_damping=500,
                     stiffness_variation=[{"share": share, **harmonic}]),
         tn.Disk(inertia=0.02, load_torque=load), tn.Shaft(stiffness=2e4, damping=1), tn.Disk(inertia=0.05)]
    )  # fmt: skip


def by_hand(share: float, speed: float, phase: float) -> np.ndarray:
    """Multipliers of ``geared`` from its Lagrangian along the line of action, in the mesh phase, by scipy."""
    inertia = np.array([0.01, 0.02, 0.05])
    along, twist = np.array([RADIUS_IN, -RADIUS_OUT, 0.0]), np.array([0.0, -1.0, 1.0])
    damping = np.diag([1.0, 0, 0]) + 500 * np.outer(along, along) + np.outer(twist, twist)
    steady = np.diag([1e5, 0, 0]) + 2e4 * np.outer(twist, twist)

    def matrices(time: float) -> tuple[np.ndarray, np.ndarray]:
        mesh = 1e8 * (1 + share * np.cos(25 * speed * time + phase))
        return damping / inertia[:, None], (steady + mesh * np.outer(along, along)) / inertia[:, None]

    return floquet(matrices, 3, 2 * np.pi / 25 / speed)


@pytest.mark.parametrize(("share", "growth"), [(0.1, 9.2), (0.2, 127.5), (0.4, 363.0)])
def test_a_varying_mesh_makes_a_line_unstable(share: float, growth: float) -> None:
    """Growth rates as an independent review found them; multipliers as from the Lagrangian."""
    found = tn.stability(geared(share, phase=0.7), 466.3)
    assert found.growth_rate == pytest.approx(growth, rel=5e-3)
    assert found.verdict is Verdict.UNSTABLE and found.period == pytest.approx(2 * np.pi / 25)
    assert set_distance(found.multipliers, by_hand(share, 466.3, 0.7)) < 1e-8


def test_linear_and_nonlinear_equations_agree_on_a_straight_line() -> None:
    """They are the same equations while the mesh stays on its stage: multipliers and torques, load included."""
    line = geared(0.2, load=300.0)
    linear, nonlinear = tn.stability(line, 400.0), tn.periodic_response(line, speed=400.0)
    assert set_distance(linear.multipliers, nonlinear.multipliers) < 1e-8
    assert linear.response is not None
    assert 2 * linear.response.torque_amplitude == pytest.approx(nonlinear.torque_peak_to_peak, rel=1e-3)


@pytest.mark.parametrize(
    ("q", "a", "trace"),
    [
        (1.0, 3.917025, 2),
        (0.4, mathieu_a(1, 0.4), -2),
        (0.2, mathieu_b(1, 0.2), -2),
        (1.0, mathieu_a(2, 1.0), 2),
        (3.0, mathieu_b(3, 3.0), -2),
    ],
)
def test_one_mesh_and_one_disk_are_a_mathieu_oscillator(q: float, a: float, trace: float) -> None:
    """At the boundaries of y″ + (a − 2q cos 2x) y = 0, one published and the others scipy's, multipliers sum to ±2.

    With z teeth a turn, x = zτ/2 and stiffness k(1 − σ cos zτ): a = (2ω/zΩ)², q = aσ/2.
    """
    teeth, inertia = 12, 0.3
    line = tn.Driveline(
        [tn.ConstantSpeed(),
         tn.GearPair(teeth_in=teeth, teeth_out=18, module=0.003, mesh_stiffness=1e7,
                     stiffness_variation=[{"share": 2 * q / a, "phase": np.pi}]),
         tn.Disk(inertia=inertia)]
    )  # fmt: skip
    (frequency,) = tn.natural_frequencies(line).undamped_frequency
    found = tn.stability(line, 2 * frequency / (teeth * np.sqrt(a)))
    assert found.multipliers.sum() == pytest.approx(trace, abs=2e-5)


@pytest.mark.parametrize("seed", quick_every(2, [9, 5, 24, 17]))  # the slow two have periods of many turns
def test_chart_kernel_integrates_the_same_meshes(seed: int) -> None:
    """Joints in front of meshes, loads on them, two harmonics: the charts' kernel against the dense integrator."""
    line = random_geared_line(seed, steepest=0.4)
    speed = 60.0
    matrix, error, trace = chain_kernel(line, speed, 1e-11)
    found, dense = np.linalg.eigvals(matrix[0]), tn.stability(line, speed, tolerance=1e-12)
    assert np.linalg.slogdet(matrix[0])[1] == pytest.approx(-trace[0], abs=1e-8)
    assert set_distance(found, dense.multipliers) < 1e-7 * max(1.0, dense.spectral_radius)


def test_charts_and_limits_count_meshes() -> None:
    line = geared(0.2)
    share = "GearPair 1.stiffness_variation 1 share"
    chart = tn.stability_chart(line, ("speed", 440.0, 490.0, 40), (share, 0.0, 0.4, 30))
    assert chart.spot_check is not None and chart.spot_check.worst_ratio < 1
    rng = np.random.default_rng(7)
    for row, column in zip(rng.integers(0, 30, 12), rng.integers(0, 40, 12), strict=True):
        own = tn.stability(geared(float(chart.y[row])), float(chart.x[column]))
        off = abs(own.spectral_radius - chart.spectral_radius[row, column])
        assert off <= chart.error_estimate[row, column] + own.error_estimate
        assert own.verdict == chart.verdict[row, column]
    limit = tn.stable_limit(line, share, [466.3, 470.0], low=0.0, high=0.4).limit[0]
    assert tn.stability(geared(limit - 1e-5), 466.3).verdict is Verdict.STABLE
    assert tn.stability(geared(limit + 1e-5), 466.3).verdict is Verdict.UNSTABLE


def test_mesh_orders_are_named() -> None:
    """Teeth per turn of the input excite: 25 in front of the mesh, 25/2 for a mesh behind a ratio of 2."""
    line = geared(0.2)
    modes = tn.natural_frequencies(line).undamped_frequency
    named = {str(r): r.speed for r in tn.resonance_speeds(line)}
    assert named["subharmonic 2ω₃/25 (mesh of GearPair 1)"] == pytest.approx(2 * modes[2] / 25)
    assert named["sum (ω₁+ω₂)/25 (mesh of GearPair 1)"] == pytest.approx((modes[0] + modes[1]) / 25)
    behind = [line.elements[0], tn.Shaft(stiffness=1e5), tn.Disk(inertia=1.0), tn.Ratio(ratio=2.0), *line.elements[1:]]
    slow = tn.Driveline(behind)
    first = tn.natural_frequencies(slow).undamped_frequency[0]
    named = {str(r): r.speed for r in tn.resonance_speeds(slow)}
    assert named["subharmonic 4ω₁/25 (mesh of GearPair 1)"] == pytest.approx(4 * first / 25)
    both = geared(0.2, tn.HookeJoint(angle=0.2))
    assert {r.mesh for r in tn.resonance_speeds(both)} == {"", "GearPair 1"}
    assert tn.stability(both, 466.3).period == pytest.approx(2 * np.pi)


def test_the_sweep_follows_the_mesh() -> None:
    """Torque over speed by harmonic balance and by integration."""
    line = geared(0.1, tn.HookeJoint(angle=0.1), load=300.0)
    swept = tn.speed_sweep(line, [350.0])
    integrated = tn.stability(line, 350.0).response
    assert integrated is not None
    assert swept.torque_amplitude[0] == pytest.approx(integrated.torque_amplitude, rel=5e-3)


def test_joints_and_meshes_without_a_common_period_are_refused() -> None:
    """Behind 61 teeth on 67 a joint is back in phase with the mesh only after 67 turns."""
    line = geared(0.2, tn.HookeJoint(angle=0.1)).replace("GearPair 1", teeth_in=61, teeth_out=67)
    behind = [tn.HookeJoint(angle=0.1), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1)]
    both = tn.Driveline([*line.elements, *behind])
    for refused in (lambda: tn.stability(both, 100.0), lambda: tn.speed_sweep(both, [100.0])):
        with pytest.raises(tn.InputError, match="joints and meshes are back in phase only after 67 turns") as error:
            refused()
        assert "on each side of the ratio separately" in str(error.value)
    assert tn.stability(line, 100.0).period == pytest.approx(2 * np.pi)


def test_a_free_line_has_a_steady_state_at_every_speed() -> None:
    """Nothing resists at rest that it turns as a whole, which is not a resonance; a soft spring changes nothing."""
    mesh = tn.GearPair(teeth_in=20, teeth_out=20, module=0.003, mesh_stiffness=2e7, mesh_damping=400.0,
                       stiffness_variation=[{"order": 1, "share": 0.2}])  # fmt: skip
    shaken = [{"order": 2, "amplitude": 20.0}]

    def rest(inertia: float) -> list[tn.Element]:
        return [
            tn.Disk(inertia=inertia, drive_share=1.0), tn.Shaft(stiffness=4e3, damping=0.8), tn.Disk(inertia=0.01),
            mesh, tn.Disk(inertia=0.02, load_torque=30.0, excitation=shaken),
        ]  # fmt: skip

    speeds = np.linspace(70.0, 110.0, 5)
    for inertia in np.linspace(0.5, 0.55, 12):
        free = tn.order_response(tn.Driveline(rest(float(inertia))), speeds)
        assert np.isfinite(free.peak_torque).all()
    held = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e-4), *rest(0.55)]
    held[2] = tn.Disk(inertia=0.55, load_torque=-30.0)  # as the drive: a soft spring would twist far
    near = tn.order_response(tn.Driveline(held), speeds)
    assert near.vibratory_torque[:, 1:] == pytest.approx(free.vibratory_torque, rel=1e-6)


def reversed_line(phase: float, second: float) -> tn.Driveline:
    """``geared`` behind a ratio of −2, with two harmonics of the stiffness."""
    line = geared(0.2, phase=phase)
    mesh = line.elements[3].model_copy(
        update={"stiffness_variation": tuple(
            tn.StiffnessVariation(order=k, share=share, phase=at)
            for k, share, at in ((1, 0.2, phase), (2, 0.15, second))
        )}
    )  # fmt: skip
    return tn.Driveline([*line.elements[:3], tn.Ratio(ratio=-2.0), mesh, *line.elements[4:]])


def torque_by_hand(speed: float, phase: float, second: float) -> float:
    """Peak to peak of the mesh torque [N m on the wheel] in the steady state, from the Lagrangian of
    ``reversed_line``: every rotation counts in its own sense of turning, and teeth come into mesh as time goes on."""
    inertia = np.array([0.01, 0.02, 0.05])
    along, twist = np.array([RADIUS_IN / 2, -RADIUS_OUT, 0.0]), np.array([0.0, -1.0, 1.0])
    steady = np.diag([1e5, 0, 0]) + 2e4 * np.outer(twist, twist)
    damping = np.diag([1.0, 0, 0]) + 500 * np.outer(along, along) + np.outer(twist, twist)
    teeth, load = 25 * speed / 2, np.array([0.0, 100.0, 0.0])

    def mesh(t: np.ndarray | float) -> np.ndarray | float:
        return 1e8 * (1 + 0.2 * np.cos(teeth * t + phase) + 0.15 * np.cos(2 * teeth * t + second))

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        x, v = y[:3], y[3:]
        return np.concatenate([v, (-load - damping @ v - steady @ x - mesh(t) * along * (along @ x)) / inertia])

    period = 2 * np.pi / teeth
    unforced = solve_ivp(rate, (0, period), np.zeros(6), method="DOP853", rtol=1e-11, atol=1e-14).y[:, -1]
    columns = [
        solve_ivp(rate, (0, period), row, method="DOP853", rtol=1e-11, atol=1e-14).y[:, -1] - unforced
        for row in 1e-3 * np.eye(6)
    ]
    start = np.linalg.solve(np.eye(6) - 1e3 * np.array(columns).T, unforced)
    times = np.linspace(0, period, 801)
    x = solve_ivp(rate, (0, period), start, method="DOP853", rtol=1e-11, atol=1e-14, t_eval=times).y
    force = mesh(times) * (along @ x[:3]) + 500 * (along @ x[3:])
    return float(np.ptp(force) * RADIUS_OUT)


def test_behind_a_negative_ratio_a_mesh_runs_in_its_own_sense() -> None:
    """Two harmonics add up by their phases, which tell one sense of running from the other."""
    speed, phase, second = 100.0, 0.7, 2.5
    truth, otherwise = torque_by_hand(speed, phase, second), torque_by_hand(speed, -phase, -second)
    assert abs(truth / otherwise - 1) > 0.02
    line = reversed_line(phase, second)
    linear, nonlinear = tn.stability(line, speed).response, tn.periodic_response(line, speed=speed)
    orders = tn.order_response(line, [speed])
    assert linear is not None
    assert 2 * linear.torque_amplitude[1] == pytest.approx(truth, rel=1e-3)
    assert nonlinear.torque_peak_to_peak[1] == pytest.approx(truth, rel=1e-3)
    assert 2 * orders.vibratory_torque[0, 1] == pytest.approx(truth, rel=1e-3)


BEND, TEETH_IN, TEETH_OUT, LOAD, SHARE, PHASE = 0.35, 17, 20, 200.0, 0.3, 1.0


def loaded_behind_a_joint() -> tn.Driveline:
    """A shaft and a disk, Hooke's joint and a varying mesh rigidly behind it, a loaded wheel."""
    return tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=2e4, damping=2.0), tn.Disk(inertia=0.02), tn.HookeJoint(angle=BEND),
         tn.GearPair(teeth_in=TEETH_IN, teeth_out=TEETH_OUT, module=0.003, mesh_stiffness=5e6, mesh_damping=300.0,
                     stiffness_variation=[{"share": SHARE, "phase": PHASE}]),
         tn.Disk(inertia=0.05, load_torque=LOAD)]
    )  # fmt: skip


def radius_behind_a_joint(speed: float, about: str) -> float:
    """Spectral radius over a turn, from the Lagrangian, about the "true" periodic motion; or about the one without
    vibration, the twist of the mesh being constant, with the torque that it then gives, "k(t)", or the mean, "mean"."""
    wheel = TEETH_OUT * 0.003 * np.cos(np.deg2rad(20.0)) / 2
    stiffness, damping, over = 5e6 * wheel**2, 300.0 * wheel**2, TEETH_IN / TEETH_OUT
    cosine, front = np.cos(BEND), -over * LOAD / 2e4

    def joint(a: float) -> tuple[float, float, float]:
        """Output less input of the joint, η and its slope, tan ψ = tan a / cos β."""
        ahead = np.arctan2((1 - cosine) * np.sin(a) * np.cos(a), cosine * np.cos(a) ** 2 + np.sin(a) ** 2)
        below = 1 - (1 - cosine**2) * np.cos(a) ** 2
        return ahead, cosine / below, -cosine * (1 - cosine**2) * np.sin(2 * a) / below**2

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        x, tangents = y[:4], y[4:].reshape(4, 4)
        wave = 1 + SHARE * np.cos(TEETH_IN * speed * t + PHASE)
        a, turning = (speed * t + x[0], speed + x[2]) if about == "true" else (speed * t + front, speed)
        ahead, eta, slope = joint(a)
        torque = stiffness * wave * (x[1] - over * (ahead + x[0])) + damping * (x[3] - over * (eta * turning - speed))
        if about != "true":
            torque = -LOAD * (wave if about == "k(t)" else 1.0)
        away = tangents[1] - over * eta * tangents[0]
        faster = tangents[3] - over * (eta * tangents[2] + slope * turning * tangents[0])
        more = stiffness * wave * away + damping * faster
        first = (-2e4 * tangents[0] - 2 * tangents[2] + over * (slope * torque * tangents[0] + eta * more)) / 0.02
        held = [(-2e4 * x[0] - 2 * x[2] + over * eta * torque) / 0.02, (-torque - LOAD) / 0.05]
        return np.concatenate([x[2:], held, tangents[2], tangents[3], first, -more / 0.05])

    x = np.array([front, -LOAD / stiffness + over * front, 0.0, 0.0])
    for _ in range(6 if about == "true" else 1):
        run = solve_ivp(
            rate, (0, 2 * np.pi / speed), [*x, *np.eye(4).ravel()], method="DOP853", rtol=1e-11, atol=1e-12
        ).y[:, -1]
        matrix = run[4:].reshape(4, 4)
        x = x + np.linalg.solve(np.eye(4) - matrix, run[:4] - x)
    return float(np.abs(np.linalg.eigvals(matrix)).max())


def test_the_torque_of_a_varying_mesh_in_the_motion_without_vibration() -> None:
    """Linear theory stands on a constant twist of the mesh, whose torque is then k(t)θ̄. The true motion vibrates, which
    moves the radius by more than the torque's share of it: it tells neither k(t)θ̄ nor a constant torque right, and is
    what ``periodic_response`` judges."""
    line, speed = loaded_behind_a_joint(), 60.0
    truth, varying, mean = (radius_behind_a_joint(speed, about) for about in ("true", "k(t)", "mean"))
    found, orbit = tn.stability(line, speed), tn.periodic_response(line, speed=speed)
    turns = 2 * np.pi / found.period
    assert found.spectral_radius**turns == pytest.approx(varying, abs=1e-8)
    assert np.abs(orbit.multipliers).max() ** turns == pytest.approx(truth, abs=1e-7)
    assert 1e-7 < abs(varying - mean) < abs(varying - truth) < 1e-4

"""Centrifugal pendulums: their order by own nonlinear equations, detuning on a circle, the ring of small motions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

import trunnion as tn

MASS, RADIUS, LENGTH = 1.2, 0.08, 0.02
ORDER = np.sqrt(RADIUS / LENGTH)
SPEED = 60.0


def pendulum(path: str = "circle", **more: float) -> tn.CentrifugalPendulum:
    return tn.CentrifugalPendulum(name="pendulum", mass=MASS, radius=RADIUS, length=LENGTH, path=path, **more)


def held(path: str) -> tn.Driveline:
    """On a drive that keeps its speed; the shaft that lines need hangs beside it."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(name="drive"),
            pendulum(path),
            tn.Shaft(stiffness=1e3, name="shaft"),
            tn.Disk(inertia=1.0, name="disk"),
        ]
    )


def swinging_order(path: str, swing: float) -> float:
    """Order of free swings by ``swing`` = S/r [rad] to either side, by their zeros."""
    line = held(path)
    start = np.zeros(4)
    start[tn.simulate(line, 1e-9, speed=SPEED).line.names.index("pendulum of pendulum")] = (
        swing * LENGTH / (RADIUS + LENGTH)
    )
    run = tn.simulate(line, 1.0, speed=SPEED, start=start, tolerance=1e-12)
    times = np.linspace(0.0, 1.0, 20_001)
    twist = run.motion_at(times).twist[:, run.shafts.index("pendulum")]
    at = np.flatnonzero(twist[:-1] * twist[1:] < 0)
    zeros = times[at] - twist[at] * (times[at + 1] - times[at]) / (twist[at + 1] - twist[at])
    return float(np.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0]) / SPEED)


def test_its_order_to_four_digits_and_how_it_detunes() -> None:
    """On a circle φ″ + n²Ω² sin φ = 0, a simple pendulum: n π/2K(sin² φ₀/2). An epicycloid keeps n at any swing."""
    assert swinging_order("circle", 0.01) == pytest.approx(ORDER, rel=2e-5)
    for swing in (0.3, 0.8, 1.5):
        own = ORDER * np.pi / 2 / ellipk(np.sin(swing / 2) ** 2)
        assert swinging_order("circle", swing) == pytest.approx(own, rel=1e-5)
    for swing in (0.3, 0.8, 1.05):  # its cusp is at 1.118
        assert swinging_order("epicycloid", swing) == pytest.approx(ORDER, rel=1e-5)


def own_motion(path: str, amplitude: float, drag: float, end: float) -> np.ndarray:
    """θ, S and the far disk by Lagrange's equations, both accelerations solved together (Denman 1992)."""
    c, square = RADIUS + LENGTH, RADIUS / LENGTH

    def rate(t: float, y: np.ndarray) -> list[float]:
        theta, s, far, w, v, u = y
        if path == "circle":
            x, x1 = RADIUS**2 + LENGTH**2 + 2 * RADIUS * LENGTH * np.cos(s / LENGTH), -2 * RADIUS * np.sin(s / LENGTH)
            g, g1 = LENGTH + RADIUS * np.cos(s / LENGTH), -square * np.sin(s / LENGTH)
        else:
            x, x1 = c**2 - square * s**2, -2 * square * s
            g = np.sqrt(c**2 - (square + square**2) * s**2)
            g1 = -(square + square**2) * s / g
        twist = 5e3 * (far - theta)
        mass = [[0.3 + MASS * x, MASS * g], [MASS * g, MASS]]
        push = twist + amplitude * np.cos(2 * theta) - MASS * (x1 * v * w + g1 * v**2)
        a, b = np.linalg.solve(mass, [push, MASS * 0.5 * x1 * w**2 - drag / c**2 * v])
        return [w, v, u, a, b, -twist / 0.5]

    start = [0.0, 0.0, 0.0, SPEED, 0.0, SPEED]
    return solve_ivp(rate, (0.0, end), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]


@pytest.mark.parametrize("path", ["circle", "epicycloid"])
def test_a_motion_against_own_equations(path: str) -> None:
    """Free–free, shaken at twice its rotation: the pendulum swings by half a radian."""
    line = shaken(pendulum(path, damping=0.05), 50.0)
    run = tn.simulate(line, 0.8, speed=SPEED, tolerance=1e-12)
    theta, travel, far = own_motion(path, 50.0, 0.05, 0.8)[:3] - [SPEED * 0.8, 0.0, SPEED * 0.8]
    names, n = run.line.names, 3
    ring, host = run.final[names.index("pendulum of pendulum")], run.final[names.index("host")]
    assert [host, (RADIUS + LENGTH) * (ring - host), run.final[names.index("out")]] == pytest.approx(
        [theta, travel, far], abs=1e-9
    )
    swing = np.abs(run.motion_at(np.linspace(0, 0.8, 4001)).twist[:, 0]).max() * (RADIUS + LENGTH) / LENGTH
    assert swing > 0.4 and run.final.shape == (2 * n,)


def shaken(absorber: tn.Element, amplitude: float) -> tn.Driveline:
    return tn.Driveline(
        [
            tn.Disk(inertia=0.3, name="host", excitation=[{"order": 2, "amplitude": amplitude}]),
            absorber,
            tn.Shaft(stiffness=5e3, name="shaft"),
            tn.Disk(inertia=0.5, name="out"),
        ]
    )


def ring(speed: float) -> tn.TunedDamper:
    """What it is in small motions at one speed."""
    inertia = MASS * (RADIUS + LENGTH) ** 2
    return tn.TunedDamper(name="pendulum", ring_inertia=inertia, stiffness=inertia * 4 * speed**2, damping=0.05)


def driven(absorber: tn.Element, gear: float = 1.0) -> tn.Driveline:
    """Behind a ratio, so that the host turns at another speed than the input."""
    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=4e3, damping=2.0, name="front"),
            tn.Ratio(ratio=gear, name="gears"),
            tn.Disk(inertia=0.2, name="hub", excitation=[{"order": 2.1, "amplitude": 30.0}]),
            absorber,
            tn.Shaft(stiffness=6e3, damping=1.5, name="rear"),
            tn.Disk(inertia=0.4, load_torque=20.0, name="load"),
        ],
        limits=[tn.Limit(of="front", max_torque=1e3), tn.Limit(of="rear", max_torque=1e3)],
    )


def test_in_linear_analyses_it_is_a_ring_on_a_spring_by_the_square_of_the_speed() -> None:
    """At each of several speeds, computed together, as the ring of that speed alone; the host turns half as fast."""
    line, speeds = driven(pendulum(damping=0.05), gear=2.0), np.array([30.0, 47.0, 90.0, 150.0])
    together = tn.order_response(line, speeds)
    for i, speed in enumerate(speeds):
        alone = driven(ring(speed / 2), gear=2.0)
        assert together.torque[i] == pytest.approx(tn.order_response(alone, [speed]).torque[0], rel=1e-9)
        assert tn.stability(line, speed).spectral_radius == pytest.approx(
            tn.stability(alone, speed).spectral_radius, rel=1e-9
        )
        modes = tn.campbell_diagram(line, [speed, speed + 1.0]).frequency[0]
        assert modes == pytest.approx(tn.campbell_diagram(alone, [speed, speed + 1.0]).frequency[0], rel=1e-9)


def test_it_takes_its_order_at_every_speed() -> None:
    """Undamped, the host of a pendulum tuned to the excitation stands still against it, at any speed."""
    line = driven(pendulum()).replace("hub", excitation=[{"order": 2, "amplitude": 30.0}])
    found = tn.order_response(line, [20.0, 55.0, 140.0])
    assert np.abs(found.rotation[:, 0, found.inertias.index("hub")]).max() < 1e-13


def test_assess_finds_what_a_dense_scan_finds() -> None:
    line = driven(pendulum(damping=0.05, largest_travel=0.01))
    scan = tn.order_response(line, np.linspace(20.0, 150.0, 4001))
    found = tn.assess(line, (20.0, 150.0))
    for k, name in enumerate(("front", "rear")):
        peak = scan.peak_torque[:, scan.springs.index(name)].max()
        assert found.check(f"max torque of {name}").value == pytest.approx(peak, rel=1e-4), k
    travel = found.check("largest travel of pendulum")
    own = scan.twist_range.largest[:, scan.springs.index("pendulum")].max() * (RADIUS + LENGTH)
    assert travel.value == pytest.approx(own, rel=1e-4) and travel.unit == "m"


def test_the_periodic_motion_follows_its_path() -> None:
    """Small: as the linear response. Large, on a circle: as a simulation that has settled, and not as the response."""
    for amplitude, linear in ((0.02, True), (300.0, False)):
        line = driven(pendulum(damping=0.5)).replace("hub", excitation=[{"order": 2.1, "amplitude": amplitude}])
        line = line.replace("load", load_torque=0.0)
        orbit = tn.periodic_response(line, 45.0, compare=False)
        response = tn.order_response(line, [45.0])
        run = tn.simulate(line, 40.0, speed=45.0)
        times = np.linspace(40.0 - 20 * 2 * np.pi / 45.0, 40.0, 20_001)
        for name in ("front", "pendulum"):
            settled = np.ptp(run.torque_at(times)[:, run.shafts.index(name)])
            assert orbit.torque_peak_to_peak[orbit.shafts.index(name)] == pytest.approx(settled, rel=1e-4)
            ratio = 2 * response.vibratory_torque[0, response.springs.index(name)] / settled
            assert bool(abs(ratio - 1) < 1e-4) is linear


def test_behind_an_angled_joint_linear_analyses_refuse_it() -> None:
    line = driven(pendulum())
    bent = tn.Driveline([line.elements[0], tn.HookeJoint(angle=0.2), *line.elements[1:]])
    for run in (lambda: tn.order_response(bent, [30.0]), lambda: tn.stability(bent, 30.0)):
        with pytest.raises(tn.InputError, match=r"pendulum.order: turns unevenly with an angled joint"):
            run()
    assert tn.simulate(bent, 0.1, speed=30.0).outcome.ok
    with pytest.raises(tn.InputError, match=r"pendulum.order: is held by the square of the speed"):
        tn.natural_frequencies(line)
    operating = tn.natural_frequencies(line.but(operation=tn.Operation(speed=60.0)))
    assert operating.elastic == pytest.approx(tn.natural_frequencies(driven(ring(60.0))).elastic, rel=1e-12)
    assert any("held as at" in str(finding) for finding in operating.findings)
    with pytest.raises(tn.InputError, match=r"pendulum.path = 'circle': swings along a path"):
        tn.run_up(line, 20.0, 30.0, acceleration=5.0)

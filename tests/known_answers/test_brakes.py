"""Brakes against closed forms: mean torque, judder, balance, power, and how long a flywheel takes to stop."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

import trunnion as tn

FALLING = {"torque": 40.0, "static_torque": 100.0, "stribeck_speed": 6.0}


def friction(speed: float) -> float:
    """As written in the docstring, by hand."""
    return 40.0 + 60.0 * np.exp(-speed / 6.0)


def test_every_spring_carries_what_the_brakes_behind_it_take():
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=1.0), tn.Brake(inertia=0.3, torque=25.0),
            tn.Ratio(ratio=-2.0), tn.Shaft(stiffness=2e4, damping=1.0), tn.Brake(inertia=0.2, **FALLING),
        ]
    )  # fmt: skip
    found = tn.order_response(line, [5.0, 50.0])
    for i, speed in enumerate((5.0, 50.0)):
        behind = friction(speed / 2)
        assert np.abs(found.mean_torque[i]) == pytest.approx([25.0 + behind / 2, behind], rel=1e-12)


@pytest.mark.parametrize("speed", [0.5, 3.0, 8.0, 20.0, 80.0])
def test_friction_that_falls_with_the_speed_feeds_the_swing(speed):
    """λ = −(c + T′)/2J ± …, T′ = −(T_s − T_c)/ω_s e^(−ω/ω_s); it judders where T′ outweighs the damping."""
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=1.0), tn.Brake(inertia=0.3, **FALLING, name="brake")]
    )
    slope = -60.0 / 6.0 * np.exp(-speed / 6.0)
    real = -(1.0 + slope) / (2 * 0.3)
    found = tn.campbell_diagram(line, [speed, speed + 1.0])
    assert found.damping_ratio[0, 0] == pytest.approx(-real / np.sqrt(1e4 / 0.3), rel=1e-9)
    verdict = tn.stability(line, speed).verdict.name
    assert verdict == ("UNSTABLE" if real > 0 else "STABLE")


def test_the_line_turns_where_a_motor_and_a_brake_balance():
    motor = tn.Motor(inertia=0.4, breakdown_torque=120.0, breakdown_slip=0.3, synchronous_speed=100.0)
    line = tn.Driveline([motor, tn.Shaft(stiffness=1e4, damping=1.0), tn.Brake(inertia=0.3, **FALLING)])

    def left(speed: float) -> float:
        slip = 1 - speed / 100.0
        return 2 * 120.0 * slip * 0.3 / (slip**2 + 0.3**2) - friction(speed)

    grid = np.linspace(0.0, 100.0, 2003)
    signs = np.sign([left(at) for at in grid])
    at = np.flatnonzero(signs[1:] != signs[:-1])
    roots = [brentq(left, a, b, xtol=1e-12) for a, b in zip(grid[at], grid[at + 1], strict=True)]
    assert len(roots) > 0
    assert [one.speed for one in tn.mean_speeds(line)] == pytest.approx(roots, rel=1e-9)


def test_the_power_of_friction_is_judged_over_the_range():
    """Of constant torque it is largest at the top; of one that falls fast it can be largest within."""
    brake = tn.Brake(inertia=0.3, torque=1.0, static_torque=400.0, stribeck_speed=20.0, name="brake")
    limits = [tn.Limit(of="shaft", max_torque=1e6)]
    shaft = tn.Shaft(stiffness=1e5, damping=40.0, name="shaft")
    for one, factor in ((brake, 1.0), (tn.Brake(inertia=0.3, torque=30.0, name="brake"), 2.0)):
        geared = [tn.ConstantSpeed(), shaft, tn.Ratio(ratio=1 / factor), one.but(heat_rating=1e3)]
        line = tn.Driveline(geared, limits=limits)
        line = line.but(operation=tn.Operation(speed_range=(3.0, 90.0)))
        speed = factor * np.linspace(3.0, 90.0, 1_000_003)
        torque = 1.0 + 399.0 * np.exp(-speed / 20.0) if one.stribeck_speed else 30.0
        check = tn.assess(line).check("friction power of brake")
        assert check.value == pytest.approx((torque * speed).max(), rel=1e-6)
        assert check.value + check.error >= (torque * speed).max() * (1 - 1e-12)
        assert str(check.status) == ("exceeded" if (torque * speed).max() > 1e3 else "satisfied")
        assert check.rule.name == "brake-heat"


def test_a_flywheel_comes_to_rest_and_is_held():
    """t = J ω/T, and then against any torque below the static one."""
    flywheel = tn.Disk(inertia=2.0, name="flywheel")
    brake = tn.Brake(inertia=0.5, torque=50.0, static_torque=80.0, name="brake")
    line = tn.Driveline([flywheel, brake, tn.Shaft(stiffness=1e4, damping=3.0), tn.Disk(inertia=0.01)])
    stop = (2.0 + 0.5 + 0.01) * 20.0 / 50.0
    pushed = tn.AppliedTorque(on="flywheel", time=[0, 2.0, 2.001, 4.0], torque=[0.0, 0.0, 70.0, 70.0])
    found = tn.transient(line, 4.0, speed=20.0, torque=[pushed])
    speeds, times = np.asarray(found.data["speed"].sel(disk="flywheel")), np.asarray(found.data["time"])
    assert times[np.flatnonzero(np.abs(speeds) < 1e-6)[0]] == pytest.approx(stop, abs=0.03)
    assert np.abs(speeds[times > stop + 0.1]).max() < 1e-6


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_friction_falls_with_the_speed_on_the_way_to_rest(way):
    """J ω̇ = −(T_c + (T_s − T_c) e^(−ω/ω_s)): with u = e^(ω/ω_s) the time to rest is (J ω_s/T_c) ln((u₀ + r)/(1 + r)),
    r = (T_s − T_c)/T_c. It then holds T_s, lets go above, and its heat is the kinetic energy that was there."""
    inertia, over, slides, holds = 2.5, 4.0, 50.0, 80.0
    brake = tn.Brake(inertia=0.5, torque=slides, static_torque=holds, stribeck_speed=over, name="brake")
    line = tn.Driveline(
        [
            tn.Disk(inertia=2.0, name="flywheel"),
            tn.Ratio(ratio=way),
            brake,
            tn.Shaft(stiffness=1e4),
            tn.Disk(inertia=1e-3),
        ]
    )
    whole, rest = inertia + 1e-3, (holds - slides) / slides
    stop = whole * over / slides * np.log((np.exp(20.0 / over) + rest) / (1 + rest))
    pushed = tn.AppliedTorque(on="flywheel", time=[0, 1.5, 2.5, 3.0], torque=[0.0, 0.0, 100.0, 100.0])
    found = tn.transient(line, 3.0, speed=20.0, torque=[pushed])
    times, speeds = np.asarray(found.data["time"]), np.asarray(found.data["speed"].sel(disk="flywheel"))
    held = (times > stop + 0.02) & (times < 1.5 + 0.79)
    assert np.abs(speeds[held]).max() < 1e-6 and held.sum() > 5
    moving = times < stop - 0.01
    u = (np.exp(20.0 / over) + rest) * np.exp(-times[moving] * slides / (whole * over)) - rest
    np.testing.assert_allclose(speeds[moving], over * np.log(u), atol=2e-3)
    assert speeds[-1] > 0.05  # above the static torque it lets go, and friction falls
    stopped = tn.transient(line, stop + 0.2, speed=20.0)
    assert stopped.energy.friction == pytest.approx(whole * 200.0, rel=1e-5)
    assert stopped.energy.applied == 0.0 and stopped.energy.error < 1e-8

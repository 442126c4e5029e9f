"""A disk directly behind a joint turns as the joint passes on what stands in front of it, twist included."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import trunnion as tn

BEND, K, C, FORK, WHEEL, END, FORCE, SPEED = np.radians(4), 4e3, 6.0, 0.2, 0.3, 0.1, 6.0, 60.0


def passed_on(p, first):
    """ψ − ψ(first) and its two derivatives at p + first, tan ψ = tan χ/cos β."""
    x, below = p + first, 1 - np.sin(BEND) ** 2 * np.cos(p + first) ** 2
    lead = (1 / np.cos(BEND) - 1) * np.sin(x) * np.cos(x)
    angle = x + np.arctan2(lead, np.cos(x) ** 2 + np.sin(x) ** 2 / np.cos(BEND))
    return angle, np.cos(BEND) / below, -np.cos(BEND) * np.sin(BEND) ** 2 * np.sin(2 * x) / below**2


def test_behind_a_joint_of_a_driven_line_by_the_nonlinear_equations():
    """Fork and wheel are one unknown p: (J₁ + J₂ψ′²) p″ + J₂ψ′ψ″p′² = what acts, integrated to the steady motion."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=K, damping=C),
            tn.Disk(inertia=FORK, name="fork", excitation=[{"order": 3, "amplitude": FORCE}]),
            tn.HookeJoint(angle=float(BEND)),
            tn.Disk(inertia=WHEEL, name="wheel"),
            tn.Shaft(stiffness=2e4, damping=3.0),
            tn.Disk(inertia=END, name="end"),
        ]
    )
    found = tn.order_response(line, [SPEED])
    assert found.inertias == ("fork", "wheel", "end")

    def rates(t, y):
        p, e, v, w = y
        angle, ratio, slope = passed_on(p, 0.0)
        torque = 2e4 * (e - angle) + 3.0 * (w - ratio * v)
        acting = FORCE * np.cos(3 * SPEED * t) - K * (p - SPEED * t) - C * (v - SPEED) + ratio * torque
        return [v, w, (acting - WHEEL * ratio * slope * v**2) / (FORK + WHEEL * ratio**2), -torque / END]

    turn, points = 2 * np.pi / SPEED, 128
    run = solve_ivp(
        rates, (0, 25 * turn), [0, 0, SPEED, SPEED], rtol=1e-9, atol=1e-11, max_step=turn / 40, dense_output=True
    )
    t = 24 * turn + turn * np.arange(points) / points
    p, e = run.sol(t)[:2]
    swings = {"fork": p - SPEED * t, "wheel": passed_on(p, 0.0)[0] - SPEED * t, "end": e - SPEED * t}
    largest = np.abs(found.rotation).max()
    for name, swing in swings.items():
        truth = 2 * np.fft.rfft(swing) / points
        for k, order in enumerate(found.order):
            mine = found.rotation[0, k, found.inertias.index(name)]
            assert abs(mine) == pytest.approx(abs(truth[round(order)]), abs=2e-4 * largest), (name, order)
    # Unlike the fork: the joint alone makes order 2 of the wheel.
    two = np.abs(found.rotation[0, list(found.order).index(2.0)])
    assert two[found.inertias.index("wheel")] < 0.3 * two[found.inertias.index("fork")]


def test_a_held_joint_moves_the_disk_behind_it_by_its_own_law():
    """Speed fluctuation Ω tan β sin β from peak to peak, half of it either way."""
    parts = [
        tn.ConstantSpeed(), tn.Disk(inertia=1.0, name="flywheel"), tn.HookeJoint(angle=float(BEND)),
        tn.Disk(inertia=0.2, name="fork"), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.3, name="end"),
    ]  # fmt: skip
    line = tn.Driveline(parts, limits=[tn.Limit(of="Disk *", max_speed_fluctuation=5.0)])
    found = tn.order_response(line, [SPEED])
    assert found.inertias == ("fork", "end")
    by_hand = SPEED * np.tan(BEND) * np.sin(BEND) / 2
    assert found.speed_fluctuation[0, 0] == pytest.approx(by_hand, rel=1e-6)
    judged = tn.assess(line, (SPEED, SPEED))
    assert judged.check("max speed fluctuation of fork").value == pytest.approx(by_hand, rel=1e-6)
    assert "a ConstantSpeed holds its rotation" in judged.check("max speed fluctuation of flywheel").because


@pytest.mark.parametrize("start", ["driven", "free"])
def test_as_with_a_stiff_shaft_between(start):
    """A shaft too stiff to twist between joint and disk makes the disk an unknown of its own: the same motion."""
    shaken = [{"order": 1.5, "amplitude": 12.0}]
    first = [tn.ConstantSpeed(), tn.Shaft(stiffness=9e3, damping=6)] if start == "driven" else []

    def line(*between):
        return tn.Driveline(
            [
                *first,
                tn.Disk(inertia=0.3, name="engine", drive_share=float(start == "free"), excitation=shaken),
                tn.Shaft(stiffness=6e3, damping=6, name="clutch"),
                *([tn.Disk(inertia=1e-4, name="yoke")] if between else []),
                tn.HookeJoint(angle=0.15),
                *between,
                tn.Disk(inertia=0.2, name="roll", load_torque=30.0, viscous_load=0.3),
            ]
        )

    speeds = [70.0, 95.0]
    one = tn.order_response(line(), speeds)
    two = tn.order_response(line(tn.Shaft(stiffness=1e8, damping=10.0)), speeds)
    assert one.inertias == ("engine", "roll") and two.inertias == ("engine", "yoke", "roll")
    for name in ("speed_fluctuation", "acceleration", "rotation_amplitude"):
        mine, other = getattr(one, name)[:, 1], getattr(two, name)[:, 2]
        assert mine == pytest.approx(other, rel=2e-3), name


def test_behind_a_ratio_a_disk_turns_by_its_own_speed():
    """The ratio's own disk, not what stands in front of it, is what its name shows."""
    engine = tn.Disk(inertia=0.2, name="engine", excitation=[{"order": 2, "amplitude": 100.0}])
    line = tn.Driveline(
        [engine, tn.Shaft(stiffness=1e4, damping=2.0), tn.Ratio(ratio=4), tn.Disk(inertia=8.0, name="drum")]
    )
    plain = tn.Driveline([engine, tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.5, name="drum")])
    geared, straight = (tn.order_response(one, [50.0]).speed_fluctuation[0] for one in (line, plain))
    assert geared == pytest.approx(straight * [1, 0.25], rel=1e-12)

"""Checks of joints behind gears, on branches and beside loops: on the right shaft, all around, or not judged."""

from __future__ import annotations

import numpy as np
import pytest

import trunnion as tn
from trunnion.driveline.quantities import DEGREE

ROAD = tn.Operation(application="road", speed=tn.rpm(15))


def uneven(angle: float) -> float:
    """U of one joint of an angle [deg]."""
    return float(np.sin(angle * DEGREE) * np.tan(angle * DEGREE))


def steepest(angle: float, speed: float) -> float:
    """Largest acceleration [rad/s²] behind a joint: ψ'' of tan ψ = tan χ/cos β, over a fine row of χ."""
    c, s2 = np.cos(angle * DEGREE), np.sin(angle * DEGREE) ** 2
    chi = np.linspace(0, np.pi, 200_001)
    return float(np.max(np.abs(c * s2 * np.sin(2 * chi) / (1 - s2 * np.cos(chi) ** 2) ** 2)) * speed**2)


@pytest.mark.parametrize("step_up", [20, 120, 180, 360])
@pytest.mark.parametrize("offset", [0, 23])
def test_a_joint_behind_a_step_up_is_seen_all_around(step_up, offset):
    """A high-speed shaft of a wind turbine: its joint turns so many times in one turn of the rotor."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=1e6, damping=10.0), tn.Disk(inertia=10.0),
            tn.Ratio(teeth_in=step_up, teeth_out=1), tn.Shaft(stiffness=1e6, fork_offset=f"{offset} deg"),
            tn.Disk(inertia=1.0), tn.HookeJoint(angle="12 deg"), tn.Shaft(stiffness=1e6, damping=10.0),
            tn.Disk(inertia=0.5, load_torque=1000.0),
        ],
        operation=ROAD,
    )  # fmt: skip
    turn = tn.kinetostatics(line, tn.rpm(15))
    assert turn.irregularity == pytest.approx(uneven(12), rel=1e-6)
    assert turn.peak_acceleration == pytest.approx(steepest(12, step_up * tn.rpm(15)), rel=1e-6)
    assert np.ptp(turn.drive_torque) / step_up == pytest.approx(1000 * uneven(12), rel=1e-4)


def branched(first: list[tn.Element], second: list[tn.Element]) -> tn.Driveline:
    start = [tn.ConstantSpeed(), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.2, name="hub")]
    return tn.Driveline([*start, *first, *second], operation=tn.Operation(application="road", speed=tn.rpm(1000)))


SLOW = [
    tn.Shaft(after="hub", stiffness=2e4, damping=1.0), tn.Disk(inertia=0.1), tn.HookeJoint(angle="8 deg", name="ja"),
    tn.Shaft(stiffness=2e4, damping=1.0, name="sa"), tn.Disk(inertia=0.3, name="A"),
]  # fmt: skip
FAST = [
    tn.Ratio(after="hub", teeth_in=3, teeth_out=1), tn.Disk(inertia=0.1), tn.HookeJoint(angle="3 deg", name="jb"),
    tn.Shaft(stiffness=2e4, damping=1.0, name="sb"), tn.Disk(inertia=0.3, name="B"),
]  # fmt: skip


@pytest.mark.parametrize("order", [(SLOW, FAST), (FAST, SLOW)])
def test_each_branch_by_its_own_joint(order):
    found = tn.assess(branched(*order))
    for end, angle, ratio in (("A", 8, 1), ("B", 3, 3)):
        check = found.check(f"acceleration behind the joints on the way to {end}")
        assert check.value == pytest.approx(steepest(angle, ratio * tn.rpm(1000)), rel=1e-5)
    assert not any("between the joints" in check.name for check in found.checks), "there is one on each"
    assert "different branches" in found.check("equal joint angles").because


def test_behind_a_reduction_the_last_shaft_counts():
    """0.2°, 10 : 1, 11°: the first joint shakes the last shaft by a tenth, the second at a tenth of the speed."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.2),
            tn.HookeJoint(angle="0.2 deg"), tn.Shaft(stiffness=5e4, damping=1.0, name="middle"), tn.Disk(inertia=0.2),
            tn.Ratio(teeth_in=1, teeth_out=10), tn.Disk(inertia=0.2), tn.HookeJoint(angle="11 deg"),
            tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.3),
        ],
        operation=tn.Operation(application="road", speed=tn.rpm(1000)),
    )  # fmt: skip
    found = tn.assess(line)
    last = steepest(11, tn.rpm(100))
    beside = steepest(0.2, tn.rpm(1000)) / 10
    value = found.check("acceleration behind the joints").value
    assert value == pytest.approx(last, abs=beside + 4 * uneven(0.2) * last)
    assert found.check("acceleration between the joints, middle").value == pytest.approx(10 * beside, rel=1e-4)
    assert "different speeds" in found.check("equal joint angles").because


LOOP = [
    tn.ConstantSpeed(), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.2, name="hub"),
    tn.HookeJoint(angle="8 deg"), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.1, name="A"),
    tn.HookeJoint(angle="5 deg", after="hub"), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.1, name="B"),
    tn.Shaft(stiffness=1e4, damping=1.0, name="tie", to="A"),
]  # fmt: skip
AT_3000 = tn.Operation(application="road", speed=tn.rpm(3000))


def test_around_a_loop_each_way_is_judged_up_to_the_tie():
    """What closes the loop winds up by how much both ways differ; each is as uneven as its own joint."""
    found = tn.assess(tn.Driveline(LOOP, operation=AT_3000))
    for end, angle in (("A", 8), ("B", 5)):
        even = found.check(f"uniformity of {end}")
        assert even.value == pytest.approx(uneven(angle), rel=1e-6) and even.exceeded
        assert "up to tie" in even.because
        shakes = found.check(f"acceleration behind the joints on the way to {end}")
        assert shakes.value == pytest.approx(steepest(angle, tn.rpm(3000)), rel=1e-6) and shakes.exceeded
    assert str(found.verdict) == "exceeded"


def test_the_tie_of_a_loop_winds_up_by_the_difference_of_both_ways():
    """Slowly, with shafts far stiffer than the tie, its torque is its stiffness times how far the ways differ."""
    stiff = [one.but(stiffness=1e9) if isinstance(one, tn.Shaft) and one.name != "tie" else one for one in LOOP]
    line = tn.Driveline(stiff)
    chi = np.linspace(0, np.pi, 20_001)
    apart = [np.arctan2(np.sin(chi), np.cos(chi) * np.cos(angle * DEGREE)) for angle in (8, 5)]
    swing = 1e4 * np.ptp(apart[0] - apart[1]) / 2
    index = tn.order_response(line, [1.0]).springs.index("tie")
    assert tn.order_response(line, [1.0]).vibratory_torque[0, index] == pytest.approx(swing, rel=2e-3)


def test_in_front_of_a_differential_joints_are_judged_and_behind_it_not():
    leg = [tn.Shaft(stiffness=2e4, damping=1.0), tn.Disk(inertia=1.0, load_torque=50.0)]
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.2),
            tn.HookeJoint(angle="6 deg"), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.1, name="pinion"),
            tn.Differential(ratio=4.0, inertia=0.1, name="axle"),
            tn.Disk(inertia=0.1), tn.HookeJoint(angle="4 deg", name="outer joint"), *leg,
            tn.Disk(inertia=0.1, after="axle.right"), leg[0], leg[1],
        ],
        operation=AT_3000,
    )  # fmt: skip
    found = tn.assess(line)
    even = found.check("uniformity")
    assert even.value == pytest.approx(uneven(6), rel=1e-6) and "up to axle" in even.because
    shakes = found.check("acceleration behind the joints")
    assert shakes.value == pytest.approx(steepest(6, tn.rpm(3000)), rel=1e-6)
    for what in ("uniformity", "acceleration"):
        behind = found.check(f"{what} behind outer joint")
        assert str(behind.status) == "not judged" and "behind axle" in behind.because


def test_turns_that_are_not_all_looked_at_are_counted():
    """Ratio 1.0007: two joints are in phase again after thousands of turns, of which 100 are computed."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.2),
            tn.HookeJoint(angle="3 deg"), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.2),
            tn.Ratio(ratio=1.0007), tn.Disk(inertia=0.2), tn.HookeJoint(angle="3 deg"),
            tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=0.3),
        ],
        operation=AT_3000,
    )  # fmt: skip
    found = tn.assess(line)
    for name in ("uniformity", "acceleration behind the joints"):
        assert "in the first 100 of the 10007 turns after which it repeats" in found.check(name).because


def test_a_spring_is_told_by_its_element_and_not_by_its_name():
    """The spring "slip of tyre" of a tyre, beside a shaft whose name is an end of that."""
    line = tn.Driveline(
        [
            tn.ConstantSpeed(), tn.Shaft(stiffness=5e4, damping=1.0, name="of tyre"), tn.Disk(inertia=0.2),
            tn.HookeJoint(angle="3 deg"), tn.Shaft(stiffness=5e4, damping=1.0), tn.Disk(inertia=1.0),
            tn.Tyre(stiffness=3e4, damping=300.0, slip_stiffness=1.2e5, radius=0.35, travel_speed=13.0, inertia=1.0,
                    name="tyre"),
            tn.Vehicle(mass=800.0, wheel_radius=0.35),
        ],
    )  # fmt: skip
    turn = tn.kinetostatics(line, 100.0)
    owner = dict(zip(turn.shafts, turn.shaft_elements, strict=True))
    assert owner["slip of tyre"] == "tyre" and owner["of tyre"] == "of tyre"


def test_a_mode_that_jumps_over_an_order_is_not_met():
    """As a spring reaches its second stage the mode jumps from below the order to above it: its ends are nearest."""
    line = tn.Driveline(
        [
            tn.Disk(inertia=0.2, drive_share=1, excitation=[{"order": 2, "amplitude": 30.0}], name="E"),
            tn.PiecewiseShaft(breakpoints=["-1 deg", "1 deg"], stiffnesses=[1e4, 4e4, 1e4], damping=3.0, name="S"),
            tn.Disk(inertia=0.8, quadratic_load=0.022, name="F"),
        ],
        operation=tn.Operation(speed_range=(tn.rpm(600), tn.rpm(2300)), application="industrial"),
    )
    check = tn.assess(line).check("separation of modes")
    assert str(check.status) == "satisfied" and 0.2 < check.value < 0.3

"""Every request that cannot be answered is refused in one line that names the place and the remedy."""

import lines
import numpy as np
import pytest

import trunnion as tn

LINE = lines.row([10, 20, 15], load=50.0)
RESULT = tn.kinetostatics(LINE)
LENGTHS = {"Shaft 2": 0.6, "Shaft 3": 0.8}


def supports(*bearings, lengths=LENGTHS, line=LINE):
    return lambda: tn.kinetostatics(line, supports=list(bearings), lengths=lengths)


BRANCHED = tn.Driveline(
    [
        tn.ConstantSpeed(),
        tn.Disk(inertia=1, name="hub"),
        tn.HookeJoint(angle=0.1),
        tn.Shaft(stiffness=1),
        tn.HookeJoint(angle=0.1, after="hub"),
        tn.Shaft(stiffness=1),
    ]
)
GEARED = tn.Driveline(
    [
        tn.ConstantSpeed(), tn.Shaft(stiffness=1), tn.HookeJoint(angle=0.1), tn.Ratio(ratio=2.0),
        tn.Shaft(stiffness=1), tn.HookeJoint(angle=0.1), tn.Shaft(stiffness=1),
    ]
)  # fmt: skip

REFUSED = {
    # layout
    "coincident centres": (
        lambda: tn.layout([(0, 0, 0), (1, 0, 0), (1, 0, 0)], (1, 0, 0), (1, 0, 0)),
        "layout.points 2 and 3",
        "own centre",
    ),
    "input axis against the line": (
        lambda: tn.layout([(0, 0, 0), (1, 0, 0)], (-1, 0, 0.1), (1, 0, 0)),
        "layout.joint 1",
        "input_axis must point from drive to load",
    ),
    "output axis against the line": (
        lambda: tn.layout([(0, 0, 0), (1, 0, 0)], (1, 0, 0.1), (-1, 0, 0)),
        "layout.joint 2",
        "output_axis must point",
    ),
    "bend of 90 deg": (
        lambda: tn.layout([(0, 0, 0), (1, 0, 0)], (0, 1, 0), (1, 0, 0)),
        "90 deg",
        "order of the points",
    ),
    "line that turns back": (
        lambda: tn.layout([(0, 0, 0), (1, 0, 0), (0, 0, 0.1)], (1, 0, 0), (-1, 0, 0)),
        "joint 2",
        "order of the points",
    ),
    "no direction": (
        lambda: tn.layout([(0, 0, 0)], (0, 0, 0), (1, 0, 0)),
        "layout.input_axis",
        "has no direction",
    ),
    "direction of two": (
        lambda: tn.layout([(0, 0, 0)], (1, 0), (1, 0, 0)),
        "layout.input_axis",
        "write (1, 0, 0)",
    ),
    "direction of words": (
        lambda: tn.layout([(0, 0, 0)], "x", (1, 0, 0)),
        "layout.input_axis",
        "not a direction",
    ),
    "points of two": (
        lambda: tn.layout([(0, 0)], (1, 0, 0), (1, 0, 0)),
        "layout.points",
        "three coordinates",
    ),
    "not points": (lambda: tn.layout(5, (1, 0, 0), (1, 0, 0)), "layout.points", "write points="),
    "coordinate of words": (
        lambda: tn.layout([(0, 0, "up")], (1, 0, 0), (1, 0, 0)),
        "layout.points",
        "such as",
    ),
    "infinite coordinate": (
        lambda: tn.layout([(0, 0, np.inf)], (1, 0, 0), (1, 0, 0)),
        "layout.points",
        "finite",
    ),
    "too few shafts": (
        lambda: tn.layout([(0, 0, 0)], (1, 0, 0), (1, 0, 0.1)).driveline([]),
        "layout.shafts",
        "give 2",
    ),
    "too few offsets": (
        lambda: tn.layout([(0, 0, 0), (1, 0, 0)], (1, 0, 0), (1, 0, 0.1)).driveline(fork_offsets=[]),
        "layout.fork_offsets",
        "give 1",
    ),
    "vertical angle of 90 deg": (lambda: tn.combined_angle("90 deg", 0), "vertical", "less than 90 deg"),
    # angles of the literature
    "missing nu": (lambda: tn.cardan_line([0.1, 0.2], [], [0.0]), "nu", "give 1"),
    "angles that are one number": (lambda: tn.cardan_line(0.3, 0.1, 0.1), "alpha = 0.3", "write alpha=["),
    "angles that are a text": (lambda: tn.cardan_line([0.1, 0.2], "1 deg", [0.0]), "nu = '1 deg'", "not a list"),
    "angle in newtons": (lambda: tn.cardan_line([0.1, 0.2], ["1 N"], [0.0]), "nu = '1 N'", "12 deg"),
    "no angles": (lambda: tn.cardan_line([], [], []), "alpha", "no joint"),
    "angle of 90 deg": (
        lambda: tn.cardan_line([0.1, 1.6], [0.0], [0.0]),
        "HookeJoint.angle",
        "less than 90 deg",
    ),
    "too many stiffnesses": (
        lambda: tn.cardan_line([0.1, 0.2], [0.0], [0.0], stiffness=[1, 2]),
        "stiffness",
        "give 1",
    ),
    "negative wall": (
        lambda: tn.Shaft(outer_diameter=0.08, inner_diameter=0.09, length=1, shear_modulus=8e10),
        "Shaft.inner_diameter",
        "smaller than outer_diameter",
    ),
    # joints
    "tripod without radius": (lambda: tn.TripodJoint(angle=0.1, length=1), "TripodJoint.radius", "write"),
    "negative radius": (
        lambda: tn.TripodJoint(angle=0.1, radius=-1, length=1),
        "TripodJoint.radius",
        "positive",
    ),
    "spider nowhere": (
        lambda: tn.TripodJoint(angle=0.1, radius=1, length=1, spider="left"),
        "TripodJoint.spider",
        '"input" or "output"',
    ),
    "distance ratio of zero": (
        lambda: tn.DoubleCardanJoint(angle=0.1, distance_ratio=0),
        "distance_ratio",
        "positive",
    ),
    # the question
    "speed of zero": (lambda: tn.kinetostatics(LINE, speed=0), "speed", "must be positive"),
    "several speeds": (
        lambda: tn.kinetostatics(LINE, speed=np.array([1.0, 2.0])),
        "speed = array",
        "must be a number",
    ),
    "speed of words": (lambda: tn.kinetostatics(LINE, speed="fast"), "'fast'", "1500 rpm"),
    "infinite acceleration": (lambda: tn.kinetostatics(LINE, acceleration=np.inf), "acceleration", "finite"),
    "acceleration of words": (
        lambda: tn.kinetostatics(LINE, acceleration="fast"),
        "acceleration",
        "finite number",
    ),
    "no turns": (lambda: tn.kinetostatics(LINE, turns=0), "turns", "write 1 or more"),
    "half a point": (lambda: tn.kinetostatics(LINE, points=90.5), "points", "whole number"),
    "torque as speed": (lambda: tn.kinetostatics(LINE, output_torque="5 rpm"), "output_torque", "N*m"),
    "friction as number": (lambda: tn.kinetostatics(LINE, friction=0.01), "friction", "tn.CrossFriction"),
    "negative friction": (
        lambda: tn.CrossFriction(-0.1, 0.01, 0.04),
        "friction.coefficient",
        "not be negative",
    ),
    "pin wider than arm": (
        lambda: tn.CrossFriction(0.1, 0.05, 0.04),
        "friction.arm",
        "larger than pin_radius",
    ),
    "friction that locks the cross": (
        lambda: tn.CrossFriction(5, 0.03, 0.04),
        "friction.coefficient",
        "locks",
    ),
    "friction that locks the angle": (
        lambda: tn.kinetostatics(lines.row([80]), friction=tn.CrossFriction(0.8, 0.03, 0.04)),
        "HookeJoint 1.angle",
        "locks",
    ),
    "prescribed output": (
        lambda: tn.kinetostatics(tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1), tn.ConstantSpeed()])),
        "ConstantSpeed 2",
        "load_torque",
    ),
    "length of nothing": (lambda: tn.kinetostatics(LINE, lengths={"Shaft 9": 1}), "Shaft 9", "did you mean"),
    "negative length": (
        lambda: tn.kinetostatics(LINE, lengths={"Shaft 2": -1}),
        "Shaft 2.lengths",
        "positive",
    ),
    "length of words": (lambda: tn.kinetostatics(LINE, lengths={"Shaft 2": "long"}), "Shaft 2", "such as"),
    # bearings
    "both bearings at one place": (
        supports(("Shaft 1", -0.1, -0.1)),
        "Shaft 1.supports",
        "cannot carry a couple",
    ),
    "three bearings on a shaft": (
        supports(("Shaft 1", -0.1, -0.2), ("Shaft 1", -0.3)),
        "Shaft 1.supports",
        "indeterminate",
    ),
    "bearing beyond the joint": (supports(("Shaft 1", -0.1, 0.2)), "Shaft 1.supports", "negative"),
    "bearing before the joint": (
        supports(("Shaft 4", -0.1, 0.2)),
        "Shaft 4.supports",
        "lies beyond the joint",
    ),
    "bearing behind its shaft": (
        supports(("Shaft 2", 0.1, 0.7)),
        "Shaft 2.supports",
        "lies beyond the joint",
    ),
    "one bearing at each end": (
        supports(("Shaft 1", -0.2), ("Shaft 4", 0.2)),
        "supports",
        "cannot carry its couple",
    ),
    "nothing behind the first shaft": (supports(("Shaft 1", -0.2, -0.1)), "supports", "give it two bearings"),
    "two hanging shafts in a row": (
        supports(("Shaft 1", -0.2, -0.1), ("Shaft 4", 0.1, 0.2)),
        "supports",
        "is not held",
    ),
    "held twice": (
        supports(("Shaft 1", -0.2, -0.1), ("Shaft 2", 0.3), ("Shaft 3", 0.3), ("Shaft 4", 0.1, 0.2)),
        "supports",
        "leave out a bearing",
    ),
    "length not known": (
        supports(("Shaft 1", -0.2, -0.1), ("Shaft 2", 0.3), ("Shaft 4", 0.1, 0.2), lengths={}),
        "Shaft 2.length",
        'lengths={"Shaft 2": 0.8}',
    ),
    "bearing in a joint's centre": (
        supports(("Shaft 1", -0.2, -0.1), ("Shaft 2", 0.0), ("Shaft 4", 0.1, 0.2)),
        "Shaft 2.supports = 0",
        "distance from that joint",
    ),
    "bearing of nothing": (supports(("Shaft 9", 0.1)), "Shaft 9", "did you mean"),
    "bearing without place": (supports(("Shaft 1",)), "supports", "write supports="),
    "bearing as text": (supports("Shaft 1"), "supports", "write supports="),
    "bearing of words": (supports(("Shaft 1", "left")), "Shaft 1.supports", "write supports="),
    "no bearing": (supports(), "supports", "write supports="),
    "bearings across a ratio": (
        supports(("Shaft 1", -0.2), ("Shaft 2", -0.2), line=GEARED, lengths={}),
        "supports",
        "Ratio",
    ),
    "branches that nothing holds": (
        supports(("Shaft 1", 0.1), line=BRANCHED, lengths={}),
        "drive.supports",
        "give it two bearings",
    ),
    # phasing and limits
    "nothing to phase": (
        lambda: tn.phase_forks(lines.row([10])),
        "driveline",
        "Shaft between two Hooke's joints",
    ),
    "pitch of zero": (lambda: tn.phase_forks(LINE, 0), "pitch", "positive"),
    "pitch that divides no turn": (
        lambda: tn.phase_forks(LINE, "7 deg"),
        "pitch = '7 deg'",
        '"7.0588235 deg" (51 splines) or "6.9230769 deg" (52 splines)',
    ),
    "pitch of more than a turn": (lambda: tn.phase_forks(LINE, 7.0), "pitch = 7", '"360 deg" (1 spline)'),
    "pitch of a shaft without forks": (
        lambda: tn.phase_forks(LINE, {"Shaft 1": 0.1}),
        "Shaft 1",
        "did you mean",
    ),
    "error of zero": (lambda: tn.assembly_sensitivity(LINE, 0), "error", "positive"),
    "error that bends a joint by 90 deg": (
        lambda: tn.assembly_sensitivity(LINE, 2.0),
        "error = 2: carries HookeJoint 2 (20 deg)",
        'write "1 deg"',
    ),
    "nothing to be sensitive": (
        lambda: tn.assembly_sensitivity(tn.Driveline([tn.Disk(inertia=1)])),
        "driveline",
        "Hooke's joint",
    ),
    "negative limit": (lambda: tn.check_limits(RESULT, irregularity=-1), "irregularity", "not be negative"),
    "limit of words": (
        lambda: tn.check_limits(RESULT, output_acceleration="low"),
        "output_acceleration",
        "not a number",
    ),
    "limit without supports": (
        lambda: tn.check_limits(RESULT, support_force=5),
        "support_force",
        "has no supports",
    ),
    "couple of nothing": (lambda: RESULT.couple_parts("joint 9"), "joint 9", "did you mean"),
    "force of nothing": (lambda: RESULT.support_parts("Shaft 1"), "Shaft 1", "there are none"),
    "sketch of no joint": (
        lambda: tn.sketch(tn.Driveline([tn.Shaft(stiffness=1)])),
        "driveline",
        "HookeJoint",
    ),
    "sketch of branches": (lambda: tn.sketch(BRANCHED), "driveline", "branches"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_in_one_line(name):
    call, place, remedy = REFUSED[name]
    with pytest.raises(tn.InputError) as caught:
        call()
    sentence = str(caught.value)
    assert place in sentence
    assert remedy in sentence
    assert "\n" not in sentence


def test_straight_joint_is_accepted():
    """Collinear axes: angle 0, the phase means nothing, and nothing breaks."""
    straight = tn.layout([(0, 0, 0), (1, 0, 0)], (1, 0, 0), (1, 0, 0))
    assert list(straight.straight) == [True, True]
    result = tn.kinetostatics(
        straight.driveline(load_torque=10.0), supports=[("Shaft 1", -0.2, -0.1), ("Shaft 3", 0.1, 0.2)],
        lengths={"Shaft 2": 1.0},
    )  # fmt: skip
    assert result.irregularity == 0
    assert not np.any(result.secondary_couple)
    assert np.allclose(result.supports.force, 0)
    assert tn.phase_forks(straight.driveline()).irregularity == 0
    assert "axes in line" in str(straight)

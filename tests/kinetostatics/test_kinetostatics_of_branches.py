"""Branched lines: every branch alone is a row of rigid bodies in space, and what they ask for adds up in the trunk.

The own model solves the six equations of equilibrium of every shaft and cross, path by path from the drive to one end;
without elasticity and friction its forces are linear in the loads, so that the paths' forces add.
"""

import numpy as np
import pytest
import vector_model
from vector_model import Line

import trunnion as tn

POINTS = 24
TRUNK = {"angles": [0.35], "planes": [0.4], "fork_offsets": [0.7]}
LEFT = {"angles": [0.5, 0.2], "planes": [-1.1, 0.6], "fork_offsets": [1.2, -0.4]}
RIGHT = {"angles": [0.3], "planes": [2.0], "fork_offsets": [-0.9]}
LENGTHS = {"trunk": 0.9, "left 1": 0.3, "left 2": 0.7, "right 1": 0.55}
HELD = {"in": (-0.3, -0.1), "trunk": (0.2, 0.6), "left 3": (0.1, 0.4), "right 2": (0.15, 0.5)}
STIFFNESS = {"in": 4e3, "trunk": 3e3, "left 1": 2e3, "left 2": 1500.0, "left 3": 1e3, "right 1": 2500.0, "right 2": 1e3}


def branched(loads=(80.0, 57.0), inertias=(0.0, 0.0)):
    """A shaft, a joint and a trunk to the hub; two joints to the left, one to the right."""

    def shaft(name, offset=0.0, **more):
        return tn.Shaft(stiffness=STIFFNESS[name], fork_offset=offset, name=name, **more)

    def joint(branch, k):
        return tn.HookeJoint(angle=branch["angles"][k], plane=branch["planes"][k])

    return tn.Driveline(
        [
            tn.ConstantSpeed(),
            shaft("in", TRUNK["fork_offsets"][0]),
            joint(TRUNK, 0),
            shaft("trunk"),
            tn.Disk(inertia=1.0, name="hub"),
            shaft("left 1", LEFT["fork_offsets"][0]),
            joint(LEFT, 0),
            shaft("left 2", LEFT["fork_offsets"][1]),
            joint(LEFT, 1),
            shaft("left 3"),
            tn.Disk(inertia=inertias[0] or 1.0, load_torque=loads[0], name="left"),
            shaft("right 1", RIGHT["fork_offsets"][0], after="hub"),
            joint(RIGHT, 0),
            shaft("right 2"),
            tn.Disk(inertia=inertias[1] or 1.0, load_torque=loads[1], name="right"),
        ]
    )


def path(branch, load, held=None, **more):
    """The way from the drive to one end, alone: trunk and first shaft of the branch are one bar."""
    name = "left" if branch is LEFT else "right"
    lengths = [LENGTHS["trunk"] + LENGTHS[f"{name} 1"]] + [LENGTHS["left 2"]] * (branch is LEFT)
    numbers = {key: TRUNK[key] + branch[key] for key in TRUNK}
    return Line(**numbers, lengths=lengths, load=load, bearings=held or {}, speed=3.0, **more)


def both(held):
    ends = {LEFT["angles"][0]: 3, RIGHT["angles"][0]: 2}
    bars = ({0: "in", 1: "trunk", ends[b["angles"][0]]: last} for b, last in ((LEFT, "left 3"), (RIGHT, "right 2")))
    return [{m: HELD[name] for m, name in bar.items()} if held else {} for bar in bars]


@pytest.mark.parametrize("acceleration", [0.0, 2.0])
def test_motion_torques_and_couples_of_every_body(acceleration):
    result = tn.kinetostatics(branched(), 3.0, acceleration, points=POINTS)
    paths = [path(b, load, acceleration=acceleration) for b, load in ((LEFT, 80.0), (RIGHT, 57.0))]
    shafts = [["in", "trunk", "left 2", "left 3"], ["in", "trunk", "right 2"]]
    forks = [[0, 1, 2, 3, 4, 5], [0, 1, 6, 7]]
    for p, phi in enumerate(result.input_angle):
        couples, torques, drive = np.zeros((8, 2)), dict.fromkeys(result.shafts, 0.0), 0.0
        for line, names, places in zip(paths, shafts, forks, strict=True):
            state = vector_model.motion(line, phi)
            truth = vector_model.forces(line, state)
            rows = [result.shafts.index(name) for name in names]
            assert np.allclose(result.speed[rows, p], state.speed, rtol=0, atol=1e-12)
            assert np.allclose(result.acceleration[rows, p], state.acceleration, rtol=0, atol=1e-11)
            for name, torque in zip(names, vector_model.shaft_torques(line, state, truth), strict=True):
                torques[name] += torque
            drive += truth["drive_torque"]
            for k, place in enumerate(places):
                j, side = divmod(k, 2)
                axis, normal = line.axes[j + side], line.normals[j]
                couple = -truth["pin_moment"][j, side]
                couple = couple - (couple @ axis) * axis
                couples[place] += [couple @ np.cross(normal, axis), couple @ normal]
        assert result.drive_torque[p] == pytest.approx(drive, abs=1e-8)
        assert np.allclose(result.secondary_couple[:, :, p], couples, rtol=0, atol=1e-8)
        for name in ("in", "trunk", "left 2", "left 3", "right 2"):
            assert result.transmitted[result.shafts.index(name), p] == pytest.approx(torques[name], abs=1e-8)
        branch = [result.transmitted[result.shafts.index(name), p] for name in ("left 1", "right 1")]
        assert sum(branch) == pytest.approx(torques["trunk"], abs=1e-8)
    assert result.power_residual < 1e-12


def test_support_forces_add_over_the_branches():
    """The trunk holds two joints, at different distances along it."""
    supports = [(name, *places) for name, places in HELD.items()]
    result = tn.kinetostatics(branched(), 3.0, points=POINTS, supports=supports, lengths=LENGTHS)
    names = [n.rpartition(" at ")[0] for n in result.supports.names]
    frames = {}
    for held, branch in zip(both(True), (LEFT, RIGHT), strict=True):
        line = path(branch, 1.0, held)
        for m, bar in zip(sorted(held), ("in", "trunk", "left 3" if branch is LEFT else "right 2"), strict=True):
            normal = line.normals[max(m - 1, 0)]
            if m == 0:  # u and v of the drive stand as at plane 0
                normal = np.array([0.0, 1.0, 0.0])
            frames[bar] = (np.cross(normal, line.axes[m]), normal)
    for p, phi in enumerate(result.input_angle):
        force = np.zeros((len(names), 3))
        for held, branch, load in zip(both(True), (LEFT, RIGHT), (80.0, 57.0), strict=True):
            line = path(branch, load, held)
            truth = vector_model.forces(line, vector_model.motion(line, phi))
            bars = {0: "in", 1: "trunk", max(held): "left 3" if branch is LEFT else "right 2"}
            places = [(bars[m], k) for m in sorted(held) for k in range(2)]
            at = dict(zip(places, truth["bearing_force"], strict=True))
            seen = {}
            for b, name in enumerate(names):
                k = seen[name] = seen.get(name, -1) + 1
                force[b] -= at.get((name, k), 0.0)
        for b, name in enumerate(names):
            u, v = frames[name]
            assert np.allclose(result.supports.force[b, :, p], [force[b] @ u, force[b] @ v], rtol=0, atol=1e-7)


def test_twists_settle_together():
    """Elastic: each branch's joints see the trunk's twist, which follows the torques of both."""
    from scipy.optimize import root

    result = tn.kinetostatics(branched(), 3.0, points=POINTS, rigid=False)
    names = ["in", "trunk", "left 1", "left 2", "right 1"]
    stiffness = np.array([STIFFNESS[n] for n in names])
    left, right = path(LEFT, 80.0), path(RIGHT, 57.0)

    def passed(x, phi):
        a = vector_model.motion(left, phi, [x[0], x[1] + x[2], x[3], 0.0])
        b = vector_model.motion(right, phi, [x[0], x[1] + x[4], 0.0])
        of_a = vector_model.shaft_torques(left, a, vector_model.forces(left, a))
        of_b = vector_model.shaft_torques(right, b, vector_model.forces(right, b))
        return np.array([of_a[0] + of_b[0], of_a[1] + of_b[1], of_a[1], of_a[2], of_b[1]])

    for p in range(0, POINTS, 5):
        phi = result.input_angle[p]
        x = root(lambda x, phi=phi: x + passed(x, phi) / stiffness, np.zeros(5), tol=1e-14).x
        found = [result.twist[result.shafts.index(n), p] for n in names]
        assert np.allclose(found, x, rtol=0, atol=1e-12)


def test_output_of_each_branch():
    line = branched(loads=(0.0, 0.0))
    result = tn.kinetostatics(line, 3.0, output_torque={"left 3": 80.0, "right": 57.0})
    loaded = tn.kinetostatics(branched(), 3.0)
    assert result.branches == ("left", "right")
    assert (result.branch, result.output_torque, result.on_branch("left").output_torque) == ("right", 57.0, 80.0)
    assert np.allclose(result.torque, loaded.torque, rtol=0, atol=1e-11)
    for name, last in (("left", "left 3"), ("right", "right 2")):
        alone = result.on_branch(name)
        assert np.array_equal(alone.output_speed, result.speed[result.shafts.index(last)])
        asked = tn.kinetostatics(line, 3.0, branch=last)
        assert asked.branch == name
        assert asked.irregularity == alone.irregularity
    assert f"output left speed over input speed {result.on_branch('left').speed_ratio[0]:.5f}" in str(result)
    assert result.data.end_speed.sel(branch="left").values == pytest.approx(result.on_branch("left").output_speed)
    failing = [f.sentence for f in tn.check_limits(result) if f.sentence.startswith("fail")]
    assert [s.split(" 0.")[0] for s in failing] == [
        "fail: irregularity of the output left", "fail: irregularity of the output right"
    ]  # fmt: skip


def test_phasing_of_a_branch():
    """One joint less on the right: its best phasing differs, and only its own shafts are turned."""
    line = branched()
    left, right = (tn.phase_forks(line, branch=name) for name in ("left", "right"))
    assert (set(left.offsets), set(right.offsets)) == ({"trunk", "left 2"}, {"trunk"})
    for name, best in (("left", left), ("right", right)):
        turn = tn.kinetostatics(best.line, branch=name)
        assert turn.irregularity == pytest.approx(best.irregularity, abs=1e-6)
        assert best.irregularity <= best.before
    shaken = tn.assembly_sensitivity(line, branch="right")
    assert not any("HookeJoint 2" in name or "HookeJoint 3" in name for name in shaken.names)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"branch": "hub"}, "branch = 'hub': names no single branch; write left or right, where one ends"),
        ({"branch": "lift"}, r"branch = 'lift': is not an element of this driveline; did you mean"),
        ({"output_torque": {"left": 1.0, "left 2": 2.0}}, "names a branch that has its torque already"),
        ({"supports": [("in", -0.3, -0.1), ("trunk", 0.1, 0.2), ("left 3", 0.1, 0.2), ("right 2", 0.1, 0.2)]},
         "trunk.length: is not known"),
    ],
)  # fmt: skip
def test_refusals(arguments, message):
    with pytest.raises(tn.InputError, match=message):
        tn.kinetostatics(branched(), **arguments)

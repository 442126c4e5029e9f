"""The command kinetostatics: text, JSON, files and refusals."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import trunnion as tn


def test_text_and_files(run, here):
    result = run("kinetostatics", "line.toml", "--load-case", "climb")
    assert result.exit_code == 0, result.stderr
    assert "irregularity 0.044193" in result.stdout
    assert "input 1500 rpm" in result.stdout or "at 1500 rpm" in result.stdout
    assert "fail: irregularity of the output" in result.stdout
    names = {path.name for path in (here / "trunnion-out").iterdir()}
    assert names == {
        "line-kinetostatics.png",
        "line-kinetostatics.csv",
        "line-kinetostatics-polar.png",
        "line-kinetostatics-sketch.png",
    }


@pytest.mark.slow
def test_a_joint_behind_gears_is_drawn(run, here):
    """The example, whose one joint stands behind a mesh."""
    text = (Path(__file__).parents[2] / "examples" / "gear-stage.toml").read_text(encoding="utf-8")
    (here / "gears.toml").write_text(text, encoding="utf-8")
    result = run("kinetostatics", "gears.toml")
    assert result.exit_code == 0, result.stderr
    assert (here / "trunnion-out" / "gears-kinetostatics-sketch.png").exists()


def test_what_cannot_be_drawn_takes_no_answer_away(run, here):
    """Two joints on one shaft have no sketch, but a turn."""
    joint = '[[element]]\ntype = "HookeJoint"\nangle = 0.1\n{}[[element]]\ntype = "Shaft"\nstiffness = 1e4\n'
    disk = '[[element]]\ntype = "Disk"\ninertia = 1\n'
    text = "format = 1\n" + '[[element]]\ntype = "ConstantSpeed"\n' + disk + 'name = "hub"\n'
    text += joint.format("") + disk + joint.format('after = "hub"\n') + disk
    (here / "two-ways.toml").write_text(text, encoding="utf-8")
    result = run("kinetostatics", "two-ways.toml", "--speed", "900 rpm")
    assert result.exit_code == 0, result.stderr
    assert "no sketch: driveline: branches to two joints" in result.stderr
    assert "irregularity of the output" in result.stdout


def test_json_against_the_function(run, here):
    call = ("kinetostatics", "line.toml", "--speed", "900 rpm", "--output-torque", "80 N*m", "--elastic")
    bearings = ("--support", "Shaft 1:-300mm:-100mm", "--support", "Shaft 2:0.1:0.4")
    friction = ("--friction", "0.005:12mm:40mm")
    result = run(*call, *bearings, *friction, "-o", "turn.nc", "-o", "turn.csv", "-o", "turn.svg", "--json")
    assert result.exit_code == 0, result.stderr
    data = json.loads(result.stdout)
    expected = tn.kinetostatics(
        tn.load("line.toml"),
        tn.rpm(900),
        rigid=False,
        output_torque=80.0,
        friction=tn.CrossFriction(0.005, 0.012, 0.04),
        supports=[("Shaft 1", -0.3, -0.1), ("Shaft 2", 0.1, 0.4)],
    )
    assert data["irregularity"] == pytest.approx(expected.irregularity, rel=1e-12)
    assert data["efficiency"] == pytest.approx(expected.efficiency, rel=1e-12)
    assert len(data["supports"]) == 4 and len(data["secondary_couples"]) == 2
    assert data["supports"][0]["largest"] == pytest.approx(
        expected.support_parts(expected.supports.names[0]).largest, rel=1e-12
    )
    assert data["written"] == ["turn.nc", "turn.csv", "turn.svg"]
    assert all((here / name).stat().st_size > 1000 for name in data["written"])
    assert not (here / "trunnion-out").exists()


FORKED = """
format = 1
[[element]]
type = "ConstantSpeed"
[[element]]
type = "Shaft"
stiffness = "1 MN*m/rad"
name = "trunk"
[[element]]
type = "Disk"
inertia = 0.1
name = "hub"
[[element]]
type = "HookeJoint"
angle = "20 deg"
[[element]]
type = "Shaft"
stiffness = "1 MN*m/rad"
name = "left"
[[element]]
type = "Disk"
inertia = 0.1
load_torque = 40
name = "left wheel"
[[element]]
type = "HookeJoint"
angle = "7 deg"
after = "hub"
[[element]]
type = "Shaft"
stiffness = "1 MN*m/rad"
name = "right"
[[element]]
type = "Disk"
inertia = 0.1
name = "right wheel"
"""


@pytest.mark.parametrize(("branch", "degrees"), [("left", 20.0), ("right wheel", 7.0)])
def test_the_output_is_the_end_of_the_branch_asked_for(run, here, branch, degrees):
    (here / "forked.toml").write_text(FORKED, encoding="utf-8")
    call = ("kinetostatics", "forked.toml", "--branch", branch, "--output-torque", "30 N*m", "-o", "turn.nc", "--json")
    result = run(*call)
    assert result.exit_code == 0, result.stderr
    data = json.loads(result.stdout)
    beta = tn.deg(degrees)
    assert data["output"] == f"{branch.split()[0]} wheel"
    assert data["irregularity"] == pytest.approx(float(np.tan(beta) * np.sin(beta)), rel=1e-4)
    expected = tn.kinetostatics(tn.load("forked.toml"), 1.0, branch=branch, output_torque=30.0)
    assert data["drive_torque"]["largest"] == pytest.approx(float(expected.drive_torque.max()), rel=1e-12)


def test_phasing(run, here):
    steering = tn.Driveline(
        [
            tn.ConstantSpeed(),
            tn.Shaft(stiffness=1e4),
            tn.HookeJoint(angle="30 deg"),
            tn.Shaft(stiffness=1e4),
            tn.HookeJoint(angle="30 deg", plane="40 deg"),
            tn.Disk(inertia=1),
        ]
    )
    tn.dump(steering, here / "steering.toml")
    data = json.loads(run("kinetostatics", "steering.toml", "--phase", "--json", "-o", "turn.nc").stdout)
    assert data["phasing"]["fork_offsets"]["Shaft 2"] == pytest.approx(tn.deg(40), abs=1e-9)
    assert data["phasing"]["irregularity"] < 1e-12
    text = run("kinetostatics", "steering.toml", "--pitch", "15 deg", "-o", "turn.nc").stdout
    assert "Shaft 2: fork offset 45.0000 deg" in text


@pytest.mark.parametrize(
    ("options", "place", "remedy"),
    [
        (("--support", "Shaft 1"), "--support", "positions from the joint in front"),
        (("--support", "Shaft 1:left"), "--support", "positions from the joint in front"),
        (("--support", "Shaft 9:0.1"), "Shaft 9", "did you mean"),
        (("--support", "Shaft 1:-0.1:-0.1"), "Shaft 1.supports", "two different positions"),
        (("--friction", "0.005"), "--friction", "0.005:12mm:40mm"),
        (("--length", "0.8"), "--length", "Shaft 2:0.8m"),
        (("--output-torque", "5 rpm"), "--output-torque", "N*m"),
        (("-o", "turn.doc"), "--output", ".png"),
        (("--phase",), "driveline", "Shaft between two Hooke's joints"),
        (("--turns", "0"), "--turns", "--help"),
        (("--branch", "sheel"), "branch", "known: Disk 2"),
    ],
)
def test_refusals(run, options, place, remedy):
    result = run("kinetostatics", "line.toml", *options)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert place in result.stderr and remedy in result.stderr

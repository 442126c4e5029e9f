"""tongues and the commands about limits: text, JSON, pictures and tables; refusals before computing."""

from __future__ import annotations

import json

import pytest


def test_tongues(run, here):
    call = ("tongues", "two-shaft-cardan", "--x", "speed:1.4:1.8", "--y", "HookeJoint 1.angle:0deg:20deg:3")
    done = run(*call, "-o", "t.csv", "-o", "t.png", "-o", "t.nc")
    assert done.exit_code == 0 and "subharmonic ω₂: closes below at input speed 1.618" in done.stdout
    assert (
        (here / "t.csv").read_text(encoding="utf-8").startswith("point,of_tongue,boundary_x [rad/s],boundary_y [rad]")
    )
    shown = json.loads(run(*call, "--json", "-o", "t.nc").stdout)
    assert shown["name"] == ["subharmonic ω₂"] and shown["complete"] == 1
    assert shown["tip_x"][0] == pytest.approx(1.618, abs=1e-3)


def test_windows_and_damping(run, here):
    call = ("stable-windows", "two-shaft-cardan", "-p", "HookeJoint 1.angle:0deg:20deg:5", "--speed", "1.4:1.8")
    done = run(*call, "-o", "w.png", "-o", "w.nc")
    assert done.exit_code == 0 and "is stable with HookeJoint 1.angle from 0° to 6.884" in done.stdout
    call = ("minimum-damping", "two-shaft-cardan", "--speed", "1.4:1.8", "--maximum", "40", "--json", "-o", "d.nc")
    shown = json.loads(run(*call).stdout)
    assert len(shown["from"]) == 1 and shown["from_region"] == ["subharmonic ω₂"] and shown["to"] == [40.0]


def test_tolerance_study(run, here):
    call = ("tolerance-study", "two-shaft-cardan", "-t", "Shaft 1.stiffness=10%", "-t", "Disk 1.inertia=normal 2%")
    done = run(*call, "--speed", "1.2", "--samples", "256", "-o", "t.png")
    assert done.exit_code == 0 and "with probability" in done.stdout and "what matters" in done.stdout
    shown = json.loads(run(*call, "--speed", "1.2", "--samples", "256", "--json", "-o", "t.nc").stdout)
    assert shown["parameter"] == ["Shaft 1.stiffness", "Disk 1.inertia"] and 0 <= shown["probability"] <= 1
    assert "stable at 11.4592 rpm with" in run(*call, "--speed", "1.2rad/s", "--unit", "rpm", "--samples", "256").stdout


def test_envelope(run, here):
    (here / "line.toml").write_text(
        """format = 1
operation = { speed_range = [100.0, 101.0], schedule = [{ name = "axle", travel = [0, 1], angles = { j = [0, 0.2] } }] }
[[element]]
type = "ConstantSpeed"
[[element]]
type = "Shaft"
stiffness = 1e4
damping = 5
[[element]]
type = "Disk"
inertia = 1
[[element]]
type = "HookeJoint"
name = "j"
angle = 0.1
[[element]]
type = "Shaft"
stiffness = 1e4
damping = 5
[[element]]
type = "Disk"
inertia = 1
""",
        encoding="utf-8",
    )
    done = run("envelope", "line.toml", "--points", "2", "-o", "e.png", "-o", "e.nc")
    assert done.exit_code == 0 and "at axle 1000 mm" in done.stdout and (here / "e.png").exists()
    shown = json.loads(run("envelope", "line.toml", "--points", "2", "--json").stdout)
    assert shown["place"] == ["as stated", "at axle 0 mm", "at axle 1000 mm"]


def test_certificate(run, here):
    call = (
        "certify-stability",
        "two-shaft-cardan",
        "-t",
        "Shaft 1.stiffness=1%",
        "--boxes",
        "1",
        "--speed",
        "1.2:1.201",
    )
    assert run(*call).stdout.splitlines()[0].startswith(("undecided within 1 tolerance", "proved stable"))
    shown = json.loads(run(*call, "--json", "-o", "c.nc").stdout)
    assert shown["boxes"] == 1 and shown["variable"] == ["speed", "Shaft 1.stiffness"]
    assert run(*call, "-o", "c.png").exit_code == 0 and (here / "c.png").exists()
    assert "is nothing this command writes" in run(*call, "-o", "c.csv").stderr


REFUSED = [
    (
        ("certify-stability", "two-shaft-cardan", "-t", "Shaft 1.stiffness=1%", "--speed", "2:1"),
        "is not a rising range",
    ),
    (("tolerance-study", "two-shaft-cardan", "-t", "Shaft 1.stiffness"), "is not a tolerance"),
    (("tolerance-study", "two-shaft-cardan", "-t", "Shaft 1.stiffness=much"), "is not a tolerance"),
    (("tolerance-study", "two-shaft-cardan", "-t", "Shaft 9.stiffness=1%", "--speed", "1"), "is not a parameter"),
    (("stable-windows", "two-shaft-cardan", "--speed", "1.8:1.4"), "is not a rising range"),
    (("minimum-damping", "two-shaft-cardan", "--damping", "Shaft 1.stiffness"), "is not the damping of an element"),
    (("minimum-damping", "two-shaft-cardan", "--speed", "1:2", "--margin", "2"), "margin = 2: must lie between"),
    (("minimum-damping", "two-shaft-cardan", "--damping", "Shaft 9.damping"), "is not a parameter"),
    (("tongues", "two-shaft-cardan", "--x", "speed:1:2:log"), "is searched evenly; leave out :log"),
    (("tongues", "two-shaft-cardan", "--x", "speed:2:1"), "is a reversed range"),
    (("tongues", "two-shaft-cardan", "--y", "Shaft 1.stiffness"), "needs a range"),
    (("tongues", "two-shaft-cardan", "--y", "HookeJoint 1.angle:0deg:20deg:2"), "rows = 2: must be a whole number"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[" ".join(call) for call, _ in REFUSED])
def test_one_line_exit_code_2_and_nothing_written(run, here, call, words):
    result = run(*call)
    assert result.exit_code == 2, result.output
    assert result.stdout == "" and words in result.stderr
    assert result.stderr.startswith("error: ") and result.stderr.count("\n") == 1
    assert not (here / "trunnion-out").exists()


@pytest.mark.parametrize(
    ("text", "wanted"),
    [("a.b=15 %", 0.15), ("a.b=15%", 0.15), ("a.b=0.15", 0.15), ("a.b=normal 3 %", ("normal", 0.03))],
)
def test_a_share_with_and_without_a_blank(text, wanted):
    """The first hour writes it as files do."""
    from trunnion.cli.limits import _tolerance

    path, found = _tolerance(None, text, "--tolerance")
    assert path == "a.b" and found == (pytest.approx(wanted) if isinstance(wanted, float) else wanted)

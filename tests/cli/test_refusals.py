"""Whatever is wrong on the command line: one line that names it, exit code 2, and nothing written."""

from __future__ import annotations

import json

import pytest

CHART = ("stability-chart", "line.toml", "--points", "4x3")
JOINT = '[[element]]\ntype = "HookeJoint"\nangle = "12 deg"\n'
BARE_JOINT = (
    'format = 1\n[[element]]\ntype = "ConstantSpeed"\n[[element]]\ntype = "Shaft"\nstiffness = 1e4\n'
    + JOINT
    + '[[element]]\ntype = "Shaft"\nstiffness = 1e4\n[[element]]\ntype = "Disk"\ninertia = 1\n'
)
RATIO = (
    BARE_JOINT.replace(JOINT, '[[element]]\ntype = "Disk"\ninertia = 1\n' + JOINT)
    + '[[element]]\ntype = "Ratio"\nratio = 3.14159\n'
    + '[[element]]\ntype = "Shaft"\nstiffness = 1e4\n[[element]]\ntype = "Disk"\ninertia = 1\n'
    + JOINT
    + '[[element]]\ntype = "Shaft"\nstiffness = 1e4\n[[element]]\ntype = "Disk"\ninertia = 1\n'
)
FREE = 'format = 1\n[[element]]\ntype = "Disk"\ninertia = 1\n' + BARE_JOINT.partition('Speed"\n')[2].replace(
    JOINT, '[[element]]\ntype = "Disk"\ninertia = 1\n' + JOINT
)
STAGED = (
    'format = 1\n[operation]\nspeed = 95\n[[element]]\ntype = "ConstantSpeed"\n[[element]]\ntype = "PiecewiseShaft"\n'
    "breakpoints = [-0.001, 0.001]\nstiffnesses = [1e4, 5e3, 1e4]\ndamping = 5\n"
    '[[element]]\ntype = "Disk"\ninertia = 1\nload_torque = 50\n'
)
FILES = {
    "empty.toml": b"",
    "binary.toml": b"\x89PNG\r\n\x1a\n\x00\x00",
    "bad.toml": b"format = 1\nname = no quotes\n",
    "bare-joint.toml": BARE_JOINT.encode(),
    "ratio.toml": RATIO.encode(),
    "free.toml": FREE.encode(),
    "staged.toml": STAGED.encode(),
}

# (arguments, what the line must say)
CASES = [
    # the file
    (("analyze", "lin.toml"), ("lin.toml: file not found", 'did you mean "line.toml"?')),
    (("stability", "no/such.toml"), ("file not found",)),
    (("analyze", "binary.toml"), ("binary.toml: is not a text file",)),
    (("analyze", "empty.toml"), ("empty.toml: is empty", "trunnion new two-shaft")),
    (("natural-frequencies", "bad.toml"), ("bad.toml: is not valid TOML", "line 2")),
    (("analyze", "folder"), ("folder: is a folder",)),
    (("analyze", "two-shaft-cradan"), ("neither a file nor", 'did you mean "two-shaft-cardan"?')),
    (("catalogue", "two-shaft-cradan"), ("is not in the catalogue", 'did you mean "two-shaft-cardan"?')),
    (("analyze", "bare-joint.toml"), ("HookeJoint 1: has no inertia", "put a Disk in front of HookeJoint 1")),
    (("natural-frequencies", "bare-joint.toml"), ("HookeJoint 1: has no inertia",)),
    (("stability", "ratio.toml", "-s", "100"), ("Ratio 1.ratio = 3.14159", "teeth_in and teeth_out")),
    (("stability", "line.toml", "--load-case", "clim"), ("load_case = 'clim'", '"climb"')),
    # speeds and units
    (("stability", "line.toml", "--speed", "0"), ("--speed = '0': must be positive",)),
    (("stability", "line.toml", "--speed=-100 rpm"), ("--speed = '-100 rpm': must be positive",)),
    (("stability", "line.toml", "--speed", "nan"), ("--speed = 'nan': must be finite",)),
    (("stability", "line.toml", "--speed", "inf rpm"), ("--speed = 'inf rpm': must be finite",)),
    (("stability", "line.toml", "--speed", "fast"), ("--speed = 'fast': does not start with a number",)),
    (("stability", "line.toml", "--speed", "12 kg"), ("--speed = '12 kg': kg is not the unit of a speed",)),
    (("analyze", "line.toml", "--unit", "RPM"), ("unit = 'RPM'", "rpm, Hz")),
    (("stability", "two-shaft-cardan"), ("operation.speed: is not given",)),
    # proofs
    (("certify-stability", "line.toml", "--within", "0 s"), ("--within = '0 s': must be a positive time",)),
    (("certify-stability", "line.toml", "-t", "Shaft 1.damping=150%"), ("Shaft 1.damping=150%", "is not a tolerance")),
    (
        ("certify-stability", "staged.toml", "-t", "Disk 1.load_torque=95%", "--speed", "90:100"),
        (
            "PiecewiseShaft 1 = -2.5: is the torque",
            "works in stage 1 of 3, up to -5 N m",
            "narrow the tolerances of loads",
        ),
    ),
    (
        ("certify-stability", "ratio.toml", "-t", "Ratio 1.ratio=10%", "--speed", "90:100"),
        ("Ratio 1.ratio: sets the period", "makes a line of each of its values"),
    ),
    # axes
    ((*CHART, "--x", "spede:1:2:3"), ("spede: is not a parameter", '"speed"')),
    ((*CHART, "--y", "HookeJoint 9.angle:0:0.2:3"), ("HookeJoint 9.angle: is not a parameter",)),
    ((*CHART, "--x", "speed:2400rpm:300rpm:4"), ("--x = 'speed:2400rpm:300rpm:4': is a reversed range",)),
    ((*CHART, "--x", "speed:300rpm:300rpm:4"), ("is a range of zero size", "low < high")),
    ((*CHART, "--x", "speed:-300rpm:0rpm:4"), ("speed.range", "must reach above zero")),
    ((*CHART, "--x", "speed:nan:300rpm:4"), ("must be finite",)),
    ((*CHART, "--x", "speed:300"), ("--x = 'speed:300': needs a range", "speed:300rpm:2400rpm:400")),
    ((*CHART, "--x", "Shaft 1.stiffness"), ("needs a range",)),
    ((*CHART, "--x", "Shaft 1.stiffness:0:1e4:4"), ("Shaft 1.stiffness 0, which must be positive", "let the axis end")),
    ((*CHART, "--x", "Shaft 1.stiffness:1 N*m:9 N*m:4"), ("N*m is not the unit", "N*m/rad")),
    ((*CHART, "--x", "speed:1:2:0"), ("must be a whole number of points",)),
    ((*CHART, "--x", "speed:1:2:many"), ("= 'many': must be a whole number of points",)),
    ((*CHART, "--y", "HookeJoint 1.angle:0:95deg:3", "--x", "HookeJoint *.angle:90deg:95deg:3"), ("89°",)),
    ((*CHART, "--y", "speed"), ("speed: is moved by both axes",)),
    ((*CHART, "--y", "factor of Shaft *.damping:-1:1:3:log"), ("cannot start at or below zero",)),
    (("analyze", "line.toml", "--points", "many"), ("--points = 'many': is not a size", "200x150")),
    (("analyze", "line.toml", "--points", "1x5"), ("2 or more",)),
    (
        (*CHART[:2], "--points", "99999999x99999999"),
        ("chart.points = '99999999 x 99999999': would need", "fewer points"),
    ),
    (("analyze", "line.toml", "--points", "99999999x99999999"), ("would need", "of memory", "fewer points")),
    ((*CHART, "--x", "speed:100rpm:300rpm:99999999999"), ("would need", "of memory", "fewer points")),
    ((*CHART, "--y", "factor of speed:1:2:3"), ("factor of speed: belongs to the analysis", 'vary "speed" itself')),
    # outputs
    ((*CHART, "-o", "folder"), ("--output = 'folder': is a folder",)),
    ((*CHART, "-o", "no/such/c.png"), ("lies in no folder", "create the folder no/such")),
    ((*CHART, "-o", "line.toml/c.png"), ("lies in no folder",)),
    ((*CHART, "-o", "c.doc"), ("no ending that names a format", ".png, .pdf, .svg, .nc, .csv")),
    (("analyze", "line.toml", "-o", "page.pdf"), ("is not a format of a report", "write page.html, or name a folder")),
    (("analyze", "line.toml", "-o", "no/such/page.html"), ("lies in no folder", "create the folder no/such")),
    (("analyze", "line.toml", "-o", "empty.toml"), ("is a file, not a folder",)),
    (("analyze", "line.toml", "-o", "empty.toml/deep"), ("cannot be made, empty.toml is a file",)),
    (("new", "-o", "x.toml"), ("no starter is named", "trunnion new two-shaft --output x.toml")),
    (("new", "two-shaft", "-o", "line.toml"), ("line.toml", "exists already", "--force")),
    (("catalogue", "-o", "a.toml"), ("--output = 'a.toml': belongs to one driveline",)),
    (
        ("catalogue", "gear-rattle", "-o", "a.toml"),
        ("catalogue = 'gear-rattle': is not a driveline", "leave --output out"),
    ),
    (("catalogue", "two-shaft-cardan", "-o", "a.txt"), ("--output = 'a.txt': does not end in .toml",)),
    (("new", "two-shaft", "-o", "folder"), ("'folder': is a folder",)),
    (("new", "two-shaft", "-o", "no/such/a.toml"), ("its folder does not exist",)),
    (("new", "tow-shaft"), ("new = 'tow-shaft': is not a starter", 'did you mean "two-shaft"?')),
    (("export", "line.toml", "--to", "csv", "-o", "line.toml"), ("is a file that this command reads",)),
    (("export", "line.toml", "--to", "csv", "-o", "line.txt"), ("does not end in .csv",)),
    (("export", "line.toml", "--to", "cvs", "-o", "l.csv"), ("is not a target", 'did you mean "csv"?')),
    (("export", "line.toml", "--to", "csv", "-o", "l.csv"), ("HookeJoint 1.angle", "write angle = 0")),
    (("import", "line.toml"), ("cannot be imported", "ends in .csv, .py or .mo")),
    (("import", "none.mo"), ("file not found",)),
    # the command itself
    (("analyse", "line.toml"), ("No such command 'analyse'",)),
    (("analyze",), ("Missing argument 'FILE'", "--help")),
    (("analyze", "line.toml", "--sped", "3"), ("--sped",)),
    (("resonance-speeds", "line.toml", "--orders", "0"), ("--orders",)),
    (("resonance-speeds", "line.toml", "--orders", "two"), ("--orders", "integer")),
    (("--bogus",), ("--bogus",)),
]


@pytest.mark.parametrize(("args", "says"), CASES, ids=[" ".join(args) for args, _ in CASES])
@pytest.mark.parametrize("as_json", [False, True], ids=["text", "json"])
def test_one_line_exit_code_2_and_nothing_written(run, here, args, says, as_json):
    for name, content in FILES.items():
        (here / name).write_bytes(content)
    (here / "folder").mkdir()
    before = contents(here)
    with_json = as_json and len(args) > 1
    result = run(*args, *(["--json"] if with_json else []))
    assert result.exit_code == 2, result.output
    if with_json:
        said = json.loads(result.stdout)
        (problem,) = said["problems"]
        assert (said["command"], said["exit_code"]) == (args[0], 2) and said["error"] in ("input", "usage")
        assert set(problem) == {"element", "key", "value", "problem", "remedy", "message"}
        assert f"error: {problem['message']}\n" == result.stderr and problem["problem"] in result.stderr
        assert said["error"] == "usage" or problem["key"] or problem["element"] or "too long" in result.stderr
    else:
        assert result.stdout == ""
    assert result.stderr.count("\n") == 1 and result.stderr.startswith("error: ")
    for part in says:
        assert part in result.stderr
    assert "Traceback" not in result.stderr
    assert contents(here) == before


def test_json_has_every_mistake_of_a_file(run, here):
    (here / "bad.toml").write_text('formt = 1\n[[element]]\ntype = "Disk"\ninertia = -1\n[[element]]\ntype = "Shft"\n')
    result = run("stability", "bad.toml", "--json")
    said = json.loads(result.stdout)
    assert result.exit_code == said["exit_code"] == 2
    assert [f"error: {one['message']}" for one in said["problems"]] == result.stderr.splitlines()
    inertia = next(one for one in said["problems"] if one["key"] == "inertia")
    assert (inertia["element"], inertia["value"]) == ("bad.toml: Disk 1 (element 1)", -1)
    assert all(one["remedy"] for one in said["problems"] if one["key"] != "inertia")


def contents(folder):
    return {str(p.relative_to(folder)): p.read_bytes() if p.is_file() else None for p in folder.rglob("*")}


def test_a_failing_disk_is_one_line_too(run, here, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device", "c.nc")

    monkeypatch.setattr("trunnion.results.chart.StabilityChart.save", full)
    result = run(*CHART, "-o", "c.nc")
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1] == "error: c.nc: No space left on device"  # notes may stand before it


def test_a_failed_computation_has_exit_code_1(run, monkeypatch):
    from trunnion.errors import ComputationError

    def fail(*_, **__):
        raise ComputationError("the integration did not settle; raise the lowest speed")

    monkeypatch.setattr("trunnion.stability", fail)
    result = run("stability", "line.toml")
    assert result.exit_code == 1
    assert result.stderr == "error: the integration did not settle; raise the lowest speed\n"

"""frequency-response and sweep in the terminal: units, names, files; every refusal one line with exit code 2."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr

PAIR = """\
format = 1
name = "gear pair"

[[element]]
type = "Disk"
inertia = "0.002 kg*m^2"
load_torque = "-1 N*m"

[[element.excitation]]
amplitude = "6 N*m"
frequency = 3000

[[element]]
type = "GearPair"
name = "mesh"
teeth_in = 18
teeth_out = 27
module = "5 mm"
mesh_stiffness = "2e6 N/m"
mesh_damping = "60 N*s/m"
backlash = "40 um"
stiffness_ratio = 0.1

[[element]]
type = "Disk"
inertia = "0.005 kg*m^2"
load_torque = "1.5 N*m"
"""
CLUTCH = """
[[element]]
type = "PiecewiseShaft"
name = "clutch"
breakpoints = ["-1 deg", "1 deg"]
stiffnesses = ["900 N*m/rad", "200 N*m/rad", "900 N*m/rad"]
damping = "1 N*m*s/rad"

[[element]]
type = "Disk"
inertia = "0.2 kg*m^2"
load_torque = "4 N*m"
"""
UNLOADED = PAIR.replace('load_torque = "-1 N*m"\n', "").replace('load_torque = "1.5 N*m"\n', "")
FREE = UNLOADED.replace("stiffness_ratio = 0.1", "stiffness_ratio = 0").replace('"6 N*m"', '"0.01 N*m"')
GEARED = PAIR.replace("frequency = 3000", "order = 2").replace(
    "\n[[element]]", '\n[operation]\nspeed = "900 rpm"\n\n[[element]]', 1
) + CLUTCH.replace("4 N*m", "0 N*m")
"""Three inertias, a mesh and a clutch, free at both ends."""
FILES = {
    "geared.toml": GEARED,
    "pair.toml": PAIR,
    "negative.toml": PAIR.replace('"40 um"', '"-40 um"'),
    "ratio.toml": PAIR.replace("= 0.1", "= 1.2"),
    "law.toml": PAIR.replace('backlash = "40 um"', 'damping_law = "sometimes"'),
    "both.toml": PAIR.replace('backlash = "40 um"', 'backlash = "40 um"\nangular_backlash = "1 deg"'),
    "radii.toml": PAIR.replace("teeth_in = 18", 'base_radius_in = "40 mm"'),
    "misspelt.toml": PAIR.replace("mesh_stiffness", "mesh_stifness"),
    "stages.toml": PAIR + CLUTCH.replace('["-1 deg", "1 deg"]', '["1 deg", "-1 deg"]'),
    "one.toml": PAIR + CLUTCH.replace('["-1 deg", "1 deg"]', '["1 deg"]'),
    "free.toml": FREE,
    "phased.toml": PAIR.replace("stiffness_ratio", 'transmission_error = [{ size = "1 um" }]\nstiffness_ratio'),
}
REFUSED = [
    (("sweep", "negative.toml"), "negative.toml: mesh (element 2).backlash = '-40 um': must not be negative; write 0"),
    (("frequency-response", "ratio.toml"), "stiffness_ratio = 1.2: must lie between 0 and 1; 0 is free play"),
    (("sweep", "law.toml"), "damping_law = 'sometimes': is unknown; write one of"),
    (("sweep", "both.toml"), "angular_backlash = '1 deg': conflicts with backlash; leave out one"),
    (("sweep", "radii.toml"), "base_radius_in = '40 mm': conflicts with"),
    (("sweep", "misspelt.toml"), 'did you mean "mesh_stiffness"?'),
    (("natural-frequencies", "stages.toml"), "clutch (element 4).breakpoints = ['1 deg', '-1 deg']: must rise"),
    (("natural-frequencies", "one.toml"), "stiffnesses = "),
    (("sweep", "phased.toml"), "transmission_error 1 size"),
    (("sweep", "two-shaft-cardan"), "HookeJoint 1"),
    (("sweep", "duffing"), "has no gap to be swept over; use gear-rattle"),
    (("sweep", "geared.toml", "--curve", "clutchh"), 'is not a shaft or mesh of the line; did you mean "clutch"?'),
    (("frequency-response", "free.toml"), "moves less than its free play of 4e-05: no contact is possible"),
    (("frequency-response", "gear-rattle", "--set", "force=0"), "force = 0: is zero: nothing moves"),
    (("sweep", "gear-rattle", "--set", "force=0"), "force = 0: is zero: nothing moves"),
    (("sweep", "gear-rattle", "--set", "half_gap=-0.1"), "half_gap = -0.1: must not be negative; write 0"),
    (("sweep", "gear-rattle", "--set", "inside=2"), "inside = 2: must lie between 0 and 1"),
    (
        ("sweep", "gear-rattle", "--set", "half_gap=0", "--set", "damping=0", "--from", "0.5", "--to", "1.5"),
        "grow without bound: there is no periodic motion; give some damping or another frequency",
    ),
    (
        ("frequency-response", "gear-rattle", "--method", "describing function", "--set", "damping=0"),
        "leaves the resonant motion unbounded; give some damping",
    ),
    (("frequency-response", "gear-rattle", "--method", "averaging", "--fit-range", "0.1"), "does not reach beyond"),
    (("frequency-response", "gear-rattle", "--from", "fast"), "--from = 'fast': "),
    (("frequency-response", "gear-rattle", "--to", "-1"), "--to = '-1': must be positive"),
    (("frequency-response", "gear-rattle", "--from", "1", "--to", "0.5"), "must be a rising range"),
    (("frequency-response", "gear-rattle", "--curve", "v"), "curve = 'v': is not a curve of this"),
    (("frequency-response", "gear-rattel"), 'did you mean "gear-rattle"?'),
    (("frequency-response", "missing.toml"), "file not found"),
    (("frequency-response", "two-shaft-cardan", "--set", "a=1"), "belongs to reference systems"),
]


@pytest.mark.parametrize(("call", "words"), REFUSED, ids=[" ".join(call) for call, _ in REFUSED])
def test_one_line_exit_code_2_and_nothing_written(run, here, call, words):
    for name, content in FILES.items():
        (here / name).write_text(content, encoding="utf-8")
    result = run(*call)
    assert result.exit_code == 2, result.output
    assert result.stdout == "" and words in result.stderr
    assert result.stderr.startswith("error: ") and result.stderr.count("\n") == 1
    assert not (here / "trunnion-out").exists()


@pytest.mark.slow
def test_a_branch_that_cannot_go_on_is_written_as_far_as_it_came(run, here):
    """Undamped, the gear pair's curve is lost in the tangle of its superharmonic resonances."""
    call = ("frequency-response", "gear-rattle", "--set", "damping=0", "-o", "r.png", "-o", "r.nc", "--json")
    result = run(*call)
    assert result.exit_code == 0, result.stderr
    (exact,) = json.loads(result.stdout)["methods"]
    last = exact["frequency"][-1]
    assert 0.3 < last < 1.3 and f"the branch was lost at frequency = {last:.6g}" in exact["says"]
    assert "longest_step" in exact["says"] and (here / "r.nc").stat().st_size > 1000
    assert not any(mark["kind"] == "Neimark–Sacker" for mark in exact["marks"])


@pytest.mark.slow
def test_every_method_of_a_system(run, here):
    result = run("frequency-response", "duffing", "--method", "all", "--curve", "v", "-o", "r.png")
    assert result.exit_code == 0, result.stderr
    assert "shooting" in result.stdout and "harmonic balance" in result.stdout and "of v" in result.stdout
    assert result.stdout.count("1.26960, 1.11570") == 2


@pytest.mark.slow
def test_a_longer_line_in_its_own_unit(run, here):
    """Speeds with a unit or in the file's; the usual method bears contacts; names of the catalogue are lines too."""
    operation = '\n[operation]\nspeed = "900 rpm"\n'
    head, rest = PAIR.split("\n[[element]]", 1)
    drive = '\n[[element]]\ntype = "ConstantSpeed"\n\n[[element]]\ntype = "Shaft"\nstiffness = 900\ndamping = 2\n'
    (here / "line.toml").write_text(head + operation + drive + "\n[[element]]" + rest + CLUTCH, encoding="utf-8")
    text = (here / "line.toml").read_text(encoding="utf-8")
    text = text.replace("frequency = 3000", "order = 2").replace('load_torque = "-1 N*m"\n', "")
    (here / "line.toml").write_text(text, encoding="utf-8")
    call = ("frequency-response", "line.toml", "--curve", "clutch", "-o", "r.png")
    one = run(*call, "--from", "600 rpm", "--to", "603")
    assert one.exit_code == 0, one.stderr
    assert "by shooting" in one.stdout and "of clutch" in one.stdout and "rpm" in one.stdout
    assert "followed to speed = 603 rpm" in one.stdout
    assert "may take minutes" in one.stderr
    named = run("frequency-response", "two-shaft-cardan", "--from", "0.5", "--to", "0.51", "-o", "c.png")
    assert named.exit_code == 0 and "by harmonic balance" in named.stdout, named.stderr


def test_a_sweep_of_a_longer_line(run, here):
    """Torques of every spring, in the file's unit; the picture of the one named; both directions in one dataset."""
    (here / "geared.toml").write_text(GEARED, encoding="utf-8")
    call = ("sweep", "geared.toml", "--from", "600", "--to", "900 rpm", "--points", "4")
    result = run(*call, "--curve", "clutch", "-o", "s.png", "-o", "s.nc")
    assert result.exit_code == 0, result.stderr
    assert "sweep up of gear pair, 4 steps from 600 to 900 rpm" in result.stdout
    assert "contact of mesh:" in result.stdout and "clutch: largest torque" in result.stdout
    with xr.open_dataset(here / "s.nc", engine="h5netcdf") as data:
        assert data["torque_high"].dims == ("direction", "speed", "spring")
        assert data["speed"].values[[0, -1]] == pytest.approx([20 * np.pi, 30 * np.pi])
        high = data["torque_high"].sel(direction="up", spring="clutch").values
    content = json.loads(run(*call, "--direction", "up", "--json", "-o", "t.png").stdout)["sweeps"]
    low = [h - s for h, s in zip(high, content[0]["torque_peak_to_peak"]["clutch"], strict=True)]
    assert len(content) == 1 and np.all(np.isfinite(low)) and set(content[0]["contact"]) == {"mesh", "clutch"}


def test_a_long_response_tells_how_far_it_is(run, here, monkeypatch):
    """Shares on stderr while it is computed, rising to the end; nothing of it on stdout."""
    monkeypatch.setattr("trunnion.cli.output.LONG", 0.0)
    result = run("frequency-response", "gear-rattle", "--from", "0.8", "--to", "1.0", "--json", "-o", "r.png")
    assert result.exit_code == 0, result.stderr
    told = [line for line in result.stderr.splitlines() if line.startswith("frequency response: ")]
    shares = [float(line.split()[2]) for line in told]
    assert len(shares) > 20 and shares == sorted(shares) and shares[-1] == 100
    json.loads(result.stdout)

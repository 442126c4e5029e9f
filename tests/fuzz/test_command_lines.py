"""Random command lines: each ends with a known exit code, errors in one line each; no traceback, no leaked warning."""

from __future__ import annotations

import random
import warnings
from pathlib import Path

import pytest
from hurry import hurried
from seed_files import STATED
from typer.testing import CliRunner

from trunnion.cli import app
from trunnion.driveline.starter import starter

FILES = ["stated.toml", "two.toml", "none.toml", ".", "broken.toml", "two-shaft-cardan", "gear-rattle", "ueda", "$x$"]
FREQUENCIES = ["1", "0", "-1", "1e300", "nan", "inf", "300 rpm", "600rpm", "5 Hz", "1e-9", "", "3 kg", "1 2", "9" * 400]
WHOLE = ["1", "2", "8", "0", "-1", "99999999999", "nan", "1.5", "", "x"]
LENGTHS = ["1", "0.01", "0", "-1", "1e300", "nan", "inf", "1e-300", "x", "9" * 400]
OUTPUTS = [
    "out.nc",
    "out.png",
    "out.csv",
    "out.xyz",
    "out",
    "none/out.png",
    ".",
    "",
    "a\0b.nc",
    "x" * 300 + ".nc",
    "out.svg",
]
AXES = [
    "speed:300rpm:2400rpm:12", "HookeJoint 1.angle:0deg:30deg:6", "HookeJoint *.angle", "speed", "load.inertia:1:2:5",
    "speed:1:1:5", "speed:2:1:5", "speed:1:2:999999999", "speed:1:nan:4", "none:1:2:3", ":::", "", "speed:-5:5:4:log",
    "Shaft 1.stiffness:1:1e30:4", "Shaft 1.stiffness:0:1:4", "1:2:3:4:5:6", "HookeJoint 1.plane:0deg:99999deg:4",
]  # fmt: skip
POINTS = ["12x6", "2x2", "99999999x99999999", "0x0", "-1x5", "3", "x", "1e3x2", "4x" + "9" * 400, "1000000x2"]
SETS = ["x=1", "damping=0.1", "amplitude=nan", "amplitude=1e300", "=", "", "forcing=0", "backlash=-1", "a=b=c"]
SPEED = {"--speed": FREQUENCIES, "--unit": ["rpm", "Hz", "rad/s", "kg", ""], "--load-case": ["climb", "none", ""]}
OUTPUT = {"--output": OUTPUTS, "--json": []}
MOTION = {
    "--start": ["0,0", "1", "nan,1", "x", "", "1e300,1e300", "0,0,0,0,0,0"],
    "--set": SETS,
    "--tolerance": LENGTHS,
}
CHAOS = {"--periods": WHOLE, "--duration": LENGTHS, "--starts": WHOLE, "--transient": WHOLE}
SECTION = {"--section": ["x=0", "x=0:-", "y=1e300", "=", "x", "none=0", "x=nan"]}
BAND = {"--from": FREQUENCIES, "--to": FREQUENCIES, "--set": SETS, "--curve": ["x", "none", "", "Shaft 1"]}
OPTIONS: dict[str, dict[str, list[str]]] = {
    "analyze": {"--points": POINTS, "--output": ["out", "two.toml", ""], **SPEED},
    "stability": SPEED,
    "stability-chart": {"--x": AXES, "--y": AXES, "--points": POINTS, **SPEED, **OUTPUT},
    "natural-frequencies": {"--unit": ["rpm", "Hz", "mile"], "--json": []},
    "resonance-speeds": {"--orders": WHOLE, "--all": [], "--unit": ["rpm", "x"]},
    "kinetostatics": {
        **SPEED, **OUTPUT, "--elastic": [], "--inertia": [], "--output-torque": ["1", "150 N*m", "nan", "1e300", "x"],
        "--friction": ["0.005:12mm:40mm", "0:0:0", "::", "nan:1:1", "1"], "--length": ["Shaft 2:0.8m", ":"],
        "--support": ["Shaft 1:-300mm:-100mm", "Shaft 1", "Shaft 1:1:1:1", ":"], "--limit": LENGTHS, "--phase": [],
        "--pitch": ["10 deg", "0", "1e-300", "nan", "x"], "--turns": WHOLE, "--points": WHOLE,
    },
    "simulate": {**SPEED, **OUTPUT, **MOTION, "--to-speed": FREQUENCIES, "--turns": LENGTHS, "--duration": LENGTHS},
    "periodic-response": {**SPEED, **OUTPUT, **MOTION, "--periods": WHOLE, "--period": LENGTHS},
    "run-up": {**SPEED, **OUTPUT, "--from": FREQUENCIES, "--to": FREQUENCIES, "--acceleration": FREQUENCIES,
               "--ramp": LENGTHS, "--limit": ["2 kN*m", "0", "x"]},
    "frequency-response": {**BAND, **OUTPUT, "--harmonics": WHOLE, "--fit-range": LENGTHS,
                           "--method": ["averaging", "harmonic balance", "exact", "none", "all", ""]},
    "sweep": {**BAND, **OUTPUT, "--points": WHOLE, "--direction": ["up", "down", "both", "x"]},
    "lyapunov-spectrum": {**SPEED, **OUTPUT, **MOTION, **CHAOS},
    "poincare-map": {
        **SPEED, **OUTPUT, **MOTION, **SECTION, "--points": WHOLE, "--every": LENGTHS, "--transient": WHOLE,
    },
    "certify-chaos": {**SPEED, **OUTPUT, **MOTION, **SECTION, **CHAOS,
                      "--sweep": ["damping:0:1:3", "x:1:2:1e9", "x", ":::", "forcing:1:2:99999999"]},
    "reproduce": OUTPUT,
    "catalogue": OUTPUT,
    "schema": {"--json": []},
    "new": {**OUTPUT, "--force": []},
}  # fmt: skip
COMMANDS = [name for name, options in OPTIONS.items() for _ in range(1 + len(options))]


def words(seed: int) -> list[str]:
    """A command, mostly with a file, and up to four options, now and then with a character changed."""
    rng = random.Random(seed)
    command = rng.choice(COMMANDS)
    # A whole study is long, and no question of what was typed.
    files = FILES if command != "reproduce" else ["none", "", "$x$", "two.toml"]
    line = [command] + ([rng.choice(files)] if rng.random() < 0.95 else [])
    for option in rng.sample(sorted(OPTIONS[command]), min(len(OPTIONS[command]), rng.randint(0, 4))):
        values = OPTIONS[command][option]
        line += [option, rng.choice(values)] if values else [option]
    if command == "certify-chaos" and not {"--periods", "--duration"} & set(line):
        line += ["--periods", "50", "--starts", "1"]  # nor is the evidence that a verdict rests on
    if rng.random() < 0.1:
        at = rng.randrange(len(line))
        line[at] = "".join(chr(rng.randrange(33, 0x2100)) if rng.random() < 0.3 else c for c in line[at])
    return line


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "stated.toml").write_text(STATED, encoding="utf-8")
    (tmp_path / "two.toml").write_text(starter("two-shaft"), encoding="utf-8")
    (tmp_path / "broken.toml").write_bytes(b"\xff\x00[[")
    return tmp_path


def faults(line: list[str], here: Path) -> str:
    """What is wrong with the answer to a command line."""
    with warnings.catch_warnings(record=True) as leaked, hurried():
        warnings.simplefilter("always")
        result = CliRunner().invoke(app, line)
    said = result.stderr.splitlines()
    if result.exit_code not in (0, 1, 2) or "defect of Trunnion" in result.stderr or "Traceback" in result.stderr:
        return f"exit code {result.exit_code}, {said[-3:]}, {result.exception!r}"
    if bool(result.exit_code) != any(row.startswith("error: ") for row in said):
        return f"exit code {result.exit_code} with {said[-3:]}"
    if leaked or "Warning" in result.stderr:
        return f"leaked {[str(w.message)[:200] for w in leaked] or said[-3:]}"
    if left := [path.name for path in here.rglob(".trunnion-*")]:
        return f"left {left}"
    return "; ".join(f"long line {row[:80]}" for row in said if len(row) > 700)


@pytest.mark.parametrize("ten", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in range(1, 50))])
def test_ten_command_lines(here, ten):
    found = {seed: faults(words(seed), here) for seed in range(10 * ten, 10 * ten + 10)}
    assert {seed: (words(seed), fault) for seed, fault in found.items() if fault} == {}

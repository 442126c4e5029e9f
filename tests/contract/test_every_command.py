"""Every command as a user calls it: with what it needs and nothing more, then for JSON and a file."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import typer
from measured.edges import write_edges
from typer.testing import CliRunner

import trunnion as tn
from trunnion.cli import app

LINE = """
format = 1
name = "short line"

[operation]
speed = "700 rpm"
speed_range = ["600 rpm", "800 rpm"]
life = "1000 h"

[[operation.duty]]
share = "100 %"
speed = "700 rpm"

[[limit]]
of = "shaft"
max_torque = "400 N*m"

[[sn_curve]]
of = "shaft"
torque_amplitude = "300 N*m"
cycles = 2e6
slope = 5

[[tolerance]]
of = "shaft"
stiffness = "2 %"

[[scenario]]
name = "blow"
speed = "700 rpm"
duration = "0.02 s"

[[scenario.torque]]
on = "hub"
time = ["0 s", "0.01 s", "0.02 s"]
torque = ["0 N*m", "-20 N*m", "0 N*m"]

[[element]]
type = "ConstantSpeed"

[[element]]
type = "HookeJoint"
angle = "6 deg"

[[element]]
type = "Shaft"
name = "shaft"
stiffness = "20 kN*m/rad"
damping = "25 N*m*s/rad"

[[element]]
type = "Disk"
name = "hub"
inertia = "0.5 kg*m^2"
load_torque = "30 N*m"
excitation = [{ order = 1, amplitude = "5 N*m" }]
"""

MOTOR = """
format = 1
name = "run-up of a motor"

[operation]
speed = "700 rpm"
speed_range = ["600 rpm", "700 rpm"]

[[scenario]]
name = "start"
speed = "600 rpm"
duration = "0.05 s"

[[scenario.torque]]
on = "motor"
time = ["0 s", "1 s"]
torque = ["60 N*m", "60 N*m"]

[[element]]
type = "Disk"
name = "motor"
inertia = "0.2 kg*m^2"
drive_share = 1

[[element]]
type = "HookeJoint"
angle = "6 deg"

[[element]]
type = "Shaft"
name = "shaft"
stiffness = "20 kN*m/rad"
damping = "25 N*m*s/rad"

[[element]]
type = "Disk"
name = "hub"
inertia = "0.5 kg*m^2"
load_torque = "30 N*m"
"""

PARTS = """
format = 1
name = "engine and pump"

[operation]
speed = "700 rpm"
speed_range = ["600 rpm", "800 rpm"]

[[element]]
type = "Disk"
name = "engine"
inertia = "0.2 kg*m^2"
drive_share = 1
excitation = [{ order = 1, amplitude = "10 N*m" }, { order = 2, amplitude = "20 N*m" }]
firing_angles = ["0 deg", "180 deg"]

[[element]]
type = "ViscousDamper"
name = "damper"
ring_inertia = "0.1 kg*m^2"
damping = "5 N*m*s/rad"

[[element]]
type = "Coupling"
name = "coupling"
stiffness = "20 kN*m/rad"
relative_damping = 0.8
temperature = "40 degC"
temperatures = ["20 degC", "60 degC", "90 degC"]
stiffness_factors = [1.05, 0.9, 0.6]
damping_factors = [1.0, 0.9, 0.8]
thermal_resistance = "0.1 K/W"
ambient_temperature = "25 degC"

[[element]]
type = "Disk"
name = "pump"
inertia = "0.5 kg*m^2"
load_torque = "30 N*m"
"""

STUDY = """
line = "line.toml"
analysis = "stability"
quantities = ["growth_rate"]
store = "study.zarr"

[[parameter]]
path = "speed"
low = "600 rpm"
high = "800 rpm"
points = 3
"""

ASKED: dict[str, list[str]] = {
    "analyze": ["line.toml"],
    "animate": ["line.toml"],
    "assess": ["line.toml"],
    "campbell-diagram": ["line.toml"],
    "capture-map": ["motor.toml", "--x", "factor:1:2:2", "--y", "HookeJoint 1.angle:0deg:5deg:2", "--phases", "1"],
    "catalogue": [],
    "certify-chaos": ["ueda", "--periods", "100", "--transient", "50"],
    "certify-peaks": ["line.toml"],
    "certify-stability": ["line.toml"],
    "compare": ["line.toml", "other.toml"],
    "compare-measured": ["run.csv", "--line", "bench.toml", "--orders", "2"],
    "components": [],
    "coupling-temperatures": ["parts.toml"],
    "damper-optimum": ["parts.toml"],
    "envelope": ["line.toml"],
    "export": ["line.toml", "--to", "c", "-o", "equations.c"],
    "fatigue": ["line.toml"],
    "frequency-response": ["dead-zone-oscillator"],
    "identify": ["run.csv", "--line", "bench.toml", "--free", "hub.inertia:0.4 kg*m^2:0.6 kg*m^2", "--orders", "2"],
    "import": ["assembly.csv"],
    "kinetostatics": ["line.toml"],
    "linearity-check": ["line.toml"],
    "lyapunov-spectrum": ["ueda", "--periods", "200"],
    "minimum-damping": ["line.toml"],
    "misfire": ["parts.toml"],
    "natural-frequencies": ["line.toml"],
    "new": [],
    "optimise": ["line.toml", "-f", "shaft.stiffness:18kN*m/rad:22kN*m/rad", "-a", "peak torque of shaft"],
    "order-response": ["line.toml"],
    "passing": ["motor.toml"],
    "periodic-response": ["line.toml"],
    "poincare-map": ["ueda"],
    "reproduce": ["gear-rattle"],
    "resonance-speeds": ["line.toml"],
    "run-up": ["line.toml"],
    "schema": [],
    "sensitivity": ["line.toml"],
    "simulate": ["line.toml"],
    "speed-sweep": ["line.toml"],
    "stability": ["line.toml"],
    "stability-chart": ["line.toml"],
    "stable-limit": ["line.toml"],
    "stable-windows": ["line.toml"],
    "study": ["study.toml", "--workers", "0"],
    "sweep": ["dead-zone-oscillator"],
    "tolerance-study": ["line.toml"],
    "tongues": ["line.toml"],
    "track-orders": ["run.csv", "--orders", "2"],
    "transient": ["line.toml"],
}
"""What each command needs, and what makes it short; the rest is what a user does not state."""

NOT_ASKED = {
    "app": "it serves until it is stopped; tests/app",
    "warm-up": "compiles all kernels, minutes; tests/contract/test_damaged_cache.py checks what is kept",
}


SLOW = {"analyze", "capture-map", "certify-chaos", "optimise", "reproduce", "sensitivity"}
"""Those that compute for more than a second even so; tests/cli asks ``analyze`` too."""

FILES = {"analyze": "out.html", "animate": "out.html", "envelope": "out.nc", "reproduce": "out"}
"""Where a picture is not what a command writes, or a line without schedules has none."""


@cache
def commands() -> dict[str, Any]:
    return dict(typer.main.get_command(app).commands)  # type: ignore[attr-defined]


def options(command: str) -> set[str]:
    return {word for one in commands()[command].params for word in one.opts}


def each(names: Iterable[str]) -> list[Any]:
    """Parameters of a test; of studies only where what they need is installed."""
    able = [name for name in sorted(names) if name != "study" or find_spec("distributed")]
    return [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in able]


def test_every_command_is_asked():
    assert set(ASKED) | set(NOT_ASKED) == set(commands())


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run-up as a counter recorded it, and the line that it ran on."""
    folder = tmp_path_factory.mktemp("recorded")
    line = tn.Driveline(
        [tn.ConstantSpeed(), tn.HookeJoint(angle="12 deg"), tn.Shaft(stiffness=2e4, damping=25),
         tn.Disk(inertia=0.5, name="hub")], operation=tn.Operation(speed="1500 rpm"),
    )  # fmt: skip
    tn.dump(line, folder / "bench.toml")
    write_edges(tn.measure(line, ("900 rpm", "1800 rpm"), 4.0, {"input": 30, "hub": 30}, wheels=1), folder / "run.csv")
    return folder


@pytest.fixture
def folder(tmp_path, monkeypatch, recorded) -> Path:
    shutil.copytree(recorded, tmp_path, dirs_exist_ok=True)
    for name, text in (("line", LINE), ("motor", MOTOR), ("parts", PARTS), ("study", STUDY)):
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    (tmp_path / "straight.toml").write_text(LINE.replace("6 deg", "0 deg").partition("excitation")[0], encoding="utf-8")
    (tmp_path / "other.toml").write_text(LINE.replace("6 deg", "7 deg"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def asked(*words: str) -> str:
    done = CliRunner().invoke(app, list(words))
    assert done.exit_code == 0, f"trunnion {' '.join(words)}: {done.output}\n{done.exception!r}"
    return done.stdout


@pytest.mark.parametrize("command", each(ASKED))
def test_as_a_user_asks(command, folder):
    if command == "import":
        asked("export", "straight.toml", "--to", "csv", "-o", "assembly.csv")
    before = set(folder.iterdir())
    said = asked(command, *ASKED[command])
    assert said.strip()
    for new in set(folder.iterdir()) - before:
        assert new.name in said or command == "study", "what it writes, it names"


AS_IT_IS = {"catalogue", "components", "export", "import", "new", "study"}
"""Commands whose ``-o`` is no picture or data of a result."""
WRITING = [name for name in ASKED if {"--json", "--output"} <= options(name) and name not in AS_IT_IS]


@pytest.mark.parametrize("command", each(WRITING))
def test_for_json_and_a_file(command, folder):
    place = FILES.get(command, "out.png")
    found = json.loads(asked(command, *ASKED[command], "--json", "-o", place))
    assert found["written"] and all((folder / one).exists() for one in found["written"])
    size = sum(one.stat().st_size for one in [folder / place, *(folder / place).glob("*")])
    assert size > 1000
    assert not (folder / "trunnion-out").exists(), "nothing but what was asked for"


@pytest.mark.parametrize("command", each({name for name in ASKED if "--json" in options(name)} - set(WRITING)))
def test_for_json(command, folder):
    if command == "import":
        asked("export", "straight.toml", "--to", "csv", "-o", "assembly.csv")
    assert json.loads(asked(command, *ASKED[command], "--json"))

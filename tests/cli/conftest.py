"""A small line that computes in milliseconds, the command in this process, and the command in its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

import trunnion
from trunnion.cli import app

LINE = """\
format = 1
name = "test line"

[operation]
speed = "1500 rpm"
speed_range = ["600 rpm", "2400 rpm"]
angle_range = ["0 deg", "20 deg"]

[[operation.load_case]]
name = "climb"
loads = { "Disk 2" = "250 N*m" }

[[element]]
type = "ConstantSpeed"

[[element]]
type = "Shaft"
stiffness = "12 kN*m/rad"
damping = "3 N*m*s/rad"

[[element]]
type = "Disk"
inertia = "0.4 kg*m^2"

[[element]]
type = "HookeJoint"
angle = "12 deg"

[[element]]
type = "Shaft"
stiffness = "10 kN*m/rad"
damping = "3 N*m*s/rad"

[[element]]
type = "Disk"
inertia = "0.9 kg*m^2"
"""
Run = Callable[..., Result]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of its own with ``line.toml``, as the working folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    (tmp_path / "line.toml").write_text(LINE, encoding="utf-8")
    return tmp_path


@pytest.fixture
def run(here: Path) -> Run:
    """The command in this process."""
    return lambda *args: CliRunner().invoke(app, [str(a) for a in args])


@pytest.fixture
def start(here: Path) -> Callable[..., subprocess.Popen[str]]:
    """Python in a process of its own, by default the command; importing the package under test."""

    def started(*args: str, program: tuple[str, ...] = ("-m", "trunnion.cli"), encoding: str = "utf-8"):
        source = str(Path(trunnion.__file__).parents[1])
        return subprocess.Popen(
            [sys.executable, *program, *args],
            cwd=here,
            env={**os.environ, "PYTHONPATH": source, "PYTHONIOENCODING": encoding},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            # Where the tests run in the background Ctrl-C is ignored, and a process inherits that.
            preexec_fn=_hear_ctrl_c if os.name == "posix" else None,
        )

    return started


def _hear_ctrl_c() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)

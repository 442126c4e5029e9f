"""A run that is killed, or whose disk is full, leaves every old result whole; the next run sweeps what it left.

Nothing touches the output before a command begins to write, so the random moments lie between that and its end.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import trunnion

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="forks, and mounts file systems as Linux does")
TO = "-o out/r.nc -o out/r.png"
COMMANDS = [
    "new two-shaft -o other.toml --force",
    f"simulate line.toml --turns 2 {TO} -o out/r.csv",
    f"kinetostatics line.toml --points 24 {TO} -o out/r.csv",
    f"stability-chart line.toml --points 12x6 {TO} -o out/r.csv",
    "stability-chart line.toml --points 12x6",
    "analyze line.toml --points 12x6 -o out",
    f"periodic-response line.toml {TO} -o out/r.csv",
    f"run-up line.toml --from 600rpm --to 610rpm -a 1000rpm {TO} -o out/r.csv",
    f"frequency-response gear-rattle --method averaging {TO}",
    f"sweep gear-rattle --points 3 {TO}",
    f"lyapunov-spectrum ueda --periods 80 --transient 5 {TO}",
    f"poincare-map ueda --points 20 --transient 5 {TO}",
    f"certify-chaos ueda --periods 80 --transient 5 {TO}",
    "reproduce bicardan-elastic -o out",
]


def tried(folder: Path, command: str, kills: int, sizes: int, seed: int) -> str:
    """What ``interrupted.py`` says, where it can in a mount namespace of its own."""
    program = Path(__file__).with_name("interrupted.py")
    apart = ["unshare", "--map-root-user", "--mount"]
    if not shutil.which("unshare") or subprocess.run([*apart, "true"], capture_output=True).returncode:
        apart = []
    run = subprocess.run(
        [*apart, sys.executable, program, *map(str, (kills, sizes, seed)), *command.split()],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(Path(trunnion.__file__).parents[1]), "COLUMNS": "200"},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=600,
    )
    return run.stdout.rpartition("what was found:\n")[2] or run.stderr


def test_a_few_moments_and_sizes(tmp_path):
    assert tried(tmp_path, COMMANDS[0], 12, 2, 0) == "whole\n"


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_thirty_moments_and_ten_sizes(tmp_path, command):
    assert tried(tmp_path, command, 30, 10, 1) == "whole\n"

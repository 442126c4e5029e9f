"""How a command ends that cannot finish: a line on stderr, the exit code of its kind, never a traceback."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from typer.core import TyperGroup

import trunnion
import trunnion.papers.entries as catalogue
from trunnion._version import __version__
from trunnion.cli import main
from trunnion.cli.ending import EndedBy

posix = pytest.mark.skipif(os.name != "posix", reason="pipes and devices")


def test_an_unexpected_error_is_one_line_and_a_file_to_send(run, here, monkeypatch):
    def breaks():
        raise RuntimeError("wheels\ncame off " + "x" * 1000)

    monkeypatch.setattr(catalogue, "entries", breaks)
    monkeypatch.setattr(tempfile, "tempdir", str(here))
    result = run("catalogue", "--json")
    assert result.exit_code == 1
    (line,) = result.stderr.splitlines()
    assert line.startswith("error: unexpected RuntimeError: wheels came off xxx") and len(line) < 500
    said = json.loads(result.stdout)
    assert (said["error"], said["exit_code"]) == ("defect", 1) and f"error: {said['problems'][0]['message']}" == line
    (report,) = here.glob("trunnion-*-crash.txt")
    assert line.endswith(str(report))
    text = report.read_text(encoding="utf-8")
    for part in (f"trunnion {__version__}", "'catalogue' '--json'", "Traceback", "wheels", "numpy"):
        assert part in text
    assert "kN*m/rad" not in text  # nothing of what the user's files hold


def test_without_a_temporary_folder_the_line_remains(run, monkeypatch):
    def breaks():
        raise KeyError("x")

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(catalogue, "entries", breaks)
    monkeypatch.setattr(tempfile, "NamedTemporaryFile", full)
    result = run("catalogue")
    assert result.exit_code == 1
    assert result.stderr == "error: unexpected KeyError: 'x'; this is a defect of Trunnion, please report it\n"


def test_a_file_with_several_mistakes_has_a_line_for_each(run, here):
    (here / "bad.toml").write_text('formt = 1\n[[element]]\ntype = "Disk"\ninertia = -1\n[[element]]\ntype = "Shft"\n')
    result = run("stability", "bad.toml")
    assert result.exit_code == 2
    lines = result.stderr.splitlines()
    assert len(lines) == 3 and all(line.startswith("error: bad.toml: ") for line in lines)


@pytest.mark.parametrize("command", [("analyze",), ("stability-chart", "line.toml", "-o"), ("new", "truck", "-o")])
def test_a_name_too_long_is_refused(run, here, command):
    result = run(*command, "x" * 300 + (".toml" if command[0] != "stability-chart" else ".png"))
    assert result.exit_code == 2, result.stderr
    (line,) = result.stderr.splitlines()
    assert "too long for the name of a file" in line and len(line) < 300
    assert os.listdir(here) == ["line.toml"]


def trunnion_with(stdout, *args):
    env = {**os.environ, "PYTHONPATH": str(Path(trunnion.__file__).parents[1])}
    with stdout as stream:
        return subprocess.run(
            [sys.executable, "-m", "trunnion", *args], stdout=stream, stderr=subprocess.PIPE, env=env, timeout=120
        )


def test_ctrl_c_before_a_command_is_reached_is_said_too(run, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(TyperGroup, "make_context", interrupted, raising=False)
    result = run("schema")
    assert (result.exit_code, result.stdout) == (130, "")
    assert result.stderr == "error: interrupted; nothing was written\n"


@posix
def test_a_reader_who_leaves_is_no_error():
    reader, writer = os.pipe()
    os.close(reader)
    done = trunnion_with(os.fdopen(writer, "wb"), "schema")
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is full")
def test_a_full_disk_behind_stdout_is_one_line():
    done = trunnion_with(open("/dev/full", "wb"), "schema")
    assert (done.returncode, done.stderr) == (1, b"error: No space left on device\n")


def test_an_interrupt_after_all_is_done_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The exit code stands, whatever falls into the last line."""

    def late() -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(EndedBy, "ignore", late)
        with pytest.raises(SystemExit) as ended:
            main(["catalogue"])
    EndedBy.ignore()
    assert not ended.value.code

"""Files and folders are written whole or not at all."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import trunnion
from trunnion.errors import ComputationError, InputError
from trunnion.writing import folder_written_whole, written_whole


def everything(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_folder_appears_with_all_its_files(tmp_path):
    with folder_written_whole(tmp_path / "a" / "b") as temporary:
        (temporary / "one.txt").write_text("1")
        (temporary / "two.txt").write_text("2")
        assert not (tmp_path / "a").exists()
    assert everything(tmp_path) == ["a", "a/b", "a/b/one.txt", "a/b/two.txt"]


def test_files_already_there_are_kept_or_replaced(tmp_path):
    (tmp_path / "kept.txt").write_text("old")
    (tmp_path / "replaced.txt").write_text("old")
    with folder_written_whole(tmp_path) as temporary:
        (temporary / "replaced.txt").write_text("new")
    assert (tmp_path / "kept.txt").read_text() == "old"
    assert (tmp_path / "replaced.txt").read_text() == "new"
    assert everything(tmp_path) == ["kept.txt", "replaced.txt"]


@pytest.mark.parametrize("failure", [KeyboardInterrupt, RuntimeError])
def test_failure_leaves_nothing(tmp_path, failure):
    with pytest.raises(failure), folder_written_whole(tmp_path / "new") as temporary:
        (temporary / "one.txt").write_text("1")
        raise failure
    with pytest.raises(failure), written_whole(tmp_path / "one.txt") as temporary:
        temporary.write_text("1")
        raise failure
    assert everything(tmp_path) == []


def test_folder_that_is_a_file(tmp_path):
    (tmp_path / "there").write_text("a file")
    with pytest.raises(InputError, match="cannot be made"), folder_written_whole(tmp_path / "there"):
        pass
    assert everything(tmp_path) == ["there"]


def test_what_a_killed_run_left_is_swept_and_what_others_write_is_not(tmp_path):
    with written_whole(tmp_path / "one.txt") as temporary:
        own = temporary.name
        with folder_written_whole(tmp_path / "b") as folder:
            assert temporary.exists() and folder.exists()
    assert everything(tmp_path) == ["b", "one.txt"]
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    host = own.removeprefix(".trunnion-").partition("-")[0]
    (tmp_path / f".trunnion-{host}-{gone.pid}-aaaaaaaa.nc").write_text("half")
    (tmp_path / f".trunnion-{host}-{gone.pid}-bbbbbbbb").mkdir()
    (tmp_path / f".trunnion-{host}-{gone.pid}-bbbbbbbb" / "part").write_text("half")
    (tmp_path / f".trunnion-{host}-{os.getppid()}-cccccccc.nc").write_text("somebody is at it")
    (tmp_path / f".trunnion-00000000-{gone.pid}-dddddddd.nc").write_text("elsewhere")
    (tmp_path / f".trunnion-00000000-{gone.pid}-eeeeeeee.nc").write_text("long ago")
    os.utime(tmp_path / f".trunnion-00000000-{gone.pid}-eeeeeeee.nc", (0, 0))
    (tmp_path / ".trunnion-notes").write_text("the user's own")
    with written_whole(tmp_path / "two.txt") as temporary:
        temporary.write_text("2")
    kept = [name.rpartition("-")[2] for name in everything(tmp_path) if name.startswith(".")]
    assert sorted(kept) == ["cccccccc.nc", "dddddddd.nc", "notes"]


def test_a_link_keeps_pointing(tmp_path):
    (tmp_path / "real.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to("real.txt")
    with written_whole(tmp_path / "link.txt") as temporary:
        temporary.write_text("new")
    assert (tmp_path / "link.txt").is_symlink() and (tmp_path / "real.txt").read_text() == "new"


@pytest.mark.parametrize("whole", [written_whole, folder_written_whole])
def test_a_full_disk_is_said_about_the_file_asked_for(tmp_path, whole):
    (tmp_path / "old").mkdir()
    target = tmp_path / "old" / "one.nc"
    if whole is written_whole:
        target.write_text("old")
    with pytest.raises(ComputationError, match=r"one\.nc: cannot be written \(No space left on device\)"):
        with whole(target) as temporary:
            raise OSError(28, "No space left on device", str(temporary))
    assert everything(tmp_path) == ["old", "old/one.nc"] if whole is written_whole else ["old"]


KILLED = """
import os, pathlib, sys
from trunnion.writing import folder_written_whole
moved, most = 0, int(sys.argv[2])
replace = os.replace
def killed(*names):
    global moved
    if moved == most:
        os._exit(9)
    moved += 1
    replace(*names)
os.replace = killed
with folder_written_whole(sys.argv[1]) as temporary:
    for name in ("a", "b", "c"):
        (temporary / name).write_text("new")
"""


@pytest.mark.parametrize("moved", range(3))
def test_files_on_their_way_arrive_with_the_next_run(tmp_path, moved):
    """Killed after ``moved`` of three files have replaced the old ones."""
    source = str(Path(trunnion.__file__).parents[1])
    for name in ("a", "b"):
        (tmp_path / name).write_text("old")
    run = [sys.executable, "-c", KILLED, str(tmp_path), str(moved)]
    assert subprocess.run(run, env={**os.environ, "PYTHONPATH": source}).returncode == 9
    contents = [(tmp_path / name).read_text() for name in ("a", "b")]
    assert contents == ["new"] * min(moved, 2) + ["old"] * (2 - min(moved, 2))
    if moved < 2:
        os.utime(tmp_path / "b", (4e9, 4e9))  # the user put something newer there
    with written_whole(tmp_path / "other") as temporary:
        temporary.write_text("1")
    assert everything(tmp_path) == ["a", "b", "c", "other"]
    contents = [(tmp_path / name).read_text() for name in ("a", "b", "c")]
    assert contents == (["new", "old", "new"] if moved < 2 else ["new"] * 3)


@pytest.mark.parametrize("moved", range(3))
def test_a_move_that_fails_is_undone(tmp_path, moved, monkeypatch):
    """As where another program holds one of the files open on Windows."""
    for name in ("a", "b"):
        (tmp_path / name).write_text("old")
    replace = os.replace

    def held(source, target):
        if str(target).endswith("abc"[moved]) and "new" in str(source):
            raise PermissionError(13, "Permission denied", str(source))
        replace(source, target)

    monkeypatch.setattr("os.replace", held)
    with pytest.raises(InputError, match="Permission denied"), folder_written_whole(tmp_path) as temporary:
        for name in ("a", "b", "c"):
            (temporary / name).write_text("new")
    assert everything(tmp_path) == ["a", "b"]
    assert (tmp_path / "a").read_text() == (tmp_path / "b").read_text() == "old"

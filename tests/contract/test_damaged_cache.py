"""A cache of machine code that was damaged costs the time to compile, and mends itself: nothing of it is run."""

from __future__ import annotations

import os
import pickle
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core import event

import trunnion
from trunnion.numerics import kept_code
from trunnion.numerics.jit import CodeCache

Damage = Callable[[Path], object]


def area(x):
    total = 0.0
    for one in x:
        total += one * one
    return total


def other(x):
    return x[0]


class Heard(event.Listener):
    """How many functions were compiled."""

    def __init__(self) -> None:
        self.compiled = 0

    def on_start(self, event) -> None:
        self.compiled += 1

    def on_end(self, event) -> None:
        pass


def compiled(folder: Path, function=area) -> int:
    """How many functions a process that has compiled nothing yet compiles to call this one."""
    made = numba.njit(function)
    made._cache = CodeCache(function, folder)
    heard = Heard()
    with event.install_listener("numba:compile", heard):
        assert made(np.full(3, 2.0)) == (12.0 if function is area else 2.0)
    return heard.compiled


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("filled")
    assert compiled(folder) == 1 and compiled(folder) == 0
    assert compiled(folder, other) == 1 and compiled(folder, other) == 0
    return folder


def kept(folder: Path, name: str = "area") -> Path:
    (path,) = folder.glob(f"*{name}*.nbc")
    return path


def changed(change: Callable[[bytes], bytes]) -> Damage:
    return lambda path: path.write_bytes(change(path.read_bytes()))


def flipped(share: float, bit: int) -> Damage:
    """One bit, at a share of the file's length."""

    def flip(raw: bytes) -> bytes:
        place = min(int(share * len(raw)), len(raw) - 1)
        return raw[:place] + bytes([raw[place] ^ (1 << bit)]) + raw[place + 1 :]

    return changed(flip)


def cut(share: float) -> Damage:
    return changed(lambda raw: raw[: int(share * len(raw))])


def instead(make: Callable[[Path], object]) -> Damage:
    return lambda path: (path.unlink(), make(path))


def full_folder(path: Path) -> None:
    path.mkdir()
    (path / "notes").write_text("a")


def repacked(change: Callable[[bytes], bytes]) -> Damage:
    """Other content with a checksum that fits."""

    def pack(raw: bytes) -> bytes:
        code = kept_code.unpacked(raw)
        assert code is not None
        return kept_code.packed(code.function, code.processor, change(code.content))

    return changed(pack)


DAMAGES: dict[str, Damage] = {
    **{f"bit {k % 8} at {k} / 24": flipped(k / 24, k % 8) for k in range(25)},
    **{f"cut at {k} / 8": cut(k / 8) for k in range(8)},
    "without its last byte": changed(lambda raw: raw[:-1]),
    "with a byte more": changed(lambda raw: raw + b"\0"),
    "twice": changed(lambda raw: raw * 2),
    "zeros": changed(lambda raw: bytes(len(raw))),
    "a page of zeros": changed(lambda raw: raw[:4096] + bytes(4096) + raw[8192:]),
    "line ends of Windows": changed(lambda raw: raw.replace(b"\n", b"\r\n")),
    "text": changed(lambda raw: b"not found"),
    "of a later format": changed(lambda raw: raw.replace(b"kernel 1", b"kernel 2", 1)),
    "numba's own format": changed(lambda raw: pickle.dumps(numba.__version__) + pickle.dumps(("stamp", {}))),
    "another function's": lambda path: shutil.copyfile(kept(path.parent, "other"), path),
    "no pickle": repacked(lambda content: b"none"),
    "an empty pickle": repacked(lambda content: pickle.dumps(None)),
    "another thing": repacked(lambda content: pickle.dumps((1, 2, 3))),
    "parts missing": repacked(lambda content: pickle.dumps((pickle.loads(content)[0], ()))),
    "a folder": instead(Path.mkdir),
    "a folder with something in it": instead(full_folder),
    "a link to nowhere": instead(lambda path: path.symlink_to(path.parent / "none" / "there")),
    "a link to itself": instead(lambda path: path.symlink_to(path)),
    "a link to a device": instead(lambda path: path.symlink_to("/dev/zero")),
    "a pipe": instead(os.mkfifo if hasattr(os, "mkfifo") else Path.mkdir),
    "nobody's to read": lambda path: path.chmod(0),
}


def test_there_are_fifty_ways():
    assert len(DAMAGES) >= 50


@pytest.mark.skipif(sys.platform == "win32", reason="links, pipes and rights are others there")
@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES.keys())
def test_what_is_damaged_is_compiled_anew_and_whole_again(filled: Path, tmp_path: Path, damage: Damage) -> None:
    folder = tmp_path / "cache"
    shutil.copytree(filled, folder)
    damage(kept(folder))
    readable = damage is DAMAGES["nobody's to read"] and os.access(kept(folder), os.R_OK)  # as for root
    assert compiled(folder) == (0 if readable else 1)
    assert compiled(folder) == 0
    assert kept_code.unpacked(kept(folder).read_bytes()) is not None
    assert compiled(folder, other) == 0
    assert sorted(p.suffix for p in folder.iterdir()) == [".lock", ".lock", ".nbc", ".nbc"]


def test_a_folder_that_is_a_file_and_one_that_is_gone(filled: Path, tmp_path: Path) -> None:
    assert compiled(tmp_path / "gone" / "deep") == 1 and compiled(tmp_path / "gone" / "deep") == 0
    (tmp_path / "file").write_text("")
    with pytest.warns(trunnion.errors.InputRemark, match="is not used"):
        assert compiled(tmp_path / "file") == 1
        assert compiled(tmp_path / "file") == 1


def test_it_is_on_the_disk_before_it_has_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A loss of power leaves the file of before, or the whole new one."""
    done: list[str] = []
    sync, replace = os.fsync, os.replace
    monkeypatch.setattr("os.fsync", lambda handle: (done.append("on the disk"), sync(handle)))
    monkeypatch.setattr("os.replace", lambda *names: (done.append("named"), replace(*names)))
    assert compiled(tmp_path) == 1
    assert done == ["on the disk", "named"]


def test_functions_that_mean_nothing_elsewhere_are_not_kept(tmp_path: Path) -> None:
    """A function as an argument is known by its address, which another process may use for another one."""

    def applied(function, x):
        return function(x)

    made = numba.njit(applied)
    made._cache = CodeCache(applied, tmp_path)
    assert made(numba.njit(lambda x: 3 * x), 2.0) == 6.0
    assert not list(tmp_path.glob("*.nbc"))


def ended(arguments: list[str], cache: Path, here: Path) -> subprocess.CompletedProcess[str]:
    source = str(Path(trunnion.__file__).parents[1])
    env = {**os.environ, "TRUNNION_CACHE": str(cache), "PYTHONPATH": source, "COLUMNS": "300"}
    command = [sys.executable, "-m", "trunnion", *arguments]
    return subprocess.run(command, cwd=here, env=env, capture_output=True, text=True, timeout=600)


SCRIPT = """
import numpy as np
from trunnion.numerics.jit import njit
@njit()
def area(x):
    total = 0.0
    for one in x:
        total += one * one
    return total
assert area(np.ones(3)) == 3.0
"""


@pytest.fixture
def small_cache(tmp_path: Path) -> Path:
    """A cache with one function of the package's own folder."""
    cache = tmp_path / "cache"
    (tmp_path / "one.py").write_text(SCRIPT, encoding="utf-8")
    env = {**os.environ, "TRUNNION_CACHE": str(cache), "PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, tmp_path / "one.py"], env=env, check=True, timeout=300)
    return cache


def test_the_check_says_what_is_kept(small_cache: Path, tmp_path: Path) -> None:
    empty = ended(["warm-up", "--check"], tmp_path / "none", tmp_path)
    assert empty.returncode == 2 and "0 functions in 0 files" in empty.stdout
    assert empty.stderr.count("\n") == 1 and 'holds no machine code of this installation; run "trunnion' in empty.stderr
    assert not (tmp_path / "none").exists()

    whole = ended(["warm-up", "--check"], small_cache, tmp_path)
    assert whole.returncode == 0 and whole.stderr == "", whole.stderr
    size = sum(path.stat().st_size for path in small_cache.rglob("*.nbc"))
    assert f"1 functions in 1 files, {size / 1024:.3g} kB" in whole.stdout
    assert f"numba {numba.__version__}" in whole.stdout

    (path,) = small_cache.rglob("*.nbc")
    older = small_cache / "package-0123456789abcdef"
    older.mkdir()
    shutil.copyfile(path, older / path.name)
    flipped(0.5, 3)(path)
    bad = ended(["warm-up", "--check"], small_cache, tmp_path)
    assert bad.returncode == 2 and f"damaged: {path.name}" in bad.stdout
    assert "of other versions, processors or sources, which may be deleted: 1 functions in 1 files" in bad.stdout
    (line,) = bad.stderr.splitlines()
    assert "holds 1 damaged file of 2" in line and "trunnion warm-up" in line
    assert path.exists()  # a check changes nothing


@pytest.mark.slow
@pytest.mark.parametrize("damage", ["bit 4 at 12 / 24", "cut at 0 / 8", "a folder"])
def test_the_next_command_works_whatever_is_damaged(damage: str, tmp_path: Path) -> None:
    """Every file of the cache at once, the copies of kernels' sources too; the command after it compiles nothing."""
    cache, command = tmp_path / "cache", ["sweep", "gear-rattle", "--points", "2", "--json", "-o", "a.nc"]
    first = ended(command, cache, tmp_path)
    assert first.returncode == 0, first.stderr
    files = [path for path in cache.rglob("*") if path.suffix in (".nbc", ".py")]
    assert {path.suffix for path in files} == {".nbc", ".py"}
    for path in files:
        DAMAGES[damage](path)
    again, then = (ended(command, cache, tmp_path) for _ in range(2))
    assert again.returncode == then.returncode == 0, again.stderr
    assert again.stdout == then.stdout == first.stdout
    assert "compiling" in again.stderr and "compiling" not in then.stderr
    assert not list(cache.rglob("__pycache__")) and not list(cache.rglob(".trunnion-*"))

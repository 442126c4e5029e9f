"""Where machine code is kept: moved by TRUNNION_CACHE, never a folder named "~", and never a reason to fail."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from compile_counter import COUNTER

import trunnion

HOMES = ("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR", "TRUNNION_CACHE")
STEP = """
import warnings
from pathlib import Path
from trunnion.errors import InputRemark
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always", InputRemark)
    from trunnion.numerics.jit import njit
    from trunnion.numerics.compiled import kernel_file
    @njit(cache=True)
    def double(x):
        return 2 * x
    Path("triple.py").write_text("from numba import njit\\n@njit(cache=True)\\ndef triple(x):\\n    return 3 * x\\n")
    assert double(2) + kernel_file("triple.py").triple(2) == 10
print(*(s.message for s in said if issubclass(s.category, InputRemark)), sep="\\n")
"""


def said_where(folder: Path, *before: str, cache: Path | str | None) -> list[str]:
    """What a fresh process says that compiles two functions, working in ``folder`` without a home."""
    kept = {key: value for key, value in os.environ.items() if key not in HOMES}
    env = {**kept, "PYTHONPATH": str(Path(trunnion.__file__).parents[1])}
    env |= {} if cache is None else {"TRUNNION_CACHE": str(cache)}
    script = folder / "step.py"
    script.write_text("\n".join((*before, STEP)), encoding="utf-8")
    done = subprocess.run([sys.executable, script], cwd=folder, env=env, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert not (folder / "~").exists()
    return done.stdout.split("\n")[:-1]


def test_the_cache_goes_where_it_is_told(tmp_path):
    assert said_where(tmp_path, cache=tmp_path / "deep" / "cache") == [""]
    kept = {path.name.split("-")[0] for path in (tmp_path / "deep" / "cache").iterdir()}
    assert len(kept) == 2 and "package" in kept  # what belongs to the package, and the file beside it


@pytest.mark.slow
def test_a_cache_that_cannot_be_written_is_said_once(tmp_path):
    (tmp_path / "file").write_text("")
    said = said_where(tmp_path, cache=tmp_path / "file")
    assert len(said) == 1 and "is not used (it cannot be written)" in said[0] and "TRUNNION_CACHE" in said[0]


@pytest.mark.skipif(sys.platform == "win32", reason="a home is always known there")
@pytest.mark.slow
def test_without_a_home_no_folder_named_after_the_tilde_appears(tmp_path):
    nobody = "import pwd\npwd.getpwuid = lambda uid: (_ for _ in ()).throw(KeyError(uid))"
    said = said_where(tmp_path, nobody, cache=None)
    assert len(said) == 1 and "there is no home folder" in said[0]


def test_a_full_disk_costs_the_cache_only(tmp_path):
    full = (
        "import pathlib\n"
        "def save(*_):\n    raise OSError(28, 'No space left on device')\n"
        "pathlib.Path.write_bytes = save"
    )
    said = said_where(tmp_path, full, cache=tmp_path / "cache")
    assert len(said) == 1 and "No space left on device" in said[0]


def test_machine_code_belongs_to_all_sources_it_comes_from(tmp_path):
    """numba would keep a caller's code when only the function it calls has changed, in another file."""
    from trunnion.numerics import sources
    from trunnion.numerics.chain import characteristic

    (tmp_path / "part").mkdir()
    (tmp_path / "caller.py").write_text("from part.callee import f\n")
    callee = tmp_path / "part" / "callee.py"
    found = []
    for text in ("def f(): return 1\n", "def f(): return 2\n", "def f(): return 1\n"):
        callee.write_text(text)
        sources.digest_of.cache_clear()
        found.append(sources.digest_of(tmp_path))
    assert found[0] == found[2] != found[1]
    kept = Path(characteristic.coefficients_from_matrices._cache.cache_path)
    assert f"package-{sources.digest_of(sources.SOURCES)}" in kept.parts


TWINS = (
    COUNTER
    + """
import time

@njit()
def area(x):
    total = 0.0
    for i in range(10):
        total += x[i] * x[i]
    return total

here = Path(sys.argv[1])
(here / sys.argv[2]).touch()
while not ((here / "one").exists() and (here / "two").exists()):
    time.sleep(0.001)
with event.install_listener("numba:compile", Heard()):
    assert area(np.ones(10)) == 10.0
print(Heard.compiled)
"""
)


@pytest.mark.skipif(sys.platform == "win32", reason="no locks of this kind there: each compiles for itself")
@pytest.mark.slow
def test_two_processes_do_not_compile_the_same_function(tmp_path):
    script = tmp_path / "twins.py"
    script.write_text(TWINS, encoding="utf-8")
    env = {**os.environ, "TRUNNION_CACHE": str(tmp_path / "kept"), "PYTHONPATH": os.pathsep.join(sys.path)}
    both = [
        subprocess.Popen([sys.executable, script, tmp_path, name], env=env, stdout=subprocess.PIPE, text=True)
        for name in ("one", "two")
    ]
    assert sorted(process.communicate(timeout=300)[0].strip() for process in both) == ["0", "1"]


def test_what_no_compiler_takes_holds_nobody_back(tmp_path):
    """A process that failed to compile lives on; the others must not wait for its end."""
    script = tmp_path / "failing.py"
    script.write_text(
        "from trunnion.numerics.compile_lock import HELD\n"
        "from trunnion.numerics.jit import njit\n"
        "import numba\n\n"
        "@njit()\n"
        "def outer(inner, x):\n"
        "    return inner(x)\n\n"
        "def spelled(x):\n"
        "    return str(x).spell()\n\n"
        "try:\n"
        "    outer(numba.njit(spelled), 1.0)\n"
        "except numba.TypingError:\n"
        "    print(len(HELD), 'held')\n"
        "print(outer(numba.njit(lambda x: abs(x)), -1.0), len(HELD))\n",
        encoding="utf-8",
    )
    env = {**os.environ, "TRUNNION_CACHE": str(tmp_path / "kept"), "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run([sys.executable, script], env=env, capture_output=True, text=True, timeout=300)
    assert done.stdout.splitlines() == ["0 held", "1.0 0"], done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="no locks of this kind there")
def test_who_waits_too_long_compiles_for_itself(tmp_path, monkeypatch):
    from trunnion.numerics import compile_lock

    monkeypatch.setattr(compile_lock, "PATIENCE", 0.2)
    first, second = compile_lock.CompileLock(tmp_path / "lock"), compile_lock.CompileLock(tmp_path / "lock")
    first.take()
    first.take()  # as often as it likes
    second.take()
    assert first.held and not second.held
    first.release()
    second.take()
    assert second.held
    nowhere = compile_lock.CompileLock(tmp_path / "missing" / "lock")
    nowhere.take()
    assert not nowhere.held

"""Machine code that comes with a wheel: used where everything fits, and never instead of another function's."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from compile_counter import COUNTER

STEP = (
    COUNTER
    + """
from trunnion.numerics import shipped

def times(factor):
    @njit()
    def inner(x):
        return factor * x
    @njit()
    def total(x):
        found = 0.0
        for one in x:
            found += inner(one)
        return found
    return total

came, needed, factor = sys.argv[1:]
shipped.CAME_ALONG = Path(came)
shipped.NEEDED = tuple(needed.split())
with event.install_listener("numba:compile", Heard()):
    print(times(int(factor))(np.ones(4)), Heard.compiled)
"""
)


def run(tmp_path: Path, *arguments: str, cache: str, **env: str) -> str:
    script = tmp_path / "step.py"
    script.write_text(STEP, encoding="utf-8")
    env = {**os.environ, "TRUNNION_CACHE": str(tmp_path / cache), "PYTHONPATH": os.pathsep.join(sys.path), **env}
    done = subprocess.run([sys.executable, script, *arguments], env=env, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.fixture(scope="module")
def came(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a build of a wheel gathers."""
    folder = tmp_path_factory.mktemp("wheel")
    said = run(folder, str(folder), "", "3", cache="building", TRUNNION_SHIP_KERNELS=str(folder / "kernels"))
    assert said.startswith("12.0 ") and said != "12.0 0"
    return folder / "kernels"


@pytest.mark.slow
def test_what_came_along_is_not_compiled(came: Path, tmp_path: Path) -> None:
    assert run(tmp_path, str(came), "", "3", cache="a") == "12.0 0"


def test_nothing_to_keep_it_in_is_no_hindrance(came: Path, tmp_path: Path) -> None:
    (tmp_path / "no folder").write_text("")
    assert run(tmp_path, str(came), "", "3", cache="no folder") == "12.0 0"


@pytest.mark.parametrize(("needed", "factor", "result"), [("", "5", "20.0"), ("no-such-feature", "3", "12.0")])
def test_another_function_or_a_lesser_processor_compiles(
    came: Path, tmp_path: Path, needed: str, factor: str, result: str
) -> None:
    value, compiled = run(tmp_path, str(came), needed, factor, cache="b").split()
    assert value == result and int(compiled) > 0


@pytest.mark.slow
def test_other_sources_or_nothing_along_compile(came: Path, tmp_path: Path) -> None:
    (folder,) = came.iterdir()
    other = tmp_path / "kernels"
    (other / "x86-64-v3-0123456789abcdef").mkdir(parents=True)
    for file in folder.iterdir():
        (other / "x86-64-v3-0123456789abcdef" / file.name).write_bytes(file.read_bytes())
    for place in (other, tmp_path / "none"):
        assert run(tmp_path, str(place), "", "3", cache=place.name + " cache").split()[1] != "0"

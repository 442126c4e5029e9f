"""Functions that only compiled code calls: part of their callers, whose values and cache they share."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import trunnion
from trunnion.numerics import linked
from trunnion.numerics.jit import njit
from trunnion.numerics.linked import OVERRIDDEN, LinkedLibrary

SCRIPT = """
import numpy as np
from compile_counter_text import Heard, event, njit

@njit(inner=True)
def half(x):
    return x / 2

@njit(inner=True)
def quarter(x):
    return half(half(x))

@njit()
def summed(x):
    total = 0.0
    for value in x:
        total += quarter(value)
    return total

with event.install_listener("numba:compile", Heard()):
    assert summed(np.array([1.0, 2.0, 5.0])) == 2.0
print(Heard.compiled)
"""


@njit(cache=False, inner=True)
def _shifted(x, by):  # type: ignore[no-untyped-def]
    return x + by if x > 0 else x - by


@njit(cache=False)
def _twice_shifted(x, by):  # type: ignore[no-untyped-def]
    return _shifted(_shifted(x, by), by)


def test_a_caller_computes_with_what_has_no_machine_code_of_its_own():
    assert (_twice_shifted(1.0, 0.25), _twice_shifted(-1.0, 0.25)) == (1.5, -1.5)
    (made,) = _shifted.overloads.values()
    assert isinstance(made.library, LinkedLibrary)
    (caller,) = _twice_shifted.overloads.values()
    assert not isinstance(caller.library, LinkedLibrary)
    assert not any("_shifted" in f.name and "twice" not in f.name for f in caller.library.get_defined_functions())


def test_where_linking_fails_it_is_compiled_as_any_other(monkeypatch):
    def of_other_insides(self: LinkedLibrary) -> None:
        raise AttributeError("_finalize_dynamic_globals")

    monkeypatch.setattr(LinkedLibrary, "_finalize_final_module", of_other_insides)
    inner, caller = _pair()
    assert caller(1.0) == 4.0
    (made,) = inner.overloads.values()
    assert not isinstance(made.library, LinkedLibrary) and made.library._finalized


@pytest.mark.parametrize("name", OVERRIDDEN)
def test_where_numba_has_other_insides_nothing_is_linked(monkeypatch, name):
    class Other:
        """numba's library without one of those names."""

    for known in set(OVERRIDDEN) - {name}:
        setattr(Other, known, None)
    monkeypatch.setattr(linked, "LIBRARY", Other)
    inner, caller = _pair()
    assert caller(1.0) == 4.0
    (made,) = inner.overloads.values()
    assert not isinstance(made.library, LinkedLibrary)


def _pair():  # type: ignore[no-untyped-def]
    """A function of compiled code alone and one that calls it, neither compiled before."""

    @njit(cache=False, inner=True)
    def doubled(x):  # type: ignore[no-untyped-def]
        return 2 * x

    @njit(cache=False)
    def twice(x):  # type: ignore[no-untyped-def]
        return doubled(doubled(x))

    return doubled, twice


def test_called_from_python_it_is_an_error_and_no_crash():
    _twice_shifted(1.0, 0.25)
    with pytest.raises(KeyError, match="compiled code alone calls"):
        _shifted(1.0, 0.25)


def test_the_caller_alone_is_kept_and_stands_without_it(tmp_path):
    """The second process compiles nothing."""
    from compile_counter import COUNTER

    (tmp_path / "compile_counter_text.py").write_text(COUNTER, encoding="utf-8")
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    paths = os.pathsep.join((str(Path(trunnion.__file__).parents[1]), str(tmp_path)))
    environment = os.environ | {"TRUNNION_CACHE": str(tmp_path / "cache"), "PYTHONPATH": paths}
    compiled = []
    for _ in range(2):
        call = [sys.executable, str(tmp_path / "script.py")]
        run = subprocess.run(call, env=environment, capture_output=True, text=True, timeout=300, check=False)
        assert run.returncode == 0, run.stderr
        compiled.append(int(run.stdout))
    assert compiled[0] >= 3 and compiled[1] == 0
    kept = [path.name for path in (tmp_path / "cache").rglob("*.nbc")]
    assert len(kept) == 1 and "summed" in kept[0]

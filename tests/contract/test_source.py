"""How the source is written: files one can read, public names that say what they are, no code as text."""

from __future__ import annotations

import ast
import inspect
import re
from contextlib import suppress
from functools import cache
from pathlib import Path
from re import _parser  # type: ignore[attr-defined]

import pytest

import trunnion

ROOT = Path(trunnion.__file__).parent
LONGEST = 700
"""Lines of a file that is not a kernel: one idea each, whole."""
FILES = sorted(ROOT.rglob("*.py"))
RUNS_TEXT = {"numerics/compiled.py"}
"""Loads a kernel's file a second time under other constants."""
MOST_BY_PLACE = 8
"""Arguments that a call passes without naming them."""
TO_KERNELS = {"k", "core", "kernel()", "_kernel()"}
"""What a kernel's module is called where it is loaded late; compiled code takes all it needs, one by one."""
NAMED_LATER = {
    # Being put together anew: they go from this list with the results of motions that get labelled fields.
    "motion/chaos/bifurcation_diagram.py",
    "motion/chaos/certify_chaos.py",
    "motion/chaos/lyapunov_map.py",
    "motion/chaos/poincare_map.py",
    "motion/linearity/linearity_check.py",
    "motion/orbits/frequency_response.py",
    "motion/orbits/harmonic_balance.py",
    "motion/orbits/harmonic_balance_springs.py",
    "motion/orbits/piecewise_branch.py",
    "motion/orbits/piecewise_orbit.py",
    "motion/orbits/piecewise_sweep.py",
    "motion/simulation/exact_motion.py",
}


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def is_kernel(path: Path) -> bool:
    """Whether a file is compiled, or part of it."""
    decorators = [ast.unparse(d) for node in ast.walk(parsed(path)) for d in getattr(node, "decorator_list", [])]
    return path.stem.endswith("_kernel") or any(d.startswith("njit") for d in decorators)


@pytest.mark.parametrize("path", FILES, ids=[str(p.relative_to(ROOT)) for p in FILES])
def test_files(path: Path) -> None:
    """Kernels may be long, since what is compiled together stands together; no other file may, nor run text as code."""
    text = path.read_text(encoding="utf-8")
    tree = parsed(path)
    assert is_kernel(path) or len(text.splitlines()) <= LONGEST
    called = {node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    assert not called & {"exec", "eval", "compile"} or str(path.relative_to(ROOT).as_posix()) in RUNS_TEXT


def crowded(tree: ast.Module, kernels: set[str]) -> list[int]:
    """Lines of calls that pass more by place than anybody can count, but for those into compiled code."""
    return [
        node.lineno
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and len(node.args) > MOST_BY_PLACE
        if ast.unparse(node.func) not in kernels and ast.unparse(getattr(node.func, "value", node.func)) not in kernels
    ]


def test_the_look_at_calls_sees_what_it_looks_for() -> None:
    nine = ", ".join("abcdefghi")
    tree = ast.parse(f"f({nine})\nf({nine[:-3]}, i=i)\nk.run({nine})\nwhole({nine})\nobject.f({nine})\nf(*{nine[:-3]})")
    assert crowded(tree, TO_KERNELS | {"whole"}) == [1, 5]


@pytest.mark.parametrize("path", FILES, ids=[str(p.relative_to(ROOT)) for p in FILES])
def test_arguments_have_names(path: Path) -> None:
    """What a call passes beyond eight arguments it names, or it passes what belongs together as one."""
    if is_kernel(path):
        return
    imported = {
        alias.asname or alias.name
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("trunnion.")
        for alias in node.names
        if (home := ROOT.joinpath(*node.module.split(".")[1:]).with_suffix(".py")).exists() and is_kernel(home)
    }
    found = crowded(parsed(path), TO_KERNELS | imported)
    known = path.relative_to(ROOT).as_posix() in NAMED_LATER
    assert bool(found) == known, f"calls in lines {found}" if found else "take this file from the list"


PATTERNS = [path for path in FILES if "import re\n" in path.read_text(encoding="utf-8")]
POSSESSIVE = {"POSSESSIVE_REPEAT", "ATOMIC_GROUP"}


def operations(parsed: object) -> set[str]:
    """Names of what a parsed pattern is made of."""
    if isinstance(parsed, _parser.SubPattern):
        return set().union(*({str(name)} | operations(rest) for name, rest in parsed))
    return set().union(*map(operations, parsed)) if isinstance(parsed, list | tuple) else set()


def test_the_look_at_patterns_sees_what_it_looks_for() -> None:
    assert operations(_parser.parse(r"(?:a|(b*+c))+")) & POSSESSIVE == {"POSSESSIVE_REPEAT"}
    assert operations(_parser.parse(r"x(?=(?>ab))")) & POSSESSIVE == {"ATOMIC_GROUP"}


@pytest.mark.filterwarnings("ignore:Possible nested set")
@pytest.mark.parametrize("path", PATTERNS, ids=lambda p: p.stem)
def test_no_pattern_needs_what_python_before_3_11_4_reads_wrongly(path: Path) -> None:
    """Possessive quantifiers and atomic groups: a distribution's own Python may be as old as 3.11.2."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            with suppress(re.error):  # other texts than patterns
                assert not operations(_parser.parse(node.value)) & POSSESSIVE, node.value


@pytest.mark.parametrize("name", sorted(trunnion.__all__))
def test_public_names_have_docstrings(name: str) -> None:
    """A public function or class, and what one calls on it, says what it is."""
    public = getattr(trunnion, name)
    if not (inspect.isfunction(public) or inspect.isclass(public)):
        return
    assert inspect.getdoc(public)
    if not inspect.isclass(public):
        return
    for key, value in vars(public).items():
        shown = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
        if not key.startswith("_") and inspect.isfunction(shown) and shown.__module__.startswith("trunnion"):
            assert inspect.getdoc(shown), f"{name}.{key}"

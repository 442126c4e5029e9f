"""How the source is written: files one can read, public names that say what they are, no code as text."""

from __future__ import annotations

import ast
import inspect
import re
from contextlib import suppress
from pathlib import Path
from re import _parser  # type: ignore[attr-defined]

import pytest

import trunnion

ROOT = Path(trunnion.__file__).parent
LONGEST = 700
"""Lines of a file that is no kernel: one idea each, whole."""
FILES = sorted(ROOT.rglob("*.py"))
RUNS_TEXT = {"numerics/compiled.py"}
"""Loads a kernel's file a second time under other constants."""


@pytest.mark.parametrize("path", FILES, ids=[str(p.relative_to(ROOT)) for p in FILES])
def test_files(path: Path) -> None:
    """Kernels may be long, since what is compiled together stands together; no other file may, nor run text as code."""
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    decorators = [ast.unparse(d) for node in ast.walk(tree) for d in getattr(node, "decorator_list", [])]
    kernel = path.stem.endswith("_kernel") or any(d.startswith("njit") for d in decorators)
    assert kernel or len(text.splitlines()) <= LONGEST
    called = {node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    assert not called & {"exec", "eval", "compile"} or str(path.relative_to(ROOT).as_posix()) in RUNS_TEXT


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

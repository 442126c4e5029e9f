"""How the source is written: files one can read, public names that say what they are, no code as text."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import pytest

import trunnion

ROOT = Path(trunnion.__file__).parent
LONGEST = 450
"""Lines of a file that is no kernel."""
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

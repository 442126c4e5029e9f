"""Which part of the package may import which: the layering that keeps each of them replaceable."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import trunnion

ROOT = Path(trunnion.__file__).parent
ALWAYS = {"errors", "_version"}
DESCRIBE = {"driveline", "laws"}
COMPUTE = {"equations", "systems", "numerics", "results", *DESCRIBE}
ALLOWED = {
    "errors": set(),
    "_version": set(),
    "laws": set(),
    "numerics": set(),
    "systems": {"numerics"},
    "driveline": {"laws", "plots"},  # plots where something draws itself, see test_plots_load_late
    "equations": {"driveline", "laws", "systems", "numerics"},
    "results": {"driveline", "numerics", "plots"},  # a chart keeps the patches behind its pixels
    "analyses": {"plots", *COMPUTE},
    "plots": {"analyses", *COMPUTE},
    "reporting": {"plots", "analyses", *COMPUTE},
    "studies": {"plots", "analyses", "reporting", *COMPUTE},
    "cli": {"plots", "analyses", "reporting", "studies", *COMPUTE},
    "__main__": {"cli"},
}
FILES = sorted(ROOT.rglob("*.py"))


def imported_parts(path: Path) -> set[str]:
    """First names below ``trunnion`` that a file imports, anywhere in it."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    modules = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            modules += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            module = node.module or ""
            modules += [f"trunnion.{alias.name}" for alias in node.names] if module == "trunnion" else [module]
    return {m.split(".")[1] for m in modules if m.startswith("trunnion.")}


def part_of(path: Path) -> str:
    first = path.relative_to(ROOT).parts[0]
    return first.removesuffix(".py")


@pytest.mark.parametrize("path", FILES, ids=[str(p.relative_to(ROOT)) for p in FILES])
def test_layers(path: Path) -> None:
    part = part_of(path)
    if part == "__init__":  # lists the public names and loads them when first used
        return
    assert part in ALLOWED, f"say in this test what trunnion.{part} may import"
    assert imported_parts(path) <= ALLOWED[part] | ALWAYS | {part}


def test_nothing_imports_the_command_line() -> None:
    users = [p for p in FILES if "cli" in imported_parts(p) and part_of(p) not in ("cli", "__main__")]
    assert users == []


def test_plots_load_late() -> None:
    """matplotlib, and plots where something draws itself, are imported inside functions only."""
    for path in FILES:
        top = ast.parse(path.read_text(encoding="utf-8")).body
        names = {a.name for n in top if isinstance(n, ast.Import) for a in n.names}
        names |= {n.module or "" for n in top if isinstance(n, ast.ImportFrom)}
        assert not any(name.startswith("matplotlib") for name in names), path
        if part_of(path) in ("driveline", "results", "analyses"):
            assert not any(name.startswith("trunnion.plots") for name in names), path

"""Which part of the package may import which: the layering that keeps each of them replaceable."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

import trunnion
from trunnion.plots import DRAWINGS

ROOT = Path(trunnion.__file__).parent
ALWAYS = {"errors", "_version"}
LAYERS = (
    {"errors", "arrays", "_version"},
    {"portable", "reading", "waiting", "writing"},
    {"numerics"},
    {"laws"},
    {"driveline", "systems"},
    {"equations"},
    {"results"},
    {"analyses"},
    {"plots"},
    {"reporting"},
    {"studies"},
    {"app"},
    {"cli"},
    {"__main__"},
)
"""From the ground up; a part imports what stands below it, and nothing above or beside it, late or for types."""
LEVEL = {part: level for level, parts in enumerate(LAYERS) for part in parts}
FILES = sorted(ROOT.rglob("*.py"))


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def imported_parts(path: Path) -> frozenset[str]:
    """First names below ``trunnion`` that a file imports, anywhere in it."""
    modules = []
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            modules += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively"
            module = node.module or ""
            modules += [f"trunnion.{alias.name}" for alias in node.names] if module == "trunnion" else [module]
    return frozenset(m.split(".")[1] for m in modules if m.startswith("trunnion."))


def part_of(path: Path) -> str:
    first = path.relative_to(ROOT).parts[0]
    return first.removesuffix(".py")


@pytest.mark.parametrize("path", FILES, ids=[str(p.relative_to(ROOT)) for p in FILES])
def test_layers(path: Path) -> None:
    part = part_of(path)
    if part == "__init__":  # lists the public names and loads them when first used
        return
    assert part in LEVEL, f"say in this test where trunnion.{part} stands"
    above = {other for other in imported_parts(path) if other != part and LEVEL[other] >= LEVEL[part]}
    assert not above, f"{path} imports {', '.join(sorted(above))} from above or beside it"


def test_drawings_exist() -> None:
    """Every entry of the table of drawings names a public method of a result, and a function."""
    for key, address in DRAWINGS.items():
        module, name = address.split(":")
        assert callable(getattr(import_module(module), name)), key
    called = {
        (node.name, call.args[1].value)
        for path in FILES
        for node in ast.walk(tree(path))
        if isinstance(node, ast.ClassDef)
        for call in ast.walk(node)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "drawing"
        if isinstance(call.args[1], ast.Constant)
    }
    assert {f"{owner}.{method}" for owner, method in called} == set(DRAWINGS)


def test_no_import_circle() -> None:
    """What a module imports, when it is loaded, late or for types alone, never leads back to it."""
    needs = {module_of(path): modules_in(ast.walk(tree(path))) & MODULES for path in FILES}
    done: set[str] = set()

    def visit(name: str, trail: tuple[str, ...]) -> None:
        assert name not in trail, " → ".join((*trail, name))
        if name not in done:
            for other in sorted(needs[name] - {name}):
                visit(other, (*trail, name))
            done.add(name)

    for name in sorted(needs):
        visit(name, ())


def module_of(path: Path) -> str:
    return ".".join(("trunnion", *path.relative_to(ROOT).with_suffix("").parts)).removesuffix(".__init__")


MODULES = {module_of(path) for path in FILES}


def loaded_modules(path: Path) -> set[str]:
    """Modules that loading a file imports: its statements outside functions and TYPE_CHECKING."""
    return modules_in(tree(path).body)


def modules_in(nodes: Iterable[ast.AST]) -> set[str]:
    """Modules that the imports among some nodes name."""
    found: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            full = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in MODULES else node.module for name in full}
    return found


def test_nothing_imports_the_command_line() -> None:
    users = [p for p in FILES if "cli" in imported_parts(p) and part_of(p) not in ("cli", "__main__")]
    assert users == []


def test_plots_load_late() -> None:
    """matplotlib is loaded when something is drawn: whatever loads before leads to no module that imports it."""
    needs = {module_of(path): loaded_modules(path) for path in FILES}
    reached = {module_of(path) for path in FILES if part_of(path) not in ("plots", "studies")}
    reached |= {"trunnion.plots", "trunnion.studies.entries"}
    waiting = list(reached)
    while waiting:
        name = waiting.pop()
        drawn = [module for module in needs[name] if module.split(".")[0] in ("matplotlib", "mpl_toolkits")]
        assert not drawn, f"{name} imports {drawn[0]} when it is loaded"
        new = {module for module in needs[name] if module in MODULES} - reached
        reached |= new
        waiting += new

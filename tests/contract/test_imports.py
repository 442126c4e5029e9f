"""Which part of the package may import which: the layering that keeps each of them replaceable."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

import trunnion
from trunnion.registry import PICTURES

ROOT = Path(trunnion.__file__).parent
LAYERS = (
    {"errors", "arrays", "_version", "portable", "registry"},
    {"reading", "waiting", "live", "writing", "laws"},
    {"numerics", "driveline"},
    {"numerics/continuation", "numerics/integration", "numerics/patches", "numerics/piecewise_linear"},
    {"numerics/chain", "systems"},
    {"equations", "results"},
    {"features"},
    # Lines as files of other programs.
    {"exchange"},
    # What stands still, and what repeats: modes of the straight line, then the periodic motion that stability,
    # responses and motions are judged about. A free–free line finds its own by shooting or by balance.
    {"modes", "steady", "steady/shooting", "steady/hill"},
    {"steady/free"},
    {"steady/orders"},
    # What grows beside that motion comes before what it amounts to: a response without a verdict is worth nothing.
    {"floquet", "floquet/propagation"},
    {"floquet/charts"},
    {"floquet/stability"},
    {"floquet/ranges", "floquet/tolerance"},
    {"floquet/certificate"},
    {"floquet/tongues"},
    {"response/kinetostatics", "response/orders"},
    {"response/ranges"},
    {"response"},
    {"response/peaks"},
    # What was measured, beside what is computed.
    {"measured/signals"},
    {"measured/tracking"},
    {"measured"},
    # Motions that do not repeat, or not linearly; they are compared with the responses below.
    {"motion", "motion/simulation", "motion/perturbation"},
    {"motion/orbits", "motion/transients"},
    {"motion/passing", "motion/chaos"},
    {"motion/linearity"},
    # Judging and changing lines takes everything below. ``design`` itself holds the envelope of all load cases.
    {"design/fatigue"},
    {"design/assessment"},
    {"design/limits"},
    {"design", "design/sensitivity", "design/comparison", "design/optimisation", "design/tolerance"},
    {"design/remedies"},
    # Judging by what was measured takes limits and bounds.
    {"measured/identification"},
    # Asks any of the analyses by its name in the registry, at very many points.
    {"studies"},
    {"pictures", "animation", "animation/player"},
    {"reporting"},
    {"papers/shared"},
    {"papers/two_shaft_cardan", "papers/bicardan_elastic", "papers/double_tripod", "papers/gear_rattle"},
    {"papers/three_shaft_cardan"},
    {"papers"},
    {"app/parts"},
    {"app/views"},
    {"app"},
    {"cli"},
    {"__main__"},
)
"""Folders, and files beside them, from the ground up. Each imports what stands below it: nothing above or beside it,
late or for types."""
LEVEL = {part: level for level, parts in enumerate(LAYERS) for part in parts}
FILES = sorted(ROOT.rglob("*.py"))


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def part_of(path: Path) -> str:
    """The folder of a file, or the name of one that stands in none."""
    folder = path.relative_to(ROOT).parent
    return path.stem if folder == Path() else folder.as_posix()


@cache
def imported_parts(path: Path) -> frozenset[str]:
    """Folders that a file imports from, anywhere in it."""
    return frozenset(part_of(HOME[name]) for name in modules_of(path) if name in HOME and name != "trunnion")


@pytest.mark.parametrize("path", FILES, ids=[path.relative_to(ROOT).as_posix() for path in FILES])
def test_layers(path: Path) -> None:
    part = part_of(path)
    if part == "__init__":  # lists the public names and loads them when first used
        return
    assert part in LEVEL, f"say in this test where trunnion/{part} stands"
    relative = [node for node in ast.walk(tree(path)) if isinstance(node, ast.ImportFrom) and node.level]
    assert not relative, f"{path} imports relatively"
    above = {other for other in imported_parts(path) if other != part and LEVEL[other] >= LEVEL[part]}
    assert not above, f"{path} imports {', '.join(sorted(above))} from above or beside it"


def test_every_layer_stands() -> None:
    assert set(LEVEL) == {part_of(path) for path in FILES} - {"__init__"}


def test_drawings_exist() -> None:
    """Every entry of the table of pictures names a public method of a result, and a function."""
    for key, address in PICTURES.items():
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
    assert {f"{owner}.{method}" for owner, method in called} == set(PICTURES)


def test_no_import_circle() -> None:
    """What a module imports, when it is loaded, late or for types alone, never leads back to it."""
    needs = {module_of(path): modules_of(path) & MODULES for path in FILES}
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


HOME = {module_of(path): path for path in FILES}
MODULES = set(HOME)


def loaded_modules(path: Path) -> set[str]:
    """Modules that loading a file imports: its statements outside functions and TYPE_CHECKING."""
    return modules_in(tree(path).body)


@cache
def modules_of(path: Path) -> frozenset[str]:
    """Modules that a file imports, anywhere in it."""
    return frozenset(modules_in(ast.walk(tree(path))))


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
    users = [p for p in FILES if "cli" in imported_parts(p) and part_of(p) not in ("cli", "__main__", "__init__")]
    assert users == []


DRAWN_BY_HAND = {"draw_matplotlib", "literal_figure", "layout", "driveline_sketch"}
"""Modules of pictures that load matplotlib; the others describe what is drawn, or draw it by Bokeh."""


def test_matplotlib_loads_late() -> None:
    """It is loaded when something is drawn: whatever loads before, descriptions included, leads to no import of it."""
    needs = {module_of(path): loaded_modules(path) for path in FILES}
    reached = {module_of(path) for path in FILES if part_of(path).split("/")[0] != "papers"}
    reached -= {f"trunnion.pictures.{name}" for name in DRAWN_BY_HAND}
    reached |= {"trunnion.papers.entries"}
    waiting = list(reached)
    while waiting:
        name = waiting.pop()
        drawn = [module for module in needs[name] if module.split(".")[0] in ("matplotlib", "mpl_toolkits")]
        assert not drawn, f"{name} imports {drawn[0]} when it is loaded"
        new = {module for module in needs[name] if module in MODULES} - reached
        reached |= new
        waiting += new

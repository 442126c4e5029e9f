"""What the package imports is declared, and the lowest versions it declares are those that are tested."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = ROOT / "pyproject.toml"
BESIDES = {"pydantic_core": "pydantic", "mpl_toolkits": "matplotlib", "llvmlite": "numba", "IPython": None,
    "PIL": "pillow", "param": "panel", "tornado": "bokeh", "nptdms": "npTDMS",
}  # fmt: skip
"""Modules of another name than what brings them; None: imported only where it is there."""

pytestmark = pytest.mark.skipif(not PROJECT.exists(), reason="needs the source tree")


def declared(*, dev: bool = False) -> dict[str, str]:
    """Lowest version by name."""
    project = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    rows = project["dependencies"] + (sum(project["optional-dependencies"].values(), []) if dev else [])
    return dict(re.fullmatch(r"([\w-]+)>=([\d.]+)", row).groups() for row in rows)


def imported() -> set[str]:
    found = set()
    for path in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                found.add((node.module or "").partition(".")[0])
    return found - set(sys.stdlib_module_names) - {"trunnion", "trunnion_kernels"}


def test_what_is_imported_is_declared():
    names = {BESIDES.get(module, module) for module in imported()} - {None}
    assert {name.replace("_", "-") for name in names} <= set(declared(dev=True))


def test_the_lowest_versions_are_tested():
    rows = (ROOT / "constraints-lowest.txt").read_text(encoding="utf-8").splitlines()
    tested = dict(row.split("==") for row in rows if not row.startswith("#"))
    lowest = declared()
    assert set(tested) == set(lowest)
    for name, version in tested.items():
        assert version.startswith(lowest[name]), f"{name}: {lowest[name]} is declared, {version} is tested"

"""What public functions and results take stands in their signatures."""

from __future__ import annotations

import inspect
from importlib import import_module
from pathlib import Path

import pytest

import trunnion
from trunnion.registry import PICTURES

ROOT = Path(trunnion.__file__).parent
NAMES_OF_THE_READER = {"catalogue", "reference_system", "gear_pair", "component"}
"""Their keywords are the parameters of what is asked for."""


def result_class(name: str) -> type:
    """The one class of a result of this name."""
    for part in ("results", "modes", "steady", "floquet", "response", "measured", "motion", "design", "studies"):
        for path in sorted((ROOT / part).rglob("*.py")):
            if f"class {name}(" in path.read_text(encoding="utf-8") or f"class {name}:" in path.read_text("utf-8"):
                module = ".".join(["trunnion", *path.relative_to(ROOT).with_suffix("").parts])
                return getattr(import_module(module), name)
    raise AssertionError(f"no result {name}")


def keywords(function: object) -> dict[str, object]:
    """Names and defaults of all that a drawing takes beside what it draws."""
    parameters = list(inspect.signature(function).parameters.values())[1:]
    assert all(p.kind is not p.VAR_KEYWORD for p in parameters)
    return {p.name: p.default for p in parameters}


@pytest.mark.parametrize("key", PICTURES)
def test_a_result_names_what_its_drawing_takes(key: str) -> None:
    """``result.plot`` has every option of the function that describes it, with the same default."""
    owner, method = key.split(".")
    module, name = PICTURES[key].split(":")
    taken = keywords(getattr(result_class(owner), method))
    taken.pop("axes", None)
    assert taken == keywords(getattr(import_module(module), name))


@pytest.mark.parametrize("name", sorted(set(trunnion.__all__) - NAMES_OF_THE_READER))
def test_public_functions_name_what_they_take(name: str) -> None:
    """No ``**options``: a misspelt one is refused where it is written."""
    if inspect.isfunction(public := getattr(trunnion, name)):
        assert all(p.kind is not p.VAR_KEYWORD for p in inspect.signature(public).parameters.values())

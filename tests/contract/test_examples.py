"""Docstrings of public names: every parameter stands in them, and their examples run and give what they say."""

from __future__ import annotations

import doctest
import inspect
import re
import sys
from importlib.util import find_spec
from typing import Any

import pytest

import trunnion
from trunnion.driveline.elements import Element

PUBLIC = sorted(trunnion.__all__)
FUNCTIONS = [name for name in PUBLIC if inspect.isfunction(getattr(trunnion, name))]
CLASSES = [name for name in PUBLIC if inspect.isclass(getattr(trunnion, name))]
OF_EVERY_ELEMENT = set(Element.model_fields)
"""What a class of element takes as all of them do, see ``Element``."""
UNNAMED = (trunnion.ComputationError, trunnion.InputRemark, trunnion.Tolerance)
"""They take a text, or any number of an element by its own name."""
SLOW = ("reproduce",)
"""Names whose examples take many seconds."""
NEEDS = {"read_study": "zarr", "study_boundary": "zarr", "study_sensitivities": "zarr"}
"""Names whose examples need a package of an extra."""
RUNNER = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE, verbose=False)
FINDER = doctest.DocTestFinder(recurse=False)


def examples(name: str) -> list[doctest.DocTest]:
    """Those in the docstring of a public name; they see what its module sees."""
    public = getattr(trunnion, name)
    names = dict(vars(sys.modules[public.__module__])) if hasattr(public, "__module__") else {}
    return [one for one in FINDER.find(public, name, globs=names) if one.examples]


def taken(name: str) -> set[str]:
    """What a function takes, or a class to be made."""
    public = getattr(trunnion, name)
    if public in UNNAMED:
        return described(name)
    parameters = set(inspect.signature(public).parameters)
    return parameters - OF_EVERY_ELEMENT if inspect.isclass(public) and issubclass(public, Element) else parameters


def described(name: str) -> set[str]:
    """The parameters that stand before a colon under "Parameters"."""
    text = inspect.getdoc(getattr(trunnion, name)) or ""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)", text, flags=re.DOTALL | re.MULTILINE)
    heads = re.findall(r"^(\*{0,2}\w+(?:, \w+)*) :", section[1] if section else "", flags=re.MULTILINE)
    return {one.lstrip("*") for head in heads for one in head.split(", ")}


def is_installed(package: str | None) -> bool:
    """Whether what an example needs of an extra is there."""
    return package is None or find_spec(package) is not None


def with_slow(names: list[str]) -> list[Any]:
    """``names`` as parameters, those marked whose examples take long."""
    return [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in names]


@pytest.mark.parametrize(
    "name", with_slow([name for name in PUBLIC if examples(name) and is_installed(NEEDS.get(name))])
)
def test_examples_run(name: str) -> None:
    """Every line gives what stands below it."""
    failures: list[str] = []
    for one in examples(name):
        RUNNER.run(one, out=failures.append)
    assert not failures, "".join(failures)


def test_public_names_have_an_example() -> None:
    """A reader sees a call and what it gives."""
    assert [name for name in FUNCTIONS + CLASSES if not examples(name)] == []


def test_public_names_describe_what_they_take() -> None:
    """Every parameter, and none that is not there."""
    wrong = {name: described(name) ^ taken(name) for name in FUNCTIONS + CLASSES}
    assert {name: parameters for name, parameters in wrong.items() if parameters} == {}

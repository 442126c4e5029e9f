"""Docstrings of public names: every parameter stands in them, and their examples run and give what they say."""

from __future__ import annotations

import doctest
import inspect
import re
import sys

import pytest

import trunnion

PUBLIC = sorted(trunnion.__all__)
FUNCTIONS = [name for name in PUBLIC if inspect.isfunction(getattr(trunnion, name))]
DESCRIBED = ("trunnion.motion.", "trunnion.steady.", "trunnion.systems.")
"""Rooms in which every public function has both; one is added as its last function gets them."""
IN_FULL = [name for name in FUNCTIONS if getattr(trunnion, name).__module__.startswith(DESCRIBED)]
RUNNER = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE, verbose=False)
FINDER = doctest.DocTestFinder(recurse=False)


def examples(name: str) -> list[doctest.DocTest]:
    """Those in the docstring of a public name; they see what its module sees."""
    public = getattr(trunnion, name)
    names = dict(vars(sys.modules[public.__module__])) if hasattr(public, "__module__") else {}
    return [one for one in FINDER.find(public, name, globs=names) if one.examples]


def described(name: str) -> set[str]:
    """The parameters that stand before a colon under "Parameters"."""
    text = inspect.getdoc(getattr(trunnion, name)) or ""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)", text, flags=re.DOTALL | re.MULTILINE)
    heads = re.findall(r"^(\*{0,2}\w+(?:, \w+)*) :", section[1] if section else "", flags=re.MULTILINE)
    return {one.lstrip("*") for head in heads for one in head.split(", ")}


@pytest.mark.parametrize("name", [name for name in PUBLIC if examples(name)])
def test_examples_run(name: str) -> None:
    """Every line gives what stands below it."""
    told: list[str] = []
    for one in examples(name):
        RUNNER.run(one, out=told.append)
    assert not told, "".join(told)


@pytest.mark.parametrize("name", IN_FULL)
def test_public_functions_have_an_example(name: str) -> None:
    """A reader sees a call and what it gives."""
    assert examples(name)


@pytest.mark.parametrize("name", IN_FULL)
def test_public_functions_describe_what_they_take(name: str) -> None:
    """Each parameter once, and none that is not there."""
    assert described(name) == set(inspect.signature(getattr(trunnion, name)).parameters)

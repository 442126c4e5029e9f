"""Tests that ``make test`` leaves out and ``make thorough`` runs: those of ``thorough.txt``, a test a line.

They take more than about a quarter of a second each. Others of their file stay among the quick ones, so that none is
left out whole.
"""

from __future__ import annotations

from pathlib import Path

import pytest

LIST = Path(__file__).with_suffix(".txt")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    listed = set(LIST.read_text(encoding="utf-8").splitlines())
    for item in items:
        if item.nodeid in listed:
            item.add_marker("thorough")
            item.add_marker("slow")  # so that "not slow" leaves it out
    if gone := unknown(listed, {item.nodeid for item in items}, config.args):
        raise pytest.UsageError(f"{LIST.name} names tests that are not there: {', '.join(sorted(gone))}")


def unknown(listed: set[str], found: set[str], asked: list[str]) -> set[str]:
    """Of the tests ``listed`` those that whole files, from which others are ``found``, do not have."""
    if any("::" in one for one in asked):
        return set()
    files = {one.split("::")[0] for one in found}
    return {one for one in listed if one.split("::")[0] in files} - found

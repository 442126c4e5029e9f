"""Tests that ``make test`` leaves out and ``make thorough`` runs: those of ``thorough.txt``, a test a line.

They take more than about a quarter of a second each. Others of their file stay among the quick ones, so that none is
left out whole. ``contract/test_thorough.py`` holds the list against the tests that there are.
"""

from __future__ import annotations

from pathlib import Path

import pytest

LIST = Path(__file__).with_suffix(".txt")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    listed = set(LIST.read_text(encoding="utf-8").splitlines())
    for item in items:
        if item.nodeid in listed:
            item.add_marker("thorough")
            item.add_marker("slow")  # so that "not slow" leaves it out

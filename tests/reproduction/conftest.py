"""Each study is computed once for all tests of a run."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import pytest

import trunnion as tn
from trunnion.studies.result import Reproduction


@pytest.fixture(scope="session")
def study() -> Callable[[str], Reproduction]:
    """``study(name)``, at the points of the documentation."""
    return cache(lambda name: tn.reproduce(name))

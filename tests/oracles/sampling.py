"""Long lists of cases of which a quick run takes a share."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def quick_every(step: int, cases: Iterable[Any]) -> list[Any]:
    """All cases as parameters of a test; one in ``step`` is quick, the others are slow."""
    return [case if i % step == 0 else pytest.param(case, marks=pytest.mark.slow) for i, case in enumerate(cases)]


def quick_only(quick: Iterable[Any], cases: Iterable[Any]) -> list[Any]:
    """All cases as parameters of a test; those of ``quick``, one for each claim, are quick, the others are slow."""
    chosen = list(quick)
    every = list(cases)
    assert all(case in every for case in chosen), "a case is not among all"
    return [case if case in chosen else _slow(case) for case in every]


def _slow(case: Any) -> Any:
    return pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.slow)

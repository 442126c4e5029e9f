"""Long lists of cases of which a quick run takes a share."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def quick_every(step: int, cases: Iterable[Any]) -> list[Any]:
    """All cases as parameters of a test; one in ``step`` is quick, the others are slow."""
    return [case if i % step == 0 else pytest.param(case, marks=pytest.mark.slow) for i, case in enumerate(cases)]

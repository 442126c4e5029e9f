"""Makes what stands beside the tests importable, and has kernels compiled at once: so many calls need them anyway."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from trunnion.analyses.charts import prices

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="module", autouse=True)
def compiled_at_once() -> Iterator[None]:
    """Nothing is stepped in NumPy first where machine code is missing."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(prices, "_in_numpy", float("inf"))
        yield

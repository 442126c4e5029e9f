"""The examples of docs/rattle.md run in order, and say what the page says they do."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from typing import Any

PAGE = (Path(__file__).parents[2] / "docs" / "rattle.md").read_text(encoding="utf-8")


def test_examples_run_in_order() -> None:
    names: dict[str, Any] = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for block in re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.DOTALL | re.MULTILINE):
            exec(block, names)
    text = printed.getvalue()
    assert "fold at 0.874372" in text and "2 attractors" in text
    assert abs(names["both"]["describing function"].peak[1] / names["both"]["exact"].peak[1] - 1) < 0.01
    assert (0.87, 0.88) in names["up"].jumps and (0.76, 0.75) in names["down"].jumps
    assert names["double"].outcome.ok and len(names["branch"].parameter) > 10
    assert abs(names["amplitude"][-1] - names["large"].amplitude) < 1e-3
    assert names["small"].stable and not names["saddle"].stable
    assert tn_orbit(names).outcome.ok


def tn_orbit(names: dict[str, Any]) -> Any:
    """The clutch damper moves too."""
    return names["tn"].piecewise_orbit(names["clutch"])

"""Pages of the documentation: their text, and their Python run from top to bottom as a reader would."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]


def page(name: str) -> str:
    """The text of ``docs/NAME.md``."""
    return (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")


def blocks(name: str, language: str) -> list[str]:
    """Its blocks in one language."""
    return re.findall(rf"^```{language}\n(.*?)^```", page(name), flags=re.DOTALL | re.MULTILINE)


def run_page(name: str) -> tuple[str, dict[str, Any]]:
    """What its Python prints, block by block in one namespace, and the names it leaves."""
    names: dict[str, Any] = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for block in blocks(name, "python"):
            exec(block, names)
    return printed.getvalue(), names

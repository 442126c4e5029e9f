"""Files of pictures that can be written; known before anything is drawn, and without matplotlib."""

from __future__ import annotations

import os
from pathlib import Path

from trunnion.errors import InputError

FORMATS = ("png", "pdf", "svg")


def check_format(path: str | os.PathLike[str]) -> str:
    """``png``, ``pdf`` or ``svg`` by the file's ending; InputError for another."""
    ending = Path(path).suffix.removeprefix(".").lower()
    if ending not in FORMATS:
        raise InputError(
            "is not a picture this program writes",
            key="output",
            value=str(path),
            remedy="end it in .png, .pdf or .svg",
        )
    return ending

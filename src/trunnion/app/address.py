"""The address of a page: the line and what is looked at, packed into the query."""

from __future__ import annotations

import base64
import binascii
import zlib
from collections.abc import Mapping
from urllib.parse import urlencode

from trunnion.errors import InputError

LARGEST = 1_000_000
"""Characters that a packed line may unfold to."""


def pack(toml: str) -> str:
    """A driveline file as text that stands in an address."""
    return base64.urlsafe_b64encode(zlib.compress(toml.encode("utf-8"), 9)).decode("ascii").rstrip("=")


def unpack(text: str) -> str:
    """The file again.

    Raises
    ------
    InputError : the text is damaged, or unfolds to more than a file may hold.
    """
    try:
        body = base64.b64decode(text + "=" * (-len(text) % 4), altchars=b"-_", validate=True)
        unfolder = zlib.decompressobj()
        content = unfolder.decompress(body, LARGEST)
        if not unfolder.eof:
            raise ValueError
        return content.decode("utf-8")
    except (ValueError, binascii.Error, zlib.error):
        remedy = "copy the whole address again"
        raise InputError("does not hold a driveline", key="line", value=text, remedy=remedy) from None


def address(view: str, settings: Mapping[str, str], slider: Mapping[str, str], toml: str, kept: str | None) -> str:
    """The query of a page."""
    parts = {"view": view, **{f"{view}.{k}": v for k, v in settings.items()}, **slider, "line": pack(toml)}
    if kept is not None:
        parts["kept"] = pack(kept)
    return "?" + urlencode(parts)

"""The address of a page: the line and what is looked at, packed into the query."""

from __future__ import annotations

import base64
import binascii
import zlib
from collections.abc import Mapping, Sequence
from urllib.parse import urlencode

from trunnion.app.parts.variant_strip import MOST_KEPT
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


def address(
    view: str,
    settings: Mapping[str, str],
    slider: Mapping[str, str],
    toml: str,
    kept: Sequence[tuple[str, str, bool]] = (),
) -> str:
    """The query of a page; ``kept`` variants as name, file, and whether they are shown."""
    parts = {"view": view, **{f"{view}.{k}": v for k, v in settings.items()}, **slider, "line": pack(toml)}
    for number, (name, file, is_shown) in enumerate(kept, start=1):
        key = f"kept{number}"
        parts |= {key: pack(file), f"{key}.name": name}
        if not is_shown:
            parts[f"{key}.hidden"] = "1"
    return "?" + urlencode(parts)


def kept_keys(query: Mapping[str, str]) -> list[str]:
    """Keys of the kept variants of a query, in their order; "kept" alone is how there was one."""
    keys = ["kept", *(f"kept{number}" for number in range(1, MOST_KEPT + 1))]
    return [key for key in keys if key in query]

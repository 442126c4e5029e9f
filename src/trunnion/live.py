"""What a notebook shows of a line or a result beside its words: the line in motion, where ``anywidget`` is.

What is shown of which class stands in ``trunnion.registry.LIVE``: lines and results know nothing of pictures.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

from trunnion.errors import TrunnionError
from trunnion.registry import LIVE, found_at


def in_notebook(owner: Any) -> dict[str, Any]:
    """The live picture of ``owner`` by media type, for Jupyter; nothing where there is none, or no ``anywidget``.

    What cannot be shown in motion, as the response of a line that nothing excites, is shown in words alone.
    """
    address = next((LIVE[one.__name__] for one in type(owner).__mro__ if one.__name__ in LIVE), "")
    if not address or find_spec("anywidget") is None:
        return {}
    try:
        found: dict[str, Any] = found_at(address)(owner)
    except TrunnionError:
        return {}
    return found

"""A page that plays a scene: one file, whose only script is admitted by its hash, that fetches nothing."""

from __future__ import annotations

import base64
import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from trunnion._version import __version__

PLAYER = Path(__file__).parent / "player" / "player.js"
MODULE = "\n/* module */"
"""Where the part of the player begins that makes a module of it."""


@cache
def script() -> str:
    """The player as one script that plays the scene of its page."""
    return PLAYER.read_text(encoding="ascii").partition(MODULE)[0] + "\nTrunnionPlayer.start();\n"


def admitted(text: str) -> str:
    """What a content policy says of one script."""
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"


def as_data(scene: Any) -> str:
    """JSON that nothing in it can end, whatever an element is called."""
    text = json.dumps(scene, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def page(scene: dict[str, Any]) -> str:
    """The whole page."""
    made = Environment(
        loader=PackageLoader("trunnion.animation", "templates"),
        autoescape=select_autoescape(default=True),
        undefined=StrictUndefined,
    )
    facts = {
        "title": scene["title"], "hash": admitted(script()), "version": __version__,
        "scene": as_data(scene), "script": script(),
    }  # fmt: skip
    return made.get_template("player.html.j2").render(**facts)

"""The player of lines in motion on the page: the file that pages from ``tn.animate`` hold, served by this server."""

from __future__ import annotations

import os
from typing import ClassVar

import param
from panel.custom import JSComponent

from trunnion.animation.page import PLAYER


class Live(JSComponent):
    """Plays a ``scene``, JSON as ``Animation.json`` has it; ``picked`` is the element that was clicked."""

    scene = param.String(default="")
    theme = param.String(default="light")
    flat = param.Boolean(default=False, doc="without WebGL")
    height_of = param.Integer(default=520)
    picked = param.String(default="")

    _bundle: ClassVar[str | os.PathLike[str] | None] = PLAYER

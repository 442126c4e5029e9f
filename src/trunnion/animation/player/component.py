"""The player on a page of the application. It stands beside the script, from where Panel's server hands that out: the
same file that pages of ``tn.animate`` hold."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import param
from panel.custom import JSComponent


class Player(JSComponent):
    """Plays a ``scene``, JSON as ``Animation.json`` has it; ``picked`` is the element that was clicked."""

    scene = param.String(default="")
    theme = param.String(default="")
    flat = param.Boolean(default=False, doc="without WebGL")
    height_of = param.Integer(default=560)
    picked = param.String(default="")

    _bundle: ClassVar[Path] = Path(__file__).with_name("player.js")

"""The player in a notebook, as a widget: the script of pages and of the application, given to Jupyter by the kernel, so
that nothing is fetched."""

from __future__ import annotations

from functools import cache
from typing import Any

from trunnion.animation.animate import animate
from trunnion.animation.animation import Animation
from trunnion.animation.movements import passage_movement, periodic_movement, transient_movement
from trunnion.animation.page import PLAYER
from trunnion.animation.scene import ShownMotion
from trunnion.animation.scenery import scenery
from trunnion.driveline.driveline import Driveline
from trunnion.errors import TrunnionError
from trunnion.modes.natural_frequencies import NaturalFrequencies
from trunnion.motion.orbits.periodic_response import PeriodicResponse
from trunnion.motion.passing.run_up import RunUp
from trunnion.motion.transients.result import Transient

HEIGHT = 480
"""Of the picture [px]."""


@cache
def _kind() -> Any:
    """The class of the widgets; ``anywidget`` is of the extra ``notebook``."""
    import anywidget
    import traitlets

    class Live(anywidget.AnyWidget):  # type: ignore[misc]
        """Plays ``scene``; ``picked`` is the element that was clicked."""

        _esm = PLAYER.read_text(encoding="ascii")
        scene = traitlets.Unicode("").tag(sync=True)
        theme = traitlets.Unicode("").tag(sync=True)
        flat = traitlets.Bool(False).tag(sync=True)
        choice = traitlets.Int(0).tag(sync=True)
        height_of = traitlets.Int(HEIGHT).tag(sync=True)
        picked = traitlets.Unicode("").tag(sync=True)

    return Live


def shown(animation: Animation) -> dict[str, Any]:
    """An animation as a widget, by media type."""
    widget = _kind()(scene=animation.json)
    found: Any = widget._repr_mimebundle_()
    bundle = found[0] if isinstance(found, tuple) else found
    return {kind: value for kind, value in (bundle or {}).items() if kind != "text/plain"}


def of_line(line: Driveline) -> dict[str, Any]:
    """A line as it turns at its operating speed; in its first mode where it states none."""
    try:
        return shown(animate(line, "turning"))
    except TrunnionError:
        return shown(animate(line, "mode"))


def of_modes(found: NaturalFrequencies) -> dict[str, Any]:
    """Its first mode."""
    return shown(animate(found.assembly, "mode"))


def of_motion(found: PeriodicResponse) -> dict[str, Any]:
    """A periodic motion of a line; nothing of one that was not found, or of other equations."""
    return _played("motion", *periodic_movement(found))


def of_run(found: RunUp) -> dict[str, Any]:
    """A run-up."""
    return _played("run-up", *passage_movement(found))


def of_transient(found: Transient) -> dict[str, Any]:
    """A transient."""
    return _played("transient", *transient_movement(found))


def _played(title: str, assembly: Any, movement: Any) -> dict[str, Any]:
    drawn = scenery(assembly.line, assembly.topology)
    return shown(Animation(assembly.line.name or "driveline", (ShownMotion(title, drawn, (movement,)),)))

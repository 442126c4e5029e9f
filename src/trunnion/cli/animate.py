"""The command ``animate``."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import trunnion as tn
from trunnion.cli.command_input import OptionReader
from trunnion.cli.options import LineOfFile, Speed
from trunnion.cli.places import PAGES, CommandOutput
from trunnion.cli.readers import read_speed, read_speed_ends
from trunnion.cli.typed import Command

if TYPE_CHECKING:
    from trunnion.animation.animation import Animation

Ends = Annotated[
    tuple[float, float] | None,
    typer.Option("--speeds", metavar="LOW:HIGH", help="Speeds of a run-up; default: the file's range."),
    OptionReader(read_speed_ends),
]


@Command("frames", writes=PAGES)
def animate(
    line: LineOfFile,
    *,
    what: str = "turning",
    speed: Speed,
    mode: int | None = None,
    beside: Annotated[float | None, OptionReader(read_speed)],
    speeds: Ends,
    acceleration: float | None = None,
    scenario: str | None = None,
) -> CommandOutput:
    """Examples: trunnion animate truck.toml --what mode --mode 2 -o mode.html

    trunnion animate truck.toml --what disturbance --speed 1500rpm -o why.gif

    --what  What is shown: turning, mode, response, motion, disturbance, run-up, transient or passing.
    --mode  Number of a mode, from 1 among those that vibrate.
    --beside  Speed of the other disturbance; default: the nearest one where it does the opposite.
    --acceleration  Acceleration of a run-up [rad/s²]; default: what takes ten seconds.
    --scenario  Name of a [[scenario]] of the file; default: its first.
    """
    found = tn.animate(
        line, what, speed=speed, mode=mode, beside=beside, speeds=speeds, acceleration=acceleration, scenario=scenario
    )
    content = {"animation": found.title, "motions": [_said(found, k) for k in range(len(found.motions))]}
    return CommandOutput(found, save=found.save, files=partial(_page, found), content=lambda: content)


def _page(found: Animation, stem: Path) -> list[Path]:
    return [found.save(stem.with_name(f"{stem.name}.html"))]


def _said(found: Animation, k: int) -> dict[str, object]:
    """What one motion shows, for JSON; the frames are in the files."""
    one = found.motions[k]
    rows = [
        {
            "title": movement.title, "says": movement.said, "notes": list(movement.notes), "frames": len(movement.time),
            "seconds": float(movement.time[-1] - movement.time[0]), "drawn": movement.factor,
        }
        for movement in one.movements
    ]  # fmt: skip
    return {"title": one.title, "bodies": len(one.parts), "movements": rows}

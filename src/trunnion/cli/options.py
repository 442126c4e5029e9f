"""The options that commands share: what a function takes, how the terminal states it, how it is read."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import typer

from trunnion.cli.command_input import CommandSubject, InputAttribute, OptionReader
from trunnion.cli.readers import line_of_file, loaded_line, range_of, read_speed, read_speed_ends, read_state

if TYPE_CHECKING:
    import trunnion as tn

FILE = typer.Argument(metavar="FILE", help="Driveline file (TOML) or a name of the catalogue.")
SPEED = typer.Option(
    "--speed", "-s", help='Input speed: "1500 rpm", "25 Hz", "157 rad/s", or a number in --unit; default: the file\'s.'
)
SPEED_RANGE = typer.Option(
    "--speed", metavar="LOW:HIGH", help="Lowest and highest input speed, 300rpm:2400rpm say; default: the file's range."
)
Unit = Annotated[
    str | None,
    typer.Option("--unit", "-u", metavar="rpm|Hz|rad/s", help="Unit of speeds; default: the file's."),
]
LoadCase = Annotated[str | None, typer.Option("--load-case", help="Torques of this load case of the file.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Parameter of a reference system; repeat it for more."),
]

Line = Annotated["tn.Driveline", FILE, CommandSubject(loaded_line, {"unit": Unit, "load_case": LoadCase})]
"""Under its own torques, or those of a load case."""
LineOfFile = Annotated["tn.Driveline", FILE, CommandSubject(line_of_file, {"unit": Unit})]
"""Under its own torques."""
AboutSteadyState = Annotated[
    bool,
    typer.Option("--about-steady-state", help="Judge the line about its true motion, not that of rigid shafts."),
]
SpeedUnit = Annotated[str, InputAttribute("unit")]
"""Of the speeds that are printed."""
Progress = Callable[[float], None]
Speed = Annotated[float | None, SPEED, OptionReader(read_speed)]
SpeedEnds = Annotated[tuple[float, float] | None, SPEED_RANGE, OptionReader(read_speed_ends)]
SpeedRange = Annotated[tuple[float, float], SPEED_RANGE, OptionReader(read_speed_ends, missing=range_of)]
Start = Annotated[
    list[float] | None,
    typer.Option(
        "--start", metavar="X,Y,…", help="State to start from; default: the system's own, or a line without twist."
    ),
    OptionReader(read_state),
]

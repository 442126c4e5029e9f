"""The command ``damper-optimum``."""

from __future__ import annotations

from typing import Annotated

import trunnion as tn
from trunnion.cli.command_input import NumberBounds
from trunnion.cli.options import LineOfFile
from trunnion.cli.places import NOTHING, CommandOutput
from trunnion.cli.typed import Command
from trunnion.driveline.dampers import Damper
from trunnion.errors import InputError


def only_damper(line: tn.Driveline) -> str:
    """Name of the line's one damper.

    Raises
    ------
    InputError : it has none, or several.
    """
    names = [name for name, element in line.parts if isinstance(element, Damper)]
    if len(names) == 1:
        return names[0]
    if not names:
        remedy = "add a ViscousDamper or a TunedDamper where it is to stand"
        raise InputError("has no damper", element="driveline", remedy=remedy)
    raise InputError("is missing", key="--damper", remedy=f"name one of {', '.join(names)}")


@Command(writes=NOTHING)
def damper_optimum(
    line: LineOfFile,
    *,
    damper: str | None = None,
    mode: Annotated[int, NumberBounds(1)] = 1,
) -> CommandOutput:
    """Example: trunnion damper-optimum ship.toml --damper "front damper" --mode 2

    --damper NAME  Name of the damper; default: the line's only one.
    --mode  Number among the elastic modes of the line without the damper's ring.
    """
    return CommandOutput(tn.damper_optimum(line, damper or only_damper(line), mode))

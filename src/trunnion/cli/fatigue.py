"""The command ``fatigue``: how long shafts last under duty and passages."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import CommandInput, OptionReader
from trunnion.cli.options import LineOfFile, Progress, SpeedUnit
from trunnion.cli.places import CommandOutput
from trunnion.cli.readers import read_quantity
from trunnion.cli.typed import Command
from trunnion.errors import InputError


def _life(asked: CommandInput, text: str, key: str) -> float:
    from trunnion.driveline.quantities import TIME

    life = read_quantity(text, TIME, key, 'write "20000 h"')
    if not life > 0:
        raise InputError("must be positive", key=key, value=text, remedy='write "20000 h"')
    return life


@Command("fatigue", within=True)
def fatigue(
    line: LineOfFile,
    *,
    life: Annotated[float | None, OptionReader(_life)],
    element: str = "",
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion fatigue truck.toml --life "20000 h" -o cycles.png

    --life  Operating time that the line is to last: "20000 h"; default: the file's.
    --element  Element whose cycles are drawn; default: the one that lasts shortest.
    """
    found = tn.fatigue(line, life=life, progress=progress)
    found.spectrum(element)

    def more() -> None:
        output.table(found.table(), "Damage and life")
        output.findings(found.findings_in(unit))

    return CommandOutput(
        found, draw=partial(found.plot, element=element), text=lambda: found.headline, more=more,
        content=lambda: found.to_dict() | {"findings": output.findings_json(found.findings)},
    )  # fmt: skip

"""The command ``transient``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import OptionReader
from trunnion.cli.options import Line, SpeedUnit
from trunnion.cli.places import CommandOutput
from trunnion.cli.readers import read_speed
from trunnion.cli.typed import Command
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.motion.transients.result import Transient

Tolerance = Annotated[float, typer.Option("--tolerance", help="Error allowed per step.", min=1e-15, max=0.1)]


@Command("transient", within=True)
def transient(
    line: Line,
    *,
    scenario: str = "",
    speed: Annotated[float | None, OptionReader(read_speed)],
    tolerance: Tolerance = 1e-10,
    unit: SpeedUnit,
) -> CommandOutput:
    """Example: trunnion transient mill.toml --scenario start -o start.png -o start.nc

    --scenario  Name of a [[scenario]] of the file; default: its only one.
    --speed  Of the input when it begins, instead of the scenario's.
    """
    known = [one.name for one in line.scenarios]
    if not scenario and len(known) != 1:
        problem = "is missing" if known else "has none to choose from"
        remedy = f"name one of {', '.join(known)}" if known else "write [[scenario]] in the file"
        raise InputError(problem, key="--scenario", remedy=remedy)
    found = tn.transient(line, scenario or known[0], speed=speed, tolerance=tolerance)
    return CommandOutput(found, content=lambda: _content(found, unit), outcome=found.outcome)


def _content(found: Transient, unit: str) -> dict[str, Any]:
    return {
        "scenario": found.name,
        "outcome": found.outcome.kind,
        "says": str(found.outcome),
        "end": found.end,
        "shafts": [
            {"name": name, "peak_torque": peak, "peak_time": at}
            for name, peak, at in zip(found.shafts, found.peak_torque, found.peak_time, strict=True)
        ],
        "disks": [
            {"name": name, "first_speed": first, "last_speed": last}
            for name, first, last in zip(found.disks, found.speed[0], found.speed[-1], strict=True)
        ],
        "crossings": [{"time": at, "name": name} for at, name in found.crossings],
        "energy_error": found.energy.error,
        "findings": output.findings_json(found.findings_in(unit)),
    }

"""The commands ``transient``, ``passing`` and ``capture-map``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import CommandInput, NumberBounds, OptionReader
from trunnion.cli.options import Line, Progress, SpeedUnit
from trunnion.cli.places import CommandOutput
from trunnion.cli.readers import range_of, read_even_axis, read_speed, read_start
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
    speed: Annotated[float | None, OptionReader(read_start)],
    tolerance: Tolerance = 1e-10,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion transient mill.toml --scenario start -o start.png -o start.nc

    --scenario  Name of a [[scenario]] of the file; default: its only one.
    --speed  Input speed at the start, instead of the scenario's.
    """
    found = tn.transient(line, _scenario(line, scenario), speed=speed, tolerance=tolerance, progress=progress)
    return CommandOutput(found, content=lambda: _content(found, unit), outcome=found.outcome)


def _scenario(line: tn.Driveline, named: str) -> str:
    """The scenario that is named, or the only one."""
    known = [one.name for one in line.scenarios]
    if not named and len(known) != 1:
        problem = "is missing" if known else "has none to choose from"
        remedy = f"name one of {', '.join(known)}" if known else "write [[scenario]] in the file"
        raise InputError(problem, key="--scenario", remedy=remedy)
    return named or known[0]


def _acting(line: tn.Driveline, named: str) -> str | None:
    """The same, or none where a motor of the line drives it."""
    driven = not line.scenarios and any(isinstance(one, tn.Motor) for _, one in line.parts)
    return None if driven and not named else _scenario(line, named)


@Command("passing", within=True)
def passing(
    line: Line,
    *,
    from_: Annotated[float, OptionReader(read_start, missing=lambda asked: range_of(asked)[0])],
    to: Annotated[float, OptionReader(read_speed, missing=lambda asked: range_of(asked)[1])],
    scenario: str = "",
    phase: float = 0.0,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion passing mill.toml --scenario start --from 0rpm --to 1400rpm -o passing.png

    --from  First speed; default: of the file's range.
    --to  Last speed; default: of the file's range.
    --scenario  Scenario whose torques and friction act; default: the file's only one.
    --phase RADIANS  Angle of the input at the start.
    """
    acting = _acting(line, scenario)
    found = tn.passing(line, (from_, to), scenario=acting, phase=phase, progress=progress)
    content = {"scenario": acting or "", **found.to_dict()}
    return CommandOutput(found, content=lambda: content, text=lambda: found.describe(unit), outcome=found.outcome)


CELLS = 12
"""Along an axis where none are stated."""
Axis = tuple[str, float, float, int]


def _axis(asked: CommandInput, text: str, key: str) -> Axis:
    """``factor:LOW:HIGH[:CELLS]`` of the drive torque, or a parameter of the line."""
    path, *numbers = text.split(":")
    if path != "factor":
        return read_even_axis(asked, text, key, CELLS)
    try:
        low, high = float(numbers[0]), float(numbers[1])
        count = int(numbers[2]) if numbers[2:] else CELLS
    except (ValueError, IndexError):
        problem = "is not a range of factors"
        raise InputError(problem, key=key, value=text, remedy="write factor:0.5:2:12, say") from None
    return path, low, high, count


@Command("capture map", within=True)
def capture_map(
    line: Line,
    *,
    x: Annotated[Axis, OptionReader(_axis, "HookeJoint *.angle")],
    y: Annotated[Axis, OptionReader(_axis, "factor:0.5:2")],
    from_: Annotated[float, OptionReader(read_start, missing=lambda asked: range_of(asked)[0])],
    to: Annotated[float, OptionReader(read_speed, missing=lambda asked: range_of(asked)[1])],
    scenario: str = "",
    drive: str = "",
    phases: Annotated[int, NumberBounds(1)] = 8,
    processes: Annotated[int, NumberBounds(1)] = 1,
    store: str = "",
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Compute a few cells only, and say how long all would take.")
    ] = False,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion capture-map mill.toml --from 0rpm --to 1400rpm --x "HookeJoint 1.angle:2deg:15deg:10"

    --x PARAMETER:LOW:HIGH[:CELLS]  What varies along x, or factor:LOW:HIGH[:CELLS] of the drive torque.
    --y PARAMETER:LOW:HIGH[:CELLS]  What varies along y, likewise.
    --from  First speed; default: of the file's range.
    --to  Last speed; default: of the file's range.
    --scenario  Scenario whose torques and friction act; default: the file's only one.
    --drive DISK  Disk whose torque the factor scales, where torques act on several.
    --phases  Starting phases of every cell.
    --processes  Number of processes that compute.
    --store FOLDER  Folder for the cells as they are computed; a second call goes on from there.
    """
    acting, driver = _acting(line, scenario), drive or None
    if dry_run:
        cost = tn.capture_map_cost(
            line, (from_, to), x, y, scenario=acting, drive=driver, phases=phases, processes=processes
        )
        return CommandOutput(cost, files=lambda stem: [], save=_nothing_to_draw)
    found = tn.capture_map(
        line, (from_, to), x, y, scenario=acting, drive=driver, phases=phases, processes=processes,
        store=store or None, progress=progress,
    )  # fmt: skip
    return CommandOutput(found.in_unit(unit), outcome=found.outcome)


def _nothing_to_draw(path: Path) -> Path:
    raise InputError("computes no map", key="--dry-run", remedy=f"leave out -o {path.name}, or --dry-run")


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

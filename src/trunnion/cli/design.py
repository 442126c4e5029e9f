"""The commands about a design: what changed and what it did, what to choose, what follows which number."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import (
    REQUIRED,
    CommandInput,
    CommandSubject,
    InputAttribute,
    NumberBounds,
    OptionReader,
)
from trunnion.cli.options import AboutSteadyState, LineOfFile, LoadCase, Progress, SpeedEnds, SpeedUnit, Unit
from trunnion.cli.places import CommandOutput
from trunnion.cli.readers import (
    file_of_line,
    is_number,
    line_of_file,
    place_of_line,
    read_box_range,
    read_line,
    read_speed,
    read_speed_ends,
)
from trunnion.cli.typed import Command
from trunnion.errors import InputError

FREE_EXAMPLE = '--free "Shaft 2.fork_offset:-90deg:90deg"'
Before = Annotated[
    "tn.Driveline",
    typer.Argument(metavar="BEFORE", help="Driveline file (TOML) or a name of the catalogue."),
    CommandSubject(line_of_file, {"unit": Unit}),
]


def _bounds(asked: CommandInput, text: str, key: str) -> tuple[str, tuple[object, object]]:
    """``PARAMETER:LOW:HIGH``, bounds as numbers in SI units or texts with a unit."""
    parts = text.rsplit(":", 2)
    if len(parts) != 3:
        raise InputError("needs two bounds", key=key, value=text, remedy=FREE_EXAMPLE)
    path, *ends = (part.strip() for part in parts)
    low, high = (float(end) if is_number(end) else end for end in ends)
    return path, (low, high)


def _direction(asked: CommandInput, text: str, key: str) -> str:
    from trunnion.design.sensitivity.directions import directions_of
    from trunnion.equations.coefficients import assemble

    directions_of(assemble(asked.line), [text])
    return text


@Command("comparison", unasked=False)
def compare(
    before: Before,
    after: Annotated[str, typer.Argument(metavar="AFTER", help="Driveline file or name to compare it with.")],
    *,
    speed: Annotated[tuple[float, float] | None, OptionReader(read_speed_ends)],
    load_case: LoadCase = None,
    file: Annotated[str, InputAttribute("file")],
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion compare truck.toml truck-stiffer.toml

    --speed LOW:HIGH  Lowest and highest input speed of both; default: the range of each file.
    """
    found = tn.compare(before, read_line(after), speed, load_case=load_case, unit=unit, progress=progress)
    names = (Path(file).stem, Path(after).stem)
    found = replace(found, names=names if names[0] != names[1] else (file, after))
    return CommandOutput(found, table=found.data.drop_dims("change"))


@Command("optimise", within=True)
def optimise(
    line: LineOfFile,
    *,
    free: Annotated[list[Any], OptionReader(_bounds, REQUIRED, several=True)],
    aim: list[str],
    speeds: SpeedEnds,
    checks: bool = True,
    designs: int = 600,
    seed: Annotated[int, NumberBounds(0)] = 0,
    write: Annotated[Path | None, OptionReader(place_of_line)],
    load_case: LoadCase = None,
    file: Annotated[str, InputAttribute("file")],
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Aims: irregularity, growth rate, peak torque of SPRING, vibratory torque of SPRING (smallest); margin of CHECK,
    least spare margin (largest).

    Example: trunnion optimise truck.toml --free "rear tube.fork_offset:-90deg:90deg" --aim irregularity

    --free, -f PARAMETER:LOW:HIGH  A number to choose and its bounds; repeat it for more.
    --aim, -a AIM  What is to be best: "irregularity", "peak torque of Shaft 1"; one or two.
    --checks/--no-checks  Whether limits and ratings of assess must be satisfied.
    --designs  Designs computed in the global search, about.
    --seed  Seed of the search; the same seed gives the same design.
    --write PATH  Write the best design as a driveline file, with the comments of the one given.
    """
    found = tn.optimise(
        line, dict(free), aim, speeds, checks=checks, load_case=load_case, designs=designs, seed=seed, unit=unit,
        progress=progress,
    )  # fmt: skip
    if write is not None:
        tn.dump(found.line, write, comments_of=file_of_line(file))
    return CommandOutput(found, written=[write] if write else [])


@Command()
def sensitivity(
    line: LineOfFile,
    *,
    speed: Annotated[list[float] | None, OptionReader(read_speed, several=True)],
    parameter: Annotated[list[str] | None, OptionReader(_direction, several=True)],
    of: list[str] | None = None,
    check: list[str] | None = None,
    tips: str | None = None,
    draw: str | None = None,
    about_steady_state: AboutSteadyState = False,
    load_case: LoadCase = None,
    asked: Annotated[CommandInput, InputAttribute("itself")],
) -> CommandOutput:
    """Example: trunnion sensitivity truck.toml --speed 1500rpm -p "Shaft *.stiffness" -p "HookeJoint *.angle"

    --speed, -s SPEED  Input speed; repeat it for more; default: the file's.
    --parameter, -p PARAMETER  Number to vary; repeat it for more; default: all of the file.
    --of KIND  frequencies, growth, torques or checks; default: all.
    --check NAME  A check of assess; default: the six with the least margin.
    --tips PARAMETER:LOW:HIGH[:ROWS]  Also the tips of the tongues over the file's speeds.
    --draw QUANTITY  Quantity that the picture shows; default: the first check.
    """
    from trunnion.design.sensitivity.sensitivity import KINDS

    found_tips = _tips(asked, tips, load_case) if tips is not None else None
    with output.progress("sensitivity") as advance:
        found = tn.sensitivity(
            line, speed, parameter, of=of or KINDS, checks=check or None, tips=found_tips, load_case=load_case,
            about_steady_state=about_steady_state, unit=asked.unit, progress=advance,
        )  # fmt: skip
    rows = found.data[["quantity_unit", "kind", "method", "value", "derivative"]]
    return CommandOutput(found, draw=partial(found.plot, draw), table=rows)


def _tips(asked: CommandInput, text: str, load_case: str | None) -> Any:
    if load_case is not None:
        asked = replace(asked, subject=asked.line.with_load(load_case))
    up, rows = read_box_range(asked, text, "--tips")
    across, _ = read_box_range(asked, "speed", "--tips")
    with output.progress("tongues") as advance:
        return tn.tongues(asked.line, across, up, rows=rows, progress=advance)

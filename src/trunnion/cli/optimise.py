"""The command ``optimise``: the best numbers of a file within bounds."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import (
    File,
    Json,
    LoadCase,
    Output,
    SpeedRange,
    Unit,
    is_number,
    read_case,
    read_speed_ends,
)
from trunnion.cli.places import answer, check_places, write_results
from trunnion.errors import InputError

EXAMPLE = '--free "Shaft 2.fork_offset:-90deg:90deg"'


def optimise(
    file: File,
    free: Annotated[
        list[str], typer.Option("--free", "-f", metavar="PARAMETER:LOW:HIGH", help="A number to choose; repeat it.")
    ],
    aim: Annotated[
        list[str],
        typer.Option("--aim", "-a", metavar="AIM", help='As "irregularity", "peak torque of Shaft 1"; one or two.'),
    ],
    speeds: SpeedRange = None,
    checks: Annotated[
        bool, typer.Option("--checks/--no-checks", help="Whether limits and ratings of assess must be satisfied.")
    ] = True,
    designs: Annotated[int, typer.Option("--designs", help="Designs of the search from everywhere.")] = 600,
    seed: Annotated[int, typer.Option("--seed", help="Of the search.", min=0)] = 0,
    best: Annotated[
        Path | None, typer.Option("--write", metavar="PATH", help="Write the best design as a driveline file.")
    ] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """Choose numbers of the file within bounds, for one aim or for two, against its checks.

    Aims: irregularity, growth rate, peak torque of SPRING, vibratory torque of SPRING (smallest); margin of CHECK,
    least spare margin (largest).

    Example: trunnion optimise truck.toml --free "rear tube.fork_offset:-90deg:90deg" --aim irregularity
    """
    line, unit = read_case(file, unit)
    bounds = dict(_bounds(text) for text in free)
    span = read_speed_ends(speeds, unit)
    check_places(to)
    if best is not None and (best.suffix.lower() != ".toml" or not best.parent.is_dir() or best.is_dir()):
        raise InputError("is no place for a driveline file", key="--write", value=str(best), remedy="best.toml, say")
    with output.progress("optimise") as advance:
        found = tn.optimise(
            line, bounds, aim, span, checks=checks, load_case=load_case, designs=designs, seed=seed, unit=unit,
            progress=advance,
        )  # fmt: skip
    written = write_results(to, file, "optimise", found, found.plot)
    if best is not None:
        tn.dump(found.line, best)
        written.append(best)
    answer("optimise", written, as_json, found.to_dict, found.__str__)


def _bounds(text: str) -> tuple[str, tuple[object, object]]:
    """``PARAMETER:LOW:HIGH``, bounds as numbers in SI units or texts with a unit."""
    parts = text.rsplit(":", 2)
    if len(parts) != 3:
        raise InputError("needs two bounds", key="--free", value=text, remedy=EXAMPLE)
    path, *ends = (part.strip() for part in parts)
    low, high = (float(end) if is_number(end) else end for end in ends)
    return path, (low, high)

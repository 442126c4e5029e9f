"""The command ``envelope``: the worst of every check over load cases and schedules."""

from __future__ import annotations

from typing import Annotated

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import File, Json, Output, SpeedRange, Unit, read_case, read_speed_ends
from trunnion.cli.places import check_places, deliver


def envelope(
    file: File,
    speeds: SpeedRange = None,
    points: Annotated[int, typer.Option("--points", help="Of each schedule, beside those it states.")] = 5,
    parameter: Annotated[
        str, typer.Option("--parameter", "-p", metavar="PARAMETER", help="Also its largest stable value everywhere.")
    ] = "",
    unit: Unit = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """The worst of every check over all load cases and schedules of the file, and where it stands.

    Example: trunnion envelope truck.toml -o envelope.png
    """
    line, unit = read_case(file, unit)
    span = read_speed_ends(speeds, unit)
    check_places(to)
    with output.progress("envelope") as advance:
        found = tn.envelope(line, span, points=points, parameter=parameter, unit=unit, progress=advance)
    deliver("envelope", file, found, to, as_json)

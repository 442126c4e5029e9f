"""The command ``envelope``: the worst of every check over load cases and schedules."""

from __future__ import annotations

from typing import Annotated

import typer

from trunnion.cli import output
from trunnion.cli.options import File, Json, Output, Unit, file_stem, read_line, read_speed_ends, read_unit
from trunnion.cli.places import answer, check_places, write_results


def envelope(
    file: File,
    speeds: Annotated[str | None, typer.Option("--speed", metavar="LOW:HIGH", help="Default the file's range.")] = None,
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
    from trunnion.analyses.assessment.envelope import envelope as judge

    line = read_line(file)
    unit = read_unit(line, unit)
    span = read_speed_ends(speeds, unit)
    check_places(to)
    with output.progress("envelope") as advance:
        found = judge(line, span, points=points, parameter=parameter, unit=unit, progress=advance)
    written = write_results(to, file_stem(file), "envelope", found.data, lambda: found.plot())
    answer("envelope", found.to_dict, found.__str__, written, as_json)

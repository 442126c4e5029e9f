"""The command ``compare``: what changed between two files, and what it did."""

from __future__ import annotations

from typing import Annotated

import typer

from trunnion.cli import output
from trunnion.cli.options import Json, LoadCase, Output, Unit, file_stem, read_line, read_speed_ends, read_unit
from trunnion.cli.places import answer, check_places, write_result

Before = Annotated[str, typer.Argument(metavar="BEFORE", help="Driveline file (TOML) or a name of the catalogue.")]
After = Annotated[str, typer.Argument(metavar="AFTER", help="The other one.")]


def compare(
    before: Before,
    after: After,
    speeds: Annotated[
        str | None, typer.Option("--speed", metavar="LOW:HIGH", help="Of both; default the range of each file.")
    ] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """What changed between two files, and what it did to frequencies, stability, torques and checks.

    Example: trunnion compare truck.toml truck-stiffer.toml
    """
    from dataclasses import replace

    from trunnion.analyses.comparison.compare import compare as find

    a, b = read_line(before), read_line(after)
    unit = read_unit(a, unit)
    span = read_speed_ends(speeds, unit)
    if to:
        check_places(to)
    with output.progress("comparison") as advance:
        found = find(a, b, span, load_case=load_case, unit=unit, progress=advance)
    names = (file_stem(before), file_stem(after))
    found = replace(found, names=names if names[0] != names[1] else (before, after))
    data = found.data
    written = [write_result(path, data, lambda: found.plot(), table=data.drop_dims("change")) for path in to or []]
    answer("compare", found.to_dict, found.__str__, written, as_json)

"""The command ``compare``: what changed between two files, and what it did."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import Json, LoadCase, Output, Unit, file_stem, read_case, read_line, read_speed_ends
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
    (a, unit), b = read_case(before, unit), read_line(after)
    span = read_speed_ends(speeds, unit)
    if to:
        check_places(to)
    with output.progress("comparison") as advance:
        found = tn.compare(a, b, span, load_case=load_case, unit=unit, progress=advance)
    names = (file_stem(before), file_stem(after))
    found = replace(found, names=names if names[0] != names[1] else (before, after))
    written = [write_result(path, found, found.plot, found.data.drop_dims("change")) for path in to or []]
    answer("compare", written, as_json, found.to_dict, found.__str__)

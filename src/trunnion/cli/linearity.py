"""The command linearity-check: linear beside nonlinear response at one speed."""

from __future__ import annotations

from typing import Annotated

import typer

from trunnion.cli import output
from trunnion.cli.options import File, Json, LoadCase, Output, Speed, Unit, file_stem, read_line, read_speed, read_unit
from trunnion.cli.places import answer, check_places, write_results


def linearity_check(
    file: File,
    speed: Speed = None,
    allowed: Annotated[
        float, typer.Option("--allowed", help="Difference up to which linear theory holds, of the largest order.")
    ] = 0.05,
    acceleration: Annotated[
        float | None, typer.Option("--acceleration", help="Also run through the speed, in rad/s².")
    ] = None,
    spring: Annotated[
        str | None, typer.Option("--spring", help="Shaft or mesh to draw; default: where the two differ most.")
    ] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """How far linear theory holds at a speed: order-response beside periodic-response, and what misleads it.

    Example: trunnion linearity-check truck.toml --load-case climb --speed "1500 rpm" --acceleration 20
    """
    from trunnion.analyses.motion.linearity_check import linearity_check as compute

    line = read_line(file, load_case)
    unit = read_unit(line, unit)
    check_places(to)
    with output.compile_notice():
        found = compute(line, read_speed(speed, unit), allowed=allowed, acceleration=acceleration)
    found.nonlinear.outcome.require()
    written = write_results(
        to, file_stem(file), "linearity-check", found.data, lambda: found.plot(spring=spring, unit=unit)
    )
    answer("linearity-check", found.to_dict, lambda: found.describe(unit), written, as_json)

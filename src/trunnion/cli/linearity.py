"""The command linearity-check: linear beside nonlinear response at one speed."""

from __future__ import annotations

from typing import Annotated

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import File, Json, LoadCase, Output, Speed, Unit, read_case, read_speed
from trunnion.cli.places import check_places, deliver


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
    line, unit = read_case(file, unit, load_case)
    check_places(to)
    with output.compile_notice():
        found = tn.linearity_check(line, read_speed(speed, unit), allowed=allowed, acceleration=acceleration)
    found.nonlinear.outcome.require()
    deliver(
        "linearity-check", file, found, to, as_json,
        draw=lambda: found.plot(spring=spring, unit=unit), text=lambda: found.describe(unit),
    )  # fmt: skip

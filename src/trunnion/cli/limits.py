"""The commands about limits: tongues, minimum damping, tolerances, sensitivities."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import (
    File,
    Json,
    LoadCase,
    Output,
    Speed,
    SpeedRange,
    Unit,
    read_box_range,
    read_case,
    read_speed,
    read_speed_range,
)
from trunnion.cli.places import check_places, deliver

Margin = Annotated[float, typer.Option("--margin", help="Share by which the speeds are widened, 0.1 for 10 %.")]


def tongues(
    file: File,
    x: Annotated[
        str, typer.Option("--x", metavar="PARAMETER:LOW:HIGH", help="Or PARAMETER for the file's range.")
    ] = "speed",
    y: Annotated[str, typer.Option("--y", metavar="PARAMETER:LOW:HIGH[:ROWS]")] = "HookeJoint *.angle",
    speed: Speed = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """Every instability region in a box of two parameters, as curves with resonance, tip and growth rate.

    Example: trunnion tongues two-shaft-cardan --x speed:0.2rad/s:2rad/s --y "HookeJoint 1.angle:0deg:60deg"
    """
    line, unit = read_case(file, unit, load_case)
    across, _ = read_box_range(x, line, unit, "--x")
    up, rows = read_box_range(y, line, unit, "--y")
    check_places(to)
    with output.progress("tongues") as advance:
        found = tn.tongues(line, across, up, speed=read_speed(speed, unit), rows=rows, progress=advance)
    boundaries = found.data[["of_tongue", "boundary_x", "boundary_y"]]
    deliver(
        "tongues", file, found, to, as_json,
        draw=lambda: found.plot(unit=unit), table=boundaries, text=lambda: found.said_in(unit),
    )  # fmt: skip


def minimum_damping(
    file: File,
    damping: Annotated[
        str | None, typer.Option("--damping", metavar="PARAMETER", help="A damping; default a factor of all.")
    ] = None,
    maximum: Annotated[float, typer.Option("--maximum", help="The largest value of it, SI units.")] = 100.0,
    speeds: SpeedRange = None,
    margin: Margin = 0.0,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """All ranges of damping that keep a range of speeds stable.

    Example: trunnion minimum-damping two-shaft-cardan --speed 1.4:1.8 --maximum 40
    """
    line, unit = read_case(file, unit, load_case)
    if damping is not None:
        tn.pack(line).resolve(damping)
    span = read_speed_range(speeds, line, unit)
    check_places(to)
    with output.progress("minimum damping") as advance:
        found = tn.minimum_damping(line, span, damping=damping, maximum=maximum, margin=margin, progress=advance)
    shown = replace(found, speed_unit=unit)
    deliver("minimum-damping", file, shown, to, as_json, draw=lambda: shown.plot(unit=unit))


def stable_windows(
    file: File,
    parameter: Annotated[
        str, typer.Option("--parameter", "-p", metavar="PARAMETER:LOW:HIGH[:ROWS]", help="Or an angle alone.")
    ] = "HookeJoint *.angle",
    speeds: SpeedRange = None,
    margin: Margin = 0.0,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """All ranges of a parameter, joint angles first, that keep a range of speeds stable.

    Example: trunnion stable-windows two-shaft-cardan -p "HookeJoint 1.angle:0deg:60deg" --speed 1.4:1.8
    """
    line, unit = read_case(file, unit, load_case)
    ends, rows = read_box_range(parameter, line, unit, "--parameter")
    span = read_speed_range(speeds, line, unit)
    check_places(to)
    with output.progress("stable windows") as advance:
        found = tn.stable_windows(line, *ends, span, margin=margin, rows=rows, progress=advance)
    shown = replace(found, speed_unit=unit)
    deliver("stable-windows", file, shown, to, as_json, draw=lambda: shown.plot(unit=unit))

"""The commands about limits: tongues, minimum damping, tolerances, sensitivities."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from trunnion.cli import output
from trunnion.cli.options import (
    File,
    Json,
    LoadCase,
    Output,
    Speed,
    Unit,
    file_stem,
    read_axis,
    read_line,
    read_speed,
    read_speed_ends,
    read_unit,
)
from trunnion.cli.places import answer, check_places, write_results
from trunnion.errors import InputError

if TYPE_CHECKING:
    from trunnion.analyses.tongues.result import Tongues
    from trunnion.analyses.tongues.windows import StableWindows
    from trunnion.equations.coefficients import Assembly

ROWS = 65
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
    from trunnion.analyses.tongues.tongues import tongues as find
    from trunnion.equations.coefficients import assemble

    line = read_line(file, load_case)
    unit = read_unit(line, unit)
    assembly = assemble(line)
    across, _ = read_box_range(x, assembly, unit, "--x")
    up, rows = read_box_range(y, assembly, unit, "--y")
    check_places(to)
    with output.progress("tongues") as advance:
        found = find(assembly, across, up, speed=read_speed(speed, unit), rows=rows, progress=advance)
    written = write_results(
        to, file_stem(file), "tongues", found.data, lambda: found.plot(unit=unit), table=_points(found)
    )
    answer("tongues", found.to_dict, lambda: found.said_in(unit), written, as_json)


def read_box_range(text: str, assembly: Assembly, unit: str, key: str) -> tuple[tuple[object, ...], int]:
    """``PARAMETER:LOW:HIGH[:ROWS]`` as a range and a number of rows."""
    parts = text.split(":")
    if parts[-1].strip() == "log":
        raise InputError("is searched evenly", key=key, value=text, remedy="leave out :log")
    counted = len(parts) > 3 and parts[-1].strip().isdecimal()
    label, low, high, points, *_ = read_axis(
        text if counted or len(parts) < 3 else f"{text}:{ROWS}", assembly, unit, ROWS, key
    )
    assert isinstance(points, int)
    return (label, low, high), points


def _points(found: Tongues) -> Any:
    """Boundary points as a table: number of the tongue, x, y."""
    return found.data[["of_tongue", "boundary_x", "boundary_y"]]


def minimum_damping(
    file: File,
    damping: Annotated[
        str | None, typer.Option("--damping", metavar="PARAMETER", help="A damping; default a factor of all.")
    ] = None,
    maximum: Annotated[float, typer.Option("--maximum", help="The largest value of it, SI units.")] = 100.0,
    speeds: Annotated[str | None, typer.Option("--speed", metavar="LOW:HIGH", help="Default the file's range.")] = None,
    margin: Margin = 0.0,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """All ranges of damping that keep a range of speeds stable.

    Example: trunnion minimum-damping two-shaft-cardan --speed 1.4:1.8 --maximum 40
    """
    from trunnion.analyses.tongues.windows import minimum_damping as find
    from trunnion.equations.coefficients import assemble

    line = read_line(file, load_case)
    unit = read_unit(line, unit)
    assembly = assemble(line)
    if damping is not None:
        assembly.packed.resolve(damping)
    span = read_speed_range(speeds, assembly, unit)
    check_places(to)
    with output.progress("minimum damping") as advance:
        found = find(assembly, span, damping=damping, maximum=maximum, margin=margin, progress=advance)
    _say_windows("minimum-damping", file, found, unit, to, as_json)


def stable_windows(
    file: File,
    parameter: Annotated[
        str, typer.Option("--parameter", "-p", metavar="PARAMETER:LOW:HIGH[:ROWS]", help="Or an angle alone.")
    ] = "HookeJoint *.angle",
    speeds: Annotated[str | None, typer.Option("--speed", metavar="LOW:HIGH", help="Default the file's range.")] = None,
    margin: Margin = 0.0,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """All ranges of a parameter, joint angles first, that keep a range of speeds stable.

    Example: trunnion stable-windows two-shaft-cardan -p "HookeJoint 1.angle:0deg:60deg" --speed 1.4:1.8
    """
    from trunnion.analyses.tongues.windows import stable_windows as find
    from trunnion.equations.coefficients import assemble

    line = read_line(file, load_case)
    unit = read_unit(line, unit)
    assembly = assemble(line)
    (label, low, high), rows = read_box_range(parameter, assembly, unit, "--parameter")
    assert isinstance(label, str) and isinstance(low, float) and isinstance(high, float)
    span = read_speed_range(speeds, assembly, unit)
    check_places(to)
    with output.progress("stable windows") as advance:
        found = find(assembly, label, low, high, span, margin=margin, rows=rows, progress=advance)
    _say_windows("stable-windows", file, found, unit, to, as_json)


def read_speed_range(text: str | None, assembly: Assembly, unit: str) -> tuple[float, float]:
    """``LOW:HIGH`` in rad/s, or the file's range."""
    from trunnion.reporting.ranges import speed_range

    return read_speed_ends(text, unit) or speed_range(assembly)


def _say_windows(
    command: str, file: str, found: StableWindows, unit: str, to: list[Path] | None, as_json: bool
) -> None:
    shown = replace(found, speed_unit=unit)
    written = write_results(to, file_stem(file), command, shown.data, lambda: shown.plot(unit=unit))
    answer(command, shown.to_dict, shown.__str__, written, as_json)

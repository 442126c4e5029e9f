"""The command ``sensitivity``: what the line's frequencies, stability, torques and checks follow."""

from __future__ import annotations

from typing import Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import File, Json, LoadCase, Output, Unit, read_box_range, read_case, read_speed
from trunnion.cli.places import check_places, deliver


def sensitivity(
    file: File,
    speeds: Annotated[
        list[str] | None, typer.Option("--speed", "-s", metavar="SPEED", help="Repeat it for more; default the file's.")
    ] = None,
    parameters: Annotated[
        list[str] | None,
        typer.Option("--parameter", "-p", metavar="PARAMETER", help="Repeat it for more; default all of the file."),
    ] = None,
    of: Annotated[
        list[str] | None,
        typer.Option("--of", metavar="KIND", help="frequencies, growth, torques or checks; default all."),
    ] = None,
    check: Annotated[
        list[str] | None, typer.Option("--check", metavar="NAME", help="A check of assess; default the tightest six.")
    ] = None,
    tips: Annotated[
        str | None,
        typer.Option("--tips", metavar="PARAMETER:LOW:HIGH[:ROWS]", help="Tips of tongues over the file's speeds."),
    ] = None,
    draw: Annotated[
        str | None, typer.Option("--draw", metavar="QUANTITY", help="What the picture shows; default the first check.")
    ] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """Derivatives of frequencies, growth rates, torques and checks by the numbers of the file, ranked.

    Example: trunnion sensitivity truck.toml --speed 1500rpm -p "Shaft *.stiffness" -p "HookeJoint *.angle"
    """
    from trunnion.analyses.sensitivity.directions import directions_of
    from trunnion.analyses.sensitivity.sensitivity import KINDS
    from trunnion.equations.coefficients import assemble

    line, unit = read_case(file, unit)
    if parameters:
        directions_of(assemble(line), parameters)
    at = [read_speed(text, unit) for text in speeds] if speeds else None
    check_places(to)
    found_tips = _tips(line, tips, unit, load_case) if tips is not None else None
    with output.progress("sensitivity") as advance:
        found = tn.sensitivity(
            line, at, parameters or None, of=of or KINDS, checks=check or None, tips=found_tips,  # type: ignore[arg-type]
            load_case=load_case, unit=unit, progress=advance,
        )  # fmt: skip
    rows = found.data[["quantity_unit", "kind", "method", "value", "derivative"]]
    deliver("sensitivity", file, found, to, as_json, draw=lambda: found.plot(draw), table=rows)


def _tips(line: tn.Driveline, text: str, unit: str, load_case: str | None) -> Any:
    if load_case is not None:
        line = line.with_load(load_case)
    up, rows = read_box_range(text, line, unit, "--tips")
    across, _ = read_box_range("speed", line, unit, "--tips")
    with output.progress("tongues") as advance:
        return tn.tongues(line, across, up, rows=rows, progress=advance)

"""The command ``sensitivity``: what the line's frequencies, stability, torques and checks follow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from trunnion.cli import output
from trunnion.cli.limits import read_box_range
from trunnion.cli.options import File, Json, LoadCase, Output, Unit, file_stem, read_line, read_speed, read_unit
from trunnion.cli.places import answer, check_places, write_results

if TYPE_CHECKING:
    from trunnion.analyses.tongues.result import Tongues
    from trunnion.driveline.driveline import Driveline


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
    from trunnion.analyses.sensitivity.sensitivity import sensitivity as find
    from trunnion.equations.coefficients import assemble

    line = read_line(file)
    unit = read_unit(line, unit)
    if parameters:
        directions_of(assemble(line), parameters)
    at = [read_speed(text, unit) for text in speeds] if speeds else None
    check_places(to)
    found_tips = _tips(line, tips, unit, load_case) if tips is not None else None
    with output.progress("sensitivity") as advance:
        found = find(
            line, at, parameters or None, of=of or KINDS, checks=check or None, tips=found_tips,  # type: ignore[arg-type]
            load_case=load_case, unit=unit, progress=advance,
        )  # fmt: skip
    written = write_results(
        to, file_stem(file), "sensitivity", found.data, lambda: found.plot(draw), table=_table(found.data)
    )
    answer("sensitivity", found.to_dict, found.__str__, written, as_json)


def _tips(line: Driveline, text: str, unit: str, load_case: str | None) -> Tongues:
    from trunnion.analyses.tongues.tongues import tongues
    from trunnion.equations.coefficients import assemble

    assembly = assemble(line if load_case is None else line.with_load(load_case))
    up, rows = read_box_range(text, assembly, unit, "--tips")
    across, _ = read_box_range("speed", assembly, unit, "--tips")
    with output.progress("tongues") as advance:
        return tongues(assembly, across, up, rows=rows, progress=advance)


def _table(data: Any) -> Any:
    """Derivatives as a table: a row for every quantity."""
    return data[["quantity_unit", "kind", "method", "value", "derivative"]]

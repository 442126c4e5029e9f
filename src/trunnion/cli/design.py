"""The commands about a design: what changed and what it did, what to choose, what follows which number."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import (
    File,
    Json,
    LoadCase,
    Output,
    SpeedRange,
    Unit,
    Within,
    file_stem,
    is_number,
    read_box_range,
    read_case,
    read_line,
    read_speed,
    read_speed_ends,
)
from trunnion.cli.places import answer, check_places, deliver, write_result, write_results
from trunnion.errors import InputError

FREE_EXAMPLE = '--free "Shaft 2.fork_offset:-90deg:90deg"'
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


def optimise(
    file: File,
    free: Annotated[
        list[str], typer.Option("--free", "-f", metavar="PARAMETER:LOW:HIGH", help="A number to choose; repeat it.")
    ],
    aim: Annotated[
        list[str],
        typer.Option("--aim", "-a", metavar="AIM", help='As "irregularity", "peak torque of Shaft 1"; one or two.'),
    ],
    speeds: SpeedRange = None,
    checks: Annotated[
        bool, typer.Option("--checks/--no-checks", help="Whether limits and ratings of assess must be satisfied.")
    ] = True,
    designs: Annotated[int, typer.Option("--designs", help="Designs of the search from everywhere.")] = 600,
    seed: Annotated[int, typer.Option("--seed", help="Of the search.", min=0)] = 0,
    best: Annotated[
        Path | None, typer.Option("--write", metavar="PATH", help="Write the best design as a driveline file.")
    ] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    within: Within = None,
    as_json: Json = False,
) -> None:
    """Choose numbers of the file within bounds, for one aim or for two, against its checks.

    Aims: irregularity, growth rate, peak torque of SPRING, vibratory torque of SPRING (smallest); margin of CHECK,
    least spare margin (largest).

    Example: trunnion optimise truck.toml --free "rear tube.fork_offset:-90deg:90deg" --aim irregularity
    """
    line, unit = read_case(file, unit)
    bounds = dict(_bounds(text) for text in free)
    span = read_speed_ends(speeds, unit)
    check_places(to)
    if best is not None and (best.suffix.lower() != ".toml" or not best.parent.is_dir() or best.is_dir()):
        raise InputError("is no place for a driveline file", key="--write", value=str(best), remedy="best.toml, say")
    with output.progress("optimise", within) as advance:
        found = tn.optimise(
            line, bounds, aim, span, checks=checks, load_case=load_case, designs=designs, seed=seed, unit=unit,
            progress=advance,
        )  # fmt: skip
    written = write_results(to, file, "optimise", found, found.plot)
    if best is not None:
        tn.dump(found.line, best)
        written.append(best)
    answer("optimise", written, as_json, found.to_dict, found.__str__)


def _bounds(text: str) -> tuple[str, tuple[object, object]]:
    """``PARAMETER:LOW:HIGH``, bounds as numbers in SI units or texts with a unit."""
    parts = text.rsplit(":", 2)
    if len(parts) != 3:
        raise InputError("needs two bounds", key="--free", value=text, remedy=FREE_EXAMPLE)
    path, *ends = (part.strip() for part in parts)
    low, high = (float(end) if is_number(end) else end for end in ends)
    return path, (low, high)


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
    from trunnion.design.sensitivity.directions import directions_of
    from trunnion.design.sensitivity.sensitivity import KINDS
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

"""The commands about limits: tongues, stable windows, minimum damping, tolerances and proofs."""

from __future__ import annotations

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
    Within,
    read_box_range,
    read_case,
    read_speed,
    read_speed_range,
)
from trunnion.cli.places import PICTURES_AND_DATA, check_places, deliver
from trunnion.errors import InputError

TOLERANCE_EXAMPLE = '--tolerance "Shaft 1.stiffness=10%", or "=normal 3%"'
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
        found = tn.tongues(line, across, up, speed=read_speed(speed, unit), rows=rows, progress=advance).in_unit(unit)
    boundaries = found.data[["of_tongue", "boundary_x", "boundary_y"]]
    deliver("tongues", file, found, to, as_json, draw=lambda: found.plot(unit=unit), table=boundaries)


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
    within: Within = None,
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
    with output.progress("minimum damping", within) as advance:
        found = tn.minimum_damping(line, span, damping=damping, maximum=maximum, margin=margin, progress=advance)
    shown = found.in_unit(unit)
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
    within: Within = None,
    as_json: Json = False,
) -> None:
    """All ranges of a parameter, joint angles first, that keep a range of speeds stable.

    Example: trunnion stable-windows two-shaft-cardan -p "HookeJoint 1.angle:0deg:60deg" --speed 1.4:1.8
    """
    line, unit = read_case(file, unit, load_case)
    ends, rows = read_box_range(parameter, line, unit, "--parameter")
    span = read_speed_range(speeds, line, unit)
    check_places(to)
    with output.progress("stable windows", within) as advance:
        found = tn.stable_windows(line, *ends, span, margin=margin, rows=rows, progress=advance)
    shown = found.in_unit(unit)
    deliver("stable-windows", file, shown, to, as_json, draw=lambda: shown.plot(unit=unit))


def tolerance_study(
    file: File,
    tolerance: Annotated[
        list[str] | None,
        typer.Option(
            "--tolerance",
            "-t",
            metavar="PARAMETER=SHARE",
            help='As "Shaft 1.stiffness=10%" or "…=normal 3%"; default those of the file.',
        ),
    ] = None,
    speeds: Annotated[
        list[str] | None, typer.Option("--speed", metavar="SPEED", help="Repeat it for more; default the file's.")
    ] = None,
    checks: Annotated[
        int, typer.Option("--checks", help="Lines judged by every check too; -1 for as many as half a minute allows.")
    ] = 0,
    samples: Annotated[int, typer.Option("--samples", help="Lines in all.")] = 1 << 14,
    seed: Annotated[int, typer.Option("--seed", help="Of the random scrambles.", min=0)] = 0,
    unit: Unit = None,
    load_case: LoadCase = None,
    to: Output = None,
    within: Within = None,
    as_json: Json = False,
) -> None:
    """The probability that the line is stable within its tolerances, its worst corner, and what matters.

    Example: trunnion tolerance-study truck.toml -t "Shaft *.stiffness=10%" -t "HookeJoint 1.angle=5%" --speed 1500rpm
    """
    from trunnion.driveline.operating_speed import operating_speed

    line, unit = read_case(file, unit, load_case)
    given = _tolerances(tolerance)
    asked = [read_speed(text, unit) for text in speeds] if speeds else [None]
    at = [operating_speed(line, one) for one in asked]
    check_places(to)
    with output.progress("tolerance study", within) as advance:
        counted = True if checks < 0 else checks
        found = tn.tolerance_study(line, given, at, checks=counted, samples=samples, seed=seed, progress=advance)
    deliver("tolerance-study", file, found.in_unit(unit), to, as_json)


def _tolerances(texts: list[str] | None) -> dict[str, object] | None:
    return dict(map(_tolerance, texts)) if texts else None


def _tolerance(text: str) -> tuple[str, object]:
    """``PARAMETER=10%``, ``PARAMETER=0.1`` or ``PARAMETER=normal 3%``."""
    path, equals, given = text.rpartition("=")
    kind, _, number = given.strip().rpartition(" ")
    try:
        share = float(number.removesuffix("%")) / (100 if number.endswith("%") else 1)
    except ValueError:
        share = 0.0
    if not equals or not path or kind not in ("", "normal") or not 0 < share < 1:
        raise InputError("is no tolerance", key="--tolerance", value=text, remedy=TOLERANCE_EXAMPLE)
    return path.strip(), ("normal", share) if kind else share


def certify_stability(
    file: File,
    tolerance: Annotated[
        list[str] | None,
        typer.Option(
            "--tolerance",
            "-t",
            metavar="PARAMETER=SHARE",
            help='As "Shaft 1.stiffness=1%"; default those of the file.',
        ),
    ] = None,
    speeds: SpeedRange = None,
    boxes: Annotated[int, typer.Option("--boxes", help="Boxes judged before the rest is left undecided.")] = 20_000,
    unit: Unit = None,
    to: Output = None,
    within: Within = None,
    as_json: Json = False,
) -> None:
    """Prove that no line within its tolerances is unstable in a range of speeds, or find one that is.

    Example: trunnion certify-stability two-shaft-cardan -t "Shaft 1.stiffness=1%" --speed 1.2:1.4
    """
    line, unit = read_case(file, unit)
    given, span = _tolerances(tolerance), read_speed_range(speeds, line, unit)
    check_places(to, PICTURES_AND_DATA)
    with output.progress("certificate", within) as advance:
        found = tn.certify_stability(line, given, span, most_boxes=boxes, progress=advance)
    deliver("certify-stability", file, found.in_unit(unit), to, as_json, what="certificate")

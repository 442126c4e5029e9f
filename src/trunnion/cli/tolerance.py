"""The commands about tolerances: how probable stability is, and a proof of it."""

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
    SpeedRange,
    Unit,
    read_case,
    read_speed,
    read_speed_range,
)
from trunnion.cli.places import PICTURES_AND_DATA, check_places, deliver
from trunnion.errors import InputError

EXAMPLE = '--tolerance "Shaft 1.stiffness=10%", or "=normal 3%"'


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
    with output.progress("tolerance study") as advance:
        counted = True if checks < 0 else checks
        found = tn.tolerance_study(line, given, at, checks=counted, samples=samples, seed=seed, progress=advance)
    deliver("tolerance-study", file, replace(found, unit=unit), to, as_json)


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
        raise InputError("is no tolerance", key="--tolerance", value=text, remedy=EXAMPLE)
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
    as_json: Json = False,
) -> None:
    """Prove that no line within its tolerances is unstable in a range of speeds, or find one that is.

    Example: trunnion certify-stability two-shaft-cardan -t "Shaft 1.stiffness=1%" --speed 1.2:1.4
    """
    line, unit = read_case(file, unit)
    given, span = _tolerances(tolerance), read_speed_range(speeds, line, unit)
    check_places(to, PICTURES_AND_DATA)
    with output.progress("certificate") as advance:
        found = tn.certify_stability(line, given, span, most_boxes=boxes, progress=advance)
    deliver("certify-stability", file, replace(found, unit=unit), to, as_json, what="certificate")

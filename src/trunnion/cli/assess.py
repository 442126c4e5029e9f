"""The commands ``assess``, ``campbell-diagram`` and ``envelope``: is the line fit for its speeds and loads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import File, Json, LoadCase, Output, SpeedRange, Unit, Within, read_case, read_speed_ends
from trunnion.cli.places import check_places, deliver

if TYPE_CHECKING:
    from trunnion.design.assessment.result import Assessment
    from trunnion.design.remedies.result import Remedies

CHECK = (
    "name status decides margin required_margin value error limit unit speed because barred covered "
    "rule.formula rule.source rule.certainty inputs load_case guideline element"
)
REMEDY = "check variable before after unit value margin required_margin verdict sentence"
"""What answers have of each."""
DIAGRAM_POINTS = 201
"""Speeds at which the modes of a diagram are computed."""


def assess(
    file: File,
    unit: Unit = None,
    load_case: LoadCase = None,
    remedies: Annotated[
        bool, typer.Option("--remedies", help="What would help: the smallest single changes for what is exceeded.")
    ] = False,
    within: Within = None,
    as_json: Json = False,
) -> None:
    """Judge every limit of the file and every rule that applies, over its speed range; the binding one first."""
    line, unit = read_case(file, unit)
    helping = None
    if remedies:
        with output.progress("remedies", within) as advance:
            helping = tn.remedies(line, load_case=load_case, unit=unit, progress=advance)
            result = helping.assessment
    else:
        with output.progress("assessment", within):
            result = tn.assess(line, load_case=load_case, unit=unit)
    if as_json:
        output.write_json("assess", assessment_json(result) | (remedies_json(helping) if helping else {}))
        return
    print_assessment(result)
    if helping is not None:
        print_remedies(helping)


def campbell_diagram(
    file: File,
    unit: Unit = None,
    load_case: LoadCase = None,
    picture: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="PATH", help="Picture ending in .png, .pdf or .svg.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Modes of the loaded line over its speed range, what excites them, and where the two meet."""
    line, unit = read_case(file, unit, load_case)
    import numpy as np

    from trunnion.plots.formats import check_format
    from trunnion.reporting.ranges import speed_range

    if picture is not None:
        check_format(picture)
    result = tn.campbell_diagram(line, np.linspace(*speed_range(line), DIAGRAM_POINTS))
    if picture is not None:
        from trunnion.plots.style import save

        save(result.plot(unit=unit, operating=line.operation).figure.figure, picture)
    if as_json:
        output.write_json("campbell-diagram", result.to_dict())
        return
    output.say(result.describe(unit))
    if picture is not None:
        output.say(f"  written: {picture}")


def envelope(
    file: File,
    speeds: SpeedRange = None,
    points: Annotated[int, typer.Option("--points", help="Of each schedule, beside those it states.")] = 5,
    parameter: Annotated[
        str, typer.Option("--parameter", "-p", metavar="PARAMETER", help="Also its largest stable value everywhere.")
    ] = "",
    unit: Unit = None,
    to: Output = None,
    as_json: Json = False,
) -> None:
    """The worst of every check over all load cases and schedules of the file, and where it stands.

    Example: trunnion envelope truck.toml -o envelope.png
    """
    line, unit = read_case(file, unit)
    span = read_speed_ends(speeds, unit)
    check_places(to)
    with output.progress("envelope") as advance:
        found = tn.envelope(line, span, points=points, parameter=parameter, unit=unit, progress=advance)
    deliver("envelope", file, found, to, as_json)


def print_assessment(result: Assessment) -> None:
    """The verdict, the table of checks, and the rules that they stand on."""
    output.say(result.sentence, style="bold")
    rows = result.table()
    output.table([{k: v for k, v in row.items() if k != "because"} for row in rows], "Checks, the binding one first")
    output.heading("Because")
    for row in rows:
        output.say(f"  {row['check']}: {row['because']}")
    output.heading("Rules")
    for rule, inputs in dict.fromkeys((c.rule, c.inputs) for c in result.checks if c.margin == c.margin):
        said = f"  {rule.name}: {rule.formula}: {rule.source} ({rule.certainty})"
        output.say(said + (f"; {inputs}" if inputs else ""))
    output.say(f"  {result.rests_on}", wrap=True)
    if result.switched_off:
        output.heading("Switched off")
        for one in result.switched_off:
            output.say(f"  {one}")
    if result.findings:
        output.findings(result.findings)


def print_remedies(found: Remedies) -> None:
    """What would help, and what each check follows most."""
    output.heading("What would help")
    for sentence in (*found.sentences, *(s for check in found.checks for s in found.sensitivity_sentences(check))):
        output.say(f"  {sentence}")


def remedies_json(found: Remedies) -> dict[str, Any]:
    """Remedies by check, and how each value follows every design variable; angles per radian."""
    return {
        "remedies": [output.record(r, REMEDY) for r in found.remedies],
        "closest": found.closest,
        "sensitivities": {
            check: {v.path: s for v, s in zip(found.variables, row, strict=True)}
            for check, row in zip(found.checks, found.sensitivity, strict=True)
        },
    }


def assessment_json(result: Assessment) -> dict[str, Any]:
    """Verdict and checks; speeds in ``speed_unit``, values and limits in the SI unit of each check."""
    words = result.words
    return {
        **output.record(result, "verdict sentence barred application", words),
        "speed_unit": result.unit,
        "speed_range": [end * words.factor for end in (result.low, result.high)],
        "switched_off": [output.record(one, "rule reason") for one in result.switched_off],
        "checks": [
            {
                **output.record(c, CHECK, words),
                "rule": c.rule.name,
                "order": c.cause.order if c.cause else None,
                "mode": c.cause.mode if c.cause and c.cause.mode else None,
            }
            for c in result.checks
        ],
        "findings": [str(f) for f in result.findings],
    }

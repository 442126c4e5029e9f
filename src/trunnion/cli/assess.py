"""The commands ``assess``, ``campbell-diagram`` and ``envelope``: is the line fit for its speeds and loads."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import Line, LineOfFile, LoadCase, Progress, SpeedEnds, SpeedUnit
from trunnion.cli.places import NOTHING, CommandOutput
from trunnion.cli.typed import Command

if TYPE_CHECKING:
    from trunnion.design.assessment.result import Assessment
    from trunnion.design.remedies.result import Remedies

CHECK = (
    "name status proof decides margin required_margin value bound error limit unit speed because barred covered "
    "rule.formula rule.source rule.certainty inputs load_case guideline element"
)
REMEDY = "check variable before after unit value margin required_margin verdict sentence"
"""What answers have of each."""
DIAGRAM_POINTS = 201
"""Speeds at which the modes of a diagram are computed."""


@Command("assessment", writes=NOTHING, within=True)
def assess(
    line: LineOfFile,
    *,
    load_case: LoadCase = None,
    remedies: bool = False,
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion assess truck.toml --load-case climb --remedies

    --remedies  Also search for what would help: the smallest single changes for what is exceeded.
    """
    helping = tn.remedies(line, load_case=load_case, unit=unit, progress=progress) if remedies else None
    result = helping.assessment if helping else tn.assess(line, load_case=load_case, unit=unit)

    def more() -> None:
        print_assessment(result)
        if helping is not None:
            print_remedies(helping)

    return CommandOutput(
        result, content=lambda: assessment_json(result) | (remedies_json(helping) if helping else {}),
        text=lambda: result.sentence, style="bold", more=more,
    )  # fmt: skip


@Command("campbell-diagram")
def campbell_diagram(line: Line, *, unit: SpeedUnit) -> CommandOutput:
    """Example: trunnion campbell-diagram truck.toml --load-case climb -o campbell.png"""
    import numpy as np

    from trunnion.reporting.ranges import diagram_range, speed_range

    result = tn.campbell_diagram(line, np.linspace(*diagram_range(*speed_range(line)), DIAGRAM_POINTS))
    return CommandOutput(result, draw=partial(result.plot, operating=line.operation))


@Command("envelope")
def envelope(
    line: LineOfFile,
    *,
    speeds: SpeedEnds,
    points: int = 5,
    parameter: str = "",
    unit: SpeedUnit,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion envelope truck.toml -o envelope.png

    --points  Points of each schedule, beside those it states.
    --parameter, -p PARAMETER  Also find its largest stable value at every point.
    """
    return CommandOutput(tn.envelope(line, speeds, points=points, parameter=parameter, unit=unit, progress=progress))


def print_assessment(result: Assessment) -> None:
    """The table of checks below the verdict, and the rules that they stand on."""
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
                **({"order_frequency": c.cause.frequency} if c.cause and c.cause.frequency else {}),
                "mode": c.cause.mode if c.cause and c.cause.mode else None,
            }
            for c in result.checks
        ],
        "findings": [str(f) for f in result.findings],
    }

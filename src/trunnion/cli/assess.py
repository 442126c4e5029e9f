"""The commands ``assess`` and ``campbell-diagram``: is the line fit for its speeds, what meets which mode."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from trunnion.cli import output
from trunnion.cli.options import File, Json, LoadCase, Unit, read_line, read_unit
from trunnion.results.speeds import speed_factor

if TYPE_CHECKING:
    from rich.console import Console

    from trunnion.analyses.assessment.remedies.result import Remedies
    from trunnion.analyses.assessment.result import Assessment
    from trunnion.driveline.driveline import Driveline

DIAGRAM_POINTS = 201
"""Speeds at which the modes of a diagram are computed."""


def assess(
    file: File,
    unit: Unit = None,
    load_case: LoadCase = None,
    remedies: Annotated[
        bool, typer.Option("--remedies", help="What would help: the smallest single changes for what is exceeded.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Judge every limit of the file and every rule that applies, over its speed range; the binding one first."""
    line = read_line(file)
    unit = read_unit(line, unit)
    helping = _helping(line, load_case, unit) if remedies else None
    if helping is not None:
        result = helping.assessment
    else:
        from trunnion.analyses.assessment.assess import assess as judge

        with output.compile_notice():
            result = judge(line, load_case=load_case, unit=unit)
    if as_json:
        output.write_json("assess", assessment_json(result) | (remedies_json(helping) if helping else {}))
        return
    out = output.console()
    print_assessment(out, result)
    if helping is not None:
        print_remedies(out, helping)


def _helping(line: Driveline, load_case: str | None, unit: str) -> Remedies:
    from trunnion.analyses.assessment.remedies.remedies import remedies as look

    with output.progress("remedies") as advance:
        return look(line, load_case=load_case, unit=unit, progress=advance)


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
    import numpy as np

    from trunnion.equations.coefficients import assemble

    line = read_line(file, load_case)
    unit = read_unit(line, unit)
    from trunnion.analyses.linear.campbell_diagram import campbell_diagram as diagram
    from trunnion.plots.style import check_format, save
    from trunnion.reporting.ranges import speed_range

    if picture is not None:
        check_format(picture)
    assembly = assemble(line)
    result = diagram(assembly, np.linspace(*speed_range(assembly), DIAGRAM_POINTS))
    if picture is not None:
        save(result.plot(unit=unit, operating=line.operation).figure.figure, picture)
    if as_json:
        output.write_json("campbell-diagram", result.to_dict())
        return
    out = output.console()
    out.print(result.describe(unit), soft_wrap=True)
    if picture is not None:
        out.print(f"  written: {picture}", soft_wrap=True)


def print_assessment(out: Console, result: Assessment) -> None:
    """The verdict, the table of checks, and the rules that they stand on."""
    out.print(result.sentence, style="bold", soft_wrap=True)
    output.heading(out, "Checks, the binding one first")
    rows = result.table()
    output.table(out, [{k: v for k, v in row.items() if k != "because"} for row in rows])
    output.heading(out, "Because")
    for row in rows:
        out.print(f"  {row['check']}: {row['because']}", soft_wrap=True)
    output.heading(out, "Rules")
    rules = dict.fromkeys((c.rule, c.inputs) for c in result.checks if c.margin == c.margin)
    for rule, inputs in rules:
        out.print(
            f"  {rule.formula}: {rule.source} ({rule.certainty})" + (f"; {inputs}" if inputs else ""), soft_wrap=True
        )
    if result.findings:
        output.heading(out, "Findings")
        output.findings(out, result.findings)


def print_remedies(out: Console, found: Remedies) -> None:
    """What would help, and what each check follows most."""
    output.heading(out, "What would help")
    for sentence in (*found.sentences, *(s for check in found.checks for s in found.sensitivity_sentences(check))):
        out.print(f"  {sentence}", soft_wrap=True)


def remedies_json(found: Remedies) -> dict[str, Any]:
    """Remedies by check, and how each value follows every design variable; angles per radian."""
    return {
        "remedies": [
            {
                "check": r.check,
                "variable": r.variable,
                "before": r.before,
                "after": r.after,
                "unit": r.unit,
                "value": r.value,
                "margin": r.margin,
                "required_margin": r.required_margin,
                "verdict": str(r.verdict),
                "sentence": r.sentence,
            }
            for r in found.remedies
        ],
        "closest": found.closest,
        "sensitivities": {
            check: {v.path: s for v, s in zip(found.variables, row, strict=True)}
            for check, row in zip(found.checks, found.sensitivity, strict=True)
        },
    }


def assessment_json(result: Assessment) -> dict[str, Any]:
    """Verdict and checks; speeds in ``speed_unit``, values and limits in the SI unit of each check."""
    factor = speed_factor(result.unit)
    return {
        "verdict": str(result.verdict),
        "sentence": result.sentence,
        "speed_unit": result.unit,
        "speed_range": [result.low * factor, result.high * factor],
        "barred": [[a * factor, b * factor] for a, b in result.barred],
        "checks": [
            {
                "name": c.name,
                "status": str(c.status),
                "margin": c.margin,
                "required_margin": c.required_margin,
                "value": c.value,
                "limit": c.limit,
                "unit": c.unit,
                "speed": c.speed * factor,
                "because": c.because,
                "barred": [[a * factor, b * factor] for a, b in c.barred],
                "formula": c.rule.formula,
                "source": c.rule.source,
                "certainty": c.rule.certainty,
                "inputs": c.inputs,
                "load_case": c.load_case,
                "guideline": c.guideline,
                "element": c.element,
                "order": c.cause.order if c.cause else None,
                "mode": c.cause.mode if c.cause and c.cause.mode else None,
            }
            for c in result.checks
        ],
        "findings": [str(f) for f in result.findings],
    }

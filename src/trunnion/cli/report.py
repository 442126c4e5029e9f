"""Results as text for the terminal and as plain values for JSON, speeds in the unit asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.cli import output
from trunnion.cli.assess import assessment_json
from trunnion.cli.kinetostatics import kinetostatics_json
from trunnion.results.counts import counted
from trunnion.results.units import with_error
from trunnion.results.verdict import Verdict
from trunnion.results.words import Words

if TYPE_CHECKING:
    from trunnion.floquet.stability.stability import Stability
    from trunnion.modes.natural_frequencies import NaturalFrequencies
    from trunnion.modes.resonance_speeds import ResonanceSpeeds
    from trunnion.reporting.overview import Overview
    from trunnion.reporting.overview_assessment import AssessableLine, AssessedLine, OverviewAssessment
    from trunnion.results.chart import StabilityChart

MOST_ROWS = 24
"""Resonances that an overview prints."""


def print_begin(given: AssessableLine) -> None:
    """What is about to be judged: the verdict of a long line takes some seconds."""
    span = Words(given.unit).over(*given.speed_range)
    said = [counted(len(given.line.elements), "element"), f"judged {span}"]
    if given.line.operation and (cases := given.line.operation.load_cases):
        said.append(f"as it is and under {counted(len(cases), 'load case')}")
    output.say(f"{given.line.name or 'driveline'}: {', '.join(said)}", wrap=True)


def print_judged(given: AssessedLine) -> None:
    """The verdict and the checks: what is known first."""
    from trunnion.design.assessment.check import Status

    judged = given.assessment
    output.say(f"{given.line.name or 'driveline'}: {judged.sentence}", style="bold")
    output.heading(f"Checks {Words(given.unit).over(*given.speed_range)}")
    rows = [r for r, c in zip(judged.table(), judged.checks, strict=True) if c.status is not Status.NOT_APPLICABLE]
    output.table([{k: v for k, v in row.items() if k != "because"} for row in rows])
    for one in judged.switched_off:
        output.say(f"  switched off: {one}")


def print_findings(given: OverviewAssessment) -> None:
    """What follows from the verdict, before anything is drawn."""
    output.findings(given.findings)
    output.say("\ntrunnion assess gives the reasons and rules of every check", wrap=True)


def print_overview(seen: Overview, given: OverviewAssessment) -> None:
    """What follows the answer: modes, resonance speeds, the joints, stability at one speed, the chart."""
    unit, words = seen.unit, Words(seen.unit)
    output.heading("Driveline")
    output.say(str(seen.line))
    modes = seen.natural_frequencies.table(seen.natural_frequencies.words.of_frequencies.of_speeds)
    output.table(modes, "Natural frequencies, all joints straight")
    span = words.over(*seen.speed_range)
    able = [row for row, r in zip(seen.resonance_speeds.table(unit), seen.resonance_speeds, strict=True) if r.opens]
    output.heading(f"Resonance speeds {span} at which instability can begin: {len(able) or 'none'}")
    output.table([{k: v for k, v in row.items() if k != "instability can begin"} for row in able[:MOST_ROWS]])
    if len(able) > MOST_ROWS:
        output.say(f"  and {len(able) - MOST_ROWS} more; see trunnion resonance-speeds", wrap=True)
    if seen.turn is not None and seen.turn.joints:
        output.heading("One turn of the joints")
        output.say(seen.turn.describe(unit))
    if seen.stability is not None:
        output.heading(f"Stability at {words.speed(seen.stability.speed)}")
        output.say(seen.stability.describe(unit), wrap=True)
    if seen.chart is not None:
        output.heading("Stability chart, all joints at one angle")
        output.say(chart_text(seen.chart, unit), wrap=True)
    known = set(given.findings)
    if more := [finding for finding in seen.findings if finding not in known]:
        output.findings(more, "Further findings")


def chart_text(chart: StabilityChart, unit: str) -> str:
    """What a chart covers, how its points count, the worst, and what was clipped."""
    words = Words(unit)
    across, up = words.parameter(chart.x_label, chart.x_unit), words.parameter(chart.y_label, chart.y_unit)
    counts = ", ".join(f"{n} {v}" for v in Verdict if (n := chart.count(v)))
    lines = [f"  {axis.said(values)}, {len(values)} points" for axis, values in ((across, chart.x), (up, chart.y))]
    if chart.speed is not None:
        lines.append(f"  at {words.speed(chart.speed)}")
    lines.append(f"  {counts}")
    if chart.count(Verdict.FAILED) < chart.verdict.size:
        i, j = np.unravel_index(np.nanargmax(chart.spectral_radius), chart.spectral_radius.shape)
        radius, error = chart.spectral_radius[i, j], chart.error_estimate[i, j]
        lines.append(
            f"  largest spectral radius {with_error(radius, error, beside=1.0)} at "
            f"{across.value(float(chart.x[j]))}, {up.value(float(chart.y[i]))}"
        )
        middle, worst = np.nanmedian(chart.error_estimate), np.nanmax(chart.error_estimate)
        lines.append(f"  error estimate {middle:.1e} (median), {worst:.1e} (worst)")
    if (checked := chart.check_sentence) is not None:
        lines.append(f"  {checked}")
    return "\n".join([*lines, *(f"  {remark}" for remark in chart.remarks)])


def overview_json(seen: Overview, written: Sequence[Path]) -> dict[str, Any]:
    """An overview as plain values; angles in rad, speeds in ``speed_unit``, frequencies in Hz."""
    paths = [str(path) for path in written]
    return {
        "driveline": seen.line.name,
        "elements": list(seen.line.names),
        "speed_unit": seen.unit,
        "speed_range": [end * Words(seen.unit).factor for end in seen.speed_range],
        "angle_range": list(seen.angle_range),
        "assessment": assessment_json(seen.assessment),
        "natural_frequencies": modes_json(seen.natural_frequencies, "Hz"),
        "resonance_speeds": resonances_json(seen.resonance_speeds, seen.unit),
        "kinetostatics": None if seen.turn is None else kinetostatics_json(seen.turn),
        "stability": None if seen.stability is None else stability_json(seen.stability.in_unit(seen.unit)),
        "stability_chart": None if seen.chart is None else chart_json(seen.chart, seen.unit) | {"written": paths},
        "findings": output.findings_json(seen.findings),
        "written": paths,
    }


def stability_json(result: Stability) -> dict[str, Any]:
    """Speeds in the unit of the result, growth in 1/s, the period in rad of input angle."""
    response = result.response
    shafts = [] if response is None else [
        {"shaft": name, "twist_amplitude": t, "torque_amplitude": f, "torque_mean": m}
        for name, t, f, m in zip(
            response.shafts,
            response.twist_amplitude.tolist(),
            response.torque_amplitude.tolist(),
            response.torque_mean.tolist(),
            strict=True,
        )
    ]  # fmt: skip
    return {
        **output.record(
            result, "speed verdict spectral_radius error_estimate growth_rate growth_rate_error", result.words
        ),
        **output.record(result, "period multipliers multiplier_error"),
        "speed_unit": result.unit,
        "resonance": None if result.resonance is None else str(result.resonance),
        "forced_response": shafts,
        "forced_response_linear": None if response is None else response.linear,
        "findings": output.findings_json(result.findings),
    }


def chart_json(chart: StabilityChart, unit: str) -> dict[str, Any]:
    """What the chart covers and counts; the points themselves are in the files written."""
    words = Words(unit)

    def ends(label: str, si_unit: str, values: Any) -> dict[str, Any]:
        factor, shown = (words.factor, unit) if label == "speed" else (1.0, si_unit)
        ends = {"low": float(values[0]) * factor, "high": float(values[-1]) * factor}
        return {"parameter": label, "unit": shown, **ends, "points": len(values)}

    return {
        "x": ends(chart.x_label, chart.x_unit, chart.x),
        "y": ends(chart.y_label, chart.y_unit, chart.y),
        **output.record(chart, "speed unstable_share way remarks", words),
        "speed_unit": unit,
        "counts": {str(v): chart.count(v) for v in Verdict},
        "error_estimate": _error_json(chart),
        "spot_check": None if chart.spot_check is None else asdict(chart.spot_check),
    }


def _error_json(chart: StabilityChart) -> dict[str, float] | None:
    if chart.count(Verdict.FAILED) == chart.verdict.size:
        return None
    return {"median": float(np.nanmedian(chart.error_estimate)), "worst": float(np.nanmax(chart.error_estimate))}


def modes_json(modes: NaturalFrequencies, unit: str) -> dict[str, Any]:
    """Frequencies in ``unit``, null where a mode is overdamped; decay in 1/s; shapes by the names of the inertias."""
    factor = Words(unit).factor
    return {
        "frequency_unit": unit,
        "rigid_body": modes.rigid_body,
        "modes": [
            {
                "frequency": float(modes.frequency[i]) * factor,
                "damping_ratio": float(modes.damping_ratio[i]),
                "undamped_frequency": float(modes.undamped_frequency[i]) * factor,
                "decay_rates": modes.decay_rate[i].tolist(),
                "shape": dict(zip(modes.names, modes.shape[:, i].tolist(), strict=True)),
            }
            for i in range(len(modes.names))
        ],
    }


def resonances_json(found: ResonanceSpeeds, unit: str) -> dict[str, Any]:
    """Resonances by ascending speed in ``unit``."""
    return {
        "speed_unit": unit,
        "orders": found.orders,
        "resonances": [output.record(r, "speed kind modes order formula opens", Words(unit)) for r in found],
    }

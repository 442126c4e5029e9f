"""Commands that compute: read the options, call one analysis, print or write what came out."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.options import (
    File,
    Json,
    LoadCase,
    Output,
    Points,
    Speed,
    Unit,
    file_stem,
    read_axis,
    read_case,
    read_line,
    read_points,
    read_speed,
    read_time,
)
from trunnion.cli.places import DEFAULT_FOLDER, answer, check_places, deliver, write_result
from trunnion.waiting import TimeLimit, to_the_end

if TYPE_CHECKING:
    from trunnion.reporting.answer import Answer
    from trunnion.reporting.overview import Overview
    from trunnion.reporting.report import Report


DRAWN = 3.0
"""Seconds that the pictures of a report take: with less left than that none is made."""
REST, LEAST = 10.0, 0.05
"""Seconds of processor time that report and chart may take where no time is given; seconds at least where it is."""


def analyze(
    file: File,
    to: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="PATH",
            help="Folder for report, chart and data; or the report alone as NAME.html.",
        ),
    ] = DEFAULT_FOLDER,
    speed: Speed = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    points: Annotated[
        str | None, typer.Option("--points", metavar="NXxNY", help="Of the chart; default as its picture needs.")
    ] = None,
    within: Annotated[
        str | None,
        typer.Option(
            "--within",
            metavar="TIME",
            help='End within this time, "30 s" say, with what is known by then; default: as long as the verdict '
            "takes, then 10 s of processor time.",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Is the line fit for its speeds? Verdict, checks and findings at once; then a report as one HTML file."""
    begun = time.monotonic()
    line, unit = read_case(file, unit, load_case)
    size, at = read_points(points) if points else None, read_speed(speed, unit)
    seconds = read_time(within, "--within")
    from trunnion.cli.files import check_report
    from trunnion.cli.report import overview_json, print_begin, print_findings, print_judged, print_overview
    from trunnion.reporting.answer import answer as answer_of
    from trunnion.reporting.answer import asked, judged
    from trunnion.reporting.overview import at_speed

    check_report(to)
    question = asked(line, speed=at, unit=unit)
    if not as_json:
        print_begin(question)
    with output.progress("verdict", within):
        verdict = judged(question)
    if not as_json:
        print_judged(verdict)
    left = None if seconds is None else max(seconds - (time.monotonic() - begun), LEAST)
    with output.stoppable(left), output.progress("findings"):
        given = answer_of(verdict)
    if not as_json:
        print_findings(given)
    left = REST if seconds is None else max(seconds - (time.monotonic() - begun), LEAST)
    with output.stoppable(left, of_processor=seconds is None) as limit:
        if left < DRAWN:
            seen, written = at_speed(given), list[Path]()
            left_out: tuple[str, ...] = (f"The report itself: the time limit of {within} left no time to draw it",)
        else:
            seen, left_out, written = _reported(given, file, to, size, limit)
    if as_json:
        output.write_json("analyze", overview_json(seen, written))
        return
    print_overview(seen, given)
    if left_out:
        output.heading("Left out of the report")
    for sentence in left_out:
        output.say(f"  {sentence}")
    output.written(written)


def _reported(
    given: Answer, file: str, to: Path, size: tuple[int, int] | None, limit: TimeLimit
) -> tuple[Overview, tuple[str, ...], list[Path]]:
    """Write the report, then once more with the chart: what is interrupted leaves the first. Also what it left out."""
    from trunnion.reporting.overview import at_speed, charted
    from trunnion.reporting.report import report

    with output.progress("report") as advance:
        seen = at_speed(given)
        page = report(seen, source=file, progress=advance)
    written = _written(page, to, file)
    if not seen.chartable:
        return seen, page.contents.left_out, written
    try:
        with output.progress("stability chart") as advance:
            seen = charted(seen, size, advance)
        if limit.stopped:
            raise KeyboardInterrupt
        page = page.charted(seen)
        with to_the_end():
            return seen, page.contents.left_out, _written(page, to, file)
    except KeyboardInterrupt:
        kept = f"the report without its chart is in {', '.join(map(str, written))}"
        raise KeyboardInterrupt(kept) from None


def _written(page: Report, to: Path, file: str) -> list[Path]:
    from trunnion.cli.files import REPORTS
    from trunnion.writing import folder_written_whole

    if to.suffix.lower() in REPORTS:
        return [page.save(to)]
    chart, stem = page.contents.overview.chart, file_stem(file)
    with folder_written_whole(to) as temporary:
        written = [page.save(temporary / f"{stem}-report.html")]
        if chart is not None:
            names = [temporary / f"{stem}-stability-chart.{ending}" for ending in ("png", "nc")]
            written += [write_result(name, chart, lambda: page.pictures["chart"]) for name in names]
    return [to / path.name for path in written]


def stability(
    file: File,
    speed: Speed = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    as_json: Json = False,
) -> None:
    """Floquet stability at one speed, with the linear forced response."""
    line, unit = read_case(file, unit, load_case)
    at = read_speed(speed, unit)
    from trunnion.cli.report import stability_json

    with output.progress("stability"):
        result = tn.stability(line, at).in_unit(unit)
    answer(
        "stability", None, as_json, lambda: stability_json(result), result.__str__,
        lambda: output.findings(result.findings), wrap=True,
    )  # fmt: skip


def stability_chart(
    file: File,
    x: Annotated[
        str,
        typer.Option(
            "--x", metavar="PARAMETER:LOW:HIGH[:POINTS][:log]", help="Or PARAMETER alone for the file's range."
        ),
    ] = "speed",
    y: Annotated[str, typer.Option("--y", metavar="PARAMETER:LOW:HIGH[:POINTS][:log]")] = "HookeJoint *.angle",
    speed: Speed = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    points: Points = "200x150",
    to: Output = None,
    as_json: Json = False,
) -> None:
    """Stability over any two parameters, as picture and data.

    Example: trunnion stability-chart a.toml --x speed:300rpm:2400rpm:400 --y "joint 2.angle:0deg:30deg:300"
    """
    line, unit = read_case(file, unit, load_case)
    nx, ny = read_points(points)
    at = read_speed(speed, unit)
    from trunnion.cli.report import chart_json, chart_text

    across = read_axis(x, line, unit, nx, "--x")
    up = read_axis(y, line, unit, ny, "--y")
    check_places(to)
    with output.progress("stability chart") as advance:
        chart = tn.stability_chart(line, across, up, speed=at, progress=advance)
    deliver(
        "stability-chart", file, chart, to, as_json, draw=lambda: chart.plot(unit=unit),
        content=lambda: chart_json(chart, unit), text=lambda: chart_text(chart, unit), wrap=True,
    )  # fmt: skip


def natural_frequencies(file: File, unit: Unit = None, as_json: Json = False) -> None:
    """Natural frequencies and damping ratios with all joints straight."""
    line = read_line(file)
    from trunnion.cli.report import modes_json
    from trunnion.driveline.operating_speed import speed_unit
    from trunnion.results.words import Words

    words = Words(unit) if unit else Words(speed_unit(line)).of_frequencies
    unit, _ = words.of_speeds, words.factor
    modes = tn.natural_frequencies(line)
    answer(
        "natural-frequencies", None, as_json, lambda: modes_json(modes, unit),
        lambda: f"{len(modes.names)} natural frequencies, all joints straight",
        lambda: output.table(modes.table(unit)), wrap=True,
    )  # fmt: skip


def resonance_speeds(
    file: File,
    orders: Annotated[int, typer.Option("--orders", help="Highest order k.", min=1, max=20)] = 2,
    everywhere: Annotated[bool, typer.Option("--all", help="Also those outside the file's speed_range.")] = False,
    unit: Unit = None,
    as_json: Json = False,
) -> None:
    """Named parametric resonance speeds in the operating range, and which of them can open."""
    from trunnion.cli.report import resonances_json

    line, unit = read_case(file, unit)
    found = tn.resonance_speeds(line, orders)
    limits = line.operation.speed_range if line.operation else None
    shown = found if everywhere or limits is None else found.within(*limits)
    rows = shown.table(unit)
    where = "" if shown is found else f" in the operating range, of {len(found)} in all (--all shows them)"
    answer(
        "resonance-speeds", None, as_json, lambda: resonances_json(shown, unit),
        lambda: f"{len(rows)} resonance speeds up to order {orders}{where}", lambda: output.table(rows), wrap=True,
    )  # fmt: skip

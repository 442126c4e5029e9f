"""Commands that compute: read the options, call one analysis, print or write what came out."""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import trunnion as tn
from trunnion.cli import output
from trunnion.cli.command_input import CommandInput, CommandSubject, NumberBounds, OptionReader, Texts
from trunnion.cli.options import (
    FILE,
    SPEED,
    AboutSteadyState,
    Line,
    LineOfFile,
    LoadCase,
    Progress,
    Speed,
    SpeedUnit,
    Unit,
)
from trunnion.cli.places import DEFAULT_FOLDER, NOTHING, CommandOutput, write_result
from trunnion.cli.readers import line_of_file, loaded_line, read_axis, read_points, read_speed, read_time
from trunnion.cli.typed import Command, Json
from trunnion.waiting import TimeLimit, to_the_end

if TYPE_CHECKING:
    from trunnion.reporting.overview import Overview
    from trunnion.reporting.overview_assessment import OverviewAssessment
    from trunnion.reporting.report import Report
    from trunnion.reporting.submission import Submission


DRAWN = 3.0
"""Seconds that the pictures of a report take: with less left than that none is made."""
LIBRARIES = ("matplotlib.figure", "numba", "scipy.optimize", "jinja2")
OF_CHARTS = ("scipy.integrate", "h5netcdf")
"""What a report stands on, and what the chart of a line with Hooke's joints does besides. Python compiles it when it is
loaded for the first time, which costs as much as the report itself and is as little of its time as compiling is."""
REST, HANDED_IN, LEAST = 10.0, 60.0, 0.05
"""Seconds of processor time, compiling and loading not counted, that report and chart may take where no time is given,
and the report to hand in, which is to be complete; seconds at least where it is."""


def analyze(
    file: Annotated[str, FILE],
    to: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="PATH",
            help="Folder for report, chart and data; or the report alone as NAME.html.",
        ),
    ] = DEFAULT_FOLDER,
    speed: Annotated[str | None, SPEED] = None,
    unit: Unit = None,
    load_case: LoadCase = None,
    points: Annotated[
        str | None,
        typer.Option("--points", metavar="NXxNY", help="Points of the chart; default: as its picture needs."),
    ] = None,
    within: Annotated[
        str | None,
        typer.Option(
            "--within",
            metavar="TIME",
            help='End within this time, "30 s" say, with what is known by then; default: as long as the verdict '
            "takes, then 10 s of processor time, 60 s with --submission.",
        ),
    ] = None,
    handed_in: Annotated[
        bool,
        typer.Option(
            "--submission",
            help="Write the report to hand in and sign, NAME-submission.html, instead of the one with charts.",
        ),
    ] = False,
    moving: Annotated[
        bool,
        typer.Option("--live", help="Also write a page on which the line moves, NAME-live.html beside the report."),
    ] = False,
    as_json: Json = False,
) -> None:
    """Is the line fit for its speeds? Verdict, checks and findings at once; then a report as one HTML file."""
    begun = time.monotonic()
    about = loaded_line(file, {"unit": unit, "load_case": load_case})
    size = read_points(points) if points else None
    at = None if speed is None else read_speed(about, speed, "--speed")
    seconds = None if within is None else read_time(within, "--within")
    from trunnion.cli.files import check_report
    from trunnion.cli.report import overview_json, print_begin, print_findings, print_judged, print_overview
    from trunnion.driveline.driveline import hooke_joints
    from trunnion.reporting.overview import at_speed
    from trunnion.reporting.overview_assessment import answer as answer_of
    from trunnion.reporting.overview_assessment import asked, judged

    check_report(to)
    question = asked(about.line, speed=at, unit=about.unit)
    if not as_json:
        print_begin(question)
    with output.progress("verdict", seconds):
        verdict = judged(question)
    if not as_json:
        print_judged(verdict)
    left = None if seconds is None else max(seconds - (time.monotonic() - begun), LEAST)
    with output.stoppable(left, stated=seconds), output.progress("findings"):
        given = answer_of(verdict)
    if not as_json:
        print_findings(given)
    if handed_in:
        left = HANDED_IN if seconds is None else max(seconds - (time.monotonic() - begun), LEAST)
        handed, written = _submitted(given, file, to, left, seconds)
        if as_json:
            output.write_json("analyze", overview_json(at_speed(given), written))
            return
        _print_left_out(handed.contents.left_out)
        output.written(written)
        return
    if seconds is None:
        for name in (*LIBRARIES, *(OF_CHARTS if hooke_joints(given.line) else ())):
            import_module(name)
    left = REST if seconds is None else max(seconds - (time.monotonic() - begun), LEAST)
    with output.stoppable(left, of_processor=seconds is None, stated=seconds) as limit:
        if left < DRAWN:
            seen, written = at_speed(given), list[Path]()
            left_out: tuple[str, ...] = (f"The report itself: the time limit of {within} left no time to draw it",)
        else:
            seen, left_out, written = _reported(given, file, to, size, limit)
            if moving:
                page, cannot = _live(seen, written[0])
                left_out, written = (*left_out, *cannot), [*written, page]
    if as_json:
        output.write_json("analyze", overview_json(seen, written))
        return
    print_overview(seen, given)
    _print_left_out(left_out)
    output.written(written)


def _print_left_out(sentences: tuple[str, ...]) -> None:
    if sentences:
        output.heading("Left out of the report")
    for sentence in sentences:
        output.say(f"  {sentence}")


def _reported(
    given: OverviewAssessment, file: str, to: Path, size: tuple[int, int] | None, limit: TimeLimit
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


def _live(seen: Overview, report: Path) -> tuple[Path, tuple[str, ...]]:
    """The page on which the line moves, beside the report, and what it leaves out."""
    from trunnion.reporting.live import beside, live

    with output.progress("the line in motion"):
        found, left_out = live(seen.line, seen.stability.speed if seen.stability else None)
    return found.save(beside(report)), left_out


def _submitted(
    given: OverviewAssessment, file: str, to: Path, left: float, within: float | None
) -> tuple[Submission, list[Path]]:
    """The report that is handed in, and where it is written; ``left`` of the time stated as ``within`` [s]."""
    from trunnion.cli.files import REPORTS
    from trunnion.reporting.submission import submission
    from trunnion.writing import folder_written_whole

    limit = output.stoppable(left, of_processor=within is None, stated=within)
    with limit, output.progress("report to hand in") as advance:
        page = submission(given, source=file, progress=advance, doing=advance.at)
    with to_the_end():
        if to.suffix.lower() in REPORTS:
            return page, [page.save(to)]
        with folder_written_whole(to) as temporary:
            name = page.save(temporary / f"{Path(file).stem}-submission.html").name
        return page, [to / name]


def _written(page: Report, to: Path, file: str) -> list[Path]:
    from trunnion.cli.files import REPORTS
    from trunnion.writing import folder_written_whole

    if to.suffix.lower() in REPORTS:
        return [page.save(to)]
    chart, stem = page.contents.overview.chart, Path(file).stem
    with folder_written_whole(to) as temporary:
        written = [page.save(temporary / f"{stem}-report.html")]
        if chart is not None:
            names = [temporary / f"{stem}-stability-chart.{ending}" for ending in ("png", "nc")]
            written += [write_result(name, chart, lambda: page.pictures["chart"]) for name in names]
    return [to / path.name for path in written]


def _size(asked: CommandInput, text: str, key: str) -> tuple[int, int]:
    return read_points(text)


Axis = tuple[str, float, float, int, str]
AXIS = partial(read_axis, points=0)
"""With as many points as ``--points`` says where none are stated."""


def _frequencies(file: str, texts: Texts) -> CommandInput:
    """The line, and the unit of frequencies that goes with that of its speeds."""
    from trunnion.results.words import Words

    asked = line_of_file(file, texts)
    return asked if texts["unit"] else replace(asked, unit=Words(asked.unit).of_frequencies.of_speeds)


@Command("stability", writes=NOTHING)
def stability(
    line: Line, *, speed: Speed, unit: SpeedUnit, about_steady_state: AboutSteadyState = False
) -> CommandOutput:
    """Example: trunnion stability truck.toml --speed "1500 rpm" """
    from trunnion.cli.report import stability_json

    found = tn.stability(line, speed, about_steady_state=about_steady_state).in_unit(unit)
    return CommandOutput(
        found,
        content=lambda: stability_json(found),
        more=lambda: output.findings(found.findings),
        wrap=True,
    )


@Command("stability chart")
def stability_chart(
    line: Line,
    *,
    x: Annotated[Axis, OptionReader(AXIS, "speed")],
    y: Annotated[Axis, OptionReader(AXIS, "HookeJoint *.angle")],
    speed: Speed,
    points: Annotated[tuple[int, int], OptionReader(_size, "200x150")],
    unit: SpeedUnit,
    about_steady_state: AboutSteadyState = False,
    progress: Progress,
) -> CommandOutput:
    """Example: trunnion stability-chart a.toml --x speed:300rpm:2400rpm:400 --y "joint 2.angle:0deg:30deg:300"

    --x PARAMETER:LOW:HIGH[:POINTS][:log]  What varies along x; PARAMETER alone takes the file's range.
    --y PARAMETER:LOW:HIGH[:POINTS][:log]  What varies along y, likewise.
    --points NXxNY  Points along x and y, where the axes do not say how many.
    """
    from trunnion.cli.report import chart_json, chart_text

    across, up = ((*axis[:3], axis[3] or n, axis[4]) for axis, n in zip((x, y), points, strict=True))
    chart = tn.stability_chart(line, across, up, speed=speed, about_steady_state=about_steady_state, progress=progress)
    return CommandOutput(
        chart, content=lambda: chart_json(chart, unit), text=lambda: chart_text(chart, unit), wrap=True
    )


LineInFrequencies = Annotated["tn.Driveline", FILE, CommandSubject(_frequencies, {"unit": Unit})]


@Command(writes=NOTHING)
def natural_frequencies(line: LineInFrequencies, *, unit: SpeedUnit) -> CommandOutput:
    """Example: trunnion natural-frequencies truck.toml --unit Hz"""
    from trunnion.cli.report import modes_json

    modes = tn.natural_frequencies(line)
    return CommandOutput(
        modes,
        content=lambda: modes_json(modes, unit),
        text=lambda: f"{len(modes.names)} natural frequencies, all joints straight",
        more=lambda: output.table(modes.table(unit)),
        wrap=True,
    )


@Command(writes=NOTHING)
def resonance_speeds(
    line: LineOfFile, *, orders: Annotated[int, NumberBounds(1, 20)] = 2, all_: bool = False, unit: SpeedUnit
) -> CommandOutput:
    """Example: trunnion resonance-speeds truck.toml --orders 3 --all

    --orders  Highest order k of the resonances.
    --all  Also list those outside the file's speed_range.
    """
    from trunnion.cli.report import resonances_json

    found = tn.resonance_speeds(line, orders)
    limits = line.operation.speed_range if line.operation else None
    shown = found if all_ or limits is None else found.within(*limits)
    rows = shown.table(unit)
    where = "" if shown is found else f" in the operating range, of {len(found)} in all (--all shows them)"
    return CommandOutput(
        shown,
        content=lambda: resonances_json(shown, unit),
        text=lambda: f"{len(rows)} resonance speeds up to order {orders}{where}",
        more=lambda: output.table(rows),
        wrap=True,
    )

"""The report: one HTML file that opens offline, prints on A4 and says first what matters most."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trunnion.design.limits.result import LimitKind
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.elements import ConstantSpeed
from trunnion.driveline.features import feature
from trunnion.errors import ComputationError, InputError
from trunnion.reporting import tables
from trunnion.reporting.binding import binding_picture
from trunnion.reporting.contents import Contents, gather, with_chart
from trunnion.reporting.modes_table import modes
from trunnion.reporting.overview import Overview, overview
from trunnion.reporting.page import HtmlPage, environment
from trunnion.reporting.pictures import ReportPicture, picture
from trunnion.reporting.provenance import provenance
from trunnion.reporting.under_load import heaviest
from trunnion.results.speeds import frequency_unit as reading_of_frequencies
from trunnion.results.speeds import speed_factor
from trunnion.results.words import Words
from trunnion.waiting import to_the_end

if TYPE_CHECKING:
    from trunnion.measured.overlay import MeasuredComparison
    from trunnion.measured.tracking.result import MeasuredOrders


@dataclass(frozen=True)
class Report(HtmlPage):
    """A page, and the results it was made from."""

    contents: Contents
    pictures: Mapping[str, ReportPicture]
    source: Path | None = None

    def charted(self, seen: Overview) -> Report:
        """The same report with the chart of ``seen``; nothing else is computed or drawn again."""
        contents = with_chart(self.contents, seen)
        with to_the_end():  # what there is is drawn
            shown = {**self.pictures, **chart_pictures(contents)}
            return Report(_page(contents, shown, self.source), contents, shown, self.source)

    def __repr__(self) -> str:
        size = len(self.html.encode()) / 1e6
        name = self.contents.overview.line.name or "a driveline"
        return f"report on {name}, {size:.1f} MB of HTML; .save(path) writes it"


def report(
    line: Driveline | Overview,
    *,
    speed: float | str | None = None,
    unit: str | None = None,
    points: tuple[int, int] | None = None,
    source: str | os.PathLike[str] | None = None,
    measured: MeasuredOrders | None = None,
    progress: Callable[[float], None] | None = None,
) -> Report:
    """Everything about ``line`` on one page.

    Parameters
    ----------
    line : the driveline, or an overview of it that is computed already (then ``speed``, ``unit`` and
        ``points`` are its own).
    speed : operating speed [rad/s]; default the one of the description.
    unit : of speeds: "rpm", "Hz" or "rad/s"; default the description's.
    points : speeds × angles of the chart; default as many as its picture needs.
    source : the file the line was read from, for its name and hash.
    measured : orders that were tracked on a bench; a section lays them over what the line predicts.
    progress : called as progress(share done) while the chart is computed.

    Raises
    ------
    InputError : the line has no equations of motion, or no steady motion to judge.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)])
    >>> tn.report(line, speed=30.0)
    report on a driveline, 0.1 MB of HTML; .save(path) writes it
    """
    if unit is not None:
        speed_factor(unit)
    seen = (
        line if isinstance(line, Overview) else overview(line, speed=speed, unit=unit, points=points, progress=progress)
    )
    contents = gather(seen, measured)
    path = None if source is None else Path(source)
    with to_the_end():  # what there is is drawn
        shown = pictures(contents)
        return Report(_page(contents, shown, path), contents, shown, path)


def _page(contents: Contents, shown: Mapping[str, ReportPicture], source: Path | None) -> str:
    seen = contents.overview
    unit, frequency_unit = seen.unit, reading_of_frequencies(seen.unit)
    made = datetime.now().astimezone()
    facts: dict[str, Any] = {
        "title": seen.line.name or "Driveline",
        "description": seen.line.description or "",
        "made": made.strftime("%Y-%m-%d"),
        "verdict": seen.assessment.sentence,
        "status": str(seen.assessment.verdict).replace(" ", "-"),
        "checks": tables.checks(seen.assessment),
        "rests_on": seen.assessment.rests_on,
        "switched_off": seen.assessment.switched_off,
        "not_applicable": tables.not_applicable(seen.assessment),
        "helped": contents.helped.sentences if contents.helped else (),
        "verified": contents.helped.verified if contents.helped else "",
        "chart_to_come": seen.chartable and seen.chart is None,
        "findings": contents.findings,
        "left_out": contents.left_out,
        "remarks": seen.remarks,
        "staged": any(feature(key).places(seen.line) for key in ("backlash", "stages")),
        "operation": tables.operation(contents, unit),
        "elements": tables.elements(seen.line),
        "modes": modes(seen),
        "crossings": tables.crossings(contents, unit, frequency_unit),
        "crossings_shown": tables.crossings_shown(contents),
        "driven": not seen.assembly.topology.free,
        "resonances": tables.resonances(contents, unit),
        "joints": tables.joints(seen.line),
        "irregularity": tables.irregularity(contents),
        "torques": tables.torques(contents, unit),
        "life": tables.fatigue(contents),
        "life_findings": contents.life.findings_in(unit) if contents.life else (),
        "load_cases": bool(seen.line.operation and seen.line.operation.load_cases),
        "under_load": tables.under_load(contents),
        "contacts": tables.contacts(contents),
        "measured": tables.measured(contents),
        "measured_says": tables.measured_sentences(contents),
        "bending": tables.bending(contents, unit),
        "stability": _verdict(seen),
        "at_speed": Words(unit).speed(seen.stability.speed) if seen.stability else "",
        "limit": contents.limit,
        "provenance": provenance(contents, source, made),
        "pictures": shown,
    }
    return environment().get_template("report.html.j2").render(**facts)


def _verdict(seen: Overview) -> str:
    """The verdict at the operating speed, without the forced response, which has its own table."""
    return seen.stability.describe(seen.unit).split("\n  linear forced response")[0] if seen.stability else ""


def pictures(contents: Contents) -> dict[str, ReportPicture]:
    """The figures of a report by name."""
    from trunnion.pictures import driveline_sketch
    from trunnion.pictures import fatigue as fatigues
    from trunnion.pictures import motion as motions
    from trunnion.pictures.campbell_diagram import campbell_diagram
    from trunnion.pictures.draw_matplotlib import draw
    from trunnion.pictures.kinetostatics import irregularity
    from trunnion.pictures.modes import mode_shapes
    from trunnion.pictures.orders import speed_sweep

    seen, unit = contents.overview, contents.overview.unit
    line, operating, frequency_unit = seen.line, seen.operation, reading_of_frequencies(seen.unit)
    first = line.elements[0]
    drive = line.names[0] if isinstance(first, ConstantSpeed) else None
    shown = {
        "sketch": picture(driveline_sketch.draw(line), "Sketch of the driveline, element by element"),
        "modes": picture(draw(mode_shapes(seen.natural_frequencies, unit=frequency_unit, drive=drive)), "Mode shapes"),
    }
    if (binding := binding_picture(seen)) is not None:
        shown["binding"] = binding
    if contents.campbell is not None:
        diagram = campbell_diagram(contents.campbell, unit=unit, frequency_unit=frequency_unit, operating=operating)
        shown["campbell"] = picture(draw(diagram), "Campbell diagram: modes and excitations over speed")
    if contents.turn is not None:
        shown["irregularity"] = picture(draw(irregularity(contents.turn)), "Speed of the shafts over a turn")
    if contents.sweep is not None:
        swept = speed_sweep(contents.sweep, unit=unit, operating=operating)
        shown["torque"] = picture(draw(swept), "Torque amplitude of every shaft over speed")
    if contents.life is not None:
        cycles = fatigues.fatigue(contents.life)
        shown["cycles"] = picture(draw(cycles), "Cycles over amplitude, and the S–N curve")
        if len(contents.life.histories) > 1:
            shown["damage"] = picture(draw(fatigues.damage(contents.life)), "Damage by element and history")
    if contents.loaded:
        motion = heaviest(contents.loaded)
        period, orders = motions.period(motion.response, unit=unit), motions.orders(motion.response)
        shown["loaded"] = picture(draw(period), f"Torque over one period, {motion.case}")
        shown["orders"] = picture(draw(orders), f"Orders of the torque, {motion.case}")
    return shown | measured_pictures(contents) | chart_pictures(contents)


def measured_pictures(contents: Contents) -> dict[str, ReportPicture]:
    """Measured orders over the response of every kind of channel, on the Campbell diagram, and on the run-up."""
    found, shown = contents.measured, {}
    if found is None:
        return {}
    from trunnion.pictures.draw_matplotlib import draw
    from trunnion.pictures.measured import comparison, on_campbell, on_run_up

    for name in compared_channels(found):
        key = f"measured {name}"
        shown[key] = picture(
            draw(comparison(found, channel=name)),
            f"Orders measured at {name} over predicted ones",
            f"Measured at {name}, with intervals of 95 %, over what the line predicts.",
        )
    try:
        shown["measured on Campbell"] = picture(draw(on_campbell(found)), "Measured orders on the Campbell diagram")
    except (InputError, ComputationError):  # the section on the Campbell diagram says why
        pass
    try:
        shown["measured on run-up"] = picture(draw(on_run_up(found)), "Measured torques on the run-up of the line")
    except (InputError, ComputationError):  # no torque was measured, or no run-up
        pass
    return shown


def compared_channels(found: MeasuredComparison) -> list[str]:
    """The first channel of each kind at a place that moves."""
    first: dict[str, str] = {}
    for name, kind, peak in zip(found.channels, found.kinds, found.peak.max(axis=0), strict=True):
        if peak > 0:
            first.setdefault(kind, name)
    return list(first.values())


def chart_pictures(contents: Contents) -> dict[str, ReportPicture]:
    """The stability chart and what follows from it; nothing where it is not computed."""
    from trunnion.pictures.draw_matplotlib import draw
    from trunnion.pictures.stability_chart import stability_chart
    from trunnion.pictures.stable_limit import stable_limit

    seen, unit, shown = contents.overview, contents.overview.unit, {}
    if seen.chart is not None:
        chart = stability_chart(seen.chart, unit=unit, operating=seen.operation)
        shown["chart"] = picture(draw(chart), "Stability chart over speed and joint angle")
    if contents.limit is not None and not np.all(contents.limit.kind == LimitKind.BEYOND):
        stands = {name: abs(angle) for name, angle in hooke_joints(seen.line)}
        limit = stable_limit(contents.limit, unit=unit, operating=seen.operation, values=stands)
        shown["limit"] = picture(draw(limit), "Largest stable joint angle over speed")
    return shown

"""The report that is handed in: to a classification society, a customer, a colleague who signs.

Its first sheet is one A4 page with the verdict, what it stands on, and room to sign. What follows is what a reviewer
recomputes: mass–elastic system, Holzer tables, excitation, torques of every shaft against what it may bear,
malfunction, heat, rules with their sources, what was searched and how far values may be low.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from trunnion._version import __version__
from trunnion.design.assessment.check import Check
from trunnion.driveline.driveline import Driveline
from trunnion.modes.mass_elastic import HolzerTable
from trunnion.reporting import submission_tables as tables
from trunnion.reporting import submission_words as words
from trunnion.reporting.barred_ranges import barred, barred_on_first_sheet
from trunnion.reporting.first_sheet import first_sheet
from trunnion.reporting.loads_table import loads
from trunnion.reporting.modes_table import modes
from trunnion.reporting.overview_assessment import OverviewAssessment, answer, asked, capital, judged
from trunnion.reporting.page import HtmlPage, environment
from trunnion.reporting.pictures import ReportPicture, picture
from trunnion.reporting.provenance import fingerprint
from trunnion.reporting.ranges import diagram_range
from trunnion.reporting.submission_contents import SubmissionContents, gather
from trunnion.results.finding import Finding, Gravity
from trunnion.results.speeds import frequency_unit
from trunnion.results.units import range_words
from trunnion.results.words import HERTZ, Words
from trunnion.waiting import to_the_end

SHRUNK = 1.4
"""How much larger than on the first sheet the drawing must get to be shown again, across the second."""
MOST_CURVES, MOST_UNLIMITED = 10, 3
"""Checks that are drawn over speed, and springs without a check."""


@dataclass(frozen=True)
class Submission(HtmlPage):
    """The report that is handed in, and the results it was made from."""

    contents: SubmissionContents
    pictures: Mapping[str, ReportPicture]

    def __repr__(self) -> str:
        name = self.contents.seen.line.name or "a driveline"
        return f"report to hand in on {name}, {len(self.html.encode()) / 1e6:.1f} MB of HTML; .save(path) writes it"


def submission(
    line: Driveline | OverviewAssessment,
    *,
    speed: float | str | None = None,
    unit: str | None = None,
    source: str | os.PathLike[str] | None = None,
    progress: Callable[[float], None] | None = None,
    doing: Callable[[str], None] | None = None,
) -> Submission:
    """The report on ``line`` that is handed in; title block and names come from its ``document``.

    Parameters
    ----------
    line : the driveline, or the answer on it that is computed already (then ``speed`` and ``unit`` are its own).
    speed : operating speed [rad/s]; default the one of the description.
    unit : of speeds: "rpm", "Hz" or "rad/s"; default the description's.
    source : the file the line was read from, for its name and hash.
    progress : called as progress(share done).
    doing : called as doing("cylinder 3 of engine, misfiring") before each cylinder that is searched out of work.

    Within ``tn.time_limit(seconds)`` it holds what is known by then; first sheet and section 10 say what is missing.

    Raises
    ------
    InputError : the line has no equations of motion, or no steady motion to judge.

    Examples
    --------
    >>> import trunnion as tn
    >>> disk = tn.Disk(inertia=0.8, excitation=[{"order": 2, "amplitude": 10.0}])
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), disk])
    >>> tn.submission(line, speed=30.0)
    report to hand in on a driveline, 0... MB of HTML; .save(path) writes it
    """
    seen = line if isinstance(line, OverviewAssessment) else answer(judged(asked(line, speed=speed, unit=unit)))
    contents = gather(seen, progress, doing)
    with to_the_end():  # what there is is drawn
        shown = _pictures(contents)
        return Submission(_page(contents, shown, None if source is None else Path(source)), contents, shown)


def _beside_checks(contents: SubmissionContents) -> Iterator[Finding]:
    """Findings that are no row of the checks on the first sheet again."""
    listed = tuple(f"{capital(str(row[1]))} is " for row in tables.first_checks(contents).rows)
    return (one for one in contents.seen.findings if not one.sentence.startswith(listed))


def _page(contents: SubmissionContents, shown: Mapping[str, ReportPicture], source: Path | None) -> str:
    seen, made = contents.seen, datetime.now().astimezone()
    grave = [one for one in _beside_checks(contents) if one.gravity is not Gravity.NOTE]
    malfunction = tables.malfunction_on_first_sheet(contents)
    checks, first, sketch_height = first_sheet(contents, malfunction, grave)
    name, digest = fingerprint(seen.line, source)
    facts: dict[str, Any] = {
        "title": seen.line.name or "Driveline",
        "description": seen.line.description or "",
        "verdict": seen.assessment.sentence,
        "status": str(seen.assessment.verdict).replace(" ", "-"),
        "footer": _footer(seen.line),
        "sketch_height": sketch_height,
        "sketch_again": _height_across(shown["sketch"]) > SHRUNK * sketch_height,
        "malfunction": malfunction,
        "malfunction_words": words.malfunction(contents),
        "ties": words.ties(contents),
        "assumptions": words.assumptions(contents),
        "several_cases": len(contents.cases) > 1,
        "separated": any(check.rule.name == "separation" for check in seen.assessment.checks),
        "title_block": tables.title_block(seen.line.document, made.strftime("%Y-%m-%d")),
        "signatures": tables.signatures(seen.line.document),
        "particulars": tables.particulars(contents),
        "first_checks": checks,
        "more_checks": tables.more_checks(contents, len(checks.rows)),
        "first_findings": first,
        "more_findings": len(grave) - len(first),
        "findings": seen.findings,
        "rests_on": seen.assessment.rests_on,
        "switched_off": seen.assessment.switched_off,
        "masses": tables.mass_table(contents),
        "springs": tables.spring_table(contents),
        "modes": modes(seen),
        "holzer": [(_mode_title(one), *tables.holzer_table(contents, one)) for one in contents.holzer],
        "engines": tables.engines(contents),
        "loads": loads(contents),
        "excitations": tables.excitations(contents),
        "powers": tables.powers(contents),
        "crossings": tables.crossings(contents),
        "shafts": tables.shafts(contents),
        "misfires": tables.misfires(contents) if contents.misfiring else None,
        "firing_checks": tables.firing_checks(contents),
        "misfire_checks": tables.misfire_checks(contents),
        "barred": barred(contents),
        "barred_first": barred_on_first_sheet(contents),
        "heats": tables.heats(contents),
        "rules": tables.rules(contents),
        "left_out": contents.left_out,
        "unsearched": contents.unsearched,
        "cylinder_cases": len(contents.misfiring) + len(contents.unsearched),
        "complete": contents.complete,
        "all_searched": contents.complete and not any(one.ended for one in contents.misfiring),
        "met": contents.campbell is not None,
        "range": Words(seen.unit).ends(*seen.speed_range),
        "one_speed": seen.speed_range[0] == seen.speed_range[1],
        "drawn": _drawn(seen),
        "curves": [key for key in shown if key.startswith("torque of ")],
        "pictures": shown,
        "program": f"Trunnion {__version__}, NumPy {np.__version__}",
        "made": made.strftime("%Y-%m-%d %H:%M %Z").strip(),
        "source": name,
        "digest": digest,
    }
    return environment().get_template("submission.html.j2").render(**facts)


def _footer(line: Driveline) -> str:
    """What every sheet says of the document."""
    of = line.document
    revision = f"revision {of.revision}" if of and of.revision else ""
    return ", ".join(one for one in (of.number if of else "", revision, line.name or "Driveline") if one)


def _drawn(seen: OverviewAssessment) -> str:
    """The speeds of the Campbell diagram: as stated, or with four figures those about one speed."""
    words, (low, high) = Words(seen.unit), diagram_range(*seen.speed_range)
    if (low, high) == seen.speed_range:
        return words.ends(low, high)
    return range_words(words.rounded(low), words.rounded(high))


def _height_across(drawn: ReportPicture) -> float:
    """Of a picture as wide as an A4 sheet between its margins [mm]."""
    assert drawn.figure is not None
    wide, high = drawn.figure.get_size_inches()
    return float(180.0 * high / wide)


def _mode_title(mode: HolzerTable) -> str:
    return f"Mode {mode.mode}: {HERTZ.speed(mode.frequency)} undamped"


def _pictures(contents: SubmissionContents) -> dict[str, ReportPicture]:
    """Sketch, modes, Campbell diagram, and the torque of the shafts that matter over speed."""
    from trunnion.driveline.elements import ConstantSpeed
    from trunnion.pictures import driveline_sketch
    from trunnion.pictures.campbell_diagram import campbell_diagram
    from trunnion.pictures.draw_matplotlib import draw
    from trunnion.pictures.modes import mode_shapes
    from trunnion.pictures.orders import course, order_response, same_looks
    from trunnion.pictures.picture import Picture

    seen, unit = contents.seen, contents.seen.unit
    frequencies = frequency_unit(unit)
    drive = seen.line.names[0] if isinstance(seen.line.elements[0], ConstantSpeed) else None
    shown = {
        "sketch": picture(driveline_sketch.draw(seen.line), "Sketch of the driveline, element by element"),
        "numbered": picture(
            driveline_sketch.draw(seen.line, named=False), "Sketch of the driveline, elements by their numbers"
        ),
        "modes": picture(draw(mode_shapes(seen.natural_frequencies, unit=frequencies, drive=drive)), "Mode shapes"),
    }
    if contents.campbell is not None:
        diagram = campbell_diagram(contents.campbell, unit=unit, frequency_unit=frequencies, operating=seen.operation)
        shown["campbell"] = picture(draw(diagram), "Campbell diagram: modes and excitations over speed")
    drawn: list[tuple[str, Picture, str, str]] = []
    for check in _with_course(contents):
        assert check.course is not None
        loaded = f", load case {check.load_case}" if check.load_case else ""
        caption = f"{capital(check.name)}: orders, their synthesis and what is allowed over speed{loaded}."
        curve = course(check.course, unit=unit, operating=seen.operation)
        drawn.append((check.name, curve, f"{check.name} over speed by order", caption))
    for spring, case in _unlimited(contents):
        response = next(one for one in contents.cases if one.name == case).answered
        curve = order_response(response, spring=spring, unit=unit, operating=seen.operation)
        loaded = f", load case {case}" if case else ""
        caption = f"Vibratory torque of {spring}, for which no limit is stated: orders and their synthesis{loaded}."
        drawn.append((spring, curve, f"Torque of {spring} over speed by order", caption))
    alike = same_looks([one for _, one, _, _ in drawn])
    for (name, _, about, caption), one in zip(drawn, alike, strict=True):
        shown[f"torque of {name}"] = picture(draw(one), about, caption)
    return shown


def _with_course(contents: SubmissionContents) -> list[Check]:
    """Checks of torque and stress that decide, the binding ones first."""
    judged = [one for one in contents.seen.assessment.checks if one.decides and one.course and one.course.by_order.size]
    return judged[:MOST_CURVES]


def _unlimited(contents: SubmissionContents) -> list[tuple[str, str]]:
    """Springs that no check is about, those that vibrate most, and the load case in which each does."""
    checked = {check.element for check in contents.seen.assessment.checks if check.course is not None}
    free = [one for one in contents.shafts if checked.isdisjoint(one.spring.split(" and "))]
    most = sorted(free, key=lambda one: -float(np.nan_to_num(one.vibratory.value)))[:MOST_UNLIMITED]
    return [(one.spring, one.vibratory.case) for one in most]

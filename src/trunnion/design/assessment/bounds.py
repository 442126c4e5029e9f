"""Whether what was searched over speed is also proved: bounds of peaks beside limits that the search finds satisfied.

A search looks at speeds. A bound holds at all of them, between and beside those looked at (``response.peaks``); it
costs some hundredths of a second a box, so that a line has a few boxes, alike for all its load cases. What they do not
prove stays *searched, not proved*: ``certify_peaks`` takes as many as are asked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trunnion.design.assessment.assessment_input import AssessmentInput, LoadCaseResponse
from trunnion.design.assessment.check import PROVED, SEARCHED, Check, Status
from trunnion.design.assessment.couplings import KINDS
from trunnion.design.assessment.measures import measures, name_of, rating_name
from trunnion.driveline.limits import LIMIT_KINDS, OneLimit
from trunnion.driveline.quantities import TORQUE, QuantityKind, eye_unit, shown
from trunnion.equations.coefficients import Assembly
from trunnion.equations.harmonics import line_harmonics
from trunnion.errors import InputError
from trunnion.response.peaks.peak_limits import peak_limits
from trunnion.results.counts import few
from trunnion.results.finding import Finding, Gravity
from trunnion.results.units import figures, rounded_up

BOXES, LEAST, WORTH = 24, 3, 8
"""Boxes of a line, and of each of its load cases at least; where it has fewer, none is worth its time."""
CHEAP = 100
"""Springs times harmonics up to which a box takes some hundredths of a second."""
EASY = 0.6
"""Share of a limit up to which a value is bounded first."""
BELOW = 1e-6
"""Share by which a bound may lie below what was computed: more than rounding and the search make."""
USEFUL = 10.0
"""Times the limit up to which a bound is said."""


@dataclass(frozen=True)
class BoundedCheck:
    """The check called ``name`` compares ``per`` times the largest of some quantities, by their places among
    ``quantities_of``, with its limit."""

    name: str
    places: tuple[int, ...]
    per: float
    kind: QuantityKind


@dataclass(frozen=True)
class ProvedBound:
    """The bound of one check over all load cases, after so many boxes."""

    value: float
    boxes: int
    ended: str


def with_bounds(subject: AssessmentInput, checks: tuple[Check, ...]) -> tuple[tuple[Check, ...], tuple[Finding, ...]]:
    """The checks with what is proved of them, and what is not in words; as they are where nothing was searched."""
    if not 0 < subject.low < subject.high or any(_not_searched(case) for case in subject.cases):
        return checks, ()
    searched = {one.name for case in subject.cases for one in measures(case.assembly)}
    open_ones = [check for check in checks if check.status is Status.SATISFIED and check.name in searched]
    if not open_ones:
        return checks, ()
    asked = {one.name: one for one in bounded_checks(subject.cases[0].assembly)}
    able = [check for check in open_ones if check.name in asked]
    try:
        found = _bounds(subject, able, asked) if able else {}
    except InputError as error:
        where = ".".join(part for part in (error.element, error.key) if part).replace("driveline", "the line")
        note = f"Values over speed are searched, not proved: {where} {error.problem}."
        unproved = tuple(replace(check, proof=SEARCHED) if check in open_ones else check for check in checks)
        return unproved, (Finding(Gravity.NOTE, note),)
    said = {check.name: _said(check, asked, found, len(subject.cases)) for check in open_ones}
    notes = tuple(Finding(Gravity.NOTE, note) for note in _notes(tuple(said.values()), asked))
    return tuple(said.get(check.name, check) if check in open_ones else check for check in checks), notes


def _notes(checks: Sequence[Check], asked: dict[str, BoundedCheck]) -> Iterator[str]:
    """What holds of all that is proved, and what is not."""
    if any(check.proof == PROVED for check in checks):
        yield "What is proved holds of the steady motion, which a stable line comes to."
    if any(check.proof == SEARCHED and check.name in asked for check in checks):
        yield "trunnion certify-peaks may prove what is searched and not proved here; it takes more time."
    if without := [check.name for check in checks if check.proof == SEARCHED and check.name not in asked]:
        yield f"Searched, not proved, because no bound is computed for them: {few(without)}."


def _not_searched(case: LoadCaseResponse) -> bool:
    """Whether it is judged at given speeds, roughly, or while more than its speed changes."""
    return bool(case.given or case.known is not None or case.rough or case.follows is not None or case.ended_by)


def _bounds(subject: AssessmentInput, able: Sequence[Check], asked: dict[str, BoundedCheck]) -> dict[str, ProvedBound]:
    """Of every check over all load cases."""
    # Loaded where needed: they bring the compiler with them.
    from trunnion.response.peaks.peaks_below import AskedPeak, peaks_below

    allowed = _allowed(subject.cases[0].assembly)
    peaks, owner = list[AskedPeak](), list[str]()
    for check in able:
        one, limit = asked[check.name], check.limit * (1 - check.required_margin)
        peaks += [AskedPeak(place, limit / one.per, check.value <= EASY * limit) for place in one.places]
        owner += [check.name] * len(one.places)
    limits, upper, boxes, ended = np.array([one.limit for one in peaks]), np.zeros(len(peaks)), 0, ""
    for case in subject.cases:
        upper[upper > limits] = np.inf  # what one case leaves open no other proves
        left = np.flatnonzero(upper <= limits)
        if not len(left) or not allowed:
            upper[left] = np.inf
            break
        most = max(allowed // len(subject.cases), LEAST)
        found = peaks_below(case.assembly, (case.low, case.high), tuple(peaks[k] for k in left), most)
        upper[left] = np.maximum(upper[left], found.upper)
        boxes, ended = boxes + found.boxes, ended or found.ended
    names = np.array(owner)
    return {name: ProvedBound(float(upper[names == name].max()) * asked[name].per, boxes, ended) for name in set(owner)}


def _allowed(assembly: Assembly) -> int:
    """Boxes that a line may take."""
    acting = sum(one.acts for one in line_harmonics(assembly))
    boxes = int(BOXES * min(1.0, CHEAP / (max(len(assembly.topology.compliances), 1) * (1 + acting))))
    return boxes if boxes >= WORTH else 0


def _said(check: Check, asked: dict[str, BoundedCheck], found: dict[str, ProvedBound], cases: int) -> Check:
    """The check with its bound over all load cases."""
    if check.name not in found:
        return replace(check, proof=SEARCHED)
    one, kind = found[check.name], asked[check.name].kind
    limit = check.limit * (1 - check.required_margin)
    if one.value < check.value * (1 - BELOW):  # one of both is wrong
        why = f"the bound {_at_most(one.value, kind)} lies below what was found, so one of both is wrong"
    elif one.value <= limit:
        gap = f", {_above(one.value, check.value)} what was found" if check.value > 0 else ""
        where = "at every speed of every load case" if cases > 1 else "at every speed"
        said = f"{check.because}; proved: at most {_at_most(one.value, kind)} {where}{gap}"
        return replace(check, because=said, proof=PROVED, bound=one.value)
    elif one.value <= USEFUL * limit:
        beyond = f"{_above(one.value, limit)} what is allowed"
        why = f"{_boxes(one.boxes)} bound it by {_at_most(one.value, kind)} only, {beyond}"
    else:
        why = one.ended or _too_few(one.boxes)
    return replace(check, because=f"{check.because}; {SEARCHED}: {why}", proof=SEARCHED, bound=one.value)


def _above(bound: float, value: float) -> str:
    """ "7.2 % above", "2.4 times"."""
    share = bound / value
    return f"{figures(100 * (share - 1), 2)} % above" if share < 2 else f"{figures(share, 2)} times"


def _too_few(boxes: int) -> str:
    if not boxes:
        return "with so many springs and excitations a proof takes longer than is spent on one here"
    return f"{_boxes(boxes)} {'does' if boxes == 1 else 'do'} not suffice for a proof"


def _boxes(number: int) -> str:
    return "one range of speed" if number == 1 else f"{number} ranges of speed"


def _at_most(value: float, kind: QuantityKind) -> str:
    """Four figures, rounded upward."""
    unit, size = eye_unit(value, kind)
    return shown(rounded_up(value / size) * size, kind, unit)


def bounded_checks(assembly: Assembly) -> Iterator[BoundedCheck]:
    """Those that compare peaks which are bounded."""
    for one in peak_limits(assembly):
        if one.rating:
            yield BoundedCheck(rating_name(one.element, one.key), one.places, one.per, KINDS.get(one.key, TORQUE))
        else:
            name = name_of(OneLimit(one.element, one.key, one.value, one.margin))
            yield BoundedCheck(name, one.places, one.per, LIMIT_KINDS[one.key])

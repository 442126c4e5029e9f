"""What changed between two descriptions, and what it did."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from trunnion.design.assessment.assess import checks_of, judgement, subject_of
from trunnion.design.assessment.assessment_input import AssessmentInput, with_torques
from trunnion.design.assessment.measures import rating_name
from trunnion.design.assessment.result import Assessment
from trunnion.design.comparison.result import Comparison, Difference
from trunnion.driveline.arguments import SpeedEnds, running_range
from trunnion.driveline.changes import changes
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit, stated_range
from trunnion.errors import InputError
from trunnion.modes.natural_frequencies import natural_frequencies
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.steady.orders.forced_response import shaft_names

RATING = "rating: "
RATED = rating_name("", "vibratory_torque")
"""What the names of checks of ratings begin with."""
Values = dict[str, tuple[str, float, str, float]]
"""By name: kind, value, unit, input speed."""


def compare(
    a: Driveline,
    b: Driveline,
    speeds: SpeedEnds | None = None,
    *,
    load_case: str | None = None,
    unit: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> Comparison:
    """What differs between two descriptions, and what that does to frequencies, stability, torques and checks.

    Elements are matched by their names, modes by their numbers.

    Parameters
    ----------
    a, b : before and after.
    speeds : lowest and highest input speed [rad/s] of both; default the range of each description, or of the other one
        where it has none.
    load_case : name of a load case of both; by default they are judged as stated and under each of their own.
    unit : of speeds in print; default the one of ``a``.
    progress : called as progress(share done).

    Raises
    ------
    InputError : a range that is reversed; no such load case; what is not a driveline.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)])
    >>> print(tn.compare(line, line.replace("Shaft 1", stiffness=1.21e4)))
    before → after: 1 change; no speeds are stated at which both could be judged
      Shaft 1, stiffness: 10 kN m/rad → 12.1 kN m/rad
      natural frequency of mode 1: 17.793 Hz → 19.5725 Hz (+10 %)
      damping ratio of mode 1: 0.01118 → 0.01016 (-9.09 %)
    """
    for name, line in (("a", a), ("b", b)):
        if not isinstance(line, Driveline):
            raise InputError("is not a driveline", key=name, value=type(line).__name__, remedy='tn.load("truck.toml")')
    spans = _spans(a, b, speeds)
    found: list[Values] = []
    judged: list[Assessment | None] = []
    said: list[Finding] = []
    for k, (line, span) in enumerate(zip((a, b), spans, strict=True)):
        values = dict(_modes(line if load_case is None else line.with_load(load_case), said))
        if span is not None:
            subject = subject_of(line, span, load_case, unit)
            subject = replace(subject, cases=tuple(with_torques(subject.cases, _every_torque(subject))))
            judged.append(judgement(subject, checks_of(subject)))
            values |= dict(_over_range(subject)) | dict(_rated(judged[-1])) | dict(_margins(judged[-1]))
        else:
            judged.append(None)
        found.append(values)
        if progress:
            progress((k + 1) / 2)
    names = (a.name or "before", b.name or "after")
    return Comparison(
        names=names if names[0] != names[1] else ("before", "after"),
        changes=changes(a, b),
        differences=tuple(_differences(*found)),
        assessments=(judged[0], judged[1]),
        unit=unit or speed_unit(a),
        findings=by_gravity({finding.sentence: finding for finding in said}.values()),
    )


def _spans(
    a: Driveline, b: Driveline, speeds: SpeedEnds | None
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    """Range of both; None where neither has one."""
    if speeds is not None:
        asked = running_range(speeds)
        return asked, asked
    first, second = stated_range(a), stated_range(b)
    return first or second, second or first


def _modes(line: Driveline, said: list[Finding]) -> Iterator[tuple[str, tuple[str, float, str, float]]]:
    try:
        found = natural_frequencies(line)
    except InputError as error:
        said.append(Finding(Gravity.CAUTION, str(error).splitlines()[0]))
        return
    modes = range(found.still, len(found.undamped_frequency))
    for m in modes:
        yield f"natural frequency of mode {m + 1}", ("frequency", float(found.frequency[m]), "rad/s", np.nan)
    for m in modes:
        if found.damping_ratio[m]:
            yield f"damping ratio of mode {m + 1}", ("damping ratio", float(found.damping_ratio[m]), "1", np.nan)


def _over_range(subject: AssessmentInput) -> Iterator[tuple[str, tuple[str, float, str, float]]]:
    """The largest growth rate, and the largest torques by all orders, under the load case that binds."""
    growths = [one for case in subject.cases if (one := case.largest_growth()) is not None]
    if growths:
        rate, speed = max(growths)
        yield "largest growth rate", ("growth rate", rate, "1/s", speed)
    cases = [case for case in subject.cases if case.response is not None]
    if not cases:
        return
    for c, spring in enumerate(shaft_names(cases[0].assembly)):
        for word in ("peak", "vibratory"):
            most = max((case.largest_torque(word, c) for case in cases), key=lambda found: found[0])
            yield f"{word} torque of {spring}", ("torque", most[0], "N*m", most[1])


def _rated(judged: Assessment | None) -> Iterator[tuple[str, tuple[str, float, str, float]]]:
    """The rated torque of every coupling with a rating: Σ S_f|T| over all orders, an upper bound."""
    for check in judged.checks if judged else ():
        if check.judged and check.name.startswith(RATED):
            yield check.name.removeprefix(RATING), ("torque", float(check.value), "N*m", float(check.speed))


def _every_torque(subject: AssessmentInput) -> tuple[tuple[str, int], ...]:
    springs = shaft_names(subject.cases[0].assembly)
    return tuple((word, c) for c in range(len(springs)) for word in ("peak", "vibratory"))


def _margins(judged: Assessment | None) -> Iterator[tuple[str, tuple[str, float, str, float]]]:
    for check in judged.checks if judged else ():
        if check.judged:
            yield f"margin of {check.name}", ("margin", float(check.margin), "1", float(check.speed))


def _differences(before: Values, after: Values) -> Iterator[Difference]:
    order = ("margin", "growth rate", "torque", "frequency", "damping ratio")
    names = dict.fromkeys([*before, *after])
    kinds = {name: (before.get(name) or after[name])[0] for name in names}
    for name in sorted(names, key=lambda one: order.index(kinds[one])):
        kind, _, unit, _ = before.get(name) or after[name]
        first, second = (one.get(name, ("", np.nan, "", np.nan)) for one in (before, after))
        yield Difference(name, kind, first[1], second[1], unit, first[3], second[3])

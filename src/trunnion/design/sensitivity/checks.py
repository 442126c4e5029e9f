"""How the value of a check follows parameters, at the speed where it binds.

A largest value over speed changes as its value at that speed does, to first order (the peak's own shift counts for
nothing): so the speed is made exact first, then the line is moved there along every parameter. Growth rates are
differentiated exactly through their Floquet modes, what is read from the response by order through its equations, both
where the line has a base motion that is known.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from trunnion.arrays import Array
from trunnion.design.assessment.assess import OF_RESPONSE, of_line, of_response
from trunnion.design.assessment.assessment_input import WHOLE, AssessmentInput, LoadCaseResponse, cases_of
from trunnion.design.assessment.check import Check
from trunnion.design.assessment.fatigue_life import NAME as FATIGUE
from trunnion.design.assessment.fatigue_life import fatigue_life
from trunnion.design.assessment.parametric import NAME as GROWTH
from trunnion.design.assessment.parametric import parametric_stability
from trunnion.design.assessment.separation import separation
from trunnion.design.sensitivity.differences import slope
from trunnion.design.sensitivity.directions import Direction, Neighbourhood, Neighbours, along_each
from trunnion.design.sensitivity.growth import radius_slope
from trunnion.design.sensitivity.responses import SpectrumSlope, spectrum_slopes
from trunnion.driveline.driveline import Driveline
from trunnion.errors import ComputationError, InputError
from trunnion.response.orders.response import response_of_spectrum

UNNAMED = replace(WHOLE, named=False)
"""Of lines beside the one that is judged, only numbers are asked for."""


@dataclass(frozen=True)
class CheckSlopes:
    """Derivatives of values and margins of checks by parameters (check, 2, direction), their errors, the speed
    (check,) [rad/s] where they were taken, value and margin there (check, 2); exact (check,): through Floquet modes or
    the equations of the response, not by differences; refused (check,): why a growth rate has none. NaN where a check
    has no value on both sides."""

    slope: Array
    error: Array
    speed: Array
    value: Array
    exact: tuple[bool, ...]
    refused: tuple[str, ...]


def check_slopes(
    subject: AssessmentInput,
    near: Neighbours,
    directions: Sequence[Direction],
    checks: Sequence[Check],
    progress: Callable[[float], None] | None = None,
) -> CheckSlopes:
    """Of every one of ``checks`` along every direction."""
    shape = (len(checks), 2, len(directions))
    slopes, errors = np.full(shape, np.nan), np.full(shape, np.nan)
    speeds, here = np.full(len(checks), np.nan), np.full((len(checks), 2), np.nan)
    exact, refused = [False] * len(checks), [""] * len(checks)
    cases = [next((one for one in subject.cases if one.name == c.load_case), subject.cases[0]) for c in checks]
    for c, check in enumerate(checks):
        speeds[c] = cases[c].peak(check.name, check.speed)
    values = _Values(subject, near, directions, checks, cases, speeds)
    for c, (check, case) in enumerate(zip(checks, cases, strict=True)):
        if check.name == GROWTH and not case.costly:
            slopes[c, 0], errors[c, 0], refused[c] = _growth(case, float(speeds[c]), directions)
            here[c], exact[c] = (check.value, check.margin), True
        else:
            here[c] = values.known(case, float(speeds[c]), check, ("", 0.0), subject.line)
            exact[c] = values.exact(case, check)
            look = partial(values.slope, case, float(speeds[c]), check)
            slopes[c], errors[c] = along_each(directions, look, (2,))
        if progress:
            progress((c + 1) / len(checks))
    return CheckSlopes(slopes, errors, speeds, here, tuple(exact), tuple(refused))


class _Values:
    """Values and margins of checks of changed lines, every line judged once at all the speeds where checks bind."""

    def __init__(
        self,
        subject: AssessmentInput,
        near: Neighbours,
        directions: Sequence[Direction],
        checks: Sequence[Check],
        cases: Sequence[LoadCaseResponse],
        speeds: Array,
    ) -> None:
        """``checks``, each of its load case (check,), bind at ``speeds`` (check,)."""
        self.subject, self.near, self.directions = subject, near, directions
        asked = {check.name for check in checks}
        self.rules = [
            rule
            for rule in (*OF_RESPONSE, separation)
            if any(one.name in asked for case in subject.cases for one in rule(subject, case))
        ]
        self.speeds = {
            case.name: np.unique([s for s, one in zip(speeds, cases, strict=True) if one is case and np.isfinite(s)])
            for case in cases
        }
        whole = [of_line, *([fatigue_life] if any(check.rule.name == FATIGUE for check in checks) else [])]
        self.whole = {check.name: rule for rule in whole for check in rule(subject)}
        self.of_response = {
            case.name: set() if case.costly else {check.name for check in of_response(subject, case)}
            for case in subject.cases
        }
        self.of_modes = {
            case.name: set() if case.costly else {check.name for check in separation(subject, case)}
            for case in subject.cases
        }
        self._seen: defaultdict[tuple[str, float, str, float], dict[str, Array]] = defaultdict(dict)
        self._around: dict[tuple[str, float], tuple[dict[str, SpectrumSlope | None], float]] = {}

    def exact(self, case: LoadCaseResponse, check: Check) -> bool:
        """Whether derivatives go through the equations of the response."""
        return check.name in self.of_response[case.name]

    def slope(self, case: LoadCaseResponse, speed: float, check: Check, one: Direction) -> tuple[Array, Array] | None:
        """Derivatives of value and margin by shares of the direction's size, and their errors."""
        exact = self.exact(case, check)
        around, pace = self._slopes_at(case, speed) if exact or check.name in self.of_modes[case.name] else ({}, 0.0)
        if (own := around.get(one.label)) is None:
            return slope(partial(self.at, case, speed, check, one))
        beside = partial(self.about, case, speed, check, one, own)
        # Separation asks the response for no more than which orders count.
        return own.slope(beside, pace) if exact else slope(beside)

    def about(
        self, case: LoadCaseResponse, speed: float, check: Check, one: Direction, around: SpectrumSlope, share: float
    ) -> Array | None:
        """Of the line moved along a direction, its response taken to first order; None where it is refused."""
        line = self.near.line(one, share) if share else self.subject.line
        if line is None:
            return None
        key = ("first order of", speed, f"{case.name}: {one.label}", share)
        if key not in self._seen:
            subject, own = _of(self.subject, case, line)
            own = replace(own, low=speed, high=speed, given=(speed,), known=around.response(own.assembly, share))
            one_case = replace(subject, cases=(own,))
            self._seen[key] = _read(self._by_case(one_case))
        return self._seen[key].get(check.name, np.full(2, np.nan))

    def _slopes_at(self, case: LoadCaseResponse, speed: float) -> tuple[dict[str, SpectrumSlope | None], float]:
        """How the response changes along every direction, and the fastest pace."""
        key = case.name, speed
        if key not in self._around:
            near = Neighbourhood(case.assembly)
            labels = [one.label for one in self.directions]
            every: dict[str, SpectrumSlope | None] = dict.fromkeys(labels)
            if np.isfinite(speed):
                under = [_under_load(case, one) for one in self.directions]
                every = dict(zip(labels, spectrum_slopes(near, speed, under), strict=True))
            self._around[key] = every, max((one.pace for one in every.values() if one is not None), default=0.0)
        return self._around[key]

    def at(self, case: LoadCaseResponse, speed: float, check: Check, one: Direction, share: float) -> Array | None:
        """Of the line moved along a direction, or as it is without a ``share``; None where it is refused."""
        line = self.near.line(one, share) if share else self.subject.line
        return None if line is None else self.known(case, speed, check, (one.label if share else "", share), line)

    def known(
        self, case: LoadCaseResponse, speed: float, check: Check, moved: tuple[str, float], line: Driveline
    ) -> Array:
        """Of a ``line`` that is ``moved`` along a direction by a share of its size."""
        whole = self.whole.get(check.name)
        key = ("", 0.0, *moved) if whole else (case.name, speed, *moved)
        if check.name not in self._seen[key]:
            subject, own = _of(self.subject, case, line)
            if whole:
                self._seen[key] |= _read(whole(subject))
            elif check.name == GROWTH and np.isfinite(speed):
                one = at_speed(subject, own, speed)
                self._seen[key] |= _read(parametric_stability(one, one.cases[0]))
            elif np.isfinite(speed):
                for at, one in _speed_by_speed(subject, own, self.speeds[case.name]):
                    self._seen[case.name, at, *moved] |= _read(self._by_case(one))
        return self._seen[key].setdefault(check.name, np.full(2, np.nan))

    def _by_case(self, one: AssessmentInput) -> Iterator[Check]:
        for rule in self.rules:
            yield from rule(one, one.cases[0])


def _speed_by_speed(
    subject: AssessmentInput, case: LoadCaseResponse, speeds: Array
) -> Iterator[tuple[float, AssessmentInput]]:
    """The same question at each of ``speeds`` (speed,) alone, of one load case, its response solved for all of them
    together."""
    answer = replace(case, low=float(speeds[0]), high=float(speeds[-1]), given=tuple(speeds.tolist())).answer
    for i, speed in enumerate(speeds.tolist()):
        one = at_speed(subject, case, speed)
        if not isinstance(answer, str):
            known = response_of_spectrum(case.assembly, answer.spectrum.take(slice(i, i + 1)), remarked=False)
            one = replace(one, cases=(replace(one.cases[0], known=known),))
        yield speed, one


def _read(found: Iterable[Check]) -> dict[str, Array]:
    return {one.name: np.array([one.value, one.margin]) for one in found}


def _growth(case: LoadCaseResponse, speed: float, directions: Sequence[Direction]) -> tuple[Array, Array, str]:
    near = Neighbourhood(case.assembly)
    try:
        found = radius_slope(near, near.row(speed), [_under_load(case, one) for one in directions])
    except (InputError, ComputationError) as error:
        none = np.full(len(directions), np.nan)
        return none, none, str(error).splitlines()[0]
    rate = speed / found.period
    return found.slope * rate, found.error * rate, found.refused


def _under_load(case: LoadCaseResponse, one: Direction) -> Direction:
    """A direction that leaves alone what the load case itself states, and moves what it multiplies by its factor."""
    line, labels = case.assembly.line, case.assembly.packed.labels
    if not case.name:
        return one
    stated = {f"{disk}.load_torque" for disk in line.loads_of(case.name)}
    factors = {
        f"{name}.{key}": factor
        for name, factor in line.factors_of(case.name).items()
        for key in getattr(line.elements[line.index(name)], "torque_keys", ())
    }
    kept = one.but(column for column, label in enumerate(labels) if label in stated)
    return kept.times({column: factors[label] for column, label in enumerate(labels) if label in factors})


def _of(subject: AssessmentInput, case: LoadCaseResponse, line: Driveline) -> tuple[AssessmentInput, LoadCaseResponse]:
    changed = replace(subject, line=line, cases=cases_of(line, subject.low, subject.high, UNNAMED))
    return changed, replace(next(c for c in changed.cases if c.name == case.name), rough=case.rough)


def at_speed(subject: AssessmentInput, case: LoadCaseResponse, speed: float) -> AssessmentInput:
    """The same question at one speed, of one load case."""
    one = replace(case, low=speed, high=speed, given=(speed,))
    return replace(subject, cases=(one,))

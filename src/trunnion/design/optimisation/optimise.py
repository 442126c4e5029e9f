"""The numbers of a line, within bounds, that are best in one aim or two and satisfy the checks."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from trunnion.design.assessment.assess import assess, subject_of
from trunnion.design.assessment.assessment_input import QUICK
from trunnion.design.optimisation.aims import Aim, DesignEvaluation, DesignProblem, UserAim, aims_of
from trunnion.design.optimisation.result import Optimum
from trunnion.design.optimisation.search import DesignSearch, EvaluatedDesign, first, front, nondominated, thinned
from trunnion.design.optimisation.space import Space
from trunnion.driveline.arguments import SpeedEnds, running_range, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit, stated_range
from trunnion.equations.coefficients import assemble
from trunnion.errors import ComputationError, InputError
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.waiting import OutOfTime, keep_time, keeps_time, time_kept

POINTS = 21
"""Points of a front at most."""
AT_BOUND = 1e-4
"""Share of the bounds nearer to one of which a number stands at it."""
ALIKE = 1e-9
"""Share by which torques under all load cases may differ from those under the cases that were searched."""
LOOKS = 4
"""Designs that tell which load cases come near the largest torque."""
RESERVE, LEAST = 2.0, 0.5
"""Of a time limit, what is kept for judging the best design, in times that one line takes; share of the time left that
the search gets at least."""
DESIGNS = 600
"""Designs of the search from everywhere; polishing adds to them."""


@keeps_time
def optimise(
    line: Driveline,
    free: Mapping[str, Sequence[object]],
    aims: str | UserAim | Sequence[str | UserAim],
    speeds: SpeedEnds | None = None,
    *,
    checks: bool | Iterable[str] = True,
    load_case: str | None = None,
    designs: int = DESIGNS,
    seed: int = 0,
    unit: str | None = None,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Optimum:
    """Choose numbers of the description, each within its bounds, for one aim or for two.

    Differential evolution from everywhere within the bounds, then Nelder and Mead's simplex from the best design. What
    comes out was computed anew as ``assess`` and the analyses do; that nothing better exists is not proved.

    Parameters
    ----------
    line : to start from; numbers that are not free stay as they are.
    free : path → (low, high), SI units or texts, as {"joint 2.angle": ("2 deg", "8 deg")}; a pattern as
        "Shaft *.stiffness" frees each number by itself, "factor of Shaft *.stiffness" all together. What ranges
        over more than a factor of ten is searched by its logarithm.
    aims : one or two of these. To be smallest: "irregularity" of the output, shafts rigid; "growth rate", the largest
        over the range; "peak torque of SPRING" and "vibratory torque of SPRING", the largest over the range and all
        load cases; or a function of a ``Driveline``. To be largest: "margin of CHECK", or "least spare margin" of all
        checks that decide.
    speeds : lowest and highest input speed [rad/s]; default the range of the description. "irregularity" needs none.
    checks : True: every check of ``assess`` that decides is to be satisfied; names: those; False or (): none. Without
        speeds nothing is judged.
    load_case : name of one of the line's load cases; by default all count.
    designs : computed in the search from everywhere, about; of two aims for each of them.
    seed : of the search; the same seed gives the same design.
    unit : of speeds in print; default the one of the description.
    within : seconds that it may take; the best design found until then is given, and ``ended`` says so.
    progress : called as progress(share done).

    Raises
    ------
    InputError : no such parameter, aim, check or load case; bounds that no line can have; no speeds where they are
        needed.
    ComputationError : no design within the bounds can be computed.
    OutOfTime : none was computed ``within`` its time.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.Driveline([
    ...     tn.ConstantSpeed(), tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1), tn.HookeJoint(angle="20 deg"),
    ...     tn.Shaft(stiffness=1e4, fork_offset="50 deg"), tn.Disk(inertia=0.1), tn.HookeJoint(angle="20 deg"),
    ...     tn.Shaft(stiffness=1e4), tn.Disk(inertia=0.1)])
    >>> best = tn.optimise(line, {"Shaft 2.fork_offset": ("-60 deg", "80 deg")}, "irregularity", designs=100)
    >>> bool(best.aim[0] < 1e-9), bool(abs(best.values["Shaft 2.fork_offset"]) < 1e-8)
    (True, True)
    """
    wanted = aims_of(line, aims)
    space = Space(assemble(line), free)
    designs, seed = whole_number(designs, "designs", 20), whole_number(seed, "seed", 0)
    span = _span(line, speeds, wanted)
    required_checks = _required_checks(checks)
    if span is not None:
        subject_of(line, span, load_case, unit)  # refuses speeds and load cases that there are not
    problem = DesignProblem(
        wanted, span, load_case, unit or speed_unit(line), required_checks if span is not None else frozenset()
    )
    _require_checks(line, problem, required_checks or frozenset())
    begun = time.monotonic()
    before = problem.answer(line)
    keep_time()
    # So that the best design can still be judged wholly.
    reserve = RESERVE * (time.monotonic() - begun)
    found, best, tried, ended = _in_time(space, problem, before, designs * len(wanted), seed, progress, reserve)
    after = _there(space, best)
    signs = np.array([-1.0 if aim.largest else 1.0 for aim in wanted])
    if progress:
        progress(1.0)
    return Optimum(
        line=after,
        free=tuple(one.label for one in space.free),
        units=tuple(one.unit for one in space.free),
        low=np.array([one.low for one in space.free]),
        high=np.array([one.high for one in space.free]),
        before=np.array([one.nominal for one in space.free]),
        value=space.values(best.shares),
        aims=tuple(aim.name for aim in wanted),
        aim_units=tuple(aim.unit for aim in wanted),
        largest=tuple(aim.largest for aim in wanted),
        aim_before=np.array(before.values),
        aim=signs * best.losses,
        front_value=np.array([space.values(one.shares) for one in found]),
        front=np.array([signs * one.losses for one in found]),
        broken=best.answer.broken,
        assessment=None if span is None else assess(after, span, load_case=load_case, unit=unit),
        designs=tried,
        seed=seed,
        findings=by_gravity(_findings(space, best, found)),
        ended=ended,
    )


def _in_time(
    space: Space,
    problem: DesignProblem,
    before: DesignEvaluation,
    most: int,
    seed: int,
    progress: Callable[[float], None] | None,
    reserve: float,
) -> tuple[list[EvaluatedDesign], EvaluatedDesign, int, str]:
    """The front, the design to take, how many were computed, and what ended the search before it was done: a time
    limit, of which ``reserve`` seconds are kept for judging the design. Where it left none, the line as it stands, of
    which the answer is ``before``, if that lies within the bounds."""
    made: list[DesignSearch] = []
    try:
        with time_kept(reserve, LEAST):
            return *_searched(space, problem, most, seed, progress, made), ""
    except OutOfTime as error:
        known = next((good for one in reversed(made) if (good := _possible(one))), [])
        if not known:
            known = _as_it_stands(space, problem, before)
        if not known:
            raise
        ended = error.why
    count = sum(len(one.tried) for one in made)
    found, best = _chosen(known)
    with suppress(OutOfTime):  # the values of the search then stand, which are those of a coarser grid
        best = _anew(DesignSearch(space, problem, most, seed, None), best)
    return (found if len(problem.aims) > 1 else [best]), best, count, ended


def _as_it_stands(space: Space, problem: DesignProblem, before: DesignEvaluation) -> list[EvaluatedDesign]:
    stated = np.array([one.nominal for one in space.free])
    if not (before.possible and np.allclose(space.values(space.start), stated, rtol=1e-9, atol=0.0)):
        return []
    signs = np.array([-1.0 if aim.largest else 1.0 for aim in problem.aims])
    return [EvaluatedDesign(space.start, before, signs * np.array(before.values))]


def _possible(search: DesignSearch) -> list[EvaluatedDesign]:
    """What a search has computed, without what cannot be."""
    return [one for one in search.tried.values() if one.answer.possible]


def _chosen(known: list[EvaluatedDesign]) -> tuple[list[EvaluatedDesign], EvaluatedDesign]:
    """The front of what is known so far, and the design to take."""
    if len(known[0].losses) == 1:
        best = min(known, key=lambda one: (one.answer.violation, one.losses[0]))
        return [best], best
    found = thinned(nondominated(known), POINTS)
    if not found:
        nearest = min(known, key=lambda one: one.answer.violation)
        return [nearest], nearest
    return found, _balanced(found)


def _searched(
    space: Space,
    problem: DesignProblem,
    most: int,
    seed: int,
    progress: Callable[[float], None] | None,
    made: list[DesignSearch],
) -> tuple[list[EvaluatedDesign], EvaluatedDesign, int]:
    """The front, the design to take, and how many were computed.

    Checks cost more than most aims, so the first search leaves them alone: where what it finds satisfies them, nothing
    better is left to find.
    """
    aims = replace(problem, required_checks=frozenset())
    before = 0
    if not aims.checking:
        found, best, before = _by_aims(space, aims, most, seed, progress, made)
        if not problem.checking or not any(problem.answer(_there(space, one)).violation for one in found):
            return found, best, before
    search = DesignSearch(space, problem, most, seed, progress)
    made.append(search)
    found, best = _found(search)
    return found, best, before + len(search.tried)


def _by_aims(
    space: Space,
    problem: DesignProblem,
    most: int,
    seed: int,
    progress: Callable[[float], None] | None,
    made: list[DesignSearch],
) -> tuple[list[EvaluatedDesign], EvaluatedDesign, int]:
    """The same without checks. Of torques the load cases that come near the largest are searched alone; where another
    one turns out to bind, it is taken in and the search begins anew."""
    cases = _near_cases(space, problem, seed) if problem.of_torques else None
    before = 0
    while True:
        search = DesignSearch(space, replace(problem, cases=cases or None), most, seed, progress)
        made.append(search)
        found, best = _found(search)
        before += len(search.tried)
        if not cases:
            return found, best, before
        other = [line for one in found if _differs(problem.answer(line := _there(space, one)), one.answer)]
        if not other:
            return found, best, before
        cases |= frozenset().union(*(problem.near_cases(line) for line in other))


def _differs(all_cases: DesignEvaluation, some: DesignEvaluation) -> bool:
    return not np.allclose(all_cases.values, some.values, rtol=ALIKE, atol=0.0)


def _near_cases(space: Space, problem: DesignProblem, seed: int) -> frozenset[str]:
    shares = np.random.default_rng(seed).random((LOOKS, len(space.free)))
    shares[0] = space.start
    lines = [line for one in shares if (line := space.line(one)) is not None]
    return frozenset[str]().union(*(problem.near_cases(line, QUICK) for line in lines))


def _there(space: Space, one: EvaluatedDesign) -> Driveline:
    line = space.line(one.shares)
    assert line is not None
    return line


def _anew(search: DesignSearch, one: EvaluatedDesign) -> EvaluatedDesign:
    """One design as ``assess`` judges it; raises what refuses the line, or says that no design can be computed."""
    found = search.whole(one.shares)
    if not found.answer.possible:
        line = search.space.line(one.shares)
        if line is not None:
            search.problem.require(line)
        raise ComputationError("no design within the bounds can be computed; narrow them, or ask for other aims")
    return found


def _found(search: DesignSearch) -> tuple[list[EvaluatedDesign], EvaluatedDesign]:
    """Designs of the front, computed anew, and the one to take: of two aims the one nearest to the best of both."""
    if len(search.problem.aims) == 1:
        best = _anew(search, search.best(first))
        return [best], best
    found = nondominated([search.whole(one.shares) for one in thinned(front(search), POINTS)])
    if not found:
        # Nothing holds all checks: the design that comes nearest to it.
        nearest = _anew(search, min(search.tried.values(), key=lambda one: one.answer.violation))
        return [nearest], nearest
    return found, _balanced(found)


def _balanced(found: list[EvaluatedDesign]) -> EvaluatedDesign:
    """The design of a front that is nearest to the best of all aims."""
    losses = np.array([one.losses for one in found])
    off = (losses - losses.min(axis=0)) / np.maximum(np.ptp(losses, axis=0), 1e-300)
    return found[int(np.argmin(np.linalg.norm(off, axis=1)))]


def _span(line: Driveline, speeds: SpeedEnds | None, aims: Sequence[Aim]) -> tuple[float, float] | None:
    span = stated_range(line) if speeds is None else running_range(speeds)
    if span is not None:
        return span
    needing = next((aim.name for aim in aims if aim.over_range), None)
    if needing is not None:
        remedy = "speeds=(tn.rpm(300), tn.rpm(2400)), say"
        raise InputError(f"is needed for the aim {needing}", key="speeds", remedy=remedy)
    return None


def _required_checks(checks: object) -> frozenset[str] | None:
    if checks is True:
        return None
    if checks is False:
        return frozenset()
    if not isinstance(checks, Iterable):
        raise InputError("must be True, False or names", key="checks", value=checks, remedy='["max torque of shaft"]')
    return frozenset((checks,) if isinstance(checks, str) else checks)


def _require_checks(line: Driveline, problem: DesignProblem, required_checks: frozenset[str]) -> None:
    """Refuse names of checks that the line has not."""
    named = {aim.name.removeprefix("margin of ") for aim in problem.aims if aim.name.startswith("margin of ")}
    named |= required_checks
    if not named:
        return
    if problem.speeds is None:
        raise InputError("are judged over a range of speeds", key="checks", remedy="give speeds")
    known = [c.name for c in assess(line, problem.speeds, load_case=problem.load_case).checks]
    for name in sorted(named):
        if name not in known:
            raise InputError(
                "is not a check of this line", key="checks", value=name, remedy=f"there are {', '.join(known)}"
            )


def _findings(space: Space, best: EvaluatedDesign, found: Sequence[EvaluatedDesign]) -> Iterator[Finding]:
    if best.answer.broken:
        yield Finding(
            Gravity.DANGER,
            f"No design within the bounds was found that satisfies {', '.join(best.answer.broken)}; this one comes "
            "nearest.",
        )
    for one, share in zip(space.free, best.shares, strict=True):
        if min(share, 1 - share) < AT_BOUND:
            side = "lowest" if share < 0.5 else "largest"
            yield Finding(Gravity.NOTE, f"{one.label} stands at its {side} bound: a wider one may give more.")

"""How frequencies, stability, torques, tips of tongues and checks follow every number of a description."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array
from trunnion.design.assessment.assess import checks_of, subject_of
from trunnion.design.assessment.check import Check, Status
from trunnion.design.assessment.parametric import NAME as GROWTH
from trunnion.design.sensitivity.checks import check_slopes
from trunnion.design.sensitivity.directions import Direction, Neighbourhood, Neighbours, directions_of
from trunnion.design.sensitivity.growth import radius_slope
from trunnion.design.sensitivity.modes import mode_slopes
from trunnion.design.sensitivity.result import (
    DIFFERENCES,
    EXACT,
    Sensitivities,
    SensitivityQuantity,
    SensitivityRows,
)
from trunnion.design.sensitivity.tips import tip_slopes
from trunnion.design.sensitivity.torques import exact_torque_slopes, own_motion_growth, slopes, torques
from trunnion.driveline.arguments import several, speeds_of
from trunnion.driveline.converter_balance import refuse_converters
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import operating_speed, speed_unit, stated_range
from trunnion.driveline.parameters import Parameter
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.released import NOT_ALIKE, refuse_pendulums
from trunnion.equations.steady_base import has_periodic_base, require_own_motion
from trunnion.errors import ComputationError, InputError
from trunnion.features import left_out
from trunnion.floquet.tongues.result import Tongues
from trunnion.results.finding import Finding, Gravity, by_gravity
from trunnion.results.words import Words
from trunnion.steady.free.periodic_steady_states import SteadyStatesBySpeed
from trunnion.steady.orders.forced_response import shaft_names

KINDS = ("frequencies", "growth", "torques", "checks")
OWN_MOTION = "Growth rates are those about the line's own periodic motion, without its excitations."
MOST_CHECKS = 6
"""Checks that are differentiated unless they are named."""


def sensitivity(
    line: Driveline,
    speeds: ArrayLike | None = None,
    parameters: Iterable[str | Parameter] | None = None,
    *,
    of: Iterable[str] = KINDS,
    checks: Iterable[str] | None = None,
    tips: Tongues | None = None,
    load_case: str | None = None,
    about_steady_state: bool = False,
    unit: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> Sensitivities:
    """Derivatives of what the line does by the numbers of its description, plain and logarithmic, ranked.

    These are exact: natural frequencies and damping ratios, through the modes; growth rates, through the Floquet mode
    and its adjoint; torques and their limits, through the equations of the response; tips, by implicit
    differentiation. Other checks, growth rates about a line's own motion, and the torques of free–free lines with joint
    angles take differences of fourth order.

    Parameters
    ----------
    line : whose numbers are varied.
    speeds : input speed or speeds [rad/s] of growth rates and torques; default the operating speed of the description,
        or the ends of its range, or none.
    parameters : paths; "HookeJoint *.angle" is each joint's, "factor of Shaft *.damping" all together; default
        every number that the description states, zeros of angles included.
    of : any of "frequencies", "growth", "torques", "checks".
    checks : names of checks of ``assess``; default the six with the least to spare. They are judged over the range of
        the description, or else over that of ``speeds``.
    tips : ``tongues`` of this line with the speed along an axis: where they close.
    load_case : name of one of the line's load cases.
    about_steady_state : growth rates about the line's own periodic motion, as in ``stability``; nothing else is.
    unit : of speeds in print; default the one of the description.
    progress : called as progress(share done).

    Raises
    ------
    InputError : no such parameter, check or load case; speeds that are not positive; a line that an analysis asked for
        refuses, if nothing else was asked for; ``about_steady_state`` without growth rates, or with
        straight joints.

    Examples
    --------
    >>> import trunnion as tn
    >>> parts = [tn.ConstantSpeed(), tn.Shaft(stiffness=1e4, damping=2.0), tn.Disk(inertia=0.8)]
    >>> found = tn.sensitivity(tn.Driveline(parts), of=["frequencies"])
    >>> print(found)
    sensitivity of 2 quantities to 4 parameters
      natural frequency of mode 1 (17.793 Hz): +0.5 % for +1 % of Shaft 1.stiffness, \
-0.5 % for +1 % of Disk 1.inertia, -0.000125 % for +1 % of Shaft 1.damping
      damping ratio of mode 1 (0.01118): +1 % for +1 % of Shaft 1.damping, -0.5 % for +1 % of Disk 1.inertia, \
-0.5 % for +1 % of Shaft 1.stiffness
    """
    kinds = _kinds(of)
    if about_steady_state and "growth" not in kinds:
        raise InputError(
            "belongs to growth rates", key="about_steady_state", value=True, remedy='leave it out, or add of=["growth"]'
        )
    stated = line if load_case is None else line.with_load(load_case)
    refuse_pendulums(stated, NOT_ALIKE)
    refuse_converters(stated, "derivatives do")
    problem = _SensitivityProblem(
        line=stated, at=_speeds(stated, speeds), directions=directions_of(assemble(stated), parameters),
        load_case=load_case, unit=unit or speed_unit(line), about_steady_state=about_steady_state,
    )  # fmt: skip
    if about_steady_state:
        require_own_motion(problem.assembly, problem.near.row())
    parts: dict[str, Callable[[], Iterator[SensitivityRows]]] = {
        "frequencies": partial(mode_slopes, problem.near, problem.directions),
        "growth": partial(_growth, problem),
        "torques": partial(_torques, problem),
        "checks": partial(_checks, problem, line, checks),
    }
    rows: list[SensitivityRows] = []
    refusals: list[TrunnionProblem] = []
    for k, kind in enumerate(kinds):
        problem.progress = partial(_report_part, progress, k, len(kinds))
        try:
            rows += parts[kind]()
        except (InputError, ComputationError) as error:
            if kind == "checks" and checks is not None:
                raise
            refusals.append(error)
    if tips is not None:
        if not isinstance(tips, Tongues):
            raise InputError("are not tongues", key="tips", value=tips, remedy="tips=tn.tongues(line, …)")
        rows += tip_slopes(problem.near, tips, problem.directions)
    if not rows and refusals:
        raise refusals[0]
    said = [Finding(Gravity.CAUTION, str(error).splitlines()[0]) for error in refusals]
    return _result(problem, rows, [*said, *problem.findings, *_left_out(stated, kinds)])


TrunnionProblem = InputError | ComputationError
ANALYSES = {"frequencies": "natural_frequencies", "growth": "stability", "torques": "order_response"}


@dataclass
class _SensitivityProblem:
    """The line under its load case, speeds (speed,) and directions; findings that come up on the way."""

    line: Driveline
    at: Array
    directions: tuple[Direction, ...]
    load_case: str | None
    unit: str
    about_steady_state: bool
    progress: Callable[[float], None] = lambda share: None
    findings: list[Finding] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.assembly: Assembly = assemble(self.line)
        self.near, self.lines = Neighbourhood(self.assembly), Neighbours(self.assembly)

    def shown(self, speed: float) -> str:
        return Words(self.unit).speed(float(f"{speed:.12g}"))


def _report_part(progress: Callable[[float], None] | None, part: int, parts: int, share: float) -> None:
    if progress:
        progress((part + share) / parts)


def _kinds(of: Iterable[str]) -> tuple[str, ...]:
    asked = several(of, "of", f"use {', '.join(KINDS)}")
    for one in asked:
        if one not in KINDS:
            raise InputError("is nothing to differentiate", key="of", value=one, remedy=f"use {', '.join(KINDS)}")
    return tuple(kind for kind in KINDS if kind in asked)


def _speeds(line: Driveline, speeds: ArrayLike | None) -> Array:
    if speeds is None:
        operation = line.operation
        if operation is None or (operation.speed is None and not operation.speed_range):
            return np.zeros(0)
        return np.array([operation.speed] if operation.speed is not None else operation.speed_range, dtype=float)
    at = speeds_of(speeds, "tn.rpm(1500)")
    return np.array([operating_speed(line, float(one)) for one in at])


def _growth(problem: _SensitivityProblem) -> Iterator[SensitivityRows]:
    if problem.about_steady_state or has_periodic_base(problem.assembly):
        # Its periodic steady state follows every parameter, so lines beside it are judged.
        if len(problem.at):
            like = SteadyStatesBySpeed(problem.line)
            here, slope, error = _by_differences(problem, partial(own_motion_growth, like))
            problem.findings.append(Finding(Gravity.NOTE, OWN_MOTION))
            for k, speed in enumerate(problem.at.tolist()):
                yield _stability_rows(problem, speed, DIFFERENCES, "", here[:, k], slope[:, k], error[:, k])
        return
    for speed in problem.at.tolist():
        found = radius_slope(problem.near, problem.near.row(speed), problem.directions)
        by = np.array([speed / found.period, found.radius])
        yield _stability_rows(
            problem, speed, EXACT, found.refused, np.array([found.growth_rate(speed), found.radius]),
            by[:, None] * found.slope, by[:, None] * found.error,
        )  # fmt: skip


def _by_differences(
    problem: _SensitivityProblem, look: Callable[[Array, Driveline], Array]
) -> tuple[Array, Array, Array]:
    """What ``look`` sees of the line at the speeds, its derivatives and errors."""
    values = partial(look, problem.at)
    return values(problem.line), *slopes(values, problem.lines, problem.directions, problem.progress)


def _stability_rows(
    problem: _SensitivityProblem, speed: float, method: str, refused: str, value: Array, slope: Array, error: Array
) -> SensitivityRows:
    at = f"at {problem.shown(speed)}"
    both = [
        SensitivityQuantity(f"{kind} {at}", kind, v, unit, method, speed, refused)
        for kind, unit, v in zip(("growth rate", "spectral radius"), ("1/s", "1"), value.tolist(), strict=True)
    ]
    return SensitivityRows(both, slope, error)


def _torques(problem: _SensitivityProblem) -> Iterator[SensitivityRows]:
    if not len(problem.at):
        return
    exact = not has_periodic_base(problem.assembly)
    if exact:
        here, slope, error = exact_torque_slopes(
            problem.near, problem.lines, problem.at, problem.directions, problem.progress
        )
    else:
        here, slope, error = _by_differences(problem, torques)
    springs, words = shaft_names(problem.assembly), ("peak torque", "vibratory torque")
    for w, v, s in np.ndindex(here.shape):
        speed, value = float(problem.at[v]), float(here[w, v, s])
        name = f"{words[w]} of {springs[s]} at {problem.shown(speed)}"
        why = "" if np.isfinite(value) else "there is no steady state"
        one = SensitivityQuantity(name, "torque", value, "N*m", EXACT if exact else DIFFERENCES, speed, why)
        yield SensitivityRows([one], slope[w, v, s], error[w, v, s])


def _checks(problem: _SensitivityProblem, line: Driveline, names: Iterable[str] | None) -> Iterator[SensitivityRows]:
    span = None
    if stated_range(line) is None:
        if not len(problem.at):
            return
        span = (float(problem.at.min()), float(problem.at.max()))
    subject = subject_of(line, span, problem.load_case, problem.unit)
    chosen = _chosen(checks_of(subject), names)
    found = check_slopes(subject, problem.lines, problem.directions, chosen, problem.progress)
    for c, check in enumerate(chosen):
        method, at = EXACT if found.exact[c] else DIFFERENCES, float(found.speed[c])
        value, margin = found.value[c].tolist()
        both = [SensitivityQuantity(check.name, "check", value, check.unit, method, at, found.refused[c])]
        if check.name != GROWTH or not found.exact[c]:  # its margin follows another speed's straight line besides
            both.append(SensitivityQuantity(f"margin of {check.name}", "margin", margin, "1", method, at))
        yield SensitivityRows(both, found.slope[c, : len(both)], found.error[c, : len(both)])


def _chosen(every: tuple[Check, ...], names: Iterable[str] | None) -> list[Check]:
    judged = [c for c in every if c.status in (Status.SATISFIED, Status.EXCEEDED) and np.isfinite(c.value)]
    if names is None:
        return judged[:MOST_CHECKS]
    known = {check.name: check for check in judged}
    chosen = []
    for name in several(names, "checks", 'checks=["uniformity"], say'):
        if name not in known:
            problem = "is not judged" if any(c.name == name for c in every) else "is not a check of this line"
            remedy = f"there are {', '.join(known)}" if known else "nothing is judged; state limits"
            raise InputError(problem, key="checks", value=name, remedy=remedy)
        chosen.append(known[name])
    return chosen


def _left_out(line: Driveline, kinds: Sequence[str]) -> list[Finding]:
    return [finding for kind in kinds if kind in ANALYSES for finding in left_out(ANALYSES[kind], line)]


def _result(
    problem: _SensitivityProblem, rows: Sequence[SensitivityRows], findings: Sequence[Finding]
) -> Sensitivities:
    width = len(problem.directions)
    once = {finding.sentence: finding for finding in findings}
    return Sensitivities(
        quantities=tuple(q for part in rows for q in part.quantities),
        parameters=tuple(one.label for one in problem.directions),
        parameter_value=np.array([one.value for one in problem.directions]),
        parameter_unit=tuple(one.unit for one in problem.directions),
        derivative=np.concatenate([part.slope.reshape(-1, width) for part in rows] or [np.zeros((0, width))]),
        error=np.concatenate([part.error.reshape(-1, width) for part in rows] or [np.zeros((0, width))]),
        unit=problem.unit,
        findings=by_gravity(once.values()),
    )

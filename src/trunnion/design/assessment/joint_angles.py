"""Angles of propeller-shaft joints and how evenly the line turns, after the makers' rules of practice.

    every working angle at least 0.5°                           so that needle bearings turn
    at most 3.2° at 5000, 3.7° at 4500, 4.2° at 4000, 5.0° at 3500 rpm
    at most 5°50′ at 3000, 7° at 2500, 8°40′ at 2000, 11°30′ at 1500, 1000 and 500 rpm; 3° beyond 5000 rpm
    two joints: both angles equal within 1°
    angular acceleration behind the last joint ≤ 300 rad/s², of a shaft between joints ≤ 1000 rad/s²
    U = (largest − smallest output speed)/mean ≤ 0.0027     (Elbe), the irregularity of one joint of 2.98°, sin β tan β

The angles from 3500 rpm up are those of Spicer's operating-angle calculator, which allows 3° at any speed; those up to
3000 rpm are "Spicer universal joint operating angles" as Parker Chelsea prints them for auxiliary shafts (bulletin
HY25-1890-M1/US, page 5). From 1500 to 3500 rpm all of them hold one acceleration, β²ω² = 1000 rad/s² within 3 %.
Between rows they are taken on straight lines; below 500 rpm, where the table begins, a larger angle than 11°30′ is not
judged. The two accelerations are usual acceptance values. All are taken at the highest speed of the range.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from trunnion.design.assessment.assessment_input import AssessmentInput
from trunnion.design.assessment.check import Check, Rule, Status, above, judged
from trunnion.design.assessment.compared import guideline
from trunnion.driveline.driveline import Driveline, hooke_joints
from trunnion.driveline.quantities import DEGREE, RPM
from trunnion.driveline.rules import RULES, SPICER
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.response.kinetostatics import Kinetostatics, kinetostatics
from trunnion.response.kinetostatics.limits import EVEN_RUNNING
from trunnion.response.kinetostatics.measures import ROUNDING, largest
from trunnion.response.kinetostatics.up_to_ties import UpToTies, up_to_ties
from trunnion.results.counts import few

SMALLEST, EASY, APART = 0.5 * DEGREE, 3.0 * DEGREE, 1.0 * DEGREE
TABLE_SPEED = np.array([500.0, 1000.0, 1500.0, 2000.0, 2500.0, 3000.0, 3500.0, 4000.0, 4500.0, 5000.0]) * RPM
TABLE_ANGLE = np.array([11.5, 11.5, 11.5, 8 + 2 / 3, 7.0, 5 + 5 / 6, 5.0, 4.2, 3.7, 3.2]) * DEGREE
TORSIONAL, INERTIAL = 300.0, 1000.0
"""Usual acceptance [rad/s²]."""
LEAST = Rule("β ≥ 0.5°", SPICER, "typical", "spicer-angles")
MOST = Rule(
    "β ≤ 11.5° up to 1500, 8.67° at 2000, 7° at 2500, 5.83° at 3000, 5° at 3500, 4.2° at 4000, 3.7° at 4500, 3.2° at "
    "5000 rpm, 3° beyond",
    RULES["spicer-angles"].source, "typical", "spicer-angles",
)  # fmt: skip
EQUAL = Rule("|β₁ − β₂| ≤ 1°", SPICER, "typical", "equal-angles")
ACCELERATIONS = ("usual acceptance", "typical", "acceptance-accelerations")
SHAKES = Rule("acceleration behind the last joint ≤ 300 rad/s²", *ACCELERATIONS)
TURNS = Rule("acceleration of a shaft between joints ≤ 1000 rad/s²", *ACCELERATIONS)
EVEN = Rule("U = (n_max − n_min)/n ≤ 0.0027", "Elbe, Cardan shafts", "typical", "elbe-uniformity")


@dataclass(frozen=True)
class RigidTurn:
    """The rigid line over its turns at the highest speed, ``part`` of it where differentials or loops let no more turn
    by the input alone; or why it is not known."""

    turn: Kinetostatics | InputError
    part: UpToTies

    @property
    def said(self) -> str:
        """What a number read off it leaves out, to follow that number."""
        said = f", up to {few(self.part.ties)}" if self.part.ties else ""
        turn = self.turn
        if isinstance(turn, Kinetostatics) and turn.turns % turn.repeats_after:
            said += f", in the first {turn.turns} of the {turn.repeats_after} turns after which it repeats"
        return said

    def behind(self, line: Driveline) -> str:
        """Joints of the line that turn otherwise than by the input alone, in words."""
        return few([name for name, _ in hooke_joints(line) if name in self.part.behind])


def turn_of(subject: AssessmentInput) -> RigidTurn:
    """The line of ``subject``, turned."""
    part = up_to_ties(subject.line)
    try:
        return RigidTurn(kinetostatics(part.line, subject.high), part)
    except InputError as error:
        return RigidTurn(error, part)


def allowed_angle(speed: float) -> float:
    """Largest angle [rad] at a joint's own speed [rad/s]; below the table that of its first row."""
    return float(np.interp(speed, TABLE_SPEED, TABLE_ANGLE)) if speed <= TABLE_SPEED[-1] else EASY


def joint_angles(subject: AssessmentInput, assembly: Assembly, rigid: RigidTurn) -> Iterator[Check]:
    """The rules for every Hooke's joint, and for the line's accelerations at its highest speed."""
    joints = hooke_joints(subject.line)
    if not joints:
        yield Check("joint angles", Status.NOT_APPLICABLE, MOST, "the line has no Hooke's joint")
        return
    topo = assembly.topology
    places = [j for j in topo.joints if subject.line.elements[topo.stations[j].element].kind == "HookeJoint"]
    ratios = [abs(float(topo.speed_ratio[j])) for j in places]
    for (name, angle), ratio in zip(joints, ratios, strict=True):
        yield from _one(subject, name, abs(angle), ratio * subject.high)
    yield _equal_angles(subject, joints, ratios)
    if isinstance(rigid.turn, Kinetostatics):
        yield from _accelerations(subject, assembly, rigid, rigid.turn)
        yield from _shared(subject, "acceleration", SHAKES, rigid)
    else:
        yield _unknown(subject, "acceleration behind the joints", SHAKES, rigid.turn)


def _equal_angles(subject: AssessmentInput, joints: Sequence[tuple[str, float]], ratios: Sequence[float]) -> Check:
    """Two joints one behind the other, on shafts of one speed: nothing else can cancel."""
    because = ""
    if len(joints) != 2:
        because = "the rule is for two joints; uniformity judges the line"
    elif not _behind(subject.line, joints[1][0], joints[0][0]):
        because = "the two joints are on different branches; uniformity judges each"
    elif abs(ratios[0] - ratios[1]) > 1e-9 * ratios[0]:
        because = (
            "the two joints turn at different speeds, so that neither cancels the other; uniformity judges the line"
        )
    if because:
        return Check("equal joint angles", Status.NOT_APPLICABLE, EQUAL, because)
    angles = [abs(angle) for _, angle in joints]
    said = f"{angles[0] / DEGREE:.4g} and {angles[1] / DEGREE:.4g} deg"
    return guideline("equal joint angles", EQUAL, (abs(angles[0] - angles[1]), APART, "rad"), said)


def _path(line: Driveline, name: str) -> list[int]:
    """Elements from the first to the one called ``name``."""
    element: int | None = line.names.index(name)
    path: list[int] = []
    while element is not None:
        path.append(element)
        element = line.parents[element]
    return path[::-1]


def _behind(line: Driveline, name: str, other: str) -> bool:
    return line.names.index(other) in _path(line, name)


def _unknown(subject: AssessmentInput, title: str, rule: Rule, why: InputError) -> Check:
    """Of a turn that cannot be computed; where two speeds are prescribed nothing is left to be judged."""
    if any(element.kind == "ConstantSpeed" for element in subject.line.elements[1:]):
        return Check(title, Status.NOT_APPLICABLE, rule, "the output is prescribed")
    return Check(title, Status.NOT_JUDGED, rule, f"{why.element or 'the line'} {why.problem}")


def _shared(subject: AssessmentInput, what: str, rule: Rule, rigid: RigidTurn) -> Iterator[Check]:
    """Joints behind a differential are turned by both of its legs."""
    if joints := rigid.behind(subject.line):
        because = f"not judged: behind {few(rigid.part.ties)} shafts turn by more than the input alone"
        yield Check(f"{what} behind {joints}", Status.NOT_JUDGED, rule, because)


def _one(subject: AssessmentInput, name: str, angle: float, speed: float) -> Iterator[Check]:
    said = f"{angle / DEGREE:.4g} deg"
    margin = above(angle, SMALLEST)
    yield Check(
        f"smallest angle of {name}", judged(margin), LEAST, f"{said} against 0.5 deg", margin=margin, value=angle,
        limit=SMALLEST, unit="rad", element=name,
    )  # fmt: skip
    limit = allowed_angle(speed)
    title, at = f"angle of {name}", f"at {subject.shown(speed)} of its shaft"
    if angle > limit and speed < TABLE_SPEED[0]:
        because = f"{said} {at}: the table begins at {subject.shown(float(TABLE_SPEED[0]))}"
        yield Check(title, Status.NOT_APPLICABLE, MOST, because)
        return
    numbers = f"{said} against {limit / DEGREE:.3g} deg {at}"
    yield guideline(title, MOST, (angle, limit, "rad"), numbers, speed=subject.high, element=name)


def _accelerations(
    subject: AssessmentInput, assembly: Assembly, rigid: RigidTurn, turn: Kinetostatics
) -> Iterator[Check]:
    topo, line = assembly.topology, subject.line
    ratios = {topo.stations[j].element: abs(float(topo.speed_ratio[j])) for j in topo.joints}
    for branch in turn.branches:
        bent = [element for element in _path(line, branch) if element in ratios]
        if not bent:  # nothing on the way there shakes it
            continue
        end = turn.on_branch(branch)
        value = float(end.peak_acceleration) * ratios[bent[-1]] / abs(end.mean_ratio)
        where = f" on the way to {branch}" if len(turn.branches) > 1 else ""
        yield _acceleration(subject, f"acceleration behind the joints{where}", SHAKES, value, TORSIONAL, rigid.said)
    elements = enumerate(zip(turn.shafts, turn.shaft_elements, strict=True))
    between = [(s, name) for s, (name, element) in elements if _between(line, element, set(ratios))]
    if inner := [(float(largest(turn.acceleration[s])), name) for s, name in between if np.any(turn.acceleration[s])]:
        value, name = max(inner)
        yield _acceleration(subject, f"acceleration between the joints, {name}", TURNS, value, INERTIAL, rigid.said)


def _between(line: Driveline, shaft: str, joints: set[int]) -> bool:
    """Whether an element that is a shaft has joints in front of it and behind it."""
    place = line.names.index(shaft)
    behind = any(place in _path(line, line.names[joint])[:-1] for joint in joints)
    return behind and any(element in joints for element in _path(line, shaft))


def _acceleration(subject: AssessmentInput, title: str, rule: Rule, value: float, limit: float, said: str) -> Check:
    value = value if value > ROUNDING * subject.high**2 else 0.0
    numbers = f"{value:.4g} rad/s² against {limit:g} rad/s² at {subject.shown(subject.high)}{said}"
    return guideline(title, rule, (value, limit, "rad/s^2"), numbers, speed=subject.high, inputs="rigid shafts")


def uniformity(subject: AssessmentInput, rigid: RigidTurn) -> Iterator[Check]:
    """U at the end of every branch, shafts rigid."""
    if not hooke_joints(subject.line):
        yield Check("uniformity", Status.NOT_APPLICABLE, EVEN, "the line has no Hooke's joint")
        return
    turn = rigid.turn
    if not isinstance(turn, Kinetostatics):
        yield _unknown(subject, "uniformity", EVEN, turn)
        return
    for branch in turn.branches:
        end = turn.on_branch(branch)
        u = end.irregularity
        angle = end.equivalent_angle / DEGREE
        numbers = f"U = {u:.4g} against 0.0027, as one joint of {angle:.3g} deg{rigid.said}"
        title = "uniformity" if len(turn.branches) == 1 else f"uniformity of {branch}"
        yield guideline(title, EVEN, (u, EVEN_RUNNING, "1"), numbers, inputs="rigid shafts")
    yield from _shared(subject, "uniformity", EVEN, rigid)

"""A proof that every line within its tolerances is stable over a range of speeds, or a line that is not.

The whole box of speeds and tolerances is tried at once, by the energy of the mean line and by a periodic Lyapunov
function; where neither proves it, it is halved across the side that brings most of what stands against it, and so are
its halves. A box whose middle ``stability`` calls unstable ends the search: that line is the counterexample.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import SpeedEnds, rising_range, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.coupling_tables import refuse_torque_tables
from trunnion.equations.steady_base import (
    has_joint_angles,
    refuse_dragged,
    require_steady_base,
    require_tree,
)
from trunnion.equations.topology import LinkKind
from trunnion.errors import ComputationError, InputError
from trunnion.features import left_out
from trunnion.floquet.certificate.box_space import BoxSpace, halved, volume
from trunnion.floquet.certificate.judge import JudgedBox, judge
from trunnion.floquet.certificate.own_requirements import about_own_motion, require_enclosed
from trunnion.floquet.certificate.requirements import require_linear
from trunnion.floquet.certificate.working_stages import working_stages
from trunnion.floquet.tolerance.parameter_intervals import table_at
from trunnion.floquet.tolerance.spread import Tolerances, read_tolerances
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, internal, labelled, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.results.verdict import Verdict
from trunnion.waiting import keeps_time, time_is_up, to_the_end

if TYPE_CHECKING:
    from trunnion.floquet.certificate.own_judge import OwnMotionLine

WIDENED = 1.3
"""By how much wider than the last box the next speeds are tried, about a line's own motion."""


@labelled
class StabilityCertificate(Result):
    """What was proved of all lines within tolerances at all speeds from one to another.

    Boxes have the speed first. ``unstable_line`` is the counterexample as a ``Driveline``.
    """

    parameters: tuple[str, ...] = internal("that scatter")
    speeds: tuple[float, float] = attribute("from one to another", "rad/s")
    verdict: str = attribute('"proved stable", "counterexample" or "undecided"')
    undecided_share: float = attribute("of the volume in ln(speed) and shares of tolerances")
    counterexample: dict[str, float] | None = internal("values by name of a line that ``stability`` calls unstable")
    boxes: int = attribute("how many were judged")
    undecided_low: Array = variable("open_box variable", words="what stays open, SI units", name="low")
    undecided_high: Array = variable("open_box variable", words="what stays open, SI units", name="high")
    proved_low: Array = variable("proved_box variable", words="what was proved, SI units")
    proved_high: Array = variable("proved_box variable", words="what was proved, SI units")
    about_own_motion: bool = attribute("about the periodic motion that the line makes, not that without vibration")
    decay: float = variable("", "1/s", "rate at which every disturbance in what was proved dies out at least")
    units: tuple[str, ...] = internal("of the parameters")
    unit: str = internal("of speeds in print")
    findings: tuple[Finding, ...] = internal("what of the line is left out", default=())
    ended: str = attribute("what ended the search before its last box, as a clause", default="")
    unstable_line: Driveline | None = internal("the counterexample", default=None)
    stages: tuple[str, ...] = attribute("in which springs with stages work where proved, a clause each", default=())

    def declared(self) -> Iterator[Variable | Attribute]:
        """The verdict, the counterexample, and the boxes that stay open."""
        names, known = ["speed", *self.parameters], self.counterexample or {}
        yield Coordinate("variable", names, "variable")
        yield Coordinate("open_box", np.arange(len(self.undecided_low)), "open_box")
        yield Coordinate("proved_box", np.arange(len(self.proved_low)), "proved_box")
        yield Variable("counterexample", np.array([known.get(name, np.nan) for name in names]), "variable")
        yield from super().declared()

    @property
    def ends(self) -> tuple[Array, Array]:
        """Lowest and highest speed [rad/s] and parameters (1 + parameters,), SI units."""
        low, high = np.vstack([self.proved_low, self.undecided_low]), np.vstack([self.proved_high, self.undecided_high])
        return low.min(axis=0), high.max(axis=0)

    def plot(self, axes: Axes | None = None) -> Axes:
        """What is proved and what is left open; see ``pictures.design.certificate``."""
        return drawing(self, "plot")(self, axes)

    def _lines(self) -> Iterator[str]:
        count = len(self.parameters)
        many = f"{count} tolerance{'s' if count > 1 else ''}"
        what = f"{many}, from {self.words.ends(*self.speeds)}" if count else f"from {self.words.ends(*self.speeds)}"
        if self.verdict == "proved stable":
            yield (
                f"proved stable: every line within {what}"
                if count
                else f"proved stable: the line at every speed {what}"
            )
        elif self.counterexample is not None:
            values = ", ".join(f"{n} = {v:.9g}" for n, v in self.counterexample.items() if n != "speed")
            at = self.words.speed(self.counterexample["speed"])
            which = f"the line with {values}" if values else "the line"
            yield f"not stable {'within ' if count else ''}{what}: at {at} {which} is unstable"
        else:
            rest = "the rest is proved stable" if self.undecided_share < 1 else "no part of it is proved stable"
            ended = f"; {self.ended}" if self.ended else ""
            inside = "within " if count else ""
            yield f"undecided {inside}{what}: {100 * self.undecided_share:.3g} % of the volume, {rest}{ended}"
        boxes = f"  {self.boxes} box{'es' if self.boxes != 1 else ''} judged"
        where = "" if self.verdict == "proved stable" else " where proved"
        known = self.decay > 0  # not NaN, nor a rate too slow to be found
        yield boxes + (f"; disturbances die out at {self.decay:.3g} 1/s at least{where}" if known else "")
        for clause in self.stages:
            yield f"  {clause}"
        if self.about_own_motion:
            proved = ", proved to exist" if len(self.proved_low) and self.counterexample is None else ""
            yield f"  about the line's own periodic motion{proved}"


@keeps_time
def certify_stability(
    line: Driveline | Assembly,
    tolerances: Tolerances | None = None,
    speeds: SpeedEnds | None = None,
    *,
    most_boxes: int = 20_000,
    about_steady_state: bool = False,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> StabilityCertificate:
    """Prove that no line within ``tolerances`` is unstable at any speed between ``speeds`` [rad/s], or find one that
    is.

    Parameters
    ----------
    line : whose shafts may branch and close no loop; about its motion without vibration, as ``stability`` judges it,
        with the same multipliers set aside, springs with stages in the stage in which their load holds them; a
        free–free line with joint angles about its own periodic motion, where a torque depends on its speed.
    tolerances : as of ``tolerance_study``, None for those of the description, which may have none, {} for none: the
        line as it is. Of stiffness, damping, inertia, fork offsets, joint planes, loads, and the angle of a HookeJoint.
        Normal distributions count as three standard deviations either way.
    speeds : lowest and highest [rad/s]; None for the range of the description.
    most_boxes : boxes judged before the rest is left undecided.
    about_steady_state : about the periodic motion that a driven line really makes, as in ``stability``: that there is
        one at every speed, and that it attracts. A free–free line with joint angles is always proved about it.
    within : seconds after which the rest is left undecided, and ``ended`` says so.
    progress : called as progress(share done).

    Raises
    ------
    InputError : the line, or what scatters, is none of these; straight joints with ``about_steady_state``.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=40.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> tn.certify_stability(line, {"Shaft 1.stiffness": 0.05}, (20.0, 160.0))
    <StabilityCertificate: proved stable: every line within 1 tolerance, from 20 rad/s to 160 rad/s>
    """
    description = line.line if isinstance(line, Assembly) else line
    if speeds is None and description.operation is not None:
        speeds = description.operation.speed_range
    span = rising_range(speeds)
    most_boxes = whole_number(most_boxes, "most_boxes", 1)
    assembly = assemble(line)
    given = assembly.line.tolerances_by_path if tolerances is None else tolerances
    spreads = read_tolerances(assembly, given) if given or not isinstance(given, dict) else ()
    own = about_own_motion(assembly, spreads, asked=about_steady_state)
    require_provable(assembly, own=own)
    require_steady_base(assembly, assembly.table(4, np.linspace(*span, 4)))
    space = _Space(assembly, spreads, span, _own_motion(assembly.line) if own else None)
    ranges = space.ranges(np.array([np.zeros(space.size), np.ones(space.size)]))
    if own:
        require_enclosed(assembly, ranges, span[0])
    require_linear(assembly, span, ranges, own=own)
    found = _BoxSearch(space, most_boxes, progress or (lambda share: None))
    found.run()
    left, proved = found.open_boxes, np.array(found.proved).reshape(-1, 2, space.size)
    verdict = "counterexample" if found.counterexample else "undecided" if len(left) else "proved stable"
    return StabilityCertificate(
        parameters=tuple(s.label for s in spreads),
        speeds=space.speeds,
        verdict=verdict,
        undecided_share=volume(left),
        counterexample=found.counterexample,
        boxes=found.judged,
        undecided_low=space.values(left[:, 0]),
        undecided_high=space.values(left[:, 1]),
        proved_low=space.values(proved[:, 0]),
        proved_high=space.values(proved[:, 1]),
        about_own_motion=own,
        decay=min(found.decays, default=np.nan),
        units=tuple(s.unit for s in spreads),
        unit=speed_unit(assembly.line),
        findings=left_out("certify_stability", assembly.line),
        ended=found.ended,
        unstable_line=found.unstable,
        stages=space.stages(proved),
    )


def _own_motion(line: Driveline) -> OwnMotionLine:
    # Loaded where needed: it brings the compiler with it.
    from trunnion.floquet.certificate.own_judge import OwnMotionLine

    return OwnMotionLine(line)


@dataclass(frozen=True)
class _Space(BoxSpace):
    """``own`` : the line about its own motion, where that is asked for."""

    own: OwnMotionLine | None = None

    @property
    def first_width(self) -> float:
        """Share of the range of speeds of the first box: about its own motion the whole range is in vain."""
        return 1.0 if self.own is None else min(self.own.narrow / float(np.log(self.speeds[1] / self.speeds[0])), 1.0)

    def judged(self, box: Array, *, by_energy: bool = False) -> JudgedBox:
        """The verdict on one box."""
        if self.own is not None:
            return self.own.judged(self.span(box), self.ranges(box))
        return judge(self.assembly, self.span(box), self.ranges(box), by_energy=by_energy)

    def stages(self, boxes: Array) -> tuple[str, ...]:
        """In which springs work in ``boxes`` (boxes, 2, variables), a clause each."""
        values = self.values(boxes.mean(axis=1))
        rows = table_at(self.assembly, self.spreads, values[:, 1:])
        rows[:, 0] = values[:, 0]
        return tuple(dict.fromkeys(str(one) for one in working_stages(self.assembly, rows)))

    def unstable_at(self, shares: Array) -> tuple[Driveline, dict[str, float]] | None:
        """The line at ``shares`` (variables,) and its numbers, if ``stability`` finds it unstable."""
        line, speed, known = self.line_at(shares)
        swings = self.own is not None and has_joint_angles(assemble(line))
        try:
            from trunnion.floquet.stability.stability import stability  # brings the compiler with it

            verdict = stability(line, speed, about_steady_state=swings).verdict
        except ComputationError:  # too stiff to be followed, or no motion was found: no counterexample
            return None
        if verdict is not Verdict.UNSTABLE:
            return None
        return line, known


@dataclass
class _BoxSearch:
    """The largest open box next: what is left when the budget ends is then as small as can be.

    refutes : whether an unstable line is looked for.
    """

    space: _Space
    most: int
    report_progress: Callable[[float], None]
    refutes: bool = True
    proved: list[Array] = field(default_factory=list)
    decays: list[float] = field(default_factory=list)
    counterexample: dict[str, float] | None = None
    unstable: Driveline | None = None
    judged: int = 0
    ended: str = ""
    _todo: list[tuple[float, int, Array]] = field(default_factory=list)
    _kept: list[Array] = field(default_factory=list)
    _count: int = 0
    _ahead: float = 1.0
    _width: float = 1.0

    @property
    def open_boxes(self) -> Array:
        """Boxes (boxes, 2, variables) that are not proved."""
        found = [*(box for _, _, box in self._todo), *self._kept]
        if self._ahead < 1:
            found.append(np.array([np.zeros(self.space.size), np.ones(self.space.size)]))
            found[-1][0, 0] = self._ahead
        return np.array(found).reshape(-1, 2, self.space.size)

    def run(self) -> None:
        """Until everything is proved, a line is unstable, or boxes or time are used up."""
        whole = np.array([np.zeros(self.space.size), np.ones(self.space.size)])
        self._ahead, self._width = 0.0, self.space.first_width
        self._put_next()
        self.ended = time_is_up()
        if self.ended:
            return
        if self.space.own is None:  # no one energy holds about many motions
            with to_the_end():  # a box takes tenths of a second at most
                self.judged += 1
                found = self.space.judged(whole, by_energy=True)
                if found.proved:
                    self._todo.clear()
                    self._keep(whole, found)
                    return
        open_share = 1.0
        while (self._todo or self._put_next()) and self.judged < self.most:
            if ended := time_is_up():
                self.ended = ended
                return
            if not self.refutes and self._in_vain:
                return
            _, _, box = heapq.heappop(self._todo)
            with to_the_end():
                found = self.space.judged(box)
                self.judged += 1
                if found.proved:
                    self._keep(box, found)
                    open_share -= float(np.prod(box[1] - box[0]))
                    self._width = float(box[1, 0] - box[0, 0]) * WIDENED
                elif found.doubtful and self.refutes and self._refuted(box):
                    self._put(box)
                    return
                else:
                    self._halve(box, found.blame)
            self.report_progress(min(max(1 - open_share, 0.0), 0.999))

    @property
    def _in_vain(self) -> bool:
        """Whether the boxes left cover no more than a part of what is ahead, each as wide as it may become; about own
        motions, a box of which takes long, whether one was not proved."""
        left = self.most - self.judged
        if self.space.own is not None and self.judged > len(self.proved):
            return True
        return 1 - self._ahead > self._width * (WIDENED**left - 1) / (WIDENED - 1)

    def _put_next(self) -> bool:
        """All tolerances at the next speeds, as wide as lately proved; whether any are left."""
        if self._ahead >= 1:
            return False
        box = np.array([np.zeros(self.space.size), np.ones(self.space.size)])
        to = min(self._ahead + self._width, 1.0)
        box[:, 0] = self._ahead, 1.0 if 1 - to < self._width / 4 else to
        self._ahead = float(box[1, 0])
        self._put(box)
        return True

    def _keep(self, box: Array, found: JudgedBox) -> None:
        self.proved.append(box)
        self.decays.append(found.decay)

    def _put(self, box: Array) -> None:
        self._count += 1
        heapq.heappush(self._todo, (-float(np.prod(box[1] - box[0])), self._count, box))

    def _refuted(self, box: Array) -> bool:
        found = self.space.unstable_at(box.mean(axis=0))
        if found is None:
            return False
        self.unstable, self.counterexample = found
        return True

    def _halve(self, box: Array, blame: Array) -> None:
        halves = halved(box, blame)
        if not halves:
            self._kept.append(box)
        for one in halves:
            self._put(one)


def proved_over(
    assembly: Assembly, speeds: tuple[float, float], most_boxes: int, *, about_steady_state: bool = False
) -> bool:
    """Whether a line as it is is proved stable at all ``speeds`` [rad/s] by as many boxes at most; with
    ``about_steady_state`` about the periodic motion that it makes."""
    try:
        require_provable(assembly, own=about_steady_state)
        if about_steady_state:
            require_enclosed(assembly, (), speeds[0])
        require_linear(assembly, speeds, (), own=about_steady_state)
        own = _own_motion(assembly.line) if about_steady_state else None
        found = _BoxSearch(_Space(assembly, (), speeds, own), most_boxes, lambda share: None, refutes=False)
        found.run()
    except (InputError, ComputationError):  # a motion may leave the stage of a spring
        return False
    return not len(found.open_boxes)


def require_provable(assembly: Assembly, *, own: bool = False) -> None:
    """Refuse lines whose equations the enclosure does not cover.

    own : about the line's own motion.

    Raises
    ------
    InputError : so.
    """
    line, topo = assembly.line, assembly.topology
    remedy = "tolerance_study() says how probable stability is"
    if not own and topo.free and has_joint_angles(assembly):
        raise InputError(
            "is free–free and has joint angles: it moves in its own periodic motion, which this proof does not enclose",
            element="driveline", remedy="put a ConstantSpeed in front, or " + remedy,
        )  # fmt: skip
    require_tree(assembly, "a certificate does")
    refuse_dragged(assembly)
    refuse_torque_tables(line, remedy, "tables are not enclosed")
    for station in topo.stations:
        if station.link is LinkKind.LOOSE:
            raise InputError(
                "turns by itself, and no certificate covers that", element=line.names[station.element], remedy=remedy
            )

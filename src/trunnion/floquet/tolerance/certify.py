"""A proof that every line within its tolerances is stable over a range of speeds, or a line that is not.

Boxes of speed and parameters are proved one by one (``lyapunov``), and halved where the proof fails, across the side
that brings most of what stands against it. A box whose middle is unstable ends the search: that line is the
counterexample, once ``stability`` confirms it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array, Integers
from trunnion.driveline.arguments import SpeedEnds, rising_range, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.elements import ConstantSpeed
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.steady_base import require_steady_base, require_tree
from trunnion.equations.topology import LinkKind
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.floquet.stability.stability import stability
from trunnion.floquet.tolerance.bounds import half_widths, over_boxes
from trunnion.floquet.tolerance.lyapunov import judge_boxes
from trunnion.floquet.tolerance.parameter_intervals import table_at
from trunnion.floquet.tolerance.spread import Spread, Tolerances, read_tolerances
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, internal, labelled, variable
from trunnion.results.finding import Finding
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.results.verdict import Verdict
from trunnion.waiting import keeps_time, time_is_up, to_the_end

BATCH = {1: 48, 2: 24, 3: 8}
"""Boxes judged together, by unknowns: some 300 MB of matrices."""
MOST_UNKNOWNS = 3
FIRST = 0.02
"""Relative width of the first cells of speed."""
KEYS = ("stiffness", "damping", "inertia", "angle")
"""What may scatter: numbers with which stiffness, damping and inertia rise, and the angle of a line's only joint."""


@labelled
class StabilityCertificate(Result):
    """What was proved of all lines within tolerances at all speeds from one to another.

    Boxes have the speed first. The largest radius is that of a sample, no bound.
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
    largest_radius: float = variable("", "1", "largest multiplier at the middle of any box")
    units: tuple[str, ...] = internal("of the parameters")
    unit: str = internal("of speeds in print")
    findings: tuple[Finding, ...] = internal("what of the line is left out", default=())
    ended: str = attribute("what ended the search before its last box, as a clause", default="")

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
        many = f"{len(self.parameters)} tolerance{'s' if len(self.parameters) > 1 else ''}"
        what = f"{many}, from {self.words.ends(*self.speeds)}"
        if self.verdict == "proved stable":
            yield f"proved stable: every line within {what}"
        elif self.counterexample is not None:
            values = ", ".join(f"{n} = {v:.9g}" for n, v in self.counterexample.items() if n != "speed")
            at = self.words.speed(self.counterexample["speed"])
            yield f"not stable within {what}: at {at} the line with {values} is unstable"
        else:
            rest = "the rest is proved stable" if self.undecided_share < 1 else "no part of it is proved stable"
            ended = f"; {self.ended}" if self.ended else ""
            yield f"undecided within {what}: {100 * self.undecided_share:.3g} % of the volume, {rest}{ended}"
        yield f"  {self.boxes} boxes"


@keeps_time
def certify_stability(
    line: Driveline | Assembly,
    tolerances: Tolerances | None = None,
    speeds: SpeedEnds | None = None,
    *,
    most_boxes: int = 20_000,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> StabilityCertificate:
    """Prove that no line within ``tolerances`` is unstable at any speed between ``speeds`` [rad/s], or find one that
    is.

    Parameters
    ----------
    line : up to three unknowns behind a ConstantSpeed, shafts, disks and Hooke's joints alone, without loads.
    tolerances : as of ``tolerance_study``, None for those of the description; of stiffness, damping, inertia, and the
        angle of a line's only joint. Normal distributions count as three standard deviations either way.
    speeds : lowest and highest [rad/s]; None for the range of the description.
    most_boxes : boxes judged before the rest is left undecided.
    within : seconds after which the rest is left undecided, and ``ended`` says so.
    progress : called as progress(share done).

    Raises
    ------
    InputError : the line, or what scatters, is none of these.

    Examples
    --------
    >>> import trunnion as tn
    >>> shaft = tn.Shaft(stiffness=1e4, damping=40.0)
    >>> line = tn.Driveline([tn.ConstantSpeed(), tn.HookeJoint(angle=0.1), shaft, tn.Disk(inertia=0.8)])
    >>> tn.certify_stability(line, {"Shaft 1.stiffness": 0.05}, (50.0, 60.0))
    <StabilityCertificate: proved stable: every line within 1 tolerance, from 50 rad/s to 60 rad/s>
    """
    description = line.line if isinstance(line, Assembly) else line
    if speeds is None and description.operation is not None:
        speeds = description.operation.speed_range
    span = rising_range(speeds)
    most_boxes = whole_number(most_boxes, "most_boxes", 1)
    assembly = assemble(line)
    _require_provable(assembly)
    require_steady_base(assembly, assembly.table(1, 1.0))
    require_tree(assembly, "the bounds of the proof do")
    spreads = read_tolerances(assembly, tolerances)
    _require_rising(assembly, spreads)
    space = _Space(assembly, spreads, span)
    found = _search(space, most_boxes, progress or (lambda share: None))
    left = found.open
    verdict = "counterexample" if found.counterexample else "undecided" if len(left) else "proved stable"
    return StabilityCertificate(
        parameters=tuple(s.label for s in spreads),
        speeds=space.speeds,
        verdict=verdict,
        undecided_share=_volume(left),
        counterexample=found.counterexample,
        boxes=found.boxes,
        largest_radius=found.radius,
        undecided_low=space.values(left[:, 0]),
        undecided_high=space.values(left[:, 1]),
        proved_low=space.values(found.proved[:, 0]),
        proved_high=space.values(found.proved[:, 1]),
        units=tuple(s.unit for s in spreads),
        unit=speed_unit(assembly.line),
        findings=left_out("certify_stability", assembly.line),
        ended=found.ended,
    )


def _volume(boxes: Array) -> float:
    return float(np.prod(boxes[:, 1] - boxes[:, 0], axis=1).sum()) if len(boxes) else 0.0


@dataclass(frozen=True)
class _Space:
    """Boxes (2, 1 + parameters) of shares from 0 to 1: the first of ln(speed), the others of tolerances."""

    assembly: Assembly
    spreads: tuple[Spread, ...]
    speeds: tuple[float, float]

    def values(self, shares: Array) -> Array:
        """Speed and parameters (boxes, 1 + parameters) at shares."""
        low, high = np.log(self.speeds)
        columns = [np.exp(low + shares[:, 0] * (high - low))]
        columns += [s.low + shares[:, k] * (s.high - s.low) for k, s in enumerate(self.spreads, start=1)]
        return np.stack(columns, axis=1)

    def table(self, shares: Array) -> Array:
        """Numbers of lines (boxes, columns)."""
        values = self.values(shares)
        table = table_at(self.assembly, self.spreads, values[:, 1:])
        table[:, 0] = values[:, 0]
        return table

    def ends(self, boxes: Array) -> tuple[Array, Array]:
        """Numbers at the low and high ends of boxes, rounded outward."""
        low, high = self.table(boxes[:, 0]), self.table(boxes[:, 1])
        moved = low != high
        wider = 1e-14 * np.maximum(np.abs(low), np.abs(high)) * moved
        return low - wider, high + wider

    def across(self, boxes: Array, blame: Array) -> Integers:
        """The side of each box that moves the variables most that are to blame (boxes, variables) for its failure."""
        middle = boxes.mean(axis=1)
        moved = []
        for side in range(boxes.shape[2]):
            ends = np.repeat(middle[:, None], 2, axis=1)
            ends[:, :, side] = boxes[:, :, side]
            moved.append(half_widths(over_boxes(self.assembly, *self.ends(ends)))[:, : blame.shape[1]])
        each = np.stack(moved, axis=1)
        share = each / np.maximum(each.sum(axis=1, keepdims=True), 1e-300)
        return np.asarray((share * blame[:, None]).sum(axis=2).argmax(axis=1))


@dataclass(frozen=True)
class _BoxSearch:
    counterexample: dict[str, float] | None
    open: Array
    proved: Array
    boxes: int
    radius: float
    ended: str = ""


def _search(space: _Space, most: int, report_progress: Callable[[float], None]) -> _BoxSearch:
    size = 1 + len(space.spreads)
    cells = max(1, int(np.ceil(np.log(space.speeds[1] / space.speeds[0]) / FIRST)))
    edges = np.linspace(0.0, 1.0, cells + 1)
    todo = np.tile(np.array([np.zeros(size), np.ones(size)]), (cells, 1, 1))
    todo[:, 0, 0], todo[:, 1, 0] = edges[:-1], edges[1:]
    proved = [np.zeros((0, 2, size))]
    batch_size, judged, radius = BATCH[space.assembly.topology.size], 0, 0.0
    while len(todo) and judged < most:
        if ended := time_is_up():
            return _BoxSearch(None, todo, np.concatenate(proved), judged, radius, ended)
        # The largest first: what is left when the budget ends is then as small as can be.
        order = np.argsort(-np.prod(todo[:, 1] - todo[:, 0], axis=1), kind="stable")
        batch, todo = todo[order[:batch_size]], todo[order[batch_size:]]
        with to_the_end():  # a batch takes a moment
            found = judge_boxes(space.assembly, *space.ends(batch))
        judged, radius = judged + len(batch), max(radius, float(np.nanmax(found.radius)))
        left = batch[~found.proved]
        proved.append(batch[found.proved])
        for box in batch[found.radius > 1]:
            with to_the_end():
                example = _confirmed(space, box)
            if example is not None:
                return _BoxSearch(example, np.concatenate([left, todo]), np.concatenate(proved), judged, radius)
        todo = np.concatenate([todo, _halved(left, space.across(left, found.blame[~found.proved]))])
        report_progress(min(1 - _volume(todo), 0.999))
    return _BoxSearch(None, todo, np.concatenate(proved), judged, radius)


def _halved(boxes: Array, along: Integers) -> Array:
    """Two halves of each box, across a side."""
    if not len(boxes):
        return boxes
    here = np.arange(len(boxes))
    middle = (boxes[here, 0, along] + boxes[here, 1, along]) / 2
    lower, upper = boxes.copy(), boxes.copy()
    lower[here, 1, along], upper[here, 0, along] = middle, middle
    return np.concatenate([lower, upper])


def _confirmed(space: _Space, box: Array) -> dict[str, float] | None:
    """The line at the middle of a box, if ``stability`` finds it unstable."""
    middle = box.mean(axis=0)[None]
    table = space.table(middle)
    line = space.assembly.packed.line_at(table[0])
    if stability(line, float(table[0, 0])).verdict is not Verdict.UNSTABLE:
        return None
    names = ("speed", *(s.label for s in space.spreads))
    return dict(zip(names, space.values(middle)[0].tolist(), strict=True))


def _require_provable(assembly: Assembly) -> None:
    """Refuse lines whose equations the bounds do not cover."""
    line, topo = assembly.line, assembly.topology

    def refuse(problem: str, element: str) -> InputError:
        return InputError(problem, element=element, remedy="tolerance_study() says how probable stability is")

    if not isinstance(line.elements[0], ConstantSpeed) or topo.free:
        raise refuse("is free–free, and only lines behind a ConstantSpeed can be certified", line.names[0])
    if topo.size > MOST_UNKNOWNS:
        raise refuse(f"has {topo.size} unknowns, and at most {MOST_UNKNOWNS} can be certified", "driveline")
    for compliance in topo.compliances:
        kinds = {line.elements[i].kind for i in compliance.shafts}
        if len(compliance.shafts) > 1 or kinds != {"Shaft"}:
            raise refuse("is no single shaft, and only such can be certified", line.names[compliance.shafts[0]])
        bends = 0
        at = compliance.near
        while topo.stations[at].link is LinkKind.JOINT:
            bends += 1
            at = topo.stations[at].before
        if bends > 1:
            raise refuse("hangs on joints without an inertia between them", line.names[compliance.shafts[0]])
    co = assembly.coefficients(assembly.table(1, 1.0), statically_twisted=False)
    loaded = any(np.any(part != 0) for part in (co.load, co.viscous, co.quadratic))
    for s, station in enumerate(topo.stations):
        name = line.names[station.element] if station.element >= 0 else "driveline"
        hooke = station.link is LinkKind.JOINT and line.elements[station.element].kind == "HookeJoint"
        if station.link not in (LinkKind.ROOT, LinkKind.SHAFT) and not hooke:
            raise refuse("is neither shaft, disk nor Hooke's joint, and only these can be certified", name)
        if hooke and co.inertia[0, s] > 0:
            raise refuse("carries an inertia behind the joint, so that it varies with the angle", name)
    if loaded:
        raise refuse("carries loads, and only unloaded lines can be certified", "driveline")


def _require_rising(assembly: Assembly, spreads: tuple[Spread, ...]) -> None:
    joints = len(assembly.topology.joints)
    for one in spreads:
        for column in one.columns.index.tolist():
            key = assembly.packed.labels[column].rpartition(".")[2]
            if key not in KEYS or (key == "angle" and joints > 1) or np.any(one.columns.slope < 0):
                raise InputError(
                    "cannot scatter in a certificate", key=one.label,
                    remedy="stiffness, damping, inertia, and the angle of a line's only joint can",
                )  # fmt: skip
            if key == "angle" and not -np.pi / 3 < one.low <= one.high < np.pi / 3:
                raise InputError("may reach 60° at most in a certificate", key=one.label, value=one.high)
            ends = one.columns.offset + one.columns.slope * np.array([[one.low], [one.high]])
            if key == "damping" and np.any(ends.min(axis=0) * ends.max(axis=0) <= 0):
                raise InputError(
                    f"would go from {one.low:.6g} to {one.high:.6g}, and damping that reaches zero cannot be certified",
                    key=one.label, remedy="keep it on one side of zero",
                )  # fmt: skip

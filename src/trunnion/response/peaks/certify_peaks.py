"""A bound of what springs carry and of how inertias' speeds swing, over a range of speeds and tolerances: a theorem.

Each box is enclosed as a whole (``box_peaks``). The box that stands furthest above what is asked for is halved, across
the side that brings most of that, until every bound is close enough above a value that some line of the box takes, or
below a stated limit. A line that exceeds its limit ends the search.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import SpeedEnds, one_number, rising_range, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.errors import InputError
from trunnion.features import left_out
from trunnion.floquet.certificate.box_space import BoxSpace
from trunnion.floquet.certificate.certify import require_provable
from trunnion.floquet.tolerance.spread import Tolerances, read_tolerances
from trunnion.response.peaks.peak_search import PeakSearch
from trunnion.response.peaks.peaks_below import require_enclosed
from trunnion.response.peaks.quantities import (
    ACCELERATION,
    ALWAYS,
    FURTHEST,
    HEAT,
    LARGEST,
    RATED,
    SPEED,
    SWING,
    TWIST,
    in_unit,
)
from trunnion.response.peaks.stages_left import stages_left
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.finding import Finding, Gravity
from trunnion.results.result import Result
from trunnion.results.units import rounded_up
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.steady.orders.forced_response import shaft_names
from trunnion.waiting import keeps_time

STEADY = "of the steady motion, which the line comes to where it is stable: certify_stability proves that"


@dataclass(frozen=True)
class AllowedPeak:
    """The bound of a ``measure`` of one spring or inertia, the largest computed, and what the description allows."""

    measure: str
    name: str
    bound: float
    computed: float
    limit: float

    @property
    def sentence(self) -> str:
        """ "heat of coupling: 120 W at most, 110 W reached, 160 W allowed"."""
        has, reached, most = (
            in_unit(self.measure, one, 5) for one in (rounded_up(self.bound, 5), self.computed, self.limit)
        )
        proved = f"{has} at most" if np.isfinite(self.bound) else "no bound"
        return f"{self.measure} of {self.name}: {proved}, {reached} reached, {most} allowed"


@labelled
class PeakCertificate(Result):
    """What torque and twist of springs, and the speed of inertias, do not exceed in any line within tolerances at any
    speed of a range.

    Each bound stands beside the largest value that was computed of any line there: the peak lies between both. Infinite
    where a part of the box stayed open.
    """

    parameters: tuple[str, ...] = internal("that scatter")
    speeds: tuple[float, float] = attribute("from one to another", "rad/s")
    verdict: str = attribute('"proved", "within limits", "counterexample" or "undecided"')
    vibratory_torque_bound: Array = variable("spring", "N*m", "half of peak to peak, proved not to be exceeded")
    vibratory_torque: Array = variable("spring", "N*m", "the largest computed")
    peak_torque_bound: Array = variable("spring", "N*m", "largest |torque|, proved not to be exceeded")
    peak_torque: Array = variable("spring", "N*m", "the largest computed")
    vibratory_twist_bound: Array = variable("spring", "rad", "half of peak to peak, proved not to be exceeded")
    vibratory_twist: Array = variable("spring", "rad", "the largest computed")
    peak_twist_bound: Array = variable("spring", "rad", "largest |twist|, proved not to be exceeded")
    peak_twist: Array = variable("spring", "rad", "the largest computed")
    rated_torque_bound: Array = variable(
        "spring", "N*m", "sum of amplitudes by S_f of all orders up to 1 kHz and more, proved not to be exceeded"
    )
    rated_torque: Array = variable("spring", "N*m", "the largest computed")
    heat_bound: Array = variable("spring", "W", "of the damping, mean over the cycle, proved not to be exceeded")
    heat: Array = variable("spring", "W", "the largest computed")
    speed_fluctuation_bound: Array = variable("inertia", "rad/s", "half of peak to peak, proved not to be exceeded")
    speed_fluctuation: Array = variable("inertia", "rad/s", "the largest computed")
    acceleration_bound: Array = variable("inertia", "rad/s^2", "half of peak to peak, proved not to be exceeded")
    acceleration: Array = variable("inertia", "rad/s^2", "the largest computed")
    peak_speed: Array = variable("spring", "rad/s", "at which the largest vibratory torque was computed")
    springs: tuple[str, ...] = coordinate("spring")
    inertias: tuple[str, ...] = coordinate("inertia")
    gap: float = attribute("asked for between bounds and what was computed, relative")
    boxes: int = attribute("how many were judged")
    open_share: float = attribute("of the volume in ln(speed) and shares of tolerances without a bound")
    counterexample: dict[str, float] | None = internal("values by name of a line that exceeds a limit")
    exceeded: str = attribute("which limit the counterexample exceeds, in words", default="")
    allowed: tuple[AllowedPeak, ...] = internal("quantities with a limit", default=())
    units: tuple[str, ...] = internal("of the parameters", default=())
    unit: str = internal("of speeds in print", default="rad/s")
    findings: tuple[Finding, ...] = internal("what of the line is left out", default=())
    ended: str = attribute("what ended the search before it was done, as a clause", default="")
    line: Driveline | None = internal("the counterexample", default=None)

    def declared(self) -> Iterator[Variable | Attribute]:
        """The bounds, and the counterexample."""
        names, known = ["speed", *self.parameters], self.counterexample or {}
        yield Coordinate("variable", names, "variable")
        yield Variable("counterexample", np.array([known.get(name, np.nan) for name in names]), "variable")
        yield from super().declared()

    def plot(self, axes: Axes | None = None) -> Axes:
        """Bounds of vibratory torque beside what was reached; see ``pictures.design.peak_certificate``."""
        return drawing(self, "plot")(self, axes)

    @property
    def largest_gap(self) -> float:
        """By how much bounds of vibratory torque stand above what was computed at most, relative."""
        with np.errstate(invalid="ignore", divide="ignore"):
            apart = self.vibratory_torque_bound / self.vibratory_torque - 1
        return float(np.nanmax(apart, initial=0.0))

    def _lines(self) -> Iterator[str]:
        count = len(self.parameters)
        many = f"within {count} tolerance{'s' if count > 1 else ''}, " if count else ""
        what = f"{many}from {self.words.ends(*self.speeds)}"
        if self.counterexample is not None:
            values = ", ".join(f"{n} = {v:.9g}" for n, v in self.counterexample.items() if n != "speed")
            at = self.words.speed(self.counterexample["speed"])
            which = f"the line with {values}" if values else "the line"
            yield f"not within limits {what}: at {at} {which} {self.exceeded}"
        elif self.verdict == "within limits":
            yield f"proved within limits: every line {what}" if count else f"proved within limits {what}"
        elif self.open_share >= 1:
            yield f"undecided {what}: nothing is bounded{f'; {self.ended}' if self.ended else ''}"
        else:
            open_part = f"; {100 * self.open_share:.3g} % of the volume is open" if self.open_share else ""
            ended = f"; {self.ended}" if self.ended else ""
            word = "peaks are bounded" if self.verdict == "proved" else "undecided"
            yield f"{word} {what}{open_part}{ended}"
        for k, name in enumerate(self.springs):
            bound, known = self.vibratory_torque_bound[k], self.vibratory_torque[k]
            if not np.isfinite(known):
                continue
            proved = f"±{rounded_up(bound, 5):.5g} N m is not exceeded" if np.isfinite(bound) else "no bound"
            at = f" at {self.words.speed(float(self.peak_speed[k]))}" if known else ""
            most = f"{rounded_up(float(self.peak_torque_bound[k]), 5):.5g} N m at most"
            yield f"  {name}: {proved}, ±{known:.5g} N m reached{at}; in all {most}"
        for name, bound, known in zip(self.inertias, self.speed_fluctuation_bound, self.speed_fluctuation, strict=True):
            if np.isfinite(bound) and known > 0:
                most, reached = self.words.speed(float(bound), 4), self.words.speed(float(known), 4)
                yield f"  {name}: its speed swings by ±{most} at most, ±{reached} reached"
        yield from (f"  {one.sentence}" for one in self.allowed if one.measure not in ALWAYS)
        yield f"  {self.boxes} box{'es' if self.boxes != 1 else ''} judged"


@keeps_time
def certify_peaks(
    line: Driveline | Assembly,
    tolerances: Tolerances | None = None,
    speeds: SpeedEnds | None = None,
    *,
    gap: float = 0.05,
    most_boxes: int = 20_000,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> PeakCertificate:
    """Prove how large torque and twist of every spring can be in any line within ``tolerances`` at any speed between
    ``speeds`` [rad/s], or find a line that exceeds a limit of the description.

    Parameters
    ----------
    line : whose shafts may branch and close no loop; behind a ConstantSpeed, or with straight joints; in the steady
        motion of ``order_response``.
    tolerances : as of ``certify_stability``, None for those of the description, {} for none.
    speeds : lowest and highest [rad/s]; None for the range of the description.
    gap : share by which a bound may stand above the largest value computed; of a spring that carries less than a
        thousandth of another, a thousandth of that is enough.
    most_boxes : boxes judged before the search ends; bounds hold all the same, but are wider.
    within : seconds after which it ends, and ``ended`` says so.
    progress : called as progress(share done).

    Raises
    ------
    InputError : the line, or what scatters, is none of these; an amplitude that goes with the speed along a curve.

    Examples
    --------
    >>> import trunnion as tn
    >>> engine = tn.Disk(inertia=0.2, excitation=[{"order": 2, "amplitude": 100.0}])
    >>> line = tn.Driveline([engine, tn.Shaft(stiffness=1e4, damping=20.0), tn.Disk(inertia=0.8)])
    >>> proved = tn.certify_peaks(line, {"Shaft 1.stiffness": 0.05}, (60.0, 100.0))
    >>> print(proved.verdict, bool(proved.vibratory_torque_bound[0] < 1.05 * proved.vibratory_torque[0]))
    proved True
    """
    description = line.line if isinstance(line, Assembly) else line
    if speeds is None and description.operation is not None:
        speeds = description.operation.speed_range
    span = rising_range(speeds)
    most_boxes = whole_number(most_boxes, "most_boxes", 1)
    gap = one_number(gap, "gap", "0.05, say")
    if not 0 < gap < np.inf:
        raise InputError("must be positive", key="gap", value=gap, remedy="0.05, say")
    assembly = assemble(line)
    require_provable(assembly)
    given = assembly.line.tolerances_by_path if tolerances is None else tolerances
    spreads = read_tolerances(assembly, given) if given or not isinstance(given, dict) else ()
    space = BoxSpace(assembly, spreads, span)
    require_enclosed(assembly, span, space.ranges(np.array([np.zeros(space.size), np.ones(space.size)])))
    found = PeakSearch.of(space, gap, most_boxes, progress or (lambda part: None))
    found.run()
    return _certificate(space, found, gap)


def _certificate(space: BoxSpace, found: PeakSearch, gap: float) -> PeakCertificate:
    assembly = space.assembly
    measures = np.array([measure for measure, _ in found.quantities])

    def of(values: Array, measure: str) -> Array:
        return values[measures == measure]

    whole = space.ranges(np.array([np.zeros(space.size), np.ones(space.size)]))
    limited = np.isfinite(found.limit)
    if found.counterexample is not None:
        verdict = "counterexample"
    elif found.done:
        verdict = (
            "within limits" if limited.any() and np.all(found.upper[limited] <= found.limit[limited]) else "proved"
        )
    else:
        verdict = "undecided"
    return PeakCertificate(
        parameters=tuple(s.label for s in space.spreads),
        speeds=space.speeds,
        verdict=verdict,
        vibratory_torque_bound=of(found.upper, SWING),
        vibratory_torque=of(found.computed, SWING),
        peak_torque_bound=of(found.upper, LARGEST),
        peak_torque=of(found.computed, LARGEST),
        vibratory_twist_bound=of(found.upper, TWIST),
        vibratory_twist=of(found.computed, TWIST),
        peak_twist_bound=of(found.upper, FURTHEST),
        peak_twist=of(found.computed, FURTHEST),
        rated_torque_bound=of(found.upper, RATED),
        rated_torque=of(found.computed, RATED),
        heat_bound=of(found.upper, HEAT),
        heat=of(found.computed, HEAT),
        speed_fluctuation_bound=of(found.upper, SPEED),
        speed_fluctuation=of(found.computed, SPEED),
        acceleration_bound=of(found.upper, ACCELERATION),
        acceleration=of(found.computed, ACCELERATION),
        peak_speed=of(found.speed, SWING),
        springs=shaft_names(assembly),
        inertias=tuple(name for _, name in assembly.topology.points),
        gap=gap,
        boxes=found.judged,
        open_share=found.open_share,
        counterexample=found.counterexample,
        exceeded=found.exceeded,
        units=tuple(s.unit for s in space.spreads),
        unit=speed_unit(assembly.line),
        allowed=tuple(
            AllowedPeak(*found.quantities[k], *map(float, (found.upper[k], found.computed[k], found.limit[k])))
            for k in np.flatnonzero(limited)
        ),
        findings=(
            Finding(Gravity.NOTE, STEADY),
            *(Finding(Gravity.CAUTION, said) for said in stages_left(assembly, space.speeds, whole, found.upper)),
            *left_out("certify_peaks", assembly.line),
        ),
        ended=found.ended,
        line=found.line,
    )

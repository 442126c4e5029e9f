"""In which ranges of a parameter a whole range of speeds is stable: how large an angle, how much damping.

A value is unfit where any speed of the range is unstable, so the unfit values are what the tongues over speed and
parameter cover, from tip to tip. Their ends are tips, or edges at an end of the speed range; both are solved for.
Damping can widen sum resonances, so there may be several windows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from trunnion.arrays import Array
from trunnion.driveline.arguments import SpeedEnds, one_number, rising_range, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.parameters import Parameter, Term
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.released import NOT_ALIKE, refuse_pendulums
from trunnion.errors import InputError
from trunnion.floquet.tongues.levels import DAMPING
from trunnion.floquet.tongues.result import Tongue, Tongues
from trunnion.floquet.tongues.tongues import task_of
from trunnion.floquet.tongues.window_search import UNKNOWN, SearchedColumn, searched
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, computed, internal, labelled
from trunnion.results.result import Result
from trunnion.results.variables import Attribute, Coordinate, Variable
from trunnion.results.words import Words
from trunnion.waiting import keeps_time

Progress = Callable[[float], None]
COMPLETE = "whether rows and columns were searched for every zero and decided everywhere, and every tip confirmed"


@dataclass(frozen=True)
class WindowEnd:
    """Where a window ends: the speed [rad/s] that turns unstable first, and the region it belongs to, or ``UNKNOWN``
    where it could not be decided; None at the ends of the range asked for."""

    speed: float
    region: str


@labelled
class StableWindows(Result):
    """Ranges of a parameter in which a whole range of speeds is stable."""

    SPEEDS_IN = "speed_unit"

    parameter: str = attribute("what was searched")
    unit: str = internal("of the parameter")
    windows: Array = internal("rising ranges of the parameter in which every speed is stable", "{unit}", "window 2")
    ends: tuple[tuple[WindowEnd | None, WindowEnd | None], ...] = internal("what begins beyond each end of each window")
    speeds: tuple[float, float] = attribute("asked for", "rad/s")
    margin: float = attribute("share by which the speeds asked for were widened at either end")
    low: float = internal("end of the range searched")
    high: float = internal("end of the range searched")
    search: str = attribute("how it was searched")
    speed_unit: str = internal("of speeds in print")
    tongues: Tongues = internal("the unstable regions behind it")
    confirmed: Array = attribute(
        "speeds at each of which the whole range was searched, and the windows found stable", "rad/s"
    )
    complete: bool = attribute(COMPLETE)
    ended: str = attribute("what ended the search before it was done, as a clause", default="")

    @property
    @computed(attribute())
    def range(self) -> tuple[float, float]:
        """The range of the parameter that was searched."""
        return self.low, self.high

    @property
    def largest(self) -> float | None:
        """The value up to which the line is stable from the low end on; None where it is unstable there at once."""
        if not len(self.windows) or self.windows[0, 0] > self.low:
            return None
        return float(self.windows[0, 1])

    @property
    def smallest(self) -> float | None:
        """The value from which on the line stays stable up to the high end; None where it is unstable there."""
        if not len(self.windows) or self.windows[-1, 1] < self.high:
            return None
        return float(self.windows[-1, 0])

    @property
    @computed(attribute())
    def sentence(self) -> str:
        """The answer in a sentence."""
        span = f"from {self.words.ends(*self.speeds)}"
        if self.ended and not len(self.confirmed):
            return f"No {self.parameter} is known yet to keep every speed {span} stable: {self.ended}."
        if not len(self.windows):
            asked = f"{self.parameter} from {self._value(self.low)} to {self._value(self.high)}"
            complete = not self.tongues.unknown and not any(t.fades for t in self.tongues)
            known = "keeps" if complete else "is known to keep"
            return f"No {asked} {known} every speed {span} stable{f'; {self.ended}' if self.ended else ''}."
        parts = []
        for (low, high), (below, above) in zip(self.windows.tolist(), self.ends, strict=True):
            begin = f"{self._value(low)}{_why(below, self.words)}"
            parts.append(f"from {begin} to {self._value(high)}{_why(above, self.words)}")
        if not len(self.confirmed):
            return f"Every speed {span} is stable with {self.parameter} {' and '.join(parts)}, as nothing can grow."
        how = "confirmed" if self.complete else "checked"
        return (
            f"Every speed {span} is stable with {self.parameter} {' and '.join(parts)}; "
            f"{how} at {len(self.confirmed)} speeds{f'; {self.ended}' if self.ended else ''}."
        )

    def _value(self, value: float) -> str:
        if self.unit == "rad":
            return f"{np.rad2deg(value):.6g}°"
        return f"{value:.6g}{'' if self.unit == '1' else ' ' + self.unit}"

    def declared(self) -> Iterator[Variable | Attribute]:
        """Windows, and what ends them."""
        yield from super().declared()
        yield Coordinate("window", np.arange(len(self.windows)), "window")
        for k, name in enumerate(("from", "to")):
            ends = [pair[k] or WindowEnd(float("nan"), "") for pair in self.ends]
            yield Variable(name, self.windows[:, k], "window", self.unit, self.parameter)
            yield Variable(f"{name}_speed", np.array([end.speed for end in ends]), "window", "rad/s")
            yield Variable(f"{name}_region", [end.region for end in ends], "window")

    def plot(self, axes: Axes | None = None, *, unit: str | None = None, labelled: int = 12) -> Axes:
        """The unstable regions over speed and parameter; see ``pictures.tongues.windows``."""
        return drawing(self, "plot")(self, axes, unit=unit, labelled=labelled)

    def _lines(self) -> list[str]:
        return [self.sentence, f"  {self.search}", *(f"  note: {r}" for r in self.tongues.remarks)]


@keeps_time
def stable_windows(
    line: Driveline | Assembly,
    parameter: str | Parameter,
    low: float,
    high: float,
    speeds: SpeedEnds,
    *,
    margin: float = 0.0,
    rows: int | None = None,
    statically_twisted: bool = True,
    about_steady_state: bool = False,
    within: float | None = None,
    progress: Progress | None = None,
) -> StableWindows:
    """The ranges of ``parameter`` between ``low`` and ``high`` in which every speed from one to another is stable.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    parameter, low, high : as of a chart's axis, SI units.
    speeds : (lowest, highest) input speed [rad/s], or texts as ("300 rpm", "2400 rpm").
    margin : share by which the speeds are widened at either end, 0.1 for 10 %.
    rows : values of the parameter searched to begin with; by default 65, of lines of more than three unknowns 17.
    statically_twisted : as in ``stability``.
    about_steady_state : about the line's own periodic motion, as in ``stability_chart``.
    within : seconds that it may take; no window is claimed then that no column confirmed, and ``ended`` says so.
    progress : called as progress(share done).

    Raises
    ------
    InputError : see ``tongues``; a margin outside 0 to 0.9.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.catalogue("two-shaft-cardan", angle=0.3)
    >>> tn.stable_windows(line, "HookeJoint *.angle", 0.0, 0.5, (1.55, 1.65)).sentence
    'Every speed from 1.55 rad/s to 1.65 rad/s is stable with HookeJoint *.angle from 0° to 6.88441° (set by
      subharmonic ω₂ at 1.61804 rad/s); confirmed at 22 speeds.'
    """
    if not 0 <= one_number(margin, "margin", "0.1 for 10 %") < 0.9:
        raise InputError("must lie between 0 and 0.9", key="margin", value=margin, remedy="0.1 for 10 %")
    asked = rising_range(speeds)
    assembly = assemble(line)
    refuse_pendulums(assembly.line, NOT_ALIKE)
    span = (asked[0] * (1 - margin), asked[1] * (1 + margin))
    task = task_of(
        assembly, ("speed", *span), (parameter, low, high), None, statically_twisted, "tongues",
        about_steady_state=about_steady_state,
    )  # fmt: skip
    found, columns, ended = searched(
        task, None if rows is None else whole_number(rows, "rows", 3), progress or (lambda share: None)
    )
    windows, ends = _free_of(found, columns) if columns or not ended else (np.zeros((0, 2)), ())
    # A range that reaches below the slowest turn that can be computed was searched from there on.
    begin = asked[0] if found.x_range[0] <= span[0] * (1 + 1e-12) else found.x_range[0]
    return StableWindows(
        parameter=found.y_label, unit=found.y_unit, windows=windows, ends=ends, speeds=(begin, asked[1]),
        margin=float(margin), low=found.y_range[0], high=found.y_range[1], search=found.search,
        speed_unit=speed_unit(assembly.line), tongues=found, confirmed=np.sort([column.x for column in columns]),
        complete=found.complete and not ended and not any(column.left_out for column in columns), ended=ended,
    )  # fmt: skip


@keeps_time
def minimum_damping(
    line: Driveline | Assembly,
    speeds: SpeedEnds,
    *,
    damping: str | Parameter | None = None,
    maximum: float = 100.0,
    margin: float = 0.0,
    rows: int | None = None,
    about_steady_state: bool = False,
    within: float | None = None,
    progress: Progress | None = None,
) -> StableWindows:
    """All ranges of damping, up to ``maximum``, that keep every speed from one to another stable.

    Parameters
    ----------
    line : a ``Driveline`` or its ``Assembly``.
    speeds : (lowest, highest) input speed [rad/s], or texts with units.
    damping : a factor of all damping that the line states by default, however it is stated, or the damping of one
        element, as "Shaft 2.damping".
    maximum : the largest value of it, in its unit (1 is what the line has where it is a factor).
    margin : share by which the speeds are widened at either end, as of ``stable_windows``.
    rows : values of the damping searched to begin with, as of ``stable_windows``.
    about_steady_state : about the line's own periodic motion, as in ``stability_chart``.
    within : seconds that it may take, as of ``stable_windows``.
    progress : called as progress(share done).

    Raises
    ------
    InputError : see ``stable_windows``; a parameter that is not damping, or a line without any to multiply.

    Examples
    --------
    >>> import trunnion as tn
    >>> line = tn.catalogue("two-shaft-cardan", angle=0.3)
    >>> tn.minimum_damping(line, (1.5, 1.7)).sentence
    'Every speed from 1.5 rad/s to 1.7 rad/s is stable with factor of all damping from 6.31234 (set by subharmonic
      ω₂ at 1.61816 rad/s) to 100; confirmed at 20 speeds.'
    """
    assembly = assemble(line)
    refuse_pendulums(assembly.line, NOT_ALIKE)
    chosen = all_damping(assembly) if damping is None else damping
    if isinstance(chosen, str) and not any(word in chosen for word in DAMPING):
        raise InputError(
            "is not the damping of an element", key="damping", value=damping, remedy='as "Shaft 2.damping"'
        )
    if not 0 < one_number(maximum, "maximum", "100, say") < np.inf:
        raise InputError("must be positive and finite", key="maximum", value=maximum, remedy="100, say")
    return stable_windows(
        assembly, chosen, 1e-6 * maximum, maximum, speeds, margin=margin, rows=rows,
        about_steady_state=about_steady_state, progress=progress,
    )  # fmt: skip


def all_damping(assembly: Assembly) -> Parameter:
    """A factor of all damping that a line states: coefficients, loss factors, relative damping, a common ratio.

    Raises
    ------
    InputError : there is none.
    """
    packed = assembly.packed
    terms = [
        Term(label, slope=float(value))
        for label, value in zip(packed.labels, packed.values, strict=True)
        if label.rpartition(".")[2] in DAMPING and value
    ]
    if not terms:
        raise InputError(
            "has no damping to multiply", element="driveline", key="damping",
            remedy='name one to vary, damping="Shaft 1.damping"',
        )  # fmt: skip
    return Parameter("factor of all damping", "1", tuple(terms))


def _why(end: WindowEnd | None, words: Words) -> str:
    return "" if end is None else f" (set by {end.region} at {words.speed(end.speed)})"


def _free_of(
    found: Tongues, columns: list[SearchedColumn]
) -> tuple[Array, tuple[tuple[WindowEnd | None, WindowEnd | None], ...]]:
    """What of the range no tongue and no unstable range of a column covers and is known, and what ends each part."""
    low, high = found.y_range
    windows: list[tuple[float, float]] = []
    ends: list[tuple[WindowEnd | None, WindowEnd | None]] = []
    at, below = low, None
    for begin, end, first, last in sorted([*_unfit(found), *_seen(columns)], key=lambda part: part[0]):
        if begin > at:
            windows.append((at, begin))
            ends.append((below, first))
        if end > at or at == low:
            at, below = max(end, at), last
    if at < high:
        windows.append((at, high))
        ends.append((below, None))
    return np.array(windows).reshape(-1, 2), tuple(ends)


def _seen(columns: list[SearchedColumn]) -> Iterator[tuple[float, float, WindowEnd, WindowEnd]]:
    """Unstable and unknown ranges of columns that regions leave out."""
    for column in columns:
        for begin, end, name in column.left_out:
            yield begin, end, WindowEnd(column.x, name), WindowEnd(column.x, name)


def _unfit(found: Tongues) -> Iterator[tuple[float, float, WindowEnd, WindowEnd]]:
    """Ranges that a tongue covers or of which nothing is known, and what is at either end of each."""
    for tongue in found:
        yield float(tongue.y[0]), float(tongue.y[-1]), _end(tongue, 0), _end(tongue, -1)
    for place in found.unknown:
        end = WindowEnd(sum(place.x) / 2, UNKNOWN)
        yield *place.between, end, end
    for tongue in found:
        # Without damping a region goes on, however little it grows.
        for side, at in (("below", 0), ("above", -1)):
            if side in tongue.fades:
                end = WindowEnd(_end(tongue, at).speed, UNKNOWN)
                low, high = sorted((found.y_range[at], float(tongue.y[at])))
                yield low, high, end, end


def _end(tongue: Tongue, place: int) -> WindowEnd:
    return WindowEnd(float(tongue.low[place] + tongue.high[place]) / 2, tongue.name)

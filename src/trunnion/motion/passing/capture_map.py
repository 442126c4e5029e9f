"""``capture_map``: over two parameters of a line, from which share of its starting phases a resonance captures it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags
from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.arguments import one_number, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.parameters import SPEED, pack
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.motion.passing.start import ends_of, lasting
from trunnion.motion.passing.trials import FACTOR, Trials, passes, trials_of
from trunnion.numerics.memory import require_memory
from trunnion.numerics.workers import Workers, workers_of_client
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import QuantityAxis, quantity_axis
from trunnion.results.result import Result
from trunnion.results.speeds import rounded_speed
from trunnion.results.variables import Attribute, Variable
from trunnion.waiting import keeps_time, time_is_up

Request: TypeAlias = tuple[str, float, float, int]
BYTES_A_CELL = 4000
"""Of a cell while it waits, about."""
SHORT = "short of torque"


@labelled
class CaptureMap(Result):
    """Share of the starting phases from which a line is captured, over two parameters."""

    parameters: tuple[str, str] = internal("along x and along y")
    units: tuple[str, str] = internal("of the parameters")
    x: Array = coordinate("x", "{self.units[0]}", "{self.parameters[0]}")
    y: Array = coordinate("y", "{self.units[1]}", "{self.parameters[1]}")
    share: Array = variable("y x", "1", "of the decided starting phases, captured; NaN: not known", name="captured")
    undecided: Array = variable("y x", "1", "share of all starting phases")
    short: Flags = variable("y x", "1", "whether the rigid line lacks the torque too", name="short_of_torque")
    computed: Flags = internal("cells that were computed (y, x)")
    phases: Array = coordinate("phase", "rad", "of the input when it begins")
    first: float = attribute("speed at the start [rad/s]")
    last: float = attribute("speed asked for [rad/s]")
    drive: str = attribute("disk whose torque the factor scales")
    tolerance: float = attribute("error allowed per step")
    stopped: str = internal("what ended it before all was computed")
    unit: str = internal("of speeds in print")

    @property
    def boundary(self) -> Array:
        """Where the share crosses one half, between neighbouring cells: (pieces, 2 ends, x and y), in SI units. It is
        known to the size of a cell, ``cell``."""
        half, known = self.share >= 0.5, np.isfinite(self.share)
        across, up = _edges(self.x), _edges(self.y)
        pieces = []
        for j, i in zip(*np.nonzero((half[:, 1:] != half[:, :-1]) & known[:, 1:] & known[:, :-1]), strict=True):
            pieces.append([(across[i + 1], up[j]), (across[i + 1], up[j + 1])])
        for j, i in zip(*np.nonzero((half[1:] != half[:-1]) & known[1:] & known[:-1]), strict=True):
            pieces.append([(across[i], up[j + 1]), (across[i + 1], up[j + 1])])
        return np.array(pieces, dtype=float).reshape(-1, 2, 2)

    @property
    def cell(self) -> tuple[float, float]:
        """Size of a cell along x and y, to which the boundary is known."""
        return float(self.x[1] - self.x[0]), float(self.y[1] - self.y[0])

    @property
    def axes(self) -> tuple[QuantityAxis, QuantityAxis]:
        """How both parameters read."""
        along, up = (
            quantity_axis("factor of the drive torque" if path == FACTOR else path, unit, self.unit)
            for path, unit in zip(self.parameters, self.units, strict=True)
        )
        return along, up

    @property
    def outcome(self) -> Outcome:
        """Whether all was computed, and a sentence."""
        if not self.stopped:
            return Outcome(True, "reached", "every cell was computed")
        done = int(self.computed.sum())
        return Outcome(False, "ended early", f"{self.stopped}: {done} of {self.computed.size} cells were computed")

    def declared(self) -> Iterator[Variable | Attribute]:
        """What the fields hold, the cells' size, and the sentence."""
        yield from super().declared()
        yield Attribute("outcome", self.outcome.kind)
        yield Attribute("cell_x", self.cell[0])
        yield Attribute("cell_y", self.cell[1])
        yield Attribute("says", "\n".join(self._lines()))

    def _lines(self) -> Iterator[str]:
        along, up = self.axes
        known = np.isfinite(self.share)
        yield (
            f"capture on the way from {rounded_speed(self.first, self.unit)} to {rounded_speed(self.last, self.unit)} "
            f"over {along.said(self.x)} and {up.said(self.y)}, {len(self.x)} × {len(self.y)} cells, "
            f"{len(self.phases)} starting phases each"
        )
        if known.any():
            often, ever = int((self.share[known] >= 0.5).sum()), int((self.share[known] > 0).sum())
            yield (
                f"  captured from half of the phases or more in {often} of {int(known.sum())} cells, from some in "
                f"{ever - often} more"
            )
        if len(self.boundary):
            wide, high = (axis.number(size, 3) for axis, size in zip(self.axes, self.cell, strict=True))
            yield f"  the boundary at one half is known to a cell, {wide} by {high}"
        if self.short.any():
            yield f"  short of torque without any resonance in {int(self.short.sum())} cells"
        if self.undecided.any():
            yield f"  some phases are undecided in {int((self.undecided > 0).sum())} cells, and left out there"
        if self.stopped:
            yield f"  {self.outcome}"

    def plot(self, axes: Axes | None = None) -> Axes:
        """Share captured in colour, and the boundary at one half; see ``pictures.transients``."""
        return drawing(self, "plot")(self, axes)


@keeps_time
def capture_map(
    line: Driveline | Assembly,
    speeds: Sequence[float | str],
    x: Request,
    y: Request,
    *,
    torque: Sequence[AppliedTorque] = (),
    friction: Sequence[FrictionTorque] = (),
    scenario: Scenario | str | None = None,
    drive: str | None = None,
    phases: int | ArrayLike = 8,
    tolerance: float = 1e-9,
    processes: int = 1,
    client: Any = None,
    within: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> CaptureMap:
    """From which share of its starting phases a line is captured on its way between two speeds, over two parameters.

    Every phase of every cell is judged as by ``passing``, at two tolerances.

    Parameters
    ----------
    line : a ``Driveline`` (or its ``Assembly``) without a ConstantSpeed.
    speeds : the first and the last [rad/s] of its input, numbers or texts with a unit; from 0, rising.
    x, y : (parameter, first, last, how many), in SI units: "HookeJoint 1.angle", say, or "factor" of the drive torque.
    torque, friction, scenario : what acts, as in ``passing``.
    drive : name of the disk whose torques the factor scales; by default the one that torques act on, or the
        line's Motor.
    phases : how many starting phases, even over half a turn and every other one half a turn on; or angles [rad].
    tolerance : error allowed per step.
    processes : that compute. More than one need ``if __name__ == "__main__":`` in a script.
    client : a ``distributed.Client``, whose workers compute the same cells instead.
    within : seconds of computing after which it ends with the cells that it has, which lie all over the map.
    progress : called as progress(share done).

    Returns
    -------
    CaptureMap: the share (y, x) captured, and the boundary at one half.

    Raises
    ------
    InputError : no such parameter; a wrong count or range; what ``passing`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
    >>> line = tn.Driveline([disks[0], tn.HookeJoint(angle="9 deg"), tn.Shaft(stiffness=2e3, damping=1.0), disks[1]])
    >>> weak = tn.AppliedTorque(on="motor", time=[0], torque=[2.5], between="steps")
    >>> angles, factors = ("HookeJoint 1.angle", 0.05, 0.18, 2), ("factor", 1.0, 4.0, 2)
    >>> tn.capture_map(line, (15.0, 40.0), angles, factors, torque=[weak], phases=2).share
    array([[0., 1.],
           [0., 0.]])
    """
    trials = trials_of(line, ends_of(speeds), lasting(line, torque, friction, scenario), drive, phases, tolerance)
    columns, rows = _values(trials.line, "x", x), _values(trials.line, "y", y)
    if x[0] == y[0]:
        raise InputError("is varied twice", key="y", value=y[0], remedy="give another parameter")
    for key, request in (("x", x), ("y", y)):  # what the line refuses, before anything is computed
        _refused(trials, key, request)
    require_memory(float(BYTES_A_CELL) * x[3] * y[3], key="y", value=y[3], remedy="ask for fewer values of x or y")
    whole_number(processes, "processes", 1)
    workers = workers_of_client(client)
    points = [{x[0]: float(a), y[0]: float(b)} for b in rows for a in columns]
    found: list[list[str] | None] = [None] * len(points)
    report_progress = progress or (lambda share: None)
    for done, (place, kinds) in enumerate(_ended(trials, points, processes, workers), start=1):
        found[place] = kinds
        report_progress(done / len(points))
    stopped = time_is_up() if None in found else ""
    shape = (len(rows), len(columns))
    share, undecided, short = (
        np.array([measure(one) for one in found]).reshape(shape) for measure in (_share, _undecided, _short)
    )
    units = tuple("1" if one[0] == FACTOR else pack(trials.line).resolve_axis(one[0]).unit for one in (x, y))
    return CaptureMap(
        parameters=(x[0], y[0]), units=(units[0], units[1]), x=columns, y=rows, share=share, undecided=undecided,
        short=short.astype(bool), computed=np.array([one is not None for one in found]).reshape(shape),
        phases=trials.phases, first=trials.first, last=trials.last, drive=trials.drive, tolerance=tolerance,
        stopped=stopped, unit=speed_unit(trials.line),
    )  # fmt: skip


def _ended(
    trials: Trials, points: list[dict[str, float]], processes: int, workers: Workers | None
) -> Iterator[tuple[int, list[str]]]:
    """Cells as they come, in an order that soon lies all over the map; none that the time limit cut short."""
    order = np.random.default_rng(0).permutation(len(points)).tolist()
    if workers is not None:
        for k, kinds in workers.each(trials.kinds, (points[place] for place in order)):
            yield order[k], kinds
        return
    if processes == 1:
        for place in order:
            if time_is_up():
                return
            kinds = trials.kinds(points[place])
            if time_is_up():
                return
            yield place, kinds
        return
    # Most of the work is done under the interpreter's lock, so that threads would wait for each other.
    with ProcessPoolExecutor(processes, get_context("spawn")) as pool:
        waiting = {pool.submit(trials.kinds, points[place]): place for place in order}
        try:
            for one in as_completed(waiting):
                yield waiting[one], one.result()
                if time_is_up():
                    return
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _share(kinds: list[str] | None) -> float:
    decided = [kind for kind in kinds or () if kind not in ("undecided", SHORT)]
    return 1 - passes(decided) / len(decided) if decided else np.nan


def _undecided(kinds: list[str] | None) -> float:
    return kinds.count("undecided") / len(kinds) if kinds else 0.0


def _short(kinds: list[str] | None) -> bool:
    return SHORT in (kinds or ())


def _values(line: Driveline, key: str, request: Request) -> Array:
    """Rising values (m,) of a parameter of the map."""
    remedy = '("HookeJoint 1.angle", 0.1, 0.3, 12), say'
    if not isinstance(request, tuple | list) or len(request) != 4 or not isinstance(request[0], str):
        raise InputError("must be a parameter, its first and last value and how many", key=key, remedy=remedy)
    path, low, high, count = request
    if path == SPEED:
        raise InputError("is what the line runs through", key=key, value=path, remedy="vary another parameter")
    if path != FACTOR:
        pack(line).resolve_axis(path)
    ends = one_number(low, key, remedy), one_number(high, key, remedy)
    if not (np.all(np.isfinite(ends)) and ends[0] < ends[1]) or (path == FACTOR and ends[0] <= 0):
        what = "must rise" if path != FACTOR else "must rise from above 0"
        raise InputError(what, key=key, value=list(request), remedy=remedy)
    whole_number(count, key, 2)
    require_memory(float(BYTES_A_CELL) * count, key=key, value=count, remedy="ask for fewer values")
    return np.linspace(*ends, count)


def _refused(trials: Trials, key: str, request: Request) -> None:
    path = request[0]
    if path == FACTOR:
        return
    packed = pack(trials.line)
    for end in request[1:3]:
        table = packed.table(1)
        packed.resolve_axis(path).put(table, end)
        packed.line_at(table[0])


def _edges(values: Array) -> Array:
    """Edges of cells about even values."""
    half = (values[1] - values[0]) / 2
    return np.append(values - half, values[-1] + half)

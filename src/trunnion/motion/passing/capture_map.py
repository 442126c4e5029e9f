"""``capture_map``: over two parameters of a line, from which share of its starting phases a resonance captures it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Flags, Integers
from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.arguments import whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.operating_speed import speed_unit
from trunnion.driveline.parameters import pack
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.coefficients import Assembly
from trunnion.motion.passing.map_cells import KINDS, UNKNOWN, MapRequest, Request, computed_cells, map_request
from trunnion.motion.passing.map_store import MapStore
from trunnion.motion.passing.trials import FACTOR
from trunnion.numerics.workers import workers_of_client
from trunnion.results.counts import counted
from trunnion.results.drawing import Axes, drawing
from trunnion.results.fields import attribute, coordinate, internal, labelled, variable
from trunnion.results.outcome import Outcome
from trunnion.results.quantity_axes import QuantityAxis, quantity_axis
from trunnion.results.result import Result
from trunnion.results.speeds import rounded_speed
from trunnion.results.variables import Attribute, Variable
from trunnion.waiting import keeps_time, time_is_up


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
        j, i = np.nonzero((half[:, 1:] != half[:, :-1]) & known[:, 1:] & known[:, :-1])
        beside = np.stack([across[i + 1], up[j], across[i + 1], up[j + 1]], axis=1)
        j, i = np.nonzero((half[1:] != half[:-1]) & known[1:] & known[:-1])
        above = np.stack([across[i], up[j + 1], across[i + 1], up[j + 1]], axis=1)
        return np.concatenate([beside, above]).reshape(-1, 2, 2)

    @property
    def changes(self) -> tuple[Integers, Integers]:
        """How often the share crosses one half along each row (y,) and along each column (x,), cells that are not known
        left out: more than once is a boundary that folds back, or slivers."""
        half, known = self.share >= 0.5, np.isfinite(self.share)
        rows = [_turns(one[seen]) for one, seen in zip(half, known, strict=True)]
        columns = [_turns(one[seen]) for one, seen in zip(half.T, known.T, strict=True)]
        return np.array(rows, dtype=np.int64), np.array(columns, dtype=np.int64)

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
            f"{counted(len(self.phases), 'starting phase')} each"
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
            yield f"  {self._nature()}"
        if self.short.any():
            yield f"  short of torque without any resonance in {int(self.short.sum())} cells"
        if self.undecided.any():
            yield f"  some phases are undecided in {int((self.undecided > 0).sum())} cells, and left out there"
        if self.stopped:
            yield f"  {self.outcome}"

    def _nature(self) -> str:
        """How the boundary lies, as far as cells tell."""
        words = []
        for axis, changes, lines in zip(self.axes, self.changes, ("rows", "columns"), strict=True):
            folds = int((changes > 1).sum())
            what = "at most once" if not folds else f"more than once in {folds} of {len(changes)} {lines}"
            words.append(f"{what} along {axis.quantity}")
        mixed = int(((self.share > 0) & (self.share < 1)).sum())
        phases = f"; the phase decides in {counted(mixed, 'cell')}" if len(self.phases) > 1 else ""
        return f"it is crossed {words[0]} and {words[1]}{phases}; strips narrower than a cell are not seen"

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
    tolerance: float = 1e-6,
    processes: int = 1,
    client: Any = None,
    store: str | Path | None = None,
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
    tolerance : error allowed per step of the finer of two runs that must end alike; the other has thirty times as much.
    processes : that compute. More than one need ``if __name__ == "__main__":`` in a script.
    client : a ``distributed.Client``, whose workers compute the same cells instead.
    store : folder that the cells are written to in pieces, while they are computed; where it holds some of this map
        already, only the others are computed. ``capture_map_cost`` says beforehand how long a map takes.
    within : seconds of computing after which it ends with the cells that it has, which lie all over the map.
    progress : called as progress(share done).

    Returns
    -------
    CaptureMap: the share (y, x) captured, and the boundary at one half.

    Raises
    ------
    InputError : no such parameter; a wrong count or range; what ``passing`` refuses; a store that holds another map.

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
    asked = map_request(line, speeds, x, y, (torque, friction, scenario), drive, phases, tolerance)
    whole_number(processes, "processes", 1)
    workers = workers_of_client(client)
    kept = None if store is None else MapStore(store, asked)
    counts = np.full((asked.cells, len(KINDS)), UNKNOWN, dtype=np.int64) if kept is None else kept.counts()
    report_progress, done = progress or (lambda share: None), int((counts[:, 0] != UNKNOWN).sum())
    report_progress(done / asked.cells)
    try:
        for place, found in computed_cells(asked, counts, processes, workers):
            counts[place] = found
            done += 1
            if kept is not None:
                kept.note(place, counts)
            report_progress(done / asked.cells)
    finally:
        if kept is not None:
            kept.write(counts)
    stopped = time_is_up() if done < asked.cells else ""
    return _map_of(asked, counts, stopped)


def _map_of(asked: MapRequest, counts: Integers, stopped: str) -> CaptureMap:
    trials, shape = asked.trials, (len(asked.y), len(asked.x))
    known = counts[:, 0] != UNKNOWN
    passed, captured, short, undecided = (np.where(known, counts[:, k], 0) for k in range(len(KINDS)))
    decided, every = passed + captured, np.maximum(counts.sum(axis=1), 1)
    share = np.divide(captured, decided, where=decided > 0, out=np.full(len(counts), np.nan))
    units = tuple("1" if one == FACTOR else pack(trials.line).resolve_axis(one).unit for one in asked.parameters)
    return CaptureMap(
        parameters=asked.parameters, units=(units[0], units[1]), x=asked.x, y=asked.y, share=share.reshape(shape),
        undecided=(undecided / every).reshape(shape), short=(short > 0).reshape(shape), computed=known.reshape(shape),
        phases=trials.phases, first=trials.first, last=trials.last, drive=trials.drive, tolerance=trials.tolerance,
        stopped=stopped, unit=speed_unit(trials.line),
    )  # fmt: skip


def _edges(values: Array) -> Array:
    """Edges of cells about even values."""
    half = (values[1] - values[0]) / 2
    return np.append(values - half, values[-1] + half)


def _turns(half: Flags) -> int:
    """How often it changes."""
    return int((half[1:] != half[:-1]).sum())

"""``capture_map_cost``: how long a map of captures will take, from a few of its cells."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from time import process_time

import numpy as np
from numpy.typing import ArrayLike

from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.arguments import whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.coefficients import Assembly
from trunnion.motion.passing.map_cells import BYTES_A_CELL, KINDS, Request, map_request
from trunnion.motion.passing.map_store import PIECE
from trunnion.numerics.memory import size_text
from trunnion.results.counts import counted
from trunnion.results.durations import time_text
from trunnion.results.fields import attribute, labelled
from trunnion.results.result import Result
from trunnion.waiting import keeps_time, time_is_up


@labelled
class CaptureMapCost(Result):
    """What a map will take: processor time by cells that were timed, memory, and room in its store."""

    cells: int = attribute("in all")
    run_ups: int = attribute("each at two tolerances")
    seconds: float = attribute("processor time of all", "s")
    error: float = attribute("twice the standard error of that, by how much cells differ", "s")
    timed: int = attribute("cells that were timed, drawn at random")
    processes: int = attribute("that share it, each with a processor")
    memory: int = attribute("bytes")
    disk: int = attribute("bytes in a store")
    files: int = attribute("in a store")

    @property
    def elapsed(self) -> float:
        """Time by the clock [s]."""
        return self.seconds / self.processes

    def _lines(self) -> Iterator[str]:
        cells, run_ups = (f"{count:,}".replace(",", " ") for count in (self.cells, self.run_ups))
        yield f"{cells} cells, {run_ups} run-ups at two tolerances each"
        error = f"± {time_text(self.error)}" if np.isfinite(self.error) else "of unknown error"
        yield (
            f"  {time_text(self.seconds)} {error} of processor time by {counted(self.timed, 'cell')} that "
            f"{'was' if self.timed == 1 else 'were'} timed, {time_text(self.elapsed)} in "
            f"{self.processes} {'process' if self.processes == 1 else 'processes'}"
        )
        yield (
            f"  {size_text(self.memory)} of memory, {size_text(self.disk)} in {counted(self.files, 'file')} of a "
            "store, from which it goes on where it was stopped"
        )


@keeps_time
def capture_map_cost(
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
    sample: int = 12,
    within: float | None = None,
) -> CaptureMapCost:
    """How long a map of captures will take, and how much it will hold, from cells drawn at random.

    Parameters
    ----------
    line, speeds, x, y, torque, friction, scenario, drive, phases, tolerance, processes : as of ``capture_map``.
    sample : cells that are computed and timed.
    within : seconds of computing after which it says what it has by then, from one cell at least.

    Raises
    ------
    InputError : what ``capture_map`` refuses.

    Examples
    --------
    >>> import trunnion as tn
    >>> disks = tn.Disk(name="motor", inertia=1.0), tn.Disk(name="load", inertia=4.0)
    >>> line = tn.Driveline([disks[0], tn.HookeJoint(angle="9 deg"), tn.Shaft(stiffness=2e3, damping=1.0), disks[1]])
    >>> weak = tn.AppliedTorque(on="motor", time=[0], torque=[20.0], between="steps")
    >>> million = ("HookeJoint 1.angle", 0.05, 0.18, 1000), ("factor", 1.0, 4.0, 1000)
    >>> cost = tn.capture_map_cost(line, (15.0, 40.0), *million, torque=[weak], phases=1, sample=2)
    >>> cost.cells, cost.seconds > 1000.0, cost.memory < 1e9
    (1000000, True, True)
    """
    asked = map_request(line, speeds, x, y, (torque, friction, scenario), drive, phases, tolerance)
    whole_number(processes, "processes", 1)
    chosen = asked.order()[: whole_number(sample, "sample", 1) + 1].tolist()
    taken: list[float] = []
    asked.trials.kinds(asked.point(chosen[-1]))  # whatever compiles, compiles
    for cell in chosen[: max(len(chosen) - 1, 1)]:
        if taken and time_is_up():
            break
        begun = process_time()
        asked.trials.kinds(asked.point(cell))
        taken.append(process_time() - begun)
    spread = float(np.std(taken, ddof=1) / np.sqrt(len(taken))) if len(taken) > 1 else np.nan
    return CaptureMapCost(
        cells=asked.cells, run_ups=asked.cells * len(asked.trials.phases), seconds=asked.cells * float(np.mean(taken)),
        error=2 * asked.cells * spread, timed=len(taken), processes=processes, memory=BYTES_A_CELL * asked.cells,
        disk=(8 * len(KINDS)) * asked.cells + 128 * -(-asked.cells // PIECE), files=1 + -(-asked.cells // PIECE),
    )  # fmt: skip

"""The cells of a map of captures: what was asked for, and how they are computed, here or in processes of their own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from trunnion.arrays import Array, Integers
from trunnion.driveline.applied_torque import AppliedTorque, FrictionTorque
from trunnion.driveline.arguments import one_number, whole_number
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import SPEED, pack
from trunnion.driveline.scenarios import Scenario
from trunnion.equations.coefficients import Assembly
from trunnion.errors import InputError
from trunnion.motion.passing.start import ends_of, lasting
from trunnion.motion.passing.trials import FACTOR, Trials, passes, trials_of
from trunnion.numerics.memory import require_memory
from trunnion.numerics.workers import Workers
from trunnion.waiting import time_is_up

Request: TypeAlias = tuple[str, float, float, int]
Acting: TypeAlias = tuple[Sequence[AppliedTorque], Sequence[FrictionTorque], Scenario | str | None]
KINDS = ("passed", "captured", "short of torque", "undecided")
"""What is counted of the starting phases of a cell."""
UNKNOWN = -1
"""Of a cell that was not computed."""
BYTES_A_CELL = 160
"""Of a cell, with what is made of all of them."""
TOGETHER = 8
"""Cells that a worker elsewhere is sent at once."""
AHEAD = 4
"""Cells that wait for each process."""


@dataclass(frozen=True)
class MapRequest:
    """Trials over two parameters, whose values are x (m,) and y (k,)."""

    trials: Trials
    parameters: tuple[str, str]
    x: Array
    y: Array

    @property
    def cells(self) -> int:
        """How many; cell i has the x of its remainder by len(x)."""
        return len(self.x) * len(self.y)

    def point(self, cell: int) -> dict[str, float]:
        """The parameters of a cell."""
        row, column = divmod(cell, len(self.x))
        return {self.parameters[0]: float(self.x[column]), self.parameters[1]: float(self.y[row])}

    def order(self) -> Integers:
        """An order of the cells that soon lies all over the map."""
        return np.random.default_rng(0).permutation(self.cells)


def map_request(
    line: Driveline | Assembly, speeds: Sequence[float | str], x: Request, y: Request, asked: Acting, drive: str | None,
    phases: int | ArrayLike, tolerance: float,
) -> MapRequest:  # fmt: skip
    """A map that is asked for.

    Raises
    ------
    InputError : what is wrong with it, before anything is computed.
    """
    trials = trials_of(line, ends_of(speeds), lasting(line, *asked), drive, phases, tolerance)
    columns, rows = _values(trials.line, "x", x), _values(trials.line, "y", y)
    if x[0] == y[0]:
        raise InputError("is varied twice", key="y", value=y[0], remedy="give another parameter")
    for request in (x, y):
        _refused(trials, request)
    require_memory(float(BYTES_A_CELL) * x[3] * y[3], key="y", value=y[3], remedy="ask for fewer values of x or y")
    return MapRequest(trials, (x[0], y[0]), columns, rows)


def computed_cells(
    asked: MapRequest, counts: Integers, processes: int, workers: Workers | None = None
) -> Iterator[tuple[int, list[int]]]:
    """Cells without ``counts`` (cell, kind) as they come; none that the time limit cut short."""
    missing = (int(cell) for cell in asked.order() if counts[cell, 0] == UNKNOWN)
    if workers is not None:
        yield from _on_workers(asked, missing, workers)
        return
    if processes > 1:
        yield from _in_processes(asked, missing, processes)
        return
    for cell in missing:
        if time_is_up():
            return
        kinds = asked.trials.kinds(asked.point(cell))
        if time_is_up():
            return
        yield cell, counted_kinds(kinds)


def _on_workers(asked: MapRequest, missing: Iterator[int], workers: Workers) -> Iterator[tuple[int, list[int]]]:
    sent: list[list[int]] = []

    def pieces() -> Iterator[list[int]]:
        while cells := list(islice(missing, TOGETHER)):
            sent.append(cells)
            yield cells

    for number, found in workers.each(_Cells(asked).of, pieces()):
        yield from zip(sent[number], found, strict=True)


@dataclass(frozen=True)
class _Cells:
    asked: MapRequest

    def of(self, cells: Sequence[int]) -> list[list[int]]:
        """Counts of several cells, which a worker computes in turn."""
        return [counted_kinds(self.asked.trials.kinds(self.asked.point(cell))) for cell in cells]


def _in_processes(asked: MapRequest, missing: Iterator[int], processes: int) -> Iterator[tuple[int, list[int]]]:
    # Much of the work is done under the interpreter's lock, so that threads would wait for each other.
    with ProcessPoolExecutor(processes, get_context("spawn"), _begin_process, (asked,)) as pool:
        waiting: dict[Future[list[int]], int] = {}
        try:
            while True:
                for cell in islice(missing, AHEAD * processes - len(waiting)):
                    waiting[pool.submit(_in_process, cell)] = cell
                if not waiting:
                    return
                for one in wait(waiting, return_when=FIRST_COMPLETED).done:
                    yield waiting.pop(one), one.result()
                if time_is_up():
                    return
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


_of_this_process: list[MapRequest] = []
"""What a process was begun for."""


def _begin_process(asked: MapRequest) -> None:
    _of_this_process[:] = [asked]


def _in_process(cell: int) -> list[int]:
    asked = _of_this_process[0]
    return counted_kinds(asked.trials.kinds(asked.point(cell)))


def counted_kinds(kinds: Sequence[str]) -> list[int]:
    """How many of each of ``KINDS``."""
    return [passes(kinds), *(list(kinds).count(kind) for kind in KINDS[1:])]


def _values(line: Driveline, key: str, request: Request) -> Array:
    """Rising values (m,) of a parameter of the map."""
    remedy = '("HookeJoint 1.angle", 0.1, 0.3, 12), say'
    if not isinstance(request, tuple | list) or len(request) != 4 or not isinstance(request[0], str):
        raise InputError("must be a parameter, its first and last value and how many", key=key, remedy=remedy)
    path, low, high, count = request
    if path == SPEED:
        raise InputError(
            "is the parameter that the line runs through", key=key, value=path, remedy="vary another parameter"
        )
    if path != FACTOR:
        pack(line).resolve_axis(path)
    ends = one_number(low, key, remedy), one_number(high, key, remedy)
    if not (np.all(np.isfinite(ends)) and ends[0] < ends[1]) or (path == FACTOR and ends[0] <= 0):
        what = "must rise" if path != FACTOR else "must rise from above 0"
        raise InputError(what, key=key, value=list(request), remedy=remedy)
    whole_number(count, key, 2)
    require_memory(float(BYTES_A_CELL) * count, key=key, value=count, remedy="ask for fewer values")
    return np.linspace(*ends, count)


def _refused(trials: Trials, request: Request) -> None:
    path = request[0]
    if path == FACTOR:
        return
    packed = pack(trials.line)
    for end in request[1:3]:
        table = packed.table(1)
        packed.resolve_axis(path).put(table, end)
        packed.line_at(table[0])

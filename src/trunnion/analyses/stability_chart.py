"""Stability over any two parameters of a line.

Each point is a monodromy matrix of the compiled chain kernel with its own error estimate; rows run in
parallel threads.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from trunnion.analyses.axes import Axis, AxisRequest, axis
from trunnion.analyses.stability import operating_speed
from trunnion.driveline.driveline import Driveline
from trunnion.driveline.parameters import SPEED
from trunnion.equations.coefficients import Assembly, assemble
from trunnion.equations.lanes import chain_lanes, chain_program
from trunnion.equations.linear import require_steady_base
from trunnion.equations.topology import require_period
from trunnion.errors import InputError
from trunnion.numerics.chain_monodromy import ChainProgram, chain_monodromy
from trunnion.numerics.spectrum import multipliers, spectral_radius
from trunnion.results.chart import StabilityChart
from trunnion.results.verdict import verdicts

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]


def stability_chart(
    line: Driveline | Assembly,
    x: AxisRequest,
    y: AxisRequest,
    *,
    speed: float | None = None,
    tolerance: float = 1e-9,
    statically_twisted: bool = True,
    threads: int | None = None,
    progress: Progress | None = None,
) -> StabilityChart:
    """Verdict, spectral radius and its error over two parameters.

    Parameters
    ----------
    line : the driveline.
    x, y : ``(parameter, low, high, points)``, optionally with ``"log"`` at the end; a parameter is a path
        ("speed", "HookeJoint 1.angle", "factor of Shaft *.damping") or a ``Parameter``; values in SI.
    speed : input speed [rad/s] where neither axis is the speed; default the operating speed of the file.
    tolerance : error asked of each monodromy matrix, in energy-like units.
    statically_twisted : as in ``stability``.
    threads : default one per core.
    progress : called as progress(rows done, rows) from the calling thread.

    Returns
    -------
    StabilityChart, arrays of shape (y, x).

    Raises
    ------
    InputError : see ``axes.axis``; both axes the same; no speed.
    KeyboardInterrupt : passed on; nothing is kept.
    """
    assembly = line if isinstance(line, Assembly) else assemble(line)
    require_steady_base(assembly)
    period = 2 * np.pi * float(require_period(assembly.line, assembly.topology))
    across, said_x = axis(assembly, x, "x")
    up, said_y = axis(assembly, y, "y")
    if across.label == up.label:
        raise InputError("stands on both axes", key=across.label, remedy="give y another parameter")
    base = float("nan") if SPEED in (across.label, up.label) else operating_speed(assembly.line, speed)
    task = _Task(assembly, chain_program(assembly.topology), period, tolerance, base, across, up, statically_twisted)
    radius, error, undamped = _run_rows(task, threads or os.cpu_count() or 1, progress)
    return StabilityChart(
        x=across.values,
        y=up.values,
        x_label=across.label,
        y_label=up.label,
        x_unit=across.unit,
        y_unit=up.unit,
        spectral_radius=radius,
        error_estimate=error,
        verdict=verdicts(radius, error, undamped),
        speed=None if np.isnan(base) else base,
        period=period,
        tolerance=tolerance,
        remarks=tuple(s for s in (said_x, said_y) if s),
        line=assembly.line,
    )


@dataclass(frozen=True)
class _Task:
    assembly: Assembly
    program: ChainProgram
    period: float
    tolerance: float
    speed: float
    x: Axis
    y: Axis
    statically_twisted: bool

    def row(self, index: int) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Spectral radius, its error and whether damping is nil, along one row."""
        table = self.assembly.table(len(self.x.values), self.speed)
        self.x.columns.put(table, self.x.values)
        self.y.columns.put(table, self.y.values[index])
        coefficients = self.assembly.coefficients(table, statically_twisted=self.statically_twisted)
        lanes = chain_lanes(self.assembly.topology, coefficients)
        matrix, error, trace = chain_monodromy(self.program, lanes, self.period, self.tolerance)
        values, bound = multipliers(matrix, error)
        if self.assembly.topology.free:
            values, bound = _without_rigid_pair(values, bound)
        radius, radius_error = spectral_radius(values, bound)
        return radius, radius_error, np.abs(trace) < 1e-13 * self.assembly.topology.size


def _without_rigid_pair(
    values: NDArray[np.complex128], bound: Array
) -> tuple[NDArray[np.complex128], Array]:
    order = np.argsort(np.abs(values - 1), axis=-1)[..., 2:]
    return np.take_along_axis(values, order, -1), np.take_along_axis(bound, order, -1)


def _run_rows(
    task: _Task, threads: int, progress: Progress | None
) -> tuple[Array, Array, NDArray[np.bool_]]:
    shape = (len(task.y.values), len(task.x.values))
    radius, error, undamped = np.empty(shape), np.empty(shape), np.empty(shape, dtype=bool)
    with ThreadPoolExecutor(threads) as pool:
        pending: dict[Future[tuple[Array, Array, NDArray[np.bool_]]], int] = {
            pool.submit(task.row, i): i for i in range(shape[0])
        }
        done_rows = 0
        try:
            while pending:
                done, _ = wait(pending, return_when=FIRST_COMPLETED, timeout=0.5)
                for future in done:
                    i = pending.pop(future)
                    radius[i], error[i], undamped[i] = future.result()
                    done_rows += 1
                if progress is not None and done:
                    progress(done_rows, shape[0])
        except BaseException:
            for future in pending:
                future.cancel()
            raise
    return radius, error, undamped

"""What ways of charting cost, in microseconds of one core: which is tried, and when it is given up.

The numbers were measured on one machine; only their ratios decide, and a choice of the dearer way costs time, never
accuracy.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from trunnion.numerics.batch import BATCH

SLAB_NODES = 4000
"""Nodes at which the propagators of slabs are sampled, and what multiplying them takes, in integrations."""
HALVINGS = 2
"""Steps taken until they are known to be short enough, over those of the last run."""


def kernel_cost(size: int, phase: float) -> float:
    """One integration of ``size`` unknowns over ``phase`` radians of the highest mode."""
    return 1 + 0.07 * 2 * size**2 * phase


def pixel_cost(coefficients: int) -> float:
    """The largest multiplier from ``coefficients`` (6 at most), or of a matrix of that size."""
    return 0.05 * coefficients if coefficients <= 6 else 100 * (coefficients / 12) ** 2


def step_cost(states: int) -> float:
    """One exponential step of a system of ``states``."""
    return 0.7 + 2.6 * (states / 12) ** 2 * -(-states // BATCH)


def without_groups(size: int, pixels: int, mean_phase: float, longest_phase: float, fewest_for_slabs: int) -> float:
    """The cheaper of direct integration and slabs, multipliers at every pixel included."""
    shown = pixels * pixel_cost(2 * size)
    direct = pixels * kernel_cost(size, mean_phase)
    slabs = SLAB_NODES * kernel_cost(size, longest_phase)
    return shown + (min(direct, slabs) if pixels >= fewest_for_slabs else direct)


NODES_OF_MATRICES, STAGES = 2000, 4.0
"""Matrices of the period that a chart of a long line is made of, at most; what each costs more with meshes or loads."""


def long_chart_seconds(size: int, pixels: int, phase: float, stages: bool) -> float:
    """A chart of a long line, each matrix over ``phase`` radians of the highest mode."""
    node = 0.014 * size**2 * phase * (STAGES if stages else 1.0)
    return 1e-6 * (min(pixels, NODES_OF_MATRICES) * node + pixels * 750 * (size / 50) ** 3)


def long_chart_bytes(size: int, pixels: int) -> float:
    """What its matrices take while they are integrated."""
    return 8.0 * (2 * size) ** 2 * (3 * BATCH + min(pixels, 128))


COMPILING = 12.0
"""Seconds that compiling a line's kernels takes."""
spent_in_numpy = 0.0


@contextmanager
def instead_of_compiling() -> Iterator[None]:
    """Count the time spent within it, in NumPy, towards what compiling would have taken."""
    global spent_in_numpy
    begin = time.thread_time()
    try:
        yield
    finally:
        spent_in_numpy += time.thread_time() - begin


def compiling_pays() -> bool:
    """Whether this process has spent as much in NumPy as compiling takes: never more than twice the cheaper way."""
    return spent_in_numpy > COMPILING


def compile_at_once() -> None:
    """From now on kernels are compiled, as if enough had been spent."""
    global spent_in_numpy
    spent_in_numpy = float("inf")

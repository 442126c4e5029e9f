"""A 400 × 400 stability chart of the two-shaft line against one scipy integration per point.

    PYTHONPATH=src python benchmarks/chart.py [--points 400] [--sample 100] [--repeats 5] [--threads 2]

Box: Ω ∈ [0.02, 2], β ∈ [0, 1.5], ζ = 0.001, equal shafts and disks; both sides asked for 1e-8.

The rival integrates the same physics in absolute rotations (no second derivative of the joint's law, fewer
operations than the papers' twist form), the four columns of the monodromy matrix together, by scipy's RK45
at rtol = atol = 1e-8, one point after the other: what the papers do. Its time is that of a random sample of
the chart's points, scaled to all of them; on several cores it is credited with the better of perfect scaling
and a pool of processes. Everything is timed warm, and the package's first chart, which may compile, apart.
Memory is the peak of the resident set over all charts, above what it was after the imports.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import os
import platform
import resource
import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.results.chart import StabilityChart

Array = NDArray[np.float64]
TOLERANCE, ZETA = 1e-8, 0.001
SPEEDS, ANGLES = (0.02, 2.0), (0.0, 1.5)


def scipy_radius(point: tuple[float, float]) -> float:
    """Spectral radius at (Ω, β) by RK45, in absolute rotations: x₁, x₂, and their rates by τ."""
    speed, beta = point
    over, loss = 1 / speed**2, 2 * ZETA / speed
    cosine, sine2 = math.cos(beta), math.sin(beta) ** 2

    def slopes(tau: float, flat: Array) -> Array:
        y = flat.reshape(4, 4)
        sine = math.sin(tau)
        d = 1 - sine2 * sine * sine
        eta, eta1 = cosine / d, cosine * sine2 * math.sin(2 * tau) / (d * d)
        torque = over * (y[1] - eta * y[0]) + loss * (y[3] - eta * y[2] - eta1 * y[0])
        out = np.empty((4, 4))
        out[:2] = y[2:]
        out[2] = eta * torque - over * y[0] - loss * y[2]
        out[3] = -torque
        return out.reshape(-1)

    run = solve_ivp(slopes, (0.0, math.pi), np.eye(4).ravel(), method="RK45", rtol=TOLERANCE, atol=TOLERANCE)
    return float(np.abs(np.linalg.eigvals(run.y[:, -1].reshape(4, 4))).max())


def chart(points: int, threads: int) -> StabilityChart:
    """The package's chart of the same box."""
    return tn.stability_chart(
        tn.catalogue("two-shaft-cardan", damping_ratio=ZETA),
        x=("speed", *SPEEDS, points),
        y=("HookeJoint 1.angle", *ANGLES, points),
        tolerance=TOLERANCE,
        threads=threads,
    )


def timed(action: Callable[[], object]) -> float:
    """Seconds that ``action`` takes."""
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def resident() -> float:
    """Resident set now [MB] where the system tells, else its peak so far."""
    try:
        with open("/proc/self/statm", encoding="ascii") as stream:
            return int(stream.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    except OSError:
        return peak_resident()


def peak_resident() -> float:
    """Largest resident set so far [MB]."""
    unit = 1e6 if sys.platform == "darwin" else 1e3
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def rival_per_point(sample: list[tuple[float, float]], cores: int) -> tuple[float, float, list[float]]:
    """Seconds a point for one core and for all of them, and the radii."""
    scipy_radius(sample[0])
    radii: list[float] = []
    single = timed(lambda: radii.extend(map(scipy_radius, sample))) / len(sample)
    if cores == 1:
        return single, single, radii
    with multiprocessing.get_context("spawn").Pool(cores) as pool:
        pool.map(scipy_radius, sample[: 4 * cores], chunksize=1)
        pooled = timed(lambda: pool.map(scipy_radius, sample, chunksize=1)) / len(sample)
    return single, min(single / cores, pooled), radii


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--points", type=int, default=400, help="points along each axis")
    parser.add_argument("--sample", type=int, default=100, help="points scipy integrates")
    parser.add_argument("--repeats", type=int, default=5, help="warm charts; the median is reported")
    parser.add_argument("--threads", type=int, default=2, help="cores on both sides")
    options = parser.parse_args()
    points, threads = options.points, options.threads

    import trunnion.floquet.charts.stability_chart  # noqa: F401  (lazy imports count as imports)

    before = resident()
    first = timed(lambda: chart(points, threads))
    peak_first = peak_resident()
    times = [timed(lambda: chart(points, threads)) for _ in range(options.repeats)]
    result = chart(points, threads)
    peak = peak_resident()

    tracemalloc.start()
    chart(points, threads)
    traced = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()

    rng = np.random.default_rng(1)
    rows, columns = rng.integers(points, size=(2, options.sample))
    sample = [(float(result.x[j]), float(result.y[i])) for i, j in zip(rows, columns, strict=True)]
    single, pooled, radii = rival_per_point(sample, threads)
    apart = np.abs(result.spectral_radius[rows, columns] - np.array(radii))

    ours, total = statistics.median(times), pooled * points**2
    versions = f"Python {platform.python_version()}, numpy {np.__version__}"
    print(f"{platform.machine()}, {os.cpu_count()} cores, {versions}")
    print(f"{points} × {points} points, tolerance {TOLERANCE:g}, {threads} threads or processes\n")
    print(f"{'':44}{'seconds':>12}{'points/s':>14}")
    rows_out = [
        (f"trunnion, warm, median of {options.repeats}", ours),
        (f"  fastest … slowest {min(times):.3f} … {max(times):.3f}", None),
        ("trunnion, first chart of the process", first),
        (f"scipy RK45, {threads} cores, scaled from {options.sample} points", total),
        ("scipy RK45, one core, scaled", single * points**2),
    ]
    for label, seconds in rows_out:
        print(f"{label:44}" + ("" if seconds is None else f"{seconds:12.3f}{points**2 / seconds:14.0f}"))
    print(f"\nratio on {threads} cores: {total / ours:.0f}")
    print(
        f"peak memory above the imports: {peak - before:.0f} MB (first chart {peak_first - before:.0f} MB), ",
        end="",
    )
    print(f"Python allocations of one chart {traced:.0f} MB")
    worst = np.nanmax(result.error_estimate[rows, columns])
    print(f"spectral radius, scipy − chart: at most {apart.max():.1e}, median {np.median(apart):.1e};")
    print(f"the chart's own estimate at these points: at most {worst:.1e}")


if __name__ == "__main__":
    main()

"""Charts as functions: sizes 2, 3 and 8 against scipy, zoom, memory, and the direct kernel.

    PYTHONPATH=src python benchmarks/charts.py [--threads 2] [--repeats 3] [--quick]

All in one process and warm, the median of a few runs. The rival is scipy's RK45 at rtol = atol = 1e-8 with the
same physics in absolute rotations (no second derivative of the joint's law), all columns of the monodromy
matrix together, over one period of half a turn; its time is that of a random sample of points,
scaled to all and divided by the number of threads, as if it scaled perfectly.
"""

from __future__ import annotations

import argparse
import math
import os
import platform
import resource
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numba
import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import trunnion as tn
from trunnion.equations.chain_batch import chain_batch, chain_program
from trunnion.equations.coefficients import assemble
from trunnion.equations.topology import require_period
from trunnion.numerics.batch import BATCH
from trunnion.numerics.chain.chain_monodromy import Window, chain_monodromy, symmetry_phase
from trunnion.results.chart import StabilityChart

Array = NDArray[np.float64]
TOLERANCE = 1e-8


def equal_chain(disks: int, damping: float = 0.002) -> tn.Driveline:
    """Disks of inertia 1 on shafts of stiffness 1, a joint between each and the next."""
    elements: list[object] = [tn.ConstantSpeed()]
    for i in range(disks):
        elements += [tn.Shaft(stiffness=1.0, damping=damping), tn.Disk(inertia=1.0)]
        if i < disks - 1:
            elements.append(tn.HookeJoint(angle=0.3))
    return tn.Driveline(elements)


def numbers_of(line: tn.Driveline) -> tuple[list[float], list[float], list[float]]:
    """Stiffness, damping and inertia along a line without forks, gears or loads."""
    shafts = [e for e in line.elements if e.kind == "Shaft"]
    disks = [e for e in line.elements if e.kind == "Disk"]
    return [s.stiffness for s in shafts], [s.damping for s in shafts], [d.inertia for d in disks]


def scipy_radius(line: tn.Driveline, speed: float, angles: list[float]) -> float:
    """Spectral radius by RK45 in absolute rotations, one integration for all columns."""
    k, c, inertia = numbers_of(line)
    n = len(k)
    over, loss = [s / speed**2 for s in k], [d / speed for d in c]
    cosines, squares = [math.cos(b) for b in angles], [math.sin(b) ** 2 for b in angles]
    halves = [math.tan(b / 2) ** 2 for b in angles]
    forks = [e.fork_offset for e in line.elements if e.kind == "Shaft"]

    def slopes(tau: float, flat: Array) -> Array:
        y = flat.reshape(2 * n, 2 * n)
        out = np.empty_like(y)
        out[:n] = y[n:]
        force = over[0] * y[0] + loss[0] * y[n]
        chi, w = tau + forks[0], 1.0
        for i in range(n - 1):
            double_sine, double_cosine = math.sin(2 * chi), math.cos(2 * chi)
            d = 1 - squares[i] * (1 + double_cosine) / 2
            eta = cosines[i] / d
            eta1 = -eta * squares[i] * double_sine / d * w
            torque = over[i + 1] * (y[i + 1] - eta * y[i]) + loss[i + 1] * (y[n + i + 1] - eta * y[n + i] - eta1 * y[i])
            out[n + i] = (eta * torque - force) / inertia[i]
            force, w = torque, eta * w
            t = halves[i]
            chi += math.atan2(t * double_sine, 1 - t * double_cosine) + math.pi / 2 + forks[i + 1]
        out[2 * n - 1] = -force / inertia[n - 1]
        return out.reshape(-1)

    start = np.eye(2 * n).ravel()
    run = solve_ivp(slopes, (0.0, math.pi), start, method="RK45", rtol=TOLERANCE, atol=TOLERANCE)
    return float(np.abs(np.linalg.eigvals(run.y[:, -1].reshape(2 * n, 2 * n))).max())


def seconds(action: Callable[[], object], repeats: int) -> float:
    """Median time of a call, after one that may compile."""
    action()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


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


def rival(
    line: tn.Driveline, chart: StabilityChart, angles_of: Callable[[float], list[float]], sample: int
) -> tuple[float, float]:
    """Seconds a point of the rival on one core, and its largest distance from the chart."""
    rng = np.random.default_rng(1)
    rows, columns = rng.integers(len(chart.y), size=sample), rng.integers(len(chart.x), size=sample)
    points = [(float(chart.x[j]), angles_of(float(chart.y[i]))) for i, j in zip(rows, columns, strict=True)]
    scipy_radius(line, *points[0])
    start = time.perf_counter()
    radii = [scipy_radius(line, *point) for point in points]
    each = (time.perf_counter() - start) / sample
    return each, float(np.abs(chart.spectral_radius[rows, columns] - radii).max())


def heyoka_seconds(line: tn.Driveline, chart: StabilityChart, sample: int) -> tuple[float, float] | None:
    """Seconds a point of heyoka's Taylor integrator in batches on one core, and its distance; None without it.

    Two shafts and a joint, all four columns in one system of 16 equations; compiling is not counted.
    """
    try:
        import heyoka as hy
    except ImportError:
        return None
    (k1, k2), (c1, c2), (inertia1, inertia2) = numbers_of(line)
    fork = next(e for e in line.elements if e.kind == "Shaft").fork_offset
    over, loss, cosine = hy.par[0], hy.par[1], hy.par[2]
    chi = hy.time + fork
    d = 1.0 - (1.0 - cosine**2) * hy.cos(chi) ** 2
    eta = cosine / d
    eta1 = -cosine * (1.0 - cosine**2) * hy.sin(2.0 * chi) / d**2
    equations = []
    for column in range(4):
        x1, x2, v1, v2 = hy.make_vars(*(f"{name}{column}" for name in ("x1", "x2", "v1", "v2")))
        near = k1 * over * x1 + c1 * loss * v1
        far = k2 * over * (x2 - eta * x1) + c2 * loss * (v2 - eta * v1 - eta1 * x1)
        equations += [(x1, v1), (x2, v2), (v1, (eta * far - near) / inertia1), (v2, -far / inertia2)]
    width = hy.recommended_simd_size()
    start = np.repeat(np.eye(4).ravel()[:, None], width, axis=1)
    run = hy.taylor_adaptive_batch(equations, start, tol=TOLERANCE, pars=np.zeros((3, width)), compact_mode=True)
    rng = np.random.default_rng(2)
    sample -= sample % width
    rows, columns = rng.integers(len(chart.y), size=sample), rng.integers(len(chart.x), size=sample)
    # Slow and fast lines in one batch wait for each other; neighbours stand together.
    order = np.argsort(chart.x[columns])
    rows, columns = rows[order], columns[order]
    apart, begin = 0.0, time.perf_counter()
    for at in range(0, sample, width):
        speed, angle = chart.x[columns[at : at + width]], chart.y[rows[at : at + width]]
        run.set_time(0.0)
        run.state[:] = start
        run.pars[:] = [1 / speed**2, 1 / speed, np.cos(angle)]
        run.propagate_until(math.pi)
        for lane in range(width):
            monodromy = run.state[:, lane].reshape(4, 4).T
            radius = np.abs(np.linalg.eigvals(monodromy)).max()
            apart = max(apart, abs(radius - chart.spectral_radius[rows[at + lane], columns[at + lane]]))
    return (time.perf_counter() - begin) / sample, apart


def kernel_rate(line: tn.Driveline, speed: tuple[float, float], angle: tuple[float, float], batch: int) -> float:
    """Monodromies a second of the chain kernel, one thread, at 1e-9, over a box of speed and all joint angles."""
    assembly = assemble(line)
    side = round(math.sqrt(batch))
    table = assembly.table(side**2)
    table[:, 0] = np.tile(np.linspace(*speed, side), side)
    for c, label in enumerate(assembly.packed.labels):
        if label.startswith("HookeJoint") and label.endswith(".angle"):
            table[:, c] = np.repeat(np.linspace(*angle, side), side)
    topology = assembly.topology
    coefficients = assembly.coefficients(table)
    program, numbers = chain_program(topology, coefficients), chain_batch(topology, coefficients)
    period = 2 * np.pi * float(require_period(line, topology))
    begin = symmetry_phase(program, numbers, period)
    window = Window(0.0 if begin is None else begin, period, begin is not None)
    return side**2 / seconds(lambda: chain_monodromy(program, numbers, window, 1e-9, 1), 3)


def processor() -> str:
    """The processor's model name where the system tells."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            return next(row.split(":", 1)[1].strip() for row in stream if row.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description="charts of lines of 2, 3 and 8 disks against scipy")
    parser.add_argument("--threads", type=int, default=2, help="cores on both sides")
    parser.add_argument("--repeats", type=int, default=3, help="warm runs; the median is reported")
    parser.add_argument("--quick", action="store_true", help="charts of a quarter of the points per axis")
    options = parser.parse_args()
    threads, repeats, less = options.threads, options.repeats, 4 if options.quick else 1

    print(f"{processor()}, {os.cpu_count()} cores")
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, numba {numba.__version__}, "
        f"scipy {scipy.__version__}; {threads} threads, batches of {BATCH}\n"
    )
    two, three, eight = tn.catalogue("two-shaft-cardan"), tn.catalogue("three-shaft-cardan"), equal_chain(8)

    def chart(line: tn.Driveline, speed: tuple[float, float], angle: tuple[float, float], n: int) -> StabilityChart:
        joint = "HookeJoint *.angle" if line is not two else "HookeJoint 1.angle"
        return tn.stability_chart(line, ("speed", *speed, n), (joint, *angle, n), tolerance=TOLERANCE, threads=threads)

    import trunnion.floquet.charts.stability_chart  # noqa: F401  (lazy imports count as imports)

    chart(two, (0.02, 2.0), (0.0, 1.5), 200)
    before = resident()
    kept = chart(two, (0.02, 2.0), (0.0, 1.5), 1000 // less)
    increment = peak_resident() - before

    print(f"{'chart':34}{'chart [s]':>10}{'scipy [s]':>12}{'ratio':>8}   {'apart':8}")
    cases = [
        ("n = 2, Ω 0.02…2, β 0…1.5 rad", two, (0.02, 2.0), (0.0, 1.5), 1000 // less, 1, 100),
        ("n = 3, Ω 0.02…2, β 0…1.2 rad", three, (0.02, 2.0), (0.0, 1.2), 1000 // less, 2, 50),
        ("n = 8, Ω 0.1…2, β 0…0.5 rad", eight, (0.1, 2.0), (0.0, 0.5), 400 // less, 7, 10),
    ]
    for name, line, speed, angle, n, joints, sample in cases:
        took = seconds(lambda: chart(line, speed, angle, n), repeats)  # noqa: B023
        result = chart(line, speed, angle, n)
        each, apart = rival(line, result, lambda b: [b] * joints, sample)  # noqa: B023
        other = each * n**2 / threads
        print(f"{f'{name}, {n}²':34}{took:10.3f}{other:12.0f}{other / took:8.0f}   {apart:.1e}")
        print(f"{'':6}{result.spot_check}", flush=True)
        if line is two and (other := heyoka_seconds(line, result, 400)) is not None:
            scaled = other[0] * n**2 / threads
            print(f"{'':6}heyoka in batches: {scaled:.0f} s, {scaled / took:.0f} times the chart, apart {other[1]:.1e}")

    truck = tn.load(Path(__file__).parents[1] / "examples" / "truck.toml")
    ranges = (tn.rpm(300), tn.rpm(2400)), (0.0, tn.deg(15))
    for across, up in ((40, 30), (200, 150)):
        spent, every = [], []
        for _ in range(repeats + 1):
            begin, wall = time.process_time(), time.perf_counter()
            result = tn.stability_chart(
                truck, ("speed", *ranges[0], across), ("HookeJoint *.angle", *ranges[1], up),
                tolerance=TOLERANCE, threads=threads,
            )  # fmt: skip
            spent.append(time.process_time() - begin)
            every.append(time.perf_counter() - wall)
        middle, clock = np.median(spent[1:]), np.median(every[1:])
        nodes = result.function.evaluations
        print(f"truck, {across} × {up}: {middle:.2f} s of processor time, {clock:.2f} s by the clock, {nodes} matrices")

    n = 1000 // less
    for name, speed, angle in (
        ("fast half", (1.0, 1.9), (0.2, 1.2)),
        ("slow corner", (0.05, 0.15), (0.5, 1.4)),
    ):
        again = seconds(lambda: kept.zoom((*speed, n), (*angle, n)), repeats)  # noqa: B023
        fresh = seconds(lambda: chart(two, speed, angle, n), repeats)  # noqa: B023
        whole = seconds(lambda: chart(two, (0.02, 2.0), (0.0, 1.5), n), 1)
        print(
            f"zoom to Ω {speed[0]:g}…{speed[1]:g}, β {angle[0]:g}…{angle[1]:g}, {n}² ({name}): {again:.3f} s; "
            f"that box fresh {fresh:.3f} s ({fresh / again:.1f}×), the whole chart {whole:.3f} s ({whole / again:.1f}×)"
        )
    print(f"peak memory above what stood before, n = 2, {n}²: {increment:.0f} MB")

    for name, line, speed, angle, batch in (
        ("n = 2, S1's box", two, (0.02, 2.0), (0.0, 1.5), 90_000),
        ("n = 3, S1's speeds, β to 1.2", three, (0.02, 2.0), (0.0, 1.2), 40_000),
        ("n = 20, Ω 0.5…2, β to 0.3", equal_chain(20), (0.5, 2.0), (0.0, 0.3), 1600),
    ):
        rate = kernel_rate(line, speed, angle, batch)
        print(f"kernel, one thread, 1e-9, {name}: {rate:.0f} monodromies/s", flush=True)


if __name__ == "__main__":
    main()

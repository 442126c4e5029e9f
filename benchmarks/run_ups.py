"""Run-ups from a low speed by a motor's curve: three inertias, one Hooke's joint, 382 turns.

    PYTHONPATH=src python benchmarks/run_ups.py [RUNS] [PROCESSES]

Prints the processor time of one run by tolerance, and what 10 000 take in so many processes, taken from RUNS of them
with angles and stiffnesses at random; then what a map of 10 000 run-ups takes, whose cells keep no motion, as
``capture_map_cost`` says. The numbers of the last run stand in ``benchmarks/README.md``.
"""

from __future__ import annotations

import sys
import time
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import trunnion as tn

DURATION, ALL = 28.0, 10_000
CURVE = ((0.0, 60.0), (100.0, 55.0), (150.0, 30.0), (200.0, -60.0))


def line(angle: float = 0.14, stiffness: float = 2e4) -> tn.Driveline:
    curve = [{"speed": speed, "torque": torque} for speed, torque in CURVE]
    return tn.Driveline(
        [
            tn.Motor(name="motor", inertia=0.5, curve=curve),
            tn.HookeJoint(angle=angle),
            tn.Shaft(name="front", stiffness=stiffness, damping=6.0),
            tn.Disk(name="middle", inertia=0.3),
            tn.Shaft(name="rear", stiffness=1.5 * stiffness, damping=6.0),
            tn.Fan(name="mill", inertia=8.0, quadratic_load=5e-4),
        ]
    )


def run(seed: int, tolerance: float) -> tuple[float, float, float]:
    """Turns, largest torque [N m] and processor time [s] of one."""
    rng = np.random.default_rng(seed)
    made = line(float(rng.uniform(0.05, 0.2)), float(rng.uniform(1e4, 3e4)))
    begin = time.process_time()
    found = tn.transient(made, DURATION, speed=5.0, tolerance=tolerance)
    peak = float(found.peak_torque.max())
    return float(found.angle[-1, 0] / (2 * np.pi)), peak, time.process_time() - begin


def of(pair: tuple[int, float]) -> tuple[float, float, float]:
    return run(*pair)


if __name__ == "__main__":
    count = int(sys.argv[1]) if sys.argv[1:] else 200
    processes = int(sys.argv[2]) if sys.argv[2:] else 2
    for tolerance in (1e-10, 1e-8, 1e-6):
        run(0, tolerance)
        found = [run(seed, tolerance) for seed in range(20)]
        turns, peaks, each = (np.array(column) for column in zip(*found, strict=True))
        print(f"tolerance {tolerance:g}: {turns.mean():.0f} turns, {np.median(each):.3f} s of processor time each")
        if tolerance == 1e-10:
            fine = peaks
        else:
            print(f"  largest torques differ from those at 1e-10 by up to {np.abs(peaks / fine - 1).max():.1g}")
        with ProcessPoolExecutor(processes) as pool:
            list(pool.map(of, [(seed, tolerance) for seed in range(2 * processes)]))
            begin = time.monotonic()
            used = sum(one[2] for one in pool.map(of, [(seed, tolerance) for seed in range(count)], chunksize=8))
            wall = time.monotonic() - begin
        print(f"  {ALL} of them: {ALL * wall / count / 60:.1f} min in {processes} processes on this machine as loaded, "
              f"{ALL * used / count / processes / 60:.1f} min by processor time")  # fmt: skip
    angles, stiffnesses = ("HookeJoint 1.angle", 0.05, 0.2, 100), ("front.stiffness", 1e4, 3e4, 100)
    for phases in (1, 8):
        print(tn.capture_map_cost(line(), (5.0, 138.0), angles, stiffnesses, phases=phases, sample=40, processes=2))

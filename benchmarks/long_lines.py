"""Long lines: chains of 10 to 300 inertias, straight and with two bent joints, processor seconds of warm calls.

    PYTHONPATH=src OPENBLAS_NUM_THREADS=1 python benchmarks/long_lines.py [--repeats 5] [--most 300]

``order_response`` at 50 speeds and 3 orders; medians on one thread.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

import trunnion as tn

SPEEDS = tn.rpm(np.linspace(600.0, 3000.0, 50))
ORDERS = (1.5, 3.0, 4.5)
TARGETS = {50: 0.15, 100: 0.4, 300: 1.5}
"""Seconds of ``order_response`` with two bent joints."""


def chain(inertias: int, joints: int = 2) -> tn.Driveline:
    """A driven chain shaken by three orders at its middle; joints at 15° behind the first and the second third."""
    rng, elements = np.random.default_rng(inertias), [tn.ConstantSpeed()]
    bends = {inertias // 3 * (j + 1) for j in range(joints)}
    for i in range(inertias):
        k = float(rng.uniform(1e5, 1e6))
        elements.append(tn.Shaft(stiffness=k, damping=2e-5 * k))
        shaken = [{"order": order, "amplitude": 50.0} for order in ORDERS] if i == inertias // 2 else []
        elements.append(tn.Disk(inertia=float(rng.uniform(0.05, 0.3)), excitation=shaken))
        if i + 1 in bends:
            elements.append(tn.HookeJoint(angle=tn.deg(15.0)))
    return tn.Driveline(elements)


def median(work: Callable[[], object], repeats: int) -> float:
    """Processor seconds of ``work``, once for warmth and then the median."""
    work()
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return statistics.median(times)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--most", type=int, default=300)
    asked = parser.parse_args()
    print("| inertias | straight [s] | two bent joints [s] | target |\n|---|---|---|---|")
    for n in (10, 20, 50, 100, 300):
        if n <= asked.most:
            straight, bent = (
                median(lambda line=line: tn.order_response(line, SPEEDS), asked.repeats)
                for line in (chain(n, 0), chain(n))
            )
            print(f"| {n} | {straight:.4f} | {bent:.3f} | {TARGETS.get(n, '')} |", flush=True)


if __name__ == "__main__":
    main()

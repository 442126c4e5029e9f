"""Every tongue of a box beside the chart that shows fewer, limits over 400 speeds, and 10⁵ lines within tolerances.

Warm: every call runs once before it is timed; the clock and the processor time of all threads are printed.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

import trunnion as tn
from trunnion.results.verdict import Verdict

LINE = tn.catalogue("two-shaft-cardan")
SPEED, ANGLE = ("speed", 0.05, 2.0), ("HookeJoint 1.angle", 0.05, 1.45)
ROWS = 15


def timed(name: str, call: Callable[[], object]) -> object:
    """The second call's answer; prints its seconds."""
    call()
    clock, processor = time.perf_counter(), time.process_time()
    found = call()
    clock, processor = time.perf_counter() - clock, time.process_time() - processor
    print(f"| {name} | {clock:.2f} | {processor:.2f} |", flush=True)
    return found


def pixel_intervals(chart: tn.StabilityChart) -> int:
    """Runs of unstable pixels over all rows."""
    unstable = np.pad(chart.verdict == Verdict.UNSTABLE, ((0, 0), (1, 1)))
    return int((np.diff(unstable.astype(int), axis=1) == 1).sum())


def main() -> None:
    """Print the table."""
    print("| what | s by the clock | s of processor time |\n|---|---|---|")
    few = timed(f"tongues, {ROWS} rows", lambda: tn.tongues(LINE, SPEED, ANGLE, rows=ROWS))
    timed("tongues, 65 rows (default)", lambda: tn.tongues(LINE, SPEED, ANGLE))
    chart = timed("chart, 8193 × 15", lambda: tn.stability_chart(LINE, (*SPEED, 8193), (*ANGLE, ROWS)))
    timed("chart, 8193 × 65", lambda: tn.stability_chart(LINE, (*SPEED, 8193), (*ANGLE, 65)))
    solved = sum(len(few.intervals_at(float(y))) for y in np.linspace(*ANGLE[1:], ROWS))
    print(f"\nunstable intervals on {ROWS} rows: {solved} solved for, {pixel_intervals(chart)} seen by 8193 pixels\n")
    speeds = np.linspace(0.3, 2.0, 400)
    timed("stable_limit, 400 speeds", lambda: tn.stable_limit(LINE, "HookeJoint 1.angle", speeds, high=1.2))
    axes = ("speed", 0.3, 2.0, 400), ("HookeJoint 1.angle", 0.0, 1.2, 200)
    timed("chart of the same box, 400 × 200", lambda: tn.stability_chart(LINE, *axes))
    bent = tn.catalogue("two-shaft-cardan", angle=0.3)
    scatter = {
        "Shaft 1.stiffness": 0.1,
        "Disk 2.inertia": ("normal", 0.03),
        "HookeJoint 1.angle": ("range", 0.25, 0.32),
    }
    timed("tolerance_study, 10⁵ lines", lambda: tn.tolerance_study(bent, scatter, 1.66, samples=100_000))


if __name__ == "__main__":
    main()

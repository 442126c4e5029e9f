"""10⁴ angles × 6 joints: one turn of the package against the 3-D vector model evaluated angle by angle.

    python benchmarks/kinetostatics.py

Both compute motion, torques and secondary couples of the same random line of six Hooke's joints in space.
"""

from __future__ import annotations

import sys
from pathlib import Path
from statistics import median
from time import perf_counter

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "kinetostatics"))

import lines
import numpy as np
import vector_model

import trunnion as tn

ANGLES = 10_000
SAMPLE = 500
"""Angles the vector model is timed over; it takes the same time for each."""


def seconds(function, repeats: int) -> float:
    """Median time of a call [s]."""
    times = []
    for _ in range(repeats):
        start = perf_counter()
        function()
        times.append(perf_counter() - start)
    return median(times)


def main() -> None:
    line = lines.random_line(6, seed=2)
    described = lines.driveline(line)
    result = tn.kinetostatics(described, speed=line.speed, points=ANGLES)
    angles = result.input_angle[:: ANGLES // SAMPLE]

    def one_by_one() -> list[float]:
        return [vector_model.forces(line, vector_model.motion(line, x))["drive_torque"] for x in angles]

    apart = np.abs(np.array(one_by_one()) - result.drive_torque[:: ANGLES // SAMPLE]).max()
    slow = seconds(one_by_one, 3) * ANGLES / SAMPLE
    rigid = seconds(lambda: tn.kinetostatics(described, speed=line.speed, points=ANGLES), 9)
    elastic = seconds(lambda: tn.kinetostatics(described, speed=line.speed, points=ANGLES, rigid=False), 5)
    print(f"{ANGLES} angles × 6 joints; drive torques agree to {apart:.1e} N m")
    print(f"  vector model, angle by angle   {slow:8.2f} s (timed over {SAMPLE} angles)")
    print(f"  kinetostatics, rigid shafts    {rigid:8.4f} s, {slow / rigid:7.0f} times faster")
    print(f"  kinetostatics, elastic shafts  {elastic:8.4f} s, {slow / elastic:7.0f} times faster")


if __name__ == "__main__":
    main()

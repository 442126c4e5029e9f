"""Whether charts choose the cheaper way: the cost model of ``floquet.charts.cost_model`` against measured seconds.

    PYTHONPATH=src python benchmarks/cost_model.py

Each chart is built as the model chooses, then with few whole-period nodes forbidden, then with them always tried.
Processor seconds of warm charts on one thread; "dearer" is what the choice cost over the better of the two.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts import chart_families
from trunnion.floquet.charts.axes import axis
from trunnion.floquet.charts.chart_pixels import judge_matrices
from trunnion.floquet.charts.cost_model import kernel_cost, pixel_cost, step_cost
from trunnion.results.chart import StabilityChart

TRUCK = tn.load(Path(__file__).parents[1] / "examples" / "truck.toml")
NEVER, ALWAYS = 0.0, 1e12
"""Prices of the other ways [µs] at which few nodes are never and always tried."""


@contextmanager
def other_ways_cost(price: float | None) -> Iterator[None]:
    """Charts as if all but few nodes cost ``price`` [µs]; None: as the model says."""
    model = chart_families.without_groups
    if price is not None:
        chart_families.without_groups = lambda *asked: price  # type: ignore[assignment]
    try:
        yield
    finally:
        chart_families.without_groups = model


def chart(line: tn.Driveline, speed: tuple[float, float], angle: float, size: tuple[int, int]) -> StabilityChart:
    """The chart on one thread."""
    return tn.stability_chart(
        line, ("speed", *speed, size[0]), ("HookeJoint *.angle", 0.0, angle, size[1]), tolerance=1e-8, threads=1
    )


def seconds(price: float | None, *asked: object) -> float:
    """Of processor time, the second of two."""
    with other_ways_cost(price):
        for _ in range(2):
            begin = time.process_time()
            chart(*asked)  # type: ignore[arg-type]
            taken = time.process_time() - begin
    return taken


def unit_prices() -> None:
    """µs of the kernels that the model names, modelled and measured."""
    assembly = assemble(TRUCK)
    x, _ = axis(assembly, ("speed", *tn.rpm(np.array([600.0, 2400.0])).tolist(), 40), "x")
    y, _ = axis(assembly, ("HookeJoint *.angle", 0.0, 0.25, 16), "y")
    family = chart_families.LineFamily(assembly, x, y, float("nan"), True, half_windows=False)
    at = np.tile(x.values, 16), np.repeat(y.values, 40)
    points = family.exponentials(*at)
    phase = family.batch(*at).frequency * np.sqrt(family.size) * family.period
    which, steps = np.arange(points.count), 128
    found = family.matrices(*at, 1e-9, 1)
    step = step_cost(points.states)
    for name, model, call, count in (
        ("an exponential step", step, lambda: points.monodromies(which, steps), steps * len(which)),
        ("an integration", kernel_cost(family.size, float(phase.mean())), lambda: family.matrices(*at, 1e-9, 1), 640),
        ("eigenvalues of a pixel", pixel_cost(points.states), lambda: judge_matrices(*found), len(which)),
    ):  # fmt: skip
        call()
        begin = time.process_time()
        call()
        print(f"| {name}, 12 states | {model:.1f} | {1e6 * (time.process_time() - begin) / count:.1f} |")


def main() -> None:
    """Print both tables."""
    print("| truck, µs | model | measured |\n|---|---|---|")
    unit_prices()
    two, rpm = tn.catalogue("two-shaft-cardan"), tn.rpm(np.array([300.0, 2400.0]))
    speeds = float(rpm[0]), float(rpm[1])
    print("\n| chart | as chosen [s] | without few nodes | few nodes always tried | dearer |\n|---|---|---|---|---|")
    for name, *asked in (
        ("truck, 12 × 8", TRUCK, speeds, 0.26, (12, 8)),
        ("truck, 40 × 30", TRUCK, speeds, 0.26, (40, 30)),
        ("truck, 200 × 150", TRUCK, speeds, 0.26, (200, 150)),
        ("two shafts, 100 × 75", two, (0.2, 2.0), 1.2, (100, 75)),
        ("two shafts, 400 × 300", two, (0.2, 2.0), 1.2, (400, 300)),
    ):
        chosen, without, always = (seconds(price, *asked) for price in (None, NEVER, ALWAYS))
        dearer = 100 * (chosen / min(without, always) - 1)
        print(f"| {name} | {chosen:.3f} | {without:.3f} | {always:.3f} | {dearer:+.0f} % |", flush=True)


if __name__ == "__main__":
    main()

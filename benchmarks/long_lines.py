"""Long lines: chains of 10 to 300 inertias, straight and with two angled joints, processor seconds of warm calls.

    PYTHONPATH=src OPENBLAS_NUM_THREADS=1 python benchmarks/long_lines.py [--repeats 5] [--most 300]

Straight free chains stand beside openTorsion where that is installed, side by side. ``order_response`` at 50 speeds
and 3 orders, and whether short lines take the cheaper of its two ways; ``stability`` at one speed,
and whether it takes the cheaper of its two ways; the response with the largest torques over a range, as estimated
before it begins and as it took; ``stability_chart`` over speed and joint angles, once, as chosen and
without grids of whole matrices where that takes no more than a minute; once each, with the largest memory, what looks
over the whole range: modes and Campbell diagram, uneven turns, unstable speeds, the response with the largest torques,
``assess`` and ``sensitivity``.
Medians on one thread.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator

import numpy as np
from orders import open_torsion

import trunnion as tn
from trunnion.equations.coefficients import assemble
from trunnion.floquet.charts.chart_families import ChartFamily, LineFamily
from trunnion.floquet.propagation import tree_modes
from trunnion.floquet.ranges.span import Span
from trunnion.floquet.ranges.unstable import unstable_ranges
from trunnion.floquet.stability import stability as judged
from trunnion.floquet.stability.stability_over_speed import stability_along
from trunnion.response.speed_sweep import begun_with, cost_of_range, response_over
from trunnion.steady.orders import spectrum

SPEEDS = tn.rpm(np.linspace(600.0, 3000.0, 50))
ORDERS = (1.5, 3.0, 4.5)
TARGETS = {50: 0.15, 100: 0.4, 300: 1.5}
"""Seconds of ``order_response`` with two angled joints."""


def chain(inertias: int, joints: int = 2, degrees: float = 15.0) -> tn.Driveline:
    """A driven chain shaken by three orders at its middle; joints at ``degrees`` behind the first and second third."""
    rng, elements = np.random.default_rng(inertias), [tn.ConstantSpeed()]
    bends = {inertias // 3 * (j + 1) for j in range(joints)}
    for i in range(inertias):
        k = float(rng.uniform(1e5, 1e6))
        elements.append(tn.Shaft(stiffness=k, damping=2e-5 * k))
        shaken = [{"order": order, "amplitude": 50.0} for order in ORDERS] if i == inertias // 2 else []
        elements.append(tn.Disk(inertia=float(rng.uniform(0.05, 0.3)), excitation=shaken))
        if i + 1 in bends:
            elements.append(tn.HookeJoint(angle=tn.deg(degrees)))
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


def straight_free(inertias: int) -> tn.Driveline:
    """A chain that nothing holds, shaken at its middle."""
    elements = list(chain(inertias, 0).elements[2:])
    return tn.Driveline(elements)


def beside_open_torsion(most: int, repeats: int) -> None:
    """Seconds of both, in turn."""
    print("\n| straight and free, inertias | order_response [s] | openTorsion [s] | times as long |\n|---|---|---|---|")
    for n in (21, 100, 300):
        line = straight_free(n)
        other = open_torsion(line, SPEEDS)
        if n > most or other is None:
            continue
        works, seconds = (lambda line=line: tn.order_response(line, SPEEDS), other), ([], [])
        for _ in range(repeats):
            for work, taken in zip(works, seconds, strict=True):
                begin = time.process_time()
                work()
                taken.append(time.process_time() - begin)
        ours, theirs = (statistics.median(taken) for taken in seconds)
        print(f"| {n} | {ours:.4f} | {theirs:.3f} | {theirs / ours:.1f} |", flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--most", type=int, default=300)
    parser.add_argument("--one", choices=list(RANGES), help="one row of the last table, for --most inertias")
    asked = parser.parse_args()
    if asked.one:
        over_range(asked.one, asked.most)
        return
    print("| inertias | order_response, straight [s] | two angled joints [s] | target |\n|---|---|---|---|")
    for n in (10, 20, 50, 100, 300):
        if n <= asked.most:
            straight, bent = (
                median(lambda line=line: tn.order_response(line, SPEEDS), asked.repeats)
                for line in (chain(n, 0), chain(n))
            )
            print(f"| {n} | {straight:.4f} | {bent:.3f} | {TARGETS.get(n, '')} |", flush=True)
    beside_open_torsion(asked.most, asked.repeats)
    print("\n| inertias, speeds | as chosen [s] | along the tree | whole matrices |\n|---|---|---|---|")
    for n, speeds in ((3, 1), (3, 400), (4, 1), (4, 400), (6, 1), (6, 400), (20, 1), (20, 50)):
        line, at = chain(n), tn.rpm(np.linspace(600.0, 3000.0, speeds))
        chosen, along, whole = (
            median(lambda line=line, at=at: tn.order_response(line, at), asked.repeats) for _ in ways()
        )
        print(f"| {n}, {speeds} | {chosen:.4f} | {along:.4f} | {whole:.4f} |", flush=True)
    print("\n| inertias | stability, straight [s] | two angled joints [s] | target |\n|---|---|---|---|")
    for n in (20, 50, 100, 300):
        if n <= asked.most:
            straight, bent = (
                median(lambda line=line: tn.stability(line, 150.0), asked.repeats) for line in (chain(n, 0), chain(n))
            )
            print(f"| {n} | {straight:.3f} | {bent:.3f} | {'0.02, 0.5' if n == 100 else ''} |", flush=True)
    print("\n| inertias, free, two angled joints | stability, about its own motion [s] | by shooting |\n|---|---|---|")
    for n, both in ((16, True), (24, True), (50, False), (100, False), (200, False)):
        if n <= asked.most:
            line = tn.Driveline(chain(n).elements[2:])
            along = median(lambda line=line: tn.stability(line, 150.0), asked.repeats)
            shot = median(lambda line=line: by_shooting(line), 1) if both else float("nan")
            print(f"| {n} | {along:.3f} | {shot:.3f} |", flush=True)
    print("\n| inertias, angle | stability, as chosen [s] | by modes | states carried in time |\n|---|---|---|---|")
    for n, angle in ((20, 15.0), (50, 15.0), (100, 15.0), (200, 15.0), (20, 45.0), (100, 45.0), (100, 60.0)):
        if n <= asked.most:
            line = chain(n, 2, angle)
            chosen, modes, carried = (
                median(lambda line=line: tn.stability(line, 150.0), asked.repeats) for _ in ways_to_multipliers()
            )
            print(f"| {n}, {angle:.0f}° | {chosen:.3f} | {modes:.3f} | {carried:.3f} |", flush=True)
    print(
        "\n| inertias, angle | response over a range, estimated [s] | measured [s] | times as long |\n|---|---|---|---|"
    )
    for n in (10, 20, 50, 100):
        for degrees in (5.0, 15.0, 30.0, 45.0) if n <= asked.most else ():
            estimate, seconds = estimated_and_measured(chain(n, 2, degrees))
            print(f"| {n}, {degrees:.0f}° | {estimate:.2f} | {seconds:.2f} | {seconds / estimate:.1f} |", flush=True)
    print("\n| inertias, pixels of a chart | as chosen [s] | without whole matrices |\n|---|---|---|")
    for n, size, both in CHARTS:
        if n <= asked.most:
            chart(chain(n), (8, 6))
            chosen, other = chart(chain(n), size), without_whole_matrices(chain(n), size) if both else float("nan")
            print(f"| {n}, {size[0]} × {size[1]} | {chosen:.2f} | {other:.2f} |", flush=True)

    print("\n| inertias | over the range | seconds | largest memory [GB] |\n|---|---|---|---|", flush=True)
    for n in (10, 20, 50, 100):
        for what in RANGES if n <= asked.most else ():
            subprocess.run([sys.executable, __file__, "--one", what, "--most", str(n)], check=True)


def estimated_and_measured(line: tn.Driveline) -> tuple[float, float]:
    """Processor seconds of the response over ``NARROW``, by which long ones are refused, and those it takes."""
    assembly, even = assemble(line), np.linspace(*NARROW, 241)
    _, cost = cost_of_range(assembly, even, begun_with(assembly, even))
    begin = time.process_time()
    response_over(line, *NARROW)
    return cost.seconds, time.process_time() - begin


def response_over_range(line: tn.Driveline) -> None:
    """As the command order-response without a number of speeds."""
    response_over(line, *ENDS)


def unstable_speeds(line: tn.Driveline) -> None:
    """As ``assess`` searches them."""
    span = Span(assemble(line), *ENDS)
    unstable_ranges(span, lambda speeds: stability_along(span.assembly, speeds))


def assessed(line: tn.Driveline) -> None:
    """All checks over the range."""
    tn.assess(line, ENDS)


def differentiated(line: tn.Driveline) -> None:
    """Frequencies, growth and torques at the ends of the range by all numbers."""
    tn.sensitivity(line, ENDS, of=["frequencies", "growth", "torques"])


def modes(line: tn.Driveline) -> None:
    """Natural frequencies, shapes and the Campbell diagram over the range."""
    tn.natural_frequencies(line)
    tn.campbell_diagram(line, ENDS)


def turns_of_joints(line: tn.Driveline) -> None:
    """Uneven rotation and torques that joints make."""
    tn.kinetostatics(line, ENDS[1])


NARROW = (float(tn.rpm(600.0)), float(tn.rpm(900.0)))
"""Which holds few enough resonances of 100 inertias."""
ENDS = (float(tn.rpm(600.0)), float(tn.rpm(3000.0)))
RANGES = {
    work.__name__: work
    for work in (modes, turns_of_joints, unstable_speeds, response_over_range, assessed, differentiated)
}
"""Each in a process of its own, whose largest memory is that of one."""


def over_range(what: str, inertias: int) -> None:
    """A row of the last table."""
    line = chain(inertias)
    tn.stability(line, 150.0)  # compiles
    begin = time.process_time()
    RANGES[what](line)
    seconds, memory = time.process_time() - begin, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"| {inertias} | {what.replace('_', ' ')} | {seconds:.1f} | {memory:.2f} |", flush=True)


CHARTS = (
    (13, (40, 30), True),
    (20, (30, 20), True),
    (20, (60, 45), True),
    (20, (200, 150), False),
    (50, (200, 150), False),
)
"""Inertias, pixels, and whether the ways of shorter lines are timed too."""


def chart(line: tn.Driveline, size: tuple[int, int]) -> float:
    """Processor seconds of a chart of ``size`` pixels."""
    begin = time.process_time()
    speed, angle = ("speed", *tn.rpm(np.array([600.0, 3000.0])).tolist()), ("HookeJoint *.angle", 0.0, tn.deg(25.0))
    tn.stability_chart(line, (*speed, size[0]), (*angle, size[1]), threads=1)
    return time.process_time() - begin


def without_whole_matrices(line: tn.Driveline, size: tuple[int, int]) -> float:
    """As ``chart``, in the ways of shorter lines."""
    own, LineFamily.whole_matrices = LineFamily.whole_matrices, ChartFamily.whole_matrices  # type: ignore[method-assign]
    try:
        return chart(line, size)
    finally:
        LineFamily.whole_matrices = own  # type: ignore[method-assign]


def by_shooting(line: tn.Driveline) -> None:
    """``stability`` of a free line in the way of shorter ones."""
    own, judged.LONG = judged.LONG, 10**6
    try:
        tn.stability(line, 150.0)
    finally:
        judged.LONG = own


def ways() -> Iterator[None]:
    """``order_response`` as the cost model chooses, then always along the tree, then always by whole matrices."""
    model = spectrum.tree_pays
    for pays in (model, lambda *asked: True, lambda *asked: False):
        spectrum.tree_pays = pays  # type: ignore[assignment]
        yield
    spectrum.tree_pays = model


def ways_to_multipliers() -> Iterator[None]:
    """``stability`` as its cost model chooses, then always by modes first, then with all states carried in time."""
    model = tree_modes._blocks_pay
    for pays in (model, lambda line: True, lambda line: False):
        tree_modes._blocks_pay = pays  # type: ignore[assignment]
        yield
    tree_modes._blocks_pay = model


if __name__ == "__main__":
    main()

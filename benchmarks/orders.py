"""Order responses: 21 inertias with 20 orders, and the truck with three angled joints and 8 orders, at 400 speeds each.

    PYTHONPATH=src python benchmarks/orders.py [--repeats 5]

Warm, the median of a few runs; extremes over the cycle (``peak_torque``) are found when asked for and timed apart. If
openTorsion is installed (pip install opentorsion), its own steady response of the same chain stands beside it.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import trunnion as tn

SPEEDS = 400


def chain(inertias: int = 21, orders: int = 20) -> tn.Driveline:
    """A free chain as of a six-cylinder engine with its driven machine."""
    rng, elements = np.random.default_rng(1), []
    for i in range(inertias):
        shaken = [
            {"order": 0.5 * (k + 1), "amplitude": float(rng.uniform(10, 100)), "phase": float(rng.uniform(-3, 3))}
            for k in range(orders if 2 <= i < 8 else 0)
        ]
        elements.append(tn.Disk(inertia=float(rng.uniform(0.05, 0.3)), excitation=shaken))
        if i < inertias - 1:
            k, c = float(rng.uniform(1e5, 1e6)), float(rng.uniform(5, 30))
            elements.append(tn.Shaft(stiffness=k, damping=c))
    return tn.Driveline(elements)


def truck() -> tn.Driveline:
    """The example, shaken by 8 orders at the gearbox."""
    line = tn.load(Path(__file__).parents[1] / "examples" / "truck.toml").with_load("climb")
    orders = [{"order": k, "amplitude": 20 / k, "phase": 0.1 * k} for k in (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)]
    return line.replace("gearbox flange", excitation=orders)


def open_torsion(line: tn.Driveline, speeds: np.ndarray) -> Callable[[], list[np.ndarray]] | None:
    """openTorsion's rotations of the chain, all orders at one speed after the other; None where it is not installed."""
    try:
        import opentorsion as ot
    except ImportError:
        return None
    disks = [e for e in line.elements if isinstance(e, tn.Disk)]
    shafts = [e for e in line.elements if isinstance(e, tn.Shaft)]
    assembly = ot.Assembly(
        [ot.Shaft(i, i + 1, k=s.stiffness, c=s.damping) for i, s in enumerate(shafts)],
        disk_elements=[ot.Disk(i, I=d.inertia) for i, d in enumerate(disks)],
    )
    shaken = {i: d.excitation for i, d in enumerate(disks) if d.excitation}
    orders = np.array([h.order for h in next(iter(shaken.values()))])

    def work() -> list[np.ndarray]:
        found = []
        for speed in speeds:
            forces = ot.PeriodicExcitation(len(disks), orders * speed)
            for i, harmonics in shaken.items():
                sizes, phases = (np.array([getattr(h, key) for h in harmonics]) for key in ("amplitude", "phase"))
                forces.add_sines(i, orders * speed, sizes, phases)
            found.append(assembly.ss_response(forces.U, orders * speed)[0])
        return found

    return work


def median(work: Callable[[], object], repeats: int) -> float:
    """Seconds of ``work``, once for warmth and then the median."""
    work()
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    print(f"{platform.processor() or platform.machine()}, Python {platform.python_version()}, numpy {np.__version__}")
    for name, line, low, high, target in (
        ("21 inertias, 20 orders", chain(), 300, 3000, 0.2),
        ("truck, 3 angled joints, 8 orders", truck(), 300, 2400, 2.0),
    ):
        speeds = tn.rpm(np.linspace(low, high, SPEEDS))
        response = median(lambda line=line, speeds=speeds: tn.order_response(line, speeds), repeats)
        both = median(lambda line=line, speeds=speeds: tn.order_response(line, speeds).peak_torque, repeats)
        print(
            f"{name}, {SPEEDS} speeds: {response:.3f} s (target {target} s); with extremes over the cycle {both:.3f} s"
        )
        rival = open_torsion(line, speeds) if not line.name else None
        if rival is not None:
            other, found = median(rival, repeats), tn.order_response(line, speeds)
            shaft = [e for e in line.elements if isinstance(e, tn.Shaft)]
            k, c = (np.array([getattr(s, key) for s in shaft])[:, None] for key in ("stiffness", "damping"))
            torque = [
                ((k + 1j * c * v * found.order) * np.diff(q, axis=0)).T for v, q in zip(speeds, rival(), strict=True)
            ]
            apart = np.abs(found.torque - torque).max() / np.abs(found.torque).max()
            print(f"  openTorsion {other:.3f} s, {other / response:.1f} times as long; torques apart by {apart:.1g}")


if __name__ == "__main__":
    main()

"""What a study costs beside its points: engine and store at tasks of a second, a second worker, points of the batch.

    python benchmarks/studies.py overhead [tasks] [seconds]
    python benchmarks/studies.py workers [tasks] [seconds]
    python benchmarks/studies.py batch [points]
    python benchmarks/studies.py memory [points] [points]
    python benchmarks/studies.py client [points] [points]

Times are processor time unless they are called elapsed: other work on the machine does not change them.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import threading
from pathlib import Path
from time import perf_counter, process_time, sleep
from typing import Any

import trunnion as tn
from trunnion.studies.points import DONE, StudyQuestion
from trunnion.studies.runner import StudyProgress, workers_here

EVERY = 0.05
"""Seconds between two looks at what processes hold."""


def line() -> tn.Driveline:
    """Two shafts with a joint between."""
    parts = tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0), tn.HookeJoint(angle=0.2)
    return tn.Driveline([tn.ConstantSpeed(), *parts, tn.Shaft(stiffness=1.0, damping=0.01), tn.Disk(inertia=1.0)])


def asked(store: Path, quantities: list[str], points: int, **more: Any) -> dict[str, Any]:
    """A grid of about so many points of angle and speed."""
    side = max(int(round(points**0.5)), 1)
    grid = [
        {"path": "HookeJoint 1.angle", "low": "2 deg", "high": "40 deg", "points": points // side},
        {"path": "speed", "low": 0.4, "high": 2.0, "points": side},
    ]
    study = {"line": "", "analysis": "stability", "quantities": quantities, "store": str(store), "parameter": grid}
    return {**study, **more}


def overhead(tasks: int = 60, seconds: int = 1) -> None:
    """Tasks that sleep, so that other work on the machine takes nothing from them: what client and scheduler, in this
    process, and worker and store, in another, take of the processor meanwhile, and how much later all is done."""
    with tempfile.TemporaryDirectory() as folder, workers_here(1, dashboard=None) as client:
        client.run(_sleeping, seconds)
        tn.study(_sleepers(Path(folder) / "warm.zarr", 2), line=line(), client=client)  # whatever loads or compiles
        before, mine, begun = sum(client.run(process_time).values()), process_time(), perf_counter()
        tn.study(_sleepers(Path(folder) / "a.zarr", tasks), line=line(), client=client)
        elapsed, mine = perf_counter() - begun, process_time() - mine
        theirs = sum(client.run(process_time).values()) - before
    asleep = tasks * seconds
    print(f"{tasks} tasks of {seconds} s, asleep: {elapsed:.1f} s elapsed, {100 * (elapsed / asleep - 1):.1f} % more")
    for who, used in (("client and scheduler", mine), ("worker and store", theirs)):
        print(f"  {who}: {1e3 * used / tasks:.1f} ms of processor time a task, {100 * used / asleep:.2f} %")


def _sleepers(store: Path, tasks: int) -> dict[str, Any]:
    """As many blocks of 16 points, each a task: 59 or 61 in place of 60 would tell a wrong share."""
    study = asked(store, ["growth_rate", "liouville_defect"], tasks * 16, block=16)
    for axis, points in zip(study["parameter"], (tasks, 16), strict=True):
        axis["points"] = points
    return study


def _sleeping(seconds: float) -> None:
    """From now on blocks of this process sleep."""

    def evaluated(self: StudyQuestion, paths: tuple[str, ...], values: Any) -> Any:
        sleep(seconds)
        room = self._room(len(values))
        room.status[:] = DONE
        for column in room.values.values():
            column[:] = 1.0
        return room

    StudyQuestion.evaluated = evaluated  # type: ignore[method-assign]


def workers(tasks: int = 60, seconds: int = 1) -> None:
    """The same tasks on one worker and on two; elapsed."""
    took = {}
    for count in (1, 2):
        with tempfile.TemporaryDirectory() as folder, workers_here(count, dashboard=None) as client:
            client.run(_sleeping, seconds)
            tn.study(_sleepers(Path(folder) / "warm.zarr", 2), line=line(), client=client)
            begun = perf_counter()
            tn.study(_sleepers(Path(folder) / "a.zarr", tasks), line=line(), client=client)
            took[count] = perf_counter() - begun
        print(f"{count} workers: {tasks} tasks of {seconds} s in {took[count]:.1f} s elapsed", flush=True)
    print(f"two are {took[1] / took[2]:.2f} times one")


def batch(points: int = 1_000_000) -> None:
    """Growth rate and verdict of two shafts, in this process, with the store."""
    with tempfile.TemporaryDirectory() as folder:
        tn.study(asked(Path(folder) / "warm.zarr", ["growth_rate"], 64), line=line(), workers=0)
        begun, elapsed = process_time(), perf_counter()
        store = Path(folder) / "a.zarr"
        found = tn.study(asked(store, ["growth_rate", "verdict"], points), line=line(), workers=0)
        used, elapsed = process_time() - begun, perf_counter() - elapsed
        size = sum(path.stat().st_size for path in store.rglob("*") if path.is_file())
    each = f"{1e6 * used / found.done:.2f} µs a point, {elapsed:.0f} s elapsed"
    print(f"{found.done} points in {used:.1f} s of processor time ({each}), {size / 1e6:.1f} MB in the store")


def memory(*sizes: int) -> None:
    """The largest that this process holds while points are computed, above what it holds before; each study new."""
    _filled(sizes, workers=0)


def client(*sizes: int) -> None:
    """The same of the client, with the scheduler beside it, while two workers compute; and of the workers together."""
    _filled(sizes, workers=2)


def _filled(sizes: tuple[int, ...], workers: int) -> None:
    from trunnion.studies.store import Store
    from trunnion.studies.study import _plan, completed

    for points in sizes or (1_000_000, 10_000_000):
        with tempfile.TemporaryDirectory() as folder:
            plan = _plan(asked(Path(folder) / "a.zarr", ["growth_rate", "verdict"], points), line(), False)
            store = Store.create(plan.store, plan.question, plan.design, plan.block, plan.source)
            held, theirs, stop = [_held()], [0], threading.Event()

            def watch(seen: list[int] = held, end: threading.Event = stop) -> None:
                while not end.is_set():
                    seen.append(_held())
                    sleep(EVERY)

            def report(state: StudyProgress, most: list[int] = theirs) -> None:
                most[0] = max(most[0], state.bytes)

            watcher = threading.Thread(target=watch)
            watcher.start()
            begun, elapsed = process_time(), perf_counter()
            completed(store, workers, None, None, None, False, report)
            used, elapsed = process_time() - begun, perf_counter() - elapsed
            stop.set()
            watcher.join()
        most, above = max(held) / 1e6, (max(held) - held[0]) / 1e6
        print(f"{points} points: at most {most:.0f} MB held, {above:.0f} MB above the start; {used:.0f} s of processor "
              f"time here, {elapsed:.0f} s elapsed")  # fmt: skip
        if workers:
            print(f"  {workers} workers together: at most {theirs[0] / 1e6:.0f} MB", flush=True)


def _held() -> int:
    """Bytes that this process has in memory now."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize()


if __name__ == "__main__":
    what, *numbers = sys.argv[1:]
    named = {"overhead": overhead, "workers": workers, "batch": batch, "memory": memory, "client": client}
    named[what](*map(int, numbers))
